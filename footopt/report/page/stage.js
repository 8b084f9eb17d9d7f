// The stage: legs, soles, forces and the ground at one instant of a walk.

const LEFT = 0, RIGHT = 1, SIDES = ["left", "right"];
const LINES = [{ stroke: "var(--left)" }, { stroke: "var(--right)", "stroke-dasharray": "7 3" }];

const gait = data.gait && { ...data.gait, angles: unpack(data.gait.angles) };

/** Thigh, shank and pitch of a leg at a time, rad. */
function legAngles(t, foot) {
  const rows = gait.angles.length / 6, at = Math.min(Math.max(t / gait.end, 0), 1) * (rows - 1);
  const i = Math.min(Math.floor(at), rows - 2), part = at - i;
  return [0, 1, 2].map((joint) => {
    const j = 6 * i + 3 * foot + joint;
    return gait.angles[j] * (1 - part) + gait.angles[j + 6] * part;
  });
}

/** A walk of the data with its arrays unpacked. */
const opened = new Map();
function open(place) {
  if (!opened.has(place)) {
    const raw = data.walks[place], walk = { ...raw, points: raw.sole ? pairs(unpack(raw.sole)) : sole(raw.design) };
    for (const name of ["t", "com", "velocity", "force", "power", "work", "at", "when", "area", "arrows"])
      walk[name] = raw[name] ? unpack(raw[name]) : [];
    if (raw.sand) {
      walk.sand = unpack(raw.sand.height);
      walk.surface = (t) => at(walk, "sand", raw.sand.height.shape[1], t, walk.when).map((z, i) => [raw.sand.first + i * raw.sand.cell, z]);
    }
    opened.set(place, prepared(walk));
  }
  return opened.get(place);
}

/** A walk with what pictures of it need: fewer points, an outline, and which arrow each piece of the sole has. */
function prepared(walk) {
  const every = Math.max(1, Math.floor(walk.points.length / Math.max(80, 4 * (space?.n ?? 0))));
  walk.light = walk.points.filter((_, i) => i % every === 0 || i === walk.points.length - 1);
  walk.shape = outline(walk.light, walk.top);
  const parts = pairs(walk.at);
  walk.part = walk.light.slice(1).map(([x, z], i) => {
    const middle = [(x + walk.light[i][0]) / 2 - walk.ankle[0], (z + walk.light[i][1]) / 2 - walk.ankle[1]];
    const far = parts.map((p) => size([p[0] - middle[0], p[1] - middle[1]]));
    return far.indexOf(Math.min(...far));
  });
  return walk;
}

/** Values of a trace with so many columns at a time, in a straight line between samples. */
function at(walk, name, width, t, times = walk.t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const part = Math.min(Math.max((t - times[low]) / (times[high] - times[low] || 1), 0), 1);
  const values = walk[name];
  return Array.from({ length: width }, (_, i) => values[low * width + i] * (1 - part) + values[high * width + i] * part);
}

/** Where legs and soles are at a time, m: of each foot its joints, and what carries a point of the foot there. */
function pose(walk, t) {
  const [x, z] = at(walk, "com", 2, t);
  return SIDES.map((_, foot) => {
    const [thigh, shank, pitch] = legAngles(t, foot);
    const knee = [x + gait.l1 * Math.sin(thigh), z - gait.l1 * Math.cos(thigh)];
    const ankle = [knee[0] + gait.l2 * Math.sin(shank), knee[1] - gait.l2 * Math.cos(shank)];
    const c = Math.cos(pitch), s = Math.sin(pitch);
    const turn = ([u, v]) => [ankle[0] + c * u - s * v, ankle[1] + s * u + c * v];
    const carry = (points) => points.map(([u, v]) => turn([u - walk.ankle[0], v - walk.ankle[1]]));
    return { leg: [[x, z], knee, ankle], turn, carry };
  });
}

/** Where everything is at a time, m and N. */
function instant(walk, t) {
  const parts = pairs(walk.at), times = walk.when.length ? walk.when : walk.t, arrows = at(walk, "arrows", 4 * parts.length, t, times);
  const feet = pose(walk, t).map(({ leg, turn, carry }, foot) => ({ leg, shape: carry(walk.shape), sole: carry(walk.light),
    forces: parts.map((p, i) => ({ at: turn(p), f: arrows.slice(2 * (foot * parts.length + i)).slice(0, 2) })) }));
  return { com: feet[0].leg[0], feet };
}

const size = ([x, z]) => Math.hypot(x, z);

/** The force of a whole foot and where it acts: the mean of its parts' places by their forces. */
function resultant(forces) {
  const total = [0, 0], place = [0, 0];
  let weight = 0;
  for (const { at: [x, z], f } of forces) {
    total[0] += f[0]; total[1] += f[1];
    place[0] += size(f) * x; place[1] += size(f) * z; weight += size(f);
  }
  return { f: total, at: weight ? [place[0] / weight, place[1] / weight] : forces[0]?.at };
}

/** What a sole can be coloured by: of each part of a foot at a time. */
const PAINTS = {
  side: null,
  stress: { title: "stress (kPa)", of: (walk, now, foot) => now.feet[foot].forces.map(({ f }, i) => size(f) / walk.area[i] / 1000) },
  power: { title: "power into the sand (W)", of: (walk, now, foot, t) => {
    const h = 0.005, [before, after] = [t - h, t + h].map((s) => pose(walk, s)[foot]);
    return pairs(walk.at).map((p, i) => {
      const [a, b] = [before.turn(p), after.turn(p)], { f } = now.feet[foot].forces[i];
      return -(f[0] * (b[0] - a[0]) + f[1] * (b[1] - a[1])) / (2 * h);
    });
  } },
};

/** The lowest that soles have been at each place so far: a print as it would stay if no sand fell back. */
function printed(walk) {
  const STEP = 0.004, [x0, x1] = range(walk.com.filter((_, i) => i % 2 === 0), 0), from = x0 - 1;
  const depth = new Float64Array(Math.ceil((x1 - x0 + 2) / STEP));
  let done = -1, before = [];
  const dig = ([xa, za], [xb, zb]) => {
    const first = Math.ceil((Math.min(xa, xb) - from) / STEP), last = (Math.max(xa, xb) - from) / STEP;
    for (let j = first; j <= last; j++) depth[j] = Math.min(depth[j], za + ((zb - za) * (from + j * STEP - xa)) / (xb - xa || 1));
  };
  return (t) => {
    if (t < done) { depth.fill(0); done = -1; before = []; }
    for (let s = Math.max(done, 0); s <= t; s += 0.01) before = pose(walk, s).map(({ carry }, foot) => {
      const points = carry(walk.light);
      if (points.some((p) => p[1] < 0)) points.slice(1).forEach((p, i) => dig(points[i], p));
      // heel and toe go on between two instants
      if (before[foot]) for (const end of [0, -1]) dig(before[foot].at(end), points.at(end));
      return points;
    });
    done = t;
    return Array.from(depth, (z, j) => [from + j * STEP, z]);
  };
}

function arrow([x0, y0], [x1, y1]) {
  const long = Math.hypot(x1 - x0, y1 - y0);
  if (long < 3) return "";
  const head = Math.min(7, 0.6 * long), ux = (x1 - x0) / long, uy = (y1 - y0) / long;
  const side = (turn) => [x1 - head * (ux - turn * 0.5 * uy), y1 - head * (uy + turn * 0.5 * ux)];
  return path([[x0, y0], [x1, y1]]) + path([side(1), [x1, y1], side(-1)]);
}

/**
 * A picture of the walker; returns what moves it to an instant.
 *
 * `close` draws soles and the forces on their parts, else the whole walker. The camera goes with the COM, or
 * looks at x = `fixed`. `other` is drawn behind as a ghost, in step: its COM, or its ankle at `fixed`, in the same place.
 */
function stage(holder, walk, { close, x, z, label, other = null, fixed = null, paint = "side", tall = 330 }) {
  const width = widthOf(holder);
  const height = Math.min(tall, (width / (x[1] - x[0])) * (z[1] - z[0]) + (close ? 0 : 60));
  const scale = Math.min(width / (x[1] - x[0]), height / (z[1] - z[0])), Z = (v) => height - (v - z[0]) * scale;
  let middle = fixed?.x ?? 0.5 * (x[0] + x[1]);
  const X = (v) => width / 2 + (v - middle) * scale;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label });
  const add = (name, attributes, ...children) => drawing.appendChild(svg(name, attributes, ...children));
  add("rect", { x: 0, y: Z(0), width, height: height - Z(0), fill: "var(--sand)" });
  const ground = add("g", {});
  const print = add("path", { fill: "var(--paper)", stroke: "none" }), rims = add("path", { class: "rims", fill: "var(--sand)", stroke: "none" });
  const surface = add("path", { fill: "none", stroke: "var(--surface)", "stroke-width": 1.5, "data-print": walk.surface ? "computed" : "drawn" });
  const names = add("g", {});
  const ghost = other && [LEFT, RIGHT].map(() => add("path", { class: "ghost" }));
  const parts = walk.at.length / 2, scheme = PAINTS[paint];
  const body = [LEFT, RIGHT].map((foot) => ({
    shape: add("path", { fill: LINES[foot].stroke, "fill-opacity": 0.16 }),
    leg: add("path", { fill: "none", stroke: LINES[foot].stroke, "stroke-width": close ? 5 : 4, "stroke-opacity": 0.75, "stroke-linejoin": "round" }),
    joints: add("path", { fill: "none", stroke: "var(--ink)", "stroke-width": 6, "stroke-linecap": "round" }),
    sole: add("path", { fill: "none", stroke: scheme ? "var(--ink)" : LINES[foot].stroke, "stroke-width": scheme ? 7 : 2.5 }),
    paints: scheme ? Array.from({ length: parts }, () => add("path", { class: "paint", fill: "none", "stroke-width": 4.5 })) : [],
    arrows: add("path", { fill: "none", stroke: "var(--ink)", "stroke-width": 1.3 }),
    name: add("text", { class: "halo", "text-anchor": "middle" }),
  }));
  const hip = add("circle", { r: close ? 0 : 8, fill: "var(--ink)" });
  const largest = close
    ? walk.arrows.reduce((most, _, i, a) => (i % 2 ? most : Math.max(most, Math.hypot(a[i], a[i + 1]))), 1)
    : walk.force.reduce((most, v) => Math.max(most, Math.abs(v)), 1);
  // pixels per newton; below the deepest sole an arrow has room
  const reach = ((close ? 0.85 * (deepest(walk) - z[0]) : 0.35 * (z[1] - z[0])) * scale) / largest;
  const round = 10 ** Math.floor(Math.log10((0.7 * largest)));
  const unit = [5, 2, 1].find((m) => m * round <= 0.7 * largest) * round;
  add("path", { d: arrow([8, 12], [8 + unit * reach, 12]), fill: "none", stroke: "var(--ink)", "stroke-width": 1.3 });
  add("text", { class: "halo", x: 14 + unit * reach, y: 16 }, `${unit} N`);
  let ends = [0, 1];
  if (scheme) {
    const all = Array.from({ length: 60 }, (_, i) => (i * walk.t.at(-1)) / 59).flatMap((t) => [LEFT, RIGHT].flatMap((foot) => scheme.of(walk, instant(walk, t), foot, t)));
    ends = range(all, 0);
    for (let i = 0; i < 30; i++) add("rect", { x: 8 + 4 * i, y: 26, width: 4.5, height: 8, fill: ramp(i / 29) });
    add("text", { class: "halo", x: 8, y: 48 }, `${number(ends[0])} to ${number(ends[1])}: ${scheme.title}`);
  }
  const pull = data.ground?.gravity;
  if (pull) {
    add("path", { class: "gravity", d: arrow([width - 60, 24], [width - 60 + 44 * pull.x, 24 - 44 * pull.z]), fill: "none", stroke: "var(--ink)", "stroke-width": 1.8 });
    add("text", { class: "halo", x: width - 8, y: 16, "text-anchor": "end" }, pull.label);
  }
  if (close && !walk.surface) add("text", { class: "halo", x: width - 8, y: pull ? height - 24 : 16, "text-anchor": "end", "font-style": "italic" }, "the print is drawn, not computed");
  holder.replaceChildren(drawing);
  const low = walk.surface ? null : printed(walk);
  const to = ([u, v]) => [X(u), Z(v)], line = (points) => path(points.map(to));
  return (t) => {
    const now = instant(walk, t), half = width / 2 / scale;
    if (!fixed && close) middle = now.com[0];
    const inView = ([u]) => Math.abs(u - middle) < half + 0.01;
    const top = (low ? low(t) : walk.surface(t)).filter(inView);
    print.setAttribute("d", `${line([[middle - half, 0], ...top, [middle + half, 0]].map(([u, v]) => [u, Math.min(v, 0)]))}Z`);
    rims.setAttribute("d", low ? "" : `${line([[middle - half, 0], ...top, [middle + half, 0]].map(([u, v]) => [u, Math.max(v, 0)]))}Z`);
    surface.setAttribute("d", line(top));
    const found = strips({ X, Z, width, height });
    ground.replaceChildren(...found.map(([sand]) => sand));
    names.replaceChildren(...found.map(([, name]) => name), ...ticks(middle - half, middle + half, width / 110).values.flatMap((v) => [
      svg("line", { x1: X(v), x2: X(v), y1: height - 6, y2: height, stroke: "var(--grey)" }),
      ...(X(v) > 24 && X(v) < width - 24 ? [svg("text", { x: X(v), y: height - 9, "text-anchor": "middle" }, `${+v.toFixed(2)} m`.replace("-", "−"))] : [])]));
    if (ghost) {
      const past = Math.min(t, other.t.at(-1)), behind = pose(other, past), shift = fixed ? fixed.shift : now.com[0] - behind[0].leg[0][0];
      behind.forEach(({ leg, carry }, side) => ghost[side].setAttribute("d",
        `${line(carry(other.shape).map(([u, v]) => [u + shift, v]))}Z${close ? "" : line(leg.map(([u, v]) => [u + shift, v]))}`));
    }
    now.feet.forEach((foot, side) => {
      const part = body[side], ankle = to(foot.leg[2]);
      part.shape.setAttribute("d", line(foot.shape) + "Z");
      part.sole.setAttribute("d", line(foot.sole));
      if (scheme) scheme.of(walk, now, side, t).forEach((v, i) => {
        part.paints[i].setAttribute("d", foot.sole.slice(1).map((p, j) => (walk.part[j] === i ? line([foot.sole[j], p]) : "")).join(""));
        part.paints[i].setAttribute("stroke", ramp((v - ends[0]) / (ends[1] - ends[0])));
      });
      part.leg.setAttribute("d", line(foot.leg));
      part.joints.setAttribute("d", foot.leg.slice(1).map((p) => { const [u, v] = to(p); return `M${u} ${v}h.01`; }).join(""));
      const shown = close ? foot.forces : [resultant(foot.forces)];
      part.arrows.setAttribute("d", shown.filter(({ at: place }) => place).map(({ at: place, f }) => {
        const end = to(place), tip = [end[0] + reach * f[0], end[1] - reach * f[1]];
        return close ? arrow([2 * end[0] - tip[0], 2 * end[1] - tip[1]], end) : arrow(end, tip);
      }).join(""));
      part.name.setAttribute("x", ankle[0]);
      part.name.setAttribute("y", ankle[1] - (close ? 34 : 14));
      part.name.textContent = close ? SIDES[side] : "";
    });
    hip.setAttribute("cx", X(now.com[0]));
    hip.setAttribute("cy", Z(now.com[1]));
  };
}

/** Sand of other strengths, as figures and films draw it. */
function strips({ X, Z, width, height }) {
  return (data.ground?.strips ?? []).flatMap((s) => {
    const [left, right] = [s.begin === null ? 0 : Math.max(X(s.begin), 0), s.end === null ? width : Math.min(X(s.end), width)];
    const [top, bottom] = [Z(s.top), s.bottom === null ? height : Math.min(Z(s.bottom), height)];
    if (left >= right || top >= bottom) return [];
    const patch = s.kind === "patch";
    return [[svg("rect", { class: "strip", x: left, y: top, width: right - left, height: bottom - top, fill: s.colour, stroke: "var(--surface)", "stroke-width": 0.6 }),
      svg("text", { class: "on-sand", x: patch ? left + 4 : right - 4, y: patch ? top + 16 : Math.min(bottom - 5, top + 26), "text-anchor": patch ? "start" : "end" }, s.label)]];
  });
}

/** The lowest point of any sole in a walk, or between two of its times, m. */
function deepest(walk, from = 0, to = Infinity) {
  const all = to === Infinity;
  if (all && walk.lowest !== undefined) return walk.lowest;
  let low = 0;
  for (let i = 0; i < walk.t.length; i += 4) if (walk.t[i] >= from && walk.t[i] <= to)
    for (const { carry } of pose(walk, walk.t[i])) for (const p of carry(walk.light)) low = Math.min(low, p[1]);
  if (all) walk.lowest = low;
  return low;
}
