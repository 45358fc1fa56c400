"use strict";
// Draws the parts of a moment with WebGL: shaded faces, lines of even width, dots.

const FACE_VERTEX = `#version 300 es
in vec3 position; in vec3 normal; in float value;
uniform mat4 matrix;
out vec3 place; out vec3 across; out float shade;
void main() { place = position; across = normal; shade = value; gl_Position = matrix * vec4(position, 1.0); }`;

const COLORED = `
uniform vec3 color; uniform sampler2D map; uniform vec4 cut; uniform bool cutting;
vec3 tint(float value) { return value < -0.5 ? color : texture(map, vec2(clamp(value, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb; }
bool away(vec3 p) { return cutting && dot(cut.xyz, p) > cut.w; }`;

const FACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place; in vec3 across; in float shade; out vec4 result;
uniform vec3 eye; uniform vec3 up;${COLORED}
void main() {
  if (away(place)) discard;
  vec3 back = normalize(eye - place);
  vec3 n = normalize(across + 1e-12 * back);
  if (dot(n, back) < 0.0) n = -n;
  vec3 side = normalize(cross(up, back) + 1e-9);
  float light = 0.5 + 0.5 * dot(n, normalize(back + 0.7 * up - 0.5 * side));
  bool plain = shade < -0.5;
  float bright = plain ? 0.5 + 0.6 * light : 0.86 + 0.14 * light;  // light must not falsify what colours say
  float gloss = plain ? 0.2 * pow(max(dot(n, normalize(back + 0.4 * up)), 0.0), 30.0) : 0.0;
  result = vec4(tint(shade) * bright + gloss, 1.0);
}`;

const LINE_VERTEX = `#version 300 es
in vec2 corner; in vec3 from; in vec3 to; in vec2 values;
uniform mat4 matrix; uniform vec2 size; uniform float width; uniform vec3 eye;
out vec3 place; out float shade;
vec4 lifted(vec3 p) { return matrix * vec4(mix(p, eye, 0.0015), 1.0); }  // before the faces it lies on
void main() {
  vec4 a = lifted(from), b = lifted(to);
  vec2 along = (b.xy / b.w - a.xy / a.w) * size;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  vec4 p = mix(a, b, corner.x);
  p.xy += (vec2(-along.y, along.x) * corner.y + along * (corner.x - 0.5) * 0.5) * width / size * p.w;
  place = mix(from, to, corner.x); shade = mix(values.x, values.y, corner.x);
  gl_Position = p;
}`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place; in float shade; out vec4 result;${COLORED}
void main() { if (away(place)) discard; result = vec4(tint(shade), 1.0); }`;

const DOT_VERTEX = `#version 300 es
in vec3 position; in float value;
uniform mat4 matrix; uniform float width;
out vec3 place; out float shade;
void main() { place = position; shade = value; gl_Position = matrix * vec4(position, 1.0); gl_PointSize = width; }`;

const DOT_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place; in float shade; out vec4 result;${COLORED}
void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  if (away(place) || dot(p, p) > 1.0) discard;
  result = vec4(tint(shade) * (1.0 - 0.4 * length(p - vec2(-0.3))), 1.0);
}`;

const plus = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const l = Math.hypot(...a) || 1; return a.map((x) => x / l); };
const rgb = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16) / 255);

class Camera {
  constructor({eye, target, up, extent}, opening) { Object.assign(this, {eye, target, up, extent, opening}); }
  axes() {
    const back = unit(plus(this.eye, this.target, -1)), right = unit(cross(this.up, back));
    return [right, cross(back, right), back];
  }
  distance() { return Math.hypot(...plus(this.eye, this.target, -1)); }
  matrix(aspect) {  // column after column
    const [r, u, b] = this.axes(), d = this.distance(), e = this.eye;
    const near = Math.max(d - 1.5 * this.extent, 0.02 * d), far = d + 3 * this.extent;
    const f = 1 / Math.tan(this.opening * Math.PI / 360), g = f / Math.min(Math.max(aspect, 0.1), 10);
    const widen = aspect < 10 / 7 ? aspect / (10 / 7) : 1;  // what was fitted to a wide view fits a narrow one, too
    const row = (v, s) => [s * v[0], s * v[1], s * v[2], -s * dot(v, e)];
    const depth = (far + near) / (near - far);
    const rows = [row(r, g * widen), row(u, f * widen), row(b, depth), row(b, -1)];
    rows[2][3] += 2 * far * near / (near - far);
    return Float32Array.from([0, 1, 2, 3].flatMap((c) => rows.map((x) => x[c])));
  }
  turn(dx, dy) {
    const [right] = this.axes();
    let back = plus(this.eye, this.target, -1);
    const rotate = (v, axis, a) => plus(plus(v.map((x) => x * Math.cos(a)), cross(axis, v), Math.sin(a)), axis, dot(axis, v) * (1 - Math.cos(a)));
    const tilted = rotate(back, right, -dy);
    if (Math.abs(dot(unit(tilted), this.up)) < 0.9995) back = tilted;
    this.eye = plus(this.target, rotate(back, unit(this.up), -dx));
  }
  move(dx, dy) {
    const [right, upward] = this.axes(), s = 2 * this.distance() * Math.tan(this.opening * Math.PI / 360);
    const by = plus(right.map((x) => -x * dx * s), upward, dy * s);
    this.eye = plus(this.eye, by); this.target = plus(this.target, by);
  }
  zoom(factor) { this.eye = plus(this.target, plus(this.eye, this.target, -1), factor); }
}

class Drawing {
  constructor(canvas, about, arrays) {
    const gl = this.gl = canvas.getContext("webgl2", {antialias: true, preserveDrawingBuffer: true});
    if (!gl) throw new Error("This page draws with WebGL 2, which this browser does not offer or has switched off.");
    Object.assign(this, {canvas, about, arrays});
    this.faces = this.program(FACE_VERTEX, FACE_FRAGMENT);
    this.lines = this.program(LINE_VERTEX, LINE_FRAGMENT);
    this.points = this.program(DOT_VERTEX, DOT_FRAGMENT);
    this.buffers = {};
    for (const name of ["position", "normal", "value", "edges", "edgesValues", "mesh", "meshValues", "dots", "dotsValues", "corner"]) this.buffers[name] = gl.createBuffer();
    this.fill("corner", new Float32Array([0, -1, 0, 1, 1, -1, 1, 1]), gl.STATIC_DRAW);
    this.index = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, arrays.triangles, gl.STATIC_DRAW);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, arrays.map);
    for (const [k, v] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_2D, k, v);
    gl.enable(gl.DEPTH_TEST);
  }

  program(...sources) {
    const gl = this.gl, program = gl.createProgram();
    sources.forEach((source, k) => {
      const shader = gl.createShader(k ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, source); gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const all = (what, count, find) => Object.fromEntries(Array.from({length: gl.getProgramParameter(program, count)}, (_, k) => gl[what](program, k).name).map((n) => [n, find(n)]));
    return {program, at: all("getActiveAttrib", gl.ACTIVE_ATTRIBUTES, (n) => gl.getAttribLocation(program, n)), has: all("getActiveUniform", gl.ACTIVE_UNIFORMS, (n) => gl.getUniformLocation(program, n))};
  }

  fill(name, data, usage = this.gl.DYNAMIC_DRAW) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffers[name]);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, data, usage);
  }

  // Positions (3 n) and values (n) from 0 to 1, -1 where there are none, at the points that are drawn.
  place(positions, values, withMesh) {
    const {corners, triangles, edges, mesh, dots} = this.arrays;
    const p = gathered(positions, corners, 3);
    this.fill("position", p); this.fill("normal", normals(p, triangles)); this.fill("value", gathered(values, corners, 1));
    this.fill("edges", gathered(positions, edges, 3)); this.fill("edgesValues", gathered(values, edges, 1));
    this.fill("dots", gathered(positions, dots, 3)); this.fill("dotsValues", gathered(values, dots, 1));
    if (withMesh) { this.fill("mesh", gathered(positions, mesh, 3)); this.fill("meshValues", new Float32Array(mesh.length).fill(-1)); }
  }

  draw(camera, {hidden, cut, mesh}) {
    const gl = this.gl, scale = Math.min(window.devicePixelRatio || 1, 2);
    const [w, h] = [this.canvas.clientWidth, this.canvas.clientHeight].map((x) => Math.max(Math.round(scale * x), 1));
    if (this.canvas.width !== w || this.canvas.height !== h) { this.canvas.width = w; this.canvas.height = h; }
    gl.viewport(0, 0, w, h); gl.clearColor(0, 0, 0, 0); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.shared = {matrix: camera.matrix(w / h), size: [w, h], eye: camera.eye, up: unit(camera.up), cut, scale};
    const shown = this.about.parts.filter((part) => !hidden.has(part.name));
    this.begin(this.faces, {position: ["position", 3], normal: ["normal", 3], value: ["value", 1]});
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
    for (const part of shown) {
      gl.uniform3fv(this.faces.has.color, rgb(part.color));
      gl.drawElements(gl.TRIANGLES, 3 * part.triangles[1], gl.UNSIGNED_INT, 12 * part.triangles[0]);
    }
    for (const part of shown) {
      const solid = part.triangles[1] > 0, color = solid ? rgb(this.about.ink) : rgb(part.color);
      if (mesh) this.segments("mesh", part.mesh, 0.7, color);
      this.segments("edges", part.edges, solid ? 1.2 : 3, color, solid);
    }
    this.begin(this.points, {position: ["dots", 3], value: ["dotsValues", 1]});
    gl.uniform1f(this.points.has.width, 11 * scale);
    for (const part of shown) { gl.uniform3fv(this.points.has.color, rgb(part.color)); gl.drawArrays(gl.POINTS, ...part.dots); }
  }

  begin(program, buffers, instanced = []) {
    const gl = this.gl, {matrix, eye, up, cut, size} = this.shared;
    gl.useProgram(program.program);
    for (let k = 0; k < 8; k++) { gl.disableVertexAttribArray(k); gl.vertexAttribDivisor(k, 0); }
    for (const [name, [buffer, width, stride = 0, offset = 0]] of Object.entries(buffers)) {
      const place = program.at[name];
      if (place === undefined) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[buffer]); gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, width, gl.FLOAT, false, stride, offset);
      gl.vertexAttribDivisor(place, instanced.includes(name) ? 1 : 0);
    }
    gl.uniformMatrix4fv(program.has.matrix, false, matrix);
    if (program.has.eye) gl.uniform3fv(program.has.eye, eye);
    if (program.has.up) gl.uniform3fv(program.has.up, up);
    if (program.has.size) gl.uniform2fv(program.has.size, size);
    gl.uniform1i(program.has.cutting, cut ? 1 : 0);
    if (cut) gl.uniform4fv(program.has.cut, cut);
  }

  segments(name, [start, count], width, color, plain = true) {
    if (!count) return;
    const gl = this.gl, first = 24 * start;
    this.begin(this.lines, {corner: ["corner", 2], from: [name, 3, 24, first], to: [name, 3, 24, first + 12],
      ...(plain ? {} : {values: [`${name}Values`, 2, 8, 8 * start]})}, ["from", "to", "values"]);
    if (plain) gl.vertexAttrib2f(this.lines.at.values, -1, -1);
    gl.uniform1f(this.lines.has.width, width * this.shared.scale);
    gl.uniform3fv(this.lines.has.color, color);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }
}

function gathered(source, ids, width) {
  const out = new Float32Array(width * ids.length);
  if (width === 1) for (let k = 0; k < ids.length; k++) out[k] = source[ids[k]];
  else for (let k = 0; k < ids.length; k++) { const s = 3 * ids[k]; out[3 * k] = source[s]; out[3 * k + 1] = source[s + 1]; out[3 * k + 2] = source[s + 2]; }
  return out;
}

function normals(p, triangles) {
  const out = new Float32Array(p.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    let x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const l = Math.sqrt(Math.hypot(x, y, z)) || 1;  // larger faces count more, but not as their area
    x /= l; y /= l; z /= l;
    for (const k of [a, b, c]) { out[k] += x; out[k + 1] += y; out[k + 2] += z; }
  }
  return out;
}
