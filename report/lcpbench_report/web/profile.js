"use strict";
// Performance profiles [Dolan 2002] of the selection, over the solvers shown.

const LARGEST_RATIO = 1000;

function profileFigure(view) {
  const all = selected(view), picked = complete(all, view), best = bestTimes(view.shown, view.tier);
  const traces = [];
  let solvable = 0;
  for (const i of picked) if (!Number.isNaN(best[i])) ++solvable;
  for (const solver of SOLVERS.filter(({key}) => view.shown.includes(key))) {
    const cells = cellsOf(solver.key, view.tier);
    if (!cells || !picked.length) continue;
    const time = cells.get("time"), ratios = [];
    for (const i of picked) if (cells.verdicts[i] === "v") ratios.push(time[i] / best[i]);
    ratios.sort((a, b) => a - b);
    const x = [1], y = [0], text = [];
    ratios.forEach((ratio, k) => {
      if (ratio > LARGEST_RATIO) return;
      x.push(ratio);
      y.push((k + 1) / picked.length);
    });
    x.push(LARGEST_RATIO);
    y.push(y[y.length - 1]);
    x.forEach((ratio, k) => text.push(`<b>${solver.key}</b><br>${percent(y[k])} of problems within ${plain(ratio)}× of the best<br>` +
      `${percent(ratios.length / picked.length)} verified in all`));
    traces.push({type: "scatter", mode: "lines", name: solver.key, x, y, text, hoverinfo: "text",
                 line: {...lineOf(solver), shape: "hv"}});
  }
  note("profile", `${picked.length} problems, of which ${solvable} are verified by a solver that is shown. What is not verified, ` +
    "or excluded by rule, never comes in; the height at the right is the share solved." + leftOut(all, picked));
  return {traces, layout: layoutOf(logAxis("time / fastest verified time of those shown", "ratio", [1, LARGEST_RATIO]),
                                   linearAxis("share of problems", {range: [-0.01, 1.02], tickformat: ".0%"}))};
}
