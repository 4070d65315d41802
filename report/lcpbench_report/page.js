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
if (tabs.length > 0) show(tabs[0].dataset.tab);
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
