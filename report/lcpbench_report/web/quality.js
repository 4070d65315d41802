"use strict";
// How exact verified answers are, what precision costs, and what becomes of every problem.

function boxFigure(view, field, title, tierLine) {
  const picked = selected(view);
  const boxes = cellsShown(view).map(({solver, cells}) => ({solver, values: sorted(picked.filter((i) => cells.verdicts[i] === "v")
    .map((i) => Math.max(cells.get(field)[i], LEAST_RESIDUAL)))})).filter(({values}) => values.length);
  const traces = boxes.map(({solver, values}) => {
    const at = [0, 0.25, 0.5, 0.75, 1].map((share) => quantile(values, share));
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
  return {traces, layout: layoutOf(logAxis(title, "residual", [...boxes.flatMap(({values}) => [values[0], values[values.length - 1]]), tierLine ? view.tier : NaN]),
                                   nameAxis(), {shapes}), height: heightOf(boxes.length, 26)};
}

const rhoFigure = (view) => boxFigure(view, "rho", "scaled natural residual ρ of verified answers", true);
const errorFigure = (view) => boxFigure(view, "werror", "error of w against the proved answer (scaled)", false);

function precisionFigure(view) {
  const traces = solversShown(view).map((solver) => {
    const rows = DATA.precision.filter((row) => row.solver === solver.key && row.set === "counted" && row.rho_median > 0)
      .sort((a, b) => b.tier - a.tier);
    return traceOf(solver, "lines+markers", {
      x: rows.map((row) => row.mean_s), y: rows.map((row) => Math.max(row.rho_median, LEAST_RESIDUAL)),
      text: rows.map((row) => `<b>${solver.key}</b> asked for ${tierName(row.tier)}<br>${percent(row.verified_share)} verified<br>` +
        `mean time ${seconds(row.mean_s)}<br>median ρ ${residual(row.rho_median)}`)});
  }).filter(({x}) => x.length);
  return {traces, layout: layoutOf(
    logAxis("shifted geometric mean of the time of all answers, right or not", "seconds", traces.flatMap(({x}) => x)),
    logAxis("median ρ delivered", "residual", traces.flatMap(({y}) => y)))};
}

// ----- verdicts counted, and one by one where problems are meant to break something

// Colour-blind safe: blue is good, black on red is a lie, greys and yellows are honest failures.
const VERDICT_COLOURS = {v: "#2b7bba", r: "#56a3a6", o: "#9cc9cb", f: "#b3261e", b: "#dd9a84", h: "#cdb04b", q: "#d8604f", w: "#e8a33d", i: "#f2cf66", t: "#e3b7a0", n: "#c9a0c9", p: "#f0dca0",
                         u: "#cfe0dc", c: "#6b4c9a", k: "#8d7bb5", m: "#a58fc9", e: "#c8b8a8", x: "#e4e8ec", ".": "#f8f9fa"};
const VERDICT_ORDER = "vrofqbhwitnpckmeux";

function coverageFigure(view) {
  const all = selected(view), picked = complete(all, view);
  const rows = cellsShown(view).map(({solver, cells}) => {
    const counts = {};
    for (const i of picked) counts[cells.verdicts[i]] = (counts[cells.verdicts[i]] ?? 0) + 1;
    return {solver, counts};
  });
  const traces = [...VERDICT_ORDER].filter((letter) => rows.some(({counts}) => counts[letter])).map((letter) => ({
    type: "bar", orientation: "h", name: VERDICTS[letter], y: rows.map(({solver}) => solver.key),
    x: rows.map(({counts}) => (counts[letter] ?? 0)), marker: {color: VERDICT_COLOURS[letter]}, hoverinfo: "text", textposition: "none",
    text: rows.map(({solver, counts}) => `<b>${solver.key}</b><br>${VERDICTS[letter]}: ${counts[letter] ?? 0} of ${picked.length}`)}));
  note("coverage", `${picked.length} problems at ${tierName(view.tier)}.${leftOut(all, picked)}`);
  return {traces, layout: layoutOf(linearAxis("problems"), nameAxis(),
                                   {barmode: "stack", bargap: 0.25, showlegend: true, legend: {orientation: "h", y: 1.02, yanchor: "bottom", traceorder: "normal"},
                                    margin: {l: 8, r: 8, t: narrow() ? 120 : 60, b: 8}}),
          height: 170 + 24 * Math.max(rows.length, 4) + (narrow() ? 60 : 0)};
}

function pathologicalFigure(view) {
  const set = PROBLEMS.sets.indexOf("pathological"), picked = [...PROBLEMS.set.keys()].filter((i) => PROBLEMS.set[i] === set);
  const letters = VERDICT_ORDER + ".", shown = cellsShown(view);
  const z = picked.map((i) => shown.map(({cells}) => letters.indexOf(cells.verdicts[i])));
  const text = picked.map((i) => shown.map(({solver, cells}) =>
    `<b>${solver.key}</b> on ${PROBLEMS.name[i]}<br>${VERDICTS[cells.verdicts[i]]} at ${tierName(view.tier)}<br>` +
    `ρ ${residual(cells.get("rho")[i])}, ${seconds(cells.get("time")[i])}`));
  const scale = [], used = new Set(z.flat());
  [...letters].forEach((letter, k) => scale.push([k / letters.length, VERDICT_COLOURS[letter]], [(k + 1) / letters.length, VERDICT_COLOURS[letter]]));
  // A legend by empty bars: a heat map has none.
  const legend = [...letters].filter((_, k) => used.has(k)).map((letter) => ({type: "scatter", mode: "markers", x: [null], y: [null],
    name: VERDICTS[letter], marker: {symbol: "square", size: 11, color: VERDICT_COLOURS[letter]}, showlegend: true}));
  return {traces: [{type: "heatmap", z, text, hoverinfo: "text", colorscale: scale, zmin: -0.5, zmax: letters.length - 0.5, showscale: false,
                    xgap: 1, ygap: 1, x: shown.map(({solver}) => solver.key), y: picked.map((i) => PROBLEMS.name[i]), showlegend: false}, ...legend],
          layout: layoutOf(linearAxis("", {type: "category", tickangle: -60, showgrid: false, side: "top"}),
                           nameAxis({tickfont: {size: narrow() ? 8 : 10.5}, dtick: 1}),
                           {showlegend: true, legend: {orientation: "h", y: 0, yanchor: "top"}, margin: {l: 8, r: 8, t: 10, b: narrow() ? 130 : 60}}),
          height: 260 + 16 * picked.length};
}
