// The designs of a run: their recorded values, heights and names.

const WIDTH = data.columns.length, values = oneMore(unpack(data.designs.values), WIDTH), COUNT = values.length / WIDTH - 1;
const DRAWN = COUNT; // the design after the last is the one that is drawn on the page
const generation = data.designs.generation && unpack(data.designs.generation);
const feasible = [...data.designs.feasible];
const reason = (i) => i === DRAWN ? sketch.reason : data.designs.reasons[i];
const front = new Set(data.front ? unpack(data.front) : []);
const MOST = 1000; // parallel lines of a colour at most

/** Columns to filter and draw designs by: recorded values, the generation, the hollow, and heights. */
const COLUMNS = data.columns.map((column, c) => {
  const flat = entry.flat?.[column.name];
  // J_W is told as a multiple of the flat foot's: both are negative
  const [show, more] = column.name === "efficiency" && flat < 0 ? [(v) => v / flat, { unit: OF_FLAT, maximise: true }] : [(v) => v, {}];
  return { ...column, ...more, show, flat: flat === undefined ? NaN : show(flat), of: (i) => show(values[i * WIDTH + c]) };
});
const plain = (name, unit, of) => ({ name, title: name, unit, maximise: true, variable: true, flat: NaN, show: (v) => v, of });
if (generation) COLUMNS.push({ ...plain("generation", "", (i) => generation[i]), maximise: false });
const depths = new Map();
if (COUNT) COLUMNS.push(plain("hollow", "mm", (i) => {
  if (!depths.has(i)) depths.set(i, MM * hollow(sole(i)));
  return depths.get(i);
}));
if (kOf) for (let p = 0; p < space.n; p++) COLUMNS.push(plain(`k${p + 1}`, "", (i) => kOf[i * space.n + p]));
const columnOf = (name) => COLUMNS.find((c) => c.name === name);
const ranking = columnOf(data.choice === "efficiency" ? "efficiency" : data.ranking_objective ?? "efficiency") ?? COLUMNS[0];

/** A design's number is its row in designs.csv, from 0. */
const numbers = data.designs.rows && unpack(data.designs.rows);
const BEST = { efficiency: "best in J_W", weights: "best by weights", limits: "best within limits" }[data.choice] ?? data.choice ?? "best";
const label = (i) => i === DRAWN ? "drawn here" : data.designs.labels ? data.designs.labels[i] : `design ${numbers[i]}${i === data.best ? `, the ${BEST}` : i === data.printed ? ", the foot to print" : ""}`;
