// A small player: every <canvas data-picture="id"> plays the frames in <script id="id" type="application/json">.
(() => {
"use strict";
const reduced = matchMedia("(prefers-reduced-motion: reduce)").matches;

function play(canvas) {
  const picture = JSON.parse(document.getElementById(canvas.dataset.picture).textContent);
  const runs = picture.films;
  const all = runs.flatMap(run => run.frames.flat());
  const xs = all.map(p => p[0]), ys = all.map(p => p[1]);
  let [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const size = Math.max(x1 - x0, y1 - y0, 1e-9), pad = 0.08 * size;
  if (y1 - y0 < 0.25 * size) { const c = (y0 + y1) / 2; y0 = c - 0.125 * size; y1 = c + 0.125 * size; }
  if (x1 - x0 < 0.25 * size) { const c = (x0 + x1) / 2; x0 = c - 0.125 * size; x1 = c + 0.125 * size; }
  x0 -= pad; x1 += pad; y0 -= pad; y1 += pad;
  const ratio = window.devicePixelRatio || 1, small = canvas.dataset.small !== undefined;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * ratio; canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  const scale = Math.min(width / (x1 - x0), height / (y1 - y0));
  const left = (width - scale * (x1 - x0)) / 2, bottom = (height - scale * (y1 - y0)) / 2;
  const at = p => [left + scale * (p[0] - x0), height - bottom - scale * (p[1] - y0)];
  const last = runs[0].frames.length - 1, seconds = Math.min(12, Math.max(3, picture.seconds));

  function draw(time) {
    const k = reduced ? last : Math.floor(time / 1000 / seconds * last) % (last + 1);
    pen.clearRect(0, 0, width, height);
    runs.forEach(({role: kind, colour, frames}) => {
      const points = frames[Math.min(k, frames.length - 1)].map(at);
      pen.strokeStyle = pen.fillStyle = colour;
      pen.lineWidth = kind === "truth" ? (small ? 3 : 6) : 1.5;
      pen.setLineDash(kind === "engine" ? [4, 3] : []);
      const moving = points.length - 1;
      if (points.length <= 3) {                                   // the way so far
        pen.globalAlpha = 0.35;
        pen.beginPath();
        frames.slice(0, k + 1).forEach((f, i) => i ? pen.lineTo(...at(f[moving])) : pen.moveTo(...at(f[moving])));
        pen.stroke();
      }
      pen.globalAlpha = kind === "truth" ? 0.5 : 1;
      pen.beginPath();
      picture.links.forEach(([i, j]) => { pen.moveTo(...points[i]); pen.lineTo(...points[j]); });
      pen.stroke();
      const radius = (small ? 2 : 4) * (kind === "truth" ? 1.7 : 1) * (points.length > 8 ? 0.6 : 1);
      points.forEach(([x, y]) => {
        pen.beginPath(); pen.arc(x, y, radius, 0, 7);
        kind === "engine" ? pen.stroke() : pen.fill();
      });
      pen.globalAlpha = 1;
    });
    if (!small && last > 0) {
      pen.fillStyle = "#555"; pen.font = "12px system-ui, sans-serif";
      pen.fillText(`t = ${(picture.seconds * k / last).toFixed(2)} s`, 8, height - 8);
    }
    if (!reduced && last > 0) requestAnimationFrame(draw);
  }
  requestAnimationFrame(draw);
}

const start = () => document.querySelectorAll("canvas[data-picture]:not([data-playing])").forEach(canvas => {
  canvas.dataset.playing = "";
  play(canvas);
});
document.readyState === "loading" ? addEventListener("DOMContentLoaded", start) : start();
})();
