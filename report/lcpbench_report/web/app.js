"use strict";
// What the visitor chose, the controls, and drawing what is in sight.

const view = {
  origin: "*", family: "*", low: 0, high: Infinity, tier: nearestTier([...DATA.tiers, ...DATA.tiers.length ? [] : [1e-6]].map((tier) => ({tier})), 1e-6).tier, metric: "time", norm: "none",
  axis: "rows", size: "all", scene: DATA.motion.length ? `${DATA.motion[0].scene}@${DATA.motion[0].level}` : "",
  shown: SOLVERS.filter((solver) => solver.shown).map(({key}) => key),
};

// Id of a figure -> what draws it.
const FIGURES = {
  times: timesFigure, winners: winnersFigure, profile: profileFigure, rho: rhoFigure, werror: errorFigure, precision: precisionFigure,
  coverage: coverageFigure, pathological: pathologicalFigure, latency: latencyFigure, deadline: deadlineFigure, energy: energyFigure,
  penetration: penetrationFigure, scaling: scalingFigure,
};
const CONFIG = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
                toImageButtonOptions: {format: "svg", filename: "lcpbench"}};
const HEIGHT = 440;

function note(figure, text) {
  const place = document.getElementById(`note-${figure}`);
  if (place) place.textContent = text;
}

/** An element of SVG. */
function drawn(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

const symbolOf = (solver) => drawn("svg", {viewBox: "-6 -6 12 12", class: "symbol"}, drawn("path", {
  d: solver.path, fill: solver.origin === "own" ? solver.colour : "#fff", stroke: solver.colour, "stroke-width": "1.6"}));

const dirty = new Set(), inSight = new Set();

function draw(id) {
  const place = document.getElementById(`figure-${id}`);
  if (!place) return null;
  dirty.delete(id);
  const {traces, layout, height} = FIGURES[id](view);
  // A phone shows the bar of buttons only where it is touched, over the plot.
  place.style.height = `${height ?? (narrow() ? 340 : HEIGHT)}px`;
  return Plotly.react(place, traces, {...layout, autosize: true}, {...CONFIG, displayModeBar: narrow() ? false : "hover"});
}

let waiting = 0;
function drawDirty() {
  if (waiting) return;
  waiting = requestAnimationFrame(() => {
    waiting = 0;
    for (const id of [...dirty]) if (inSight.has(id)) draw(id);
  });
}

function changed() {
  for (const id of Object.keys(FIGURES)) dirty.add(id);
  drawDirty();
  if (document.getElementById("league")) leagueTable(view);
  for (const chip of document.querySelectorAll("#chips .chip")) chip.setAttribute("aria-pressed", view.shown.includes(chip.dataset.solver));
  document.getElementById("legend").replaceChildren(...solversShown(view).map(chipOf));
  for (const other of document.querySelectorAll("select[data-choice]")) other.value = choiceOf(other.dataset.choice);
  const picture = document.getElementById("picture");
  picture.hidden = !DATA.pictures.includes(view.family);
  picture.href = `#scene-${view.family}`;
  document.getElementById("chosen").textContent = `(${view.shown.length} of ${SOLVERS.length} shown)`;
}

/** The ends of the rows are chosen by size classes. */
const choiceOf = (name) => String(name === "low" || name === "high" ? CLASSES.findIndex((one) => one[name] === view[name]) : view[name]);

function setChoice(name, value) {
  view[name] = name === "low" || name === "high" ? CLASSES[Number(value)][name] : name === "tier" ? Number(value) : value;
  changed();
}

function fillControls() {
  const explored = PROBLEMS.families.filter((_, f) => PROBLEMS.family.some((of, i) => of === f && EXPLORED_SETS[PROBLEMS.set[i]]));
  const sizes = CLASSES.map((one, c) => [String(c), one.label]);
  const entries = {
    origin: [["*", "all origins"], ...PROBLEMS.origins.map((origin) => [origin, origin])],
    family: [["*", "all families"], ...explored.map((family) => [family, family])],
    low: sizes, high: sizes, tier: DATA.tiers.map((tier) => [String(tier), tierName(tier)]),
    metric: Object.entries(METRICS).map(([key, {title}]) => [key, title]),
    norm: [["none", "none"], ["best", "fastest of those shown"], ["oracle", "one factorization (oracle)"], ["rows", "per row"],
           ...SOLVERS.map(({key}) => [`solver:${key}`, `time of ${key}`])],
    axis: Object.entries(AXES).map(([key, {title}]) => [key, title]),
    size: [...new Set(DATA.latency.map((row) => String(row.size)))].sort((a, b) => (a === "all" ? -1 : b === "all" ? 1 : a - b))
      .map((size) => [size, size === "all" ? "all sizes" : `${size} rows`]),
    scene: [...new Set(DATA.motion.map((curve) => `${curve.scene}@${curve.level}`))].map((scene) => [scene, scene.replace("@", ", level ")]),
  };
  if (CLASSES.length) [view.low, view.high] = [CLASSES[0].low, CLASSES[CLASSES.length - 1].high];
  for (const select of document.querySelectorAll("select[data-choice]")) {
    select.replaceChildren(...entries[select.dataset.choice].map(([value, text]) => new Option(text, value)));
    select.addEventListener("change", () => setChoice(select.dataset.choice, select.value));
  }
}

function chipOf(solver) {
  const chip = document.createElement("button");
  chip.type = "button";
  chip.className = "chip";
  chip.dataset.solver = solver.key;
  chip.title = solver.method;
  chip.setAttribute("aria-pressed", view.shown.includes(solver.key));
  chip.append(symbolOf(solver), solver.key);
  chip.addEventListener("click", () => {
    view.shown = view.shown.includes(solver.key) ? view.shown.filter((key) => key !== solver.key) : [...view.shown, solver.key];
    changed();
  });
  return chip;
}

function fillChips() {
  document.getElementById("chips").replaceChildren(...SOLVERS.map(chipOf));
  const presets = {start: ({shown}) => shown, own: ({origin}) => origin === "own", peer: ({origin}) => origin !== "own",
                   all: () => true, none: () => false};
  for (const button of document.querySelectorAll("[data-preset]")) {
    button.addEventListener("click", () => {
      view.shown = SOLVERS.filter(presets[button.dataset.preset]).map(({key}) => key);
      changed();
    });
  }
}

function watch() {
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      inSight[entry.isIntersecting ? "add" : "delete"](entry.target.id.slice("figure-".length));
    }
    drawDirty();
  }, {rootMargin: "400px"});
  for (const place of document.querySelectorAll(".chart")) seen.observe(place);
  const links = [...document.querySelectorAll("nav a")];
  const here = new IntersectionObserver((entries) => {
    for (const {target} of entries.filter(({isIntersecting}) => isIntersecting)) {
      for (const link of links) link.classList.toggle("here", link.hash === `#${target.id}`);
    }
  }, {rootMargin: "-20% 0px -70% 0px"});
  for (const section of document.querySelectorAll("main section[id]")) here.observe(section);
  let width = window.innerWidth;
  window.addEventListener("resize", () => {
    if ((width < 700) !== narrow()) changed();
    width = window.innerWidth;
  });
}

// For tests, printing and pictures: draws everything at once, a promise of the figures' ids.
window.lcpbench = {
  view, setChoice, figures: FIGURES,
  drawAll: async () => {
    await Promise.all(Object.keys(FIGURES).map(draw));
    return Object.keys(FIGURES).filter((id) => document.getElementById(`figure-${id}`));
  },
};
window.addEventListener("beforeprint", () => window.lcpbench.drawAll());

fillControls();
fillChips();
watch();
changed();
