// The force of the sand on both feet, as footopt/gait, foot, effects and walk/contact.py compute it.
// Functions have the names that they have there. All constants are the run's own, in data.physics.

const P = data.physics ?? {};
// of both feet's forces: x, z, power, xx, xz, zx, zz of the left, then the right; last along_x, along_z of both
const [LEFT_POWER, RIGHT_POWER, ALONG, FORCES] = [2, 9, 14, 18];

// --- the gait: footopt/gait ----------------------------------------------------------------------------------

/** theta(p) = a0 + sum a cos(2 pi k p) + b sin(2 pi k p), rad, and its derivative by the phase. */
function fourier({ a0, a, b }, phase) {
  let value = a0, rate = 0;
  for (let k = 1; k <= a.length; k++) {
    const w = 2 * Math.PI * k, c = Math.cos(w * phase), s = Math.sin(w * phase);
    value += a[k - 1] * c + b[k - 1] * s;
    rate += w * (b[k - 1] * c - a[k - 1] * s);
  }
  return [value * (Math.PI / 180), rate * (Math.PI / 180)];
}

const smoothStep = (s) => [s ** 3 * (10 - 15 * s + 6 * s * s), 30 * s * s * (1 - s) ** 2];

/** A foot relative to the hip at t: x, z, vx, vz of the ankle, cos and sin of the pitch, its rate. */
function footPose(t, foot, table, at) {
  const { thigh, knee, pitch, start, period, standing } = P.gait, { l1, l2 } = P.walker;
  const r = period / 2, since = t - (start ?? Infinity), s = clip(since / r, 0, 1);
  const phase = 0.25 + 0.5 * s ** 4 * (2.5 - 3 * s + s * s) + Math.max(since - r, 0) / period + 0.5 * foot;
  const phaseRate = smoothStep(s)[0] / period, blend = foot ? r : period / 3;
  let [w, wRate] = smoothStep(clip(since / blend, 0, 1));
  wRate /= blend;
  const [a, aRate] = fourier(thigh, phase), [b, bRate] = fourier(knee, phase), shank = [a - b, aRate - bRate];
  const [[th, dth], [sh, dsh], [turn, rate]] = [[a, aRate], shank, pitch ? fourier(pitch, phase) : shank].map(
    ([angle, by], joint) => [(1 - w) * standing[joint][foot] + w * angle, wRate * (angle - standing[joint][foot]) + w * by * phaseRate]);
  const st = Math.sin(th), ct = Math.cos(th), ss = Math.sin(sh), cs = Math.cos(sh);
  table[at] = l1 * st + l2 * ss;
  table[at + 1] = -l1 * ct - l2 * cs;
  table[at + 2] = l1 * ct * dth + l2 * cs * dsh;
  table[at + 3] = l1 * st * dth + l2 * ss * dsh;
  table[at + 4] = Math.cos(turn);
  table[at + 5] = Math.sin(turn);
  table[at + 6] = rate;
}

/** A quantity and its rate at the share s of a step, from both at the step's ends (cubic Hermite). */
function hermite(v0, v1, a0, a1, h, s) {
  const rise = v1 - v0, q = 3 * rise - h * (2 * a0 + a1), r = h * (a0 + a1) - 2 * rise;
  return [v0 + s * (h * a0 + s * (q + s * r)), a0 + (s * (2 * q + 3 * s * r)) / h];
}

/** A foot's pose at the share s of a step of h seconds, into a table, from those at the step's ends. */
function poseBetween(first, i, last, j, h, s, table, at) {
  for (let k = 0; k < 2; k++) // x and z
    [table[at + k], table[at + 2 + k]] = hermite(first[i + k], last[j + k], first[i + 2 + k], last[j + 2 + k], h, s);
  const [a, b] = [first.subarray(i + 4, i + 7), last.subarray(j + 4, j + 7)]; // cosine, sine, rate
  const [cos, cosRate] = hermite(a[0], b[0], -a[1] * a[2], -b[1] * b[2], h, s);
  const [sin, sinRate] = hermite(a[1], b[1], a[0] * a[2], b[0] * b[2], h, s);
  table.set([cos, sin, cos * sinRate - sin * cosRate], at + 4);
}

/** Ends of the time steps, and the poses at their nodes for whole steps, halves, quarters: made when first asked for. */
const motions = new Map();
function motion(dt) {
  if (motions.has(dt)) return motions.get(dt);
  const start = P.gait.start ?? Infinity, { end } = P, { rest, control, gamma } = P.accuracy, times = [];
  const steps = (length) => Math.max(1, Math.ceil(length / dt - 1e-9));
  const standing = start > 0 && start < end ? Math.ceil(start / (rest * dt) - 1e-9) : 0, from = standing ? start : 0;
  for (let k = 0; k < standing; k++) times.push((start * k) / standing);
  const n = steps(end - from);
  for (let k = 0; k <= n; k++) times.push(from + ((end - from) * k) / n);
  const [tabled, traced, finest] = control === null ? [0, 0, 0] : ['tabled', 'traced', 'halvings'].map((name) => P.accuracy[name]), nodes = [gamma, 1], pose0 = new Float64Array(14);
  const tables = Array.from({ length: tabled + 1 }, (_, level) => new Float64Array(28 * (times.length - 1) * 2 ** level).fill(NaN));
  while (tables.length <= finest) tables.push(new Float64Array(28)); // of the step that is asked for last
  /** Where in a level's table both nodes of a step are, 28 numbers. */
  const poses = (level, index) => {
    const table = tables[level], n0 = index >> level;
    if (level > tabled) {
      const parts = 2 ** (level - tabled), whole = Math.floor(index / parts), h = (times[n0 + 1] - times[n0]) / 2 ** tabled;
      const [begin, from] = whole ? [tables[tabled], poses(tabled, whole - 1) + 14] : [pose0, 0], to = poses(tabled, whole) + 14;
      for (let i = 0; i < 4; i++)
        poseBetween(begin, from + 7 * (i & 1), tables[tabled], to + 7 * (i & 1), h, (index % parts + nodes[i >> 1]) / parts, table, 7 * i);
      return 0;
    }
    const at = 28 * index, part = index - (n0 << level);
    if (Number.isNaN(table[at])) {
      for (let i = 0; i < 4; i++) // two nodes, two feet
        footPose(times[n0] + (times[n0 + 1] - times[n0]) * ((part + nodes[i >> 1]) / 2 ** level), i & 1, table, at + 7 * i);
    }
    return at;
  };
  footPose(0, 0, pose0, 0);
  footPose(0, 1, pose0, 7);
  const made = { times, traced, finest, tables, poses, pose0 };
  motions.set(dt, made);
  return made;
}

// --- the sole: footopt/foot ----------------------------------------------------------------------------------

/** Points at equal steps along the arc of the spline through heights k, [x, z, x, z, ...], m. */
function arcPoints(k, steps) {
  const { n, L, fine } = space, { z, cubic } = spline(k), spacing = (2 * L) / (n - 1);
  const pieces = (n - 1) * fine, arc = new Float64Array(pieces + 1), out = new Float64Array(2 * steps + 2);
  for (let j = 0, before = 0; j <= pieces; j++) {
    const speed = cubic(j / fine, (i, s, d0, q, c) => Math.hypot(spacing, d0 + s * (2 * q + 3 * s * c)));
    if (j > 0) arc[j] = arc[j - 1] + 0.5 * (before + speed);
    before = speed;
  }
  for (let m = 0, j = 0; m <= steps; m++) {
    const at = (arc[pieces] * m) / steps;
    while (j < pieces - 1 && arc[j + 1] < at) j++;
    const u = (j + clip((at - arc[j]) / (arc[j + 1] - arc[j]), 0, 1)) / fine;
    out[2 * m] = spacing * (u - 0.5 * (n - 1));
    out[2 * m + 1] = cubic(u, (i, s, d0, q, c) => z[i] + s * (d0 + s * (q + s * c)));
  }
  return out;
}

/** Plates: place, cos and sin of twice the angle, area, direction, turn; `span` that one stands for. Those of the run's sole, if it has no heights k. */
function plates(k) {
  if (!k) return Object.fromEntries(Object.entries(P.plates).map(([name, of]) => [name, name === "span" ? of : unpack(of)]));
  const { parts } = P.accuracy, points = arcPoints(k, P.accuracy.plates * parts);
  const count = (points.length / 2 - 1) / parts, [ankleX, ankleZ] = P.foot.ankle;
  const [x, z, c2, s2, area, tx, tz, turn] = Array.from({ length: 8 }, () => new Float64Array(count));
  let whole = 0;
  for (let i = 0; i < count; i++) {
    let total = 0;
    for (let j = 2 * i * parts, end = 2 * (i + 1) * parts; j < end; j += 2) {
      const dx = points[j + 2] - points[j], dz = points[j + 3] - points[j + 1], square = Math.max(dx * dx + dz * dz, 1e-60);
      const length = Math.sqrt(square);
      total += length;
      x[i] += (0.5 * (points[j + 2] + points[j]) - ankleX) * length;
      z[i] += (0.5 * (points[j + 3] + points[j + 1]) - ankleZ) * length;
      c2[i] += ((dx * dx - dz * dz) / square) * length;
      s2[i] += ((2 * dx * dz) / square) * length;
      tx[i] += dx;
      tz[i] += dz;
    }
    for (const column of [x, z, c2, s2]) column[i] /= total;
    const norm = Math.hypot(tx[i], tz[i]) || 1;
    tx[i] /= norm;
    tz[i] /= norm;
    let spread = 0;
    for (let j = 2 * i * parts, end = 2 * (i + 1) * parts; j < end; j += 2) {
      const dx = points[j + 2] - points[j], dz = points[j + 3] - points[j + 1], across = dx * tz[i] - dz * tx[i];
      spread += across * across / Math.sqrt(Math.max(dx * dx + dz * dz, 1e-60));
    }
    turn[i] = Math.sqrt((12 * spread) / total);
    area[i] = total * P.foot.width;
    whole += total;
  }
  return { x, z, c2, s2, area, tx, tz, turn, span: parts > 1 ? whole / count : 0 };
}

// --- the contact: footopt/walk/contact.py, footopt/effects -----------------------------------------------------

const load = new Float64Array(3), gate = new Float64Array(2), push = new Float64Array(3); // values and derivatives
const EFFECTS = {
  layers: ({ depths, jumps }) => [load, (depth) => {
    for (let i = 0; i < depths.length; i++) if (depth > depths[i]) { load[0] += jumps[i] * (depth - depths[i]); load[1] += jumps[i]; }
  }],
  patches: ({ begins, ends, extra, blur }) => [load, (depth, x) => {
    let strength = 1, change = 0;
    for (let i = 0; i < begins.length; i++) {
      const s = clip((x - begins[i]) / blur + 0.5, 0, 1), r = clip((x - ends[i]) / blur + 0.5, 0, 1);
      strength += extra[i] * (s * s * (3 - 2 * s) - r * r * (3 - 2 * r));
      change += (extra[i] * (s * (1 - s) - r * (1 - r)) * 6) / blur;
    }
    load[2] = load[2] * strength + load[0] * change;
    load[0] *= strength;
    load[1] *= strength;
  }],
  leading_edge: () => [gate, (vn, creep) => {
    const s = clip(vn / creep, -1, 1), step = 0.5 + s * (0.75 - 0.25 * s * s);
    gate[1] = gate[1] * step + gate[0] * ((0.75 * (1 - s * s)) / creep);
    gate[0] *= step;
  }],
  inertia: ({ density, skin }) => [push, (vn, depth) => {
    const speed = Math.max(vn, 0), part = Math.min(depth / skin, 1), pressure = density * speed * speed;
    push[0] += part * pressure;
    push[1] += 2 * density * part * speed;
    if (depth < skin) push[2] += pressure / skin;
  }],
};
let loads, gates, pushes;
/** Walk with these effects from now on. */
function takeEffects(effects) {
  const hooks = Object.entries(effects ?? {}).map(([name, law]) => EFFECTS[name](law));
  [loads, gates, pushes] = [load, gate, push].map((state) => hooks.filter(([of]) => of === state).map(([, hook]) => hook));
}
takeEffects(P.effects);

/** The law in N/m^3 and the mass, kg, of a walk. */
function world(zeta, mass) {
  const unit = zeta * P.sand.gravity * P.sand.unit;
  return { mass, ...Object.fromEntries(Object.entries(P.sand.law).map(([name, c]) => [name, unit * c])) };
}

/** F = sum f over a foot's plates (the paper's eqs. 1 and 2), its power and derivatives, into `out`. */
function footForce(W, sole, poses, p, hipX, hipZ, hipVx, hipVz, creep, c, out, foot, each) {
  const { x: X, z: Z, c2: C2, s2: S2, area, tx, tz } = sole, { A00, A10, B01, B_sum, B_diff, C01, C_sum, C_diff, D10 } = W;
  const ax = hipX + poses[p], az = hipZ + poses[p + 1], avx = hipVx + poses[p + 2], avz = hipVz + poses[p + 3];
  const cos = poses[p + 4], sin = poses[p + 5], rate = poses[p + 6];
  const c2p = cos * cos - sin * sin, s2p = 2 * sin * cos;
  const along = rate * sole.span, { turn, exposed, bent } = P.accuracy, eps2 = creep * creep + (turn * along) ** 2;
  let fx = 0, fz = 0, power = 0, xx = 0, xz = 0, zx = 0, zz = 0, alongX = 0, alongZ = 0;
  for (let i = 0; i < X.length; i++) {
    const rise = sin * X[i] + cos * Z[i], depth = -(az + rise);
    if (depth <= 0) continue;
    const vx = avx - rate * rise, vz = avz + rate * cos * X[i] - rate * sin * Z[i];
    let k = area[i] * depth;
    const q = 1 / Math.sqrt(vx * vx + vz * vz + eps2), hx = vx * q, hz = vz * q; // h = v / |v|, smoothed
    // eq. 1: the stress per depth, p = a - M h, with cos and sin of twice the plate's angle in the world
    const C = C2[i] * c2p - S2[i] * s2p, S = S2[i] * c2p + C2[i] * s2p;
    const mxx = C01 + C_sum * C, mxz = C_diff * S, mzx = -B_diff * S, mzz = B01 + B_sum * C;
    const turnedX = mxx * hx + mxz * hz, turnedZ = mzx * hx + mzz * hz; // M h
    let px = -D10 * S - turnedX, pz = A00 + A10 * C - turnedZ;
    let sinking = c * area[i], byX = 0, byDepth = 1; // sinking = -dk/dv_z
    if (loads.length) {
      load[0] = depth;
      load[1] = 1;
      load[2] = 0;
      for (const hook of loads) hook(depth, ax + cos * X[i] - sin * Z[i]);
      k = area[i] * load[0];
      byDepth = load[1];
      byX = load[2];
    }
    let kq = k * q, fxi = 0, fzi = 0, jxx = 0, jxz = 0, jzx = 0, jzz = 0; // dh/dv = (I - h h^T) / |v|
    if (gates.length || pushes.length) {
      const nx = sin * tx[i] + cos * tz[i], nz = sin * tz[i] - cos * tx[i], vn = vx * nx + vz * nz; // outward normal
      if (gates.length) {
        gate[0] = 1;
        gate[1] = 0;
        const bend = (bent * sole.turn[i]) ** 2, wide2 = creep * creep + (exposed * along) ** 2 + bend * (vx * vx + vz * vz);
        for (const hook of gates) hook(vn, Math.sqrt(wide2));
        const by = k * gate[1], wider = (vn * bend) / wide2, gx = nx - wider * vx, gz = nz - wider * vz;
        jxx += by * px * gx;
        jxz += by * px * gz;
        jzx += by * pz * gx;
        jzz += by * pz * gz;
        kq *= gate[0];
        px *= gate[0];
        pz *= gate[0];
      }
      if (pushes.length) {
        push.fill(0);
        for (const hook of pushes) hook(vn, depth);
        const a = area[i] * push[0], byVn = area[i] * push[1];
        fxi = -a * nx;
        fzi = -a * nz;
        power -= a * vn;
        jxx -= byVn * nx * nx;
        jxz -= byVn * nx * nz - sinking * push[2] * nx;
        jzx -= byVn * nx * nz;
        jzz -= byVn * nz * nz - sinking * push[2] * nz;
      }
    }
    fxi += k * px;
    fzi += k * pz;
    fx += fxi;
    fz += fzi;
    power += k * (px * vx + pz * vz); // eq. 7
    if (each) each(i, fxi, fzi);
    jxx += sinking * byX * px;
    jzx += sinking * byX * pz;
    sinking *= byDepth;
    jxz -= sinking * px;
    jzz -= sinking * pz;
    jxx -= kq * (mxx - turnedX * hx); // M dh/dv = (M - (M h) h^T) / |v|
    jxz -= kq * (mxz - turnedX * hz);
    jzx -= kq * (mzx - turnedZ * hx);
    jzz -= kq * (mzz - turnedZ * hz);
    xx += jxx;
    xz += jxz;
    zx += jzx;
    zz += jzz;
    if (gates.length) [alongX, alongZ] = [alongX + jxx * vx + jzx * vz, alongZ + jxz * vx + jzz * vz];
  }
  const o = 7 * foot, a = ALONG + 2 * foot;
  out[o] = fx; out[o + 1] = fz; out[o + 2] = power;
  out[o + 3] = xx; out[o + 4] = xz; out[o + 5] = zx; out[o + 6] = zz;
  out[a] = alongX; out[a + 1] = alongZ;
}

/** The force of the sand on both feet. */
function contact(W, sole, poses, p, x, z, vx, vz, creep, c, out) {
  for (const foot of [0, 1]) footForce(W, sole, poses, p + 7 * foot, x, z, vx, vz, creep, c, out, foot);
}

/** The speed over which a plate's direction turns; a gate opens over no less. */
function smoothSpeed(sole, rate, creep) {
  const within = P.accuracy.turn * rate * sole.span;
  return Math.sqrt(creep * creep + within * within);
}

/** The deepest plate of a foot: the hip's velocity at which it rests, the speed over which it turns, its height above the hip. */
function deepestPlate(sole, poses, p, foot, creep) {
  const o = p + 7 * foot, cos = poses[o + 4], sin = poses[o + 5], rate = poses[o + 6];
  let i = 0, height = Infinity;
  for (let j = 0; j < sole.x.length; j++) {
    const level = poses[o + 1] + sin * sole.x[j] + cos * sole.z[j];
    if (level < height) [i, height] = [j, level];
  }
  const rise = sin * sole.x[i] + cos * sole.z[i], along = cos * sole.x[i] - sin * sole.z[i];
  return { foot, height, vx: -(poses[o + 2] - rate * rise), vz: -(poses[o + 3] + rate * along), speed: smoothSpeed(sole, rate, creep) };
}

/** Hip height at which the limit forces of downward motion carry the weight; NaN if they do not. */
function staticHeight(W, sole, pose0) {
  const { x, z, c2, s2, area, tx, tz } = sole;
  const each = (take) => {
    for (const p of [0, 7]) for (let i = 0; i < x.length; i++) take(p, i, pose0[p + 4], pose0[p + 5]);
  };
  const lift = (height) => {
    let total = 0;
    each((p, i, cos, sin) => {
      const depth = -(height + pose0[p + 1] + sin * x[i] + cos * z[i]);
      if (depth <= 0) return;
      const c = c2[i] * (cos * cos - sin * sin) - s2[i] * (2 * sin * cos);
      load.set([depth, 1, 0]);
      gate.set([1, 0]);
      for (const hook of loads) hook(depth, pose0[p] + cos * x[i] - sin * z[i]);
      for (const hook of gates) hook(cos * tx[i] - sin * tz[i], Math.max(P.accuracy.bent * sole.turn[i], 1e-9));
      total += area[i] * load[0] * (W.A00 + W.B01 + (W.A10 + W.B_sum) * c) * gate[0];
    });
    return total;
  };
  let low = 0, high = -Infinity;
  each((p, i, cos, sin) => { high = Math.max(high, -(pose0[p + 1] + sin * x[i] + cos * z[i])); });
  const weight = W.mass * P.gravity.g;
  if (high <= low || lift(low) < weight) return NaN;
  for (let i = 0; i < 60; i++) {
    const middle = 0.5 * (low + high);
    if (lift(middle) >= weight) low = middle; else high = middle;
  }
  return low;
}
