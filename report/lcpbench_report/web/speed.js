"use strict";
// The explorer: any metric against any property of the problems; who is the fastest where; performance profiles; exponents.

const METRICS = {
  time: {title: "fresh time", kind: "seconds", time: true},
  again: {title: "time of the same matrix with another b", kind: "seconds", time: true},
  problem: {title: "part of the time: checks, forms of A", kind: "seconds", time: true},
  prepare: {title: "part of the time: preparation", kind: "seconds", time: true},
  convert: {title: "part of the time: conversion for a library", kind: "seconds", time: true},
  solve: {title: "part of the time: solve", kind: "seconds", time: true},
  iterations: {title: "iterations (each solver's own)", kind: "plain"},
  rho: {title: "scaled natural residual ρ", kind: "residual"},
  backward: {title: "largest backward error", kind: "residual"},
  werror: {title: "error of w against the proved answer", kind: "residual"},
};
const AXES = {
  rows: {title: "rows n", kind: "plain", values: () => Float64Array.from(PROBLEMS.rows)},
  redundancy: {title: "share of dependent rows", kind: "plain", values: () => unpack(PROBLEMS.redundancy)},
  mass_ratio: {title: "largest mass ratio", kind: "plain", values: () => unpack(PROBLEMS.mass_ratio)},
  condition: {title: "condition of A on its range", kind: "residual", values: () => unpack(PROBLEMS.condition)},
  fraction_active: {title: "share of active rows", kind: "plain", values: () => unpack(PROBLEMS.fraction_active)},
};
const MOST_POINTS = 4000;  // more single problems are not drawn: the browser would stall, and nothing be seen
const LEAST_RESIDUAL = 1e-18;

/** What a time is divided by, by problem, or null; and the words for it. */
function normaliser(view) {
  if (!METRICS[view.metric].time || view.norm === "none") return null;
  if (view.norm === "oracle") return {by: ORACLE, title: " / one factorization that knows the active set", kind: "ratio"};
  if (view.norm === "rows") return {by: Float64Array.from(PROBLEMS.rows), title: " per row", kind: "seconds"};
  if (view.norm === "best") {
    return {by: bestTimes(view.shown, view.tier), title: " / fastest verified of those shown", kind: "ratio"};
  }
  const base = view.norm.slice("solver:".length);
  return {by: bestTimes([base], view.tier), title: ` / fresh time of ${base}`, kind: "ratio"};
}

function timesFigure(view) {
  const picked = selected(view), metric = METRICS[view.metric], axis = AXES[view.axis];
  const across = axis.values(), norm = normaliser(view), kind = norm ? norm.kind : metric.kind;
  const solvers = solversShown(view);
  const withPoints = picked.length * solvers.length <= MOST_POINTS;
  const traces = [];
  for (const {solver, cells} of cellsShown(view)) {
    const raw = cells.get(view.metric);
    const good = {x: [], y: [], text: []}, bad = {x: [], y: [], text: []}, groups = new Map();
    for (const i of picked) {
      let y = norm ? raw[i] / norm.by[i] : raw[i];
      if (metric.kind === "residual") y = Math.max(y, LEAST_RESIDUAL);
      if (!(y > 0) || !Number.isFinite(y) || !(across[i] > 0)) continue;
      const verified = cells.verdicts[i] === "v", into = verified ? good : bad;
      into.x.push(across[i]);
      into.y.push(y);
      into.text.push(`<b>${solver.key}</b> on ${PROBLEMS.name[i]}<br>${VERDICTS[cells.verdicts[i]]} at ` +
        `${tierName(view.tier)}<br>${metric.title}: ${KINDS[metric.kind].words(raw[i])}` +
        (norm ? `<br>shown: ${KINDS[kind].words(y)}` : "") + `<br>n = ${PROBLEMS.rows[i]}`);
      if (!verified) continue;
      // Lines go through means of like problems: of one size, or of a third of a decade.
      const key = view.axis === "rows" && view.family !== "*" ? across[i] : Math.round(3 * Math.log10(across[i]));
      groups.set(key, [...groups.get(key) ?? [], {x: across[i], y, weight: WEIGHTS[i]}]);
    }
    const means = [...groups].sort((a, b) => a[0] - b[0]).map(([, group]) => ({
      count: group.length, x: geometricMean(group.map(({x}) => x), group.map(({weight}) => weight)),
      y: geometricMean(group.map(({y}) => y), group.map(({weight}) => weight))}));
    traces.push(traceOf(solver, "lines+markers", {
      x: means.map(({x}) => x), y: means.map(({y}) => y), marker: markerOf(solver, withPoints ? 5 : 7),
      text: means.map(({count, x, y}) => `<b>${solver.key}</b><br>mean of ${count} verified: ${KINDS[kind].words(y)}<br>${axis.title}: ${plain(x)}`)}));
    if (withPoints) {
      traces.push(traceOf(solver, "markers", {...good, marker: markerOf(solver, 5, {opacity: 0.45})}));
      traces.push(traceOf(solver, "markers", {...bad, name: `${solver.key}, not verified`,
                                              marker: {symbol: "x-thin", size: 6, opacity: 0.6, line: {color: solver.colour, width: 1.4}}}));
    }
  }
  note("times", traces.length === 0 ? "Nothing that fits is in these results."
    : withPoints ? "Small marks: single problems (hover for their names); thin crosses: answers that were not verified. " +
      "Lines: geometric means of verified answers of like size."
      : "Lines: geometric means of verified answers of like size. Choose a family, or fewer solvers, to see single problems.");
  return {traces, layout: layoutOf(logAxis(axis.title, axis.kind, traces.flatMap(({x}) => x)),
                                   logAxis(metric.title + (norm ? norm.title : ""), kind, traces.flatMap(({y}) => y)))};
}

/** Families x sizes: the solver with the least geometric mean among those shown that verify all problems that any does. */
function winnersFigure(view) {
  const families = PROBLEMS.families, solvers = solversShown(view);
  const places = new Map(), picked = selected({...view, family: "*"});
  for (const i of picked) {
    const size = CLASSES.findIndex(({low, high}) => PROBLEMS.rows[i] >= low && PROBLEMS.rows[i] <= high);
    const key = `${PROBLEMS.family[i]}/${size}`;
    places.set(key, [...places.get(key) ?? [], i]);
  }
  const used = families.map((family, f) => f).filter((f) => CLASSES.some((_, c) => places.has(`${f}/${c}`)));
  const sizes = CLASSES.map((_, c) => c).filter((c) => used.some((f) => places.has(`${f}/${c}`)));
  const cells = solvers.map((solver) => cellsOf(solver.key, view.tier));
  const grid = used.map((f) => sizes.map((c) => {
    const problems = places.get(`${f}/${c}`) ?? [];
    const found = solvers.map((solver, s) => {
      const ran = cells[s] && problems.every((i) => cells[s].verdicts[i] !== ".");
      const good = ran ? problems.filter((i) => cells[s].verdicts[i] === "v") : [];
      return {s, verified: good.length, share: weightOf(good),
              mean: geometricMean(good.map((i) => cells[s].get("time")[i]), good.map((i) => WEIGHTS[i]))};
    });
    const most = Math.max(0, ...found.map((one) => one.verified)), weight = Math.max(0, ...found.map((one) => one.share));
    const ranked = found.filter((one) => most && one.share >= weight * (1 - 1e-9)).sort((a, b) => a.mean - b.mean);
    return {winner: ranked.length ? ranked[0].s : null, hover: !problems.length ? "no problems" : !ranked.length ? "verified by none" :
      `<b>${families[f]}</b>, ${CLASSES[c].label} rows<br>${problems.length} problems, ${most} verified<br>` +
      ranked.slice(0, 4).map((one) => `${solvers[one.s].key}: ${seconds(one.mean)}`).join("<br>")};
  }));
  const scale = [], count = Math.max(solvers.length, 1);
  solvers.forEach((solver, s) => scale.push([s / count, solver.colour], [(s + 1) / count, solver.colour]));
  const nameOf = (key) => key.length > 14 ? key.slice(0, 13) + "…" : key;
  const annotations = narrow() ? [] : grid.flatMap((row, y) => row.flatMap(({winner}, x) => winner === null ? [] : [
    {x, y, text: nameOf(solvers[winner].key), showarrow: false, font: {color: "#fff", size: 10.5}}]));
  return {traces: [{type: "heatmap", z: grid.map((row) => row.map(({winner}) => winner)), text: grid.map((row) => row.map(({hover}) => hover)),
                    hoverinfo: "text", colorscale: scale.length ? scale : [[0, LINE], [1, LINE]], zmin: -0.5,
                    zmax: count - 0.5, showscale: false, xgap: 2, ygap: 2, x: sizes.map((_, x) => x), y: used.map((_, y) => y)}],
          layout: layoutOf(linearAxis("rows n", {tickvals: sizes.map((_, x) => x), ticktext: sizes.map((c) => CLASSES[c].label), showgrid: false}),
                           linearAxis("", {tickvals: used.map((_, y) => y), ticktext: used.map((f) => families[f]), autorange: "reversed", showgrid: false}),
                           {annotations}),
          height: 90 + 24 * used.length};
}

// ----- performance profiles [Dolan 2002] of the selection, over the solvers shown

const LARGEST_RATIO = 1000;

function profileFigure(view) {
  const all = selected(view), picked = complete(all, view), best = bestTimes(view.shown, view.tier);
  const traces = [], whole = weightOf(picked);
  const solvable = picked.filter((i) => !Number.isNaN(best[i])).length;
  for (const {solver, cells} of picked.length ? cellsShown(view) : []) {
    const time = cells.get("time"), good = picked.filter((i) => cells.verdicts[i] === "v");
    good.sort((a, b) => time[a] / best[a] - time[b] / best[b]);
    const x = [1], y = [0];
    let reached = 0;
    for (const i of good) {
      reached += WEIGHTS[i];
      if (time[i] / best[i] > LARGEST_RATIO) break;
      x.push(time[i] / best[i]);
      y.push(Math.min(1, reached / whole));
    }
    x.push(LARGEST_RATIO);
    y.push(y[y.length - 1]);
    const text = x.map((ratio, k) => `<b>${solver.key}</b><br>${percent(y[k])} of problems within ${plain(ratio)}× of the best<br>` +
      `${percent(weightOf(good) / whole)} verified in all`);
    traces.push(traceOf(solver, "lines", {x, y, text, line: {...lineOf(solver), shape: "hv"}}));
  }
  note("profile", `${picked.length} problems, each of k variants of one base with weight 1/k, of which ${solvable} are verified by a solver that is shown. What is not verified, ` +
    "or excluded by rule, never comes in; the height at the right is the share solved." + leftOut(all, picked));
  return {traces, layout: layoutOf(logAxis("time / fastest verified time of those shown", "ratio", [1, LARGEST_RATIO]),
                                   linearAxis("share of problems", {range: [-0.01, 1.02], tickformat: ".0%"}))};
}

// ----- exponents of time over rows

function scalingFigure(view) {
  const rows = DATA.scaling.filter((row) => view.shown.includes(row.solver) && Math.abs(Math.log(row.tier / view.tier)) < 1e-6 &&
    (view.family === "*" || row.family === view.family));
  const traces = [], order = SOLVERS.filter(({key}) => rows.some((row) => row.solver === key));
  for (const solver of order) {
    const mine = rows.filter((row) => row.solver === solver.key);
    const words = mine.map((row) => `<b>${solver.key}</b> on ${row.family}<br>time ~ n^${row.exponent.toFixed(2)} ` +
      `(${row.exponent_low?.toFixed(2)} to ${row.exponent_high?.toFixed(2)})<br>${row.problems} problems, ${row.rows_min} to ${row.rows_max} rows`);
    const one = mine.length === 1, middle = median(mine.map((row) => row.exponent));
    traces.push(traceOf(solver, "markers", {
      x: mine.map((row) => row.exponent), y: mine.map(() => solver.key), text: words, marker: markerOf(solver, one ? 9 : 6, {opacity: one ? 1 : 0.55}),
      error_x: one ? {type: "data", symmetric: false, color: solver.colour, thickness: 1.5,
                      array: [mine[0].exponent_high - middle], arrayminus: [middle - mine[0].exponent_low]} : undefined}));
    if (!one) {
      traces.push(traceOf(solver, "markers", {
        x: [middle], y: [solver.key], text: [`<b>${solver.key}</b>: median over ${mine.length} families ${middle.toFixed(2)}`],
        marker: {symbol: "line-ns-open", size: 18, line: {color: INK, width: 2.5}, color: INK}}));
    }
  }
  note("scaling", view.family === "*" ? "A mark per family; the bar is their median. Choose a family to see its interval."
    : "Least squares on the logarithms with Student's 95 % interval.");
  return {traces, layout: layoutOf(linearAxis("exponent p of time ~ n^p"), nameAxis({showgrid: true})),
          height: heightOf(order.length)};
}
