// A search while it runs, and from its beginning again: front, convergence and the best foot, generation by generation.

/** The objectives of a design, minimised. */
const cost = (data.objectives ?? []).map((name) => data.columns.findIndex((c) => c.name === name)).map((c) => {
  const sign = data.columns[c].maximise ? -1 : 1;
  return (i) => sign * values[i * WIDTH + c];
});

/** Of some designs those that no other of them is better than in all objectives. */
function undominated(among) {
  const better = (i, j) => cost.every((of) => of(i) <= of(j)) && cost.some((of) => of(i) < of(j));
  const kept = [];
  for (const i of among.slice().sort((a, b) => cost[0](a) - cost[0](b) || a - b)) if (!kept.some((j) => better(j, i))) kept.push(i);
  return kept;
}

/** In which generation each of some designs was found to be worse than another; never, if it is on the front at the end. */
function surpassed(among) {
  const at = among.slice().sort((a, b) => generation[a] - generation[b]), m = cost.length, found = new Float64Array(COUNT).fill(Infinity);
  const f = Float64Array.from({ length: at.length * m }, (_, n) => cost[n % m](at[Math.floor(n / m)]));
  at.forEach((i, own) => {
    for (let j = 0; j < at.length && !front.has(i) && found[i] === Infinity; j++) {
      let c = 0, less = false;
      for (; c < m && f[j * m + c] <= f[own * m + c]; c++) less ||= f[j * m + c] < f[own * m + c];
      if (c === m && less) found[i] = generation[at[j]];
    }
  });
  return found;
}

const several = data.objectives?.length > 1;
/** What a design of several objectives is the best by, until the run itself has chosen. */
const lead = (several && columnOf("efficiency")) || guide;
const bestOf = (among) => among.reduce((best, i) => (best < 0 || (lead.of(i) - lead.of(best)) * (lead.maximise ? 1 : -1) > 0 ? i : best), -1);

/** Put the front and the best of some designs on the page; the drawing of the sole turns from one into the other. */
let morphing = 0;
function showBest(explore, last, among, ranked = several ? undominated(among) : []) {
  front.clear();
  ranked.forEach((i) => front.add(i));
  explore.until(last);
  const best = bestOf(several ? ranked : among), holder = document.querySelector("#design figure .plot"), before = shownBest;
  if (best < 0 || best === before) return best;
  shownBest = best;
  cancelAnimationFrame(morphing);
  const [from, to] = [before < 0 ? best : before, best].map(sole), begun = performance.now(), still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const tick = (now) => {
    const part = still ? 1 : clip((now - begun) / 400, 0, 1);
    if (part >= 1) { choose(best); return; }
    const points = from.map(([x, z], j) => [x, z + part * (to[j][1] - z)]);
    update(holder, soleDrawing(points, { width: widthOf(holder), top: own("top", best) }));
    morphing = requestAnimationFrame(tick);
  };
  morphing = requestAnimationFrame(tick);
  return best;
}
let shownBest = -1;

/** A slider over the generations of a search that has ended. */
function rewinding(explore, found) {
  if (data.live) return;
  const last = data.history.length, atEnd = [...front], every = Array.from({ length: COUNT }, (_, i) => i).filter((i) => feasible[i]);
  const clock = el("output", { for: "rewind" });
  const slider = el("input", { id: "rewind", type: "range", min: 1, max: last, step: 1, value: last, "aria-label": "generation of the search", input: () => { stop(); to(+slider.value); } });
  const play = el("button", { id: "again", type: "button", click: () => (timer ? stop() : start()) }, "Search again");
  let timer = 0, until = null;
  function to(g) {
    slider.value = g;
    clock.textContent = `generation ${g} of ${last}`;
    slider.setAttribute("aria-valuetext", clock.textContent);
    found.draw(g - 1);
    if (g < last) {
      const among = every.filter((i) => generation[i] <= g);
      if (several) until ??= surpassed(every);
      showBest(explore, g, among, several ? among.filter((i) => until[i] > g) : []);
      return;
    }
    cancelAnimationFrame(morphing);
    front.clear();
    atEnd.forEach((i) => front.add(i));
    explore.until(Infinity);
    shownBest = -1;
    choose(data.best);
  }
  function stop() {
    clearInterval(timer);
    timer = 0;
    play.textContent = "Search again";
  }
  function start() {
    if (+slider.value === last) to(1);
    play.textContent = "Pause";
    timer = setInterval(() => { to(+slider.value + 1); if (+slider.value >= last) stop(); }, 600);
  }
  clock.textContent = `generation ${last} of ${last}`;
  found.section.querySelector("h2").after(el("div", { class: "bar" }, play, slider, clock));
}

/** Ask the server of a search that runs for its new designs, until it has ended and its own page is there. */
function follow(explore, found) {
  const status = document.getElementById("header").appendChild(el("p", { id: "live", role: "status" }, "Waiting for the first designs."));
  const { most } = data.live, began = performance.now();
  let count = 0, first = 0, chosenNow = data.best, round = 0;
  chosen.push((i) => { chosenNow = i; });
  async function ask() {
    const { designs, ended, hypervolume } = await (await fetch(`news?from=${count}`)).json();
    if (designs.length) receive(designs, hypervolume);
    if (ended) { location.reload(); return; }
    setTimeout(ask, 700);
  }
  function receive(designs, hypervolume) {
    if (!count) first = designs.length;
    round++;
    for (const row of designs.slice(0, COUNT - count)) {
      const k = row.slice(0, space.n), why = row.at(-1), code = data.designs.reasons.indexOf(why);
      kOf.set(k, count * space.n);
      values.set(row.slice(space.n, -1).map((v) => v ?? NaN), count * WIDTH);
      generation[count] = round;
      feasible[count] = why ? 0 : 1;
      reasonCodes[count] = code < 0 ? data.designs.reasons.push(why) - 1 : code;
      depths.delete(count);
      walked.delete(count++);
    }
    const among = Array.from({ length: count }, (_, i) => i).filter((i) => feasible[i]), following = chosenNow === data.best;
    if (!following) { front.clear(); undominated(among).forEach((i) => front.add(i)); explore.until(Infinity); }
    data.best = following ? Math.max(showBest(explore, Infinity, among), 0) : Math.max(bestOf(several ? [...front] : among), 0);
    const c = data.columns.findIndex((column) => column.name === data.objectives[0]);
    data.history.push({ evaluations: count, best: several ? hypervolume : values[data.best * WIDTH + c], median: null, front: front.size });
    found.draw();
    const rate = (count - first) / (performance.now() - began), left = rate > 0 ? (most - count) / rate / 1000 : NaN;
    status.textContent = `${count} of at most ${most} designs walked${count >= most ? "; the best are walked again and the report is written" : Number.isFinite(left) ? `; at most ${left < 90 ? `${Math.ceil(left)} s` : `${Math.ceil(left / 60)} min`} left` : ""}.`;
  }
  ask().catch(() => { status.textContent = `The search no longer answers: it has ended or was stopped. ${count} designs were walked.`; });
}
