"use strict";
// How exact verified answers are, what precision costs, and what becomes of every problem.

function boxesOf(view, field) {
  const picked = selected(view), found = [];
  for (const {solver, cells} of cellsShown(view)) {
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
  for (const solver of solversShown(view)) {
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

// ----- verdicts counted, and one by one where problems are meant to break something

// Colour-blind safe: blue is good, black on red is a lie, greys and yellows are honest failures.
const VERDICT_COLOURS = {v: "#2b7bba", r: "#56a3a6", f: "#b3261e", b: "#dd9a84", h: "#cdb04b", q: "#d8604f", w: "#e8a33d", i: "#f2cf66", t: "#e3b7a0", n: "#c9a0c9", p: "#f0dca0",
                         u: "#b9c2cc", c: "#6b4c9a", k: "#8d7bb5", m: "#a58fc9", e: "#c8b8a8", x: "#e4e8ec", ".": "#f8f9fa"};
const VERDICT_ORDER = "vrfqbhwitnpuckmex";

function coverageFigure(view) {
  const all = selected(view), picked = complete(all, view), rows = [];
  for (const {solver, cells} of cellsShown(view)) {
    const counts = {};
    for (const i of picked) counts[cells.verdicts[i]] = (counts[cells.verdicts[i]] ?? 0) + 1;
    rows.push({solver, counts});
  }
  const traces = [...VERDICT_ORDER].filter((letter) => rows.some(({counts}) => counts[letter])).map((letter) => ({
    type: "bar", orientation: "h", name: VERDICTS[letter], y: rows.map(({solver}) => solver.key),
    x: rows.map(({counts}) => (counts[letter] ?? 0)), marker: {color: VERDICT_COLOURS[letter]}, hoverinfo: "text", textposition: "none",
    text: rows.map(({solver, counts}) => `<b>${solver.key}</b><br>${VERDICTS[letter]}: ${counts[letter] ?? 0} of ${picked.length}`)}));
  note("coverage", `${picked.length} problems at ${tierName(view.tier)}.${leftOut(all, picked)}`);
  return {traces, layout: layoutOf(linearAxis("problems"), linearAxis("", {type: "category", autorange: "reversed", showgrid: false}),
                                   {barmode: "stack", bargap: 0.25, showlegend: true, legend: {orientation: "h", y: 1.02, yanchor: "bottom", traceorder: "normal"},
                                    margin: {l: 8, r: 8, t: narrow() ? 120 : 60, b: 8}}),
          height: 170 + 24 * Math.max(rows.length, 4) + (narrow() ? 60 : 0)};
}

function pathologicalFigure(view) {
  const set = PROBLEMS.sets.indexOf("pathological");
  const picked = [];
  for (let i = 0; i < COUNT; ++i) if (PROBLEMS.set[i] === set) picked.push(i);
  const letters = VERDICT_ORDER + ".", solvers = SOLVERS.filter(({key}) => view.shown.includes(key) && cellsOf(key, view.tier));
  const z = [], text = [];
  for (const i of picked) {
    z.push(solvers.map(({key}) => letters.indexOf(cellsOf(key, view.tier).verdicts[i])));
    text.push(solvers.map(({key}) => {
      const cells = cellsOf(key, view.tier);
      return `<b>${key}</b> on ${PROBLEMS.name[i]}<br>${VERDICTS[cells.verdicts[i]]} at ${tierName(view.tier)}<br>` +
        `ρ ${residual(cells.get("rho")[i])}, ${seconds(cells.get("time")[i])}`;
    }));
  }
  const scale = [], used = new Set(z.flat());
  [...letters].forEach((letter, k) => scale.push([k / letters.length, VERDICT_COLOURS[letter]], [(k + 1) / letters.length, VERDICT_COLOURS[letter]]));
  // A legend by empty bars: a heat map has none.
  const legend = [...letters].filter((_, k) => used.has(k)).map((letter) => ({type: "scatter", mode: "markers", x: [null], y: [null],
    name: VERDICTS[letter], marker: {symbol: "square", size: 11, color: VERDICT_COLOURS[letter]}, showlegend: true}));
  return {traces: [{type: "heatmap", z, text, hoverinfo: "text", colorscale: scale, zmin: -0.5, zmax: letters.length - 0.5, showscale: false,
                    xgap: 1, ygap: 1, x: solvers.map(({key}) => key), y: picked.map((i) => PROBLEMS.name[i]), showlegend: false}, ...legend],
          layout: layoutOf(linearAxis("", {type: "category", tickangle: -60, showgrid: false, side: "top"}),
                           linearAxis("", {type: "category", autorange: "reversed", showgrid: false, tickfont: {size: narrow() ? 8 : 10.5}, dtick: 1}),
                           {showlegend: true, legend: {orientation: "h", y: 0, yanchor: "top"}, margin: {l: 8, r: 8, t: 10, b: narrow() ? 130 : 60}}),
          height: 260 + 16 * picked.length};
}
