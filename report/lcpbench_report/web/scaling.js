"use strict";
// Exponents of time over rows.

function scalingFigure(view) {
  const rows = DATA.scaling.filter((row) => view.shown.includes(row.solver) && Math.abs(Math.log(row.tier / view.tier)) < 1e-6 &&
    (view.family === "*" || row.family === view.family));
  const traces = [], order = SOLVERS.filter(({key}) => rows.some((row) => row.solver === key));
  for (const solver of order) {
    const mine = rows.filter((row) => row.solver === solver.key);
    const words = mine.map((row) => `<b>${solver.key}</b> on ${row.family}<br>time ~ n^${row.exponent.toFixed(2)} ` +
      `(${row.exponent_low?.toFixed(2)} to ${row.exponent_high?.toFixed(2)})<br>${row.problems} problems, ${row.rows_min} to ${row.rows_max} rows`);
    const one = mine.length === 1;
    traces.push({type: "scatter", mode: "markers", name: solver.key, x: mine.map((row) => row.exponent), y: mine.map(() => solver.key), text: words,
                 hoverinfo: "text", marker: markerOf(solver, one ? 9 : 6, {opacity: one ? 1 : 0.55}),
                 error_x: one ? {type: "data", symmetric: false, color: solver.colour, thickness: 1.5,
                                 array: [mine[0].exponent_high - mine[0].exponent], arrayminus: [mine[0].exponent - mine[0].exponent_low]} : undefined});
    if (!one) {
      traces.push({type: "scatter", mode: "markers", name: solver.key, x: [median(mine.map((row) => row.exponent))], y: [solver.key],
                   hoverinfo: "text", text: [`<b>${solver.key}</b>: median over ${mine.length} families ${median(mine.map((row) => row.exponent)).toFixed(2)}`],
                   marker: {symbol: "line-ns-open", size: 18, line: {color: INK, width: 2.5}, color: INK}});
    }
  }
  note("scaling", view.family === "*" ? "A mark per family; the bar is their median. Choose a family to see its interval."
    : "Least squares on the logarithms with Student's 95 % interval.");
  return {traces, layout: layoutOf(linearAxis("exponent p of time ~ n^p"), linearAxis("", {type: "category", autorange: "reversed"})),
          height: 110 + 24 * Math.max(order.length, 4)};
}
