// What the pages do beside playing films: filter the table of scenes, play a thumbnail under the pointer, open folds.
(() => {
"use strict";
const filter = document.querySelector("form.filter");
if (filter) {
  const rows = [...document.querySelectorAll("tr.scene")], told = filter.querySelector("output");
  const apply = () => {
    const asked = new FormData(filter), words = asked.get("words").toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase(), lesson = row.parentElement.dataset.lesson;
      row.hidden = !(words.every(word => text.includes(word))
        && (!asked.get("lesson") || lesson === asked.get("lesson"))
        && (!asked.get("engine") || row.dataset.engine.split(" ").includes(asked.get("engine")))
        && (!asked.get("verdict") || row.dataset.verdict.split(" ").includes(asked.get("verdict"))));
      shown += !row.hidden;
    }
    document.querySelectorAll("tbody[data-lesson]").forEach(body => { body.hidden = !body.querySelector("tr.scene:not([hidden])"); });
    document.querySelector("table.scenes thead").hidden = !shown;
    told.textContent = !shown ? "No scene is like that." : shown === 1 ? "1 scene" : `${shown} scenes`;
    const query = new URLSearchParams([...asked].filter(([, value]) => value)).toString();
    try { history.replaceState(null, "", `${location.pathname}${query && "?"}${query}${location.hash}`); } catch { /* a browser may forbid it for a file */ }
  };
  for (const [name, value] of new URLSearchParams(location.search)) if (filter.elements[name]) filter.elements[name].value = value;
  filter.addEventListener("input", apply);
  filter.addEventListener("reset", () => setTimeout(apply));
  filter.addEventListener("submit", event => event.preventDefault());
  apply();                                                        // a browser may restore what was typed
}

const still = matchMedia("(prefers-reduced-motion: reduce)");
document.querySelectorAll("a.thumb[data-film]:not([data-still])").forEach(thumb => {
  let stop = null, wanted = false;
  const play = () => {
    if (!wanted || stop || still.matches) return;
    const canvas = document.createElement("canvas"), drawing = thumb.querySelector("svg");
    thumb.append(canvas);
    drawing.style.visibility = "hidden";
    const end = filmPlayer.small(canvas, self.films[thumb.dataset.film]);
    stop = () => { end(); canvas.remove(); drawing.style.visibility = ""; stop = null; };
  };
  const begin = () => {
    wanted = true;
    if (self.films?.[thumb.dataset.film]) play();
    else if (!thumb.dataset.asked) {
      thumb.dataset.asked = "";
      const script = document.createElement("script");
      script.src = `${thumb.dataset.film}-film.js`;
      script.onload = play;
      document.head.append(script);
    }
  };
  const end = () => { wanted = false; stop?.(); };
  for (const name of ["pointerenter", "focus"]) thumb.addEventListener(name, begin);
  for (const name of ["pointerleave", "blur"]) thumb.addEventListener(name, end);
});

const unfold = () => {
  const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (target) target.closest("article")?.querySelectorAll("details").forEach(fold => { fold.open = true; });
};
addEventListener("hashchange", unfold);
unfold();
let folded = [];
addEventListener("beforeprint", () => { folded = [...document.querySelectorAll("details:not([open])")]; folded.forEach(fold => { fold.open = true; }); });
addEventListener("afterprint", () => folded.forEach(fold => { fold.open = false; }));
})();
