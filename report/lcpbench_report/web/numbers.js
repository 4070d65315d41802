"use strict";
// Numbers as words, axes, and the few statistics that the page computes itself.

const INK = "#1c2430", SOFT = "#5a6573", LINE = "#dfe4ea";

/** A unit of time and its exponent, of 10^e seconds. */
const unitOf = (e) => e >= 0 ? ["s", 0] : e >= -3 ? ["ms", -3] : e >= -6 ? ["µs", -6] : ["ns", -9];

function seconds(value) {
  if (!Number.isFinite(value)) return "–";
  const [unit, exponent] = unitOf(Math.log10(value / 0.9995)), scaled = value / 10 ** exponent;
  return `${scaled.toFixed(scaled >= 99.95 ? 0 : scaled >= 9.995 ? 1 : 2)} ${unit}`;
}

function residual(value) {
  if (!Number.isFinite(value)) return "–";
  return value === 0 ? "0" : value.toExponential(1);
}

function plain(value) {
  if (!Number.isFinite(value)) return "–";
  return value >= 1000 ? value.toFixed(0) : String(Number(value.toPrecision(3)));
}

const times = (value) => `${plain(value)}×`;
const percent = (value) => Number.isFinite(value) ? `${(100 * value).toFixed(value > 0 && value < 0.0995 ? 1 : 0)} %` : "–";

/** Kind of a value -> its words in hovers, and on axes those of a power of ten. */
const KINDS = {
  seconds: {words: seconds, tick: (e) => `${10 ** (e - unitOf(e)[1])} ${unitOf(e)[0]}`},
  residual: {words: residual, tick: (e) => `1e${e}`},
  ratio: {words: times, tick: (e) => e < -3 || e > 4 ? `1e${e}×` : `${Number((10 ** e).toPrecision(1))}×`},
  share: {words: percent, tick: (e) => `${Number((10 ** (e + 2)).toPrecision(1))} %`},
  plain: {words: plain, tick: (e) => e < -3 || e > 5 ? `1e${e}` : `${Number((10 ** e).toPrecision(1))}`},
};

const narrow = () => window.innerWidth < 700;

/** A long title in two lines where the screen is narrow. */
function titleOf(text) {
  if (!narrow() || text.length < 36) return {text, standoff: 8};
  const middle = text.length / 2, gaps = [...text.matchAll(/ /g)].map((found) => found.index);
  const at = gaps.reduce((a, b) => Math.abs(a - middle) <= Math.abs(b - middle) ? a : b, 0);
  return {text: at ? `${text.slice(0, at)}<br>${text.slice(at + 1)}` : text, standoff: 8};
}

/** A logarithmic axis with a tick for every power of ten, or for every other one where there are many. */
function logAxis(title, kind, values, most = 8) {
  const known = values.filter((value) => value > 0 && value < Infinity);
  const [low, high] = known.length ? [Math.min, Math.max].map((end) => known.reduce((a, b) => end(a, b))) : [1, 10];
  const from = Math.log10(low), to = Math.log10(high), room = Math.max(0.04 * (to - from), 0.05);
  const first = Math.ceil(from - room), last = Math.floor(to + room);
  const step = Math.max(1, Math.ceil((last - first + 1) / most));
  let ticks = [];
  for (let e = first; e <= last; e += step) ticks.push(e);
  if (ticks.length < 2) {  // within a decade
    ticks = [first - 1, first].flatMap((e) => [1, 2, 5].map((m) => e + Math.log10(m))).filter((e) => e >= from - room && e <= to + room);
  }
  const word = (e) => Number.isInteger(e) ? KINDS[kind].tick(e) : KINDS[kind].words(10 ** e);
  return {type: "log", title: titleOf(title), range: [from - room, to + room], tickvals: ticks.map((e) => 10 ** e),
          ticktext: ticks.map(word), gridcolor: LINE, zeroline: false, linecolor: SOFT, automargin: true};
}

function linearAxis(title, more = {}) {
  return {title: titleOf(title), gridcolor: LINE, zeroline: false, linecolor: SOFT, automargin: true, ...more};
}

/** A name per row, the first on top. */
const nameAxis = (more = {}) => linearAxis("", {type: "category", autorange: "reversed", showgrid: false, ...more});

const heightOf = (rows, each = 24, least = 4) => 110 + each * Math.max(rows, least);

function layoutOf(xaxis, yaxis, more = {}) {
  return {font: {family: "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', Arial, sans-serif",
                 size: narrow() ? 11 : 13, color: INK},
          paper_bgcolor: "#fff", plot_bgcolor: "#fff", showlegend: false, hovermode: "closest", xaxis, yaxis,
          hoverlabel: {align: "left", bgcolor: "#fff", bordercolor: SOFT, font: {color: INK}},
          margin: narrow() ? {l: 8, r: 8, t: 12, b: 8} : {l: 16, r: 16, t: 34, b: 16}, ...more};
}

function sorted(values) {
  return values.filter((value) => !Number.isNaN(value)).sort((a, b) => a - b);
}

/** Linear interpolation between order statistics; `values` ascending. */
function quantile(values, share) {
  if (!values.length) return NaN;
  const at = share * (values.length - 1), below = Math.floor(at);
  if (below + 1 >= values.length || values[below] === values[below + 1]) return values[below];
  return values[below] + (at - below) * (values[below + 1] - values[below]);
}

const median = (values) => quantile(sorted([...values]), 0.5);

/** The least value with half of the weight at or below it; of two that share the middle their mean. */
function weightedMedian(values, weights) {
  const order = values.map((_, k) => k).filter((k) => !Number.isNaN(values[k])).sort((a, b) => values[a] - values[b]);
  const half = order.reduce((sum, k) => sum + weights[k], 0) / 2;
  let below = 0;
  const at = order.findIndex((k) => (below += weights[k]) > half * (1 - 1e-9));
  const next = below > half * (1 + 1e-9) ? at : Math.min(at + 1, order.length - 1);
  return (values[order[at]] + values[order[next]]) / 2;
}

/** exp(mean of log(x + shift)) - shift */
function geometricMean(values, weights = values.map(() => 1), shift = 0) {
  const whole = weights.reduce((sum, weight) => sum + weight, 0);
  return values.length ? Math.exp(values.reduce((sum, value, k) => sum + weights[k] * Math.log(value + shift), 0) / whole) - shift : NaN;
}

/** How marks and lines of a solver look, everywhere. */
function lineOf(solver, width = 2) {
  return {color: solver.colour, dash: solver.dash, width: solver.origin === "own" ? width : 0.75 * width};
}

function markerOf(solver, size = 7, more = {}) {
  return {symbol: solver.symbol, color: solver.colour, size, line: {color: solver.colour, width: 1.2}, ...more};
}

/** Marks or lines of a solver; `more` has x, y and text, and what is different. */
function traceOf(solver, mode, more) {
  return {type: "scatter", mode, name: solver.key, hoverinfo: "text", line: lineOf(solver), marker: markerOf(solver), ...more};
}
