"use strict";
// The table of the selection: who verifies what, how fast and how exactly.

function leagueRows(view) {
  const all = selected(view), picked = complete(all, view), best = bestTimes(view.shown, view.tier);
  const rows = (picked.length ? cellsShown(view) : []).map(({solver, cells}) => {
    const time = cells.get("time"), rho = cells.get("rho"), error = cells.get("werror");
    const good = picked.filter((i) => cells.verdicts[i] === "v"), taken = picked.filter((i) => cells.verdicts[i] !== "u");
    const errors = sorted(good.map((i) => error[i])), weights = good.map((i) => WEIGHTS[i]);
    return {solver: solver.key, verified: good.length && good.length === taken.length ? 1 : weightOf(good) / weightOf(taken),
               unasked: picked.length - taken.length,
               lies: picked.filter((i) => "fq".includes(cells.verdicts[i])).length,
               below: picked.filter((i) => cells.verdicts[i] === "b").length,
               mean: geometricMean(good.map((i) => time[i]), weights, DATA.shift),
               ratio: weightedMedian(good.map((i) => time[i] / best[i]), weights), rho: weightedMedian(good.map((i) => rho[i]), weights),
               error: quantile(errors, 0.99)};
  });
  return {rows, count: picked.length, missing: leftOut(all, picked)};
}

const LEAGUE = [
  ["solver", "solver", (value) => value], ["verified", "verified", percent], ["lies", "false claims", String], ["below", "below the tier", String],
  ["mean", "mean fresh time of the verified", seconds], ["ratio", "median time / best shown", times], ["rho", "median ρ", residual],
  ["error", "99 % of w errors", residual], ["unasked", "not asked", String],
];
const leagueOrder = {by: "verified", down: true};

function leagueTable(view) {
  const {rows, count, missing} = leagueRows(view), table = document.getElementById("league");
  const {by, down} = leagueOrder;
  const key = (row) => Number.isNaN(row[by]) ? (down ? -Infinity : Infinity) : row[by];  // last
  rows.sort((a, b) => (down ? -1 : 1) * ((key(a) > key(b)) - (key(a) < key(b))) || a.ratio - b.ratio);
  table.replaceChildren();
  const head = table.createTHead().insertRow();
  for (const [field, title] of LEAGUE) {
    const cell = document.createElement("th"), button = document.createElement("button");
    button.type = "button";
    button.textContent = title + (field === by ? (down ? " ↓" : " ↑") : "");
    button.addEventListener("click", () => {
      leagueOrder.down = field === by ? !down : ["verified", "unasked", "lies", "below"].includes(field);
      leagueOrder.by = field;
      leagueTable(view);
    });
    cell.append(button);
    head.append(cell);
  }
  const body = table.createTBody();
  for (const row of rows) {
    const line = body.insertRow();
    for (const [field, , words] of LEAGUE) {
      const cell = document.createElement(field === "solver" ? "th" : "td");
      cell.append(...field === "solver" ? [symbolOf(BY_KEY.get(row.solver)), " ", row.solver] : [words(row[field])]);
      if (field === "lies" && row.lies) cell.className = "bad";
      line.append(cell);
    }
  }
  note("league", `${count} problems at ${tierName(view.tier)}. Each of k variants of one base weighs 1/k. The mean is geometric, shifted by ${seconds(DATA.shift)}, over each solver's own verified ` +
    "answers: compare it only between solvers that verify alike; the ratio compares problem by problem." + missing);
}
