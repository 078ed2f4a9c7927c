// A small player in space: <div data-space="id"> plays the motion in <script id="id" type="application/json">, or that of
// self.films[id].  Its bar of controls is that of ../player.js, which is part of this file.
//
// {seconds, ground: bool, trail: number of a body or null, arrows: ["ω", "L", …],
//  bodies: [{kind: "box", size: [half, half, half]} | {kind: "sphere", r} | {kind: "cylinder" | "capsule", r, length} (along z)
//           | {kind: "cone", r, length} (tip in the origin) | {kind: "mesh", vertices: [[x, y, z], …], triangles: [[i, j, k], …]}],
//  walls: [[[x, y, z], [x, y, z]], …]: edges of what stands still,
//  runs: [{label, look: "truth" | "ours" | "engine", colour, frames: base64 of float32 (frame, body: x y z w qx qy qz; arrow: from, to)}]}
import "../player.js";
import {
  AmbientLight, ArrowHelper, BoxGeometry, BufferGeometry, CanvasTexture, CapsuleGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight,
  EdgesGeometry, Float32BufferAttribute, GridHelper, Group, Line, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, PerspectiveCamera,
  Quaternion, Scene, SphereGeometry, Sprite, SpriteMaterial, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const ARROWS = ["#e69f00", "#cc79a7", "#009e73"];                      // Okabe and Ito: told apart by everyone
const BRIGHT = { "--ink": "#1d2429", "--soft": "#5b666e", "--line": "#d5dadd" };            // colours of a page that does not say its own
const { controls: film_bar, floats, metres, nice, page } = globalThis.filmPlayer;

function shape(body) {
  if (body.kind === "box") return new BoxGeometry(...body.size.map(half => 2 * half));
  if (body.kind === "sphere") return new SphereGeometry(body.r, 24, 12);
  if (body.kind === "cylinder") return new CylinderGeometry(body.r, body.r, body.length, 32).rotateX(Math.PI / 2);
  if (body.kind === "capsule") return new CapsuleGeometry(body.r, body.length, 8, 24).rotateX(Math.PI / 2);
  if (body.kind === "cone") return new ConeGeometry(body.r, body.length, 32).rotateX(-Math.PI / 2).translate(0, 0, body.length / 2);
  const mesh = new BufferGeometry();
  mesh.setAttribute("position", new Float32BufferAttribute(body.vertices.flat(), 3));
  mesh.setIndex(body.triangles.flat());
  mesh.computeVertexNormals();
  return mesh;
}

function figure(body, run) {
  const group = new Group(), geometry = shape(body), ghost = run.look !== "ours";
  if (run.look !== "engine") {
    group.add(new Mesh(geometry, new MeshStandardMaterial({
      color: run.colour, transparent: ghost, opacity: ghost ? 0.3 : 1, roughness: 0.7, flatShading: body.kind === "mesh", depthWrite: !ghost })));
  }
  const edges = new EdgesGeometry(geometry, 20);
  const line = new LineBasicMaterial({ color: run.look === "engine" ? run.colour : "#1d2429" });
  if (run.look === "truth") line.name = "--ink";                     // a ghost is as dark or light as the page's letters
  group.add(new LineSegments(edges, line));
  if (body.kind === "sphere" || body.kind === "cylinder" || body.kind === "capsule") {      // a mark shows that it turns
    const reach = body.kind === "sphere" ? body.r : body.r * 1.001, z = body.kind === "sphere" ? 0 : (body.length || 0) / 2;
    const ring = [...Array(33)].map((_, i) => new Vector3(0, reach * Math.cos(i * Math.PI / 16), (z || reach) * Math.sin(i * Math.PI / 16)));
    group.add(new Line(new BufferGeometry().setFromPoints(ring), new LineBasicMaterial({ color: "#1d2429" })));
  }
  return group;
}

// A letter that always faces the reader.
function letter(text, size) {
  const canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
  canvas.width = canvas.height = 256;                              // four times what the screen shows, so that letters stay sharp
  pen.font = "600 176px system-ui, sans-serif"; pen.textAlign = "center"; pen.textBaseline = "middle"; pen.fillStyle = page("--ink", "#1d2429");
  pen.fillText(text, 128, 136);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false, transparent: true }));
  sprite.scale.setScalar(size);
  return sprite;
}

function play(place) {
  const text = document.getElementById(place.dataset.space);
  const picture = text?.type === "application/json" ? JSON.parse(text.textContent) : self.films?.[place.dataset.space]?.space;
  if (!picture) return;
  let renderer;
  try {
    renderer = new WebGLRenderer({ antialias: true });
  } catch {
    place.textContent = "This picture needs WebGL, which this browser does not have or has switched off.";
    return;
  }
  renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
  const view = renderer.domElement, note = document.createElement("div");
  note.style.cssText = "position:absolute;right:.6rem;bottom:.3rem;pointer-events:none;font:12px system-ui,sans-serif;color:var(--soft,#5b666e)";
  place.style.position = "relative";
  place.replaceChildren(view, note);

  const scene = new Scene(), camera = new PerspectiveCamera(35, 1, 0.001, 1e6);
  scene.background = new Color(page("--wash", "#f6f7f8"));
  scene.add(new AmbientLight("#ffffff", 1.6));
  const lamp = new DirectionalLight("#ffffff", 2.2);
  lamp.position.set(2, -3, 5);
  scene.add(lamp);
  const bodies = picture.bodies.length, arrows = picture.arrows.length, row = 7 * bodies + 6 * arrows;

  const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
  const runs = picture.runs.map(run => {
    const numbers = floats(run.frames), figures = picture.bodies.map(body => figure(body, run));
    figures.forEach(f => scene.add(f));
    const radii = figures.map(f => {
      const { geometry } = f.children[0];
      geometry.computeBoundingSphere();
      return geometry.boundingSphere.radius + geometry.boundingSphere.center.length();
    });
    const pointers = run.look === "engine" ? [] : picture.arrows.map((_, i) => {
      const arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, ARROWS[i]);
      scene.add(arrow);
      return arrow;
    });
    for (let at = 0; at < numbers.length; at += row) {
      for (let b = 0; b < bodies; b++) {
        const r = radii[b], c = new Vector3(...numbers.subarray(at + 7 * b, at + 7 * b + 3));
        low.min(c.clone().subScalar(r)); high.max(c.clone().addScalar(r));
      }
      for (let i = 0; i < arrows; i++) {
        const tip = new Vector3(...numbers.subarray(at + 7 * bodies + 6 * i + 3, at + 7 * bodies + 6 * i + 6));
        low.min(tip); high.max(tip);
      }
    }
    let trail = null;
    if (picture.trail !== null && picture.trail !== undefined) {
      trail = new Line(new BufferGeometry(), new LineBasicMaterial({ color: run.colour }));
      trail.frustumCulled = false;
      trail.geometry.setAttribute("position", new Float32BufferAttribute(
        Array.from({ length: numbers.length / row }, (_, k) => [...numbers.subarray(k * row + 7 * picture.trail, k * row + 7 * picture.trail + 3)]).flat(), 3));
      scene.add(trail);
    }
    return { label: run.label, colour: run.colour, look: run.look, shown: true, numbers, figures, pointers, trail, frames: numbers.length / row };
  });

  const walls = (picture.walls ?? []).flat().map(point => new Vector3(...point));
  if (walls.length) {
    const line = new LineBasicMaterial();
    line.name = "--soft";
    scene.add(new LineSegments(new BufferGeometry().setFromPoints(walls), line));
    walls.forEach(point => { low.min(point); high.max(point); });
  }
  const centre = low.clone().add(high).multiplyScalar(0.5), size = Math.max(high.clone().sub(low).length(), 1e-6);
  const corner = picture.ground ? new Vector3(low.x, low.y, 0) : low, reach = nice(0.3 * size);
  const directions = [["x", new Vector3(1, 0, 0)], ["y", new Vector3(0, 1, 0)], ["z", new Vector3(0, 0, 1)]];
  const ink = new LineBasicMaterial();
  ink.name = "--soft";
  scene.add(new LineSegments(new BufferGeometry().setFromPoints(
    directions.flatMap(([, along]) => [corner, corner.clone().addScaledVector(along, reach)])), ink));
  directions.forEach(([name, along]) => {
    const sign = letter(name, 0.07 * size);
    sign.position.copy(corner).addScaledVector(along, reach + 0.035 * size);
    scene.add(sign);
  });
  if (picture.ground) {
    const grid = new GridHelper(2 * size, 20).rotateX(Math.PI / 2);
    grid.position.set(centre.x, centre.y, 0);
    grid.material.vertexColors = false;
    grid.material.name = "--line";
    scene.add(grid);
  }
  camera.up.set(0, 0, 1);
  camera.near = size / 1000; camera.far = size * 100;
  const home = centre.clone().add(new Vector3(0.75, -1.2, 0.6).multiplyScalar((walls.length ? 1.15 : 0.95) * size)), controls = new OrbitControls(camera, view);
  camera.position.copy(home);
  controls.target.copy(centre);
  controls.update();
  controls.enableZoom = false;                                         // the wheel scrolls the page until a reader chooses the picture
  view.style.touchAction = "pan-y";                                    // and so does a finger that moves up or down
  view.tabIndex = 0;
  view.setAttribute("role", "img");
  view.setAttribute("aria-label", place.getAttribute("aria-label") || "A picture in 3D");
  place.removeAttribute("role"); place.removeAttribute("aria-label");
  view.addEventListener("focus", () => { controls.enableZoom = true; });
  view.addEventListener("blur", () => { controls.enableZoom = false; });
  view.addEventListener("pointerdown", () => view.focus({ preventScroll: true }));
  const turn = (right, up, nearer = 1) => {
    const arm = camera.position.clone().sub(controls.target).applyAxisAngle(new Vector3(0, 0, 1), right).multiplyScalar(nearer);
    const side = new Vector3().crossVectors(camera.up, arm).normalize(), tilted = arm.clone().applyAxisAngle(side, -up);
    const angle = tilted.angleTo(camera.up);
    camera.position.copy(controls.target).add(angle > 0.05 && angle < Math.PI - 0.05 ? tilted : arm);
    render();
  };
  const keys = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1], "+": [0, 0, 0.9], "-": [0, 0, 1 / 0.9] };
  view.addEventListener("keydown", event => {
    if (!keys[event.key]) return;
    turn(...keys[event.key]);
    event.preventDefault();
  });

  const from = new Vector3(), to = new Vector3(), truth = runs[0].look === "truth" ? runs[0] : null, turned = new Quaternion(), right = new Quaternion(), none = new Quaternion();
  const pose = (figure, { numbers, frames, look }, k, b, magnified) => {
    const at = Math.min(k, frames - 1) * row + 7 * b;
    figure.position.fromArray(numbers, at);
    figure.quaternion.set(numbers[at + 4], numbers[at + 5], numbers[at + 6], numbers[at + 3]);
    if (magnified === 1 || !truth || look === "truth") return;
    const there = Math.min(k, truth.frames - 1) * row + 7 * b;
    from.fromArray(truth.numbers, there);
    figure.position.sub(from).multiplyScalar(magnified).add(from);
    right.set(truth.numbers[there + 4], truth.numbers[there + 5], truth.numbers[there + 6], truth.numbers[there + 3]);
    turned.copy(figure.quaternion).multiply(right.clone().invert());   // the rotation from the truth to this run, its angle magnified
    if (turned.w < 0) turned.set(-turned.x, -turned.y, -turned.z, -turned.w);
    const half = Math.atan2(Math.hypot(turned.x, turned.y, turned.z), turned.w);
    if (half < 1e-9) return;
    from.set(turned.x, turned.y, turned.z).normalize();
    figure.quaternion.copy(none.setFromAxisAngle(from, Math.min(2 * half * magnified, Math.PI)).multiply(right));
  };
  const set = (k, magnified) => runs.forEach(run => {
    const { numbers, figures, pointers, trail, frames, shown } = run, at = Math.min(k, frames - 1) * row;
    figures.forEach((f, b) => { f.visible = shown; pose(f, run, k, b, magnified); });
    pointers.forEach((arrow, i) => {
      from.fromArray(numbers, at + 7 * bodies + 6 * i); to.fromArray(numbers, at + 7 * bodies + 6 * i + 3).sub(from);
      const length = to.length();
      arrow.visible = shown && length > 1e-9;
      if (arrow.visible) { arrow.position.copy(from); arrow.setDirection(to.normalize()); arrow.setLength(length, Math.min(0.25 * length, 0.06 * size), Math.min(0.12 * length, 0.03 * size)); }
    });
    if (trail) { trail.visible = shown; trail.geometry.setDrawRange(0, k + 1); }
  });
  const last = runs[0].frames - 1;
  note.textContent = `axes: ${metres(reach)}`;
  const render = () => { if (place.isConnected) renderer.render(scene, camera); };
  const bar = film_bar(place, {
    last, seconds: picture.seconds, runs, hint: "Drag or use the arrow keys to turn it. Click it, then the wheel or + and − bring it nearer.",
    draw: (k, magnified) => {
      scene.background.set(page("--wash", "#f6f7f8"));
      scene.traverse(({ material }) => { if (material?.name) material.color.set(page(material.name, BRIGHT[material.name])); });
      set(k, magnified);
      render();
    },
    reset: () => { camera.position.copy(home); controls.target.copy(centre); controls.update(); render(); },
  });
  controls.addEventListener("change", render);
  const fit = () => {
    if (!place.isConnected) { renderer.dispose(); renderer.forceContextLoss(); return; }      // a notebook's cell ran again
    const width = place.clientWidth || 640, height = place.clientHeight || 360;
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.fov = width < height ? 45 : 35;
    camera.updateProjectionMatrix();
    bar.show();
  };
  new ResizeObserver(fit).observe(place);
  fit();
}

const start = () => document.querySelectorAll("[data-space]:not([data-playing])").forEach(place => {
  place.dataset.playing = "";
  play(place);
});
document.readyState === "complete" ? start() : addEventListener("DOMContentLoaded", start);
