// What moves on a page that can be turned.  All geometry comes from the data; nothing is folded or searched here:
// a step of the slider shows a stored state, and nothing is shown between two of them.
"use strict";
const DATA = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
const UPPER = "#f3dfb4", LOWER = "#9fb6c4", MOUNTAIN = "#c1121f", VALLEY = "#1d4ed8", FLAT = "#777777";
const COLOURS = {mountain: MOUNTAIN, valley: VALLEY, "not folded": FLAT};
const THICK = 0.004, ABOVE = 0.008;  // half the paper's thickness in the picture, and how high creases lie on it
const MOST_NUMBERED = 40;  // creases whose numbers can be read
const OFF = 0.05, DASH = 0.12;  // how far marks stand off the paper; length of a dash with its gap
const kindOf = phi => Math.abs(phi) < 1e-6 ? "not folded" : phi < 0 ? "mountain" : "valley";
const ARC = Math.PI / 24;
// dark (low) to pale (high): readable in grey, and to colour-blind readers
const SCALE = [[0, "#0b2559"], [0.25, "#24479d"], [0.5, "#1f7fb6"], [0.75, "#56bcc0"], [1, "#dff3c4"]];
const LOOKS = {
  contact: {color: "#1b1b1b", width: 1.5}, handle: {color: "#7b1fa2", width: 2.5, dash: "dash"},
  metastable: {color: "#e10000", width: 4}, curve: {color: "#0072b2", width: 2}};
const CONFIG = {displaylogo: false, responsive: true, displayModeBar: false};
const scene = {data: null, station: 0, track: -1, step: 0, playing: null};

// ---------------------------------------------------------------- small vectors

const add = (a, b) => a.map((v, i) => v + b[i]);
const times = (a, s) => a.map(v => v * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => times(a, 1 / Math.max(Math.hypot(...a), 1e-12));
const safe = text => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
const number = v => v === null ? "–" : Number(v.toPrecision(6)).toString().replace("-", "−");
const degrees = a => (a * 180 / Math.PI).toFixed(1).replace(/^-0\.0$/, "0.0").replace("-", "−");

// ---------------------------------------------------------------- a folded body

function outline(state, facet) {  // corners of a facet; a sector's far side is an arc about its first corner
  const p = facet.map(k => state.corners[k]);
  if (!scene.data.body.sectors) return p;
  const [o, a, b] = p, u = add(a, times(o, -1)), v = add(b, times(o, -1));
  const angle = Math.atan2(Math.hypot(...cross(u, v)), dot(u, v));
  const count = Math.max(1, Math.ceil(angle / ARC)), out = [o];
  for (let k = 0; k <= count; k++) {
    const t = k / count * angle;
    out.push(add(o, times(add(times(u, Math.sin(angle - t)), times(v, Math.sin(t))), 1 / Math.sin(angle))));
  }
  return out;
}

function normals(state) {
  return scene.data.body.facets.map(f => {
    const [a, b, c] = f.map(k => state.corners[k]);
    return unit(cross(add(b, times(a, -1)), add(c, times(a, -1))));
  });
}

const shift = (state, f) => state.shifts ? state.shifts[f] : [0, 0, 0];
const columns = points => ({x: points.map(p => p && p[0]), y: points.map(p => p && p[1]), z: points.map(p => p && p[2])});

function facetTraces(state, normal) {  // both sides of the paper, a little apart, so that each has its own colour
  const points = [], i = [], j = [], k = [], colour = [], edge = [];
  scene.data.body.facets.forEach((facet, f) => {
    const ring = outline(state, facet).map(p => add(p, shift(state, f)));
    for (const [side, paint] of [[THICK, UPPER], [-THICK, LOWER]]) {
      const first = points.length;
      points.push(...ring.map(p => add(p, times(normal[f], side))));
      for (let t = 1; t < ring.length - 1; t++) {
        i.push(first); j.push(first + t); k.push(first + t + 1); colour.push(paint);
      }
    }
    const border = scene.data.body.sectors ? ring.slice(1) : [...ring, ring[0]];
    for (const side of [1.1 * THICK, -1.1 * THICK]) edge.push(...border.map(p => add(p, times(normal[f], side))), null);
  });
  const light = {ambient: 0.95, diffuse: 0.3, specular: 0.02, roughness: 0.9, fresnel: 0};
  return [
    {type: "mesh3d", ...columns(points), i, j, k, facecolor: colour, hoverinfo: "skip", flatshading: true,
      lighting: light, lightposition: {x: 1000, y: -2000, z: 4000}},
    {type: "scatter3d", mode: "lines", ...columns(edge), line: {color: "#111111", width: 2}, hoverinfo: "skip"}];
}

// Labels lie over the picture: text in space would be cut by facets.
const label = ([x, y, z], text, size, more = {}) =>
  ({x, y, z, text, showarrow: false, font: {size, color: "#111111"}, ...more});

// A crease is a band on the facets beside it, on both sides of the paper: whole for mountains, dashed for valleys, thin
// where it is not folded.
function creaseTraces(state, normal) {
  const points = [], i = [], j = [], k = [], colour = [], texts = [], ends = [];
  state.angles.forEach((phi, n) => {
    const c = scene.data.body.creases[n], a = state.corners[c.start], b = state.corners[c.end];
    const axis = unit(add(b, times(a, -1))), length = Math.hypot(...add(b, times(a, -1)));
    const kind = kindOf(phi), share = Math.min(1, Math.abs(phi) / Math.PI);
    const wide = kind === "not folded" ? 0.008 : 0.02 + 0.015 * share, count = Math.max(2, Math.round(length / DASH));
    const dashes = kind === "valley" ? [...Array(count).keys()].map(d => [d / count, (d + 0.6) / count]) : [[0, 1]];
    for (const [f, way] of [[c.left, 1], [c.right, -1]]) for (const side of [ABOVE, -ABOVE]) {
      const base = add(shift(state, f), times(normal[f], side)), inward = times(cross(normal[f], axis), way * wide);
      for (const [from, to] of dashes) {
        const first = points.length;
        const [p, q] = [from, to].map(t => add(base, add(a, times(axis, t * length))));
        points.push(p, q, add(q, inward), add(p, inward));
        for (let t = 0; t < 4; t++) texts.push(`crease ${n + 1}: ${kind}, ${degrees(phi)}°`);
        i.push(first, first); j.push(first + 1, first + 2); k.push(first + 2, first + 3);
        colour.push(COLOURS[kind], COLOURS[kind]);
      }
    }
    const place = add(add(b, times(axis, 0.11)), times(add(shift(state, c.left), shift(state, c.right)), 0.5));
    const same = ends.find(e => Math.hypot(...add(e.place, times(place, -1))) < 0.09);
    if (same) same.text += `, ${n + 1}`;
    else ends.push({place, text: String(n + 1)});
  });
  const bands = [
    {type: "mesh3d", ...columns(points), i, j, k, facecolor: colour, text: texts, hoverinfo: "text", flatshading: true,
      lighting: {ambient: 1, diffuse: 0, specular: 0, fresnel: 0}}];
  return {bands, numbers: scene.data.body.creases.length > MOST_NUMBERED ? [] : ends.map(e => label(e.place, e.text, 14))};
}

// Marks stand off the paper on both sides; the label is on the side that is seen first.
function markTraces(state, normal, marks, towards) {
  const body = scene.data.body, found = {true: [], false: []}, labels = [];
  marks.forEach((mark, m) => {
    const places = [
      ...mark.creases.map(n => {
        const c = body.creases[n], t = 0.8 - 0.15 * (m % 4), f = c.right, half = state.angles[n] / 2;
        const a = state.corners[c.start], b = state.corners[c.end], axis = unit(add(b, times(a, -1)));
        const out = add(times(normal[f], Math.cos(half)), times(cross(axis, normal[f]), Math.sin(half)));
        return [add(add(times(a, 1 - t), times(b, t)), times(add(shift(state, f), shift(state, c.left)), 0.5)), out];
      }),
      ...mark.facets.map(f => {
        const ring = outline(state, body.facets[f]);
        return [add(times(ring.reduce(add), 1 / ring.length), shift(state, f)), normal[f]];
      })];
    places.forEach(([place, out], n) => {
      // what is fully folded has an outside only: above a mountain, below a valley
      const closed = n < mark.creases.length && Math.abs(state.angles[mark.creases[n]]) > 2;
      const seen = closed ? -Math.sign(state.angles[mark.creases[n]]) : dot(out, towards) >= 0 ? 1 : -1;
      for (const side of closed ? [seen] : [seen, -seen])
        found[mark.loaded].push({place: add(place, times(out, side * OFF)), text: safe(mark.text)});
      if (n) return;
      const right = dot(place, scene.right) >= 0 ? 1 : -1;
      labels.push(label(add(place, times(out, seen * OFF)), safe(mark.label), 12, {showarrow: true, arrowhead: 0,
        arrowwidth: 1, ax: right * 46, ay: -26 - 20 * m, bgcolor: "rgba(255,255,255,0.85)", borderpad: 1}));
    });
  });
  const diamonds = [true, false].map(loaded => ({type: "scatter3d", mode: "markers",
    ...columns(found[loaded].map(e => e.place)), hovertext: found[loaded].map(e => e.text), hoverinfo: "text",
    marker: {symbol: loaded ? "diamond" : "circle-open", size: 6, color: loaded ? "#e69f00" : "#333333",
      line: {color: "#111111", width: 1}}}));
  return {diamonds, labels};
}

// The box holds all that is shown under one key, so that a path does not jump about in it.
function box(states) {
  const all = states.flatMap(s => s.corners), low = [0, 1, 2].map(k => all.reduce((v, p) => Math.min(v, p[k]), Infinity));
  const high = [0, 1, 2].map(k => all.reduce((v, p) => Math.max(v, p[k]), -Infinity));
  const middle = times(add(low, high), 0.5);
  return {middle, reach: 1.2 * all.reduce((v, p) => Math.max(v, Math.hypot(...add(p, times(middle, -1)))), 1e-9)};
}

function drawSpace() {
  const now = current(), normal = normals(now.state), {middle, reach} = box(now.all), [right, up, towards] = now.view;
  scene.right = right;
  const axis = k => ({visible: false, range: [middle[k] - reach, middle[k] + reach], autorange: false});
  const vector = v => ({x: v[0], y: v[1], z: v[2]});
  const {bands, numbers} = creaseTraces(now.state, normal);
  const {diamonds, labels} = markTraces(now.state, normal, now.marks, towards);
  Plotly.react("space", [...facetTraces(now.state, normal), ...bands, ...diamonds], {
    margin: {l: 0, r: 0, t: 0, b: 0}, showlegend: false, uirevision: now.key,
    scene: {xaxis: axis(0), yaxis: axis(1), zaxis: axis(2), aspectmode: "manual", aspectratio: {x: 2, y: 2, z: 2},
      dragmode: "orbit", uirevision: now.key, annotations: [...numbers, ...labels],
      camera: {projection: {type: "orthographic"}, eye: vector(times(towards, 3.0)), up: vector(up),
        center: {x: 0, y: 0, z: 0}}}}, CONFIG);
}

// ---------------------------------------------------------------- energies

const AXIS = {zeroline: false, showline: true, linecolor: "#888", ticks: "outside", gridcolor: "#e6e6e6"};
const MARGIN = {l: 55, r: 12, t: 26, b: 42};

function drawProfile() {
  if (scene.track < 0) return;
  const track = scene.data.tracks[scene.track];
  Plotly.react("profile", [
    {x: track.parameter, y: track.energy, mode: "lines+markers", line: {color: "#333", width: 2},
      marker: {size: 3, color: "#333"}, hovertemplate: "%{x:.4g}: %{y:.6g} J<extra></extra>"},
    {x: [track.parameter[scene.step]], y: [track.energy[scene.step]], mode: "markers", hoverinfo: "skip",
      marker: {size: 13, color: "#e69f00", line: {color: "#111", width: 2}}}],
  {margin: MARGIN, showlegend: false, dragmode: false, title: {text: "Energy along the path", font: {size: 13}},
    xaxis: {...AXIS, title: {text: safe(track.label)}}, yaxis: {...AXIS, title: {text: "energy [J]"}}}, CONFIG);
}

function mapTraces(panel) {
  panel.ranges = [0, 1].map(k => {  // with room, so that a star on the border is seen whole
    const all = [...panel[k ? "y" : "x"], ...panel.lines.flatMap(l => l.points.map(p => p[k])), ...panel.stations.map(p => p[k + 1])]
      .filter(v => v !== null);
    const low = all.reduce((a, b) => Math.min(a, b), Infinity), high = all.reduce((a, b) => Math.max(a, b), -Infinity);
    return [low - 0.06 * (high - low), high + 0.06 * (high - low)];
  });
  const out = [], flat = (panel.energy || []).flat().filter(v => v !== null);
  if (panel.energy && flat.length) {
    const low = flat.reduce((a, b) => Math.min(a, b)), high = flat.reduce((a, b) => Math.max(a, b));
    const share = v => v === null ? null : Math.sqrt((v - low) / (high - low || 1));  // finer where minima are
    const ticks = [0, 0.25, 0.5, 0.75, 1];
    out.push({type: "heatmap", x: panel.x, y: panel.y, z: panel.energy.map(row => row.map(share)), customdata: panel.energy,
      colorscale: SCALE, zmin: 0, zmax: 1, hoverongaps: false,
      hovertemplate: `${safe(panel.labels[0])} %{x:.3f}<br>${safe(panel.labels[1])} %{y:.3f}<br>U = %{customdata:.6g} J<extra></extra>`,
      colorbar: {title: {text: "U [J]"}, thickness: 12, tickvals: ticks,
        ticktext: ticks.map(t => Number((low + t * t * (high - low)).toPrecision(3)).toString())}});
  }
  for (const line of panel.lines) {
    const [x, y] = [0, 1].map(k => line.points.map(p => p[k]));
    out.push({x, y, mode: "lines", line: LOOKS[line.look], hoverinfo: "text", text: safe(line.name), name: line.look,
      showlegend: false});
  }
  return out;
}

function drawMaps() {
  const now = current();
  scene.data.panels.forEach((panel, m) => {
    const marks = panel.stations, here = [];
    const traces = [...scene.maps[m]];
    for (const {track, points} of panel.tracks) {
      if (track !== scene.track) continue;
      for (const look of [{color: "#000", width: 5}, {color: "#fff", width: 2.5}])
        traces.push({x: points.map(p => p[0]), y: points.map(p => p[1]), mode: "lines", line: look, hoverinfo: "skip"});
      here.push(points[scene.step]);
    }
    traces.push({x: marks.map(p => p[1]), y: marks.map(p => p[2]), mode: "markers+text",
      text: marks.map(p => String(p[0] + 1)), textposition: "top right",
      textfont: {size: 15, color: "#111", weight: "bold", shadow: "0 0 3px #fff, 0 0 3px #fff, 0 0 3px #fff"},
      hovertext: marks.map(p => safe(scene.data.stations[p[0]].title)), hoverinfo: "text", customdata: marks.map(p => p[0]),
      marker: {symbol: "star", opacity: 1, size: marks.map(p => scene.track < 0 && p[0] === scene.station ? 19 : 13),
        color: marks.map(p => scene.track < 0 && p[0] === scene.station ? "#e69f00" : "#ffffff"),
        line: {color: "#111", width: 1.5}}, cliponaxis: false});
    traces.push({x: here.map(p => p[0]), y: here.map(p => p[1]), mode: "markers", hoverinfo: "skip",
      marker: {size: 14, color: "#e69f00", line: {color: "#111", width: 2}}, cliponaxis: false});
    const div = $("map" + m);
    Plotly.react(div, traces, {margin: MARGIN, showlegend: false, dragmode: false, hovermode: "closest",
      uirevision: 1, title: {text: safe(panel.title), font: {size: 13}},
      xaxis: {...AXIS, title: {text: safe(panel.labels[0])}, range: panel.ranges[0]},
      yaxis: {...AXIS, title: {text: safe(panel.labels[1])}, range: panel.ranges[1]},
      plot_bgcolor: panel.energy ? "#f4f4f4" : "#fff"}, CONFIG);
    if (!div.listens) {
      div.listens = true;
      div.on("plotly_click", event => {  // a star is a way to its state
        const chosen = event.points.find(p => typeof p.customdata === "number" && p.data.mode === "markers+text");
        if (chosen) chooseState(chosen.customdata);
      });
    }
  });
}

// ---------------------------------------------------------------- what is chosen

function current() {
  if (scene.track >= 0) {
    const track = scene.data.tracks[scene.track], state = track.states[scene.step];
    return {state, view: track.view, marks: [], energy: track.energy[scene.step], all: track.states,
      key: `path ${scene.track}`};
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
  $("step").disabled = $("play").disabled = !onPath;
  $("step").max = onPath ? track.states.length - 1 : 0;
  $("step").value = scene.step;
  $("profile").style.display = onPath ? "" : "none";
  let said = `U = ${number(now.energy)} J`;
  if (onPath) said += `; step ${scene.step + 1} of ${track.states.length}` +
    (track.of > track.states.length ? ` shown (${track.of} stored)` : "");
  else if (scene.data.note) said += `. ${scene.data.note}`;
  $("where").textContent = said;
  const lines = onPath
    ? [`${scene.data.steps} Contacts are marked on chosen states only.`,
      `fold angles [deg]: ${now.state.angles.map(degrees).join(", ")}`]
    : now.state.lines;
  $("lines").replaceChildren(...lines.map(text => Object.assign(document.createElement("li"), {textContent: text})));
  drawSpace(); drawProfile(); drawMaps();
}

function stop() {
  clearInterval(scene.playing);
  scene.playing = null;
  $("play").innerHTML = "&#9654;";
}

function chooseState(n) {
  stop();
  const count = scene.data.stations.length;
  Object.assign(scene, {station: (n + count) % count, track: -1, step: 0});
  draw();
}

function choosePath(n) {
  stop();
  Object.assign(scene, {track: n, step: 0});
  if (n >= 0 && scene.data.tracks[n].start !== null) scene.station = scene.data.tracks[n].start;
  draw();
}

function chooseScene(n) {
  stop();
  const data = DATA[n];
  Object.assign(scene, {data, station: 0, track: data.stations.length ? -1 : 0, step: 0});
  $("title").textContent = data.title;
  fill($("state"), data.stations.map(s => s.title), 0);
  fill($("path"), ["none: the state alone", ...data.tracks.map(t => t.title)], 0);
  document.querySelectorAll(".paths").forEach(e => { e.style.display = data.tracks.length ? "" : "none"; });
  document.querySelectorAll(".report").forEach((e, k) => { e.hidden = k !== n; });
  $("maps").replaceChildren(...data.panels.map((_, m) =>
    Object.assign(document.createElement("div"), {id: "map" + m, className: "map"})));
  scene.maps = data.panels.map(mapTraces);
  const plots = document.querySelector(".plots"), some = data.stations.length + data.tracks.length > 0;
  plots.style.display = some ? "" : "none";
  plots.classList.toggle("alone", !data.panels.length);
  if (some) draw();
  else $("where").textContent = "There is no state to show.";
}

$("state").onchange = event => chooseState(Number(event.target.value));
$("before").onclick = () => chooseState(scene.station - 1);
$("after").onclick = () => chooseState(scene.station + 1);
$("path").onchange = event => choosePath(Number(event.target.value) - 1);
$("step").oninput = event => { scene.step = Number(event.target.value); draw(); };
$("play").onclick = () => {
  if (scene.playing) return stop();
  const last = scene.data.tracks[scene.track].states.length - 1;
  if (scene.step === last) scene.step = 0;
  $("play").textContent = "❚❚";
  scene.playing = setInterval(() => {
    scene.step += 1;
    draw();
    if (scene.step >= last) stop();
  }, 90);
};
$("scene").onchange = event => chooseScene(Number(event.target.value));
fill($("scene"), DATA.map(d => d.title), 0);
document.querySelectorAll(".many").forEach(e => { e.style.display = DATA.length > 1 ? "" : "none"; });
chooseScene(0);
