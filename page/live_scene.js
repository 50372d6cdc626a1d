// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The 3-D view of `cairn live --view`, in WebGL2. Its frame is the floor's below the camera: x forward, y left, z up
// (ROS REP 103), in m. It follows shared.js and comes before live.js, in one <script>.

/** The little of linear algebra that a camera needs; matrices column by column, as WebGL takes them. */
const kMatrix = {
  product(a, b) {
    const out = new Float32Array(16);
    for (let c = 0; c < 4; ++c) for (let r = 0; r < 4; ++r) for (let k = 0; k < 4; ++k) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    return out;
  },
  perspective(degrees, aspect, near, far) {
    const f = 1 / Math.tan(degrees * Math.PI / 360);
    return Float32Array.of(f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0);
  },
  looking(eye, at) {
    const away = unit3(minus3(eye, at)), right = unit3(cross3([0, 0, 1], away)), up = cross3(away, right);
    const back = (axis) => -dot3(axis, eye);
    return Float32Array.of(right[0], up[0], away[0], 0, right[1], up[1], away[1], 0, right[2], up[2], away[2], 0, back(right), back(up), back(away), 1);
  },
  /** From the rows of a 3×4 or 4×4 matrix. */
  ofRows: (m) => Float32Array.of(m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, m[3], m[7], m[11], 1),
};
const minus3 = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross3 = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit3 = (a) => a.map((v) => v / (Math.hypot(...a) || 1));
const bytesOf = (colour) => [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));

// Lines are quads: WebGL draws none wider than a pixel. What lies behind the eye is cut off before it is projected.
const kLineShader = `#version 300 es
uniform mat4 clip; uniform vec2 size;
layout(location = 0) in vec3 from; layout(location = 1) in vec3 to; layout(location = 2) in vec4 colour; layout(location = 3) in float width;
out vec4 tint;
void main() {
  vec4 a = clip * vec4(from, 1.0), b = clip * vec4(to, 1.0);
  const float near = 0.05;
  tint = colour;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (a.w < near && b.w < near) return;
  if (a.w < near) a = mix(b, a, (b.w - near) / (b.w - a.w));
  else if (b.w < near) b = mix(a, b, (a.w - near) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * size;
  float far = length(along);
  along = far > 0.001 ? along / far : vec2(1.0, 0.0);
  vec2 aside = vec2(-along.y, along.x) * width / size * (gl_VertexID < 2 ? -1.0 : 1.0);
  vec4 end = (gl_VertexID & 1) == 0 ? a : b;
  gl_Position = end + vec4(aside * end.w, 0.0, 0.0);
}`;
const kFaceShader = `#version 300 es
uniform mat4 clip;
layout(location = 0) in vec3 place; layout(location = 1) in vec4 colour;
out vec4 tint;
void main() { tint = colour; gl_Position = clip * vec4(place, 1.0); }`;
// A PointCloud2 as it came. Points without a colour of their own are coloured by their height over the floor.
const kCloudShader = `#version 300 es
uniform mat4 clip, floor_from_camera; uniform float scale; uniform bool has_colour;
layout(location = 0) in vec3 place; layout(location = 1) in vec4 colour;
out vec4 tint;
void main() {
  vec4 p = floor_from_camera * vec4(place, 1.0);
  float high = clamp(p.z / 1.5, 0.0, 1.0);
  tint = vec4(has_colour ? mix(colour.bgr, vec3(0.75), 0.12) : mix(vec3(0.25, 0.55, 0.62), vec3(0.95, 0.72, 0.35), high), 1.0);
  gl_Position = clip * p;
  gl_PointSize = clamp(scale / gl_Position.w, 1.5, 7.0);
}`;
const kTintShader = `#version 300 es
precision mediump float;
in vec4 tint; out vec4 shown;
void main() { shown = tint; }`;

/** The six sides of a box, whose corner k lies at (k & 1, k & 2, k & 4) of its axes; and its twelve edges. */
const kSides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
const kEdges = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/**
 * The 3-D view in a stage; null where the browser has no WebGL2. `show({...})` takes what has changed of
 *   things  [{id, corners (8), colour, text, dim, moving}]
 *   trails  [{colour, points}]
 *   cloud   {bytes, step, count, place, colour (offsets; colour may be null)}
 *   floorFromCamera (rows), hasFloor, frustum {left, right, top, bottom: tangents}
 * all in the floor's frame but the cloud and the frustum, which are the camera's (x right, y down, z forward).
 */
function makeScene(stage, onPick) {
  const canvas = stage.querySelector('canvas'), layer = stage.querySelector('.marks');
  const wanted = {alpha: false, powerPreference: 'low-power'};
  // Without a graphics processor the view must not take the time that the images need: fewer and coarser pictures.
  const quick = canvas.getContext('webgl2', {...wanted, antialias: true, failIfMajorPerformanceCaveat: true});
  const gl = quick ?? canvas.getContext('webgl2', {...wanted, antialias: false});
  if (!gl) return null;
  const kPause = quick ? 0 : 400;  // ms between two pictures, unless somebody turns the view
  let lines, faces, clouds, grid;
  function begin() {
    lines = program(kLineShader, ['clip', 'size']);
    faces = program(kFaceShader, ['clip']);
    clouds = program(kCloudShader, ['clip', 'floor_from_camera', 'scale', 'has_colour']);
    for (const p of [lines, faces, clouds]) Object.assign(p, {layout: gl.createVertexArray(), buffer: gl.createBuffer()});
    layOutLines(lines);
    gl.bindVertexArray(faces.layout);
    gl.bindBuffer(gl.ARRAY_BUFFER, faces.buffer);
    attribute(0, 3, gl.FLOAT, 16, 0);
    attribute(1, 4, gl.UNSIGNED_BYTE, 16, 12);
    grid = {layout: gl.createVertexArray(), buffer: gl.createBuffer(), count: 0};
    layOutLines(grid);
    const metres = gridLines();
    gl.bufferData(gl.ARRAY_BUFFER, metres.bytes(), gl.STATIC_DRAW);
    grid.count = metres.count;
    shown.isCloudNew = true;
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }
  function program(vertex, uniforms) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, kTintShader]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(gl.getAttachedShaders(made).map((s) => gl.getShaderInfoLog(s)).join(' ') || gl.getProgramInfoLog(made));
    }
    return {made, at: Object.fromEntries(uniforms.map((name) => [name, gl.getUniformLocation(made, name)]))};
  }
  function attribute(index, count, type, step, offset, divisor = 0) {
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, count, type, type === gl.UNSIGNED_BYTE, step, offset);
    gl.vertexAttribDivisor(index, divisor);
  }
  function layOutLines({layout, buffer}) {
    gl.bindVertexArray(layout);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    attribute(0, 3, gl.FLOAT, 32, 0, 1);
    attribute(1, 3, gl.FLOAT, 32, 12, 1);
    attribute(2, 4, gl.UNSIGNED_BYTE, 32, 24, 1);
    attribute(3, 1, gl.FLOAT, 32, 28, 1);
  }

  /** Vertices that grow: `words` 32-bit words each, of which the word at `colourAt` is a colour. */
  function vertices(words, colourAt) {
    let floats = new Float32Array(words * 256), ints = new Uint32Array(floats.buffer), count = 0;
    return {
      add(values, [r, g, b], alpha) {
        if ((count + 1) * words > floats.length) {
          const wider = new Float32Array(floats.length * 2);
          wider.set(floats);
          floats = wider;
          ints = new Uint32Array(floats.buffer);
        }
        floats.set(values, count * words);
        ints[count * words + colourAt] = (Math.round(alpha * 255) << 24 | b << 16 | g << 8 | r) >>> 0;
        ++count;
      },
      clear() { count = 0; },
      get count() { return count; },
      bytes: () => floats.subarray(0, count * words),
    };
  }
  const lineList = vertices(8, 6), faceList = vertices(4, 3);
  const line = (list, a, b, colour, alpha, width) => list.add([a[0], a[1], a[2], b[0], b[1], b[2], 0, width], colour, alpha);

  const kReach = 14;  // m of grid around the camera
  function gridLines() {
    const list = vertices(8, 6), colour = [124, 138, 150];
    const alphaAt = (x, y) => Math.max(0, 1 - Math.hypot(x - 3, y) / (kReach - 3)) ** 1.3 * 0.5;
    for (let a = -kReach; a <= kReach; ++a) {
      for (let b = -kReach; b < kReach; ++b) {
        const strong = a === 0 ? 1.7 : 1;
        const across = alphaAt(a, b + 0.5) * strong, ahead = alphaAt(b + 0.5, a) * strong;
        if (across > 0.01) line(list, [a, b, 0], [a, b + 1, 0], colour, Math.min(1, across), 1);
        if (ahead > 0.01) line(list, [b, a, 0], [b + 1, a, 0], colour, Math.min(1, ahead), 1);
      }
    }
    return list;
  }

  // ---- what is shown, and from where ----

  const shown = {things: [], trails: [], cloud: null, isCloudNew: false, floorFromCamera: null, hasFloor: false, frustum: null};
  const kViews = {behind: {yaw: 0, pitch: 0.52, far: 6.5}, side: {yaw: 1.15, pitch: 0.42, far: 6.5}, above: {yaw: 0, pitch: 1.55, far: 8}};
  const view = {at: [2.6, 0, 0.3], ...kViews.behind, isTouched: false};
  let size = {wide: 0, high: 0, dpr: 1};  // of the canvas
  const room = {wide: 0, high: 0};        // for it
  let asked = 0, paintedAt = 0;
  let grip = null;  // where the pointer holds the view
  const draw = () => { asked ||= requestAnimationFrame(() => { asked = 0; paint(); }); };
  let waits = 0;
  const drawSoon = () => {
    const left = paintedAt + kPause - performance.now();
    if (left <= 0 || grip) draw();
    else waits ||= setTimeout(() => { waits = 0; draw(); }, left);
  };
  const eye = () => minus3(view.at, [
    Math.cos(view.yaw) * Math.cos(view.pitch), Math.sin(view.yaw) * Math.cos(view.pitch), -Math.sin(view.pitch)].map((v) => v * view.far));
  const cameraPlace = () => { const m = shown.floorFromCamera; return m ? [m[3], m[7], m[11]] : [0, 0, 0]; };
  const toFloor = (p) => { const m = shown.floorFromCamera; return [0, 4, 8].map((r) => m[r] * p[0] + m[r + 1] * p[1] + m[r + 2] * p[2] + m[r + 3]); };

  function lookFrom(name) {
    Object.assign(view, kViews[name], {isTouched: false});
    fit();
    draw();
  }
  /** Things seen are in the middle, as long as nobody has turned the view; slowly, so that it stays calm. */
  function fit(share = 1) {
    if (view.isTouched || !shown.things.length) return;
    const ahead = shown.things.map((t) => t.corners[0][0]).sort((a, b) => a - b);
    const reach = Math.min(12, Math.max(2, ahead[Math.floor(ahead.length * 0.9)]));
    view.at[0] += (reach * 0.72 - view.at[0]) * share;
    view.at[1] += (0 - view.at[1]) * share;
    view.far += (Math.max(2.4, reach * 1.02 + 0.5) - view.far) * share;
  }

  function paint() {
    const {wide, high} = room, dpr = Math.min(2, devicePixelRatio || 1) * (quick ? 1 : 0.6);
    paintedAt = performance.now();
    if (!wide || !high || gl.isContextLost()) return;
    if (size.wide !== wide || size.high !== high || size.dpr !== dpr) {
      size = {wide, high, dpr};
      canvas.width = Math.round(wide * dpr);
      canvas.height = Math.round(high * dpr);
    }
    const clip = kMatrix.product(kMatrix.perspective(48, wide / high, 0.05, 200), kMatrix.looking(eye(), view.at));
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.031, 0.035, 0.039, 1);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    if (shown.cloud && shown.floorFromCamera) paintCloud(clip);
    gl.depthMask(false);
    if (shown.hasFloor) paintLines(grid, grid.count, clip);
    gather();
    gl.useProgram(faces.made);
    gl.uniformMatrix4fv(faces.at.clip, false, clip);
    gl.bindVertexArray(faces.layout);
    gl.bindBuffer(gl.ARRAY_BUFFER, faces.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, faceList.bytes(), gl.STREAM_DRAW);
    gl.drawArrays(gl.TRIANGLES, 0, faceList.count);
    gl.disable(gl.DEPTH_TEST);  // edges and trails are seen through the cloud
    gl.bindBuffer(gl.ARRAY_BUFFER, lines.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, lineList.bytes(), gl.STREAM_DRAW);
    paintLines(lines, lineList.count, clip);
    name(clip, wide, high);
  }
  function paintLines({layout}, count, clip) {
    gl.useProgram(lines.made);
    gl.uniformMatrix4fv(lines.at.clip, false, clip);
    gl.uniform2f(lines.at.size, size.wide, size.high);
    gl.bindVertexArray(layout);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }
  function paintCloud(clip) {
    const {bytes, step, count, place, colour} = shown.cloud;
    gl.useProgram(clouds.made);
    gl.uniformMatrix4fv(clouds.at.clip, false, clip);
    gl.uniformMatrix4fv(clouds.at.floor_from_camera, false, kMatrix.ofRows(shown.floorFromCamera));
    gl.uniform1f(clouds.at.scale, canvas.height * 0.022);
    gl.uniform1i(clouds.at.has_colour, colour === null ? 0 : 1);
    gl.bindVertexArray(clouds.layout);
    if (shown.isCloudNew) {
      shown.isCloudNew = false;
      gl.bindBuffer(gl.ARRAY_BUFFER, clouds.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.STREAM_DRAW);
      attribute(0, 3, gl.FLOAT, step, place);
      if (colour === null) gl.disableVertexAttribArray(1);
      else attribute(1, 4, gl.UNSIGNED_BYTE, step, colour);
    }
    gl.drawArrays(gl.POINTS, 0, count);
  }

  /** Boxes, trails and the camera as lines and faces. */
  function gather() {
    lineList.clear();
    faceList.clear();
    for (const {points, colour} of shown.trails) {
      const rgb = bytesOf(colour);
      for (let k = 1; k < points.length; ++k) line(lineList, points[k - 1], points[k], rgb, 0.12 + 0.68 * k / points.length, 2);
    }
    for (const {corners, colour, dim, chosen} of shown.things) {
      const rgb = bytesOf(colour), bright = bytesOf(mixed(colour, '#ffffff', 0.25));
      for (const [a, b, c, d] of kSides) {
        for (const k of [a, b, c, a, c, d]) faceList.add([...corners[k], 0], rgb, dim ? 0.04 : chosen ? 0.34 : 0.16);
      }
      for (const [a, b] of kEdges) line(lineList, corners[a], corners[b], bright, dim ? 0.3 : 1, chosen ? 2.6 : 1.6);
    }
    if (!shown.floorFromCamera) return;
    const white = [232, 236, 239], at = cameraPlace();
    if (shown.frustum) {
      const {left, right, top, bottom} = shown.frustum, z = 0.28;
      const ends = [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => toFloor([x * z, y * z, z]));
      ends.forEach((end, k) => {
        line(lineList, at, end, white, 0.8, 1.3);
        line(lineList, end, ends[(k + 1) % 4], white, 0.8, 1.3);
      });
      // The edges of the view, on the floor.
      if (shown.hasFloor) {
        for (const x of [left, right]) {
          const [p, q] = [0.6, 9].map((far) => { const e = toFloor([x * far, 0, far]); return [e[0], e[1], 0.002]; });
          line(lineList, p, q, white, 0.2, 1);
        }
      }
    }
    if (shown.hasFloor) line(lineList, at, [at[0], at[1], 0], white, 0.35, 1);
  }

  const marksById = new Map();
  /** The names over the boxes, and the metres on the floor. */
  function name(clip, wide, high) {
    const wanted = [];
    const put = (key, text, place, look, colour, isName) => {
      const [x, y, , w] = [0, 1, 2, 3].map((r) => clip[r] * place[0] + clip[4 + r] * place[1] + clip[8 + r] * place[2] + clip[12 + r]);
      if (w < 0.1) return;
      let mark = marksById.get(key);
      if (!mark) {
        marksById.set(key, mark = {node: el('span', {class: 'mark'}), text: null, look: null});
        mark.node.style.setProperty('--colour', colour);
        layer.append(mark.node);
      }
      if (mark.look !== look) mark.node.className = mark.look = look;
      if (mark.text !== text) {
        mark.node.textContent = mark.text = text;
        mark.wide = mark.node.offsetWidth;
      }
      wanted.push(Object.assign(mark, {key, isName, x: (x / w + 1) / 2 * wide, y: (1 - y / w) / 2 * high - (isName ? 13 : 0)}));
    };
    for (const {id, text, corners, colour, dim, moving} of shown.things) {
      const top = corners.reduce((sum, c) => [sum[0] + c[0] / 8, sum[1] + c[1] / 8, Math.max(sum[2], c[2])], [0, 0, -Infinity]);
      put(`t${id}`, text, top, `mark${dim ? ' dim' : ''}${moving ? ' moving' : ''}`, colour, true);
    }
    if (shown.hasFloor) for (const metre of [1, 2, 3, 4, 6, 8, 10]) if (metre < view.far * 1.6) put(`m${metre}`, `${metre} m`, [metre, 0, 0], 'mark metre', '', false);
    // Names that would lie on others move up, the nearest box's the least.
    const placed = [];
    for (const mark of wanted.sort((a, b) => b.isName - a.isName || b.y - a.y)) {
      const hits = (other) => Math.abs(other.x - mark.x) < (other.wide + mark.wide) / 2 + 2 && Math.abs(other.y - mark.y) < 20;
      if (!mark.isName && placed.some(hits)) {
        mark.node.style.visibility = 'hidden';
        continue;
      }
      for (let other = placed.find(hits); mark.isName && other; other = placed.find(hits)) mark.y = other.y - 20.5;
      placed.push(mark);
      mark.node.style.visibility = '';
      mark.node.style.transform = `translate(${mark.x.toFixed(1)}px, ${mark.y.toFixed(1)}px) translate(-50%, -50%)`;
    }
    const kept = new Set(wanted);
    for (const [key, mark] of marksById) {
      if (kept.has(mark)) continue;
      mark.node.remove();
      marksById.delete(key);
    }
  }

  // ---- turning it ----

  stage.addEventListener('pointerdown', (event) => {
    grip = {x: event.clientX, y: event.clientY, moves: event.shiftKey || event.button !== 0, far: 0};
    stage.setPointerCapture(event.pointerId);
    stage.classList.add('turning');
  });
  stage.addEventListener('pointermove', (event) => {
    if (!grip) return;
    const dx = event.clientX - grip.x, dy = event.clientY - grip.y;
    Object.assign(grip, {x: event.clientX, y: event.clientY, far: grip.far + Math.abs(dx) + Math.abs(dy)});
    if (grip.far < 3) return;
    view.isTouched = true;
    if (grip.moves) {
      const step = view.far / (stage.clientHeight || 1), c = Math.cos(view.yaw), s = Math.sin(view.yaw);
      view.at[0] += (c * dy - s * dx) * step;
      view.at[1] += (s * dy + c * dx) * step;
    } else {
      view.yaw -= dx * 0.008;
      view.pitch = Math.min(1.55, Math.max(-0.2, view.pitch + dy * 0.006));
    }
    draw();
  });
  for (const kind of ['pointerup', 'pointercancel']) {
    stage.addEventListener(kind, (event) => {
      stage.classList.remove('turning');
      if (grip && grip.far < 3 && kind === 'pointerup') onPick(thingAt(event));
      grip = null;
    });
  }
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    view.isTouched = true;
    view.far = Math.min(60, Math.max(0.6, view.far * Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0012))));
    draw();
  }, {passive: false});
  stage.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('keydown', (event) => {
    const turn = {ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08]}[event.key];
    if (!turn) return;
    event.preventDefault();
    event.stopPropagation();
    view.isTouched = true;
    view.yaw += turn[0];
    view.pitch = Math.min(1.55, Math.max(-0.2, view.pitch + turn[1]));
    draw();
  });
  /** The id of the nearest box under the pointer; null beside all. */
  function thingAt(event) {
    const box = stage.getBoundingClientRect(), wide = box.width, high = box.height;
    const clip = kMatrix.product(kMatrix.perspective(48, wide / high, 0.05, 200), kMatrix.looking(eye(), view.at));
    let best = null;
    for (const {id, corners} of shown.things) {
      const ends = corners.map((p) => {
        const [x, y, , w] = [0, 1, 2, 3].map((r) => clip[r] * p[0] + clip[4 + r] * p[1] + clip[8 + r] * p[2] + clip[12 + r]);
        return [(x / w + 1) / 2 * wide + box.left, (1 - y / w) / 2 * high + box.top, w];
      });
      const over = (k, v) => Math.min(...ends.map((e) => e[k])) - 4 <= v && v <= Math.max(...ends.map((e) => e[k])) + 4;
      const far = Math.min(...ends.map((e) => e[2]));
      if (far > 0 && over(0, event.clientX) && over(1, event.clientY) && (!best || far < best.far)) best = {id, far};
    }
    return best?.id ?? null;
  }

  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => { begin(); draw(); });
  new ResizeObserver(([{contentRect}]) => {
    Object.assign(room, {wide: contentRect.width, high: contentRect.height});
    draw();
  }).observe(stage);
  begin();
  return {
    show(what) {
      Object.assign(shown, what);
      if (what.cloud) shown.isCloudNew = true;
      if (what.things) fit(0.05);
      drawSoon();
    },
    lookFrom,
  };
}
