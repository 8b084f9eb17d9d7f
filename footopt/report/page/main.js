// Puts the page together: what was found, the designs, the chosen sole, its walk, and how it was made.

const entry = data.entry ?? {};
const flatEntry = entry.flat;

/** The first lines: what this run is and what it found. */
function headline() {
  const warnings = [...(entry.warnings ?? []).map((text) => `Outside what the theory is tested for: ${text}.`), ...(data.warnings ?? [])]
    .map((text) => el("p", { class: "warning" }, text));
  const badge = el("details", { id: "warnings" }, el("summary", {}, `${warnings.length} warning${warnings.length > 1 ? "s" : ""}`), ...warnings);
  return [...(data.headline ?? []).map((text) => el("p", {}, text)), ...(warnings.length ? [badge] : [])];
}

/** The chosen design: its sole, its numbers, its files. */
function designSection() {
  const drawing = el("div", { class: "plot" }), numbers = el("div", { class: "scroll" }), words = el("p", { id: "design-words" });
  const title = el("h2", { id: "design-title" });
  let chosen = data.best;
  const buttons = Object.entries(FORMATS).map(([ending, { text, type }]) => el("button", {
    type: "button", id: `download-${ending}`,
    click: () => download(`sole-${label(chosen).replace(/[^\w.-]+/g, "-")}.${ending}`, text({ points: sole(chosen), top: own("top", chosen), width: own("width", chosen) }), type),
  }, ending.toUpperCase()));
  const section = el("section", { id: "design" }, title, words,
    el("div", COUNT > 1 ? {} : { class: "grid wide" }, el("figure", {}, drawing),
      el("div", {}, numbers, el("div", { class: "bar" }, "Download it as", ...buttons))));
  function redraw() {
    const points = sole(chosen), k = heights(chosen), best = chosen === data.best;
    const others = data.walks?.find((walk) => walk.design === null);
    title.textContent = COUNT > 1 ? `The chosen sole: ${label(chosen)}` : `The sole: ${label(chosen)}`;
    words.textContent = [
      k ? `k = [${k.join(",")}]` : "",
      `hollow ${(MM * hollow(points)).toFixed(1)} mm`,
      generation ? `generation ${generation[chosen]}` : "",
      feasible[chosen] ? "" : `infeasible: ${reason(chosen)}`,
    ].filter(Boolean).join("; ");
    drawing.replaceChildren(soleDrawing(points, { width: Math.max(drawing.clientWidth, 200), k, top: own("top", chosen),
      ghost: others ? pairs(unpack(others.sole)) : null }));
    const exact = best && data.bestValues, value = (c) => (exact ? data.bestValues[c] : values[chosen * WIDTH + c]);
    const errors = best && entry.error_estimate;
    numbers.replaceChildren(table(
      ["", "this sole", ...(errors ? ["error"] : []), ...(flatEntry ? ["flat sole", "change"] : [])],
      data.columns.map((column, c) => {
        const base = flatEntry?.[column.name];
        const share = errors ? Math.abs(errors[column.name] / value(c)) : NaN;
        return [`${column.title}${column.unit ? `, ${column.unit}` : ""} (${column.maximise ? "max" : "min"})`,
          number(value(c)),
          ...(errors ? [Number.isFinite(share) ? `${+(100 * share).toPrecision(2)} %` : "–"] : []),
          ...(flatEntry ? [number(base), change(value(c), base, column)] : [])];
      })),
      el("p", { class: "note" }, data.jobs ? "" : exact
        ? `Walked at accuracy ${entry.accuracy.name}; the errors are estimates by refinement.${others ? " Dashed: the flat sole." : ""}`
        : `Walked at accuracy ${(entry.search_accuracy ?? entry.accuracy).name}.${others ? " Dashed: the flat sole." : ""}`));
  }
  return { section, redraw, show: (i) => { chosen = i; redraw(); say(`Chosen: ${label(i)}`); } };
}
function change(value, base, column) {
  const ratio = value / base;
  if (!Number.isFinite(ratio)) return "–";
  if (column.name === "efficiency") return ratio >= 1 ? `x ${ratio.toFixed(3)}` : `${(100 * (1 - ratio)).toPrecision(2)} % worse`;
  return `${ratio >= 1 ? "+" : "−"}${Math.abs(100 * (ratio - 1)).toFixed(1)} %`;
}

/** How a search got there: convergence, and each design that was the best for a while. */
function searchSection(choose) {
  const holder = el("div", { class: "plot" }), several = data.objectives.length > 1;
  const draw = () => {
    const rows = data.history, bests = rows.map((r) => r.best ?? NaN), medians = rows.map((r) => r.median ?? NaN);
    const a = axes(holder, { x: [0, rows.at(-1).evaluations], y: range([...bests, ...medians]), xlabel: "evaluations",
      ylabel: several ? "hypervolume (1: box of the first generation)" : `${named(guide)}: best so far`, height: 260, left: 84,
      label: "Convergence of the search; the table below has the numbers" });
    const X = (i) => a.X(rows[i].evaluations);
    a.svg.append(
      svg("path", { d: path(medians.map((v, i) => [X(i), a.Y(v)])), fill: "none", stroke: GREY, "stroke-width": 1.5, "stroke-dasharray": "6 4" }),
      svg("path", { d: path(bests.flatMap((v, i) => (i ? [[X(i), a.Y(bests[i - 1])], [X(i), a.Y(v)]] : [[X(i), a.Y(v)]]))), fill: "none", stroke: GREEN, "stroke-width": 2.2 }));
  };
  const buttons = data.lineage.map((i) => el("button", { type: "button", "aria-pressed": String(i === data.best), "data-design": i, click: () => choose(i) },
    soleDrawing(sole(i), { width: 136, height: 32, plain: true }),
    el("div", {}, `generation ${generation[i]}`), el("div", {}, quantity(guide.of(i), guide.unit))));
  const section = el("section", { id: "search" }, el("h2", {}, "The search"),
    el("figure", {}, holder, several ? null : el("figcaption", {}, "Dashed: the median of each generation.")),
    folded("The search as a table", () => table(["evaluations", ...(several ? ["hypervolume", "front"] : [`best ${named(guide)}`, "median"])],
      data.history.map((r) => [r.evaluations, number(r.best), several ? r.front : number(r.median)].map(String)))),
    ...(buttons.length ? [el("h3", {}, "Lineage: each sole that was the best at the end of a generation"),
      el("div", { class: "lineage" }, ...buttons)] : []));
  const mark = (i) => buttons.forEach((b) => b.setAttribute("aria-pressed", String(+b.dataset.design === i)));
  return { section, draw, mark };
}

/** A text (or an element) that may run over several lines of a table; a path breaks after a slash. */
const words = (text) => el("span", { class: "words" },
  ...(typeof text === "string" ? text.split(/(?<=\/)/).flatMap((part, i) => (i ? [el("wbr"), part] : [part])) : [text]));

/** A multirun, or runs to compare: its jobs in a table with their soles. */
function jobsSection(choose) {
  const differ = data.columns, what = data.jobs[0].name.split(" ")[0];
  return el("section", { id: "jobs" }, el("h2", {}, `The ${what}s`),
    el("div", { class: "scroll", style: "max-height:none" }, table([what, "settings", "sole", ...differ.map(named), "hollow (mm)", "seed", "time (s)"],
      data.jobs.map((job) => [
        job.link ? el("a", { href: job.link }, job.name) : job.name,
        el("div", {}, words(job.settings), job.place ? el("div", { class: "words note" }, job.place) : "", job.note ? el("div", { class: "words warning" }, job.note) : ""),
        job.design === null ? "" : el("button", { type: "button", "aria-label": `Choose the sole of ${job.name}`, click: () => choose(job.design) },
          soleDrawing(sole(job.design), { width: 120, height: 36, plain: true })),
        ...differ.map((_, c) => (job.design === null ? "–" : number(values[job.design * WIDTH + c]))),
        job.hollow, job.seed ?? "–", number(job.seconds)]))),
    ...(data.jobs.some((job) => job.link) ? [el("p", { class: "note" }, `A ${what}'s link opens its own page.`)] : []));
}

/** What the jobs' walks have in common to look at: traces over time, a colour and a dash for each job. */
function tracesSection() {
  const jobs = data.traces.map((raw, i) => ({ label: data.designs.labels[raw.design], t: unpack(raw.t),
    ...Object.fromEntries(["height", "speed", "power", "work"].map((name) => [name, unpack(raw[name])])),
    settings: data.jobs.find((job) => job.design === raw.design).settings,
    line: { stroke: COLOURS[i % COLOURS.length], "stroke-dasharray": [null, "7 3", "2 2", "9 3 2 3"][i % 4] } }));
  const titles = { height: "height of the COM (m)", speed: "forward speed (m/s)", power: "power of the sand, both feet (W)", work: "work of the sand, both feet (J)" };
  const plots = Object.keys(titles).map((name) => [name, el("div", { class: "plot" })]);
  const draw = () => plots.forEach(([name, holder]) => {
    const a = axes(holder, { x: range(jobs.flatMap((job) => [0, job.t.at(-1) ?? 0]), 0), y: range(jobs.flatMap((job) => Array.from(job[name]))),
      xlabel: "time (s)", ylabel: titles[name], height: 230, label: `${titles[name]} over time, of every job` });
    for (const job of jobs) a.svg.append(svg("path", { d: path(Array.from(job.t, (t, i) => [a.X(t), a.Y(job[name][i])])), fill: "none", "stroke-width": 1.5, ...job.line }));
  });
  const section = el("section", { id: "traces" }, el("h2", {}, "Their walks"),
    el("p", { class: "note" }, ...jobs.flatMap((job) => [key(job.line), ` ${[job.label, job.settings].filter(Boolean).join(": ")}  `])),
    el("div", { class: "grid", style: "--columns:2" }, ...plots.map(([, holder]) => el("figure", {}, holder))));
  return { section, draw };
}

/** A study of many walks: its figures and its tables, as they are on paper and on the terminal. */
function studySections() {
  const figures = data.figures.map(({ source, width, says }) =>
    el("figure", { class: "printed" }, el("img", { src: source, width, alt: says }), el("figcaption", {}, says)));
  const tables = data.tables.flatMap(({ title, head, words: wordy, rows, bad, links, caption }) => {
    const shown = (cell, r, c) => links[r][c] ? el("a", { href: encodeURIComponent(cell) }, cell) : bad[r][c] ? el("strong", { class: "bad" }, cell) : cell;
    const made = table(head.map((text, c) => (wordy[c] ? words(text) : text)),
      rows.map((row, r) => row.map((cell, c) => (wordy[c] ? words(shown(cell, r, c)) : shown(cell, r, c)))));
    return [title ? el("h3", {}, title) : null, el("div", { class: "scroll" }, made), caption ? el("p", { class: "note" }, caption) : null];
  });
  return [
    ...(tables.length ? [el("section", { id: "tables" }, el("h2", {}, "What was found"), ...tables)] : []),
    ...(figures.length ? [el("section", { id: "figures" }, el("h2", {}, "Figures"), ...figures)] : []),
  ];
}

/** Config, seed, versions, errors, time: what a reader needs to make the same page again. */
function footer() {
  const facts = [
    ["seed", entry.seed ?? undefined], ["wall time", entry.wall_time_s === undefined ? undefined : `${entry.wall_time_s.toFixed(1)} s`],
    ["accuracy", entry.accuracy?.name],
    ["evaluations", entry.evaluations], ["designs", entry.designs], ["infeasible", entry.infeasible],
    ["versions", entry.versions && Object.entries(entry.versions).map(([name, v]) => `${name} ${v}`).join(", ")],
  ].filter(([, value]) => value !== undefined);
  const block = (title, value) => value === undefined ? null : folded(title, () => el("pre", {}, JSON.stringify(value, null, 2)));
  return [el("h2", {}, "How it was made"),
    el("p", {}, facts.map(([name, value]) => `${name}: ${value}`).join("; ")),
    ...(entry.validity ? [el("p", {}, `validity of the walk: ${Object.entries(entry.validity).map(([name, value]) => `${name} ${quantity(value, entry.validity_units?.[name])}`).join("; ")}`)] : []),
    ...[block("Error estimates", entry.error_estimate), block("Settings", entry.settings), block("Scene", entry.scene),
      block("Accuracy", entry.accuracy)].filter(Boolean)];
}

function build() {
  const main = document.getElementById("main");
  document.getElementById("header").append(...headline());
  const walks = data.walks && walkSection(), design = designSection();
  let explore = null, found = null;
  const choose = (i) => {
    design.show(i);
    explore?.mark(i);
    found?.mark(i);
    const place = data.walks ? data.walks.findIndex((walk) => walk.design === i) : -1;
    if (walks && place >= 0) walks.show(place);
    unwalked.textContent = walks && place < 0 ? `No walk of ${label(i)} is on this page (${data.walks.length - 2} of the designs beside the best are); footopt study=simulate foot.k=[${heights(i)}] walks with it, with this run's own sand and other settings beside.` : "";
  };
  const unwalked = design.section.appendChild(el("p", { class: "note", id: "unwalked" }));
  if (data.figures) main.append(...studySections());
  if (data.jobs) main.append(jobsSection(choose));
  if (COUNT > 1) main.append((explore = explorer(choose, design.section)).section);
  if (COUNT === 1) main.append(design.section);
  if (walks) main.append(walks.section);
  if (data.history?.length) main.append((found = searchSection(choose)).section);
  const traces = data.traces?.length ? tracesSection() : null;
  if (traces) { main.append(traces.section); drawn(traces.draw); }
  if (data.entry) document.getElementById("footer").append(...footer());
  if (found) drawn(found.draw);
  if (explore) { explore.filter(); drawings.push(explore.redraw); }
  if (COUNT) drawn(design.redraw);
  if (walks) { walks.show(0); drawings.push(walks.redraw); }
}
build();
