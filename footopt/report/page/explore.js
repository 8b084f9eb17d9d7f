// Many designs: parallel coordinates and a scatter that filter each other, and a table of the same.

/** A limit as short as it is shown. */
const rounded = (v) => (Number.isFinite(v) ? +v.toPrecision(5) : v);

/** The explorer; `choose(i)` takes the design that is picked, `glimpse(i)` that under the pointer; `beside` is beside the scatter. */
function explorer(choose, beside, glimpse) {
  let order = COLUMNS.filter((c) => !c.variable);
  const every = Array.from({ length: COUNT }, (_, i) => i), passes = new Uint8Array(COUNT), ends = new Map();
  /** The smallest and the largest of the designs that are shown, and of the flat foot. */
  const endsOf = (c) => ends.get(c) ?? ends.set(c, range([...windowOf(c), data.runs ? NaN : c.flat], 0)).get(c);
  /** The values between which a figure is drawn. */
  function windowOf(c) {
    if (zoom.value === "limits" && state.passing.length) return state.passing.map(c.of);
    const all = state.shown.map(c.of);
    if (zoom.value !== "most") return all;
    const sorted = Float64Array.from(all).sort(), at = (share) => sorted[Math.round(share * (sorted.length - 1))];
    return [at(0.025), at(0.975), ...[data.best, state.chosen].filter((i) => feasible[i]).map(c.of)];
  }
  const scaleOf = (c, room, count) => zoom.value === "quantiles" ? quantileScale([...state.shown.map(c.of), c.flat], count) : evenScale(range(endsOf(c), room), count);
  const state = { limits: new Map(), chosen: data.best, shown: [], passing: [], near: -1, sort: null, way: 1 };
  for (const part of address.get("limits")?.split(",") ?? []) {
    const [name, low, high] = part.split("~");
    if (columnOf(name) && +low <= +high) state.limits.set(name, [+low, +high]);
  }
  const wide = el("div", { class: "plot brush", id: "parallel" });
  const flat = el("div", { class: "plot brush", id: "scatter" });
  const count = el("p", { id: "count", role: "status" });
  const choice = (id, name, first = []) => {
    const select = el("select", { id, change: () => redraw() }, ...first, ...COLUMNS.map((c) => el("option", { value: c.name }, named(c))));
    select.value = name;
    return select;
  };
  const several = data.objectives?.length > 1 ? data.objectives : ["work", "peak_power"];
  const across = choice("scatter-x", columnOf(several[0]) ? several[0] : COLUMNS[0].name);
  const up = choice("scatter-y", columnOf(several[1]) ? several[1] : COLUMNS.at(-1).name);
  const shade = choice("shade", "", [el("option", { value: "" }, "nothing")]), scale = el("span", { class: "scale" });
  const SETS = {
    all: { title: "all feasible ones", has: () => true },
    front: { title: "the Pareto front", has: (i) => front.has(i) },
  };
  const which = el("select", { id: "which", change: () => filter() }, ...Object.entries(SETS)
    .filter(([name]) => name !== "front" || front.size)
    .map(([value, { title }]) => el("option", { value }, title)));
  if (front.size) which.value = "front";
  const zoom = el("select", { id: "zoom", change: () => { ends.clear(); redraw(); } },
    ...[["all", "all designs"], ["most", "95 % of them"], ["limits", "those within the limits"], ["quantiles", "quantiles"]].map(([value, text]) => el("option", { value }, text)));
  if (!front.size && COUNT > 100) zoom.value = "most";
  const save = el("button", { type: "button", id: "save", click: () => download("designs.csv", [["design", ...COLUMNS.map((c) => c.name === "efficiency" ? "J_W_of_flat" : c.name)],
    ...state.passing.map((i) => [data.designs.labels ? JSON.stringify(label(i)) : numbers[i], ...COLUMNS.map((c) => +c.of(i).toPrecision(7))])].map((row) => row.join(",") + "\n").join(""), "text/csv") }, "CSV of these");
  const clear = el("button", { type: "button", id: "clear", click: () => { state.limits.clear(); filter(); } }, "Clear limits");
  const fields = new Map(COLUMNS.map((c) => [c.name, [0, 1].map((end) => el("input", {
    type: "number", step: "any", "aria-label": `${end ? "largest" : "smallest"} ${named(c)}`,
    change: () => setLimit(c.name, ...fields.get(c.name).map((field, e) => field.value === "" ? [-Infinity, Infinity][e] : +field.value)),
  }))]));
  const rows = folded("The designs within the limits as a table (the first 50 in the order of a column)", () => {
    const told = COLUMNS.filter((c) => !/^k\d+$/.test(c.name)), { sort, way } = state;
    const heads = told.map((c) => el("button", { type: "button", "data-sort": c.name, click: () => {
      Object.assign(state, { sort: c, way: sort === c ? -way : c.maximise ? -1 : 1 }); // the best first
      rows.refresh();
      rows.querySelector(`[data-sort="${c.name}"]`).focus();
    } }, `${named(c)}${sort === c ? (way > 0 ? " ▲" : " ▼") : ""}`));
    const made = table(["", ...heads, ...(kOf ? ["k"] : [])], leaders(50, sort ? (i) => way * sort.of(i) : score).map((i) => [
      el("button", { type: "button", click: () => choose(i) }, data.designs.labels ? label(i) : String(numbers[i])),
      ...told.map((c) => number(c.of(i))), ...(kOf ? [heights(i).join(" ")] : [])]));
    heads.forEach((head, j) => head.closest("th")?.setAttribute("aria-sort", sort !== told[j] ? "none" : way > 0 ? "ascending" : "descending"));
    return made;
  });
  const axesList = el("div", { class: "bar", id: "axes-list" });
  const axesBox = el("details", { id: "axes" }, el("summary", {}, "Axes"), axesList);
  axesList.append(...COLUMNS.map((c) => el("label", {}, el("input", { type: "checkbox", checked: order.includes(c), "data-axis": c.name, change: () => {
    order = COLUMNS.filter((other) => (other === c) !== order.includes(other));
    drawParallel();
  } }), c.title)));
  const section = el("section", { id: "explore" },
    el("h2", {}, data.runs ? "Their best designs" : "The designs"),
    el("div", { class: "grid wide" }, beside,
      el("figure", {},
        el("div", { class: "bar" }, el("label", {}, "across", across), el("label", {}, "up", up)), flat)),
    el("p", { class: "note" }, "Drag along an axis, or across the scatter, to set limits: both then show what is within them. ",
      "Click a line or a point to choose that design. Better is up on every axis of an objective.", entry.search_accuracy ? ` Values are those of the search, at accuracy ${entry.search_accuracy.name}.` : "",
      numbers ? " A design's number is its row in designs.csv, from 0." : "",
      COUNT > MOST ? ` Of more than ${MOST} lines an even selection is drawn.` : "",
      front.size && entry.front_size > front.size ? ` Of the ${entry.front_size} designs on the front ${front.size} are here.` : ""),
    el("div", { class: "bar" }, which.length > 1 ? el("label", {}, "designs", which) : null, el("label", {}, "axes span", zoom), el("label", {}, "colour by", shade), scale, clear, save, count),
    data.runs ? legend(every.map((i) => ({ name: label(i), ...runLine(i) }))) : null,
    scrolled("Parallel axes", wide),
    axesBox,
    el("details", { id: "limits" }, el("summary", {}, "The limits as numbers"),
      table(["", "from", "to"], COLUMNS.map((c) => [named(c), ...fields.get(c.name)]))),
    rows);

  /** The cost of a design as the run chose: of several objectives the distance from the best of each, in parts of their range. */
  function score(i) {
    if (!(data.objectives?.length > 1) || data.choice === "efficiency") return (ranking.maximise ? -1 : 1) * ranking.of(i);
    return data.objectives.reduce((sum, name) => {
      const c = columnOf(name), [low, high] = rangeOf(c);
      return sum + (((c.maximise ? high - c.of(i) : c.of(i) - low) / (high - low || 1)) ** 2);
    }, 0);
  }
  const ranges = new Map(), rangeOf = (c) => ranges.get(c) ?? ranges.set(c, range(state.shown.map(c.of), 0)).get(c);
  /** The first designs within the limits, in the order of their costs. */
  function leaders(count, price = score) {
    const found = [];
    for (const i of state.passing) {
      const cost = price(i);
      if (found.length === count && !(cost < found.at(-1)[0])) continue;
      found.splice(found.findLastIndex(([other]) => !(other > cost)) + 1, 0, [cost, i]);
      found.length = Math.min(found.length, count);
    }
    return found.map(([, i]) => i);
  }
  function setLimit(name, low, high) {
    if (low === -Infinity && high === Infinity) state.limits.delete(name);
    else state.limits.set(name, [Math.min(low, high), Math.max(low, high)]);
    filter(true);
    const best = leaders(1)[0]; // what was brushed is shown by its best
    if (best !== undefined && !state.passing.includes(state.chosen)) choose(best);
  }
  /** Take what is within the limits, of the same designs as before or of those that are to be shown. */
  function filter(same = false) {
    if (!same) {
      const { has } = SETS[which.value];
      state.shown = every.filter((i) => feasible[i] && has(i));
      ranges.clear();
    }
    const limits = [...state.limits].map(([name, pair]) => [columnOf(name).of, ...pair]);
    state.passing = state.shown.filter((i) => limits.every(([of, low, high]) => of(i) >= low && of(i) <= high));
    passes.fill(0);
    for (const i of state.passing) passes[i] = 1;
    if (!same || zoom.value === "limits") ends.clear();
    remember("limits", [...state.limits].map(([name, pair]) => [name, ...pair].join("~")).join(","));
    count.textContent = `${state.passing.length} of ${state.shown.length} designs within the limits`;
    for (const [name, pair] of fields) pair.forEach((field, end) => {
      const limit = state.limits.get(name)?.[end] ?? NaN;
      field.value = Number.isFinite(limit) ? String(limit) : "";
    });
    rows.refresh();
    redraw();
  }
  /** Designs' colours: of their runs, or by the value that was chosen. */
  function colours() {
    const by = columnOf(shade.value), [low, high] = by ? range(state.shown.map(by.of), 0) : [0, 1], usual = ink("--designs");
    scale.replaceChildren(...(by ? [`${number(low)} `, el("span", { class: "gradient", style: `background:linear-gradient(90deg,${[0, 0.25, 0.5, 0.75, 1].map(ramp)})` }), ` ${number(high)}`] : []));
    if (by) return (i) => ramp((by.of(i) - low) / (high - low));
    return data.runs ? (i) => ink(runLine(i).stroke) : () => usual;
  }

  /** A canvas under a drawing, for what is too much for elements. */
  function canvas(holder, a) {
    const made = el("canvas", { "aria-hidden": "true", width: a.width * devicePixelRatio, height: a.height * devicePixelRatio });
    holder.prepend(made);
    const pen = made.getContext("2d");
    pen.scale(devicePixelRatio, devicePixelRatio);
    return pen;
  }
  function redraw() {
    drawParallel();
    drawScatter();
  }
  const overlays = new Map();
  /** Mark the best design, the chosen one and that under the pointer over a drawing, which is not drawn again for them. */
  function overlay(a, holder, marks) {
    const group = a.svg.appendChild(svg("g"));
    overlays.set(holder, () => group.replaceChildren(...[
      ...(data.runs || state.chosen === data.best ? [] : [[data.best, "var(--best)", 2.5, BEST]]),
      data.runs ? [state.chosen, COLOURS[state.chosen % COLOURS.length], 4, ""] : state.chosen === data.best ? [data.best, "var(--best)", 3, BEST] : [state.chosen, "var(--chosen)", 3, "chosen"],
      [state.near, "var(--ink)", 1.5, ""],
    ].flatMap(([i, ...more]) => (feasible[i] ? marks(i, ...more) : []))));
    overlays.get(holder)();
  }
  const mark = () => overlays.forEach((draw) => draw());

  function drawParallel() {
    wide.style.minWidth = `${96 * order.length}px`; // names beside each other
    const width = Math.max(wide.clientWidth, 200), height = 330, top = 56, bottom = height - 12, colour = colours();
    const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img",
      "aria-label": `Parallel coordinates of ${state.shown.length} designs; the limits beside the scatter and the table below do the same` });
    const a = { svg: drawing, width, height };
    wide.replaceChildren(drawing);
    const pen = canvas(wide, a);
    pen.rect(0, top - 3, width, bottom - top + 6); // what is beyond the zoom is not drawn
    pen.clip();
    const X = (c) => 70 + (c * (width - 140)) / Math.max(order.length - 1, 1);
    const scales = order.map((c) => scaleOf(c, 0, 5)), better = (c, share) => (order[c].maximise ? share : 1 - share); // the best at the top
    const Y = (c, v) => bottom + better(c, scales[c].to(v)) * (top - bottom);
    const fromY = (c, y) => scales[c].from(better(c, (y - bottom) / (top - bottom)));
    const line = (of) => path(order.map((c, j) => [X(j), Y(j, of(c))]));
    const lines = (all, style, thick) => { // more would be a solid block, or too faint to be seen
      const some = all.filter((_, n) => n % Math.ceil(all.length / MOST) === 0);
      pen.globalAlpha = Math.max(0.03, Math.min(0.8, (shade.value ? 60 : 25) / some.length));
      pen.lineWidth = thick;
      for (const i of some) {
        pen.beginPath();
        order.forEach((c, j) => pen.lineTo(X(j), Y(j, c.of(i))));
        pen.strokeStyle = style(i);
        pen.setLineDash(data.runs ? runLine(i)["stroke-dasharray"]?.split(" ") ?? [] : []);
        pen.stroke();
      }
    };
    const rest = ink("--line");
    lines(state.shown.filter((i) => !passes[i]), () => rest, 0.7);
    lines(state.passing, colour, data.runs ? 1.8 : 0.9);
    const known = order.filter((c) => Number.isFinite(c.flat));
    if (!data.runs && known.length > 1 && known.length === order.length) {
      drawing.append(svg("path", { class: "ghost", d: line((c) => c.flat) }), svg("text", { class: "halo", x: X(order.length - 1) + 8, y: Y(order.length - 1, order.at(-1).flat) + 4, style: "fill:var(--grey)" }, "flat"));
    }
    overlay(a, wide, (i, stroke, thick) => [svg("path", { d: line((c) => c.of(i)), fill: "none", stroke, "stroke-width": thick })]);
    order.forEach((c, j) => {
      const name = c.title.split(" ").reduce((rows, word) => ((rows.at(-1) + word).length > 13 ? [...rows, word] : [...rows.slice(0, -1), `${rows.at(-1)} ${word}`.trim()]), [""]).filter(Boolean);
      drawing.append(
        svg("line", { class: "axis", x1: X(j), x2: X(j), y1: top, y2: bottom, "data-axis": c.name }),
        ...scales[j].marks.flatMap(([v, text]) => [svg("line", { class: "axis", x1: X(j) - 4, x2: X(j), y1: Y(j, v), y2: Y(j, v) }),
          svg("text", { class: "halo", x: X(j) - 7, y: Y(j, v) + 4, "text-anchor": "end" }, text)]),
        svg("text", { class: "axis-name", y: 12, "text-anchor": "middle", style: "font-weight:600" },
          ...[...name.slice(0, 2), c.unit ? `(${c.unit})` : ""].map((text, row) => svg("tspan", { x: X(j), y: 12 + 14 * row }, text)), svg("title", {}, named(c))),
        svg("rect", { class: "grip", "data-grip": c.name, x: X(j) - 20, y: 0, width: 40, height }));
      const limit = state.limits.get(c.name);
      if (limit) {
        const [y0, y1] = limit.map((v) => clip(Y(j, v), top, bottom));
        drawing.append(rectangle(X(j) - 9, y0, X(j) + 9, y1));
      }
    });
    const near = (x) => order.findIndex((_, j) => Math.abs(X(j) - x) < 20);
    const under = ([x, y], most) => {
      let k = 0;
      while (k < order.length - 2 && X(k + 1) < x) k++;
      const part = order.length > 1 ? clip((x - X(k)) / (X(k + 1) - X(k)), 0, 1) : 0, next = Math.min(k + 1, order.length - 1);
      return nearest((i) => Math.abs(Y(k, order[k].of(i)) * (1 - part) + Y(next, order[next].of(i)) * part - y), most);
    };
    gestures(a, {
      drag: ([x0, y0], [x1, y1], done) => {
        const j = near(x0);
        if (j < 0) return null;
        // beyond the end of an axis there is no limit
        const up = order[j].maximise ? 1 : -1, end = (y) => (y < top ? up * Infinity : y > bottom ? -up * Infinity : fromY(j, y));
        const held = moved(order[j], fromY(j, y0), fromY(j, y1)); // a drag from within limits moves them
        if (held) [y0, y1] = held.map((v) => Y(j, v));
        if (done) setLimit(order[j].name, rounded(end(y0)), rounded(end(y1)));
        return rectangle(X(j) - 9, y0, X(j) + 9, y1);
      },
      click: ([x, y]) => {
        const j = near(x);
        if (j >= 0 && state.limits.has(order[j].name)) { setLimit(order[j].name, -Infinity, Infinity); return; }
        const i = under([x, y], 12);
        if (i >= 0) choose(i);
      },
    });
    hover(a, (x, y) => told(y > top ? under([x, y], 6) : -1));
  }

  /** The limits of a column, moved as a drag from a value to another one moves them; null where it does not begin within them. */
  function moved(c, from, to) {
    const [low, high] = state.limits.get(c.name) ?? [];
    return from >= low && from <= high && Number.isFinite(high - low) ? [low + to - from, high + to - from] : null;
  }

  /** The design within the limits that a measure of distance in pixels calls the nearest, or -1 if none is near. */
  function nearest(distance, most) {
    let found = -1, least = most;
    for (const i of state.passing) {
      const far = distance(i);
      if (far < least) { least = far; found = i; }
    }
    return found;
  }
  /** The text of a design under the pointer. */
  const told = (i) => {
    if (i !== state.near) {
      glimpse((state.near = i) < 0 ? state.chosen : i);
      mark();
    }
    return i < 0 ? null : [label(i), ...COLUMNS.filter((c) => !c.variable || order.includes(c)).map((c) => `${c.title} ${quantity(c.of(i), c.unit)}`)].join("\n");
  };

  function drawScatter() {
    const cx = columnOf(across.value), cy = columnOf(up.value);
    const a = axes(flat, { x: scaleOf(cx, 0.05, 6), y: scaleOf(cy, 0.05, 8),
      xlabel: named(cx), ylabel: named(cy), height: 400, left: 72,
      label: `Scatter of ${state.shown.length} designs: ${named(cy)} over ${named(cx)}` });
    const pen = canvas(flat, a), colour = colours();
    a.svg.append(svg("rect", { class: "grip", x: a.inside.left, y: a.inside.top, width: a.inside.right - a.inside.left, height: a.inside.bottom - a.inside.top }));
    const rest = ink("--line");
    pen.beginPath(); // what is beyond the zoom is not drawn
    pen.rect(a.inside.left - 3, a.inside.top - 3, a.inside.right - a.inside.left + 6, a.inside.bottom - a.inside.top + 6);
    pen.clip();
    const dot = (i, style, radius) => {
      pen.beginPath();
      pen.arc(a.X(cx.of(i)), a.Y(cy.of(i)), radius, 0, 7);
      pen.fillStyle = style;
      pen.fill();
    };
    pen.globalAlpha = 0.35;
    for (const i of state.shown) if (!passes[i]) dot(i, rest, 1.8);
    pen.globalAlpha = data.runs ? 1 : state.passing.length > 2000 ? 0.35 : 0.65;
    for (const i of state.passing) dot(i, colour(i), data.runs ? 5 : 2.5);
    overlay(a, flat, (i, stroke, thick, text) => (Number.isFinite(cx.of(i) + cy.of(i)) ? [
      svg("circle", { cx: a.X(cx.of(i)), cy: a.Y(cy.of(i)), r: 6, fill: "none", "stroke-width": 2.5, stroke: data.runs ? "var(--ink)" : stroke }),
      nameAt(a, a.X(cx.of(i)), a.Y(cy.of(i)) - 8, text)] : []));
    if (!data.runs && Number.isFinite(cx.flat) && Number.isFinite(cy.flat)) a.svg.append(
      svg("rect", { x: a.X(cx.flat) - 5, y: a.Y(cy.flat) - 5, width: 10, height: 10, fill: "var(--flat)", stroke: "var(--ink)" }),
      nameAt(a, a.X(cx.flat), a.Y(cy.flat) + 12, "flat"));
    const limits = [cx, cy].map((c) => state.limits.get(c.name));
    if (limits.some(Boolean)) {
      const b = a.inside;
      const [x0, x1] = (limits[0] ?? [-Infinity, Infinity]).map((v) => clip(a.X(v), b.left, b.right));
      const [y0, y1] = (limits[1] ?? [-Infinity, Infinity]).map((v) => clip(a.Y(v), b.top, b.bottom));
      a.svg.append(rectangle(x0, y0, x1, y1));
      a.svg.lastChild.style.fillOpacity = 0.1; // the points are seen through it
    }
    const under = ([x, y], most) => nearest((i) => Math.hypot(a.X(cx.of(i)) - x, a.Y(cy.of(i)) - y), most);
    hover(a, (x, y) => told(under([x, y], 8)));
    gestures(a, {
      drag: ([x0, y0], [x1, y1], done) => {
        const held = [moved(cx, a.fromX(x0), a.fromX(x1)), moved(cy, a.fromY(y0), a.fromY(y1))];
        if (held.every(Boolean)) [[x0, x1], [y0, y1]] = [held[0].map(a.X), held[1].map(a.Y)];
        if (done) {
          state.limits.set(cx.name, [x0, x1].sort((u, v) => u - v).map(a.fromX).map(rounded));
          setLimit(cy.name, rounded(a.fromY(y0)), rounded(a.fromY(y1)));
        }
        return rectangle(x0, y0, x1, y1);
      },
      click: (at) => { const i = under(at, 12); if (i >= 0) choose(i); },
    });
  }
  section.addEventListener("keydown", (event) => event.key === "Escape" && clear.click());
  return { section, filter, redraw, mark: (i) => { state.chosen = i; mark(); } };
}
