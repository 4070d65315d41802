// Tier tabs: choosing a tier anywhere chooses it everywhere. Without script every panel is shown.
document.documentElement.classList.add("js");
const tabs = [...document.querySelectorAll("[data-tab]")];
function show(tier) {
  for (const tab of tabs) tab.setAttribute("aria-pressed", String(tab.dataset.tab === tier));
  for (const panel of document.querySelectorAll("[data-panel]")) panel.hidden = panel.dataset.panel !== tier;
}
for (const tab of tabs) {
  tab.addEventListener("click", () => {
    const before = tab.getBoundingClientRect().top;
    show(tab.dataset.tab);
    window.scrollBy({ top: tab.getBoundingClientRect().top - before, behavior: "instant" });
  });
}
if (tabs.length > 0) show(document.body.dataset.firstTier);
// One family at a time; an address that names another one chooses it.
const families = [...document.querySelectorAll("[data-family-tab]")];
function showFamily(family) {
  for (const tab of families) tab.setAttribute("aria-pressed", String(tab.dataset.familyTab === family));
  for (const article of document.querySelectorAll("[data-family]")) article.hidden = article.dataset.family !== family;
}
for (const tab of families) tab.addEventListener("click", () => showFamily(tab.dataset.familyTab));
function showNamedFamily() {
  const named = families.find((tab) => location.hash === `#timing-${tab.dataset.familyTab}`);
  if (named) showFamily(named.dataset.familyTab);
}
if (families.length > 0) showFamily(families[0].dataset.familyTab);
showNamedFamily();
window.addEventListener("hashchange", showNamedFamily);
// Pointing at a solver's name lights its curve in every figure and dims the others.
function light(solver) {
  for (const lit of document.querySelectorAll(".lit")) lit.classList.remove("lit");
  document.body.classList.toggle("dim", Boolean(solver));
  if (solver) for (const line of document.querySelectorAll(`[id$="line--${solver}"]`)) line.classList.add("lit");
}
document.addEventListener("pointerover", (event) => {
  const name = event.target.closest?.("[data-solver]");
  light(name ? name.dataset.solver : "");
});
// Marks the section in view in the table of contents.
const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const seen = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (!entry.isIntersecting) continue;
    for (const [id, link] of links) link.classList.toggle("here", id === entry.target.id);
  }
}, { rootMargin: "-15% 0px -75% 0px" });
for (const id of links.keys()) {
  const section = document.getElementById(id);
  if (section) seen.observe(section);
}
