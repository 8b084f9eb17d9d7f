// Many designs: parallel coordinates and a scatter that filter each other, and a table of the same.

const values = unpack(data.designs.values), WIDTH = data.columns.length, COUNT = values.length / WIDTH;
const generation = data.designs.generation && unpack(data.designs.generation);
const feasible = data.designs.feasible.data ? unpack(data.designs.feasible) : data.designs.feasible;
const reason = (i) => data.designs.reasons[data.designs.reason ? reasonCodes[i] : i];
const reasonCodes = data.designs.reason && unpack(data.designs.reason);
const front = new Set(data.front ?? []);
const MOST = 1000; // parallel ones of a colour at most

/** What designs can be filtered and drawn by: the recorded values, and when a search came to them. */
const COLUMNS = data.columns.map((column, c) => ({ ...column, of: (i) => values[i * WIDTH + c] }));
if (generation) COLUMNS.push({ name: "generation", title: "generation", unit: "", maximise: false, of: (i) => generation[i] });
const columnOf = (name) => COLUMNS.find((c) => c.name === name);
const guide = columnOf(data.guide ?? "efficiency") ?? COLUMNS[0];

/** A design's number is its row in designs.csv, from 0. */
const numbers = data.designs.rows && unpack(data.designs.rows);
const BEST = { efficiency: "best in J_W", weights: "best by weights", limits: "best within limits" }[data.choice] ?? data.choice ?? "best";
const label = (i) => data.designs.labels ? data.designs.labels[i] : `design ${numbers[i]}${i === data.best ? `, the ${BEST}` : ""}`;

/** A limit as short as it is shown. */
const tidy = (v) => (Number.isFinite(v) ? +v.toPrecision(5) : v);

/** The explorer; `choose(i)` is called when a design is picked, `beside` is shown beside the scatter. */
function explorer(choose, beside) {
  const all = Array.from({ length: COUNT }, (_, i) => i).filter((i) => feasible[i]);
  const state = { limits: new Map(), chosen: data.best, shown: [], passing: [] };
  const parallel = COLUMNS.filter((c) => c.name !== "generation");
  const wide = el("div", { class: "plot brush", id: "parallel", style: `min-width:${110 * parallel.length}px` }); // names beside each other
  const flat = el("div", { class: "plot brush", id: "scatter" });
  const count = el("p", { id: "count", role: "status" });
  const choice = (id, name) => {
    const select = el("select", { id, change: () => redraw() },
      ...COLUMNS.map((c) => el("option", { value: c.name }, named(c))));
    select.value = name;
    return select;
  };
  const several = data.objectives?.length > 1 ? data.objectives : ["work", "peak_power"];
  const across = choice("scatter-x", columnOf(several[0]) ? several[0] : COLUMNS[0].name);
  const up = choice("scatter-y", columnOf(several[1]) ? several[1] : COLUMNS.at(-1).name);
  const walked = new Set((data.walks ?? []).map((walk) => walk.design));
  const SETS = {
    all: { title: "all feasible ones", has: () => true },
    front: { title: "the Pareto front", has: (i) => front.has(i) },
    walked: { title: "those whose walk is on this page", has: (i) => walked.has(i) },
  };
  const which = el("select", { id: "which", change: () => filter() }, ...Object.entries(SETS)
    .filter(([name]) => (name !== "front" || front.size) && (name !== "walked" || walked.size))
    .map(([value, { title }]) => el("option", { value }, title)));
  if (front.size) which.value = "front";
  const clear = el("button", { type: "button", id: "clear", click: () => { state.limits.clear(); filter(); } }, "Clear limits");
  const fields = new Map(COLUMNS.map((c) => [c.name, [0, 1].map((end) => el("input", {
    type: "number", step: "any", "aria-label": `${end ? "largest" : "smallest"} ${named(c)}`,
    change: () => setLimit(c.name, ...fields.get(c.name).map((field, e) => field.value === "" ? [-Infinity, Infinity][e] : +field.value)),
  }))]));
  const rows = folded(`The designs within the limits as a table (the first 50, by ${named(guide)})`, () => {
    const best = state.passing.slice().sort((a, b) => (guide.of(a) - guide.of(b)) * (guide.maximise ? -1 : 1));
    return table(["", ...COLUMNS.map(named), ...(kOf ? ["k"] : [])], best.slice(0, 50).map((i) => [
      el("button", { type: "button", click: () => pick(i) }, data.designs.labels ? label(i) : String(numbers[i])),
      ...COLUMNS.map((c) => number(c.of(i))), ...(kOf ? [heights(i).join(" ")] : [])]));
  });
  const section = el("section", { id: "explore" },
    data.jobs ? el("h2", {}, "Their best designs") : null,
    el("div", { class: "grid wide" }, beside,
      el("figure", {},
        el("div", { class: "bar" }, el("label", {}, "across", across), el("label", {}, "up", up)), flat)),
    el("p", { class: "note" }, "Drag along an axis, or across the scatter, to set limits: both then show what is within them. ",
      "Click a line or a point to choose that design. Better is up on every axis of the parallel coordinates.",
      numbers ? " A design's number is its row in designs.csv, from 0." : "",
      COUNT > MOST ? ` Of more than ${MOST} lines an even selection is drawn.` : ""),
    el("div", { class: "bar" }, data.jobs ? null : el("label", {}, "designs", which), clear, count),
    el("figure", { class: "scroll" }, wide),
    el("details", { id: "limits" }, el("summary", {}, "The limits as numbers"),
      table(["", "from", "to"], COLUMNS.map((c) => [named(c), ...fields.get(c.name)]))),
    rows);

  const within = (i) => {
    for (const [name, [low, high]] of state.limits) {
      const v = columnOf(name).of(i);
      if (!(v >= low && v <= high)) return false;
    }
    return true;
  };
  function setLimit(name, low, high) {
    if (low === -Infinity && high === Infinity) state.limits.delete(name);
    else state.limits.set(name, [Math.min(low, high), Math.max(low, high)]);
    filter();
  }
  function filter() {
    state.shown = all.filter(SETS[which.value].has);
    state.passing = state.shown.filter(within);
    count.textContent = `${state.passing.length} of ${state.shown.length} designs within the limits`;
    for (const [name, pair] of fields) pair.forEach((field, end) => {
      const limit = state.limits.get(name)?.[end] ?? NaN;
      field.value = Number.isFinite(limit) ? String(limit) : "";
    });
    rows.refresh();
    redraw();
  }
  function pick(i) {
    state.chosen = i;
    redraw();
    choose(i);
  }
  const colour = (i) => data.jobs ? COLOURS[i % COLOURS.length] : BLUE;

  /** A canvas under a drawing, for what is too much for elements. */
  function canvas(holder, a) {
    const made = el("canvas", { "aria-hidden": "true", width: a.width * devicePixelRatio, height: a.height * devicePixelRatio });
    holder.prepend(made);
    const pen = made.getContext("2d");
    pen.scale(devicePixelRatio, devicePixelRatio);
    return pen;
  }
  /** Where the pointer is in a drawing, pixels. */
  const where = (a, event) => {
    const box = a.svg.getBoundingClientRect();
    return [((event.clientX - box.left) * a.width) / box.width, ((event.clientY - box.top) * a.height) / box.height];
  };
  /** Tell a click from a drag. */
  function gestures(a, { drag, click }) {
    let from = null, box = null;
    a.svg.addEventListener("pointerdown", (event) => {
      from = where(a, event);
      a.svg.setPointerCapture(event.pointerId);
    });
    a.svg.addEventListener("pointermove", (event) => {
      if (!from) return;
      box?.remove();
      box = drag(from, where(a, event), false);
      if (box) a.svg.append(box);
    });
    a.svg.addEventListener("pointerup", (event) => {
      if (!from) return;
      const start = from, end = where(a, event);
      from = null;
      box?.remove();
      if (Math.hypot(end[0] - start[0], end[1] - start[1]) < 4) click(end); else drag(start, end, true);
    });
    a.svg.addEventListener("pointercancel", () => { from = null; box?.remove(); });
  }
  const rectangle = (x0, y0, x1, y1) => svg("rect", { class: "brush", x: Math.min(x0, x1), y: Math.min(y0, y1),
    width: Math.abs(x1 - x0), height: Math.abs(y1 - y0) });

  function redraw() {
    drawParallel();
    drawScatter();
  }

  function drawParallel() {
    const width = Math.max(wide.clientWidth, 200), height = 300, top = 46, bottom = height - 26;
    const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img",
      "aria-label": `Parallel coordinates of ${state.shown.length} designs; the limits beside the scatter and the table below do the same` });
    const a = { svg: drawing, width, height };
    wide.replaceChildren(drawing);
    const pen = canvas(wide, a);
    const X = (c) => 70 + (c * (width - 140)) / Math.max(parallel.length - 1, 1);
    const ends = parallel.map((c) => {
      const [low, high] = range(state.shown.map(c.of), 0);
      return c.maximise ? [low, high] : [high, low]; // worst, best
    });
    const Y = (c, v) => { const [worst, best] = ends[c]; return best === worst ? (top + bottom) / 2 : bottom + ((v - worst) / (best - worst)) * (top - bottom); };
    const fromY = (c, y) => { const [worst, best] = ends[c]; return worst + ((y - bottom) / (top - bottom)) * (best - worst); };
    const line = (i, style, thick) => {
      pen.beginPath();
      parallel.forEach((c, j) => pen.lineTo(X(j), Y(j, c.of(i))));
      pen.strokeStyle = style;
      pen.lineWidth = thick;
      pen.stroke();
    };
    const lines = (all, style, thick) => { // more would be a solid block, or too faint to be seen
      const some = all.filter((_, n) => n % Math.ceil(all.length / MOST) === 0);
      pen.globalAlpha = Math.max(0.03, Math.min(0.8, 25 / some.length));
      for (const i of some) line(i, style(i), thick);
    };
    const passing = new Set(state.passing);
    lines(state.shown.filter((i) => !passing.has(i)), () => "#aaa", 0.7);
    lines(state.passing, colour, data.jobs ? 1.8 : 0.9);
    pen.globalAlpha = 1;
    if (feasible[state.chosen]) line(state.chosen, data.jobs ? colour(state.chosen) : GREEN, data.jobs ? 4 : 2.5);
    parallel.forEach((c, j) => {
      const [worst, best] = ends[j];
      const [name, unit] = [c.title, c.unit];
      drawing.append(
        svg("line", { class: "axis", x1: X(j), x2: X(j), y1: top, y2: bottom, "data-axis": c.name }),
        svg("text", { x: X(j), y: 14, "text-anchor": "middle", style: "font-weight:600" }, name + (unit ? ` (${unit})` : "")),
        svg("text", { x: X(j), y: top - 8, "text-anchor": "middle" }, number(best)),
        svg("text", { x: X(j), y: bottom + 16, "text-anchor": "middle" }, number(worst)));
      const limit = state.limits.get(c.name);
      if (limit) {
        const [y0, y1] = limit.map((v) => Math.min(Math.max(Y(j, v), top), bottom));
        drawing.append(rectangle(X(j) - 9, y0, X(j) + 9, y1));
      }
    });
    const near = (x) => parallel.findIndex((_, j) => Math.abs(X(j) - x) < 20);
    gestures(a, {
      drag: ([x0, y0], [, y1], done) => {
        const j = near(x0);
        if (j < 0) return null;
        // beyond the end of an axis there is no limit
        const end = (y) => (y < top ? (parallel[j].maximise ? Infinity : -Infinity) : y > bottom ? (parallel[j].maximise ? -Infinity : Infinity) : fromY(j, y));
        if (done) setLimit(parallel[j].name, tidy(end(y0)), tidy(end(y1)));
        return rectangle(X(j) - 9, y0, X(j) + 9, y1);
      },
      click: ([x, y]) => {
        const j = near(x);
        if (j >= 0 && state.limits.has(parallel[j].name)) { setLimit(parallel[j].name, -Infinity, Infinity); return; }
        let k = 0;
        while (k < parallel.length - 2 && X(k + 1) < x) k++;
        const part = parallel.length > 1 ? Math.min(Math.max((x - X(k)) / (X(k + 1) - X(k)), 0), 1) : 0;
        const next = Math.min(k + 1, parallel.length - 1);
        nearest((i) => Math.abs(Y(k, parallel[k].of(i)) * (1 - part) + Y(next, parallel[next].of(i)) * part - y), 12);
      },
    });
  }

  /** Each job's name beside its point, moved to the middle from that of a neighbour where they would cover each other. */
  function nameJobs(a, place) {
    const taken = [];
    for (const i of state.shown) {
      let [x, y] = place(i);
      const step = y > a.height / 2 ? -14 : 14;
      while (taken.some(([u, v]) => Math.abs(u - x) < 60 && Math.abs(v - y) < 14)) y += step;
      taken.push([x, y]);
      a.svg.append(svg("text", { class: "halo", x: x + 10, y: y + 4 }, label(i)));
    }
  }

  /** Pick the design that a measure of distance in pixels calls the nearest, if it is near. */
  function nearest(distance, most) {
    let found = -1, least = most;
    for (const i of state.passing) {
      const far = distance(i);
      if (far < least) { least = far; found = i; }
    }
    if (found >= 0) pick(found);
  }

  function drawScatter() {
    const cx = columnOf(across.value), cy = columnOf(up.value);
    const a = axes(flat, { x: range(state.shown.map(cx.of)), y: range(state.shown.map(cy.of)),
      xlabel: named(cx), ylabel: named(cy), height: 400, left: 72,
      label: `Scatter of ${state.shown.length} designs: ${named(cy)} over ${named(cx)}` });
    const pen = canvas(flat, a);
    const dot = (i, style, radius) => {
      pen.beginPath();
      pen.arc(a.X(cx.of(i)), a.Y(cy.of(i)), radius, 0, 7);
      pen.fillStyle = style;
      pen.fill();
    };
    const passing = new Set(state.passing);
    pen.globalAlpha = 0.35;
    for (const i of state.shown) if (!passing.has(i)) dot(i, "#b5b5b5", 1.8);
    pen.globalAlpha = data.jobs ? 1 : state.passing.length > 2000 ? 0.35 : 0.65;
    for (const i of state.passing) dot(i, colour(i), data.jobs ? 5 : 2.5);
    const mark = (i, text, attributes) => Number.isFinite(cx.of(i)) && Number.isFinite(cy.of(i)) && a.svg.append(
      svg("circle", { cx: a.X(cx.of(i)), cy: a.Y(cy.of(i)), r: 6, fill: "none", "stroke-width": 2.5, ...attributes }),
      svg("text", { class: "halo", x: a.X(cx.of(i)) + 10, y: a.Y(cy.of(i)) - 8 }, text));
    if (data.jobs) nameJobs(a, (i) => [a.X(cx.of(i)), a.Y(cy.of(i))]);
    else if (state.chosen !== data.best) mark(data.best, BEST, { stroke: "#1a1a1a", "stroke-width": 1.5 });
    if (feasible[state.chosen]) mark(state.chosen, data.jobs ? "" : state.chosen === data.best ? `${BEST}, chosen` : "chosen", { stroke: data.jobs ? "#1a1a1a" : GREEN });
    const limits = [cx, cy].map((c) => state.limits.get(c.name));
    if (limits.some(Boolean)) {
      const clip = (v, low, high) => Math.min(Math.max(v, low), high), b = a.inside;
      const [x0, x1] = (limits[0] ?? [-Infinity, Infinity]).map((v) => clip(a.X(v), b.left, b.right));
      const [y0, y1] = (limits[1] ?? [-Infinity, Infinity]).map((v) => clip(a.Y(v), b.top, b.bottom));
      a.svg.append(rectangle(x0, y0, x1, y1));
      a.svg.lastChild.style.fillOpacity = 0.1; // the points are seen through it
    }
    gestures(a, {
      drag: ([x0, y0], [x1, y1], done) => {
        if (done) {
          state.limits.set(cx.name, [x0, x1].sort((u, v) => u - v).map(a.fromX).map(tidy));
          setLimit(cy.name, tidy(a.fromY(y0)), tidy(a.fromY(y1)));
        }
        return rectangle(x0, y0, x1, y1);
      },
      click: ([x, y]) => nearest((i) => Math.hypot(a.X(cx.of(i)) - x, a.Y(cy.of(i)) - y), 12),
    });
  }
  section.addEventListener("keydown", (event) => event.key === "Escape" && clear.click());
  return { section, filter, redraw, mark: (i) => { state.chosen = i; redraw(); } };
}
