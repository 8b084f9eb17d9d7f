// The walk: its stage, and its traces over time with the same instant.

const PLOTS = [
  { title: "height of the COM (m)", name: "com", width: 2, lines: [1] },
  { title: "forward speed (m/s)", name: "velocity", width: 2, lines: [0] },
  { title: "vertical force (N)", name: "force", width: 2 * SIDES.length, lines: [1, 3].slice(0, SIDES.length) },
  { title: "forward force (N)", name: "force", width: 2 * SIDES.length, lines: [0, 2].slice(0, SIDES.length) },
  { title: "power of the sand (W)", name: "power", width: SIDES.length, lines: [0, 1].slice(0, SIDES.length) },
  { title: "work of the sand (J)", name: "work", width: SIDES.length, lines: [0, 1].slice(0, SIDES.length) },
];

const PALE = { stroke: "var(--flat)", "stroke-width": 1.2 }; // the walk that another is compared with

const column = (walk, name, width, i) => Array.from(walk.t, (_, row) => walk[name][row * width + i]).map((v) => (Math.abs(v) < ROUNDING ? 0 : v));

/** One trace of a walk, a pale one to compare it with; returns what moves the cursor. */
function tracePlot(holder, { title, name, width, lines }, walk, other, seek) {
  const two = lines.length > 1, pale = other ? lines.map((i) => column(other, name, width, i)) : [];
  const told = (shown, t) => { const v = at(shown, name, width, t); return lines.map((l, i) => `${two ? `${SIDES[i]} ` : ""}${number(v[l])}`).join(", "); };
  const a = plot(holder, { x: [0, gait.end], xlabel: "time (s)", ylabel: title, height: 190, strikes: gait.strikes, label: `${title} over time; the table below has the numbers` }, [
    ...pale.map((y, i) => ({ x: other.t, y, ...PALE, "stroke-dasharray": two && i ? "7 3" : null })),
    ...lines.map((i, l) => ({ x: walk.t, y: column(walk, name, width, i), ...(two ? LINES[l] : { stroke: "var(--ink)" }) })),
  ], (t) => `${t.toFixed(2)} s: ${told(walk, t)}${other ? `; ${other.label}: ${told(other, t)}` : ""}`);
  const cursor = a.svg.appendChild(svg("line", { class: "cursor", y1: a.inside.top, y2: a.inside.bottom }));
  const dots = lines.map((_, i) => a.svg.appendChild(svg("circle", { r: 3.5, fill: two ? LINES[i].stroke : "var(--ink)" })));
  const to = (event) => seek(a.fromX(where(a, event)[0]));
  a.svg.addEventListener("pointerdown", (event) => { a.svg.setPointerCapture(event.pointerId); to(event); });
  a.svg.addEventListener("pointermove", (event) => event.buttons && to(event));
  return (t) => {
    cursor.setAttribute("x1", a.X(t));
    cursor.setAttribute("x2", a.X(t));
    const values = at(walk, name, width, t);
    dots.forEach((dot, i) => { dot.setAttribute("cx", a.X(t)); dot.setAttribute("cy", a.Y(values[lines[i]])); });
  };
}

/** The walk of a design: of the data, or made here; or null. */
function walkOf(i) {
  const place = data.walks.findIndex((walk) => walk.design === i);
  return place < 0 ? simulated(i) : Object.assign(open(place), { label: label(i) });
}
/** That of the flat sole, which is no design. */
function flatWalk() {
  const place = data.walks?.findIndex((walk) => walk.design === null) ?? -1;
  return sketch?.flat ?? (place < 0 ? null : open(place));
}

/** Whether a sole is the flat one: level, as low and as long. */
function isFlat(points) {
  const flat = flatWalk()?.points, same = (a, b) => Math.abs(a - b) < 1e-5; // m
  return Boolean(flat) && [0, -1].every((end) => same(points.at(end)[0], flat.at(end)[0])) && points.every(([, z]) => same(z, flat[0][1]));
}

/** A sentence where a walk made here is sensitive to rounding; else nothing. */
function sensitivity(i) {
  const found = walked.has(i) && rounding(walked.get(i).plates, i === DRAWN ? sketch : { zeta: P.sand.zeta, mass: P.walker.mass });
  return found ? `This walk is sensitive to rounding, which alone changes its ${found[0].replaceAll("_", " ")} by ${Number.isFinite(found[1]) ? percent(found[1]) : "all of it"}. footopt may differ by as much.` : "";
}

/** The section of the walk; `show(i)` puts the walk of a design on it. */
function walkSection() {
  const state = { chosen: data.best, walk: null, other: null, t: 0, playing: false, movers: [] };
  const others = new Map([["", null], ...(flatWalk() ? [["flat", flatWalk]] : []), ...(COUNT > 1 ? [["best", () => walkOf(data.best)]] : [])]);
  const compare = el("select", { id: "walk-compare", change: () => redraw() },
    ...[...others.keys()].map((name) => el("option", { value: name }, name || "none")));
  compare.value = others.has("flat") ? "flat" : "";
  const play = el("button", { id: "play", type: "button", click: () => (state.playing ? stop() : start()) }, "Play");
  const speed = el("select", { id: "speed" },
    ...[["1", "real time"], ["0.5", "1/2"], ["0.25", "1/4"], ["0.1", "1/10"]].map(([value, text]) => el("option", { value }, text)));
  speed.value = "0.5";
  const scrubber = el("input", { id: "time", type: "range", min: 0, max: gait.end, step: gait.end / 500,
    "aria-label": "time of the walk, s", input: () => { stop(); move(+scrubber.value); } });
  const clock = el("output", { for: "time", style: "min-width:9.5em" });
  const whole = el("div", { class: "plot" }), near = el("div", { class: "plot" });
  const plots = PLOTS.map(() => el("div", { class: "plot seek" }));
  const numbers = scrolled("Numbers at this instant"), key = el("div", {});
  const title = el("h2", { id: "walk-title" }), message = el("p", { id: "unwalked", class: "note" });
  const samples = folded("The walk as a table", () => sampleTable(state.walk));
  const picture = el("div", {},
    el("div", { class: "bar" }, play, el("label", {}, "speed", speed), scrubber, clock),
    el("div", { class: "grid wide" },
      el("figure", {}, whole, el("figcaption", {}, "The walker and the force of the sand on each foot, from where it acts.")),
      el("figure", {}, near, el("figcaption", {}, "Close-up; arrows: forces on parts of the sole, ending there."))),
    numbers,
    el("p", { class: "note" }, "Dotted: heel strikes. ",
      "Click or drag in a plot to go to an instant. Power and work are negative where the sand takes energy."),
    key,
    el("div", { class: "grid plots", style: "--columns:3" }, ...plots.map((plot) => el("figure", {}, plot))),
    samples);
  const section = el("section", { id: "walk" }, title,
    el("div", { class: "bar" }, others.size > 1 ? el("label", {}, "compare with", compare) : null), message, picture);

  function redraw() {
    const { walk } = state, failed = !walk || walk.t.length < 2;
    title.textContent = `The walk${COUNT > 1 ? `: ${label(state.chosen)}` : ""}`;
    message.textContent = !walk
      ? `The walk of ${label(state.chosen)} is not on this page: footopt study=simulate run=${data.folder ?? "FOLDER"} 'foot.k=[${heights(state.chosen)}]' simulates it.`
      : walk.reason ? `This walk failed: ${walk.reason}${failed ? ", at once" : `, at ${number(walk.t.at(-1))} s`}.` : sensitivity(state.chosen);
    picture.hidden = failed;
    if (failed) { stop(); return; }
    const com = pairs(walk.com), { legs } = sizes(walk), low = deepest(walk) - 0.05 * legs, x = range(com.map((p) => p[0]), 0);
    const found = others.get(compare.value)?.(), other = found && found !== walk && found.t.length > 1 && !(found === flatWalk() && isFlat(walk.points)) ? found : null;
    key.replaceChildren(legend([...SIDES.map((side, i) => ({ name: `${side} foot`, ...LINES[i] })), ...(other ? [{ name: other.label, ...PALE }] : [])]));
    const shared = { other };
    state.movers = [
      stage(whole, walk, { ...shared, x: [x[0] - 0.55 * legs, x[1] + 0.55 * legs], z: [Math.min(low, -0.16 * legs), Math.max(...com.map((p) => p[1])) + 0.12 * legs],
        label: "Stick figure of the walker at one instant" }),
      stage(near, walk, { ...shared, close: true, x: [-0.36 * legs, 0.36 * legs], z: [low - Math.max(0.04 * legs, 0.2 * (0.24 * legs - low)), 0.24 * legs],
        label: "Close-up of both soles in the sand with the forces on them" }),
      ...plots.map((plot, i) => tracePlot(plot, PLOTS[i], walk, other, (t) => { stop(); move(t); })),
    ];
    scrubber.max = walk.t.at(-1);
    move(state.t);
    samples.refresh();
  }
  function move(t) {
    state.t = clip(t, 0, state.walk.t.at(-1));
    state.movers.forEach((mover) => mover(state.t));
    scrubber.value = state.t;
    const [now, end] = [state.t, gait.end].map((s) => s.toFixed(gait.end < 0.5 ? 4 : 2));
    clock.textContent = `t = ${now} s of ${end} s`;
    scrubber.setAttribute("aria-valuetext", clock.textContent);
    const get = (name, width) => at(state.walk, name, width, state.t);
    const com = get("com", 2), v = get("velocity", 2), f = get("force", 2 * SIDES.length), p = get("power", SIDES.length), w = get("work", SIDES.length);
    const digits = clip(3 - Math.floor(Math.log10(largest(Array.from(state.walk.force)))), 1, 6); // of forces, powers and works
    numbers.replaceChildren(table(["at this instant", "x (m)", "z (m)", "Vx (m/s)", "Vz (m/s)", "forward force (N)", "vertical force (N)", "power (W)", "work (J)"], [
      ["centre of mass (COM)", com[0].toFixed(3), com[1].toFixed(3), v[0].toFixed(3), v[1].toFixed(3), "", "", "", ""],
      ...SIDES.map((side, i) => [`${side} foot`, "", "", "", "", ...[f[2 * i], f[2 * i + 1], p[i], w[i]].map((v) => v.toFixed(digits))]),
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
  function show(i) {
    stop();
    state.chosen = i;
    state.walk = walkOf(i);
    redraw();
  }
  // a figure worth looking at before anyone presses Play: the first single stance
  state.t = gait.strikes.length ? gait.strikes[0] + 0.25 : 0;
  return { section, show, redraw };
}

/** A step, close, over and over: the first one; `show(i)` takes that of another design. */
function stepLoop() {
  const holder = el("div", { class: "plot", id: "step" }), still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const button = el("button", { type: "button", class: "loop", click: () => { state.playing = !state.playing; run(); } });
  const beside = el("span"), figure = el("figure", {}, holder, el("figcaption", {}, button, " A step at a quarter of its speed, with the forces on parts of the sole", beside));
  const begin = gait.strikes[0], stride = 2 * ((gait.strikes[1] ?? NaN) - gait.strikes[0]), side = RIGHT;
  const state = { walk: null, mover: null, t: begin + 0.1 * stride, playing: !still && Number.isFinite(stride), seen: true };
  new IntersectionObserver(([{ isIntersecting }]) => { state.seen = isIntersecting; run(); }).observe(holder);
  let before = 0, busy = false;
  const tick = (now) => {
    busy = state.playing && state.seen && state.mover;
    if (!busy) return;
    state.t += Math.min((now - before) / 1000, 0.1) / 4;
    if (state.t > begin + 0.66 * stride) state.t = begin - 0.06 * stride;
    before = now;
    if (!sketch?.frame) state.mover(state.t); // else it is drawn anew in this frame
    requestAnimationFrame(tick);
  };
  function run() {
    button.textContent = state.playing ? "Pause" : "Play";
    if (!busy) { before = performance.now(); busy = true; requestAnimationFrame(tick); }
  }
  function redraw() {
    const { walk } = state;
    figure.hidden = !walk || !(walk.t.at(-1) > begin + 0.3 * stride);
    state.mover = null;
    if (figure.hidden) return;
    const flat = flatWalk(), other = flat && !isFlat(walk.points) && flat.t.at(-1) > begin + 0.3 * stride ? flat : null;
    beside.textContent = other ? "; dashed: the flat foot in step." : ".";
    const low = deepest(walk, begin - 0.06 * stride, begin + 0.66 * stride);
    const { sole } = sizes(walk), foot = (w) => pose(w, begin + 0.25 * stride)[side].leg[2][0];
    state.mover = stage(holder, walk, { close: true, other, tall: 300, x: [-0.26 * sole, 0.26 * sole], z: [low - Math.max(0.07 * sole, 0.3 * (0.13 * sole - low)), 0.13 * sole],
      fixed: { x: foot(walk) + 0.03 * sole, shift: other ? foot(walk) - foot(other) : 0 }, label: `One step of the ${SIDES[side]} foot in the sand, with the forces on its sole` });
    state.mover(state.t);
    run();
  }
  return { figure, redraw, take: (i) => { state.walk = walkOf(i); } };
}

function sampleTable(walk) {
  const every = Math.max(1, Math.floor(walk.t.length / 60));
  const rows = [];
  for (let i = 0; i < walk.t.length; i += every) rows.push([walk.t[i].toFixed(3),
    ...["com", "velocity", "force", "power", "work"].flatMap((name) => {
      const width = walk[name].length / walk.t.length;
      return Array.from(walk[name].slice(i * width, (i + 1) * width), number);
    })]);
  return table(["t (s)", "x (m)", "z (m)", "Vx (m/s)", "Vz (m/s)",
    ...SIDES.flatMap((side) => [`${side} forward force (N)`, `${side} vertical force (N)`]),
    ...SIDES.map((side) => `${side} power (W)`), ...SIDES.map((side) => `${side} work (J)`)], rows);
}
