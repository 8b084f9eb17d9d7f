// A sole of one's own: waypoints to drag, sliders for sand and mass, the walk that follows, undo, and the commands for it.

/** The sole that is sketch, the design after the last: its sand and mass, why it failed, what it was before, and the frame that is to show it. */
const sketch = P.sand ? { zeta: P.sand.zeta, mass: P.walker.mass, reason: "", flat: null, past: [], frame: 0, moving: false } : null;
if (sketch && !kOf) data.designs.soles.push(data.designs.soles[0]);

const walked = new Map();
/** The walk of a design, made here; null where the page says why it cannot. */
function simulated(i) {
  if (!sketch) return null;
  if (!walked.has(i)) {
    const cut = plates(heights(i)), made = simulate(cut, i === DRAWN ? sketch : { zeta: P.sand.zeta, mass: P.walker.mass });
    if (walked.size > 20) walked.clear();
    walked.set(i, prepared({ ...made, plates: cut, points: sole(i), top: own("top", i), design: i }));
  }
  return Object.assign(walked.get(i), { label: label(i) });
}

const elsewhere = new Map();
/** The objectives of a sole under another law of sand, or by finer numbers; null where the walk fails. */
function walkedAs(k, { zeta, mass }, { law, zeta: factor = 1, effects = P.effects, finer = 1 }) {
  const key = [law, finer, zeta, mass, k].join(" ");
  if (!elsewhere.has(key)) {
    const { plates: count, dt, control } = P.accuracy;
    Object.assign(P.accuracy, { plates: finer * count, dt: dt / finer, control: control && control / finer ** 2 });
    takeEffects(effects);
    const walk = simulate(plates(k), { zeta: zeta * factor, mass });
    Object.assign(P.accuracy, { plates: count, dt, control });
    takeEffects(P.effects);
    elsewhere.set(key, walk.reason ? null : walk.objectives);
  }
  return elsewhere.get(key);
}
/** A design of this page under other laws of sand, against the flat sole, and the numerical errors of its values: walked here once the hand rests. */
function judgedHere(i) {
  if (!sketch || !space || !data.objectives || sketch.moving || !feasible[i]) return { laws: [], errors: {} };
  const own = i === DRAWN ? sketch : { zeta: P.sand.zeta, mass: P.walker.mass }, k = heights(i), flat = Array(space.n).fill(space.K);
  const share = (a, b) => a && b && Object.fromEntries(Object.keys(a).map((name) => [name, a[name] / b[name] - 1]));
  const usual = walkedAs(k, own, {}), finer = walkedAs(k, own, { finer: 2 });
  return { laws: P.others.map((other) => ({ law: other.law, change: share(walkedAs(k, own, other), walkedAs(flat, own, other)) ?? {} })),
    errors: usual && finer ? Object.fromEntries(Object.keys(usual).map((name) => [name, Math.abs(usual[name] - finer[name])])) : {} };
}
/** Where a walk that was made here leaves the tested range: by its depth, which the page knows. */
function tooDeep(i) {
  const walk = feasible[i] && simulated(i);
  if (!walk) return [];
  const ankle = Math.max(...Array.from({ length: 101 }, (_, j) => Math.max(...pose(walk, (j * walk.t.at(-1)) / 100).map(({ leg }) => -leg.at(-1)[1]))));
  return [["depth of the sole", walk.objectives.maximum_sinkage, P.foot.width], ["depth of the ankle", ankle, 0]]
    .flatMap(([name, value, limit], row) => (value > limit ? [`${name} ${number(value)} m is above ${number(limit)} m: ${P.why[row]}`] : []));
}

const flatOfRun = { ...entry.flat };
/** Compare with the flat sole of the run, or with one in the sand and with the mass of what is sketch. */
function compareWith(design) {
  const same = design !== DRAWN || (sketch.zeta === P.sand.zeta && sketch.mass === P.walker.mass);
  sketch.flat = null;
  if (!same && flatWalk() && space) {
    const flat = Array(space.n).fill(space.K), made = simulate(plates(flat), sketch);
    sketch.flat = prepared({ ...made, points: flatWalk().points, top: own("top", DRAWN), label: "flat" });
  }
  for (const name of Object.keys(flatOfRun)) entry.flat[name] = same ? flatOfRun[name] : sketch.flat?.objectives[name] ?? NaN;
}

/** Walk with what is sketch, and put its values into the design after the last. */
function rewalk() {
  walked.delete(DRAWN);
  depths.delete(DRAWN);
  const walk = simulated(DRAWN), heightsOf = walk.points.map((p) => p[1]);
  const out = space ? Math.max(...heightsOf, -space.H - Math.min(...heightsOf)) : 0;
  sketch.reason = walk.reason || (space && out > (space.box_tolerance ?? Infinity) * space.H ? `it leaves its box by ${(MM * out).toFixed(1)} mm, which a search forbids` : "");
  data.columns.forEach((column, c) => { values[DRAWN * WIDTH + c] = walk.objectives[column.name] ?? NaN; });
  feasible[DRAWN] = walk.reason ? 0 : 1;
}

const put = ({ k, zeta, mass }) => {
  if (k && kOf) kOf.set(k, DRAWN * space.n);
  Object.assign(sketch, { zeta, mass });
};
const takeSketch = (all) => { put(all); rewalk(); };

/** The tools beside the drawing of the chosen sole; `now()` is the chosen design, `show(i)` shows one, `settle(i)` everywhere. */
function drawTools(holder, now, show, settle) {
  const why = P.refusal ?? (sketch ? "" : null);
  if (why === null || data.runs) return { section: el("div", {}), redraw: () => {} };
  if (why) return { section: el("p", { class: "note", id: "no-drawing" }, `No other sole can be drawn and simulated here: ${why}.`), redraw: () => {} };
  let rest = 0;
  const snapshot = () => ({ design: now(), k: heights(now()), zeta: sketch.zeta, mass: sketch.mass });
  /** Change what is drawn: the sole and its step follow in the next frame, all else when the hand rests. */
  function edit(change, remember = true) {
    if (remember) sketch.past.push(snapshot());
    put({ ...snapshot(), ...change });
    sketch.frame ||= requestAnimationFrame(() => {
      sketch.frame = 0;
      rewalk();
      show(DRAWN);
    });
    sketch.moving = true;
    clearTimeout(rest);
    rest = setTimeout(() => { sketch.moving = false; settle(DRAWN); }, 150);
  }
  function undo() {
    const before = sketch.past.pop();
    if (!before) return;
    takeSketch(before);
    settle(before.design);
  }
  const level = (p, k) => {
    const moved = heights(now());
    if (moved[p] === (k = clip(Math.round(k), 1, space.K))) return null;
    moved[p] = k;
    return moved;
  };
  let held = -1, fresh = true; // whether the next change is the first of a drag, which an undo goes back to
  holder.addEventListener("pointerdown", (event) => {
    const aside = (grip) => { const { left, width } = grip.getBoundingClientRect(); return Math.abs(left + width / 2 - event.clientX); };
    held = event.target.closest("[data-waypoint]") // grips cover each other on a narrow screen: the nearest is meant
      ? +[...holder.querySelectorAll("[data-waypoint]")].reduce((a, b) => (aside(b) < aside(a) ? b : a)).dataset.waypoint : -1;
    fresh = true;
    if (held >= 0) holder.setPointerCapture(event.pointerId);
  });
  holder.addEventListener("pointermove", (event) => {
    if (held < 0) return;
    const drawing = holder.firstChild, box = drawing.getBoundingClientRect();
    const k = level(held, -drawing.height_of(((event.clientY - box.top) * drawing.viewBox.baseVal.height) / box.height) / (space.H / space.K));
    if (k) edit({ k }, fresh);
    if (k) fresh = false;
  });
  for (const end of ["pointerup", "pointercancel"]) holder.addEventListener(end, () => { held = -1; });
  holder.addEventListener("keydown", (event) => {
    const p = +(event.target.dataset.waypoint ?? -1), by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (p < 0 || !by) return;
    event.preventDefault();
    const k = level(p, heights(now())[p] + by);
    if (k) edit({ k });
  });
  document.addEventListener("keydown", (event) => {
    if ((event.ctrlKey || event.metaKey) && event.key === "z" && sketch.past.length && event.target.type !== "number") { event.preventDefault(); undo(); }
  });
  /** A slider over a factor of 10 to either side, in equal steps of the logarithm. */
  const slider = (name, text, own) => {
    const shown = el("output", { for: name }), input = el("input", { id: name, type: "range", min: -1, max: 1, step: 0.01, "aria-label": text,
      input: () => { edit({ [name]: +input.value ? +(own * 10 ** input.value).toPrecision(3) : own }, fresh); fresh = false; }, change: () => { fresh = true; } });
    const redraw = () => { input.value = Math.log10(sketch[name] / own); shown.textContent = number(sketch[name]); input.setAttribute("aria-valuetext", shown.textContent); };
    return { row: el("label", {}, text, input, shown), redraw };
  };
  const sliders = [slider("zeta", "sand strength, zeta", P.sand.zeta), slider("mass", "mass, kg", P.walker.mass)];
  const back = el("button", { type: "button", id: "undo", click: undo }, "Undo"), commands = el("pre", { id: "commands" });
  const section = el("div", { id: "draw" },
    el("p", { class: "note" }, kOf ? "Drag a waypoint of the sole, or choose one and press the up and down keys: the page simulates its walk. k has their levels from heel to toe, counted downwards." : "This sole has no waypoints to drag; sand and mass can be changed."),
    el("div", { class: "bar" }, ...sliders.map(({ row }) => row), back),
    folded("Commands that simulate this sole, or search from it", () => commands));
  function redraw() {
    sliders.forEach((s) => s.redraw());
    back.disabled = !sketch.past.length;
    const k = heights(now()), own = now() === DRAWN;
    const sand = own && sketch.zeta !== P.sand.zeta ? ` sand.zeta=${sketch.zeta}` : "", mass = own && sketch.mass !== P.walker.mass ? ` walker.mass=${sketch.mass}` : "";
    const world = `${k ? ` 'foot.k=[${k}]'` : ""}${sand}${mass}`;
    commands.textContent = [`footopt study=simulate run=${data.folder ?? "FOLDER"}${world}`,
      ...(data.objectives && k ? [`footopt ${data.overrides ? `${data.overrides} ` : ""}'study.start=[${k}]'${sand}${mass}`] : [])].join("\n");
  }
  return { section, redraw };
}
