"use strict";
// What becomes of every problem: verdicts counted, and one by one where problems are meant to break something.

// Colour-blind safe: blue is good, black on red is a lie, greys and yellows are honest failures.
const VERDICT_COLOURS = {v: "#2b7bba", r: "#56a3a6", f: "#b3261e", b: "#dd9a84", h: "#cdb04b", q: "#d8604f", w: "#e8a33d", i: "#f2cf66", t: "#e3b7a0", n: "#c9a0c9", p: "#f0dca0",
                         u: "#b9c2cc", c: "#6b4c9a", k: "#8d7bb5", m: "#a58fc9", e: "#c8b8a8", x: "#e4e8ec", ".": "#f8f9fa"};
const VERDICT_ORDER = "vrfqbhwitnpuckmex";

function coverageFigure(view) {
  const all = selected(view), picked = complete(all, view), rows = [];
  for (const solver of SOLVERS.filter(({key}) => view.shown.includes(key))) {
    const cells = cellsOf(solver.key, view.tier);
    if (!cells) continue;
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
