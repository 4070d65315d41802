"use strict";
// Steps of recorded motions, and motions driven by each solver.

function latencyFigure(view) {
  const rows = DATA.latency.filter((row) => view.shown.includes(row.solver) && String(row.size) === view.size && !String(row.mode).startsWith("deadline"));
  const traces = [];
  for (const solver of solversShown(view)) {
    for (const mode of ["cold", "warm"]) {
      const mine = rows.filter((row) => row.solver === solver.key && row.mode === mode);
      if (!mine.length) continue;
      const row = nearestTier(mine, view.tier);
      const x = ["p50", "p99", "max"].map((level) => row[level] ?? NaN);
      const words = `<b>${solver.key}</b>, ${mode} starts, asked for ${tierName(row.tier)}<br>p50 ${seconds(x[0])}, p99 ${seconds(x[1])}, ` +
        `largest ${seconds(x[2])}<br>${percent(row.verified_share)} of ${row.steps} steps verified` +
        (row.warm_gain ? `<br>a warm start gains ${plain(row.warm_gain)}×` : "");
      traces.push(traceOf(solver, "lines+markers", {
        name: `${solver.key} ${mode}`, x, y: x.map(() => `${solver.key}, ${mode}`), text: x.map(() => words),
        line: {...lineOf(solver), dash: mode === "cold" ? "dot" : "solid"},
        marker: {color: solver.colour, symbol: ["circle", "diamond", "line-ns-open"], size: [9, 8, 12], line: {color: solver.colour, width: 2}}}));
    }
  }
  return {traces, layout: layoutOf(logAxis("latency of a step", "seconds", traces.flatMap(({x}) => x)), nameAxis({showgrid: true})),
          height: heightOf(traces.length, 20, 6)};
}

function deadlineFigure(view) {
  const rows = DATA.deadlines.filter((row) => view.shown.includes(row.solver) && String(row.size) === view.size);
  const tier = rows.length ? nearestTier(rows, view.tier).tier : NaN;
  const deadlines = [...new Set(rows.map((row) => row.deadline_s))].sort((a, b) => a - b);
  const traces = SOLVERS.filter(({key}) => rows.some((row) => row.solver === key)).map((solver) => {
    const mine = deadlines.map((deadline) => rows.find((row) => row.solver === solver.key && row.tier === tier && row.deadline_s === deadline));
    const missed = mine.map((row) => row && row.verified_share < 1 ? 1 - row.verified_share : null);
    return {type: "bar", name: solver.key, x: deadlines.map(seconds), y: missed, hoverinfo: "text", textposition: "none",
            marker: {color: solver.colour, pattern: {shape: solver.dash === "solid" ? "" : "/"}},
            text: mine.map((row, k) => row ? `<b>${solver.key}</b>, ${seconds(deadlines[k])} a step<br>${percent(row.in_time_share)} in time, ` +
              `${percent(row.verified_share)} verified at ${tierName(tier)}<br>99 % of ρ: ${residual(row.rho_p99 ?? NaN)}` : "")};
  });
  const perfect = deadlines.map((deadline) => rows.filter((row) => row.tier === tier && row.deadline_s === deadline && row.verified_share === 1))
    .map((found, k) => found.length ? `${seconds(deadlines[k])}: ${found.map(({solver}) => solver).join(", ")}` : "").filter(Boolean);
  note("deadline", Number.isNaN(tier) ? "" : `Judged at ${tierName(tier)}; every step is given the best answer that was there in time. ` +
    (perfect.length ? `No step is missed within ${perfect.join("; ")}.` : ""));
  return {traces, layout: layoutOf(linearAxis("deadline of a step", {type: "category"}),
                                   logAxis("share of steps missed: late, or not verified", "share", [...traces.flatMap(({y}) => y), 1]), {barmode: "group", bargap: 0.15})};
}

const MOTION_DASHES = ["solid", "dash", "dot", "dashdot"];  // loosest tolerance first
const LEAST_DRIFT = 1e-17;

function motionFigure(view, field, title) {
  const curves = DATA.motion.filter((curve) => `${curve.scene}@${curve.level}` === view.scene && view.shown.includes(curve.solver));
  const tolerances = [...new Set(curves.map((curve) => curve.tolerance))].sort((a, b) => b - a);
  const traces = curves.map((curve) => {
    const solver = BY_KEY.get(curve.solver), y = curve[field].slice(1).map((value) => value === null ? null : Math.max(value, LEAST_DRIFT));
    return traceOf(solver, "lines", {
      x: curve.time.slice(1), y,
      line: {color: solver.colour, width: 1.6, dash: MOTION_DASHES[Math.min(tolerances.indexOf(curve.tolerance), 3)]},
      text: y.map((value) => `<b>${curve.driver}</b> at ${tierName(curve.tolerance)}<br>${title}: ${residual(value ?? NaN)}` +
        (curve.stopped ? `<br>stopped: ${curve.stopped}` : ""))});
  });
  note("motion", tolerances.length ? `Lines: ${tolerances.map((tolerance, k) => `${tierName(tolerance)} ${MOTION_DASHES[Math.min(k, 3)]}`).join(", ")}.`
    : "None of the solvers shown drove this scene.");
  return {traces, layout: layoutOf(linearAxis("time [s]"), logAxis(title, "residual", traces.flatMap(({y}) => y)))};
}

const energyFigure = (view) => motionFigure(view, "energy", "energy error / largest kinetic energy");
const penetrationFigure = (view) => motionFigure(view, "penetration", "deepest penetration so far [m]");
