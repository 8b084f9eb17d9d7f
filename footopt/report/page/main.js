// Puts the page together: the answer, the designs, the chosen sole, its walk, the search and its settings.

const badge = el("details", { id: "warnings" });
/** Warnings of the run, and of the design that is shown. */
function warn(i = data.best) {
  const outside = i === undefined || i === data.best ? entry.warnings ?? [] : tooDeep(i), told = [...outside.map((text) => `Outside the tested range: ${text}.`), ...(data.warnings ?? [])];
  badge.hidden = !told.length;
  badge.replaceChildren(el("summary", {}, `${told.length} warning${told.length > 1 ? "s" : ""}`), ...told.map((text) => el("p", { class: "warning" }, text)));
}
/** The first lines: what this run is and what it found. */
function headline() {
  warn();
  const [first, ...more] = data.headline ?? [], short = data.walks ? [] : more;
  return [...(first ? [el("p", {}, first)] : []), ...short.map((text) => el("p", {}, text)), badge];
}

/** The change of an objective: of J_W the multiple, of others in %. */
function change(value, base, column) {
  const ratio = value / base;
  if (!Number.isFinite(ratio) || Math.abs(base) < ROUNDING) return "–";
  if (column.name === "efficiency") return `x ${ratio.toFixed(2)}`;
  if (Math.abs(ratio) >= 10) return `x ${number(+ratio.toPrecision(2))}`;
  return `${ratio >= 1 ? "+" : "−"}${Math.abs(100 * (ratio - 1)).toFixed(1)} %`;
}

/** A design's value of each column, the finest there is. */
const fineOf = (i) => (i === data.best ? data.bestValues : i === data.printed ? data.printedValues : null);
const valueOf = (i, c) => fineOf(i)?.[c] ?? values[i * WIDTH + c];

/** Relative changes of a design against the flat foot under other sand laws: as the run found them, or as this page does. */
function underLaws(i, name) {
  const known = i === data.best ? entry.laws ?? [] : i === data.printed ? entry.to_print.laws ?? [] : null;
  return (known ? known.slice(1) : judgedHere(i).laws).map((law) => ({ law: law.law, share: law.change?.[name] })).filter(({ share }) => Number.isFinite(share ?? NaN));
}
const doubtful = (share, under) => under.some((u) => u.share * share < 0) ? ", sign not certain" : "";

const errorOf = (i, name) => Math.abs((i === data.best ? entry.error_estimate : judgedHere(i).errors)?.[name] ?? NaN);
/** The best of a search has its colour, any other sole that of the chosen one; the sole of a single walk that of the figures. */
const colourOf = (i) => `var(--${i !== data.best ? "chosen" : data.objectives ? "best" : label(i) === "flat" ? "flat" : "line-0"})`;

const OF_THE_LAW = " The law of the sand errs by half and more in many experiments: compare feet, do not read values as measurements.";

/** Bars of change against the flat foot, with error ticks and circles under other sand laws. */
function bars(i, width) {
  const colour = colourOf(i), sought = data.objectives ?? [], narrow = width < 450;
  const rows = data.columns.flatMap((column, c) => {
    const value = valueOf(i, c), base = entry.flat[column.name], share = value / base - 1;
    if (column.name === "efficiency" || !Number.isFinite(share) || Math.abs(base) < ROUNDING) return [];
    return [{ column, value, base, share, error: errorOf(i, column.name) / Math.abs(base), under: underLaws(i, column.name), better: (share > 0) === column.maximise }];
  }).sort((a, b) => sought.includes(b.column.name) - sought.includes(a.column.name));
  const reach = ({ share, error, under }) => [share, ...(Number.isFinite(error) ? [share - error, share + error] : []), ...under.map((u) => u.share)];
  const [low, high] = range([-0.005, 0.005, ...rows.flatMap(reach)].map((v) => clip(v, -1, 2)), 0); // 1 % at least
  const left = 78, right = 78, tall = 49, X = (v) => left + ((clip(v, low, high) - low) / (high - low || 1)) * (width - left - right);
  const made = svg("svg", { id: "bars", viewBox: `0 0 ${width} ${rows.length * tall + 4}`, height: rows.length * tall + 4, role: "img",
    "aria-label": `Change against the flat foot: ${rows.map((row) => `${row.column.title} ${change(row.value, row.base, row.column)}`).join(", ")}` });
  rows.forEach(({ column, value, base, share, error, under, better }, r) => {
    const y = r * tall + 22, middle = y + 9, end = X(share), out = share < 0 ? -1 : 1;
    const ends = range([share, ...under.map((u) => u.share)], 0).map(X), past = (out < 0 ? Math.min : Math.max)(...reach({ share, error, under }).map(X));
    made.append(
      svg("text", { class: "halo", x: 0, y: r * tall + 14 }, svg("tspan", { style: "font-weight:600" }, column.title),
        svg("tspan", { style: "fill:var(--grey)" }, `  ${quantity(value, column.unit)}${Number.isFinite(error) && !narrow ? ` ± ${percent(Math.abs(error * base / value))}` : ""}, flat ${number(base)}${doubtful(share, under)}`)),
      svg("line", { x1: X(0), x2: X(0), y1: y - 3, y2: y + 21, stroke: "var(--ink)", "stroke-width": 1.2 }),
      svg("rect", { class: "bar-of-change", "data-name": column.name, x: Math.min(X(0), end), y, width: Math.max(Math.abs(end - X(0)), 1), height: 18,
        fill: better ? colour : "var(--paper)", stroke: colour, "stroke-width": 1.5, ...(better ? {} : { "stroke-dasharray": "4 3" }) }),
      ...(under.length ? [svg("line", { class: "laws", x1: ends[0], x2: ends[1], y1: middle, y2: middle, stroke: "var(--ink)", "stroke-width": 1 }),
        ...under.map((u) => svg("path", { class: "law", d: u.share > high ? `M${X(high) - 4} ${middle - 4}l6 4l-6 4z` : `M${X(u.share) - 2.8} ${middle}a2.8 2.8 0 1 1 0 .01z`, fill: "var(--paper)", stroke: "var(--ink)" }, svg("title", {}, `${u.law}: ${change(1 + u.share, 1, {})}`)))] : []),
      ...(Number.isFinite(error) ? [svg("path", { class: "error", d: `M${X(share - error)} ${y - 3}v24M${X(share + error)} ${y - 3}v24M${X(share - error)} ${middle}H${X(share + error)}`, stroke: "var(--ink)", "stroke-width": 1.5 })] : []),
      svg("text", { x: past + 8 * out, y: middle + 4, "text-anchor": out < 0 ? "end" : "start", style: "font-weight:600" }, change(value, base, column)));
  });
  return made;
}

/** What was sought against the flat foot, with its range under other laws: J_W, or up to three objectives. */
function gain(i) {
  const sought = data.objectives?.length < 4 ? data.objectives : ["efficiency"], laws = underLaws(i, sought[0]).length;
  const told = sought.flatMap((name) => {
    const c = data.columns.findIndex((column) => column.name === name), value = valueOf(i, c), base = entry.flat?.[name];
    if (c < 0 || !Number.isFinite(value / base)) return [];
    const under = underLaws(i, name), ends = range(under.map((u) => 1 + u.share), 0), j = name === "efficiency";
    const between = j ? ends.map((v) => v.toFixed(2)).join(" to ") : ends.map((v) => change(v, 1, {})).join(" to ");
    return [`${j ? `J_W ${(value / base).toFixed(2)} times the flat foot's` : `${data.columns[c].title} ${change(value, base, data.columns[c])}`}${under.length ? ` (${between} under ${laws} other law${laws > 1 ? "s" : ""} of sand${doubtful(value / base - 1, under)})` : ""}`];
  });
  return told.length ? el("p", { class: "gain" }, el("strong", {}, told.join("; "))) : "";
}

/** All values of a design, with their errors, beside those of the flat foot. */
function valueTable(i, flat = entry.flat) {
  const errors = data.columns.some(({ name }) => Number.isFinite(errorOf(i, name)));
  return table(["", "this sole", ...(errors ? ["error"] : []), ...(flat ? ["flat sole", "change"] : [])],
    data.columns.map((column, c) => {
      const value = valueOf(i, c), base = flat?.[column.name];
      return [`${column.title}${column.unit ? `, ${column.unit}` : ""} (${column.maximise ? "max" : "min"})`, number(value),
        ...(errors ? [percent(errorOf(i, column.name) / Math.abs(value), value)] : []), ...(flat ? [number(base), change(value, base, column)] : [])];
    }));
}

/** The changes of a design against the flat foot, a row for each other law of sand. */
function lawTable(i) {
  const shares = data.columns.map(({ name }) => new Map(underLaws(i, name).map(({ law, share }) => [law, share])));
  return table(["change under", ...data.columns.map(({ title }) => title)],
    [...shares[0].keys()].map((law) => [law, ...data.columns.map((column, c) => change(1 + (shares[c].get(law) ?? NaN), 1, column))]));
}

/** The answer: the chosen sole beside the flat one, what it changes, its step, its files. */
function designSection() {
  const drawing = el("div", { class: "plot" }), answer = el("div", {}), numbers = el("div", {}), words = el("p", { id: "design-words", class: "note" });
  const title = el("h2", { id: "design-title" }), step = data.walks && gait?.strikes.length ? stepLoop() : null;
  let chosen = data.best;
  const tools = drawTools(drawing, () => chosen, (i) => show(i), (i) => choose(i));
  const buttons = Object.entries(FORMATS).map(([ending, { text, type }]) => el("button", {
    type: "button", id: `download-${ending}`,
    click: () => download(`sole-${label(chosen).replace(/[^\w.-]+/g, "-")}.${ending}`, text({ points: sole(chosen), top: own("top", chosen) }), type),
  }, ending.toUpperCase()));
  const stl = el("a", { id: "stl" }, "STL"), back = el("button", { type: "button", id: "back", click: () => choose(data.best) }, `Back to the ${BEST}`);
  const exact = folded("These numbers as a table", () => el("div", {}, valueTable(chosen), data.objectives ? lawTable(chosen) : ""));
  const section = el("section", { id: "design" }, title,
    el("div", { class: "grid wide" },
      el("div", {}, el("figure", {}, drawing), words, step?.figure ?? null),
      el("div", {}, answer, el("div", { class: "bar" }, "Files of this sole:", stl, ...buttons, back), numbers, exact, tools.section)));
  function toPrint() {
    if (typeof data.printed !== "number") return "";
    const { worst_loss: loss, worst_loss_of_best: other } = entry.to_print, own = data.printed === data.best;
    const here = own || chosen === data.printed, show = el("button", { type: "button", id: "show-printed", click: () => choose(data.printed) }, "Show it");
    return chosen === data.best || here ? el("p", { id: "to-print" }, el("strong", {}, here ? "Print this sole." : "Print the robust sole"), ...(here ? [] : [" (", el("a", { href: "to_print.stl" }, "STL"), ")."]),
      ` It loses at most ${percent(loss)} to the best one known under each law of sand`, own ? ". " : `; the best one by the run's own law loses ${percent(other)}. `, here ? "" : show) : "";
  }
  function redraw() {
    const points = sole(chosen), k = heights(chosen), best = chosen === data.best, flat = data.walks && flatWalk(), same = flat && isFlat(points);
    title.textContent = COUNT > 1 ? `The ${best ? "" : "chosen "}sole: ${label(chosen)}` : `The sole: ${label(chosen)}`;
    back.hidden = best || data.runs !== undefined;
    stl.hidden = data.runs !== undefined || !(best || chosen === data.printed);
    stl.href = best ? "contour.stl" : "to_print.stl";
    words.textContent = [k ? `k = [${k.join(",")}]` : "", `hollow ${(MM * hollow(points)).toFixed(1)} mm`, generation && chosen !== DRAWN ? `generation ${generation[chosen]}` : "",
      feasible[chosen] ? "" : `infeasible: ${reason(chosen)}`, chosen === DRAWN && feasible[chosen] ? sketch.reason : "", same ? "this is the flat foot" : flat ? `dashed: the flat foot${flat.reason ? `, whose walk failed: ${flat.reason}` : ""}` : ""].filter(Boolean).join("; ");
    const focus = document.activeElement?.dataset?.waypoint;
    drawing.replaceChildren(soleDrawing(points, { width: widthOf(drawing), k, top: own("top", chosen), colour: data.runs ? COLOURS[chosen % COLOURS.length] : colourOf(chosen),
      ghost: same ? null : flat?.points }));
    if (focus) drawing.querySelector(`[data-waypoint="${focus}"]`)?.focus({ preventScroll: true });
    const finer = fineOf(chosen), accuracy = data.runs ? "" : `Evaluated at accuracy ${(finer ? entry.accuracy : entry.search_accuracy ?? entry.accuracy)?.name}. `;
    const compared = entry.flat && feasible[chosen] && !flat?.reason && !same;
    exact.hidden = !compared;
    answer.replaceChildren(...(compared ? [gain(chosen), toPrint()] : []));
    numbers.replaceChildren(...(compared
      ? [bars(chosen, Math.max(widthOf(numbers), 250)), el("p", { class: "note" }, "Solid: better than the flat foot; dashed: worse. Error ticks: the numerical error.",
        underLaws(chosen, data.columns[0].name).length ? ` Circles: the result under other sand laws, which the table below names${best || chosen === data.printed ? "" : `, those that this page simulates (${P.others.map(({ law }) => law).join(", ")})`}.` : "", ` ${accuracy}`, gain(chosen) && "J_W, which the paper minimises: −distance × mean height / (work × peak power × speed loss).", OF_THE_LAW)]
      : [scrolled("Values", valueTable(chosen, same ? null : entry.flat)), el("p", { class: "note" }, accuracy, OF_THE_LAW)]));
    exact.refresh();
    warn(chosen);
    tools.redraw();
    step?.redraw();
  }
  function show(i) {
    chosen = i;
    if (sketch) compareWith(i);
    step?.take(i);
    redraw();
    say(`Chosen: ${label(i)}`);
  }
  return { section, redraw, show };
}

/** The chosen design in little, beside the scatter. */
function glance() {
  const section = el("section", { id: "glance", "aria-label": "The chosen design" });
  let chosen = data.best;
  const show = (i = chosen, keep = true) => {
    if (keep) chosen = i;
    section.replaceChildren(el("h3", {}, label(i)), entry.flat ? gain(i) : "", el("figure", {}, soleDrawing(sole(i), { width: widthOf(section), height: 90, plain: true,
      top: own("top", i), colour: colourOf(i), ghost: data.walks && flatWalk()?.points })),
    i === data.best ? "" : scrolled("Values of the chosen design", valueTable(i)),
    heights(i) ? el("p", { class: "note" }, `k = [${heights(i).join(",")}]`) : "",
    el("p", {}, el("a", { href: "#design" }, "the whole answer"), ", ", el("a", { href: "#walk" }, "its walk"), ...(i === data.best ? [", ", el("a", { href: "contour.stl" }, "its STL")] : [])));
  };
  return { section, show };
}

/** The search: its convergence. */
function searchSection() {
  const holder = el("div", { class: "plot" }), several = data.objectives.length > 1;
  const looks = { best: { stroke: "var(--best)", "stroke-width": 2.2 }, median: { stroke: "var(--flat)", "stroke-dasharray": "6 4" } };
  const draw = () => {
    const shown = several ? (v) => v ?? NaN : (v) => ranking.show(v ?? NaN);
    const rows = data.history, at = rows.map((r) => r.evaluations), bests = rows.map((r) => shown(r.best)), last = bests.at(-1);
    const steps = (all) => all.flatMap((v, i) => (i ? [all[i - 1], v] : [v])), ends = at.flatMap((v, i) => (i ? [v, v] : [v]));
    const a = plot(holder, { x: [0, at.at(-1)], xlabel: "evaluations", height: 260, left: 84, label: "Convergence of the search; the table below has the numbers",
      ylabel: several ? `hypervolume (1: box of the first generation)` : `${named(ranking)}: best so far` }, [
      { x: at, y: rows.map((r) => shown(r.median)), ...looks.median },
      { x: ends, y: steps(bests), ...looks.best },
    ], (x) => {
      const r = rows.findLast((row) => row.evaluations <= x + 0.01 * at.at(-1));
      return r ? `${r.evaluations} evaluations: ${number(shown(r.best))}${Number.isFinite(r.median ?? NaN) ? `, median ${number(shown(r.median))}` : ""}` : null;
    });
    if (Number.isFinite(last)) a.svg.append(svg("circle", { cx: a.X(at.at(-1)), cy: a.Y(last), r: 3.5, fill: "var(--best)" }));
  };
  const section = el("section", { id: "search" }, el("h2", {}, "The search"),
    several ? null : legend([{ name: `best so far, at accuracy ${entry.search_accuracy?.name ?? entry.accuracy?.name}`, ...looks.best }, { name: `median of the generation${entry.solver?.name === "memetic" ? ", low after a restart" : ""}`, ...looks.median }]),
    el("figure", {}, holder),
    folded("The search as a table", () => table(["evaluations", ...(several ? ["hypervolume", "front"] : [`best ${named(ranking)}`, "median"])],
      data.history.map((r) => [r.evaluations, number(several ? r.best : ranking.show(r.best)), several ? r.front : number(ranking.show(r.median))].map(String)))));
  return { section, draw };
}

/** A text (or an element) that may run over several lines of a table; a path breaks after a slash. */
const words = (text) => el("span", { class: "words" },
  ...(typeof text === "string" ? text.split(/(?<=\/)/).flatMap((part, i) => (i ? [el("wbr"), part] : [part])) : [text]));

/** Runs side by side, such as the jobs of a multirun: a table with their soles. */
function runsSection(choose) {
  const differ = data.columns, ranged = data.runs.some(({ laws }) => laws);
  return el("section", { id: "runs" }, el("h2", {}, "The runs"),
    scrolled("The runs", table(["run", "settings", "sole", ...differ.map(named), ...(ranged ? ["J_W under other laws"] : []), "hollow (mm)"],
      data.runs.map(({ name, link, settings, note, laws, design: i }) => [
        link ? el("a", { href: link }, name) : name,
        el("div", {}, words(settings), note ? el("div", { class: "words warning" }, note) : ""),
        i === null ? "" : el("button", { type: "button", "aria-label": `Choose the sole of ${name}`, click: () => choose(i) },
          soleDrawing(sole(i), { width: 120, height: 36, plain: true, colour: COLOURS[i % COLOURS.length] })),
        ...differ.map((_, c) => (i === null ? "–" : number(values[i * WIDTH + c]))),
        ...(ranged ? [laws || "–"] : []), i === null ? "–" : (MM * hollow(sole(i))).toFixed(1)]))),
    ...(data.runs.some((run) => run.link) ? [el("p", { class: "note" }, "A run's link opens its own page.")] : []));
}

/** Traces of the runs' walks over time, a colour and a dash for each run. */
function tracesSection() {
  const runs = data.traces.map((raw) => ({ label: data.designs.labels[raw.design], t: unpack(raw.t),
    ...Object.fromEntries(["height", "speed", "power", "work"].map((name) => [name, unpack(raw[name])])), looks: runLine(raw.design) }));
  const titles = { height: "height of the COM (m)", speed: "forward speed (m/s)", power: "power of the sand, both feet (W)", work: "work of the sand, both feet (J)" };
  const plots = Object.keys(titles).map((name) => [name, el("div", { class: "plot" })]);
  const draw = () => plots.forEach(([name, holder]) => plot(holder, { x: range(runs.flatMap((run) => [0, run.t.at(-1) ?? 0]), 0), xlabel: "time (s)", ylabel: titles[name],
    height: 230, label: `${titles[name]} over time, of every run` }, runs.map((run) => ({ x: run.t, y: run[name], "stroke-width": 1.5, ...run.looks })),
    (t) => [`${t.toFixed(2)} s`, ...runs.filter((run) => t <= run.t.at(-1)).map((run) => `${run.label}: ${number(at(run, name, 1, t)[0])}`)].join("\n")));
  const section = el("section", { id: "traces" }, el("h2", {}, "Their walks"),
    legend(runs.map((run) => ({ name: run.label, ...run.looks }))),
    el("div", { class: "grid plots", style: "--columns:2" }, ...plots.map(([, holder]) => el("figure", {}, holder))));
  return { section, draw };
}

/** A study of many walks: its figures and its tables, as they are on paper and on the terminal. */
function studySections() {
  const figures = data.figures.map(({ source, width, says }) =>
    el("figure", { class: "printed", tabindex: "0" }, el("img", { src: source, width, alt: says }), el("figcaption", {}, says)));
  const tables = data.tables.flatMap(({ title, head, words: wordy, rows, bad, links, caption }) => {
    const shown = (cell, r, c) => links[r][c] ? el("a", { href: encodeURIComponent(cell) }, cell) : bad[r][c] ? el("strong", { class: "bad" }, cell) : cell;
    const made = table(head.map((text, c) => (wordy[c] ? words(text) : text)),
      rows.map((row, r) => row.map((cell, c) => (wordy[c] ? words(shown(cell, r, c)) : shown(cell, r, c)))));
    return [title ? el("h3", {}, title) : null, scrolled(title ?? "A table", made), caption ? el("p", { class: "note" }, caption) : null];
  });
  return [
    ...(tables.length ? [el("section", { id: "tables" }, el("h2", {}, "Results"), ...tables)] : []),
    ...(figures.length ? [el("section", { id: "figures" }, el("h2", {}, "Figures"), ...figures)] : []),
  ];
}

/** Settings, seed, versions, errors, time: all that reproduces the page. */
function footer() {
  const facts = [
    ["seed", entry.seed ?? undefined], ["wall time", entry.wall_time_s === undefined ? undefined : `${entry.wall_time_s.toFixed(1)} s`],
    ["accuracy", entry.accuracy?.name],
    ...(data.walks ? data.headline.slice(1).map((text, i) => [i ? "then" : "search", text]) : []),
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

const chosen = []; // functions that show the chosen design
function choose(i) {
  chosen.forEach((show) => show(i));
  remember("sole", i === data.best ? "" : i === DRAWN ? [sketch.zeta, sketch.mass, ...(heights(i) ?? [])].join("_") : String(numbers ? numbers[i] : i));
}
/** Choose the sole of the address: a design, or one that was drawn. */
function recall() {
  const [zeta, mass, ...k] = (address.get("sole") ?? "").split("_").map(Number), known = mass === undefined && address.has("sole") ? (numbers ? numbers.indexOf(zeta) : zeta) : -1;
  const drawn = sketch && zeta > 0 && mass > 0 && (kOf ? k.length === space.n && k.every((v) => Number.isInteger(v) && v > 0 && v <= space.K) : !k.length);
  if (drawn) takeSketch({ k, zeta, mass });
  choose(drawn ? DRAWN : known in feasible && known < COUNT ? known : data.best);
}

function build() {
  const main = document.getElementById("main");
  document.getElementById("header").append(...headline());
  const design = designSection(), walks = data.walks && walkSection(), small = COUNT > 1 && !data.runs ? glance() : null;
  const explore = COUNT > 1 ? explorer(choose, small?.section ?? design.section, (i) => small?.show(i, false)) : null;
  const found = data.history?.length ? searchSection() : null, traces = data.traces?.length ? tracesSection() : null;
  if (data.figures) main.append(...studySections());
  if (data.runs) main.append(runsSection(choose));
  const answer = [COUNT && (small || COUNT === 1) ? design.section : null, walks?.section];
  main.append(...[...(front.size ? [explore?.section, ...answer] : [...answer, explore?.section]), found?.section, traces?.section].filter(Boolean));
  for (const select of document.querySelectorAll("select[id]")) // as the address has it
    if ([...select.options].some(({ value }) => value === address.get(select.id))) select.value = address.get(select.id);
  if (data.entry) document.getElementById("footer").append(...footer());
  chosen.push(...(COUNT ? [design.show] : []), ...[walks?.show, small?.show, explore?.mark].filter(Boolean));
  if (traces) drawn(traces.draw);
  if (found) drawn(() => found.draw());
  if (explore) { explore.filter(); drawings.push(explore.redraw); }
  if (COUNT) { recall(); drawings.push(design.redraw); }
  if (walks) drawings.push(walks.redraw);
  if (small) drawings.push(() => small.show());
}
build();
if (sketch) requestAnimationFrame(() => requestAnimationFrame(() => document.body.classList.add("built"))); // sections have their sizes then
