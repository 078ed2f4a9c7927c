// The canvas of a live scene: it draws what the kernel sends, and tells the kernel what pointer and keys do.
// player.js stands above this text: scales and the look of the bar are those of the films.
//
// A picture is one buffer of numbers of 4 bytes: HEAD, then x y q of each body, the same of pymunk's, and
// x y F_x F_y of each contact.
const HEAD = ["n", "t", "pace", "ms", "energy", "expected", "apart", "overlap", "held", "heldX", "heldY", "handX", "handY",
  "echo", "first", "last", "forces", "beside"];
const REACH = { mouse: 6, pen: 10, touch: 22 };          // so far from a body it is still grabbed [px]
const ACK = 6;                                           // the kernel hears of every so many pictures: a message costs it time
const ARROW = 26;                                        // length of the arrow of a mean body's weight [px]
const CROWD = 60;                                        // above so many, forces are short thin lines without heads, and outlines thin
const TRACE = 900;                                       // pictures of the curves
const BACK = 1 / 30;                                     // by which one press of the comma goes back [s]
const SPEEDS = [[0.1, "⅒"], [0.25, "¼"], [0.5, "½"], [1, "1"], [2, "2"]];
const reduced = matchMedia("(prefers-reduced-motion: reduce)");
const { nice, metres } = globalThis.filmPlayer;

const add = (parent, tag, more = {}) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(more)) name in element ? element[name] = value : element.setAttribute(name, value);
  parent.append(element);
  return element;
};
const short = x => !Number.isFinite(x) ? "–" : Math.abs(x) >= 1e4 || (x && Math.abs(x) < 1e-2) ? x.toExponential(1) : `${+x.toPrecision(3)}`;
const length = x => x >= 1 ? `${x.toFixed(2)} m` : x >= 0.01 ? `${(100 * x).toFixed(1)} cm` : `${(1000 * x).toFixed(2)} mm`;

function fit(canvas, pen) {
  const ratio = window.devicePixelRatio || 1, w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
}

// Distance from a point to a segment.
function away([x, y], [ax, ay], [bx, by]) {
  const dx = bx - ax, dy = by - ay, l = dx * dx + dy * dy, s = l ? Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / l)) : 0;
  return Math.hypot(x - ax - s * dx, y - ay - s * dy);
}
// Distance from an outline, in coordinates of its body; below zero inside.
function outside({ points, closed, round }, at) {
  if (round) return Math.hypot(...at) - round;
  let nearest = points.length === 1 ? away(at, points[0], points[0]) : Infinity, inside = false;
  for (let i = 0; i + (closed ? 0 : 1) < points.length; i++) {
    const a = points[i], b = points[(i + 1) % points.length];
    nearest = Math.min(nearest, away(at, a, b));
    if (closed && (a[1] > at[1]) !== (b[1] > at[1]) && at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1])) inside = !inside;
  }
  return inside ? -nearest : nearest;
}

// ---- the parts below the canvas
function parts(el, scene, tell) {
  const root = add(el, "div", { className: "live-scene" });
  root.setAttribute("onkeydown", scene.keep);            // as around every film
  const stage = add(root, "canvas", { className: "stage", tabIndex: 0 });
  stage.setAttribute("role", "application");
  stage.setAttribute("aria-label", `${scene.name || "Live scene"}: ${scene.bodies.length} bodies. Space plays and pauses, full stop makes one step, comma goes back, R resets, N takes the next body, arrow keys pull it, Escape lets it go, C shows contact forces.`);
  const say = add(root, "div", { className: "say" });
  say.setAttribute("role", "status");
  const bar = add(root, "div", { className: "film-bar" });
  bar.setAttribute("role", "group");
  bar.setAttribute("aria-label", "Controls of the live scene");
  const button = (text, name, does) => add(bar, "button", { type: "button", textContent: text, title: name, ariaLabel: name, onclick: does });
  const play = button("▶", "Play (space)", () => tell({ do: play.dataset.on ? "pause" : "play" }));
  button("▶❙", "One step (full stop)", () => tell({ do: "step" }));
  button("⟲", "Reset (R)", () => tell({ do: "reset" }));
  const time = add(bar, "input", { type: "range", min: 0, max: 0, step: "any", value: 0, ariaLabel: "Time: the last thirty seconds" });
  time.oninput = () => tell({ do: "seek", to: +time.value });
  const clock = add(bar, "output", { textContent: "t = 0.00 s" });
  const speed = add(add(bar, "label", { textContent: "speed" }), "select", { ariaLabel: "Speed" });
  for (const [value, text] of SPEEDS) add(speed, "option", { value, textContent: `${text}×`, selected: value === 1 });
  speed.onchange = () => tell({ do: "set", to: { speed: +speed.value } });
  const box = (text, on, change) => {
    const label = add(bar, "label"), input = add(label, "input", { type: "checkbox", checked: on });
    label.append(text);
    input.onchange = () => change(input.checked);
    return input;
  };
  const look = { forces: null, beside: null };
  look.forces = box("contact forces", true, () => root.dispatchEvent(new Event("look")));
  look.beside = box(scene.rival, !!scene.beside, on => tell({ do: "beside", on }));
  add(look.beside.parentNode, "i");
  look.forces.parentNode.hidden = !scene.contacts; look.beside.parentNode.hidden = !scene.engine;
  button("film", "Save the last thirty seconds as a page that any browser plays", () => tell({ do: "film" }));
  const knobs = add(root, "div", { className: "knobs" });
  for (const { name, key, low, high, step, value, unit, inverse } of scene.knobs) {
    const label = add(knobs, "label"), shown = x => inverse ? `1/${Math.round(x)} s` : `${short(x)} ${unit}`.trim();
    add(label, "span", { textContent: name });
    const input = add(label, "input", { type: "range", min: low, max: high, step, value: value ?? low, ariaLabel: name });
    const output = add(label, "output", { textContent: value === null ? "mixed" : shown(value) });
    input.oninput = () => { output.textContent = shown(+input.value); tell({ do: "set", to: { [key]: inverse ? 1 / input.value : +input.value } }); };
  }
  const keys = add(root, "div", { className: "keys" }), trace = add(root, "canvas", { className: "trace" });
  trace.setAttribute("role", "img");
  trace.setAttribute("aria-label", `${scene.says.energy}${scene.engine ? `, and distance from ${scene.rival},` : ""} against time`);
  const numbers = {};
  for (const name of ["energy", "expected", "apart", "overlap", "pace"]) numbers[name] = add(keys, "span", { className: name });
  const printed = add(root, "pre", { hidden: true });
  return { root, stage, say, play, time, clock, speed, look, trace, numbers, printed };
}

function render({ model, el }) {
  const scene = model.get("scene"), { bodies } = scene, n = bodies.length, free = bodies.map(body => !body.fixed), takes = bodies.map(body => body.moves);
  const tell = message => model.send(message), ui = parts(el, scene, tell), { root, stage, say, trace } = ui;
  const size = bodies.reduce((sum, { points, round }) => sum + (round || Math.max(0, ...points.map(p => Math.hypot(...p)))), 0) / Math.max(1, free.filter(Boolean).length);
  let frame = null, head = {}, playing = false, wanted = false, history = [], told = 0, frames = 0, since = performance.now(), fps = 0;
  let view = [...scene.view], scale = 1, left = 0, colours = {}, held = null, moved = null, byKey = -1, target = null, unseen = false, number = 0;
  const sentAt = new Map();

  // ---- what the kernel says
  const heard = (message, buffers) => {
    if (message.kind === "frame") {
      const bytes = buffers[0];
      frame = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
      HEAD.forEach((name, i) => { head[name] = frame[i]; });
      if (head.n % ACK === 0) tell({ do: "ack", n: head.n });
      while (history.length && history.at(-1)[0] > head.last + 1e-4) history.pop();
      if (!history.length || head.t > history.at(-1)[0]) history.push([head.t, head.energy, head.expected, head.apart, ...scene.trail < 0 ? [] : pose(0, scene.trail)]);
      if (history.length > TRACE) history.shift();
      if (head.last < 1e-4) view = [...scene.view];
      frames++;
    } else if (message.kind === "status") {
      playing = message.playing;
      say.textContent = message.say;
      say.className = `say ${message.tone}`;
      ui.play.textContent = playing ? "❚❚" : "▶";
      ui.play.title = ui.play.ariaLabel = playing ? "Pause (space)" : "Play (space)";
      playing ? ui.play.dataset.on = "1" : delete ui.play.dataset.on;
    } else if (message.kind === "printed") {
      ui.printed.hidden = false;
      ui.printed.textContent = (ui.printed.textContent + message.text).slice(-2000);
      ui.printed.scrollTop = 1e9;
    } else if (message.kind === "film") {
      const link = document.createElement("a"), url = URL.createObjectURL(new Blob([message.page], { type: "text/html" }));
      link.href = url; link.download = "film.html"; link.click();
      setTimeout(() => URL.revokeObjectURL(url), 10000);
    }
    ask();
  };
  model.on("msg:custom", heard);

  // ---- places
  const measure = () => {
    const [x0, x1, y0, y1] = scene.view, wide = stage.clientWidth;
    const tall = Math.round(Math.max(170, Math.min(scene.height, wide * (y1 - y0) / (x1 - x0))));
    if (stage.style.height !== `${tall}px`) stage.style.height = `${tall}px`;
    if (frame) for (let k = 0; k < n; k++) if (free[k]) {                // what is thrown out of the picture is followed, up to twice its size
      const [x, y] = pose(0, k), w = x1 - x0, h = y1 - y0;
      view = [Math.max(x0 - w / 2, Math.min(view[0], x - 0.03 * w)), Math.min(x1 + w / 2, Math.max(view[1], x + 0.03 * w)),
        Math.max(y0 - h / 2, Math.min(view[2], y - 0.03 * h)), Math.min(y1 + h / 2, Math.max(view[3], y + 0.03 * h))];
    }
    scale = Math.min(wide / (view[1] - view[0]), tall / (view[3] - view[2]));
    left = (wide - scale * (view[1] - view[0])) / 2;
  };
  const sx = x => left + scale * (x - view[0]), sy = y => stage.clientHeight - scale * (y - view[2]);
  const world = event => {
    const r = stage.getBoundingClientRect();
    return [(event.clientX - r.left - left) / scale + view[0], (stage.clientHeight - (event.clientY - r.top)) / scale + view[2]];
  };
  const pose = (which, k) => { const i = HEAD.length + 3 * (which * n + k); return [frame[i], frame[i + 1], frame[i + 2]]; };
  const local = (k, [px, py]) => {
    const [x, y, q] = pose(0, k), c = Math.cos(q), s = Math.sin(q);
    return [c * (px - x) + s * (py - y), c * (py - y) - s * (px - x)];
  };
  const there = (which, k, [u, w]) => {
    if (k < 0) return [u, w];
    const [x, y, q] = pose(which, k), c = Math.cos(q), s = Math.sin(q);
    return [x + c * u - s * w, y + s * u + c * w];
  };
  const pick = (at, reach) => {
    let best = -1, nearest = reach / scale;
    for (let k = 0; k < n; k++) if (takes[k]) {
      const far = outside(bodies[k], local(k, at));
      if (far < nearest) { nearest = far; best = k; }
    }
    return best;
  };

  // ---- hand
  const stamp = () => { sentAt.set(++number, performance.now()); if (sentAt.size > 200) sentAt.delete(sentAt.keys().next().value); return number; };
  const grab = (k, at) => {
    tell({ do: "grab", body: k, place: local(k, k === scene.anywhere ? pose(0, k) : at), target: at, n: stamp() });
    if (!playing) tell({ do: "play" });
  };
  const release = () => { if (held !== null || byKey >= 0) tell({ do: "release" }); held = null; byKey = -1; stage.classList.remove("holds"); };
  const touched = event => {
    const k = frame ? pick(world(event), REACH[event.pointerType] ?? 10) : -1;
    return k < 0 && frame && event.pointerType !== "touch" ? scene.anywhere : k;             // a finger beside a body scrolls the page
  };
  stage.onpointerdown = event => {
    stage.focus({ preventScroll: true });
    const k = touched(event);
    if (event.button || held !== null || !(k >= 0)) return;
    event.preventDefault();
    try { stage.setPointerCapture(event.pointerId); } catch { /* a pointer of a test */ }
    held = event.pointerId; stage.classList.add("holds");
    grab(k, world(event));
  };
  // A finger on a body pulls the body; anywhere else it scrolls the page.
  const finger = event => { if (frame && pick(world(event.touches[0]), REACH.touch) >= 0) event.preventDefault(); };
  stage.addEventListener("touchstart", finger, { passive: false });
  stage.onpointermove = event => { if (event.pointerId === held) { moved = world(event); ask(); } };
  stage.onpointerup = stage.onpointercancel = stage.onlostpointercapture = event => { if (event.pointerId === held) release(); };
  stage.onblur = () => { if (byKey >= 0) release(); };
  const next = back => {
    if (!frame || !takes.includes(true)) return;
    do byKey = (byKey + (back ? n - 1 : 1) + n) % n; while (!takes[byKey]);
    target = pose(0, byKey).slice(0, 2);
    grab(byKey, target);
  };
  const pull = ([x, y]) => {
    const step = 0.02 * (scene.view[1] - scene.view[0]);
    target = [target[0] + step * x, target[1] + step * y];
    tell({ do: "move", target, n: stamp() });
  };
  const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  stage.onkeydown = event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase(), holds = held !== null || byKey >= 0;
    if (key === " ") tell({ do: playing ? "pause" : "play" });
    else if (key === ".") tell({ do: "step" });
    else if (key === "," && frame) tell({ do: "seek", to: head.t - BACK });
    else if (key === "r") tell({ do: "reset" });
    else if (key === "c") { ui.look.forces.checked = !ui.look.forces.checked; ask(); }
    else if (key === "n") next(event.shiftKey);
    else if (WAYS[event.key] && byKey >= 0) pull(WAYS[event.key]);
    else if (key === "escape" && holds) { release(); event.stopPropagation(); }
    else return;
    event.preventDefault();
  };

  // ---- drawing
  const pen = stage.getContext("2d"), line = trace.getContext("2d");
  const scheme = () => {                                 // before it is in the page it has no style
    const rgb = getComputedStyle(root).color.match(/[\d.]+/g)?.map(Number) ?? [0, 0, 0], dark = rgb[0] + rgb[1] + rgb[2] > 382;
    root.classList.toggle("dark", dark);
    for (const [name, colour] of Object.entries(scene.colours)) {
      colours[name] = dark ? scene.dark[colour.toLowerCase()] ?? colour : colour;
      root.style.setProperty(`--${name}`, colours[name]);
    }
    const style = getComputedStyle(root);
    colours.ink = style.color; colours.soft = style.getPropertyValue("--soft").trim();
  };
  const hatched = ([nx, ny, d]) => {
    const far = view[1] - view[0] + view[3] - view[2], mx = (view[0] + view[1]) / 2, my = (view[2] + view[3]) / 2, out = nx * mx + ny * my - d;
    const x = sx(mx - out * nx), y = sy(my - out * ny), steps = Math.ceil(far * scale / 8);
    pen.beginPath();
    pen.moveTo(x + 8 * steps * ny, y + 8 * steps * nx); pen.lineTo(x - 8 * steps * ny, y - 8 * steps * nx);
    pen.stroke();
    pen.globalAlpha = 0.5; pen.lineWidth = 1; pen.beginPath();
    for (let i = -steps; i <= steps; i++) {              // strokes as below the floors of the films
      const px = x + 8 * i * ny, py = y + 8 * i * nx;
      pen.moveTo(px, py); pen.lineTo(px - 6 * nx - 4 * ny, py + 6 * ny - 4 * nx);
    }
    pen.stroke(); pen.globalAlpha = 1; pen.lineWidth = 1.5;
  };
  const outline = (which, k) => {
    const { points, closed, round } = bodies[k];
    if (round) {
      const [x, y, q] = pose(which, k), r = scale * round;
      pen.moveTo(sx(x) + r, sy(y)); pen.arc(sx(x), sy(y), r, 0, 7);
      pen.moveTo(sx(x), sy(y)); pen.lineTo(sx(x) + r * Math.cos(q), sy(y) - r * Math.sin(q));
      return;
    }
    points.forEach((point, i) => { const [x, y] = there(which, k, point); pen[i ? "lineTo" : "moveTo"](sx(x), sy(y)); });
    if (closed) pen.closePath();
    if (points.length === 1) { const [x, y] = there(which, k, points[0]); pen.moveTo(sx(x) + 3, sy(y)); pen.arc(sx(x), sy(y), 3, 0, 7); }
  };
  const shapes = (which, wanted, colour, alpha) => {
    pen.beginPath();
    for (let k = 0; k < n; k++) if (wanted(k)) outline(which, k);
    pen.fillStyle = pen.strokeStyle = colour;
    if (alpha) { pen.globalAlpha = alpha; pen.fill(); pen.globalAlpha = 1; }
    pen.stroke();
  };
  const spring = (a, b) => {
    const dx = b[0] - a[0], dy = b[1] - a[1], l = Math.hypot(dx, dy) || 1;
    pen.moveTo(...a);
    for (let i = 1; i < 12; i++) { const w = l > 14 ? (i % 2 ? -4 : 4) : 0; pen.lineTo(a[0] + dx * i / 12 - w * dy / l, a[1] + dy * i / 12 + w * dx / l); }
    pen.lineTo(...b);
  };
  const trail = () => {
    if (scene.trail < 0) return;
    pen.strokeStyle = colours.ours; pen.globalAlpha = 0.4; pen.beginPath();
    for (const [t, , , , x, y] of history) if (t <= head.t) pen.lineTo(sx(x), sy(y));
    pen.stroke(); pen.globalAlpha = 1;
  };
  const linked = (which, colour) => {
    pen.strokeStyle = colour; pen.lineWidth = n > CROWD ? 1 : 2; pen.beginPath();
    for (const [a, b] of scene.links) { const [ax, ay] = pose(which, a), [bx, by] = pose(which, b); pen.moveTo(sx(ax), sy(ay)); pen.lineTo(sx(bx), sy(by)); }
    pen.stroke(); pen.lineWidth = 1.5;
  };
  const links = () => {
    pen.strokeStyle = pen.fillStyle = colours.ink; pen.lineWidth = 1; pen.beginPath();
    for (const [a, ax, ay, b, bx, by] of scene.springs) spring(...[[a, [ax, ay]], [b, [bx, by]]].map(([k, at]) => { const [x, y] = there(0, k, at); return [sx(x), sy(y)]; }));
    pen.stroke();
    linked(0, colours.ours);
    for (const [k, u, w] of scene.pins) { const [x, y] = there(0, k, [u, w]); pen.beginPath(); pen.arc(sx(x), sy(y), 3, 0, 7); pen.fill(); }
    pen.lineWidth = 1.5;
  };
  const forces = () => {
    const m = head.forces, crowd = m > CROWD, begin = frame.length - 4 * m, longest = crowd ? 1.5 * scale * size : 0.3 * stage.clientHeight;
    const unit = crowd ? Math.min(ARROW, scale * size) / 3 : ARROW;
    pen.strokeStyle = colours.force; pen.lineWidth = crowd ? 1 : 1.6; pen.globalAlpha = crowd ? 0.7 : 1; pen.beginPath();
    for (let k = 0; k < m; k++) {
      const [x, y, fx, fy] = frame.subarray(begin + 4 * k, begin + 4 * k + 4), force = Math.hypot(fx, fy), l = Math.min(longest, unit * force / scene.weight);
      if (l < 1.5) continue;
      const ux = fx / force, uy = -fy / force, bx = sx(x), by = sy(y), ex = bx + l * ux, ey = by + l * uy, h = Math.min(6, 0.4 * l);
      pen.moveTo(bx, by); pen.lineTo(ex, ey);
      if (!crowd) { pen.moveTo(ex - h * (ux - 0.5 * uy), ey - h * (uy + 0.5 * ux)); pen.lineTo(ex, ey); pen.lineTo(ex - h * (ux + 0.5 * uy), ey - h * (uy - 0.5 * ux)); }
    }
    pen.stroke(); pen.globalAlpha = 1; pen.lineWidth = 1.5;
  };
  const hand = () => {
    pen.strokeStyle = pen.fillStyle = colours.hand;
    pen.setLineDash([3, 3]); pen.beginPath(); pen.moveTo(sx(head.heldX), sy(head.heldY)); pen.lineTo(sx(head.handX), sy(head.handY)); pen.stroke(); pen.setLineDash([]);
    pen.beginPath(); pen.arc(sx(head.handX), sy(head.handY), 4, 0, 7); pen.fill();
  };
  const ruler = () => {
    const bar = nice(0.25 * stage.clientWidth / scale), x = stage.clientWidth - 10, y = 14;
    pen.strokeStyle = pen.fillStyle = colours.soft; pen.lineWidth = 1.2; pen.font = "12px system-ui, sans-serif"; pen.textAlign = "right";
    pen.beginPath();
    for (const [a, b] of [[[x - bar * scale, y], [x, y]], [[x - bar * scale, y - 4], [x - bar * scale, y + 4]], [[x, y - 4], [x, y + 4]]]) { pen.moveTo(...a); pen.lineTo(...b); }
    pen.stroke(); pen.fillText(metres(bar), x - bar * scale - 6, y + 4); pen.textAlign = "left";
  };
  const draw = () => {
    if (!colours.ours) scheme();
    measure(); fit(stage, pen);
    pen.lineWidth = 1.5; pen.strokeStyle = colours.soft;
    scene.planes.forEach(hatched);
    if (!frame) return;
    trail();
    shapes(0, k => !free[k] && bodies[k].points.length, colours.soft, 0.3);
    shapes(0, k => free[k] && k !== head.held, colours.ours, 0.22);
    if (head.held >= 0) shapes(0, k => k === head.held, colours.hand, 0.3);
    links();
    if (head.beside) {
      pen.setLineDash([4, 3]); if (n > CROWD) { pen.lineWidth = 0.8; pen.globalAlpha = 0.6; }
      shapes(1, k => free[k], colours.engine, 0); linked(1, colours.engine);
      pen.setLineDash([]); pen.lineWidth = 1.5; pen.globalAlpha = 1;
    }
    if (ui.look.forces.checked) forces();
    if (head.held >= 0) hand();
    ruler(); curves(); report();
  };
  const curves = () => {
    fit(trace, line);
    const w = trace.clientWidth, h = trace.clientHeight, last = history.length - 1;
    if (last < 1) return;
    let low = Infinity, high = -Infinity, far = 1e-9;
    for (const [, e, given, apart] of history) { low = Math.min(low, e, given); high = Math.max(high, e, given); far = Math.max(far, apart); }
    const span = Math.max(high - low, 1e-6 * Math.abs(high), 1e-12), t0 = history[0][0], whole = Math.max(history[last][0] - t0, 1e-9), at = t => 4 + (w - 8) * (t - t0) / whole;
    const curve = (value, colour, dashes) => {
      line.strokeStyle = colour; line.lineWidth = 1.5; line.setLineDash(dashes); line.beginPath();
      history.forEach((one, k) => line[k ? "lineTo" : "moveTo"](at(one[0]), h - 5 - (h - 10) * value(one)));
      line.stroke(); line.setLineDash([]);
    };
    curve(one => (one[2] - low) / span, colours.hand, []);
    curve(one => (one[1] - low) / span, colours.ours, []);
    if (head.beside) curve(one => one[3] / far, colours.engine, [4, 3]);
    if (head.t < head.last - 1e-4) { line.strokeStyle = colours.ink; line.lineWidth = 1; line.beginPath(); line.moveTo(at(head.t), 0); line.lineTo(at(head.t), h); line.stroke(); }
  };
  const report = () => {
    ui.clock.textContent = `t = ${head.t.toFixed(2)} s`;
    ui.time.min = head.first; ui.time.max = head.last;
    if (document.activeElement !== ui.time || playing) ui.time.value = head.t;
    Object.assign(root.dataset, { frame: head.n, t: head.t.toFixed(4), held: head.held, fps: fps.toFixed(1), energy: head.energy, apart: head.apart });
    const now = performance.now();
    if (playing && now - told < 250) return;             // numbers that change sixty times a second cannot be read
    told = now;
    const { energy, expected, apart, overlap, pace } = ui.numbers;
    energy.textContent = `${scene.says.energy} ${short(head.energy)} ${scene.says.unit}`;
    expected.textContent = `${scene.says.expected} ${short(head.expected)} ${scene.says.unit}`;
    apart.textContent = head.beside ? `farthest from ${scene.rival}: ${length(head.apart)}` : "";
    overlap.textContent = scene.says.overlap && `${scene.says.overlap} ${length(head.overlap)}`;
    pace.textContent = `${short(head.ms)} ms per step${playing && head.pace < 0.9 ? `; slow motion, ${short(head.pace * +ui.speed.value)} of real time` : ""}`;
  };
  const ask = () => { if (!wanted) { wanted = true; requestAnimationFrame(shown); } };
  const shown = now => {
    wanted = false;
    if (moved && held !== null) { tell({ do: "move", target: moved, n: stamp() }); moved = null; }
    if (sentAt.has(head.echo)) { (root.latencies ??= []).push(now - sentAt.get(head.echo)); sentAt.clear(); }
    if (root.latencies?.length > 500) root.latencies.shift();
    if (now - since > 1000) { fps = 1000 * frames / (now - since); frames = 0; since = now; }
    if (stage.clientWidth) draw();
  };

  // ---- size, colours, and whether it is seen
  const recolour = () => { scheme(); ask(); };
  const sizes = new ResizeObserver(ask), looks = new MutationObserver(recolour), dark = matchMedia("(prefers-color-scheme: dark)");
  const seen = new IntersectionObserver(found => {
    const now = found.at(-1).isIntersecting;
    if (now && unseen) tell({ do: "play" });
    unseen = !now && playing;
    if (unseen) tell({ do: "pause" });
  });
  sizes.observe(stage); seen.observe(stage); dark.addEventListener("change", recolour); root.addEventListener("look", ask);
  for (const element of [document.body, document.documentElement]) looks.observe(element, { attributes: true, attributeFilter: ["class", "data-theme", "data-jp-theme-light", "data-jp-theme-name"] });
  const pulse = setInterval(() => { if (!document.hidden && stage.isConnected) tell({ do: "here" }); }, 1000);
  root.where = k => { const [x, y] = pose(0, k); return [sx(x), sy(y)]; };      // for tests
  tell({ do: "hello", play: scene.play && !reduced.matches });
  return () => {
    release(); clearInterval(pulse); tell({ do: "gone" }); model.off("msg:custom", heard);
    sizes.disconnect(); seen.disconnect(); looks.disconnect(); dark.removeEventListener("change", recolour);
  };
}
export default { render };
