// The stage: legs, soles, forces and the ground at one instant of a walk.

const RIGHT = 1, SIDES = data.sides ?? ["left", "right"], LOOKS = ["left", "right"];
const LINES = [{ stroke: "var(--left)" }, { stroke: "var(--right)", "stroke-dasharray": "7 3" }];

const gait = data.gait && { ...data.gait, angles: unpack(data.gait.angles) };

/** Thigh, shank and pitch of a leg at a time, rad. */
function legAngles(t, foot) {
  const rows = gait.angles.length / 6, at = clip(t / gait.end, 0, 1) * (rows - 1);
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
    for (const name of ["t", "com", "velocity", "force", "power", "work", "at", "when", "arrows", "legs"])
      walk[name] = raw[name] ? unpack(raw[name]) : [];
    opened.set(place, prepared(walk));
  }
  return opened.get(place);
}

/** A walk with what pictures of it need: fewer points, and an outline. */
function prepared(walk) {
  const every = Math.max(1, Math.floor(walk.points.length / Math.max(80, 4 * (space?.n ?? 0))));
  walk.light = walk.points.filter((_, i) => i % every === 0 || i === walk.points.length - 1);
  walk.shape = outline(walk.light, walk.top);
  return walk;
}

/** Values of a trace with so many columns at a time, in a straight line between samples. */
function at(walk, name, width, t, times = walk.t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const part = clip((t - times[low]) / (times[high] - times[low] || 1), 0, 1);
  const values = walk[name];
  return Array.from({ length: width }, (_, i) => values[low * width + i] * (1 - part) + values[high * width + i] * part);
}

/** Joints of a leg of a walk at a time, m, and the pitch of its foot, rad: traced, or of the gait. */
function legPose(walk, t, foot) {
  if (walk.legs?.length) {
    const width = walk.legs.length / walk.t.length / SIDES.length, row = at(walk, "legs", SIDES.length * width, t).slice(foot * width, (foot + 1) * width);
    return [pairs(row.slice(0, -1)), row.at(-1)];
  }
  const [x, z] = at(walk, "com", 2, t), [thigh, shank, pitch] = legAngles(t, foot);
  const knee = [x + gait.l1 * Math.sin(thigh), z - gait.l1 * Math.cos(thigh)];
  return [[[x, z], knee, [knee[0] + gait.l2 * Math.sin(shank), knee[1] - gait.l2 * Math.cos(shank)]], pitch];
}

/** Where legs and soles are at a time, m: of each foot its joints, and what carries a point of the foot there. */
function pose(walk, t) {
  return SIDES.map((_, foot) => {
    const [leg, pitch] = legPose(walk, t, foot), ankle = leg.at(-1);
    const c = Math.cos(pitch), s = Math.sin(pitch);
    const turn = ([u, v]) => [ankle[0] + c * u - s * v, ankle[1] + s * u + c * v];
    const carry = (points) => points.map(([u, v]) => turn([u - walk.ankle[0], v - walk.ankle[1]]));
    return { leg, c, s, turn, carry };
  });
}

/** Where everything is at a time, m and N. */
function instant(walk, t) {
  const parts = pairs(walk.at), arrows = at(walk, "arrows", 2 * SIDES.length * parts.length, t, walk.when);
  const feet = pose(walk, t).map(({ leg, turn, carry }, foot) => ({ leg, shape: carry(walk.shape), sole: carry(walk.light),
    forces: parts.map((p, i) => ({ at: turn(p), f: arrows.slice(2 * (foot * parts.length + i)).slice(0, 2) })) }));
  return { com: at(walk, "com", 2, t), feet };
}

const size = ([x, z]) => Math.hypot(x, z);
const largest = (values) => values.reduce((a, b) => Math.max(a, Math.abs(b)), 1e-12);

/** Lengths of a walk's legs and soles over those of the paper's walker, for which the pictures are framed. */
function sizes(walk) {
  const { leg } = pose(walk, walk.t[0])[0], [low, high] = range(walk.points.map(([x]) => x), 0);
  return { legs: leg.slice(1).reduce((sum, [x, z], i) => sum + size([x - leg[i][0], z - leg[i][1]]), 0) / 0.92, sole: (high - low) / 0.26 };
}

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

/** Arrows [x, z, u, w] as one line with gaps; short ones would be heads alone. */
const arrows = (unit, all) => all.flatMap(([x, z, u, w]) => {
  const long = Math.hypot(u, w), head = Math.min((1.3 * unit) / Math.max(long, unit), 0.5), tip = [x + u, z + w];
  if (!(long > 0.8 * unit)) return [];
  return [[x, z], tip, GAP, [tip[0] - head * (u + 0.4 * w), tip[1] - head * (w - 0.4 * u)], tip, [tip[0] - head * (u - 0.4 * w), tip[1] - head * (w + 0.4 * u)], GAP];
});
const GAP = [NaN, NaN];

/** Sand with its strips and its surface, gravity and the key of arrows: [class, points (m), style] from behind to the front, and [x, z, text, anchor]. */
function groundPicture({ left, right, low, high, unit, metres, newtons, close }) {
  const { strips, gravity } = data.ground, words = [["key", left + metres * newtons + 2 * unit, low + 1.5 * unit, `${number(newtons)} N`]];
  const box = (a, b, c, d) => [[a, c], [a, d], [b, d], [b, c]], shapes = [["sand", box(left, right, low, 0)]];
  for (const { kind, begin, end, top: upper, bottom, colour, text } of strips) {
    const a = Math.max(begin, left), b = Math.min(end, right), c = Math.max(bottom, low);
    if (!(a < b && c < upper)) continue;
    shapes.push([kind, box(a, b, c, upper), `fill:${colour}`]);
    if (kind === "layer") words.push([kind, b - 0.6 * unit, Math.max(c + 1.3 * unit, upper - 3 * unit), text, "end"]);
    else if (text.length * unit <= b - a) words.push([kind, a + 0.6 * unit, Math.min(upper - 1.6 * unit, low + (close ? 5.7 : 1.5) * unit), text]);
  }
  shapes.push(["surface", [[left - 0.05, 0], [right + 0.05, 0]]]);
  for (const { x, z, words: [g, angle] } of gravity) {
    shapes.push(["gravity", arrows(unit, [[right - 4 * unit, high - 5.4 * unit, 6 * unit * x, 6 * unit * z]])]);
    words.push(["gravity", right - unit, high - 1.5 * unit, g, "end"], ["slope", right - unit, high - 4 * unit, angle, "end"]);
  }
  shapes.push(["key", arrows(unit, [[left + unit, low + 1.5 * unit, metres * newtons, 0]])]);
  return { shapes, words: words.map(([, ...word]) => word) };
}

/** Feet with their legs and forces and the hip, as `groundPicture` gives them. */
function bodyPicture(now, { left, right, unit, metres, close }, ghosts) {
  const shapes = ghosts.map((points) => ["ghost", points]), words = [];
  now.feet.forEach(({ leg, shape, sole }, foot) => {
    const side = LOOKS[foot], [x, z] = leg.at(-1);
    shapes.push([`${side}-foot`, shape], [`${side}-leg`, leg], [`${side}-joints dots`, leg.slice(1)], [`${side}-sole`, sole]);
    if (close && x > left + 3 * unit && x < right - 3 * unit) words.push([x, z + 5.5 * unit, SIDES[foot], "middle"]);
  });
  const forces = now.feet.flatMap((foot) => (close ? foot.forces : [resultant(foot.forces)])).filter(({ at: place }) => place);
  const drawn = forces.map(({ at: [x, z], f: [fx, fz] }) => [x - close * metres * fx, z - close * metres * fz, metres * fx, metres * fz]);
  shapes.push(["force", arrows(unit, drawn)], ["hip dots", [now.com]]);
  return { shapes, words };
}

/**
 * A stage in a holder; returns what moves it to an instant.
 *
 * `close` draws soles and the forces on their parts, else the whole walker. The camera goes with the COM, or
 * looks at x = `fixed`. `other` is drawn behind as a ghost, in step: its COM, or its ankle at `fixed`, in the same place.
 */
function stage(holder, walk, { close = false, x, z, label, other = null, fixed = null, tall = 330 }) {
  const width = widthOf(holder), axis = 18;
  const height = Math.min(tall, (width / (x[1] - x[0])) * (z[1] - z[0]) + (close ? 0 : 60)), above = height - axis;
  const scale = Math.min(width / (x[1] - x[0]), above / (z[1] - z[0])), half = width / 2 / scale;
  redrawn(holder, [["svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label }]]);
  const most = largest(close ? pairs(walk.arrows).map(size) : Array.from(walk.force));
  const metres = (close ? 0.85 * (deepest(walk) - z[0]) : 0.35 * (z[1] - z[0])) / most, round = 10 ** Math.floor(Math.log10(0.8 * most));
  const newtons = [5, 2, 1].find((m) => m * round <= 0.8 * most) * round;
  return (t) => {
    const now = instant(walk, t), middle = fixed?.x ?? (close ? now.com[0] : 0.5 * (x[0] + x[1]));
    const view = { left: middle - half, right: middle + half, low: z[0], high: z[0] + above / scale, unit: 6 / scale, metres, newtons, close };
    const X = (v) => (v - view.left) * scale, Z = (v) => above - (v - z[0]) * scale, line = (points) => path(points.map(([u, v]) => [X(u), Z(v)]));
    const ghosts = [];
    if (other) {
      const behind = pose(other, Math.min(t, other.t.at(-1))), shift = fixed ? fixed.shift : now.com[0] - behind[0].leg[0][0];
      for (const { leg, carry } of behind) for (const points of [[...carry(other.shape), carry(other.shape)[0]], ...(close ? [] : [leg])])
        ghosts.push(points.map(([u, v]) => [u + shift, v]));
    }
    const along = ticks(view.left, view.right, width / 110);
    const sand = groundPicture(view), body = bodyPicture(now, view, ghosts), words = [...sand.words, ...body.words];
    redrawn(holder.firstChild, [
      ...[...sand.shapes, ...body.shapes].filter(([, points]) => points.length).map(([name, points, style = ""]) => ["path", { class: name, style, d: name.endsWith("dots") ? points.map(([u, v]) => `M${X(u)} ${Z(v)}h.01`).join("") : line(points) }]),
      ["rect", { x: 0, y: above, width, height: axis, fill: "var(--paper)" }],
      ...[...words.map(([u, v, text, anchor]) => [X(u), Z(v) + 4, text, anchor]), ...along.values
        .filter((v) => X(v) > 24 && X(v) < width - 24).map((v) => [X(v), height - 2, `${+v.toFixed(Math.max(2, along.digits))} m`.replace("-", "−"), "middle"])]
        .map(([x, y, text, anchor = "start"]) => ["text", { class: "halo", x, y, "text-anchor": anchor }, text]),
      ...along.values.map((v) => ["line", { class: "axis", x1: X(v), x2: X(v), y1: above, y2: above + 4 }]),
    ]);
  };
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
