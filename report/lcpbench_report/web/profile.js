"use strict";
// Performance profiles [Dolan 2002] of the selection, over the solvers shown.

const LARGEST_RATIO = 1000;

function profileFigure(view) {
  const all = selected(view), picked = complete(all, view), best = bestTimes(view.shown, view.tier);
  const traces = [], whole = weightOf(picked);
  let solvable = 0;
  for (const i of picked) if (!Number.isNaN(best[i])) ++solvable;
  for (const solver of SOLVERS.filter(({key}) => view.shown.includes(key))) {
    const cells = cellsOf(solver.key, view.tier);
    if (!cells || !picked.length) continue;
    const time = cells.get("time"), good = picked.filter((i) => cells.verdicts[i] === "v");
    good.sort((a, b) => time[a] / best[a] - time[b] / best[b]);
    const x = [1], y = [0], text = [];
    let reached = 0;
    for (const i of good) {
      reached += WEIGHTS[i];
      if (time[i] / best[i] > LARGEST_RATIO) break;
      x.push(time[i] / best[i]);
      y.push(Math.min(1, reached / whole));
    }
    x.push(LARGEST_RATIO);
    y.push(y[y.length - 1]);
    x.forEach((ratio, k) => text.push(`<b>${solver.key}</b><br>${percent(y[k])} of problems within ${plain(ratio)}× of the best<br>` +
      `${percent(weightOf(good) / whole)} verified in all`));
    traces.push({type: "scatter", mode: "lines", name: solver.key, x, y, text, hoverinfo: "text",
                 line: {...lineOf(solver), shape: "hv"}});
  }
  note("profile", `${picked.length} problems, each of k variants of one base with weight 1/k, of which ${solvable} are verified by a solver that is shown. What is not verified, ` +
    "or excluded by rule, never comes in; the height at the right is the share solved." + leftOut(all, picked));
  return {traces, layout: layoutOf(logAxis("time / fastest verified time of those shown", "ratio", [1, LARGEST_RATIO]),
                                   linearAxis("share of problems", {range: [-0.01, 1.02], tickformat: ".0%"}))};
}
