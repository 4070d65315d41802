"use strict";
// How exact verified answers are, and what precision costs.

function boxesOf(view, field) {
  const picked = selected(view), found = [];
  for (const solver of SOLVERS.filter(({key}) => view.shown.includes(key))) {
    const cells = cellsOf(solver.key, view.tier);
    if (!cells) continue;
    const all = cells.get(field), values = [];
    for (const i of picked) {
      if (cells.verdicts[i] === "v" && !Number.isNaN(all[i])) values.push(Math.max(all[i], LEAST_RESIDUAL));
    }
    if (values.length) found.push({solver, values: sorted(values)});
  }
  return found;
}

function boxFigure(view, field, title, tierLine) {
  const boxes = boxesOf(view, field), all = [];
  const traces = boxes.map(({solver, values}) => {
    const at = [0, 0.25, 0.5, 0.75, 1].map((share) => quantile(values, share));
    all.push(at[0], at[4]);
    return {type: "box", name: solver.key, y: [solver.key], orientation: "h", lowerfence: [at[0]], q1: [at[1]], median: [at[2]],
            q3: [at[3]], upperfence: [at[4]], line: {color: solver.colour, width: 1.5}, fillcolor: solver.colour + "33",
            hoverinfo: "x+name", width: 0.6};
  });
  // Invisible marks carry the words: boxes from quantiles have none.
  traces.push({type: "scatter", mode: "markers", marker: {opacity: 0, size: 16, color: INK}, hoverinfo: "text",
               x: boxes.map(({values}) => quantile(values, 0.5)), y: boxes.map(({solver}) => solver.key),
               text: boxes.map(({solver, values}) => `<b>${solver.key}</b>, ${values.length} verified answers<br>median ` +
                 `${residual(quantile(values, 0.5))}<br>99 %: ${residual(quantile(values, 0.99))}<br>largest ${residual(values[values.length - 1])}`)});
  const shapes = tierLine ? [{type: "line", x0: view.tier, x1: view.tier, y0: 0, y1: 1, yref: "paper", line: {color: SOFT, width: 1, dash: "dot"}}] : [];
  return {traces, layout: layoutOf(logAxis(title, "residual", [...all, tierLine ? view.tier : NaN]),
                                   linearAxis("", {type: "category", autorange: "reversed", showgrid: false}), {shapes}),
          height: 110 + 26 * Math.max(boxes.length, 4)};
}

const rhoFigure = (view) => boxFigure(view, "rho", "scaled natural residual ρ of verified answers", true);
const errorFigure = (view) => boxFigure(view, "werror", "error of w against the proved answer (scaled)", false);

function precisionFigure(view) {
  const traces = [], allX = [], allY = [];
  for (const solver of SOLVERS.filter(({key}) => view.shown.includes(key))) {
    const rows = DATA.precision.filter((row) => row.solver === solver.key && row.set === "counted" && row.rho_median > 0)
      .sort((a, b) => b.tier - a.tier);
    if (!rows.length) continue;
    const y = rows.map((row) => Math.max(row.rho_median, LEAST_RESIDUAL));
    allX.push(...rows.map((row) => row.mean_s));
    allY.push(...y);
    traces.push({type: "scatter", mode: "lines+markers", name: solver.key, x: rows.map((row) => row.mean_s), y, hoverinfo: "text",
                 line: lineOf(solver), marker: markerOf(solver),
                 text: rows.map((row) => `<b>${solver.key}</b> asked for ${tierName(row.tier)}<br>${percent(row.verified_share)} verified<br>` +
                   `mean time ${seconds(row.mean_s)}<br>median ρ ${residual(row.rho_median)}`)});
  }
  return {traces, layout: layoutOf(logAxis("shifted geometric mean of the time of all answers, right or not", "seconds", allX),
                                   logAxis("median ρ delivered", "residual", allY))};
}
