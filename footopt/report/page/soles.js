// Soles: from the data, as files for the workshop, and as a drawing.

const space = data.space;
const kOf = data.designs.k && oneMore(unpack(data.designs.k), space.n);

/** The waypoints' heights of a design. */
const heights = (i) => kOf ? Array.from(kOf.subarray(i * space.n, (i + 1) * space.n)) : null;

/** The width of a design's foot, or the height of its top, m: the same for all, or one each. */
const own = (name, i) => (Array.isArray(data[name]) ? data[name][i] : data[name]);

/** The sole of a design from heel to toe, [[x, z], ...], m: its own, or a spline linear in its heights. */
function sole(i) {
  if (!space) return pairs(unpack(data.designs.soles[i]));
  const { z, cubic } = spline(heights(i)), pieces = (space.n - 1) * space.fine;
  return Array.from({ length: pieces + 1 }, (_, j) => [(space.L * (2 * j - pieces)) / pieces, cubic(j / space.fine, (p, s, d0, q, c) => z[p] + s * (d0 + s * (q + s * c)))]);
}

/** The spline through heights k: z of its waypoints, m, and what a function takes of its piece at u, from 0 to n - 1. */
function spline(k) {
  const { n, K, H } = space, z = k.map((v) => -v * (H / K));
  const slopes = space.slopes.map((row) => row.reduce((sum, m, j) => sum + z[j] * m, 0));
  const cubic = (u, take) => {
    const i = Math.min(Math.trunc(u), n - 2), s = u - i, rise = z[i + 1] - z[i], d0 = slopes[i], d1 = slopes[i + 1];
    return take(i, s, d0, 3 * rise - 2 * d0 - d1, d0 + d1 - 2 * rise);
  };
  return { z, cubic };
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

/** Files of a sole by ending: its text, and what kind of file it is. */
const FORMATS = {
  dxf: { text: toDxf, type: "image/vnd.dxf" },
  csv: { text: toCsv, type: "text/csv" },
};

/** A sole in its box with its waypoints, in mm, as a drawing of a given width. */
function soleDrawing(points, { width, k = null, height = null, ghost = null, plain = false, top = 0, colour = "var(--best)" }) {
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
    "aria-hidden": plain ? "true" : null, role: plain ? null : k ? "group" : "img",
    "aria-label": plain ? null : "The sole from heel to toe" });
  if (!plain) {
    if (space) made.append(svg("rect", { x: X(-space.L), y: Z(0), width: 2 * space.L * scale,
      height: space.H * scale, fill: "var(--pale)" }));
    const foot = Z(z0) + 4;
    const across = ticks(MM * x0, MM * x1, width / 90), up = ticks(MM * z0, MM * z1, 3);
    made.append(...across.values.flatMap((v) => [svg("line", { class: "axis", x1: X(v / MM), x2: X(v / MM), y1: foot, y2: foot + 4 }),
      svg("text", { x: X(v / MM), y: foot + 17, "text-anchor": "middle" }, tickText(v, across))]),
    ...up.values.flatMap((v) => [svg("line", { class: "axis", x1: edge - 4, x2: edge, y1: Z(v / MM), y2: Z(v / MM) }),
      svg("text", { x: edge - 6, y: Z(v / MM) + 4, "text-anchor": "end" }, tickText(v, up))]));
    made.append(svg("text", { x: (edge + width) / 2, y: foot + 34, "text-anchor": "middle" },
      "x (mm), to the toe; upwards z (mm), same scale"));
  }
  made.append(svg("path", { d: to(shape) + "Z", fill: colour, "fill-opacity": 0.14, stroke: "none" }));
  if (ghost) made.append(svg("path", { d: to(ghost), fill: "none", stroke: "var(--flat)", "stroke-width": 1.5, "stroke-dasharray": "5 4" }));
  made.append(svg("path", { d: to(points), fill: "none", stroke: colour, "stroke-width": plain ? 1.5 : 3 }));
  if (k && !plain) k.forEach((height, p) => {
    const cx = X((2 * space.L * p) / (space.n - 1) - space.L), cy = Z((-height * space.H) / space.K);
    made.append(svg("circle", { cx, cy, r: 4, class: "waypoint", stroke: colour, "stroke-width": 1.5 }),
    P.sand ? svg("circle", { cx, cy, r: 11, class: "grip", "data-waypoint": p, role: "slider", tabindex: "0",
      "aria-label": `level of waypoint ${p + 1}, downwards`, "aria-valuemin": 1, "aria-valuemax": space.K, "aria-valuenow": height, "aria-orientation": "vertical" }) : "");
  });
  made.height_of = (y) => z1 - (y - 4) / scale;
  return made;
}
