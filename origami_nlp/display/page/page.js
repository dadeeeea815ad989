// What moves on the interactive page.  All geometry comes from the data; nothing is folded or searched here: a step of
// the slider shows a stored state, and nothing is shown between two of them.  Opened as page.html#turning, in a frame
// of another page, it shows a state alone that turns until it is touched.
"use strict";
const DATA = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
const UPPER = 0xf3dfb4, LOWER = 0x9fb6c4, LOADED = 0xe69f00;
const CREASES = {mountain: {color: 0xc1121f, linewidth: 4.5}, valley: {color: 0x1d4ed8, linewidth: 4.5, dashed: true},
  "not folded": {color: 0x777777, linewidth: 1.5}};
const MOST_NUMBERED = 40;  // creases whose numbers can be read
const kindOf = phi => Math.abs(phi) < 1e-6 ? "not folded" : phi < 0 ? "mountain" : "valley";
const ALONE = location.hash === "#turning";
const SPEED = ALONE && !matchMedia("(prefers-reduced-motion: reduce)").matches ? 0.3 : 0;  // of turning by itself [rad/s]
const BY_KEY = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]};
const scene = {data: null, station: 0, track: -1, step: 0, key: null};

// ---------------------------------------------------------------- small vectors and words

const add = (a, b) => a.map((v, i) => v + b[i]);
const times = (a, s) => a.map(v => v * s);
const sub = (a, b) => a.map((v, i) => v - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = a => Math.hypot(...a);
const unit = a => times(a, 1 / Math.max(length(a), 1e-12));
const minus = text => String(text).replace(/^-/, "−");
const number = v => v === null ? "–" : minus(Number(v.toPrecision(6)));
const degrees = a => minus((a * 180 / Math.PI).toFixed(1).replace(/^-0\.0$/, "0.0"));

// ---------------------------------------------------------------- a folded body

const outline = (state, facet) => facet.map(k => state.corners[k]);

const normals = state => scene.data.body.facets.map(f => {
  const [a, b, c] = f.map(k => state.corners[k]);
  return unit(cross(sub(b, a), sub(c, a)));
});

const shift = (state, f) => state.shifts ? state.shifts[f] : [0, 0, 0];  // facets that lie on each other are drawn apart

function paperOf(state) {  // triangles of the facets, and their borders
  const triangles = [], borders = [];
  scene.data.body.facets.forEach((facet, f) => {
    const ring = outline(state, facet).map(p => add(p, shift(state, f)));
    for (let t = 1; t < ring.length - 1; t++) triangles.push(...ring[0], ...ring[t], ...ring[t + 1]);
    facet.forEach((corner, k) => {
      if (!scene.creased.has(`${corner} ${facet[(k + 1) % facet.length]}`)) borders.push(...ring[k], ...ring[(k + 1) % facet.length]);
    });
  });
  return {triangles, borders};
}

function creasesOf(state) {  // a crease on each of its facets, by kind, and where its number stands
  const kinds = {mountain: [], valley: [], "not folded": []}, numbers = [];
  state.angles.forEach((phi, n) => {
    const c = scene.data.body.creases[n], a = state.corners[c.start], b = state.corners[c.end], kind = kindOf(phi);
    const two = [shift(state, c.left), shift(state, c.right)];
    for (const s of length(sub(...two)) > 0 ? two : two.slice(1)) kinds[kind].push(...add(a, s), ...add(b, s));
    const middle = times(add(...two), 0.5), at = scene.round ? 1.1 : 0.5;
    const place = add(add(times(a, 1 - at), times(b, at)), middle);
    const same = numbers.find(e => length(sub(e.place, place)) < 0.04 * scene.reach);
    if (same) same.text += `, ${n + 1}`;
    else numbers.push({place, text: String(n + 1), dx: 0, dy: 0});
  });
  return {kinds, numbers: state.angles.length > MOST_NUMBERED ? [] : numbers};
}

// Contacts stand off the paper; their label is on the side that is seen first.
function marksOf(state, marks, towards, right) {
  const body = scene.data.body, normal = normals(state), places = [], labels = [], off = 0.03 * scene.reach;
  marks.forEach((mark, m) => {
    const found = [
      ...mark.creases.map(n => {
        const c = body.creases[n], t = 0.8 - 0.15 * (m % 4), half = state.angles[n] / 2;
        const a = state.corners[c.start], b = state.corners[c.end], axis = unit(sub(b, a));
        const out = add(times(normal[c.right], Math.cos(half)), times(cross(axis, normal[c.right]), Math.sin(half)));
        const at = add(add(times(a, 1 - t), times(b, t)), times(add(shift(state, c.right), shift(state, c.left)), 0.5));
        return [at, out];
      }),
      ...mark.facets.map(f => {
        const ring = outline(state, body.facets[f]);
        return [add(times(ring.reduce(add), 1 / ring.length), shift(state, f)), normal[f]];
      })];
    found.forEach(([at, out], n) => {
      const seen = dot(out, towards) >= 0 ? 1 : -1;
      for (const side of [seen, -seen])
        places.push({place: add(at, times(out, side * off)), loaded: mark.loaded});
      if (n) return;
      const place = add(at, times(out, seen * off));
      labels.push({place, text: mark.label, dx: dot(sub(at, scene.middle), right) >= 0 ? 42 : -42, dy: -24, mark: true});
    });
  });
  return {places, labels};
}

// ---------------------------------------------------------------- space

const space = {renderer: null, camera: null, controls: null, speed: SPEED, last: 0, world: new LIB.Scene(), body: null, labels: [],
  dirty: true, positions: []};

function openSpace() {
  const canvas = document.createElement("canvas");
  try {
    space.renderer = new LIB.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
  } catch {
    $("space").append("This browser has no WebGL: folded states cannot be shown in space.");
    return;
  }
  $("space").prepend(canvas);
  space.overlay = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  $("space").append(space.overlay);
  space.camera = new LIB.OrthographicCamera();
  // light from above left of the reader, weaker from all round: facets that are tilted differently differ in brightness
  const key = new LIB.DirectionalLight(0xffffff, 1.6), fill = new LIB.DirectionalLight(0xffffff, 0.5);
  key.position.set(-0.6, 0.9, 0.7);
  fill.position.set(1, -0.3, 0.5);
  space.camera.add(key, fill, key.target, fill.target);
  space.world.add(space.camera, new LIB.HemisphereLight(0xffffff, 0xe4e8ec, 2.0));
  space.controls = new LIB.TrackballControls(space.camera, canvas);
  Object.assign(space.controls, {rotateSpeed: 2.5, staticMoving: true});
  space.controls.addEventListener("change", () => { space.dirty = true; });
  new ResizeObserver(() => { fitSpace(); if (space.dirty) render(); }).observe($("space"));  // a new size empties the canvas
  Object.assign(canvas, {tabIndex: 0, role: "img", ariaLabel: "folded state; drag, or use the arrow keys, to turn it"});
  canvas.addEventListener("pointerdown", () => { space.speed = 0; });
  canvas.addEventListener("keydown", event => {
    if (!BY_KEY[event.key]) return;
    event.preventDefault();
    space.speed = 0;
    turnBy(...BY_KEY[event.key]);
  });
  (function turn(now = 0) {
    if (space.speed && scene.data) turnBy(space.speed * Math.min(now - space.last, 60) / 1000, 0);
    space.last = now;
    space.controls.update();
    if (space.dirty) render();
    requestAnimationFrame(turn);
  })();
}

function turnBy(round, over) {  // about what is upright, and about what points to the right [rad]
  const {camera, controls} = space, away = camera.position.clone().sub(controls.target);
  const right = camera.up.clone().cross(away).normalize();
  away.applyAxisAngle(camera.up, -round).applyAxisAngle(right, over);
  camera.up.applyAxisAngle(right, over);
  camera.position.copy(controls.target).add(away);
  camera.lookAt(controls.target);
  space.dirty = true;
}

function fitSpace() {
  if (!space.renderer || !scene.reach) return;
  const w = $("space").clientWidth, h = $("space").clientHeight, half = 1.12 * scene.reach * Math.max(1, h / w);
  Object.assign(space.camera, {left: -half * w / h, right: half * w / h, top: half, bottom: -half, near: 0,
    far: 12 * scene.reach});
  space.camera.updateProjectionMatrix();
  space.renderer.setPixelRatio(window.devicePixelRatio);
  space.renderer.setSize(w, h, false);
  space.controls.handleResize();
  space.dirty = true;
}

function lookFrom([right, up, towards]) {
  const {camera, controls} = space, eye = add(scene.middle, times(towards, 6 * scene.reach));
  const w = $("space").clientWidth, h = $("space").clientHeight;
  const far = axis => 1.18 * scene.shown.reduce((v, p) => Math.max(v, Math.abs(dot(sub(p, scene.middle), axis))), 1e-9);
  const half = Math.max(far(up), far(right) * h / w), whole = 1.12 * scene.reach * Math.max(1, h / w);
  camera.zoom = Math.min(whole / half, 1.8);
  camera.position.set(...eye);
  camera.up.set(...up);
  controls.target.set(...scene.middle);
  camera.lookAt(controls.target);
  fitSpace();
}

function segments(points, look) {
  const geometry = new LIB.LineSegmentsGeometry().setPositions(points);
  const dashes = {dashSize: 0.07 * scene.reach, gapSize: 0.05 * scene.reach};
  return new LIB.LineSegments2(geometry, new LIB.LineMaterial({...look, ...dashes})).computeLineDistances();
}

function drawSpace() {
  if (!space.renderer) return;
  const now = current(), fresh = scene.key !== now.key;
  if (fresh) {  // the box holds all that is shown under one key, so that a path does not jump about in it
    scene.key = now.key;
    const all = now.all.flatMap(s => s.corners);
    const ends = [Math.min, Math.max].map(end => [0, 1, 2].map(k => all.reduce((v, p) => end(v, p[k]), all[0][k])));
    scene.shown = all;
    scene.middle = times(add(...ends), 0.5);
    scene.reach = all.reduce((v, p) => Math.max(v, length(sub(p, scene.middle))), 1e-9);
    lookFrom(now.view);
  }
  if (space.body) {
    space.world.remove(space.body);
    space.body.traverse(part => { part.geometry?.dispose(); part.material?.dispose(); });
  }
  const body = space.body = new LIB.Group(), {triangles, borders} = paperOf(now.state);
  const geometry = new LIB.BufferGeometry();
  geometry.setAttribute("position", new LIB.Float32BufferAttribute(triangles, 3));
  geometry.computeVertexNormals();
  const behind = {polygonOffset: true, polygonOffsetFactor: 3, polygonOffsetUnits: 4};  // lines lie on the paper
  const paper = [[LIB.FrontSide, UPPER], [LIB.BackSide, LOWER]].map(([side, color]) =>
    new LIB.Mesh(geometry, new LIB.MeshLambertMaterial({side, color, ...behind})));
  body.add(...paper, segments(borders, {color: 0x333333, linewidth: 1.2}));
  const {kinds, numbers} = creasesOf(now.state);
  for (const [kind, points] of Object.entries(kinds)) {
    if (points.length) body.add(segments(points, CREASES[kind]));
  }
  const {places, labels} = marksOf(now.state, now.marks, now.view[2], now.view[0]);
  for (const mark of places) {
    const size = 0.026 * scene.reach;
    const shape = mark.loaded ? new LIB.OctahedronGeometry(1.3 * size) : new LIB.SphereGeometry(0.8 * size, 16, 12);
    const mesh = new LIB.Mesh(shape, new LIB.MeshLambertMaterial({color: mark.loaded ? LOADED : 0xffffff}));
    mesh.position.set(...mark.place);
    body.add(mesh);
  }
  space.world.add(body);
  Object.assign(space, {labels: [...$("numbers").checked ? numbers : [], ...labels], positions: triangles, dirty: true});
}

function render() {
  space.dirty = false;
  space.renderer.render(space.world, space.camera);
  const w = $("space").clientWidth, h = $("space").clientHeight, put = [], parts = [];
  const element = (name, attributes, text) => {
    const e = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
    if (text) e.textContent = text;
    return e;
  };
  for (const label of space.labels) {
    const p = new LIB.Vector3(...label.place).project(space.camera);
    const x = (p.x + 1) / 2 * w, y = (1 - p.y) / 2 * h, wide = 7.2 * label.text.length, anchor = label.dx > 0 ? "start" : label.dx < 0 ? "end" : "middle";
    const tx = x + label.dx;
    let ty = y + label.dy;
    const left = anchor === "start" ? tx : anchor === "end" ? tx - wide : tx - wide / 2, right = left + wide;
    const meets = () => put.some(r => Math.abs(r.y - ty) < 16 && left < r.right && r.left < right);
    for (let tries = 0; meets() && tries < (label.mark ? 40 : 3); tries++) ty += 16;  // the later one gives way downwards
    put.push({left, right, y: ty});
    if (label.mark) parts.push(element("line", {x1: x, y1: y, x2: tx, y2: ty - 4}));
    parts.push(element("text", {x: tx, y: ty + (label.mark ? 0 : 5), "text-anchor": anchor, class: label.mark ? "mark" : "number"}, label.text));
  }
  space.overlay.replaceChildren(...parts);
}

// ---------------------------------------------------------------- energies

const MARGIN = {marginLeft: 76, marginRight: 18, marginTop: 22, marginBottom: 40, style: {fontSize: "12px", overflow: "visible"}};
const AXIS = {labelAnchor: "center", labelArrow: "none", ticks: 6, tickFormat: v => minus(Number(v.toPrecision(6)))};

const sizeOf = () => Math.max(280, Math.min($("side").clientWidth || 600, 900));

function drawProfile() {
  $("profile").replaceChildren();
  if (scene.track < 0) return;
  const track = scene.data.tracks[scene.track], points = track.parameter.map((s, k) => [s, track.energy[k]]);
  const picture = LIB.plot({...MARGIN, width: sizeOf(), height: 240, grid: true, x: {...AXIS, label: track.label},
    y: {...AXIS, label: "energy [J]"}, marks: [
      LIB.line(points, {stroke: "#333", strokeWidth: 2}), LIB.dot(points, {r: 1.6, fill: "#333"}),
      LIB.dot([points[scene.step]], {r: 7, fill: "#e69f00", stroke: "#111", strokeWidth: 2})]});
  $("profile").append(picture);
}

// ---------------------------------------------------------------- what is chosen

function current() {
  if (scene.track >= 0) {
    const track = scene.data.tracks[scene.track], state = track.states[scene.step];
    return {state, view: track.view, marks: [], energy: track.energy[scene.step], all: track.states, key: `path ${scene.track}`};
  }
  const state = scene.data.stations[scene.station];
  return {state, view: state.view, marks: state.marks, energy: state.energy, all: [state], key: `state ${scene.station}`};
}

function fill(select, titles, chosen) {
  select.replaceChildren(...titles.map((title, n) => new Option(title, n, false, n === chosen)));
}

function draw() {
  const now = current(), track = scene.data.tracks[scene.track], onPath = scene.track >= 0;
  $("state").value = scene.station;
  $("path").value = scene.track + 1;
  $("step").disabled = !onPath;
  $("step").max = onPath ? track.states.length - 1 : 0;
  $("step").value = scene.step;
  let said = `energy ${number(now.energy)} J`;
  if (onPath) said += `; step ${scene.step + 1} of ${track.states.length}` +
    (track.of > track.states.length ? ` shown (${track.of} stored)` : "");
  $("where").textContent = said;
  const lines = onPath
    ? [`${scene.data.steps} Contacts are marked on chosen states only.`,
      `fold angles [deg]: ${now.state.angles.map(degrees).join(", ")}`]
    : now.state.lines;
  $("lines").replaceChildren(...lines.map(text => Object.assign(document.createElement("li"), {textContent: text})));
  document.querySelectorAll(".marked").forEach(e => { e.style.display = now.marks.length ? "" : "none"; });
  document.querySelector(".plots").classList.toggle("alone", !onPath);
  drawSpace(); drawProfile();
}

function chooseState(n) {
  const count = scene.data.stations.length;
  if (!count) return;
  Object.assign(scene, {station: (n + count) % count, track: -1, step: 0});
  draw();
}

function choosePath(n) {
  if (n < 0 && !scene.data.stations.length) n = 0;
  Object.assign(scene, {track: n, step: 0});
  if (n >= 0 && scene.data.tracks[n].start !== null) scene.station = scene.data.tracks[n].start;
  draw();
}

function openScene() {  // on its first path, where it has one
  const data = DATA, first = data.tracks.length && !ALONE ? 0 : -1;
  scene.round = data.body.creases.every(c => c.start === data.body.creases[0].start);  // about one vertex: numbers beyond
  scene.creased = new Set(data.body.creases.flatMap(c => [`${c.start} ${c.end}`, `${c.end} ${c.start}`]));
  Object.assign(scene, {data, station: first < 0 ? 0 : data.tracks[0].start ?? 0, track: first, step: 0, key: null});
  $("title").textContent = data.title;
  fill($("state"), data.stations.map(s => s.title), 0);
  fill($("path"), ["none: the state alone", ...data.tracks.map(t => t.title)], 0);
  document.querySelectorAll(".paths").forEach(e => { e.style.display = data.tracks.length ? "" : "none"; });
  $("numbers").checked = data.body.creases.length <= 12 && !ALONE;
  const some = data.stations.length + data.tracks.length > 0;
  document.querySelector(".plots").style.display = some ? "" : "none";
  if (some) draw();
  else $("where").textContent = "There is no state to show.";
}

$("state").onchange = event => chooseState(Number(event.target.value));
$("before").onclick = () => chooseState(scene.station - 1);
$("after").onclick = () => chooseState(scene.station + 1);
$("path").onchange = event => choosePath(Number(event.target.value) - 1);
$("step").oninput = event => { scene.step = Number(event.target.value); draw(); };
$("numbers").onchange = drawSpace;
$("upright").onclick = () => lookFrom(current().view);
window.onresize = () => { if (scene.data) drawProfile(); };  // it fits the width
document.body.classList.toggle("alone", ALONE);
openSpace();
openScene();
