// The walk: legs, soles and forces at one instant, and its traces over time with the same instant.

const LEFT = 0, RIGHT = 1, SIDES = ["left", "right"];
const LINES = [{ stroke: BLUE }, { stroke: VERMILLION, "stroke-dasharray": "7 3" }];

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
    const raw = data.walks[place];
    const walk = { ...raw, place, points: raw.sole ? pairs(unpack(raw.sole)) : sole(raw.design) };
    for (const name of ["t", "com", "velocity", "force", "power", "work", "at", "arrows"])
      walk[name] = raw[name] ? unpack(raw[name]) : [];
    // fewer points are enough for a moving picture
    const every = Math.max(1, Math.floor(walk.points.length / 80));
    walk.light = walk.points.filter((_, i) => i % every === 0 || i === walk.points.length - 1);
    walk.shape = outline(walk.light, walk.top);
    opened.set(place, walk);
  }
  return opened.get(place);
}

/** Values of a trace with so many columns at a time, in a straight line between samples. */
function at(walk, name, width, t) {
  const times = walk.t;
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const part = Math.min(Math.max((t - times[low]) / (times[high] - times[low] || 1), 0), 1);
  const values = walk[name];
  return Array.from({ length: width }, (_, i) => values[low * width + i] * (1 - part) + values[high * width + i] * part);
}

/** Where everything is at a time, m and N. */
function instant(walk, t) {
  const [x, z] = at(walk, "com", 2, t);
  const parts = walk.at.length / 2, arrows = at(walk, "arrows", 4 * parts, t);
  const feet = SIDES.map((_, foot) => {
    const [thigh, shank, pitch] = legAngles(t, foot);
    const knee = [x + gait.l1 * Math.sin(thigh), z - gait.l1 * Math.cos(thigh)];
    const ankle = [knee[0] + gait.l2 * Math.sin(shank), knee[1] - gait.l2 * Math.cos(shank)];
    const c = Math.cos(pitch), s = Math.sin(pitch);
    const turn = ([u, v]) => [ankle[0] + c * u - s * v, ankle[1] + s * u + c * v];
    const carry = (points) => points.map(([u, v]) => turn([u - walk.ankle[0], v - walk.ankle[1]]));
    const forces = Array.from({ length: parts }, (_, i) => {
      const j = 2 * (foot * parts + i);
      return { at: turn([walk.at[2 * i], walk.at[2 * i + 1]]), f: [arrows[j], arrows[j + 1]] };
    });
    return { leg: [[x, z], knee, ankle], shape: carry(walk.shape), sole: carry(walk.light), forces };
  });
  return { com: [x, z], feet };
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

function arrow([x0, y0], [x1, y1]) {
  const long = Math.hypot(x1 - x0, y1 - y0);
  if (long < 3) return "";
  const head = Math.min(7, 0.6 * long), ux = (x1 - x0) / long, uy = (y1 - y0) / long;
  const side = (turn) => [x1 - head * (ux - turn * 0.5 * uy), y1 - head * (uy + turn * 0.5 * ux)];
  return path([[x0, y0], [x1, y1]]) + path([side(1), [x1, y1], side(-1)]);
}

/** A picture of the walker; returns what moves it to an instant. `close` follows the soles. */
function stage(holder, walk, { close, x, z, label }) {
  const width = Math.max(holder.clientWidth, 200);
  const height = Math.min(330, (width / (x[1] - x[0])) * (z[1] - z[0]) + 60);
  const scale = Math.min(width / (x[1] - x[0]), height / (z[1] - z[0])), Z = (v) => height - (v - z[0]) * scale;
  let middle = 0.5 * (x[0] + x[1]);
  const X = (v) => width / 2 + (v - middle) * scale;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label });
  const add = (name, attributes) => drawing.appendChild(svg(name, attributes));
  add("rect", { x: 0, y: Z(0), width, height: height - Z(0), fill: "var(--sand)" });
  const marks = add("g", {});
  add("line", { x1: 0, x2: width, y1: Z(0), y2: Z(0), stroke: "var(--orange)", "stroke-width": 1.5 });
  const body = [LEFT, RIGHT].map((foot) => ({
    shape: add("path", { fill: foot ? "#f6dfce" : "#d5e6f2", "fill-opacity": 0.85 }),
    leg: add("path", { fill: "none", stroke: LINES[foot].stroke, "stroke-width": close ? 5 : 4, "stroke-opacity": 0.75, "stroke-linejoin": "round" }),
    joints: add("path", { fill: "none", stroke: "#1a1a1a", "stroke-width": 6, "stroke-linecap": "round" }),
    sole: add("path", { fill: "none", stroke: LINES[foot].stroke, "stroke-width": 2.5 }),
    arrows: add("path", { fill: "none", stroke: "#1a1a1a", "stroke-width": 1.3 }),
    name: add("text", { class: "halo", "text-anchor": "middle" }),
  }));
  const hip = add("circle", { r: close ? 0 : 8, fill: "#1a1a1a" });
  const largest = close
    ? walk.arrows.reduce((most, _, i, a) => (i % 2 ? most : Math.max(most, Math.hypot(a[i], a[i + 1]))), 1)
    : walk.force.reduce((most, v) => Math.max(most, Math.abs(v)), 1);
  const reach = ((close ? 0.3 : 0.35) * (z[1] - z[0]) * scale) / largest; // pixels per newton
  const round = 10 ** Math.floor(Math.log10((0.7 * largest)));
  const unit = [5, 2, 1].find((m) => m * round <= 0.7 * largest) * round;
  add("path", { d: arrow([14, height - 12], [14 + unit * reach, height - 12]), fill: "none", stroke: "#1a1a1a", "stroke-width": 1.3 });
  add("text", { x: 20 + unit * reach, y: height - 8 }).textContent = `${unit} N`;
  holder.replaceChildren(drawing);
  return (t) => {
    const now = instant(walk, t);
    if (close) middle = now.com[0];
    const to = ([u, v]) => [X(u), Z(v)], line = (points) => path(points.map(to));
    marks.replaceChildren(...ground({ X, Z, width, height }), ...ticks(middle - width / 2 / scale, middle + width / 2 / scale, width / 110).values.flatMap((v) => [
      svg("line", { x1: X(v), x2: X(v), y1: Z(0), y2: Z(0) + 6, stroke: "var(--orange)" }),
      ...(X(v) > 24 && X(v) < width - 24 ? [svg("text", { x: X(v), y: Z(0) + 19, "text-anchor": "middle" }, `${+v.toFixed(2)} m`.replace("-", "−"))] : [])]));
    now.feet.forEach((foot, side) => {
      const part = body[side], ankle = to(foot.leg[2]);
      part.shape.setAttribute("d", line(foot.shape) + "Z");
      part.sole.setAttribute("d", line(foot.sole));
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

/** What the scene's effects do to the ground: layers, patches with their strength, and which way gravity pulls. */
function ground({ X, Z, width, height }) {
  const { patches, layers, slope } = data.entry.scene.effects, tilt = ((slope?.angle ?? 0) * Math.PI) / 180;
  const label = (x, y, text, anchor = "start") => svg("text", { class: "halo", x, y, "text-anchor": anchor }, text);
  return [
    ...(patches?.begins ?? []).flatMap((begin, i) => [
      svg("rect", { x: X(begin), y: Z(0), width: X(patches.ends[i]) - X(begin), height: height - Z(0), fill: "#d9b26a", "fill-opacity": 0.5 }),
      label(X(begin) + 4, height - 24, `× ${patches.factors[i]}`)]),
    ...(layers?.depths ?? []).map((depth) =>
      svg("line", { x1: 0, x2: width, y1: Z(-depth), y2: Z(-depth), stroke: "var(--orange)", "stroke-dasharray": "4 4" })),
    ...(slope ? [
      svg("path", { d: arrow([width - 40, 24], [width - 40 - 44 * Math.sin(tilt), 24 + 44 * Math.cos(tilt)]), fill: "none", stroke: "#1a1a1a", "stroke-width": 1.5 }),
      label(width - 8, 16, `gravity, ${number(Math.abs(slope.angle))}° ${slope.angle > 0 ? "uphill" : "downhill"}`, "end")] : []),
  ];
}

const PLOTS = [
  { title: "height of the COM (m)", name: "com", width: 2, lines: [1] },
  { title: "forward speed (m/s)", name: "velocity", width: 2, lines: [0] },
  { title: "vertical force (N)", name: "force", width: 4, lines: [1, 3] },
  { title: "forward force (N)", name: "force", width: 4, lines: [0, 2] },
  { title: "power of the sand (W)", name: "power", width: 2, lines: [0, 1] },
  { title: "work of the sand (J)", name: "work", width: 2, lines: [0, 1] },
];

const column = (walk, name, width, i) => Array.from(walk.t, (_, row) => walk[name][row * width + i]);

/** One trace of a walk, a pale one to compare it with; returns what moves the cursor. */
function tracePlot(holder, { title, name, width, lines }, walk, other, seek) {
  const series = lines.map((i) => column(walk, name, width, i));
  const pale = other ? lines.map((i) => column(other, name, width, i)) : [];
  const a = axes(holder, {
    x: [0, gait.end], y: range([...series.flat(), ...pale.flat()]), xlabel: "time (s)", ylabel: title, height: 190,
    label: `${title} over time; the table below has the numbers`,
  });
  for (const strike of gait.strikes) a.svg.append(svg("line", {
    class: "strike", x1: a.X(strike), x2: a.X(strike), y1: a.inside.top, y2: a.inside.bottom }));
  pale.forEach((values, i) => a.svg.append(svg("path", { d: path(values.map((v, j) => [a.X(other.t[j]), a.Y(v)])),
    fill: "none", stroke: "#b5b5b5", "stroke-width": 1.2, "stroke-dasharray": lines.length > 1 && i ? "7 3" : null })));
  series.forEach((values, i) => a.svg.append(svg("path", { d: path(values.map((v, j) => [a.X(walk.t[j]), a.Y(v)])),
    fill: "none", "stroke-width": 1.8, ...(lines.length > 1 ? LINES[i] : { stroke: "#1a1a1a" }) })));
  const cursor = a.svg.appendChild(svg("line", { class: "cursor", y1: a.inside.top, y2: a.inside.bottom }));
  const dots = series.map((_, i) => a.svg.appendChild(svg("circle", { r: 3.5, fill: lines.length > 1 ? LINES[i].stroke : "#1a1a1a" })));
  const to = (event) => seek(a.fromX(((event.clientX - a.svg.getBoundingClientRect().left) * a.width) / a.svg.getBoundingClientRect().width));
  a.svg.addEventListener("pointerdown", (event) => { a.svg.setPointerCapture(event.pointerId); to(event); });
  a.svg.addEventListener("pointermove", (event) => event.buttons && to(event));
  return (t) => {
    cursor.setAttribute("x1", a.X(t));
    cursor.setAttribute("x2", a.X(t));
    const values = at(walk, name, width, t);
    dots.forEach((dot, i) => { dot.setAttribute("cx", a.X(t)); dot.setAttribute("cy", a.Y(values[lines[i]])); });
  };
}

/** The section of the walk; `show(place)` puts another walk of the data on it. */
function walkSection() {
  const state = { walk: null, other: null, t: 0, playing: false, movers: [] };
  const choices = (extra) => [...extra, ...data.walks.map((walk, i) => el("option", { value: i }, walk.label))];
  const pick = el("select", { id: "walk-choice", change: () => show(+pick.value, true) }, ...choices([]));
  const flat = data.walks.findIndex((walk) => walk.design === null);
  const compare = el("select", { id: "walk-compare", change: () => { state.other = compare.value; redraw(); } },
    ...choices([el("option", { value: "" }, "none")]));
  if (flat >= 0) compare.value = String(flat);
  state.other = compare.value;
  const play = el("button", { id: "play", type: "button", click: () => (state.playing ? stop() : start()) }, "Play");
  const speed = el("select", { id: "speed" },
    ...[["1", "real time"], ["0.5", "1/2"], ["0.25", "1/4"], ["0.1", "1/10"]].map(([value, text]) => el("option", { value }, text)));
  speed.value = "0.5";
  const scrubber = el("input", { id: "time", type: "range", min: 0, max: gait.end, step: 0.005,
    "aria-label": "time of the walk, s", input: () => { stop(); move(+scrubber.value); } });
  const clock = el("output", { for: "time", style: "min-width:9.5em" });
  const whole = el("div", { class: "plot" }), near = el("div", { class: "plot" });
  const plots = PLOTS.map(() => el("div", { class: "plot seek" }));
  const numbers = el("div", { class: "scroll" });
  const message = el("p", {});
  const samples = folded("The walk as a table", () => sampleTable(state.walk));
  const picture = el("div", {},
    el("div", { class: "bar" }, play,
      el("label", {}, "speed", speed), scrubber, clock),
    el("div", { class: "grid wide" },
      el("figure", {}, whole, el("figcaption", {}, "The walker and the force of the sand on each foot, from where it acts.")),
      el("figure", {}, near, el("figcaption", {}, "Close-up; arrows: forces on parts of the sole, ending there."))),
    numbers,
    el("p", { class: "note", id: "walk-key" }, key(LINES[LEFT]), " left foot, ", key(LINES[RIGHT]), " right foot, ",
      key({ stroke: "#b5b5b5" }), " the walk it is compared with; dotted lines: heel strikes. ",
      "Click or drag in a plot to go to an instant. Power and work are negative where the sand takes energy."),
    el("div", { class: "grid plots", style: "--columns:3" }, ...plots.map((plot) => el("figure", {}, plot))),
    samples);
  const section = el("section", { id: "walk" }, el("h2", {}, "The walk"),
    el("div", { class: "bar" }, el("label", {}, "sole", pick), el("label", {}, "compare with", compare)), message, picture);

  function redraw() {
    if (!state.walk) return;
    const { walk } = state, failed = walk.t.length < 2;
    message.textContent = walk.reason ? `This walk failed: ${walk.reason}${failed ? ", at once" : `, at ${number(walk.t.at(-1))} s`}.` : "";
    picture.hidden = failed;
    if (failed) return;
    const com = Array.from({ length: walk.com.length / 2 }, (_, i) => [walk.com[2 * i], walk.com[2 * i + 1]]);
    let deepest = 0;
    for (let i = 0; i < walk.t.length; i += 4) for (const foot of instant(walk, walk.t[i]).feet)
      for (const p of foot.sole) deepest = Math.min(deepest, p[1]);
    const low = deepest - 0.05, x = range(com.map((p) => p[0]), 0);
    const other = state.other === "" || +state.other === walk.place ? null : open(+state.other);
    state.movers = [
      stage(whole, walk, { x: [x[0] - 0.55, x[1] + 0.55], z: [Math.min(low, -0.16), Math.max(...com.map((p) => p[1])) + 0.12],
        label: "Stick figure of the walker at one instant" }),
      stage(near, walk, { close: true, x: [-0.36, 0.36], z: [low - 0.08, 0.27],
        label: "Close-up of both soles in the sand with the forces on them" }),
      ...plots.map((plot, i) => tracePlot(plot, PLOTS[i], walk, other?.t.length > 1 ? other : null, (t) => { stop(); move(t); })),
    ];
    scrubber.max = walk.t.at(-1);
    move(state.t);
    samples.refresh();
  }
  function move(t) {
    state.t = Math.min(Math.max(t, 0), state.walk.t.at(-1));
    state.movers.forEach((mover) => mover(state.t));
    scrubber.value = state.t;
    clock.textContent = `t = ${state.t.toFixed(2)} s of ${gait.end.toFixed(2)} s`;
    scrubber.setAttribute("aria-valuetext", clock.textContent);
    const get = (name, width) => at(state.walk, name, width, state.t);
    const com = get("com", 2), v = get("velocity", 2), f = get("force", 4), p = get("power", 2), w = get("work", 2);
    numbers.replaceChildren(table(["at this instant", "x (m)", "z (m)", "Vx (m/s)", "Vz (m/s)", "forward force (N)", "vertical force (N)", "power (W)", "work (J)"], [
      ["COM", com[0].toFixed(3), com[1].toFixed(3), v[0].toFixed(3), v[1].toFixed(3), "", "", "", ""],
      ...SIDES.map((side, i) => [`${side} foot`, "", "", "", "", f[2 * i].toFixed(0), f[2 * i + 1].toFixed(0), p[i].toFixed(1), w[i].toFixed(1)]),
    ].map((row) => row.map((text) => text.replace(/^-(0(\.0*)?)$/, "$1").replace(/^-/, "−")))));
  }
  function start() {
    state.playing = true;
    play.textContent = "Pause";
    let before = performance.now();
    if (state.t >= state.walk.t.at(-1) - 1e-3) state.t = 0;
    const tick = (now) => {
      if (!state.playing) return;
      move(state.t + ((now - before) / 1000) * +speed.value);
      before = now;
      if (state.t >= state.walk.t.at(-1)) stop(); else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
  function stop() {
    state.playing = false;
    play.textContent = "Play";
  }
  function show(place, loud = false) {
    stop();
    pick.value = String(place);
    state.walk = open(place);
    redraw();
    if (loud) say(`Walk of ${state.walk.label}`);
  }
  // a figure worth looking at before anyone presses Play: the first single stance
  state.t = gait.strikes.length ? gait.strikes[0] + 0.25 : 0;
  return { section, show, redraw };
}

const key = ({ stroke, "stroke-dasharray": dash }) =>
  el("span", { class: "key", style: `border-color:${stroke};border-top-style:${dash ? "dashed" : "solid"}` });

function sampleTable(walk) {
  const every = Math.max(1, Math.floor(walk.t.length / 60));
  const rows = [];
  for (let i = 0; i < walk.t.length; i += every) rows.push([walk.t[i].toFixed(3),
    ...["com", "velocity", "force", "power", "work"].flatMap((name) => {
      const width = name === "force" ? 4 : 2;
      return Array.from(walk[name].slice(i * width, (i + 1) * width), number);
    })]);
  return table(["t (s)", "x (m)", "z (m)", "Vx (m/s)", "Vz (m/s)",
    ...SIDES.flatMap((side) => [`${side} forward force (N)`, `${side} vertical force (N)`]),
    ...SIDES.map((side) => `${side} power (W)`), ...SIDES.map((side) => `${side} work (J)`)], rows);
}
