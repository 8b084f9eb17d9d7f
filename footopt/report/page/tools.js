// What every part of the page needs: the data, elements, scales, tables, downloads.

const data = JSON.parse(document.getElementById("data").textContent);
const BLUE = "#0072b2", VERMILLION = "#d55e00", GREEN = "#00795a", GREY = "#8c8c8c";
const COLOURS = [BLUE, VERMILLION, "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000"];

/** A flat array of numbers from base64: floats of 32 or 64 bits, or whole numbers of 16 bits and their scale. */
function unpack({ low, step, data: text }) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  if (step <= 0) return step < 0 ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
  return Float64Array.from(new Uint16Array(bytes.buffer), (v) => low + step * v);
}

/** An element, of HTML or of SVG, with attributes (a function is a listener) and children. */
function make(space, name, attributes, children) {
  const made = space ? document.createElementNS(space, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(key, value);
    else if (value !== null && value !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}
const el = (name, attributes = {}, ...children) => make(null, name, attributes, children);
const svg = (name, attributes = {}, ...children) =>
  make("http://www.w3.org/2000/svg", name, attributes, children);

/** Four significant digits, as on the terminal. */
function number(value) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (Math.abs(value) < 1e-12) return "0";
  if (Number.isInteger(value) && Math.abs(value) < 1e5) return String(value).replace("-", "−");
  const [mantissa, power] = value.toExponential(3).split("e").map(Number);
  const text = power < -3 || power >= 5 ? `${mantissa}e${power}` : String(Number(value.toFixed(Math.max(3 - power, 0))));
  return text.replace("-", "−");
}
const quantity = (value, unit) => number(value) + (unit ? ` ${unit}` : "");
const named = (column) => column.title + (column.unit ? ` (${column.unit})` : "");

/** Some round numbers from low to high. */
function ticks(low, high, count) {
  const rough = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= rough * 0.999);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return { values: found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), step };
}
function tickText(value, { digits, step }) {
  const small = step < 1e-4 || Math.abs(value) >= 1e5;
  const text = small ? value.toExponential(1).replace(".0e", "e") : value.toFixed(digits);
  return (value === 0 ? "0" : text).replace(/-/g, "−");
}

/** The smallest and the largest finite number, and some room around them. */
function range(values, room = 0.05) {
  let low = Infinity, high = -Infinity;
  for (const v of values) if (Number.isFinite(v)) { if (v < low) low = v; if (v > high) high = v; }
  if (low > high) return [0, 1];
  const more = (high - low || Math.abs(high) || 1) * room;
  return [low - more, high + more];
}

/** Axes in a holder: an empty drawing with scales from numbers to pixels and back. */
function axes(holder, { x, y, xlabel, ylabel, height, label, left = 58 }) {
  const width = Math.max(holder.clientWidth, 200), right = 26, top = 22, bottom = xlabel ? 40 : 22;
  const place = (low, high, from, to) => (v) => from + ((v - low) / (high - low || 1)) * (to - from);
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label });
  const made = {
    svg: drawing, width, height,
    X: place(...x, left, width - right), Y: place(...y, height - bottom, top),
    fromX: place(left, width - right, ...x), fromY: place(height - bottom, top, ...y),
    inside: { left, right: width - right, top, bottom: height - bottom },
  };
  const across = ticks(...x, Math.max(3, width / 90)), up = ticks(...y, Math.max(3, height / 45));
  for (const v of up.values) {
    drawing.append(
      svg("line", { class: "gridline", x1: left, x2: width - right, y1: made.Y(v), y2: made.Y(v) }),
      svg("text", { x: left - 6, y: made.Y(v) + 4, "text-anchor": "end" }, tickText(v, up)));
  }
  for (const v of across.values) {
    drawing.append(
      svg("line", { class: "axis", x1: made.X(v), x2: made.X(v), y1: height - bottom, y2: height - bottom + 4 }),
      svg("text", { x: made.X(v), y: height - bottom + 16, "text-anchor": "middle" }, tickText(v, across)));
  }
  drawing.append(
    svg("line", { class: "axis", x1: left, x2: width - right, y1: height - bottom, y2: height - bottom }),
    svg("text", { x: 4, y: 13 }, ylabel));
  if (xlabel) drawing.append(
    svg("text", { x: (left + width - right) / 2, y: height - 5, "text-anchor": "middle" }, xlabel));
  holder.replaceChildren(drawing);
  return made;
}

/** Points in pixels as an SVG path; a gap where one is not a number. */
function path(points) {
  let text = "", down = false;
  for (const [x, y] of points) {
    if (Number.isFinite(x) && Number.isFinite(y)) text += `${down ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`;
    down = Number.isFinite(x) && Number.isFinite(y);
  }
  return text;
}

/** A table; rows of texts or elements. */
function table(head, rows, attributes = {}) {
  return el("table", attributes,
    el("thead", {}, el("tr", {}, ...head.map((text) => el("th", { scope: "col" }, text)))),
    el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map((cell) => el("td", {}, cell))))));
}

/** A table that opens on demand and is filled then. */
function folded(title, fill) {
  const box = el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": title });
  const whole = el("details", { toggle: () => whole.open && box.replaceChildren(fill()) },
    el("summary", {}, title), box);
  whole.refresh = () => whole.open && box.replaceChildren(fill());
  return whole;
}

/** Hand a file to the browser. */
function download(name, content, type) {
  const link = el("a", { href: URL.createObjectURL(new Blob([content], { type })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Say something to those who do not see what has changed. */
const say = (text) => { document.getElementById("status").textContent = text; };

/** Draw again whenever the width of the page changes. */
const drawings = [];
function drawn(draw) {
  drawings.push(draw);
  draw();
}
let lastWidth = document.body.clientWidth;
new ResizeObserver(() => {
  if (document.body.clientWidth === lastWidth) return;
  lastWidth = document.body.clientWidth;
  drawings.forEach((draw) => draw());
}).observe(document.body);

// --- soles ----------------------------------------------------------------------------------------

const space = data.space && Object.fromEntries(Object.entries(data.space).map(
  ([key, value]) => [key, value.data === undefined ? value : unpack(value)]));
const kOf = data.designs.k && unpack(data.designs.k);

/** The waypoints' heights of a design. */
const heights = (i) => kOf ? Array.from(kOf.subarray(i * space.n, (i + 1) * space.n)) : null;

/** The width of a design's foot, or the height of its top, m: the same for all, or one each. */
const own = (name, i) => (Array.isArray(data[name]) ? data[name][i] : data[name]);

/** The sole of a design from heel to toe, [[x, z], ...], m: its own, or a spline linear in its heights. */
function sole(i) {
  if (!space) return pairs(unpack(data.designs.soles[i]));
  const k = heights(i), m = space.x.length;
  return Array.from(space.x, (x, j) => {
    let z = space.base[j];
    for (let p = 0; p < space.n; p++) z += (k[p] - 1) * space.columns[p * m + j];
    return [x, z];
  });
}
function pairs(flat) {
  const found = [];
  for (let i = 0; i < flat.length; i += 2) found.push([flat[i], flat[i + 1]]);
  return found;
}

/** The sole with vertical sides and a flat top (z, m), counter-clockwise from the heel. */
function outline(points, top) {
  const level = Math.max(top, ...points.map((p) => p[1])), SAME = 1e-7;
  const closed = points.slice();
  for (const end of [points[points.length - 1], points[0]])
    if (level - end[1] > SAME) closed.push([end[0], level]);
  return closed;
}

/** Largest vertical gap between the sole and its lower convex hull, m. */
function hollow(points) {
  const hull = [];
  for (const p of points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1])) {
    while (hull.length > 1) {
      const [a, b] = hull.slice(-2);
      if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
      hull.pop();
    }
    hull.push(p);
  }
  let gap = 0, edge = 0;
  for (const [x, z] of points) {
    while (edge < hull.length - 2 && hull[edge + 1][0] < x) edge++;
    while (edge > 0 && hull[edge][0] > x) edge--;
    const [a, b] = [hull[edge], hull[edge + 1]];
    if (b && b[0] > a[0]) gap = Math.max(gap, z - a[1] - ((b[1] - a[1]) * (x - a[0])) / (b[0] - a[0]));
  }
  return gap;
}

const MM = 1000;
const mm = (value) => (MM * value).toFixed(4).replace(/^-(0\.0*)$/, "$1");

/** The sole as a table, as contour.csv. */
const toCsv = ({ points }) => "x_mm,z_mm\n" + points.map(([x, z]) => `${mm(x)},${mm(z)}\n`).join("");

/** Outline and sole as polylines in mm, in the DXF of release 12, which every CAD program reads. */
function toDxf({ points, top }) {
  const polyline = (layer, closed, line) => [
    [0, "POLYLINE"], [8, layer], [66, 1], [10, "0.0"], [20, "0.0"], [30, "0.0"], [70, closed ? 1 : 0],
    ...line.flatMap(([x, z]) => [[0, "VERTEX"], [8, layer], [10, mm(x)], [20, mm(z)], [30, "0.0"]]),
    [0, "SEQEND"], [8, layer]];
  const layer = (name, colour) => [[0, "LAYER"], [2, name], [70, 0], [62, colour], [6, "CONTINUOUS"]];
  return [
    [0, "SECTION"], [2, "HEADER"], [9, "$ACADVER"], [1, "AC1009"], [9, "$INSUNITS"], [70, 4],
    [9, "$MEASUREMENT"], [70, 1], [0, "ENDSEC"],
    [0, "SECTION"], [2, "TABLES"], [0, "TABLE"], [2, "LAYER"], [70, 2],
    ...layer("OUTLINE", 7), ...layer("SOLE", 1), [0, "ENDTAB"], [0, "ENDSEC"],
    [0, "SECTION"], [2, "ENTITIES"],
    ...polyline("OUTLINE", true, outline(points, top)), ...polyline("SOLE", false, points),
    [0, "ENDSEC"], [0, "EOF"],
  ].map(([code, value]) => `${code}\n${value}\n`).join("");
}

/** The triangles of a simple polygon that runs counter-clockwise, by cutting ears: [[i, j, k], ...]. */
function triangles(polygon) {
  const left = polygon.map((_, i) => i), found = [];
  const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  while (left.length > 3) {
    let ear = left.findIndex((j, at) => {
      const i = left.at(at - 1), k = left[(at + 1) % left.length], [a, b, c] = [i, j, k].map((p) => polygon[p]);
      return turn(a, b, c) > 0 && !left.some((p) => p !== i && p !== j && p !== k &&
        turn(a, b, polygon[p]) >= 0 && turn(b, c, polygon[p]) >= 0 && turn(c, a, polygon[p]) >= 0);
    });
    if (ear < 0) ear = 0; // only points in one line are left
    found.push([left.at(ear - 1), left[ear], left[(ear + 1) % left.length]]);
    left.splice(ear, 1);
  }
  return [...found, left];
}

/** The outline extruded to the foot's width, in mm: x to the toe, y to the left, z up. */
function toStl({ points, top, width }) {
  const shape = outline(points, top), n = shape.length, caps = triangles(shape);
  const at = (i, y) => [MM * shape[i % n][0], MM * y, MM * shape[i % n][1]];
  const solid = [
    ...caps.map((t) => t.map((i) => at(i, 0))), // seen from the side of -y they run counter-clockwise
    ...caps.map((t) => t.map((i) => at(i, width)).reverse()),
    ...shape.flatMap((_, i) => [[at(i, 0), at(i, width), at(i + 1, width)], [at(i, 0), at(i + 1, width), at(i + 1, 0)]]),
  ];
  const facets = solid.map(([a, b, c]) => {
    const u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
    const cross = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
    const long = Math.hypot(...cross) || 1, vertex = (p) => `vertex ${p.map((v) => v.toFixed(4)).join(" ")}\n`;
    return `facet normal ${cross.map((v) => (v / long).toFixed(6)).join(" ")}\nouter loop\n${[a, b, c].map(vertex).join("")}endloop\nendfacet\n`;
  });
  return `solid sole\n${facets.join("")}endsolid sole\n`;
}

/** Files of a sole by ending: its text, and what kind of file it is. */
const FORMATS = {
  dxf: { text: toDxf, type: "image/vnd.dxf" },
  csv: { text: toCsv, type: "text/csv" },
  stl: { text: toStl, type: "model/stl" },
};

/** A sole in its box with its waypoints, in mm, as a drawing of a given width. */
function soleDrawing(points, { width, k = null, height = null, ghost = null, plain = false, top = 0 }) {
  const shape = outline(points, top);
  const xs = [...shape, ...(ghost || [])].map((p) => p[0]), zs = [...shape, ...(ghost || [])].map((p) => p[1]);
  if (space && !plain) { xs.push(-space.L, space.L); zs.push(-space.H, 0); }
  const [x0, x1] = range(xs, 0.02), [z0, z1] = range(zs, 0.1);
  const edge = plain ? 4 : 40, below = plain ? 4 : 52;
  const scale = Math.min((width - edge - 8) / (x1 - x0), height ? (height - below) / (z1 - z0) : Infinity);
  const high = height || (z1 - z0) * scale + below;
  const X = (x) => edge + (x - x0) * scale, Z = (z) => 4 + (z1 - z) * scale;
  const to = (list) => path(list.map(([x, z]) => [X(x), Z(z)]));
  const made = svg("svg", { viewBox: `0 0 ${width} ${high}`, height: high, width: plain ? width : null,
    "aria-hidden": plain ? "true" : null, role: plain ? null : "img",
    "aria-label": plain ? null : `The sole from heel to toe, hollow ${number(MM * hollow(points))} mm` });
  if (!plain) {
    if (space) made.append(svg("rect", { x: X(-space.L), y: Z(0), width: 2 * space.L * scale,
      height: space.H * scale, fill: "#f0f0f0" }));
    const foot = Z(z0) + 4;
    for (const v of ticks(MM * x0, MM * x1, width / 90).values) made.append(
      svg("line", { class: "axis", x1: X(v / MM), x2: X(v / MM), y1: foot, y2: foot + 4 }),
      svg("text", { x: X(v / MM), y: foot + 17, "text-anchor": "middle" }, String(Math.round(v)).replace("-", "−")));
    for (const v of ticks(MM * z0, MM * z1, 3).values) made.append(
      svg("line", { class: "axis", x1: edge - 4, x2: edge, y1: Z(v / MM), y2: Z(v / MM) }),
      svg("text", { x: edge - 6, y: Z(v / MM) + 4, "text-anchor": "end" }, String(Math.round(v)).replace("-", "−")));
    made.append(svg("text", { x: (edge + width) / 2, y: foot + 34, "text-anchor": "middle" },
      "x (mm), to the toe; upwards z (mm), same scale"));
  }
  made.append(svg("path", { d: to(shape) + "Z", fill: plain ? "#e9e9e9" : "#e0f0ea", stroke: "none" }));
  if (ghost) made.append(svg("path", { d: to(ghost), fill: "none", stroke: GREY, "stroke-width": 1.5, "stroke-dasharray": "5 4" }));
  made.append(svg("path", { d: to(points), fill: "none", stroke: GREEN, "stroke-width": plain ? 1.5 : 2.5 }));
  if (k && !plain) k.forEach((height, p) => made.append(svg("circle", { cx: X(space.waypoints[p]),
    cy: Z(-height * space.step), r: 4, fill: "#fff", stroke: GREEN, "stroke-width": 1.5 })));
  return made;
}
