// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The 3-D view of `cairn live --view`. Its frame is the floor's below the camera: x forward, y left, z up (ROS REP
// 103), in m. It follows shared.js and precedes live.js in one <script>. It is drawn with the 2-D canvas: some boxes,
// lines and a thinned cloud take a millisecond, whereas WebGL without a GPU takes 30, if the browser has it at all.

/** The linear algebra that a camera needs; column-major matrices. */
const kMatrix = {
  product(a, b) {
    const out = new Float64Array(16);
    for (let c = 0; c < 4; ++c) for (let r = 0; r < 4; ++r) for (let k = 0; k < 4; ++k) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    return out;
  },
  perspective(degrees, aspect) {
    const f = 1 / Math.tan(degrees * Math.PI / 360);
    return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, -1, -1, 0, 0, 0, 0];  // depths are not used
  },
  looking(eye, at) {
    const away = unit3(minus3(eye, at)), right = unit3(cross3([0, 0, 1], away)), up = cross3(away, right);
    const back = (axis) => -dot3(axis, eye);
    return [right[0], up[0], away[0], 0, right[1], up[1], away[1], 0, right[2], up[2], away[2], 0, back(right), back(up), back(away), 1];
  },
  /** From row-major 3×4 or 4×4. */
  ofRows: (m) => [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, m[3], m[7], m[11], 1],
};
const minus3 = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross3 = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit3 = (a) => a.map((v) => v / (Math.hypot(...a) || 1));

/** The six sides of a box, whose corner k lies at (k & 1, k & 2, k & 4) of its axes; and its twelve edges. */
const kSides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
const kEdges = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/**
 * The 3-D view in a stage. `refresh()` draws it with the screen's next repaint, `paintWithOthers()` in the current
 * one if it is due; `look()` returns its content:
 *   things  [{id, corners (8), colour, text, chosen, dim, moving}]
 *   trails  [{colour, points}]
 *   cloud   {bytes, step, count, place, colour (offsets; colour may be null)}, or null
 *   floorFromCamera (rows), hasFloor, frustum {left, right, top, bottom: tangents; or null}
 * all in the floor's frame but the cloud and the frustum, which are the camera's (x right, y down, z forward).
 */
function makeScene(stage, look, onPick) {
  const canvas = stage.querySelector('canvas'), context = canvas.getContext('2d', {alpha: false});
  const kNear = 0.05;  // m in front of the eye
  // A repaint waits for this multiple of the last one's duration, but at most this many ms: the images have priority.
  const kShare = 40, kLongest = 400;

  // ---- what is shown, and from where ----

  let shown = {things: [], trails: [], cloud: null, floorFromCamera: null, hasFloor: false, frustum: null};
  const kViews = {behind: {yaw: 0, pitch: 0.52, far: 6.5}, side: {yaw: 1.15, pitch: 0.42, far: 6.5}, above: {yaw: 0, pitch: 1.55, far: 8}};
  const view = {at: [2.6, 0, 0.3], ...kViews.behind, isTouched: false, reach: 0};
  let size = {wide: 0, high: 0, dpr: 1};  // of the canvas
  const room = {wide: 0, high: 0};        // available to it
  let clip = new Float64Array(16);        // from the floor's frame to the screen, of the last repaint
  let asked = 0, waits = 0, pause = 0, paintedAt = -Infinity;
  let grip = null;  // where the pointer holds the view
  const draw = () => { asked ||= requestAnimationFrame(() => { asked = 0; paint(); }); };
  /** Draws in the current repaint of the page, or in the next if the last one is too recent. */
  function paintWithOthers() {
    if (asked) return;  // an individual repaint is already due
    if (grip || performance.now() - paintedAt >= pause) paint();
    else waits ||= setTimeout(draw, pause + 100);
  }
  const eye = () => minus3(view.at, [
    Math.cos(view.yaw) * Math.cos(view.pitch), Math.sin(view.yaw) * Math.cos(view.pitch), -Math.sin(view.pitch)].map((v) => v * view.far));
  const cameraPlace = () => { const m = shown.floorFromCamera; return [m[3], m[7], m[11]]; };
  const toFloor = (p) => moved(shown.floorFromCamera, p);

  function lookFrom(name) {
    Object.assign(view, kViews[name], {isTouched: false});
    fit(1);
    draw();
  }
  /** Centres the visible objects until the user turns the view; slowly and not for small changes, so that it stays
      calm. */
  function fit(share) {
    if (view.isTouched || !shown.things.length) return;
    const ahead = shown.things.map((t) => t.corners[0][0]).sort((a, b) => a - b);
    const reach = Math.min(12, Math.max(2, ahead[Math.floor(ahead.length * 0.9)]));
    if (share === 1 || Math.abs(reach - view.reach) > 0.1 * view.reach) view.reach = reach;
    const to = (from, goal) => (Math.abs(goal - from) < 0.02 ? goal : from + (goal - from) * share);
    view.at[0] = to(view.at[0], view.reach * 0.72);
    view.at[1] = to(view.at[1], 0);
    view.far = to(view.far, Math.max(2.4, view.reach * 1.02 + 0.5));
  }

  // ---- places on the screen ----

  /** Projects a point of the floor's frame: x·w, y·w, and w, its depth in front of the eye. */
  const project = ([x, y, z]) => [0, 1, 3].map((r) => clip[r] * x + clip[4 + r] * y + clip[8 + r] * z + clip[12 + r]);
  const onScreen = ([x, y, w]) => [(x / w + 1) / 2 * size.wide, (1 - y / w) / 2 * size.high];
  /** Lines, batched by style: one stroke for each line would take longer than for all. */
  function pen() {
    const looks = new Map(), kAlphas = 24;
    return {
      line(from, to, colour, alpha, width) {
        let a = project(from), b = project(to);
        if (a[2] < kNear && b[2] < kNear) return;
        // Parts behind the eye are clipped before projection.
        const cut = (p, q) => p.map((v, k) => v + (q[k] - v) * (p[2] - kNear) / (p[2] - q[2]));
        if (a[2] < kNear) a = cut(b, a);
        else if (b[2] < kNear) b = cut(a, b);
        const share = Math.ceil(Math.min(1, alpha) * kAlphas) / kAlphas, key = `${colour} ${share} ${width}`;
        let look = looks.get(key);
        if (!look) looks.set(key, look = {path: new Path2D(), colour, share, width});
        look.path.moveTo(...onScreen(a));
        look.path.lineTo(...onScreen(b));
      },
      draw(to) {
        for (const {path, colour, share, width} of looks.values()) {
          Object.assign(to, {strokeStyle: colour, globalAlpha: share, lineWidth: width});
          to.stroke(path);
        }
        to.globalAlpha = 1;
      },
    };
  }

  function paint() {
    const {wide, high} = room, dpr = Math.min(2, devicePixelRatio || 1), begun = performance.now();
    paintedAt = begun;
    clearTimeout(waits);
    waits = 0;
    if (!wide || !high) return;
    if (size.wide !== wide || size.high !== high || size.dpr !== dpr) {
      size = {wide, high, dpr};
      canvas.width = Math.round(wide * dpr);
      canvas.height = Math.round(high * dpr);
    }
    const found = look();
    if (found) {
      shown = found;
      fit(view.reach ? 0.1 : 1);
    }
    clip = kMatrix.product(kMatrix.perspective(48, wide / high), kMatrix.looking(eye(), view.at));
    const places = () => context.setTransform(dpr, 0, 0, dpr, 0, 0), pixels = () => context.setTransform(1, 0, 0, 1, 0, 0);
    pixels();
    context.drawImage(floorPicture(), 0, 0);
    // Points in a box lie between its sides.
    places();
    paintSides((towardsEye) => towardsEye <= 0);
    pixels();
    if (shown.cloud && shown.floorFromCamera) paintCloud(shown.cloud);
    places();
    paintSides((towardsEye) => towardsEye > 0);
    paintLines();
    if (shown.floorFromCamera) paintCamera();
    paintNames();
    pause = Math.min(kLongest, kShare * (performance.now() - begun));
  }

  const kReach = 14;  // m of grid around the camera
  const floor = {canvas: document.createElement('canvas'), key: ''};
  /** The background of the view; it changes with the view only. */
  function floorPicture() {
    const {width, height} = canvas, key = [...clip, width, height, shown.hasFloor].join();
    if (key === floor.key) return floor.canvas;
    floor.key = key;
    Object.assign(floor.canvas, {width, height});
    const picture = floor.canvas.getContext('2d', {alpha: false}), lines = pen();
    picture.fillStyle = '#08090a';
    picture.fillRect(0, 0, width, height);
    if (!shown.hasFloor) return floor.canvas;
    const alphaAt = (x, y) => Math.max(0, 1 - Math.hypot(x - 3, y) / (kReach - 3)) ** 1.3 * 0.5;
    for (let a = -kReach; a <= kReach; ++a) {
      for (let b = -kReach; b < kReach; ++b) {
        const strong = a === 0 ? 1.7 : 1;
        const across = alphaAt(a, b + 0.5) * strong, ahead = alphaAt(b + 0.5, a) * strong;
        if (across > 0.01) lines.line([a, b, 0], [a, b + 1, 0], '#7c8a96', across, 1);
        if (ahead > 0.01) lines.line([b, a, 0], [b + 1, a, 0], '#7c8a96', ahead, 1);
      }
    }
    picture.scale(size.dpr, size.dpr);
    lines.draw(picture);
    return floor.canvas;
  }

  const kMostPixels = 2e6;  // of the point image, at the canvas's resolution up to this limit
  const points = {canvas: document.createElement('canvas'), image: null, pixels: null, depths: null};
  /** A PointCloud2 as received. Points without colour are coloured by their height above the floor. */
  function paintCloud({bytes, step, count, place, colour}) {
    const share = Math.min(1, Math.sqrt(kMostPixels / (canvas.width * canvas.height)));
    const width = Math.max(1, Math.round(canvas.width * share)), height = Math.max(1, Math.round(canvas.height * share));
    const picture = points.canvas.getContext('2d');
    if (points.image?.width !== width || points.image.height !== height) {
      Object.assign(points.canvas, {width, height});
      points.image = picture.createImageData(width, height);
      points.pixels = new Uint32Array(points.image.data.buffer);
      points.depths = new Float32Array(width * height);
    }
    const {pixels, depths} = points, m = kMatrix.product(clip, kMatrix.ofRows(shown.floorFromCamera)), up = shown.floorFromCamera.slice(8, 12);
    pixels.fill(0);
    depths.fill(Infinity);
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), scale = height * 0.022;
    for (let k = 0, at = place; k < count; ++k, at += step) {
      const x = view.getFloat32(at, true), y = view.getFloat32(at + 4, true), z = view.getFloat32(at + 8, true);
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (!(w > kNear)) continue;
      const half = Math.min(7, Math.max(1.5, scale / w)) / 2;
      const right = ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) / 2 * width, down = (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2 * height;
      const x0 = Math.max(0, Math.ceil(right - half - 0.5)), x1 = Math.min(width, Math.ceil(right + half - 0.5));
      const y0 = Math.max(0, Math.ceil(down - half - 0.5)), y1 = Math.min(height, Math.ceil(down + half - 0.5));
      if (x0 >= x1 || y0 >= y1) continue;
      let red, green, blue;
      if (colour === null) {
        const high = Math.min(1, Math.max(0, (up[0] * x + up[1] * y + up[2] * z + up[3]) / 1.5));
        [red, green, blue] = [64 + 178 * high, 140 + 44 * high, 158 - 69 * high];
      } else {
        const first = at - place + colour;
        [red, green, blue] = [bytes[first + 2] * 0.88 + 23, bytes[first + 1] * 0.88 + 23, bytes[first] * 0.88 + 23];
      }
      const tint = (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
      for (let row = y0; row < y1; ++row) {
        for (let i = row * width + x0, end = row * width + x1; i < end; ++i) {
          if (depths[i] <= w) continue;
          depths[i] = w;
          pixels[i] = tint;
        }
      }
    }
    picture.putImageData(points.image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(points.canvas, 0, 0, canvas.width, canvas.height);
  }

  const middle = (places) => [0, 1, 2].map((k) => places.reduce((sum, p) => sum + p[k], 0) / places.length);
  /** The sides of the boxes for which `isWanted` is true, by how far they face the eye. */
  function paintSides(isWanted) {
    const from = eye();
    for (const {corners, colour, dim, chosen} of shown.things) {
      const ends = corners.map(project), centre = middle(corners);
      context.fillStyle = colour;
      context.globalAlpha = dim ? 0.04 : chosen ? 0.34 : 0.16;
      for (const side of kSides) {
        const here = middle(side.map((k) => corners[k]));
        if (!isWanted(dot3(minus3(here, centre), minus3(from, here))) || side.some((k) => ends[k][2] < kNear)) continue;
        context.beginPath();
        for (const k of side) context.lineTo(...onScreen(ends[k]));
        context.fill();
      }
    }
    context.globalAlpha = 1;
  }
  /** Trails and edges, visible through the cloud. */
  function paintLines() {
    const lines = pen();
    for (const {points: way, colour} of shown.trails) {
      for (let k = 1; k < way.length; ++k) lines.line(way[k - 1], way[k], colour, 0.12 + 0.68 * k / way.length, 2);
    }
    for (const {corners, colour, dim, chosen} of shown.things) {
      const bright = mixed(colour, '#ffffff', 0.25);
      for (const [a, b] of kEdges) lines.line(corners[a], corners[b], bright, dim ? 0.3 : 1, chosen ? 2.6 : 1.6);
    }
    lines.draw(context);
  }
  function paintCamera() {
    const lines = pen(), white = '#e8ecef', at = cameraPlace();
    if (shown.frustum) {
      const {left, right, top, bottom} = shown.frustum, z = 0.28;
      const ends = [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => toFloor([x * z, y * z, z]));
      ends.forEach((end, k) => {
        lines.line(at, end, white, 0.8, 1.3);
        lines.line(end, ends[(k + 1) % 4], white, 0.8, 1.3);
      });
      // The outline of the field of view on the floor.
      if (shown.hasFloor) {
        for (const x of [left, right]) {
          const [p, q] = [0.6, 9].map((far) => { const e = toFloor([x * far, 0, far]); return [e[0], e[1], 0.002]; });
          lines.line(p, q, white, 0.2, 1);
        }
      }
    }
    if (shown.hasFloor) lines.line(at, [at[0], at[1], 0], white, 0.35, 1);
    lines.draw(context);
  }

  const family = getComputedStyle(stage).fontFamily;
  const fonts = {name: `600 12px ${family}`, metre: `400 11px ${family}`};
  const widths = new Map();  // font and text → px
  function widthOf(text, font) {
    const key = font + text;
    let wide = widths.get(key);
    if (wide === undefined) {
      if (widths.size > 500) widths.clear();
      context.font = font;
      widths.set(key, wide = context.measureText(text).width);
    }
    return wide;
  }
  function box(left, top, wide, high, round) {
    context.beginPath();
    context.roundRect(left, top, wide, high, round);
  }
  /** The names above the boxes, and the distance marks on the floor. */
  function paintNames() {
    const wanted = [];
    const put = (text, place, isName, thing) => {
      const end = project(place);
      if (end[2] < 0.1) return;
      const [x, y] = onScreen(end), font = isName ? fonts.name : fonts.metre, padding = isName ? 14 : 0;
      wanted.push({text, isName, x, y: y - (isName ? 13 : 0), font, wide: widthOf(text, font) + padding, thing});
    };
    for (const thing of shown.things) {
      const top = thing.corners.reduce((sum, c) => [sum[0] + c[0] / 8, sum[1] + c[1] / 8, Math.max(sum[2], c[2])], [0, 0, -Infinity]);
      put(thing.moving ? `${thing.text} ➜` : thing.text, top, true, thing);
    }
    if (shown.hasFloor) for (const metre of [1, 2, 3, 4, 6, 8, 10]) if (metre < view.far * 1.6) put(`${metre} m`, [metre, 0, 0], false, null);
    // Overlapping names move up, that of the nearest box least.
    const placed = [];
    context.textBaseline = 'middle';
    for (const mark of wanted.sort((a, b) => b.isName - a.isName || b.y - a.y)) {
      const hits = (other) => Math.abs(other.x - mark.x) < (other.wide + mark.wide) / 2 + 2 && Math.abs(other.y - mark.y) < 20;
      if (!mark.isName && placed.some(hits)) continue;
      for (let other = placed.find(hits); mark.isName && other; other = placed.find(hits)) mark.y = other.y - 20.5;
      placed.push(mark);
      const {text, font, wide, thing} = mark, left = Math.round(mark.x - wide / 2), y = Math.round(mark.y);
      context.font = font;
      if (!thing) {
        context.fillStyle = '#6d757e';
        context.fillText(text, left, y + 0.5);
        continue;
      }
      context.globalAlpha = thing.dim ? 0.3 : 1;
      box(left, y - 9, wide, 18, 3);
      context.fillStyle = 'rgba(8, 9, 10, .6)';
      context.fill();
      box(left, y - 9, 3, 18, [3, 0, 0, 3]);
      context.fillStyle = thing.colour;
      context.fill();
      if (thing.moving) {
        box(left - 0.5, y - 9.5, wide + 1, 19, 3.5);
        Object.assign(context, {strokeStyle: '#fff', lineWidth: 1});
        context.stroke();
      }
      context.fillStyle = '#fff';
      context.fillText(text, left + 8, y + 0.5);
      context.globalAlpha = 1;
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
  /** The id of the nearest box under the pointer, or null. */
  function thingAt(event) {
    const box = stage.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    let best = null;
    for (const {id, corners} of shown.things) {
      const ends = corners.map(project), places = ends.map(onScreen);
      const over = (k, v) => Math.min(...places.map((p) => p[k])) - 4 <= v && v <= Math.max(...places.map((p) => p[k])) + 4;
      const far = Math.min(...ends.map((e) => e[2]));
      if (far > 0 && over(0, x) && over(1, y) && (!best || far < best.far)) best = {id, far};
    }
    return best?.id ?? null;
  }

  new ResizeObserver(([{contentRect}]) => {
    Object.assign(room, {wide: contentRect.width, high: contentRect.height});
    draw();
  }).observe(stage);
  return {refresh: draw, paintWithOthers, lookFrom};
}
