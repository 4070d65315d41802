"use strict";
// What payload.py wrote, unpacked when it is first asked for.

const DATA = JSON.parse(document.getElementById("data").textContent);
const SOLVERS = DATA.solvers;
const BY_KEY = new Map(SOLVERS.map((solver) => [solver.key, solver]));
const PROBLEMS = DATA.problems;
const COUNT = PROBLEMS.name.length;
const STEPS_PER_DECADE = 1600;
const ZERO = -32767, INFINITE = 32767, UNKNOWN = -32768;
const EXPLORED_SETS = PROBLEMS.sets.map((name) => name !== "pathological");

const VERDICTS = {
  v: "verified", b: "below the tier, which it was not asked for", h: "verified alone, not in a timed pass", r: "infeasible, proved without rounding", o: "infeasible within rounding", f: "false success", q: "false claim of infeasibility", i: "iteration limit", t: "time limit",
  n: "numerical failure", u: "not asked: not taken as it is given", c: "crashed", k: "killed at the limit", m: "out of memory",
  p: "claims infeasible, no accepted ray", w: "solves its own model, and not Coulomb's law", e: "other failure", x: "excluded by rule",
  ".": "not run",
};

function bytesOf(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/** Values by problem; NaN where nothing is known. */
function unpack(text) {
  const view = new DataView(bytesOf(text).buffer);
  return Float64Array.from({length: view.byteLength / 2}, (_, i) => {
    const code = view.getInt16(2 * i, true);
    if (code === UNKNOWN) return NaN;
    if (code === ZERO) return 0;
    return code === INFINITE ? Infinity : 10 ** (code / STEPS_PER_DECADE);
  });
}

const ORACLE = unpack(PROBLEMS.oracle);
const WEIGHTS = PROBLEMS.weight;  // of k variants of one base, 1/k each; origins of a size class alike
const weightOf = (picked) => picked.reduce((sum, i) => sum + WEIGHTS[i], 0);
const unpacked = new Map();

function numbersOf(packed, field) {
  if (!unpacked.has(packed)) unpacked.set(packed, {});
  return unpacked.get(packed)[field] ??= unpack(packed[field]);
}

/** 1e-6, as formats.py has it: toExponential writes e+3. */
const tierName = (tier) => tier.toExponential(0).replace("e+", "e");

/** One solver's cells at a tier; null where it has none. */
function cellsOf(solver, tier) {
  const mine = DATA.cells[solver], key = tierName(tier);
  if (!mine || !(key in mine.verdicts)) return null;
  const packed = mine.numbers[mine.places[key]];
  return {verdicts: mine.verdicts[key], get: (field) => numbersOf(packed, field)};
}

const solversShown = (view) => SOLVERS.filter(({key}) => view.shown.includes(key));

/** Of the solvers shown those that have cells at the tier, with these. */
const cellsShown = (view) => solversShown(view).map((solver) => ({solver, cells: cellsOf(solver.key, view.tier)})).filter(({cells}) => cells);

/** Of rows with a tier the one that is nearest to `wanted`. */
const nearestTier = (rows, wanted) =>
  rows.reduce((a, b) => Math.abs(Math.log(a.tier / wanted)) <= Math.abs(Math.log(b.tier / wanted)) ? a : b);

/** Smallest time of a verified answer by problem, over `solvers`; NaN where there is none. */
function bestTimes(solvers, tier) {
  const best = new Float64Array(COUNT).fill(NaN);
  for (const cells of solvers.map((solver) => cellsOf(solver, tier)).filter(Boolean)) {
    cells.get("time").forEach((time, i) => {
      if (cells.verdicts[i] === "v" && !(best[i] <= time)) best[i] = time;
    });
  }
  return best;
}

/** Size classes of the campaign that have problems here. */
const CLASSES = DATA.classes.map((of) => ({...of, high: of.high ?? Infinity})).filter(({low, high}) => PROBLEMS.rows.some((n) => n >= low && n <= high));

/** Those of `picked` that every solver shown was run on, or is excluded from by rule: of a campaign that is not at its
 *  end the others would count as failures. Solvers without any cell at the tier do not matter. */
function complete(picked, view) {
  const cells = view.shown.map((solver) => cellsOf(solver, view.tier)).filter((found) => found && picked.some((i) => found.verdicts[i] !== "."));
  return picked.filter((i) => cells.every((found) => found.verdicts[i] !== "."));
}

const leftOut = (picked, kept) => kept.length < picked.length
  ? ` ${picked.length - kept.length} more problems were not run with all solvers shown, and are left out.` : "";

/** Indices of problems. A family that was asked for is shown whole; else only problems that count. */
function selected(view) {
  const wanted = (i) => view.family === "*" ? PROBLEMS.counts[i] : PROBLEMS.families[PROBLEMS.family[i]] === view.family;
  return [...PROBLEMS.rows.keys()].filter((i) => PROBLEMS.rows[i] >= view.low && PROBLEMS.rows[i] <= view.high &&
    EXPLORED_SETS[PROBLEMS.set[i]] && wanted(i) && (view.origin === "*" || PROBLEMS.origins[PROBLEMS.origin[i]] === view.origin));
}
