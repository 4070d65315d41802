"use strict";
// Shows the charts that Python has described, each in the view that was chosen, when it comes into sight.

const CHARTS = JSON.parse(document.getElementById("data").textContent);
const CONFIG = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
                toImageButtonOptions: {format: "svg", filename: "lcpbench"}};
const INK = "#1c2430";
const LOOK = {
  font: {family: "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', Arial, sans-serif", size: 12, color: INK},
  paper_bgcolor: "#fff", plot_bgcolor: "#fff", hovermode: "closest", margin: {l: 16, r: 16, t: 34, b: 16}, bargap: 0.25,
  hoverlabel: {align: "left", bgcolor: "#fff", bordercolor: "#5a6573", font: {color: INK}}, autosize: true,
};
const PLACES = [...document.querySelectorAll(".chart")];

/** @returns a promise of the figure */
function draw(place) {
  const name = place.id.slice("figure-".length);
  const chosen = [...place.parentNode.querySelectorAll("select")].map(({value}) => value).join("\n");
  const view = CHARTS[name][chosen];
  place.hidden = !view;
  document.getElementById(`note-${name}`).textContent = view ? "" : "Nothing that fits is in these results.";
  if (!view) return null;
  place.style.height = `${view.layout.height}px`;
  // A phone shows the bar of buttons only where it is touched, over the plot.
  return Plotly.react(place, view.data, {...LOOK, ...view.layout}, {...CONFIG, displayModeBar: window.innerWidth < 700 ? false : "hover"});
}

const drawAll = () => Promise.all(PLACES.map(draw)).then(() => PLACES.map(({id}) => id));

const inSight = new IntersectionObserver((entries) => {
  for (const {target, isIntersecting} of entries) {
    if (isIntersecting && !target.data && !target.hidden) draw(target);
  }
}, {rootMargin: "400px"});
for (const place of PLACES) {
  inSight.observe(place);
  for (const select of place.parentNode.querySelectorAll("select")) select.addEventListener("change", () => draw(place));
}
window.addEventListener("beforeprint", drawAll);

const links = [...document.querySelectorAll("nav a")];
const here = new IntersectionObserver((entries) => {
  for (const {target} of entries.filter(({isIntersecting}) => isIntersecting)) {
    for (const link of links) link.classList.toggle("here", link.hash === `#${target.id}`);
  }
}, {rootMargin: "-20% 0px -70% 0px"});
for (const section of document.querySelectorAll("main section[id]")) here.observe(section);
