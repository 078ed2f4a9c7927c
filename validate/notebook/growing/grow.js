// Draws the scene that grows: one view, or two beside each other that share one clock; on a narrow page, one below the other.
// player.js stands above this text, and its bar serves here, too.
(() => {
"use strict";
const { controls, shade, page } = globalThis.filmPlayer;
const NARROW = 520, LABEL = 20;                          // width below which views stand below each other, height of a label [px]

// Places [m]: they come as whole millimetres of 16 bits.
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
const places = text => Float32Array.from(new Int16Array(bytes(text)), n => n / 1000);

function draw(canvas, film, k) {
  const ratio = devicePixelRatio || 1, pen = canvas.getContext("2d"), many = film.views.length;
  const stacked = canvas.clientWidth < NARROW, [left, right, low, high] = film.sides;
  const width = stacked ? canvas.clientWidth : canvas.clientWidth / many;
  const scale = width / (right - left), height = scale * (high - low) + LABEL;
  canvas.style.height = `${Math.round(stacked ? many * height : height)}px`;
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  film.views.forEach((view, n) => {
    const x0 = stacked ? 0 : n * width, y0 = stacked ? n * height : 0;
    pen.setTransform(ratio, 0, 0, ratio, ratio * x0, ratio * y0);
    pen.save();
    pen.beginPath(); pen.rect(0, 0, width, height); pen.clip();
    const line = points => {
      pen.beginPath();
      points.forEach(([x, y]) => pen.lineTo(scale * (x - left), height - scale * (y - low)));
      pen.stroke();
    };
    pen.lineCap = pen.lineJoin = "round";
    pen.strokeStyle = page("--soft", "#5b666e"); pen.globalAlpha = 0.55; pen.lineWidth = 2.5;
    film.walls.forEach(line);
    pen.globalAlpha = 1;
    [...film.rest, ...view.actors].forEach(actor => {
      const at = Math.min(k, actor.pictures - 1) * actor.points;
      const place = p => [actor.numbers[2 * (at + p)], actor.numbers[2 * (at + p) + 1]];
      pen.strokeStyle = actor.shown ? shade(view.colour) : page("--soft", "#5b666e");
      pen.lineWidth = actor.shown ? (actor.links.length > 60 ? 1.3 : 2.4) : 1;
      pen.globalAlpha = actor.shown ? 1 : 0.6;
      actor.links.forEach(link => line(link.map(place)));
    });
    pen.globalAlpha = 1;
    pen.fillStyle = shade(view.colour); pen.font = "600 13px system-ui, sans-serif";
    pen.fillText(view.label, 8, 15);
    pen.restore();
    if (!stacked && n) { pen.fillStyle = page("--soft", "#5b666e"); pen.fillRect(0, 0, 1, height); }
    if (stacked && n) { pen.fillStyle = page("--soft", "#5b666e"); pen.fillRect(0, 0, width, 1); }
  });
}

const start = () => document.querySelectorAll("canvas[data-growing]:not([data-playing])").forEach(canvas => {
  canvas.dataset.playing = "";
  const film = JSON.parse(document.getElementById(canvas.dataset.growing).textContent);
  for (const actor of [...film.rest, ...film.views.flatMap(view => view.actors)]) {
    actor.numbers = places(actor.frames);
    actor.points = 1 + Math.max(...actor.links.flat());
    actor.pictures = actor.numbers.length / actor.points / 2;
  }
  const last = Math.max(...film.views.flatMap(view => view.actors.map(actor => actor.pictures))) - 1;
  const bar = controls(canvas, { last, seconds: film.seconds, runs: [], draw: k => draw(canvas, film, k) });
  canvas.tabIndex = 0;
  new ResizeObserver(bar.show).observe(canvas);
});
// A page of the book loads this text once, above all but the first of its canvases.
document.readyState === "complete" ? start() : addEventListener("DOMContentLoaded", start);
})();
