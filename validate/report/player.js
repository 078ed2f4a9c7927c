// A small player: <canvas data-film="scene"> plays self.films[scene], <canvas data-picture="id"> the JSON in #id.
// The player in 3D uses the same bar of controls.
(() => {
"use strict";
if (globalThis.filmPlayer) { globalThis.filmPlayer.start(); return; }            // a notebook has this script once per film
const reduced = matchMedia("(prefers-reduced-motion: reduce)"), dark = matchMedia("(prefers-color-scheme: dark)");
const SECONDS = { shortest: 4, longest: 14 };                     // of one showing
const MAGNIFIED = [1, 10, 100, 1000, 10000];

const style = document.createElement("style");
style.textContent = `
.film-bar { display: flex; flex-wrap: wrap; gap: .3rem .8rem; align-items: center; font: 13px/1.5 system-ui, sans-serif; margin: .35rem 0; max-width: 46rem; }
.film-bar input[type=range] { flex: 1 1 8rem; min-width: 6rem; } .film-bar output { font-variant-numeric: tabular-nums; min-width: 6.2rem; }
.film-bar button { min-width: 2.2rem; cursor: pointer; } .film-bar label { display: inline-flex; gap: .3rem; align-items: center; }
.film-bar small { flex-basis: 100%; opacity: .8; } .film-bar i { display: inline-block; width: .8rem; height: .8rem; border-radius: 50%; }`;
document.head.append(style);

// A colour of the page's scheme: dark.css has lighter ones for a dark page.
const shade = colour => getComputedStyle(document.documentElement).getPropertyValue(`--c${colour.toLowerCase().replace("#", "-")}`).trim() || colour;
const page = (name, otherwise) => getComputedStyle(document.documentElement).getPropertyValue(name).trim() || otherwise;

const add = (parent, tag, more = {}) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(more)) name in element ? element[name] = value : element.setAttribute(name, value);
  parent.append(element);
  return element;
};

// The bar below a film. runs: [{label, colour, shown}]; draw(frame, magnified) draws. The bar stops while the film is out of sight.
function controls(place, { last, seconds, runs, draw, reset, hint }) {
  const bar = document.createElement("div"), showing = Math.min(SECONDS.longest, Math.max(SECONDS.shortest, seconds));
  bar.className = "film-bar";
  bar.setAttribute("role", "group");
  bar.setAttribute("aria-label", "Controls of the moving picture");
  const state = { at: 0, playing: false, speed: 1, magnified: 1, seen: true, before: 0 };
  const show = () => draw(Math.round(state.at), state.magnified);
  if (last > 0) {
    const button = add(bar, "button", { type: "button" });
    const slider = add(bar, "input", { type: "range", min: 0, max: last, value: 0, ariaLabel: "Time" });
    const clock = add(bar, "output");
    const speed = add(add(bar, "label", { textContent: "speed" }), "select", { ariaLabel: "Speed" });
    for (const [value, text] of [[0.1, "⅒"], [0.25, "¼"], [0.5, "½"], [1, "1"], [2, "2"]]) add(speed, "option", { value, textContent: `${text}×`, selected: value === 1 });
    const told = () => {
      slider.value = Math.round(state.at);
      const time = `${(seconds * Math.round(state.at) / last).toFixed(2)} s`;
      clock.textContent = `t = ${time}`;
      slider.setAttribute("aria-valuetext", time);
      const pace = state.speed * seconds / showing;
      clock.title = pace > 1.05 ? `${pace.toPrecision(2)} times as fast as the motion` : pace < 0.95 ? `slowed down ${(1 / pace).toPrecision(2)} times` : "as fast as the motion";
    };
    const tick = now => {
      if (!state.playing || !place.isConnected) return;
      if (state.seen) {
        state.at = (state.at + Math.min(100, Math.max(0, now - state.before)) / 1000 / showing * state.speed * last) % (last + 1);
        if (state.at > last) state.at = 0;
        told(); show();
      }
      state.before = now;
      requestAnimationFrame(tick);
    };
    const play = on => {
      state.playing = on;
      button.textContent = on ? "❚❚" : "▶";
      button.setAttribute("aria-label", on ? "Pause" : "Play");
      state.before = performance.now();
      if (on) requestAnimationFrame(tick);
    };
    button.onclick = () => play(!state.playing);
    slider.oninput = () => { play(false); state.at = +slider.value; told(); show(); };
    speed.onchange = () => { state.speed = +speed.value; told(); };
    place.addEventListener("keydown", event => {
      if (event.target !== place && !place.contains(event.target)) return;
      if (event.key === " ") play(!state.playing);
      else if (event.key === "," || event.key === ".") { play(false); state.at = Math.min(last, Math.max(0, Math.round(state.at) + (event.key === "." ? 1 : -1))); told(); show(); }
      else return;
      event.preventDefault();
    });
    new IntersectionObserver(seen => { state.seen = seen.at(-1).isIntersecting; }).observe(place);
    state.at = reduced.matches ? last : 0;
    told();
    play(!reduced.matches);
    state.stop = () => play(false);
  }
  if (reset) add(bar, "button", { type: "button", textContent: "reset view", onclick: reset });
  if (runs.length > 1) for (const run of runs) {
    const label = add(bar, "label"), box = add(label, "input", { type: "checkbox", checked: true });
    const sign = add(label, "i");
    sign.style.background = shade(run.colour);
    if (MARKERS[run.marker]) { sign.style.clipPath = outline(run.marker); sign.style.borderRadius = 0; }
    label.append(run.label);
    box.onchange = () => { run.shown = box.checked; show(); };
  }
  if (runs.length > 1 && last > 0 && (runs[0].role || runs[0].look) === "truth") {
    const choice = add(add(bar, "label", { textContent: "difference from the truth" }), "select", { ariaLabel: "Magnify the difference from the truth" });
    for (const value of MAGNIFIED) add(choice, "option", { value, textContent: value === 1 ? "as it is" : `× ${value.toLocaleString("en")}` });
    choice.onchange = () => { state.magnified = +choice.value; show(); };
  }
  if (hint) add(bar, "small", { textContent: hint });
  place.after(bar);
  dark.addEventListener("change", show);
  show();
  return { show, stop: () => state.stop?.() };
}

// Markers of matplotlib: corners (x, y) of a shape of size 1, y down; "o" is a circle.
const turned = (n, begin, stretch = 1) => Array.from({ length: n }, (_, k) => [stretch * Math.sin(begin + 2 * Math.PI * k / n), -Math.cos(begin + 2 * Math.PI * k / n)]);
const MARKERS = {
  "^": turned(3, 0), ">": turned(3, Math.PI / 2), "v": turned(3, Math.PI), "<": turned(3, -Math.PI / 2), s: turned(4, Math.PI / 4), D: turned(4, 0), d: turned(4, 0, 0.6), h: turned(6, 0),
  P: [[-0.35, -1], [0.35, -1], [0.35, -0.35], [1, -0.35], [1, 0.35], [0.35, 0.35], [0.35, 1], [-0.35, 1], [-0.35, 0.35], [-1, 0.35], [-1, -0.35], [-0.35, -0.35]] };
function mark(pen, [x, y], radius, marker) {
  pen.beginPath();
  if (!MARKERS[marker]) { pen.arc(x, y, radius, 0, 7); return; }
  for (const [dx, dy] of MARKERS[marker]) pen.lineTo(x + 1.25 * radius * dx, y + 1.25 * radius * dy);
  pen.closePath();
}
const outline = marker => `polygon(${MARKERS[marker].map(([x, y]) => `${(50 + 50 * x).toFixed(1)}% ${(50 + 50 * y).toFixed(1)}%`).join(", ")})`;

const floats = text => new Float32Array(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);

// Frames of a run as one array of x, y, x, y, …: they come packed, or from a notebook as lists.
function unpacked(film) {
  const runs = film.films.map(run => {
    const points = run.points ?? run.frames[0].length;
    const numbers = typeof run.frames === "string" ? floats(run.frames) : Float64Array.from(run.frames.flat(2));
    return { ...run, points, numbers, frames: numbers.length / points / 2, shown: true };
  });
  return { ...film, runs, last: runs[0].frames - 1 };
}

// A round length that takes about a fifth of the width.
function nice(length) {
  const power = 10 ** Math.floor(Math.log10(length)), lead = length / power;
  return power * (lead < 2 ? 1 : lead < 5 ? 2 : 5);
}
const metres = x => x >= 1000 ? `${+(x / 1000).toPrecision(1)} km` : x >= 0.995 ? `${+x.toPrecision(1)} m` : x >= 0.00995 ? `${+(100 * x).toPrecision(1)} cm` : x >= 1e-5 ? `${+(1000 * x).toPrecision(1)} mm` : `${x.toExponential(0)} m`;

// Drawing of a film in the plane: returns draw(frame, magnified).
function drawer(canvas, film, small) {
  const { runs, links } = film, truth = runs[0].role === "truth" ? runs[0] : null, springy = (film.look || "rod") !== "rod";
  let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
  for (const { numbers } of runs) for (let i = 0; i < numbers.length; i += 2) {
    x0 = Math.min(x0, numbers[i]); x1 = Math.max(x1, numbers[i]); y0 = Math.min(y0, numbers[i + 1]); y1 = Math.max(y1, numbers[i + 1]);
  }
  const size = Math.max(x1 - x0, y1 - y0, 1e-9), pad = 0.1 * size;
  for (const grow of [0.25 * size - (y1 - y0)]) if (grow > 0) { y0 -= grow / 2; y1 += grow / 2; }
  for (const grow of [0.25 * size - (x1 - x0)]) if (grow > 0) { x0 -= grow / 2; x1 += grow / 2; }
  x0 -= pad; x1 += pad; y0 -= pad; y1 += pad;
  const first = runs[0], fixed = [];                               // points that never move: nails, walls and floors
  for (let p = 0; p < first.points; p++) {
    fixed[p] = film.last > 0;
    for (let k = 1; k <= film.last && fixed[p]; k++) for (const c of [0, 1])
      if (first.numbers[2 * (k * first.points + p) + c] !== first.numbers[2 * p + c]) fixed[p] = false;
  }
  const moving = fixed.some(f => !f) && film.last > 0;
  const mean = [0, 0], free = fixed.filter(f => !f).length * first.frames;      // of what moves: hatching is on the other side
  if (moving) for (let k = 0; k < first.frames; k++) for (let p = 0; p < first.points; p++)
    if (!fixed[p]) for (const c of [0, 1]) mean[c] += first.numbers[2 * (k * first.points + p) + c] / free;
  const pen = canvas.getContext("2d");

  return (k, magnified = 1) => {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const ink = page("--ink", "#1d2429"), soft = page("--soft", "#5b666e"), foot = small ? 0 : 26;
    const scale = Math.min(width / (x1 - x0), (height - foot) / (y1 - y0));
    const left = (width - scale * (x1 - x0)) / 2, bottom = (height - foot - scale * (y1 - y0)) / 2 + foot;
    const at = (run, frame, p) => {
      const f = Math.min(frame, run.frames - 1), i = 2 * (f * run.points + p);
      let x = run.numbers[i], y = run.numbers[i + 1];
      if (magnified > 1 && truth && run !== truth && run.points === truth.points) {
        const j = 2 * (Math.min(f, truth.frames - 1) * truth.points + p);
        x = truth.numbers[j] + magnified * (x - truth.numbers[j]); y = truth.numbers[j + 1] + magnified * (y - truth.numbers[j + 1]);
      }
      return [left + scale * (x - x0), height - bottom - scale * (y - y0)];
    };
    const line = (a, b) => { pen.moveTo(...a); pen.lineTo(...b); };
    const hatched = (a, b, side) => {
      const dx = b[0] - a[0], dy = b[1] - a[1], length = Math.hypot(dx, dy) || 1, n = Math.floor(length / 8);
      pen.beginPath(); line(a, b); pen.stroke();
      pen.save(); pen.globalAlpha *= 0.5; pen.lineWidth = 1; pen.beginPath();
      for (let i = 1; i <= n; i++) {
        const x = a[0] + dx * i / n, y = a[1] + dy * i / n;
        line([x, y], [x - 4 * dx / length - 6 * side * dy / length, y - 4 * dy / length + 6 * side * dx / length]);
      }
      pen.stroke(); pen.restore();
    };
    const spring = (a, b, shift) => {
      const dx = b[0] - a[0], dy = b[1] - a[1], length = Math.hypot(dx, dy) || 1, ux = dx / length, uy = dy / length;
      const wide = Math.min(5, 0.2 * length), go = (s, t) => pen.lineTo(a[0] + dx * s - uy * (t + shift), a[1] + dy * s + ux * (t + shift));
      pen.moveTo(...a); go(0.12, 0);
      if (length > 14) for (let i = 0; i < 10; i++) go(0.16 + 0.068 * (i + 0.5), (i % 2 ? -1 : 1) * wide);
      go(0.88, 0); pen.lineTo(...b);
    };
    const damper = (a, b, shift) => {
      const dx = b[0] - a[0], dy = b[1] - a[1], ux = dx / (Math.hypot(dx, dy) || 1), uy = dy / (Math.hypot(dx, dy) || 1);
      const spot = (s, t) => [a[0] + dx * s - uy * (t + shift), a[1] + dy * s + ux * (t + shift)];
      line(spot(0.1, 0), spot(0.4, 0)); pen.moveTo(...spot(0.65, -5)); for (const s of [spot(0.4, -5), spot(0.4, 5), spot(0.65, 5)]) pen.lineTo(...s);
      line(spot(0.55, -3.5), spot(0.55, 3.5)); line(spot(0.55, 0), spot(0.9, 0));
    };

    pen.strokeStyle = pen.fillStyle = ink; pen.lineWidth = small ? 1 : 1.5; pen.setLineDash([]); pen.globalAlpha = 0.8;
    if (moving) {
      links.forEach(([i, j]) => {
        if (!fixed[i] || !fixed[j]) return;
        const a = at(first, 0, i), b = at(first, 0, j), c = [left + scale * (mean[0] - x0), height - bottom - scale * (mean[1] - y0)];
        const side = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0 ? -1 : 1;
        small || Math.hypot(a[0] - b[0], a[1] - b[1]) < 24 ? (pen.beginPath(), line(a, b), pen.stroke()) : hatched(a, b, side);
      });
      fixed.forEach((still, p) => {
        if (!still || small || links.some(pair => pair.includes(p) && fixed[pair[0]] && fixed[pair[1]])) return;
        const a = at(first, 0, p), held = links.find(pair => pair.includes(p));
        if (springy && held && first.points < 5) {                 // the wall that a spring is fixed to
          const b = at(first, 0, held[0] === p ? held[1] : held[0]), length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
          const ux = (b[0] - a[0]) / length, uy = (b[1] - a[1]) / length;
          if (Math.abs(ux) > 0.98) return hatched([a[0] + uy * 26, a[1] - ux * 26], [a[0] - uy * 26, a[1] + ux * 26], 1);
        }
        pen.fillRect(a[0] - 4, a[1] - 4, 8, 8);
      });
    }
    runs.forEach(run => {
      if (!run.shown) return;
      const { role } = run;
      pen.strokeStyle = pen.fillStyle = shade(run.colour);
      pen.lineWidth = role === "truth" ? (small ? 3 : 6) : small ? 1.2 : 1.8;
      pen.setLineDash(role === "engine" ? [5, 4] : []);
      if (run.points <= 3 && film.last > 0) {                      // the way so far
        pen.globalAlpha = 0.4;
        for (let p = 0; p < run.points; p++) {
          if (fixed[p]) continue;
          pen.beginPath();
          for (let i = 0; i <= k; i++) { const a = at(run, i, p); i ? pen.lineTo(...a) : pen.moveTo(...a); }
          pen.stroke();
        }
      }
      pen.globalAlpha = role === "truth" ? 0.45 : 1;
      pen.beginPath();
      links.forEach(([i, j]) => {
        if (moving && fixed[i] && fixed[j]) return;
        const a = at(run, k, i), b = at(run, k, j), damped = film.look === "spring and damper";
        springy && role !== "truth" && !small ? spring(a, b, damped ? -8 : 0) : line(a, b);
        if (springy && damped && role !== "truth" && !small) damper(a, b, 8);
      });
      pen.stroke();
      pen.setLineDash([]);
      const radius = (small ? 2 : 4) * (run.points > 8 ? 0.6 : 1) * { truth: 1.9, engine: 1.3, ours: 0.9 }[role];
      for (let p = 0; p < run.points; p++) {
        if (moving && fixed[p]) continue;
        mark(pen, at(run, k, p), radius, run.marker);
        role === "engine" ? pen.stroke() : pen.fill();
      }
      pen.globalAlpha = 1;
    });
    if (small) return;
    pen.setLineDash([]); pen.lineWidth = 1.2; pen.strokeStyle = pen.fillStyle = soft; pen.font = "12px system-ui, sans-serif";
    const bar = nice(0.25 * width / scale), [px, py] = [width - 12, height - 10], names = film.axes || ["x", "y"];
    pen.beginPath(); line([px - bar * scale, py], [px, py]); line([px - bar * scale, py - 4], [px - bar * scale, py + 4]); line([px, py - 4], [px, py + 4]); pen.stroke();
    pen.textAlign = "right"; pen.fillText(metres(bar), px - bar * scale - 6, py + 4); pen.textAlign = "left";
    const o = [12, height - 10];
    pen.beginPath(); line(o, [o[0] + 26, o[1]]); line([o[0] + 22, o[1] - 3], [o[0] + 26, o[1]]); line([o[0] + 22, o[1] + 3], [o[0] + 26, o[1]]);
    line(o, [o[0], o[1] - 26]); line([o[0] - 3, o[1] - 22], [o[0], o[1] - 26]); line([o[0] + 3, o[1] - 22], [o[0], o[1] - 26]); pen.stroke();
    pen.fillText(names[0], o[0] + 30, o[1] + 3); pen.fillText(names[1], o[0] - 3, o[1] - 30);
    if (magnified > 1) pen.fillText(`differences × ${magnified.toLocaleString("en")}`, 12, 16);
  };
}

function play(canvas) {
  const text = canvas.dataset.picture && document.getElementById(canvas.dataset.picture);
  const given = text ? JSON.parse(text.textContent) : self.films?.[canvas.dataset.film];
  if (!given) return;
  const film = unpacked(given), bar = controls(canvas, { last: film.last, seconds: film.seconds, runs: film.runs, draw: drawer(canvas, film, false) });
  canvas.style.touchAction = "pan-y";
  canvas.tabIndex = film.last > 0 ? 0 : -1;
  new ResizeObserver(bar.show).observe(canvas);
}

// Play a film in a thumbnail; the function that is returned stops it.
function small(canvas, given) {
  const film = unpacked(given), draw = drawer(canvas, film, true), showing = Math.min(SECONDS.longest, Math.max(SECONDS.shortest, film.seconds));
  let on = true, began = performance.now();
  const tick = now => { if (on) { draw(Math.floor(Math.max(0, now - began) / 1000 / showing * film.last) % (film.last + 1)); requestAnimationFrame(tick); } };
  requestAnimationFrame(tick);
  return () => { on = false; };
}

const start = () => document.querySelectorAll("canvas[data-picture]:not([data-playing]), canvas.big[data-film]:not([data-playing])").forEach(canvas => {
  canvas.dataset.playing = "";
  play(canvas);
});
globalThis.filmPlayer = { controls, small, shade, page, floats, nice, metres, start };
// Until DOMContentLoaded the files of the films may not have come yet; a notebook is complete.
document.readyState === "complete" ? start() : addEventListener("DOMContentLoaded", start);
})();
