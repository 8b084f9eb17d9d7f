// The walk, as footopt/walk/newton.py, steppers/implicit.py, loop.py, metrics.py and objectives.py compute it.

// --- one step: footopt/walk/newton.py, steppers/implicit.py -----------------------------------------

const spare = new Float64Array(FORCES);
const implicit = { vx: 0, vz: 0, force: new Float64Array(FORCES), reversal: null };

/** Mean speed of a foot's plates, |P| / |F|: longer where it carries little of the force on both feet. */
function meanSpeed(F, o, both) {
  const force = Math.abs(F[o]) + Math.abs(F[o + 1]);
  return force === 0 ? Infinity : (Math.abs(F[o + 2]) / force) * Math.sqrt(both / force);
}

/** How a change of the velocity changes a foot's force, to first order. */
function changeOf(F, o, dvx, dvz) {
  return Math.abs(F[o + 3] * dvx + F[o + 4] * dvz) + Math.abs(F[o + 5] * dvx + F[o + 6] * dvz);
}

/** w at a velocity of the hip, and its rate; a plate is that of `deepestPlate`. */
function directionOf(plate, vx, vz) {
  const x = vx - plate.vx, z = vz - plate.vz, rate = 1 / Math.sqrt(x * x + z * z + plate.speed * plate.speed);
  return [x * rate, z * rate, rate];
}

/** The hip's velocity with a direction w; (vx, vz) where no motion reverses, or the foot slides. */
function velocityOf(plate, x, z, vx, vz) {
  const square = x * x + z * z, { inside } = P.accuracy;
  if (!plate || square > inside * inside) return [vx, vz];
  const speed = plate.speed / Math.sqrt(1 - square);
  return [plate.vx + speed * x, plate.vz + speed * z];
}

/** w half-way between those at two velocities of the hip. */
function halfWay(plate, vx, vz, toX, toZ) {
  if (!plate) return [1, 0];
  const [x, z] = directionOf(plate, vx, vz), [endX, endZ] = directionOf(plate, toX, toZ);
  return [0.5 * (x + endX), 0.5 * (z + endZ)];
}

/** The plate of the foot whose motion reverses between two velocities of the hip: that with the smaller w half-way. */
function reversingPlate(sole, poses, p, z, vx, vz, toX, toZ, creep) {
  let found = null, least = Infinity;
  for (const foot of [0, 1]) {
    const plate = deepestPlate(sole, poses, p, foot, creep), [wx, wz] = halfWay(plate, vx, vz, toX, toZ), size = wx * wx + wz * wz;
    if (z + plate.height < 0 && size < least) [found, least] = [plate, size];
  }
  return found;
}

/** The velocity after a step of Newton's method, as one of w. */
function stepped(plate, vx, vz, dvx, dvz) {
  if (!plate) return [vx + dvx, vz + dvz];
  const [x, z, rate] = directionOf(plate, vx, vz), along = x * dvx + z * dvz;
  return velocityOf(plate, x + rate * (dvx - x * along), z + rate * (dvz - z * along), vx + dvx, vz + dvz);
}

/** Velocity V of an implicit stage, V = v0 + c a(r0 + c V, V), by Newton's method from a guess; whether it was found. */
function solveStage(W, sole, poses, p, x0, z0, vx0, vz0, c, vx, vz, reversal) {
  const { newton, most, shortest, inside, gated, changed, changedGated, creep } = P.accuracy, F = implicit.force, inv = c / W.mass, { tilt, g } = P.gravity;
  let best = Infinity, dvx = 0, dvz = 0, part = 1, side = 1, plate = reversal && deepestPlate(sole, poses, p, reversal.foot, creep);
  if (plate && z0 + c * vz + plate.height >= 0) plate = null;
  if (plate) [vx, vz] = velocityOf(plate, reversal.x, reversal.z, vx, vz);
  const smooth = smoothSpeed(sole, Math.min(Math.abs(poses[p + 6]), Math.abs(poses[p + 13])), creep);
  let bestX = vx, bestZ = vz;
  for (let i = 0; i < most; i++) {
    contact(W, sole, poses, p, x0 + c * vx, z0 + c * vz, vx, vz, creep, c, F);
    const rx = vx - (tilt === null ? vx0 : vx0 + c * tilt) - inv * (F[0] + F[7]), rz = vz - vz0 - inv * (F[1] + F[8]) + c * g;
    const residual = rx * rx + rz * rz;
    if (residual <= best) {
      [best, bestX, bestZ, part] = [residual, vx, vz, gates.length ? Math.min(2 * part, 1) : 1];
      const jxx = 1 - inv * (F[3] + F[10]), jxz = -inv * (F[4] + F[11]), jzx = -inv * (F[5] + F[12]), jzz = 1 - inv * (F[6] + F[13]);
      const det = 1 / (jxx * jzz - jxz * jzx);
      dvx = (jxz * rz - jzz * rx) * det;
      dvz = (jzx * rx - jxx * rz) * det;
      const size = Math.abs(dvx) + Math.abs(dvz), rounding = 1e-13 * (1 + Math.abs(vx) + Math.abs(vz));
      const force = Math.abs(F[0]) + Math.abs(F[1]) + (Math.abs(F[7]) + Math.abs(F[8]));
      const speed = force === 0 ? creep : creep + Math.min(meanSpeed(F, 0, force), meanSpeed(F, 7, force));
      const enough = Math.min(newton * speed, plate ? gated * plate.speed : Infinity, gates.length ? gated * smooth : Infinity);
      const change = Math.max(changeOf(F, 0, dvx, dvz), changeOf(F, 7, dvx, dvz));
      if (size <= rounding || (force > 0 && size <= enough + rounding && change <= (gates.length ? changedGated : changed) * force)) {
        implicit.vx = vx + dvx;
        implicit.vz = vz + dvz;
        const [wx, wz] = plate ? directionOf(plate, implicit.vx, implicit.vz) : [1, 0];
        implicit.reversal = wx * wx + wz * wz > inside * inside ? null : { foot: plate.foot, x: wx, z: wz };
        for (const [o, a] of [[0, ALONG], [7, ALONG + 2]]) { // carried along the last step, to first order
          F[o] += F[o + 3] * dvx + F[o + 4] * dvz;
          F[o + 1] += F[o + 5] * dvx + F[o + 6] * dvz;
          F[o + 2] += F[a] * dvx + F[a + 1] * dvz + (F[o] * dvx + F[o + 1] * dvz);
        }
        return true;
      }
      [dvx, dvz] = [part * dvx, part * dvz];
      [vx, vz] = stepped(plate, vx, vz, dvx, dvz);
    } else if (!plate) { // half-way in w
      plate = reversingPlate(sole, poses, p, z0 + c * vz, bestX, bestZ, vx, vz, creep);
      const [x, z] = halfWay(plate, bestX, bestZ, vx, vz);
      [vx, vz] = velocityOf(plate, x, z, 0.5 * (bestX + vx), 0.5 * (bestZ + vz));
      best = Infinity;
    } else if (part > shortest) {
      [dvx, dvz, part] = [0.5 * dvx, 0.5 * dvz, 0.5 * part];
      [vx, vz] = stepped(plate, bestX, bestZ, dvx, dvz);
    } else { // a whole step away, on one side and on the other
      [vx, vz] = [bestX + (side * dvx) / part, bestZ + (side * dvz) / part];
      [best, part, side] = [Infinity, 1, -side];
    }
  }
  return false;
}

const accelX = (W, F) => (F[0] + F[7]) / W.mass + (P.gravity.tilt ?? 0);
const accelZ = (W, F) => (F[1] + F[8]) / W.mass - P.gravity.g;

/** Accumulate one stage: work of both feet, height, positive joint work. */
function accumulate(sums, weight, z, vx, vz, F) {
  const left = F[0] * vx + F[1] * vz - F[2], right = F[7] * vx + F[8] * vz - F[9];
  sums[0] += weight * F[LEFT_POWER];
  sums[1] += weight * F[RIGHT_POWER];
  sums[2] += weight * z;
  sums[3] += weight * Math.max(left, 0) + weight * Math.max(right, 0);
}

/** The state at t + h out of that at t, into `after`; whether the step could be made. */
function sdirk2(W, sole, poses, p, now, after, h) {
  const { gamma } = P.accuracy, c = gamma * h, r = (1 - gamma) * h, { x, z, vx, vz } = now;
  const ax = accelX(W, now.force), az = accelZ(W, now.force);
  after.sums.set(now.sums);
  if (!solveStage(W, sole, poses, p, x, z, vx, vz, c, vx + c * ax, vz + c * az, now.reversal)) return false;
  const ux = implicit.vx, uz = implicit.vz, bx = accelX(W, implicit.force), bz = accelZ(W, implicit.force);
  accumulate(after.sums, r, z + c * uz, ux, uz, implicit.force);
  const x1 = x + r * ux, z1 = z + r * uz;
  // the guess follows the change of acceleration so far, to the end of the step
  const guessX = ux + r * (bx + (bx - ax)), guessZ = uz + r * (bz + (bz - az));
  const solved = solveStage(W, sole, poses, p + 14, x1, z1, vx + r * bx, vz + r * bz, c, guessX, guessZ, implicit.reversal);
  after.vx = implicit.vx;
  after.vz = implicit.vz;
  after.x = x1 + c * implicit.vx;
  after.z = z1 + c * implicit.vz;
  after.force.set(implicit.force);
  after.reversal = implicit.reversal;
  accumulate(after.sums, c, after.z, implicit.vx, implicit.vz, implicit.force);
  return solved;
}

// --- the walk: footopt/walk/loop.py, metrics.py, objectives.py --------------------------------------------------

/** The velocity's extreme inside a step. */
function hermiteExtreme(v0, v1, a0, a1, h) {
  const rise = v1 - v0, p = h * a0, q = 3 * rise - h * (2 * a0 + a1), r = h * (a0 + a1) - 2 * rise;
  const root = Math.sqrt(Math.max(q * q - 3 * p * r, 0)), s = a0 < 0 ? -p / (q + root) : -p / (q - root);
  return hermite(v0, v1, a0, a1, h, Number.isFinite(s) ? clip(s, 0, 1) : 0)[0];
}
/** The largest of a quantity between the second and the third of four samples. */
function peak([a, b, c, d], [t0, t1, t2, t3]) {
  const before = t1 - t0, within = t2 - t1, after = t3 - t2, slope = (c - b) / within;
  const left = (slope - (b - a) / before) / (before + within), right = ((d - c) / after - slope) / (within + after);
  const begins = slope - left * within, ends = slope + right * within;
  if (!(begins > 0 && slope + left * within < 0 && slope - right * within > 0 && ends < 0)) return Math.max(b, c);
  const first = b - (0.25 * begins * begins) / left, last = c - (0.25 * ends * ends) / right;
  return right < P.accuracy.jump * left ? first : left < P.accuracy.jump * right ? last : 0.5 * (first + last);
}

/** Depth of the lowest end of a plate of both feet, m. */
function sinkage(sole, poses, p, z) {
  let depth = 0;
  for (const o of [p + 14, p + 21]) for (let i = 0; i < sole.x.length; i++) {
    const middle = z + poses[o + 1] + poses[o + 5] * sole.x[i] + poses[o + 4] * sole.z[i];
    const rise = sole.area[i] / P.foot.width * Math.abs(poses[o + 5] * sole.tx[i] + poses[o + 4] * sole.tz[i]);
    depth = Math.max(depth, 0.5 * rise - middle);
  }
  return depth;
}

/** Parts of a sole, `ARROWS` at most, whose forces are traced: of which each plate is. */
function groups(count) {
  const parts = Math.min(P.arrows, count), of = new Uint8Array(count);
  for (let j = 0; j < parts; j++) of.fill(j, Math.floor((count * j) / parts));
  return { parts, of };
}

const TRACE = 13, EVERY = 2; // steps: forces along soles cost as much as one of Newton's
/** Walk with plates: why it failed, its raw results, rows of `TRACE` numbers, and the forces along both soles at some of their times. */
function walkPlates(sole, zeta, mass, dt = P.accuracy.dt, repeat = 0) {
  const W = world(zeta, mass), { times, traced, finest, tables, poses, pose0 } = motion(dt), { control } = P.accuracy;
  let [now, after] = [0, 1].map(() => ({ x: 0, z: 0, vx: 0, vz: 0, force: new Float64Array(FORCES), sums: new Float64Array(4), reversal: null }));
  const { parts, of } = groups(sole.x.length), row = 1 << (finest - traced), most = (times.length - 1) << traced, rows = new Float64Array(TRACE * most);
  const when = [], arrows = new Float64Array(4 * parts * (Math.ceil(most / EVERY) + 1));
  const height = staticHeight(W, sole, pose0), strike = P.strike ?? Infinity;
  const end = (reason, raw = null) => ({ reason, raw, rows, made, when, arrows: arrows.subarray(0, 4 * parts * when.length) });
  let made = 0;
  if (!Number.isFinite(height)) return end("sunk");
  now.z = height;
  contact(W, sole, pose0, 0, 0, height, 0, 0, P.accuracy.creep, 0, now.force);
  let speed = -Infinity, fall = 0, power = 0, force = 0, deepest = 0, n = 0, place = 0, level = finest;
  const lefts = [0, 0, 0, 0], rights = [0, 0, 0, 0], both = [0, 0, 0, 0], ends = [0, 0, 0, 0]; // |P| and force of the last four steps
  while (n < times.length - 1) {
    const stride = 1 << (finest - level), h = (times[n + 1] - times[n]) / (1 << level);
    const index = (n << level) + place / stride, p = poses(level, index);
    const solved = sdirk2(W, sole, tables[level], p, now, after, h), F = after.force;
    const a0 = accelX(W, now.force), a1 = accelX(W, F);
    const left = Math.abs(F[LEFT_POWER]), right = Math.abs(F[RIGHT_POWER]);
    const error = Math.abs(after.vx - now.vx - 0.5 * h * (a0 + a1)) +
      Math.abs(after.vz - now.vz - 0.5 * h * (accelZ(W, now.force) + accelZ(W, F)));
    const near = power > 0 && Math.max(left, right) >= P.accuracy.near * power, allowed = near ? P.accuracy.peak * control : control;
    if (control !== null && level < finest && !(solved && error <= allowed)) {
      level++;
      continue;
    }
    if (!solved || !(Math.abs(after.vx) + Math.abs(after.vz) < 1e4)) {
      return repeat < P.accuracy.repeats ? walkPlates(sole, zeta, mass, P.accuracy.dt / 4 ** (repeat + 1), repeat + 1) : end("diverged");
    }
    if (after.z <= 0) return end("sunk");
    place += stride;
    const last = place === 1 << finest, t = last ? times[n + 1] : times[n] + (place / (1 << finest)) * (times[n + 1] - times[n]);
    if (last) {
      n++;
      place = 0;
    }
    for (let s = 0; s < 3; s++) {
      lefts[s] = lefts[s + 1];
      rights[s] = rights[s + 1];
      both[s] = both[s + 1];
      ends[s] = ends[s + 1];
    }
    lefts[3] = left;
    rights[3] = right;
    both[3] = F[1] + F[8];
    ends[3] = t;
    if (t > strike - 1e-9) { // objectives that begin with the first heel strike
      if (speed === -Infinity) {
        const share = clip(1 - (t - strike) / h, 0, 1);
        [speed] = hermite(now.vx, after.vx, a0, a1, h, share);
        power = Math.max(...[lefts, rights].map(([, , before, last]) => before + share * (last - before)));
      } else if (a0 * a1 < 0) {
        const extreme = hermiteExtreme(now.vx, after.vx, a0, a1, h);
        speed = Math.max(speed, extreme);
        fall = Math.max(fall, speed - extreme);
      }
      speed = Math.max(speed, after.vx);
      fall = Math.max(fall, speed - after.vx);
      power = Math.max(power, left, right);
      if (ends[1] > strike - 1e-9) power = Math.max(power, peak(lefts, ends), peak(rights, ends));
    }
    force = Math.max(force, both[3], ends[0] > 0 ? peak(both, ends) : 0);
    deepest = Math.max(deepest, sinkage(sole, tables[level], p, after.z));
    [now, after] = [after, now];
    if (place % row === 0) {
      rows.set([t, now.x, now.z, now.vx, now.vz, F[0], F[1], F[7], F[8], F[2], F[9], now.sums[0], now.sums[1]], TRACE * made);
      for (let foot = 0; foot < 2 && made % EVERY === 0; foot++) {
        const from = 4 * parts * when.length + 2 * parts * foot;
        footForce(W, sole, tables[level], p + 14 + 7 * foot, now.x, now.z, now.vx, now.vz, P.accuracy.creep, 0, spare, 0, (i, fx, fz) => {
          arrows[from + 2 * of[i]] += fx;
          arrows[from + 2 * of[i] + 1] += fz;
        });
      }
      if (made % EVERY === 0) when.push(t);
      made++;
    }
    if (control !== null && level > 0 && place % (2 * stride) === 0 && error < 0.1 * allowed) level--;
  }
  if (now.x <= 0 && speed > -Infinity) return end("backward");
  const none = speed === -Infinity ? NaN : 0, [workLeft, workRight, heights, joint] = now.sums;
  return end("", {
    distance: now.x, mean_height: heights / P.end, work: Math.abs(workLeft + workRight), peak_power: power + none,
    speed_loss: fall + none, joint_work: joint, peak_vertical_force: force, maximum_sinkage: deepest,
  });
}

/** Everything that a walk is judged by, by name, in natural signs; what is measured in Python is missing. */
function objectives(raw, mass) {
  if (!raw) return {};
  const floored = Object.entries(P.floors).map(([name, floor]) => Math.max(raw[name], floor));
  return {
    ...raw,
    efficiency: -(raw.distance * raw.mean_height) / floored.reduce((a, b) => a * b),
    cost_of_transport: raw.distance > ROUNDING ? raw.work / (mass * P.walker.g * raw.distance) : NaN,
  };
}

/** A walk with the plates of a sole, and its objectives. */
function simulate(sole, { zeta, mass }) {
  const { reason, raw, rows, made, when, arrows } = walkPlates(sole, zeta, mass);
  const columns = (from, width) => {
    const found = new Float64Array(width * made);
    for (let i = 0; i < made; i++) for (let j = 0; j < width; j++) found[width * i + j] = rows[TRACE * i + from + j];
    return found;
  };
  const { parts, of } = groups(sole.x.length), at = new Float64Array(2 * parts), size = new Float64Array(parts);
  of.forEach((j, i) => { at[2 * j] += sole.x[i]; at[2 * j + 1] += sole.z[i]; size[j]++; });
  return {
    reason, objectives: objectives(raw, mass), lowest: raw ? -raw.maximum_sinkage : undefined, ankle: P.foot.ankle, at: at.map((v, i) => v / size[i >> 1]), when, arrows,
    t: columns(0, 1), com: columns(1, 2), velocity: columns(3, 2), force: columns(5, 4), power: columns(9, 2), work: columns(11, 2),
  };
}

const SAME = 1e-9; // relative, of walks that are the same
/** The objective that rounding alone changes the most, and by how much of it: a plate turns round, a step is halved, or not. */
function rounding(sole, { zeta, mass }) {
  const [found, ...others] = [0, -2, -1, 1, 2].map((n) => simulate(sole, { zeta, mass: mass * (1 + n * Number.EPSILON) }).objectives);
  return Object.keys(found).map((name) => [name, Math.max(...others.map((other) => Math.abs((other[name] ?? NaN) / found[name] - 1)))])
    .filter(([name, by]) => Number.isFinite(found[name]) && !(by <= SAME)).reduce((most, one) => (most && most[1] >= one[1] ? most : one), null);
}
