// A small player in space: every <div data-space="id"> plays the motion in <script id="id" type="application/json">.
//
// {seconds, ground: bool, trail: number of a body or null, arrows: ["ω", "L", …],
//  bodies: [{kind: "box", size: [half, half, half]} | {kind: "sphere", r} | {kind: "cylinder" | "capsule", r, length} (along z)
//           | {kind: "cone", r, length} (tip in the origin) | {kind: "mesh", vertices: [[x, y, z], …], triangles: [[i, j, k], …]}],
//  runs: [{label, look: "truth" | "ours" | "engine", colour, frames: base64 of float32 (frame, body: x y z w qx qy qz; arrow: from, to)}]}
import {
  AmbientLight, ArrowHelper, BoxGeometry, BufferGeometry, CapsuleGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight, EdgesGeometry,
  Float32BufferAttribute, GridHelper, Group, Line, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, PerspectiveCamera, Scene,
  SphereGeometry, Vector3, WebGLRenderer, AxesHelper,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const ARROWS = ["#e69f00", "#cc79a7", "#009e73"];                      // Okabe and Ito: told apart by everyone
const SECONDS = { shortest: 4, longest: 14 };                          // of one showing

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
  group.add(new LineSegments(edges, new LineBasicMaterial({ color: run.look === "engine" ? run.colour : "#1d2429" })));
  if (body.kind === "sphere" || body.kind === "cylinder" || body.kind === "capsule") {      // a mark, or nobody sees it turn
    const reach = body.kind === "sphere" ? body.r : body.r * 1.001, z = body.kind === "sphere" ? 0 : (body.length || 0) / 2;
    const ring = [...Array(33)].map((_, i) => new Vector3(0, reach * Math.cos(i * Math.PI / 16), (z || reach) * Math.sin(i * Math.PI / 16)));
    group.add(new Line(new BufferGeometry().setFromPoints(ring), new LineBasicMaterial({ color: "#1d2429" })));
  }
  return group;
}

function floats(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function play(place) {
  const picture = JSON.parse(document.getElementById(place.dataset.space).textContent);
  const width = place.clientWidth || 640, height = place.clientHeight || 360;
  let renderer;
  try {
    renderer = new WebGLRenderer({ antialias: true });
  } catch {
    place.textContent = "This picture needs WebGL, which this browser does not have or has switched off.";
    return;
  }
  renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
  renderer.setSize(width, height);
  place.replaceChildren(renderer.domElement);
  const clock = document.createElement("div");
  clock.style.cssText = "font:12px system-ui,sans-serif;color:#555;margin-top:-1.5rem;padding-left:.5rem;height:1.5rem;position:relative";
  place.append(clock);

  const scene = new Scene(), camera = new PerspectiveCamera(35, width / height, 0.001, 1e6);
  scene.background = new Color("#f6f7f8");
  scene.add(new AmbientLight("#ffffff", 1.6));
  const lamp = new DirectionalLight("#ffffff", 2.2);
  lamp.position.set(2, -3, 5);
  scene.add(lamp);
  const bodies = picture.bodies.length, arrows = picture.arrows.length, row = 7 * bodies + 6 * arrows;

  const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
  const runs = picture.runs.map(run => {
    const numbers = floats(run.frames), figures = picture.bodies.map(body => figure(body, run));
    figures.forEach(f => scene.add(f));
    const pointers = run.look === "engine" ? [] : picture.arrows.map((_, i) => {
      const arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, ARROWS[i]);
      scene.add(arrow);
      return arrow;
    });
    for (let at = 0; at < numbers.length; at += row) {
      for (let b = 0; b < bodies; b++) {
        figures[b].children[0].geometry.computeBoundingSphere();
        const r = figures[b].children[0].geometry.boundingSphere.radius + figures[b].children[0].geometry.boundingSphere.center.length();
        const c = new Vector3(...numbers.subarray(at + 7 * b, at + 7 * b + 3));
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
    return { numbers, figures, pointers, trail, frames: numbers.length / row };
  });

  const centre = low.clone().add(high).multiplyScalar(0.5), size = Math.max(high.clone().sub(low).length(), 1e-6);
  const axes = new AxesHelper(0.3 * size);
  axes.position.copy(picture.ground ? new Vector3(low.x, low.y, 0) : low);
  scene.add(axes);
  if (picture.ground) {
    const grid = new GridHelper(2 * size, 20, "#9aa3a8", "#d5dadd").rotateX(Math.PI / 2);
    grid.position.set(centre.x, centre.y, 0);
    scene.add(grid);
  }
  camera.up.set(0, 0, 1);
  camera.near = size / 1000; camera.far = size * 100; camera.updateProjectionMatrix();
  camera.position.copy(centre).add(new Vector3(0.75, -1.2, 0.6).multiplyScalar(0.95 * size));
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.copy(centre);
  controls.enableDamping = true;
  controls.update();

  const from = new Vector3(), to = new Vector3();
  const set = k => runs.forEach(({ numbers, figures, pointers, trail, frames }) => {
    const at = Math.min(k, frames - 1) * row;
    figures.forEach((f, b) => {
      f.position.fromArray(numbers, at + 7 * b);
      f.quaternion.set(numbers[at + 7 * b + 4], numbers[at + 7 * b + 5], numbers[at + 7 * b + 6], numbers[at + 7 * b + 3]);
    });
    pointers.forEach((arrow, i) => {
      from.fromArray(numbers, at + 7 * bodies + 6 * i); to.fromArray(numbers, at + 7 * bodies + 6 * i + 3).sub(from);
      const length = to.length();
      arrow.visible = length > 1e-9;
      if (arrow.visible) { arrow.position.copy(from); arrow.setDirection(to.normalize()); arrow.setLength(length, Math.min(0.25 * length, 0.06 * size), Math.min(0.12 * length, 0.03 * size)); }
    });
    if (trail) trail.geometry.setDrawRange(0, k + 1);
  });
  const last = runs[0].frames - 1, showing = Math.min(SECONDS.longest, Math.max(SECONDS.shortest, picture.seconds));
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const draw = time => {
    if (!place.isConnected) { renderer.dispose(); renderer.forceContextLoss(); return; }
    const k = still ? last : Math.floor(time / 1000 / showing * last) % (last + 1);
    set(k);
    clock.textContent = (last > 0 ? `t = ${(picture.seconds * k / last).toFixed(2)} s · ` : "") + "drag to turn, scroll to come nearer";
    controls.update();
    renderer.render(scene, camera);
    requestAnimationFrame(draw);
  };
  requestAnimationFrame(draw);
}

const start = () => document.querySelectorAll("[data-space]:not([data-playing])").forEach(place => {
  place.dataset.playing = "";
  play(place);
});
document.readyState === "loading" ? addEventListener("DOMContentLoaded", start) : start();
