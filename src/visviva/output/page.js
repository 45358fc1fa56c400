"use strict";
// What one does with the page: time, fields, parts, cuts, curves. Frames stand in the page, or who serves it has them.

const find = (id) => document.getElementById(id);
const about = JSON.parse(find("about").textContent);
const inside = find("frames").textContent.trim().split("\n");
const MOST_KEPT = 60;  // unpacked frames in memory
const state = {frame: 0, playing: false, hidden: new Set(), wanted: 0, shown: -1, failed: ""};
const kept = new Map();
let drawing, camera, plots = [];

async function unpacked(text) {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}

async function served(path) {
  const answer = await fetch(`${path}?token=${about.token}`);
  if (!answer.ok) throw new Error(`the viewer answers ${answer.status}: ${await answer.text()}`);
  return answer;
}

async function frame(k) {
  if (!kept.has(k)) {
    const data = about.token ? await (await served(`frame/${k}`)).arrayBuffer() : await unpacked(inside[k]);
    kept.set(k, new Numbers(data));
    while (kept.size > MOST_KEPT) kept.delete(kept.keys().next().value);
  }
  return kept.get(k);
}

// Positions and fields of a moment: the range of each component, then 16 bits a number.
class Numbers {
  constructor(data) {
    const n = about.points;
    let at = 0;
    this.positions = new Float32Array(3 * n); this.fields = [];
    const read = (width, put) => {
      const ends = new Float64Array(data, at, 2 * width), whole = new Uint16Array(data, at + 16 * width, width * n);
      for (let c = 0; c < width; c++) {
        const low = ends[c], step = (ends[width + c] - low) / 65534;
        for (let k = 0; k < n; k++) put(k, c, whole[c * n + k] === 65535 ? NaN : low + step * whole[c * n + k]);
      }
      at += 16 * width + Math.ceil(2 * width * n / 8) * 8;
    };
    read(3, (k, c, x) => { this.positions[3 * k + c] = x; });
    for (const _ of about.fields) {
      const values = new Float32Array(n);
      read(1, (k, c, x) => { values[k] = x; });
      this.fields.push(values);
    }
  }
}

async function show(k) {
  state.wanted = k = Math.max(0, Math.min(k, about.times.length - 1));
  let numbers;
  try { numbers = await frame(k); } catch (error) { trouble(error); return; }
  if (state.wanted !== k) return;  // the slider has gone on
  state.frame = k; state.numbers = numbers;
  find("slider").value = k;
  find("moment").textContent = `${about.clock.replace(/ \[.*/, "")} ${short(about.times[k])} ${(about.clock.match(/\[(.*)\]/) || ["", ""])[1]}`;
  place(); plots.forEach((plot) => plot.draw());
  state.shown = k;
}

function place() {
  const k = chosen(), n = about.points, values = new Float32Array(n).fill(-1);
  if (k >= 0) {
    const [low, high] = about.fields[k].range, field = state.numbers.fields[k];
    for (let j = 0; j < n; j++) if (!Number.isNaN(field[j])) values[j] = Math.max((field[j] - low) / (high - low), 0);
  }
  drawing.place(state.numbers.positions, values, find("mesh").checked);
  draw();
}

function draw() { drawing.draw(camera, {hidden: state.hidden, cut: cut(), mesh: find("mesh").checked}); }

const chosen = () => about.fields.findIndex((field) => field.name === find("field").value);

function cut() {
  const axis = find("cut").value;
  find("cut-place").disabled = axis === "";
  if (axis === "") return null;
  const plane = [0, 0, 0, 0], middle = about.camera.target[axis], s = find("cut-place").value / 1000 - 0.5;
  const side = camera.eye[axis] < camera.target[axis] ? -1 : 1;  // what is before the cut goes
  plane[axis] = side; plane[3] = side * (middle + s * about.camera.extent * 1.2);
  return plane;
}

function short(x) { return x === null || Number.isNaN(x) ? "–" : String(parseFloat(x.toPrecision(4))); }

function bar() {
  const k = chosen();
  find("bar").hidden = k < 0;
  if (k < 0) return;
  const {label, range: [low, high]} = about.fields[k], colors = find("bar-colors").getContext("2d");
  find("bar-title").textContent = label;
  for (let j = 0; j < 256; j++) { colors.fillStyle = `rgb(${drawing.arrays.map.slice(3 * j, 3 * j + 3).join(",")})`; colors.fillRect(0, 255 - j, 16, 1); }
  find("bar-ticks").replaceChildren(...ticks(low, high, 5).map((value) => {
    const tick = document.createElement("span");
    tick.textContent = short(value); tick.style.bottom = `${100 * (value - low) / (high - low)}%`;
    return tick;
  }));
}

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((digit) => digit * power >= rough) || 10);
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && out.length < 20; k++) out.push(k * step);
  return out;
}

class Plot {
  constructor(data, at) {
    this.box = document.createElement("div"); this.box.className = "plot";
    this.box.innerHTML = "<b></b><canvas></canvas><div class=legend></div>";
    this.canvas = this.box.querySelector("canvas");
    this.canvas.onclick = (event) => show(nearest(this.time(event.offsetX)));  // of a path, the state nearest to a load
    at.append(this.box); this.set(data);
  }
  set(data) {
    this.data = data; this.box.querySelector("b").textContent = data.title;
    const all = data.curves.flatMap((curve) => curve.values).filter((x) => x !== null);
    this.low = Math.min(...all, Infinity); this.high = Math.max(...all, -Infinity);
    if (!(this.high > this.low)) { const d = Math.abs(this.low) || 1; this.low -= d; this.high += d; }
  }
  span() { const p = this.data.places, a = Math.min(...p), b = Math.max(...p); return [a, b > a ? b : a + 1]; }
  time(x) {
    const [a, b] = this.span(), place = a + (x - 46) / (this.canvas.clientWidth - 50) * (b - a), {times, places} = this.data;
    if (about.clock !== "state") return place;
    return times[places.reduce((best, p, k) => Math.abs(p - place) < Math.abs(places[best] - place) ? k : best, 0)];
  }
  draw() {
    const scale = window.devicePixelRatio || 1, w = this.canvas.clientWidth, h = this.canvas.clientHeight, g = this.canvas.getContext("2d");
    if (!w || !this.data.times.length) return;
    this.canvas.width = scale * w; this.canvas.height = scale * h; g.scale(scale, scale);
    const [a, b] = this.span(), x = (t) => 46 + (t - a) / (b - a) * (w - 50), y = (v) => h - 14 - (v - this.low) / (this.high - this.low) * (h - 22);
    g.font = "10px system-ui, sans-serif"; g.fillStyle = "#5b6772"; g.strokeStyle = "#e3e8ed"; g.textAlign = "right";
    for (const v of ticks(this.low, this.high, 3)) { g.beginPath(); g.moveTo(46, y(v)); g.lineTo(w - 4, y(v)); g.stroke(); g.fillText(short(v), 42, y(v) + 3); }
    g.textAlign = "center";
    for (const t of ticks(a, b, 4)) g.fillText(short(t), Math.min(x(t), w - 12), h - 2);
    const now = about.times[state.frame], legend = this.box.querySelector(".legend");
    legend.replaceChildren();
    this.data.curves.forEach((curve, c) => {
      const color = about.palette[c % about.palette.length], entry = document.createElement("span");
      g.strokeStyle = color; g.lineWidth = 1.4; g.beginPath();
      let pen = false;
      curve.values.forEach((v, k) => { if (v === null) { pen = false; return; } g[pen ? "lineTo" : "moveTo"](x(this.data.places[k]), y(v)); pen = true; });
      g.stroke();
      entry.style.color = color; entry.textContent = `${curve.name} ${short(at(this.data.times, curve.values, now))}`;
      legend.append(entry);
    });
    g.strokeStyle = about.ink; g.lineWidth = 1; g.beginPath(); const here = x(at(this.data.times, this.data.places, now));
    g.moveTo(here, 4); g.lineTo(here, h - 14); g.stroke();
  }
}

function place_of(times, t) {
  let a = 0, b = times.length - 1;
  while (a < b) { const m = (a + b) >> 1; if (times[m] < t) a = m + 1; else b = m; }
  return a;
}
function nearest(t) { const k = place_of(about.times, t); return k && t - about.times[k - 1] < about.times[k] - t ? k - 1 : k; }
function at(times, values, t) {
  const k = place_of(times, t);
  if (k === 0 || values[k] === null || values[k - 1] === null) return values[k];
  const s = Math.min(Math.max((t - times[k - 1]) / (times[k] - times[k - 1]), 0), 1);
  return values[k - 1] + s * (values[k] - values[k - 1]);
}

// The point that is drawn nearest to a place of the view: its part, and the value of the field there.
function under(x, y) {
  const w = drawing.canvas.clientWidth, h = drawing.canvas.clientHeight, m = camera.matrix(w / h), p = state.numbers.positions;
  let best = null;
  about.parts.forEach((part) => {
    if (state.hidden.has(part.name)) return;
    for (let k = part.points[0]; k < part.points[0] + part.points[1]; k++) {
      const q = [0, 1, 2, 3].map((r) => m[r] * p[3 * k] + m[4 + r] * p[3 * k + 1] + m[8 + r] * p[3 * k + 2] + m[12 + r]);
      const d = Math.hypot((q[0] / q[3] + 1) / 2 * w - x, (1 - q[1] / q[3]) / 2 * h - y);
      if (d < 14 && (!best || q[3] + d * camera.extent / 400 < best.rank)) best = {part: part.name, point: k, rank: q[3] + d * camera.extent / 400};
    }
  });
  if (!best) return null;
  const k = chosen();
  return {...best, position: Array.from(p.slice(3 * best.point, 3 * best.point + 3)), value: k < 0 ? null : state.numbers.fields[k][best.point]};
}

function hint(event) {
  const found = event && !event.buttons ? under(event.offsetX, event.offsetY) : null;
  find("hint").hidden = !found;
  if (!found) return;
  const value = found.value === null || Number.isNaN(found.value) ? `(${found.position.map(short).join(", ")})` : `${short(found.value)}`;
  find("hint").textContent = `${found.part}  ${value}`;
  Object.assign(find("hint").style, {left: `${event.offsetX + 14}px`, top: `${event.offsetY + 10}px`});
}

function play(on) {
  state.playing = on;
  find("play").innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
  if (!on) return;
  if (state.frame === about.times.length - 1) state.frame = 0;
  let began = performance.now(), from = about.times[state.frame];
  const speed = () => { const s = find("speed").value; return s === "fit" ? (about.times[about.times.length - 1] - about.times[0]) / 8 : Number(s); };
  let pace = speed();
  const step = async (now) => {
    if (!state.playing) return;
    if (pace !== speed()) { began = now; from = about.times[state.frame]; pace = speed(); }
    let t = from + (now - began) / 1000 * pace;
    if (t >= about.times[about.times.length - 1]) { began = now; t = from = about.times[0]; }
    const k = nearest(t);
    if (k !== state.frame) await show(k);
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function listen() {
  const view = find("view");
  view.onpointerdown = (event) => view.setPointerCapture(event.pointerId);
  view.onpointermove = (event) => {
    if (!event.buttons) { hint(event); return; }
    hint(null);
    const dx = event.movementX / view.clientHeight, dy = event.movementY / view.clientHeight;
    if (event.shiftKey || event.buttons > 1) camera.move(dx, dy); else camera.turn(5 * dx, 5 * dy);
    draw();
  };
  view.onpointerleave = () => hint(null);
  view.oncontextmenu = (event) => event.preventDefault();
  view.addEventListener("wheel", (event) => { event.preventDefault(); camera.zoom(Math.exp(0.001 * event.deltaY)); draw(); }, {passive: false});
  find("play").onclick = () => play(!state.playing);
  find("slider").oninput = () => { play(false); find("follow").checked = false; show(Number(find("slider").value)); };
  for (const id of ["field", "mesh"]) find(id).onchange = () => { bar(); place(); };
  find("cut").onchange = draw; find("cut-place").oninput = draw;
  find("reset").onclick = () => { camera = new Camera(about.camera, about.opening); draw(); };
  document.onkeydown = (event) => {
    if (["SELECT", "INPUT", "BUTTON"].includes(event.target.tagName)) return;
    if (event.key === " ") { event.preventDefault(); play(!state.playing); }
    if (event.key === "ArrowRight") show(state.frame + 1);
    if (event.key === "ArrowLeft") show(state.frame - 1);
  };
  new ResizeObserver(() => { draw(); plots.forEach((plot) => plot.draw()); }).observe(find("stage"));
}

function furnish() {
  const option = (value, text) => { const o = document.createElement("option"); o.value = value; o.textContent = text; return o; };
  find("slider").max = about.times.length - 1;
  find("field").append(option("", "none"), ...about.fields.map((field) => option(field.name, field.label)));
  find("field").value = about.fields.some((field) => field.name === about.first) ? about.first : "";
  find("speed").append(option("fit", "whole in 8 s"), ...[0.01, 0.1, 0.25, 0.5, 1, 2, 5, 10].map((s) => option(s, `${s} ×`)));
  find("parts").append(...about.parts.map((part) => {
    const label = document.createElement("label"), box = document.createElement("input"), patch = document.createElement("i");
    box.type = "checkbox"; box.checked = true; patch.style.background = part.color;
    box.onchange = () => { if (box.checked) state.hidden.delete(part.name); else state.hidden.add(part.name); draw(); };
    label.append(box, patch, part.name);
    return label;
  }));
  plots = about.plots.map((data) => new Plot(data, find("plots")));
}

// A run that goes on has more to show from time to time.
async function follow() {
  try {
    const news = await (await served("news")).json();
    const grown = news.times.length !== about.times.length;
    Object.assign(about, {times: news.times, fields: news.fields, plots: news.plots});
    find("slider").max = about.times.length - 1;
    news.plots.forEach((data, k) => plots[k] ? plots[k].set(data) : plots.push(new Plot(data, find("plots"))));
    bar();
    if (grown && find("follow").checked && !state.playing) { about.camera = news.camera; await show(about.times.length - 1); } else plots.forEach((plot) => plot.draw());
  } catch (error) { trouble(error); return; }
  setTimeout(follow, 1000);
}

function trouble(error) { state.failed = String(error.message || error); find("trouble").hidden = false; find("trouble").textContent = state.failed; }

async function begin() {
  const arrays = {};
  for (const [name, text] of Object.entries(about.arrays)) {
    const data = await unpacked(text);
    arrays[name] = name === "map" ? new Uint8Array(data) : new Uint32Array(data);
  }
  drawing = new Drawing(find("view"), about, arrays);
  camera = new Camera(about.camera, about.opening);
  furnish(); bar(); await show(about.live ? about.times.length - 1 : 0); listen();
  find("follow-label").hidden = !about.live;
  if (about.live) setTimeout(follow, 1000);
  state.ready = true;
}

window.visviva = {state, show, under, about};
begin().catch(trouble);
