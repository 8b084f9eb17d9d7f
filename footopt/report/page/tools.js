// Tools of every part of the page: the data, elements, scales, tables, downloads.

const data = JSON.parse(document.getElementById("data").textContent);
const entry = data.entry ?? {};
/** Lines of runs, in the order of the figures. */
const COLOURS = Array.from({ length: 7 }, (_, i) => `var(--line-${i})`), DASHES = [null, "7 3", "2 2", "9 3 2 3"];
const runLine = (i) => ({ stroke: COLOURS[i % COLOURS.length], "stroke-dasharray": DASHES[i % 4] });
/** A colour by its role, for a canvas, which reads no variables. */
const ink = (colour) => getComputedStyle(document.documentElement).getPropertyValue(colour.replace(/^var\(|\)$/g, "")).trim();
/** What the address keeps of the page, so that a link opens it as it is. */
const address = new URLSearchParams([...new URLSearchParams(location.hash.slice(1))].filter(([, value]) => value));
function remember(name, value) {
  if (value) address.set(name, value); else address.delete(name);
  history.replaceState(null, "", address.size ? `#${address}` : location.pathname + location.search);
}
addEventListener("change", ({ target }) => target.matches("select[id]") && remember(target.id, target.value));
const clip = (v, low, high) => Math.min(Math.max(v, low), high);
/** From 0 to 1 in colours that the colour-blind can tell apart (viridis). */
function ramp(share) {
  const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  const place = 4 * clip(share || 0, 0, 1), i = Math.min(Math.floor(place), 3);
  return `rgb(${stops[i].map((v, c) => Math.round(v + (place - i) * (stops[i + 1][c] - v))).join(" ")})`;
}

/** A flat array of numbers from base64. */
function unpack({ type, data: text }) {
  const { buffer } = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new { int32: Int32Array, float32: Float32Array, float64: Float64Array }[type](buffer);
}

/** Numbers with room for a row more, of NaN. */
function oneMore(numbers, width) {
  const more = new Float64Array(numbers.length + width).fill(NaN);
  more.set(numbers);
  return more;
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

/** Give a drawing parts [element, attributes, text], in its elements of before where they are alike. */
function redrawn(drawing, parts) {
  parts.forEach(([name, attributes, text = ""], i) => {
    let made = drawing.childNodes[i];
    if (made?.nodeName !== name) {
      if (made) made.remove();
      made = drawing.insertBefore(Object.assign(svg(name), { known: { text: "" } }), drawing.childNodes[i] ?? null);
    }
    for (const key in attributes) if (made.known[key] !== attributes[key]) made.setAttribute(key, (made.known[key] = attributes[key]) ?? "");
    if (made.known.text !== text) made.textContent = made.known.text = text;
  });
  while (drawing.childNodes.length > parts.length) drawing.lastChild.remove();
}

const ROUNDING = 1e-12, TINY = 1e-10; // what is smaller is no motion, force or power; no number that is told
/** Four significant digits, as on the terminal. */
function number(value) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (Math.abs(value) < TINY) return "0";
  if (Number.isInteger(value) && Math.abs(value) < 1e5) return String(value).replace("-", "−");
  const [mantissa, power] = value.toExponential(3).split("e").map(Number);
  const text = power < -3 || power >= 5 ? `${mantissa}e${power}` : String(Number(value.toFixed(Math.max(3 - power, 0))));
  return text.replace("-", "−");
}
const OF_FLAT = "x of flat";
const quantity = (value, unit) => unit === OF_FLAT ? `${value.toFixed(2)} x the flat foot's` : number(value) + (unit ? ` ${unit}` : "");
/** A share of 1 with two digits; a dash where it is of nothing but rounding. */
const percent = (share, of = 1) => Number.isFinite(share) && Math.abs(of) > TINY ? `${share < ROUNDING ? 0 : +(100 * share).toPrecision(2)} %` : "–";
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

/** The width of a holder, pixels: asked for once, as every answer lays the page out anew. */
const widths = new Map();
function widthOf(holder) {
  if (!widths.get(holder)) widths.set(holder, holder.clientWidth);
  return Math.max(widths.get(holder), 200);
}

/** A scale: the share of an axis at which a value is, the value at a share, and round values with their texts. */
function evenScale([low, high], count) {
  if (high - low < 1e-9 * Math.abs(high)) high = low; // rounding
  const marks = ticks(low, high, count);
  return { to: (v) => (high > low ? (v - low) / (high - low) : 0.5), from: (share) => low + share * (high - low),
    marks: high > low ? marks.values.map((v) => [v, tickText(v, marks)]) : [[low, number(low)]] };
}
/** A scale of quantiles: equal lengths hold equally many of the values. */
function quantileScale(values, count) {
  const sorted = Float64Array.from(values.filter(Number.isFinite)).sort(), last = sorted.length - 1;
  const from = (share) => {
    const place = clip(share, 0, 1) * last, i = Math.floor(place);
    return sorted[i] + (place - i) * ((sorted[i + 1] ?? sorted[i]) - sorted[i]);
  };
  const to = (v) => {
    let low = 0, high = last;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (sorted[middle] <= v) low = middle; else high = middle;
    }
    return (low + clip((v - sorted[low]) / (sorted[high] - sorted[low] || 1), 0, 1)) / (last || 1);
  };
  return { to, from, marks: Array.from({ length: count + 1 }, (_, i) => [from(i / count), number(from(i / count))]) };
}

/** Axes in a holder: an empty drawing with scales, or ranges of even ones, from numbers to pixels and back. */
function axes(holder, { x, y, xlabel, ylabel, height, label, left = 58 }) {
  const width = widthOf(holder), right = 26, top = 22, bottom = xlabel ? 40 : 22;
  const across = x.marks ? x : evenScale(x, Math.max(3, width / 90)), up = y.marks ? y : evenScale(y, Math.max(3, height / 45));
  const wide = width - right - left, high = top - height + bottom;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label });
  const made = {
    svg: drawing, width, height,
    X: (v) => left + across.to(v) * wide, Y: (v) => height - bottom + up.to(v) * high,
    fromX: (px) => across.from((px - left) / wide), fromY: (px) => up.from((px - height + bottom) / high),
    inside: { left, right: width - right, top, bottom: height - bottom },
  };
  for (const [v, text] of up.marks) {
    drawing.append(
      svg("line", { class: "gridline", x1: left, x2: width - right, y1: made.Y(v), y2: made.Y(v) }),
      svg("text", { x: left - 6, y: made.Y(v) + 4, "text-anchor": "end" }, text));
  }
  for (const [v, text] of across.marks) {
    drawing.append(
      svg("line", { class: "axis", x1: made.X(v), x2: made.X(v), y1: height - bottom, y2: height - bottom + 4 }),
      svg("text", { x: made.X(v), y: height - bottom + 16, "text-anchor": "middle" }, text));
  }
  drawing.append(
    svg("line", { class: "axis", x1: left, x2: width - right, y1: height - bottom, y2: height - bottom }),
    svg("text", { x: 4, y: 13 }, ylabel));
  if (xlabel) drawing.append(
    svg("text", { x: (left + width - right) / 2, y: height - 5, "text-anchor": "middle" }, xlabel));
  holder.replaceChildren(drawing);
  return made;
}

/** A name beside a point, on the side where it has room. */
const nameAt = (a, x, y, text) => (x > a.width - 80 ? svg("text", { class: "halo", x: x - 10, y, "text-anchor": "end" }, text) : svg("text", { class: "halo", x: x + 10, y }, text));

/** Where the pointer is in a drawing, its own pixels. */
function where(a, event) {
  const box = a.svg.getBoundingClientRect();
  return [((event.clientX - box.left) * a.width) / box.width, ((event.clientY - box.top) * a.height) / box.height];
}

/** Words beside the pointer: `read(x, y)` gives those of a place in pixels, or nothing. */
const tip = document.body.appendChild(el("div", { id: "tip", "aria-hidden": "true", hidden: true }));
function hover(a, read) {
  a.svg.addEventListener("pointermove", (event) => {
    const words = event.buttons ? null : read(...where(a, event));
    tip.hidden = !words;
    if (!words) return;
    tip.textContent = words;
    tip.style.left = `${Math.min(event.pageX + 14, document.documentElement.clientWidth - tip.offsetWidth - 8)}px`;
    tip.style.top = `${event.pageY + 16}px`;
  });
  a.svg.addEventListener("pointerleave", () => { tip.hidden = true; read(NaN, NaN); });
}

/** Tell a click from a drag. */
function gestures(a, { drag, click }) {
  let from = null, box = null;
  // a finger on an axis brushes, elsewhere it moves the page
  a.svg.addEventListener("touchstart", (event) => event.target.classList.contains("grip") && event.preventDefault(), { passive: false });
  a.svg.addEventListener("pointerdown", (event) => {
    from = where(a, event);
    a.svg.setPointerCapture(event.pointerId);
  });
  a.svg.addEventListener("pointermove", (event) => {
    if (!from) return;
    box?.remove();
    tip.hidden = true;
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

/** The names of lines, each beside a piece of it. */
const legend = (lines) => el("div", { class: "bar legend" }, ...lines.map(({ name, ...looks }) => el("span", {},
  svg("svg", { width: 32, height: 12, "aria-hidden": "true" }, svg("path", { d: "M1 6H31", fill: "none", "stroke-width": 2, ...looks })), name)));

/** Lines { x, y, ... } with their looks in a holder, on axes; `read(x)` are the words at a place. */
function plot(holder, { strikes = [], ...frame }, series, read) {
  const a = axes(holder, { ...frame, y: range(series.flatMap(({ y }) => Array.from(y)), 0.08) }), { left, right, top, bottom } = a.inside;
  for (const t of strikes) a.svg.append(svg("line", { class: "strike", x1: a.X(t), x2: a.X(t), y1: top, y2: bottom }));
  for (const { x, y, ...looks } of series)
    a.svg.append(svg("path", { d: path(Array.from(x, (v, i) => [a.X(v), a.Y(y[i])])), fill: "none", "stroke-width": 1.8, ...looks }));
  hover(a, (x) => (x >= left && x <= right ? read(a.fromX(x)) : null));
  return a;
}

/** Points in pixels as an SVG path; a gap where one is not a number. */
function path(points) {
  let text = "", down = false;
  for (const [x, y] of points) {
    const known = Number.isFinite(x + y);
    if (known) text += `${down ? "L" : "M"}${Math.round(10 * x) / 10} ${Math.round(10 * y) / 10}`;
    down = known;
  }
  return text;
}

/** A table; rows of texts or elements. */
function table(head, rows, attributes = {}) {
  return el("table", attributes,
    el("thead", {}, el("tr", {}, ...head.map((text) => (text ? el("th", { scope: "col" }, text) : el("td"))))),
    el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map((cell) => el("td", {}, cell))))));
}

/** A box that scrolls where it is too large. */
const scrolled = (label, ...children) => el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, ...children);

/** A table that opens on demand and is filled then. */
function folded(title, fill) {
  const box = scrolled(title);
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
const say = (text) => { const status = document.getElementById("status"); if (status.textContent !== text) status.textContent = text; };

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
  widths.clear();
  drawings.forEach((draw) => draw());
}).observe(document.body);
addEventListener("beforeprint", () => { document.getElementById("warnings")?.setAttribute("open", ""); });
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => drawings.forEach((draw) => draw()));
