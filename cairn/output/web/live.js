// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The page of `cairn live --view`: an ordinary client of the Foxglove WebSocket protocol, on the host and port that
// served the page. Messages are ROS 2's in CDR, and JSON. It follows shared.js and live_scene.js in one <script>.
(() => {
  // ---- the connection ----

  const kTopics = ['left', 'labels', 'reject', 'disparity', 'obstacles', 'stats'];
  const kSilence = 3000;  // ms without a frame before a notice is shown
  const kLongestWait = 5000;  // ms between attempts to connect
  const link = {
    socket: null, state: 'connecting', attempt: 0, retryAt: 0, since: performance.now(), refused: false,
    channels: new Map(),       // topic → id of its channel
    subscriptions: new Map(),  // id of a subscription → topic
    last: 0,                   // the last id assigned
  };

  function connect() {
    link.retryAt = 0;
    let socket;
    try {
      socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/`, ['cairn.v1']);
    } catch {
      return retry();
    }
    socket.binaryType = 'arraybuffer';
    link.socket = socket;
    link.channels.clear();
    link.subscriptions.clear();
    frames.clear();
    Object.assign(latest, {picture: -1n, disparity: -1n});  // stamps of another run may be earlier
    socket.onopen = () => {
      Object.assign(link, {state: 'open', attempt: 0, refused: false, since: performance.now()});
      send({op: 'subscribeParameterUpdates', parameterNames: []});
      loadOptions();
      watch();
    };
    socket.onmessage = ({data}) => {
      if (link.socket !== socket) return;
      if (typeof data === 'string') hear(data);
      else receive(data);
    };
    socket.onclose = () => { if (link.socket === socket) retry(); };
  }
  async function retry() {
    if (link.state !== 'gone') link.since = performance.now();
    Object.assign(link, {socket: null, state: 'gone'});
    const wait = Math.min(kLongestWait, 500 * 2 ** link.attempt++);
    link.retryAt = performance.now() + wait;
    setTimeout(connect, wait);
    watch();
    // A running server that refuses was restarted, with another token.
    const answer = await fetch('/options.json', {cache: 'no-store'}).catch(() => null);
    link.refused = answer?.status === 401 || answer?.status === 403;
    watch();
  }
  function send(message) {
    if (link.socket?.readyState === WebSocket.OPEN) link.socket.send(JSON.stringify(message));
  }

  function hear(text) {
    let message;
    try {
      message = JSON.parse(text);
    } catch {
      return;
    }
    switch (message.op) {
      case 'serverInfo': return nameSource(message.name);
      case 'advertise':
        for (const {id, topic} of message.channels ?? []) link.channels.set(String(topic).replace(/^\/cairn\//, ''), id);
        return subscribe();
      case 'unadvertise':
        for (const [topic, id] of link.channels) if (message.channelIds?.includes(id)) link.channels.delete(topic);
        for (const [id, topic] of link.subscriptions) if (!link.channels.has(topic)) link.subscriptions.delete(id);
        return;
      case 'status': return said(Number(message.level), String(message.message ?? ''));
      case 'parameterValues': return heardParameters(message.parameters ?? []);
      default:
    }
  }

  // A panel out of view costs nothing: neither the robot's time nor bandwidth.
  const inView = new Map();  // panel → whether it is in view
  const needs = () => {
    const visible = document.visibilityState === 'visible';
    const sees = (panel) => visible && inView.get(panel) !== false;
    const wanted = new Set(['stats']);
    if (sees('picture')) wanted.add('left').add('labels');
    if (sees('disparity')) wanted.add('disparity').add('reject');
    if (sees('scene')) wanted.add('obstacles');
    return wanted;
  };
  function subscribe() {
    const wanted = needs();
    const gone = [...link.subscriptions].filter(([, topic]) => !wanted.has(topic)).map(([id]) => id);
    for (const id of gone) link.subscriptions.delete(id);
    if (gone.length) send({op: 'unsubscribe', subscriptionIds: gone});
    const have = new Set(link.subscriptions.values()), added = [];
    for (const topic of wanted) {
      if (have.has(topic) || !link.channels.has(topic)) continue;
      link.subscriptions.set(++link.last, topic);
      added.push({id: link.last, channelId: link.channels.get(topic)});
    }
    if (added.length) send({op: 'subscribe', subscriptions: added});
  }

  // ---- messages ----

  /** Reads CDR (XCDR1, little endian); alignment is relative to the end of the 4-byte encapsulation header. */
  class Cdr {
    constructor(buffer, offset) {
      this.view = new DataView(buffer, offset + 4);
      this.at = 0;
      if (new DataView(buffer, offset).getUint8(1) !== 1) throw new Error('not little-endian CDR');
    }
    u8() { return this.view.getUint8(this.at++); }
    u32() {
      this.at = (this.at + 3) & ~3;
      this.at += 4;
      return this.view.getUint32(this.at - 4, true);
    }
    bytes() {
      const count = this.u32(), start = this.view.byteOffset + this.at;
      if (this.at + count > this.view.byteLength) throw new Error('truncated message');
      this.at += count;
      return new Uint8Array(this.view.buffer, start, count);
    }
    text() { return kText.decode(this.bytes()).replace(/\0$/, ''); }
    header() {
      this.u32();
      this.u32();
      this.text();
    }
  }
  const kText = new TextDecoder();

  function compressedImage(cdr) {
    cdr.header();
    return {format: cdr.text(), bytes: cdr.bytes()};
  }
  /** An Image of one channel as numbers, without padding. */
  function plainImage(cdr) {
    cdr.header();
    const height = cdr.u32(), width = cdr.u32(), encoding = cdr.text();
    cdr.u8();
    const step = cdr.u32(), bytes = cdr.bytes(), each = encoding === 'mono16' || encoding === '16UC1' ? 2 : 1;
    const Numbers = each === 2 ? Uint16Array : Uint8Array;
    if (step * height > bytes.length || width * each > step) throw new Error('truncated image');
    if (step === each * width && each === 1) return {width, height, values: bytes.subarray(0, step * height)};
    // A copy, because the received bytes are not aligned.
    if (step === width * each) return {width, height, values: new Numbers(bytes.slice(0, step * height).buffer)};
    const tight = new Uint8Array(width * height * each);
    for (let y = 0; y < height; ++y) tight.set(bytes.subarray(y * step, y * step + width * each), y * width * each);
    return {width, height, values: new Numbers(tight.buffer)};
  }
  function pointCloud(cdr) {
    cdr.header();
    const height = cdr.u32(), width = cdr.u32(), fields = new Map();
    for (let left = cdr.u32(); left > 0; --left) {
      const name = cdr.text();
      fields.set(name, cdr.u32());
      cdr.u8();
      cdr.u32();
    }
    cdr.u8();
    const step = cdr.u32();
    cdr.u32();
    const bytes = cdr.bytes(), place = fields.get('x');
    if (place === undefined || fields.get('y') !== place + 4 || fields.get('z') !== place + 8) throw new Error('points without x, y, z');
    return {bytes, step, count: Math.min(width * height, step ? Math.floor(bytes.length / step) : 0), place, colour: fields.get('rgb') ?? null};
  }

  // Messages of one frame have the same stamp. A few frames are kept, because `left` is decoded after the rest has
  // arrived; parts shown together have the same stamp.
  const kKept = 6;
  const kPanelOf = {left: 'picture', labels: 'picture', disparity: 'disparity', reject: 'disparity'};
  const frames = new Map();  // stamp → {stamp, at, and the message of each topic}
  const latest = {picture: -1n, disparity: -1n};  // the stamp drawn last, or about to be drawn
  let decoding = 0;

  function receive(buffer) {
    const head = new DataView(buffer);
    if (buffer.byteLength < 13 || head.getUint8(0) !== 1) return;
    const topic = link.subscriptions.get(head.getUint32(1, true));
    if (!topic) return;
    const stamp = head.getBigUint64(5, true);
    try {
      if (topic === 'stats') {
        const stats = JSON.parse(kText.decode(new Uint8Array(buffer, 13)));
        heardStats(stats, stamp);
        return put(topic, stats, stamp);
      }
      const cdr = new Cdr(buffer, 13);
      if (topic === 'left') return void decode(compressedImage(cdr), stamp);
      put(topic, topic === 'obstacles' ? pointCloud(cdr) : plainImage(cdr), stamp);
    } catch (error) {
      said(2, `/cairn/${topic}: ${error.message}`);
    }
  }
  async function decode({format, bytes}, stamp) {
    const frame = frameOf(stamp);
    if (decoding > 2) return;  // this browser is too slow: skip a frame
    ++decoding;
    try {
      put('left', await createImageBitmap(new Blob([bytes], {type: format.includes('png') ? 'image/png' : 'image/jpeg'})), frame.stamp);
    } catch {
      said(2, '/cairn/left: cannot decode an image');
    } finally {
      --decoding;
    }
  }
  function frameOf(stamp) {
    let frame = frames.get(stamp);
    if (!frame) {
      frames.set(stamp, frame = {stamp, at: performance.now()});
      if (frames.size > kKept) {
        const oldest = frames.keys().next().value;
        frames.get(oldest).left?.close();
        frames.delete(oldest);
      }
    }
    return frame;
  }
  function put(topic, value, stamp) {
    const frame = frameOf(stamp);
    frame[topic] = value;
    const panel = kPanelOf[topic];
    if (topic === 'obstacles') newest.cloud = value;
    if (panel) putInPanel(panel, frame);
    // Each repaint is costly for the browser, however small: all parts of a frame are drawn together.
    if ([...link.subscriptions.values()].every((name) => frame[name])) drawNow();
    else drawsSoon ||= setTimeout(drawNow, kTogether);
  }
  function putInPanel(panel, frame) {
    const pair = panel === 'picture' ? ['left', 'labels'] : ['disparity', 'reject'];
    const isWhole = pair.every((name) => frame[name]);
    // Labels may be missing if they were subscribed to later; then show the image without them.
    const isLate = panel === 'picture' && frame.left && performance.now() - (drawnAt.picture ?? link.since) > 400;
    if (!isWhole && !isLate) return;
    if (frame.stamp < latest[panel]) return;  // its image was decoded late
    latest[panel] = frame.stamp;
    due[panel] = frame;
  }

  // ---- painting at the screen's pace ----

  const due = {}, drawnAt = {};
  const newest = {cloud: null, stats: null, source: null};  // source: requested since the last frame
  const shown = {};  // what is on the screen: {picture: frame, disparity: frame}
  const kReading = 200;  // ms
  let readAt = 0;
  const kTogether = 40;  // ms to wait for the other parts of a frame; some never come, such as images that this browser is too slow to decode
  let asked = 0, drawsSoon = 0;
  function drawNow() {
    clearTimeout(drawsSoon);
    drawsSoon = 0;
    asked ||= requestAnimationFrame(() => {
      asked = 0;
      if (due.picture) paintPicture(due.picture);
      if (due.disparity) paintDisparity(due.disparity);
      due.picture = due.disparity = null;
      if (inView.get('scene') !== false) scene.paintWithOthers();
      if (performance.now() - readAt >= kReading) slowly();
    });
  }
  /** Time from the arrival of a frame's first message until it is drawn; for measurements. */
  const cairnStats = window.cairnStats = {computed: 0, received: 0, drawn: 0, p50_ms: 0, p95_ms: 0};  // computed: by the robot
  const delays = [];
  const drawnTimes = [];
  function count(frame) {
    const now = performance.now();
    delays.push(now - frame.at);
    if (delays.length > 300) delays.shift();
    drawnTimes.push(now);
    if (drawnTimes.length > 60) drawnTimes.shift();
    ++cairnStats.drawn;
    if (cairnStats.drawn > 10 && cairnStats.drawn % 10) return;
    const sorted = [...delays].sort((a, b) => a - b);
    cairnStats.p50_ms = sorted[Math.floor(sorted.length * 0.5)];
    cairnStats.p95_ms = sorted[Math.floor(sorted.length * 0.95)];
  }
  const drawnRate = () => {
    const recent = drawnTimes.filter((t) => performance.now() - t < 2000);
    return recent.length < 2 ? 0 : 1000 * (recent.length - 1) / (recent.at(-1) - recent[0]);
  };

  const panels = Object.fromEntries(['picture', 'scene', 'disparity'].map((name) => {
    const root = document.querySelector(`[data-panel="${name}"]`);
    return [name, {
      root, stage: root.querySelector('.stage'), screen: root.querySelector('.screen'), count: root.querySelector('.count'),
      canvases: [...root.querySelectorAll('canvas')], marks: root.querySelector('.marks'),
    }];
  }));
  // Cached, because querying them triggers a layout each time.
  const sizes = new Map();  // element → size on the screen
  const measured = new ResizeObserver((entries) => {
    for (const {target, contentRect} of entries) sizes.set(target, {wide: contentRect.width, high: contentRect.height});
    stripIsOld = true;
    if (shown.picture?.labels) placeMarks(shown.picture.labels);
  });
  /** A bitmap as large as a canvas, with pixels as integers. */
  function buffers(canvas) {
    let image = null, context = null, pixels = null;
    return {
      sized(width, height) {
        if (canvas.width !== width || canvas.height !== height || !image) {
          [canvas.width, canvas.height] = [width, height];
          context = canvas.getContext('2d');
          image = context.createImageData(width, height);
          pixels = new Uint32Array(image.data.buffer);
        }
        return pixels;
      },
      put: () => context.putImageData(image, 0, 0),
    };
  }
  /** Does nothing if the text is unchanged, to avoid a layout. */
  function write(node, text) {
    if (node.textContent !== text) node.textContent = text;
  }
  function shape(screen, width, height) {
    screen.style.setProperty('--aspect', `${width} / ${height}`);
    screen.style.setProperty('--ratio', String(width / height));
  }

  // ---- what is chosen ----

  const state = {
    near: null,     // the track under the pointer
    picked: null,   // the track that was clicked
    reason: null,   // the bit of the reason that blinks
    phase: false,   // of blinking
    overlay: kept('overlay', 'masks'),
    isPaused: false,
    pausedAt: -Infinity,  // when it was requested here
  };
  const chosen = () => state.near ?? state.picked;
  function kept(name, otherwise) {
    try {
      return localStorage.getItem(`cairn.${name}`) ?? otherwise;
    } catch {
      return otherwise;
    }
  }
  function keep(name, value) {
    try {
      localStorage.setItem(`cairn.${name}`, value);
    } catch { /* a browser without storage */ }
  }
  function pick(id) {
    state.picked = id === state.picked ? null : id;
    showChosen();
    selectRow('things', state.picked);
  }
  function near(id) {
    if (state.near === id) return;
    state.near = id;
    showChosen();
    markRow('things', id);
  }
  function showChosen() {
    if (shown.picture) paintPicture(shown.picture, true);
    scene.refresh();
  }

  // ---- the left image ----

  const kOverlays = ['masks', 'outlines', 'none'];
  const overlay = buffers(panels.picture.canvases[1]);
  const pictureMarks = new Map();  // track → {node, x, y}
  function paintPicture(frame, again = false) {
    const {canvases: [photo], screen} = panels.picture;
    const before = shown.picture;
    if (frame.left?.width) {  // a closed bitmap has none
      const {width, height} = frame.left;
      if (photo.width !== width || photo.height !== height) {
        [photo.width, photo.height] = [width, height];
        shape(screen, width, height);
      }
      if (!again) photo.getContext('2d', {alpha: false}).drawImage(frame.left, 0, 0);
    }
    const labels = frame.labels;
    if (labels) {
      const {width, height, values} = labels;
      const pixels = overlay.sized(width, height);
      if (state.overlay === 'none') pixels.fill(0);
      else paintLabels(pixels, values, width, idColour, chosen(), state.overlay === 'outlines');
      overlay.put();
      if (!again || state.overlay === 'none') placeMarks(labels);
      else dimMarks();
    }
    if (again) return;
    if (before && before !== frame && before.left && !frames.has(before.stamp)) before.left.close();
    shown.picture = frame;
    drawnAt.picture = performance.now();
    if (!frame.isCounted) count(frame);
    frame.isCounted = true;  // messages repeat when subscriptions change
  }

  /** The centroid of each label, from every fourth pixel. */
  function middles({width, height, values}) {
    const all = new Map();
    for (let y = 1; y < height; y += 2) {
      for (let x = 1, i = y * width + 1; x < width; x += 2, i += 2) {
        const id = values[i];
        if (!id) continue;
        let sums = all.get(id);
        if (!sums) all.set(id, sums = {x: 0, y: 0, n: 0});
        sums.x += x;
        sums.y += y;
        ++sums.n;
      }
    }
    return all;
  }
  const markText = (id) => {
    const thing = thingsById.get(id);
    return thing && isNumber(thing.distance_m) ? `${fixed(thing.distance_m, 2)} m` : '';
  };
  function placeMarks(labels) {
    const found = state.overlay === 'none' ? new Map() : middles(labels), {marks, screen} = panels.picture;
    const {wide, high} = sizes.get(screen) ?? {wide: screen.clientWidth, high: screen.clientHeight}, scale = wide / labels.width;
    for (const [id, sums] of found) {
      const x = sums.x / sums.n * scale, y = sums.y / sums.n * scale;
      let mark = pictureMarks.get(id);
      if (!mark) {
        const text = markText(id);
        mark = {node: el('span', {class: 'mark', 'data-key': id}, el('b', {}, String(id)), ' ', el('span', {}, text)), text, at: '', x, y};
        mark.node.style.setProperty('--colour', idColour(id));
        marks.append(mark.node);
        pictureMarks.set(id, mark);
        mark.wide = mark.node.offsetWidth;
      }
      // Smoothed, because a mask's edge flickers and its name should not.
      const near = Math.hypot(mark.x - x, mark.y - y) < 40 ? 0.45 : 1;
      mark.x += (x - mark.x) * near;
      mark.y += (y - mark.y) * near;
    }
    for (const [id, mark] of pictureMarks) {
      if (found.has(id)) continue;
      mark.node.remove();
      pictureMarks.delete(id);
    }
    // Overlapping names move down.
    const placed = [];
    for (const mark of [...pictureMarks.values()].sort((a, b) => a.y - b.y)) {
      const half = mark.wide / 2 + 1, x = Math.min(wide - half, Math.max(half, mark.x));
      let y = Math.min(high - 10, Math.max(10, mark.y));
      for (const other of placed) if (Math.abs(other.x - x) < other.half + half && Math.abs(other.y - y) < 20) y = other.y + 20;
      placed.push({x, y, half});
      const at = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      if (at !== mark.at) mark.node.style.transform = mark.at = at;
    }
    dimMarks();
  }
  function dimMarks() {
    for (const [id, {node}] of pictureMarks) {
      node.classList.toggle('dim', chosen() !== null && chosen() !== id);
      node.classList.toggle('moving', thingsById.get(id)?.is_moving === true);
    }
  }
  /** Throttled: 30 updates a second would be unreadable. */
  function writeMarks() {
    const changed = [...pictureMarks].filter(([id, {text}]) => text !== markText(id));
    for (const [id, mark] of changed) mark.node.lastChild.textContent = mark.text = markText(id);
    for (const [, mark] of changed) mark.wide = mark.node.offsetWidth;  // all at once: one layout
  }
  function trackUnder(event) {
    const labels = shown.picture?.labels, at = labels && pixelUnder(event, panels.picture.screen, labels);
    return at ? labels.values[at.i] || null : null;
  }

  // ---- disparity ----

  const kHole = '#24272b', kBlink = '#ff3df2';
  const {reasons, ramp} = run.look;
  const kAllReasons = reasons.reduce((all, {bit}) => all | bit, 0);
  const disparityImage = buffers(panels.disparity.canvases[0]);
  const colours = {valid: new Uint32Array(256), hole: new Uint32Array(kAllReasons + 1), key: ''};
  const range = {low: 1, high: 255};  // of the values present, 1 … 255
  const reasonOf = (bits) => reasons.find(({bit}) => bits & bit) ?? null;
  const pixelsOf = (value) => {
    const d = newest.stats?.num_disparities;
    return isNumber(d) ? (value - 1) / 254 * d + (newest.stats.min_disparity ?? 0) : NaN;
  };
  const metres = (disparity) => metresOf(disparity, newest.stats?.rig);
  function mixColours() {
    const key = [Math.round(range.low), Math.round(range.high), state.reason, state.phase].join();
    if (key === colours.key) return;
    colours.key = key;
    for (let v = 1; v < 256; ++v) {
      const share = Math.min(1, Math.max(0, (v - range.low) / Math.max(1, range.high - range.low)));
      const colour = ramp[Math.round(share * (ramp.length - 1))];
      colours.valid[v] = pixel(state.reason ? mixed(colour, kHole, 0.78) : colour);
    }
    for (let bits = 0; bits <= kAllReasons; ++bits) {
      const colour = reasonOf(bits)?.colour ?? kHole;
      colours.hole[bits] = !state.reason ? pixel(colour)
        : bits & state.reason ? pixel(state.phase ? kBlink : mixed(kBlink, kHole, 0.65)) : pixel(mixed(colour, kHole, 0.7));
    }
  }
  const histogram = new Uint32Array(256), holes = new Uint32Array(kAllReasons + 1);
  function paintDisparity(frame, again = false) {
    const {disparity, reject} = frame;
    if (!disparity) return;
    const {width, height, values} = disparity, bits = reject?.values;
    const {canvases: [canvas], screen} = panels.disparity;
    if (canvas.width !== width || canvas.height !== height) shape(screen, width, height);
    const pixels = disparityImage.sized(width, height);
    mixColours();
    const {valid, hole} = colours;
    histogram.fill(0);
    holes.fill(0);
    for (let i = 0; i < values.length; ++i) {
      const v = values[i];
      if (v) {
        pixels[i] = valid[v];
        ++histogram[v];
        continue;
      }
      const why = bits ? bits[i] & kAllReasons : 0;
      pixels[i] = hole[why];
      ++holes[why];
    }
    disparityImage.put();
    shown.disparity = frame;
    drawnAt.disparity = performance.now();
    if (!again) followRange();
  }
  /** The colours span the values present, from 1 % to 99 %; they adapt slowly. */
  function followRange() {
    let all = 0, low = 1, high = 255;
    for (let v = 1; v < 256; ++v) all += histogram[v];
    if (!all) return;
    for (let sum = histogram[1]; sum < all * 0.01 && low < 255;) sum += histogram[++low];
    for (let sum = histogram[255]; sum < all * 0.01 && high > 1;) sum += histogram[--high];
    high = Math.max(high, low + 8);
    const step = Math.abs(range.low - low) + Math.abs(range.high - high) > 60 ? 1 : 0.08;
    range.low += (low - range.low) * step;
    range.high += (high - range.high) * step;
  }

  const legend = {ticks: [0, 1, 2].map(() => el('span')), rows: new Map()};
  function makeLegend() {
    const scale = el('div', {class: 'scale', style: {background: `linear-gradient(to right, ${ramp.filter((_, i) => i % 15 === 0).join(',')})`}});
    byId('reasons').append(scale, el('div', {class: 'ticks'}, legend.ticks));
    for (const {bit, name, colour, says} of reasons) {
      const share = el('span');
      const row = el('button', {class: 'reason off', type: 'button', title: `${says ?? name}. Click to make it blink.`, 'aria-pressed': 'false', 'data-bit': bit, onclick: () => blink(bit)},
        el('i', {style: {background: colour}}), name, share);
      legend.rows.set(bit, {row, share});
      byId('reasons').append(row);
    }
    byId('reasons').append(el('p', {class: 'hint'}, 'why a pixel has no disparity; click one to find it'));
  }
  function writeLegend() {
    if (!shown.disparity) return;
    const all = shown.disparity.disparity.values.length || 1;
    let hole = 0;
    const counts = new Map(reasons.map(({bit}) => [bit, 0]));
    for (let bits = 0; bits <= kAllReasons; ++bits) {
      hole += holes[bits];
      const first = holes[bits] ? reasonOf(bits) : null;
      if (first) counts.set(first.bit, counts.get(first.bit) + holes[bits]);
    }
    for (const [bit, {row, share}] of legend.rows) {
      write(share, counts.get(bit) ? percent(counts.get(bit) / all) : '');
      row.classList.toggle('off', !counts.get(bit));
    }
    [range.low, (range.low + range.high) / 2, range.high].forEach((v, k) => {
      const d = pixelsOf(v), z = metres(d);
      legend.ticks[k].replaceChildren(...(isNumber(d) ? [`${fixed(d, 0)} px`, ...(isNumber(z) ? [el('br'), `${fixed(z, 1)} m`] : [])] : []));
    });
    if (!panels.disparity.isRead) write(panels.disparity.count, `density ${percent(1 - hole / all, 0)}`);
  }
  let blinker = 0;
  function blink(bit) {
    state.reason = state.reason === bit ? null : bit;
    state.phase = true;
    for (const [other, {row}] of legend.rows) row.setAttribute('aria-pressed', String(other === state.reason));
    clearInterval(blinker);
    const repaint = () => { if (shown.disparity) paintDisparity(shown.disparity, true); };
    repaint();
    if (state.reason === null || matchMedia('(prefers-reduced-motion: reduce)').matches) return;
    blinker = setInterval(() => {
      state.phase = !state.phase;
      repaint();
    }, 320);
  }
  function readPixel(event) {
    const frame = shown.disparity, at = frame && pixelUnder(event, panels.disparity.screen, frame.disparity);
    panels.disparity.isRead = Boolean(at);
    if (!at) return;
    const value = frame.disparity.values[at.i], place = `(${at.x}, ${at.y})`;
    if (value) {
      const d = pixelsOf(value), z = metres(d);
      panels.disparity.count.textContent = `${place}: ${fixed(d, 1)} px${isNumber(z) ? `, ${fixed(z, 2)} m` : ''}`;
      return;
    }
    const bits = frame.reject?.values[at.i] ?? 0, why = reasons.filter(({bit}) => bits & bit).map(({name}) => name);
    panels.disparity.count.textContent = `${place}: hole${why.length ? `: ${why.join(', ')}` : ''}`;
  }

  // ---- what the server says of each frame ----

  const kHistory = 120;  // frames
  const history = [];    // {frame, stages: Map, latency}
  let thingsById = new Map();
  const life = {frame: null, at: 0, count: 0};  // the last frame received, and when
  const trails = new Map();  // track → [{t, place}]
  const kTrail = 6, kJump = 1.5;  // s, m

  function heardStats(stats, stamp) {
    newest.stats = stats;
    newest.source = null;
    if (stats.frame !== life.frame) {
      if (isNumber(life.frame) && stats.frame < life.frame) {
        history.length = 0;
        trails.clear();
      }
      Object.assign(life, {frame: stats.frame, at: performance.now(), count: life.count + 1});
      Object.assign(cairnStats, {computed: stats.frame, received: life.count});
      const stages = new Map();
      for (const {stage, ms} of stats.stages ?? []) if (isNumber(ms)) stages.set(String(stage), (stages.get(String(stage)) ?? 0) + ms);
      history.push({frame: stats.frame, stages, latency: stats.latency_ms});
      if (history.length > kHistory) history.shift();
      takeThings(stats, Number(stamp / 1000n) / 1e6);
      stripIsOld = true;
    }
    // Frames in flight when it was paused still report it as running.
    if (stats.paused === true || performance.now() - state.pausedAt > 1000) state.isPaused = stats.paused === true;
    if (life.count === 1) slowly();
  }

  const kLevelCamera = [0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 0];  // if no floor is known
  function floorFromCamera({ground}) {
    if (!ground?.normal || !ground.forward || !ground.left) return null;
    return [...ground.forward, 0, ...ground.left, 0, ...ground.normal, ground.height_m];
  }
  /** Null if the camera's position is unknown. */
  const mapFromCamera = ({camera}) => camera && motionOf(camera);
  function takeThings(stats, seconds) {
    const onFloor = floorFromCamera(stats) ?? kLevelCamera, inMap = mapFromCamera(stats);
    thingsById = new Map();
    for (const thing of stats.objects ?? []) {
      const id = Number(thing.id);
      if (!Number.isInteger(id)) continue;
      thing.id = id;
      const corners = cornersOf(thing);
      thing.corners = corners?.map((p) => moved(onFloor, p)) ?? null;
      thingsById.set(id, thing);
      if (!corners || !inMap) continue;
      const middle = [0, 1, 2].map((k) => corners.reduce((sum, c) => sum + c[k] / 8, 0));
      const place = moved(inMap, middle), trail = trails.get(id), last = trail?.at(-1);
      const follows = last && seconds - last.t < 1 && Math.hypot(...minus3(place, last.place)) < kJump;
      if (follows) trail.push({t: seconds, place});
      else trails.set(id, [{t: seconds, place}]);
    }
    for (const [id, points] of trails) {
      while (points.length && points[0].t < seconds - kTrail) points.shift();
      if (!points.length) trails.delete(id);
    }
  }
  /** Corners of its box in the camera's frame, from corners k at (k & 1, k & 2, k & 4) of its axes; first around its
      base, then around its top. */
  function cornersOf({corners_m: around}) {
    if (!Array.isArray(around) || around.length !== 8) return null;
    return [0, 1, 3, 2, 4, 5, 7, 6].map((k) => around[k]);
  }
  /** The trails, stored in the map, relative to the current camera. */
  function trailsFromHere(stats, only) {
    const onFloor = floorFromCamera(stats) ?? kLevelCamera, inMap = mapFromCamera(stats);
    if (!inMap) return [];
    return [...trails].filter(([id]) => only === null || only === id)
      .map(([id, points]) => ({colour: idColour(id), points: points.map(({place}) => moved(onFloor, movedBack(inMap, place)))}));
  }

  // ---- the 3-D view ----

  function frustumOf({rig, image}) {
    if (!rig || !image) return null;
    const at = (v, c) => (v - c) / rig.focal_px;
    return {left: at(0, rig.cx_px), right: at(image.width, rig.cx_px), top: at(0, rig.cy_px), bottom: at(image.height, rig.cy_px)};
  }
  const scene = makeScene(panels.scene.stage, sceneNow, (id) => (id === null ? state.picked !== null && pick(state.picked) : pick(id)));
  function sceneNow() {
    const {stats, cloud} = newest, only = chosen();
    if (!stats) return null;
    const things = [...thingsById.values()].filter((thing) => thing.corners).map((thing) => ({
      id: thing.id, corners: thing.corners, colour: idColour(thing.id), chosen: only === thing.id, dim: only !== null && only !== thing.id,
      moving: thing.is_moving === true, text: [thing.id, markText(thing.id)].filter((t) => t !== '').join(' · '),
    }));
    const matrix = floorFromCamera(stats);
    return {things, trails: trailsFromHere(stats, only), cloud, floorFromCamera: matrix ?? kLevelCamera, hasFloor: matrix !== null, frustum: frustumOf(stats)};
  }

  // ---- the list of objects ----

  const speedOf = (thing) => (thing.velocity_m_s ? Math.hypot(...thing.velocity_m_s) : null);
  const sizeOf = ({size_m: size}) => (Array.isArray(size) && size.every(isNumber) ? size : null);
  const thingsTable = table('things', [
    {name: 'id', title: 'Track id, never reused', value: (t) => t.id, show: (t) => [swatch(idColour(t.id)), String(t.id)]},
    number('distance m', (t) => t.distance_m, 2, {title: 'Distance from the camera'}),
    {name: 'size m', title: 'Box: length × width × height', value: (t) => sizeOf(t)?.reduce((a, b) => a * b) ?? null, show: (t) => sizeOf(t)?.map((v) => fixed(v, 2)).join(' × ') ?? '–'},
    number('confidence', (t) => t.confidence, 2, {title: 'Probability that it is one object'}),
    {name: 'state', text: true, title: 'State of the track; speed if moving', value: (t) => (t.is_moving ? '' : stateOf(t)),
      show: (t) => (t.is_moving ? [el('span', {class: 'moving'}, isNumber(speedOf(t)) ? `moving, ${fixed(speedOf(t), 2)} m/s` : 'moving')] : stateOf(t))},
  ], [], {key: (t) => t.id, pickRow: (t) => pick(t.id), selected: (t) => t.id === state.picked, enter: (t) => near(t?.id ?? null)});
  const stateOf = (thing) => words(String(thing.state ?? ''));
  function writeThings() {
    const all = [...thingsById.values()];
    thingsTable.refill(all);
    const moving = all.filter((t) => t.is_moving).length;
    write(thingsNote, all.length ? `${all.length} in view${moving ? `, ${moving} moving` : ''}` : 'none');
    const {image, name} = newest.stats ?? {};
    write(panels.picture.count, [name, image && `${image.width} × ${image.height}`].filter(Boolean).join(' · '));
    panels.picture.count.title = name ?? '';
    const floor = newest.stats && floorFromCamera(newest.stats) !== null;
    write(panels.scene.count, !newest.stats ? '' : !newest.stats.rig ? 'no calibration: no metres' : floor ? 'grid: 1 m' : 'no floor found');
  }
  const thingsNote = el('span', {class: 'note'});
  byId('found').append(el('div', {class: 'head'}, el('h2', {}, 'Objects'), thingsNote), thingsTable);

  // ---- time per stage ----

  const kStageColours = ['#2b9c8d', '#5b8fd6', '#a37fd6', '#d08a4a', '#c95f84', '#7fa650', '#c9b458'], kOther = '#59626b';
  const strip = {canvas: document.querySelector('.strip canvas'), stages: [], chosenAt: 0, top: 10};
  let stripIsOld = true;
  function chooseStages() {
    // Again once the first frames, which take longer, no longer dominate.
    if (strip.stages.length && life.count - strip.chosenAt < Math.min(240, strip.chosenAt + 10)) return;
    strip.chosenAt = life.count;
    const sums = new Map();
    for (const {stages} of history) for (const [stage, ms] of stages) sums.set(stage, (sums.get(stage) ?? 0) + ms);
    const most = [...sums].sort((a, b) => b[1] - a[1]).slice(0, kStageColours.length).map(([stage]) => stage);
    // A stage keeps its colour and place; new ones take what is free.
    const stay = strip.stages.filter((stage) => most.includes(stage));
    const free = kStageColours.filter((c) => !stay.some((s) => strip.colours.get(s) === c));
    strip.colours = new Map(stay.map((s) => [s, strip.colours.get(s)]));
    for (const stage of most) if (!stay.includes(stage)) { strip.colours.set(stage, free.shift()); stay.push(stage); }
    strip.stages = stay;
    byId('stages').replaceChildren(...strip.stages.map((stage) => el('span', {class: 'chip', title: `${words(stage)}: median of the last ${kHistory} frames, in ms`},
      el('i', {style: {background: strip.colours.get(stage)}}), el('b', {}, words(stage)), el('span', {'data-stage': stage}))));
  }
  const otherOf = (stages) => [...stages].reduce((sum, [stage, ms]) => (strip.colours.has(stage) ? sum : sum + ms), 0);
  const median = (values) => (values.length ? [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] : NaN);
  function drawStrip() {
    stripIsOld = false;
    const {canvas} = strip, {wide, high} = sizes.get(canvas) ?? {}, dpr = Math.min(2, devicePixelRatio || 1);
    if (!wide || !high) return;
    if (canvas.width !== Math.round(wide * dpr) || canvas.height !== Math.round(high * dpr)) {
      [canvas.width, canvas.height] = [Math.round(wide * dpr), Math.round(high * dpr)];
    }
    const context = canvas.getContext('2d');
    context.setTransform(dpr, 0, 0, dpr, 0, 0);
    context.clearRect(0, 0, wide, high);
    if (!history.length) return;
    chooseStages();
    const totals = history.map(({stages, latency}) => Math.max(latency ?? 0, [...stages.values()].reduce((a, b) => a + b, 0)));
    const top = [...totals].sort((a, b) => a - b)[Math.floor(totals.length * 0.97)] * 1.2 || 10;
    strip.top += (top - strip.top) * (top > strip.top ? 0.5 : 0.05);
    const left = 34, each = (wide - left) / kHistory, perMs = (high - 8) / strip.top, y = (ms) => high - 1 - perMs * ms;
    context.font = '11px system-ui, sans-serif';
    context.textBaseline = 'middle';
    const step = roundStep(strip.top, 4);
    for (let ms = 0; ms < strip.top; ms += step) {
      context.fillStyle = '#22272c';
      context.fillRect(left, Math.round(y(ms)), wide - left, 1);
      context.fillStyle = '#98a1ab';
      context.textAlign = 'right';
      if (high - y(ms) > 4) context.fillText(`${ms}`, left - 6, y(ms));
    }
    context.textAlign = 'right';
    context.fillText('ms', left - 6, high - 5);
    const first = kHistory - history.length, tops = history.map(() => y(0));
    // Grouped by colour: frame by frame would take three times as long.
    for (const stage of [...strip.stages, null]) {
      context.fillStyle = strip.colours.get(stage) ?? kOther;
      history.forEach(({stages}, k) => {
        const part = (stage === null ? otherOf(stages) : stages.get(stage) ?? 0) * perMs;
        if (part > 0) context.fillRect(left + (first + k) * each, tops[k] -= part, Math.max(1, each - 1), part);
      });
    }
    context.strokeStyle = '#e3e6e9';
    context.lineWidth = 1.25;
    context.beginPath();
    history.forEach(({latency}, k) => { if (isNumber(latency)) context.lineTo(left + (first + k + 0.5) * each, Math.max(1, y(latency))); });
    context.stroke();
  }
  function writeStages() {
    for (const node of document.querySelectorAll('#stages [data-stage]')) {
      write(node, `${fixed(median(history.map(({stages}) => stages.get(node.dataset.stage) ?? 0)), 1)}`);
    }
    const all = median(history.map(({stages}) => [...stages.values()].reduce((a, b) => a + b, 0)));
    write(byId('time-note'), history.length ? `${fixed(all, 1)} ms per frame` : '');
  }
  function describeTime(event) {
    const box = strip.canvas.getBoundingClientRect(), each = (box.width - 34) / kHistory;
    const entry = history[Math.floor((event.clientX - box.left - 34) / each) - (kHistory - history.length)];
    if (!entry) return hideTip();
    const rest = otherOf(entry.stages);
    showTip(event, el('b', {}, `frame ${entry.frame}`), rows([
      ...strip.stages.filter((s) => entry.stages.has(s)).map((s) => [words(s), `${fixed(entry.stages.get(s), 1)} ms`]),
      ...(rest >= 0.05 ? [['other stages', `${fixed(rest, 1)} ms`]] : []),
      ['arrival to objects', isNumber(entry.latency) ? `${fixed(entry.latency, 1)} ms` : null]]));
  }

  // ---- the bar ----

  const gauges = new Map();
  function gauge(name, value, unit, title, kind = '') {
    let cell = gauges.get(name);
    if (!cell) {
      const text = el('span'), small = el('small');
      cell = {node: el('div', {}, el('dt', {}, name), el('dd', {}, text, small)), text, small};
      gauges.set(name, cell);
      byId('gauges').append(cell.node);
    }
    cell.node.hidden = value === null;
    if (value === null) return;
    write(cell.text, value);
    write(cell.small, unit);
    if (cell.node.title !== title) cell.node.title = title;
    if (cell.node.className !== kind) cell.node.className = kind;
  }
  function writeGauges() {
    const stats = newest.stats;
    if (!stats) return;
    const {drops = {}, source = {}} = stats, here = cairnStats.p50_ms, age = stats.latency_ms + here;
    const comes = link.state === 'open' && performance.now() - life.at < kSilence && !state.isPaused;
    gauge('rate', comes ? fixed(stats.rate_hz, 1) : '–', 'Hz', 'Frames processed per second');
    gauge('drawn', comes && inView.get('picture') !== false ? fixed(drawnRate(), 1) : '–', 'Hz', 'Frames drawn by this page per second');
    gauge('age', comes ? fixed(age, 0) : '–', 'ms', `From a pair's arrival at the computer until it is drawn here: ${fixed(stats.latency_ms, 1)} ms there, ${fixed(here, 1)} ms here (median), without the network between`, comes && age > 250 ? 'warn' : '');
    const lost = [['replaced', 'replaced', 'replaced by a newer pair while waiting'], ['too_old', 'too old', 'older than --max-age when processing was due'], ['at_source', 'at source', 'lost or unpaired at the camera']];
    const some = lost.filter(([key]) => drops[key] > 0);
    const all = lost.reduce((sum, [key]) => sum + (drops[key] ?? 0), 0);
    gauge('dropped', String(all), some.map(([key, name]) => `${drops[key]} ${name}`).join(', '), `Pairs dropped: ${lost.map(([key, , why]) => `${drops[key] ?? 0}: ${why}`).join('; ')}`);
    const {skew_ms: skew} = source;
    gauge('skew', isNumber(skew) ? fixed(skew, 2) : null, 'ms', 'Difference of the stamps of left and right');
    gauge('unpaired', source.unpaired > 0 ? String(source.unpaired) : null, '', 'Images without a partner within --max-skew');
    gauge('reconnects', source.is_live ? String(source.reconnects ?? 0) : null, '', 'Reconnections of the camera', source.is_connected === false ? 'bad' : '');
    const wrong = (stats.findings ?? []).filter(({severity}) => severity !== 'note'), [first] = wrong;
    gauge('rig', first ? first.finding : null, wrong.length > 1 ? `and ${wrong.length - 1} more` : '', wrong.map(({says, remedy}) => `${says}. ${remedy}`).join('\n'), wrong.some(({severity}) => severity === 'broken') ? 'bad' : 'warn');
    gauge('skipped', stats.skipped > 0 ? String(stats.skipped) : null, '', 'Messages dropped because the network or the browser was too slow');
    gauge('viewers', isNumber(stats.clients) ? String(stats.clients) : null, '', 'Connected clients');
    byId('playback').hidden = stats.is_file !== true;
    for (const id of ['pause', 'step', 'record']) byId(id).disabled = !stats.tunable;
    byId('pause').setAttribute('aria-pressed', String(state.isPaused));
    byId('pause').textContent = state.isPaused ? '▶' : '❚❚';
    byId('pause').setAttribute('aria-label', state.isPaused ? 'Go on' : 'Pause');
    const record = byId('record');
    record.hidden = stats.can_record !== true;
    record.setAttribute('aria-pressed', String(stats.recording === true));
    record.lastChild.textContent = stats.recording ? 'recording' : 'record';
    record.title = stats.recording ? 'Stop recording' : 'Record the camera (--record FILE.mcap)';
    byId('revision').textContent = stats.revision > 0 ? counted(stats.revision, 'change') : '';
    if (isNumber(stats.revision) && stats.revision !== tuning.revision) {
      if (tuning.revision !== null) reloadOptions();
      tuning.revision = stats.revision;
    }
    if ((stats.tunable === true) !== tuning.tunable) {
      tuning.tunable = stats.tunable === true;
      writeOptions();
    }
  }
  function nameSource(name) {
    const title = String(name ?? '').replace(/^cairn(:| live:?)?\s*/, '');
    byId('title').textContent = title;
    byId('title').title = title;
  }

  // ---- what is wrong, if anything is ----

  const seconds = (ms) => `${Math.max(1, Math.round(ms / 1000))} s`;
  function judge() {
    const now = performance.now(), {stats} = newest, idle = now - Math.max(life.at, link.state === 'open' && !life.at ? link.since : 0);
    if (link.state === 'connecting') return {kind: 'waiting', word: 'connecting'};
    if (link.state === 'gone') {
      const left = link.retryAt ? `Next attempt in ${seconds(link.retryAt - now)}` : 'Trying';
      return {
        kind: 'gone', word: 'server gone', bad: true,
        head: link.refused ? 'The server refuses this page' : `No server for ${seconds(now - link.since)}`,
        text: link.refused ? 'The server was restarted with a new token: open the address that it printed.' : 'cairn live has ended, or the network is down.',
        small: `${left} (${counted(link.attempt, 'attempt')} so far).${life.at ? ' The last frame received is shown.' : ''}`,
      };
    }
    if (state.isPaused) return {kind: 'paused', word: 'paused'};
    if (idle < kSilence) return life.at ? {kind: 'live', word: stats?.is_file ? 'playing' : 'live'} : {kind: 'waiting', word: 'waiting'};
    const source = newest.source ?? stats?.source ?? {}, trouble = String(source.trouble || '');
    const why = source.is_connected === false ? `camera not connected${trouble ? `: ${trouble}` : ''}`
      : trouble || (stats?.is_file ? 'end of the file, or a slow frame' : 'the camera is connected, but delivers no frames');
    return {
      kind: 'waiting', word: 'no frames', head: `No frame for ${seconds(idle)}`, text: why,
      small: life.at ? `Frame ${life.frame} is shown.` : 'No frame received since this page was opened.',
    };
  }
  /** While no frames arrive, no message reports the state of the camera. */
  async function askStatus() {
    if (link.state !== 'open' || state.isPaused || performance.now() - Math.max(life.at, link.since) < kSilence - 1000) return;
    const answer = await fetch('/status.json', {cache: 'no-store'}).catch(() => null);
    const status = answer?.ok ? await answer.json().catch(() => null) : null;
    if (!status) return;
    newest.source = status.source ?? null;
    if (!newest.stats && isNumber(status.frame)) newest.stats = status;
    watch();
  }
  let verdict = '';
  function watch() {
    const {kind, word, head, text, small, bad} = judge();
    byId('link').dataset.state = kind;
    write(byId('link').lastChild, word);
    const news = panels.picture.stage.querySelector('.news');
    const said = head ? [head, text, small].join('|') : '';
    if (said !== verdict) {
      verdict = said;
      news.hidden = !head;
      news.classList.toggle('bad', Boolean(bad));
      if (head) news.replaceChildren(el('b', {}, head), text, el('small', {}, small));
    }
    byId('desk').classList.toggle('stale', Boolean(head) && Boolean(life.at));
    const rate = kind === 'live' && newest.stats ? `${fixed(newest.stats.rate_hz, 0)} Hz` : word;
    const title = `${rate} · ${byId('title').textContent || 'cairn live'}`;
    if (document.title !== title) document.title = title;
  }

  /** Messages of the server. */
  function said(level, text) {
    if (!text) return;
    const name = tuning.rows.size ? [...tuning.rows.keys()].find((n) => text.includes(n)) : undefined;
    if (name && level >= 1) {
      tuning.refused.set(name, text);
      reloadOptions();
    }
    toast(text, level >= 2 ? 'error' : level === 1 ? 'warning' : '');
  }
  function toast(text, kind = '') {
    const all = byId('toasts');
    if (all.lastChild?.firstChild?.textContent === text) all.lastChild.remove();
    const node = el('div', {class: `toast ${kind}`}, text);
    all.append(node);
    while (all.children.length > 4) all.firstChild.remove();
    setTimeout(() => node.remove(), 7000);
  }

  // ---- options ----

  const tuning = {rows: new Map(), refused: new Map(), options: [], revision: null, tunable: null, waiting: 0, sent: new Map(), timer: 0};
  const kMinus = /^[−-]1 = off, /;
  /** The parsed domain of an option: {choices} or {low, high, odd, hasOff}. */
  function domainOf({type, domain = ''}) {
    const text = String(domain);
    if (type === 'bool') return {};
    if (text.includes('|')) return {choices: text.split('|')};
    const [low, high] = text.replace(kMinus, '').split('…').map((part) => parseFloat(part.replace('−', '-')));
    return {low, high, odd: text.includes('odd'), hasOff: kMinus.test(text), whole: type === 'int'};
  }
  /**
   * Maps a slider's 0 … 1 to an option's values and back. Ranges of several decades are logarithmic, and very wide
   * ones end at the largest useful value; the box next to the slider accepts any.
   */
  function scaleOf({low, high, odd, whole}, first) {
    const isWide = high - low > 2000 * Math.max(whole ? 1 : 0, Math.abs(first) || 1e-3) || (low >= 0 && high >= 200 && high > 12 * Math.max(1, first));
    const digits = whole ? 0 : Math.max(0, Math.min(4, 2 - Math.floor(Math.log10(Math.max(1e-4, high - low > 100 ? 100 : high - low)))));
    const tidy = (v) => {
      if (odd) return Math.min(high, Math.max(low, 2 * Math.round((v - 1) / 2) + 1));
      if (whole) return Math.round(v);
      const step = isWide && v > 0 ? 10 ** Math.max(-4, Math.floor(Math.log10(v)) - 1) : 10 ** -digits;
      return Number((Math.round(v / step) * step).toPrecision(8));
    };
    if (isWide && low >= 0) {
      const span = Math.log1p((high - low) * (whole ? 1 : 100));
      return {to: (v) => Math.log1p((v - low) * (whole ? 1 : 100)) / span, from: (s) => tidy(low + Math.expm1(s * span) / (whole ? 1 : 100))};
    }
    return {to: (v) => (v - low) / (high - low), from: (s) => tidy(low + s * (high - low))};
  }

  async function loadOptions() {
    const answer = await fetch('/options.json', {cache: 'no-store'}).catch(() => null);
    if (!answer?.ok) return;
    const list = await answer.json().catch(() => null);
    const options = Array.isArray(list) ? list : list?.options;
    if (!Array.isArray(options)) return;
    tuning.options = options.map((o) => ({...o, value: String(o.value), first: String(o.first ?? o.value)}));
    writeOptions();
  }
  function reloadOptions() {
    clearTimeout(tuning.waiting);
    tuning.waiting = setTimeout(loadOptions, 150);
  }
  function heardParameters(parameters) {
    let isKnown = false;
    for (const {name, value} of parameters) {
      if (name === 'live.pause') Object.assign(state, {isPaused: value === true, pausedAt: performance.now()});
      if (name === 'live.record' && newest.stats) newest.stats.recording = Boolean(value);
      isKnown ||= tuning.rows.has(name);
    }
    if (isKnown) reloadOptions();
  }
  /** At most ten times a second, however fast a slider is moved. */
  function setOption(name, value) {
    tuning.refused.delete(name);
    tuning.sent.set(name, value);
    if (tuning.timer) return;
    const flush = () => {
      if (!tuning.sent.size) {
        tuning.timer = 0;
        return;
      }
      send({op: 'setParameters', id: 'page', parameters: [...tuning.sent].map(([n, v]) => ({name: n, value: v}))});
      tuning.sent.clear();
      tuning.timer = setTimeout(flush, 100);
    };
    flush();
  }
  const typed = ({type}, text) => (type === 'bool' ? text === 'true' : type === 'int' || type === 'float' ? Number(text) : text);

  function makeRow(option) {
    const {name, unit, help, type} = option, domain = domainOf(option), short = name.slice(name.indexOf('.') + 1);
    const row = {option, domain};
    const change = (text) => {
      row.shown = text;
      setOption(name, typed(row.option, text));
      row.write(text);
    };
    const id = `o-${name.replace(/[^\w-]/g, '_')}`;
    const undo = el('button', {class: 'undo', type: 'button', title: 'Reset to the initial value', 'aria-label': `${name}: reset to the initial value`, onclick: () => change(row.option.first)}, '↺');
    const facts = el('p', {class: 'help'}), refused = el('p', {class: 'refused', hidden: true});
    let control, bar = null;
    if (type === 'bool') {
      control = el('input', {id, type: 'checkbox', onchange: () => change(String(control.checked))});
      row.write = (text) => { control.checked = text === 'true'; };
    } else if (domain.choices) {
      control = el('select', {id, onchange: () => change(control.value)}, domain.choices.map((c) => el('option', {value: c}, words(c))));
      row.write = (text) => { control.value = text; };
    } else {
      const first = Number(option.first), on = first === -1 && domain.hasOff ? domain.low : first;
      const scale = scaleOf(domain, on);
      control = el('input', {id, class: 'value', type: 'text', inputmode: 'decimal', spellcheck: 'false', autocomplete: 'off', onfocus: () => control.select(), onchange: () => {
        const text = control.value.trim().replace('−', '-');
        if (text === 'off' && domain.hasOff) change('-1');
        else if (text === '' || !Number.isFinite(Number(text))) row.write(row.option.value);
        else change(String(Number(text)));
      }});
      const slider = el('input', {type: 'range', min: 0, max: 1, step: 'any', 'aria-label': name, oninput: () => change(String(scale.from(Number(slider.value))))});
      slider.addEventListener('keydown', (event) => {
        const way = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[event.key];
        if (!way) return;
        event.preventDefault();
        let share = Number(slider.value), next = scale.from(share);
        for (const before = next; next === before && share >= 0 && share <= 1;) next = scale.from(share += way / 400);
        change(String(Math.min(domain.high, Math.max(domain.low, next))));
      });
      let last = on;
      const off = domain.hasOff ? el('input', {type: 'checkbox', onchange: () => change(off.checked ? '-1' : String(last))}) : null;
      bar = el('div', {class: 'bar'}, slider, off ? el('label', {title: 'Turn off'}, off, 'off') : null);
      row.write = (text) => {
        const value = Number(text), isOff = domain.hasOff && value === -1;
        control.value = isOff ? 'off' : text;
        if (off) off.checked = isOff;
        if (!isOff) {
          last = value;
          slider.value = scale.to(value);
        }
        slider.classList.toggle('off', isOff);
        row.isOff = isOff;
      };
      row.slider = slider;
      row.off = off;
      row.title = `${domain.low} … ${domain.high}${domain.odd ? ', odd' : ''}`;
    }
    row.node = el('div', {class: 'option', 'data-name': name},
      el('label', {class: 'name', for: id, title: `${name}${row.title ? `: ${row.title}` : ''}${unit ? ` ${unit}` : ''}`}, words(short)), control, el('span', {class: 'unit', title: unit || null}, unit), undo, bar, facts, refused);
    row.refresh = (fresh) => {
      row.option = fresh;
      const isOpen = tuning.tunable === true && fresh.active !== false;
      const isBusy = document.activeElement && row.node.contains(document.activeElement) && (document.activeElement === control && type !== 'bool' && !domain.choices || row.isHeld);
      if (!isBusy && !tuning.sent.has(name)) row.write(fresh.value);
      control.disabled = !isOpen;
      if (row.slider) row.slider.disabled = !isOpen || row.isOff;
      if (row.off) row.off.disabled = !isOpen;
      const isChanged = fresh.value !== fresh.first;
      undo.style.visibility = isChanged && tuning.tunable ? '' : 'hidden';
      undo.title = `Reset to ${fresh.first}`;
      row.node.classList.toggle('changed', isChanged);
      row.node.classList.toggle('inactive', fresh.active === false);
      facts.replaceChildren(help, ...(fresh.active === false && fresh.needs ? [' ', el('span', {class: 'needs'}, `Needs ${fresh.needs}.`)] : []));
      const why = tuning.refused.get(name);
      refused.hidden = !why;
      refused.textContent = why ?? '';
    };
    if (row.slider) {
      row.slider.addEventListener('pointerdown', () => { row.isHeld = true; });
      for (const kind of ['pointerup', 'change', 'blur']) row.slider.addEventListener(kind, () => { row.isHeld = false; });
    }
    return row;
  }
  function writeOptions() {
    const {options, rows: all} = tuning;
    document.querySelector('.read-only').hidden = tuning.tunable || !newest.stats;
    const names = options.map((o) => o.name).join();
    if (names !== tuning.names) {
      tuning.names = names;
      all.clear();
      tuning.sections = new Map();
      for (const option of options) {
        const section = option.name.slice(0, option.name.indexOf('.'));
        if (!tuning.sections.has(section)) {
          const note = el('span', {class: 'note'}), body = el('div');
          tuning.sections.set(section, {node: el('details', {'data-section': section}, el('summary', {}, words(section), note), body), note, body});
        }
        const row = makeRow(option);
        all.set(option.name, row);
        tuning.sections.get(section).body.append(row.node);
      }
      tuning.empty = el('p', {class: 'empty', hidden: true});
      byId('sections').replaceChildren(...[...tuning.sections.values()].map((s) => s.node), tuning.empty);
      for (const name of ['objects', 'match']) tuning.sections.get(name)?.node.setAttribute('open', '');
    }
    for (const option of options) all.get(option.name)?.refresh(option);
    byId('reset').disabled = !tuning.tunable || !options.some((o) => o.value !== o.first);
    findOptions();
  }
  function findOptions() {
    const parts = byId('search').value.toLowerCase().split(/\s+/).filter(Boolean), onlyChanged = byId('changed-only').checked;
    const isSought = parts.length > 0 || onlyChanged;
    let found = 0;
    for (const [section, {node, note}] of tuning.sections ?? []) {
      let here = 0, changed = 0;
      for (const option of tuning.options) {
        if (!option.name.startsWith(`${section}.`)) continue;
        const text = `${option.name} ${words(option.name)} ${option.help}`.toLowerCase();
        const isChanged = option.value !== option.first, fits = parts.every((p) => text.includes(p)) && (!onlyChanged || isChanged);
        tuning.rows.get(option.name).node.hidden = !fits;
        here += fits ? 1 : 0;
        changed += isChanged ? 1 : 0;
      }
      node.hidden = here === 0;
      note.textContent = changed ? `${changed} changed` : '';
      if (isSought && !tuning.isSought) node.wasOpen = node.open;
      if (isSought) node.open = true;
      else if (tuning.isSought) node.open = node.wasOpen ?? node.open;
      found += here;
    }
    tuning.isSought = isSought;
    if (!tuning.empty) return;
    tuning.empty.hidden = found > 0;
    tuning.empty.textContent = onlyChanged && !parts.length ? 'No option was changed.' : 'No option matches.';
  }
  function reset() {
    const changed = tuning.options.filter((o) => o.value !== o.first);
    // In one message: one by one, intermediate combinations might be refused.
    if (changed.length) send({op: 'setParameters', id: 'reset', parameters: changed.map((o) => ({name: o.name, value: typed(o, o.first)}))});
    tuning.refused.clear();
    reloadOptions();
  }
  async function copyYaml() {
    const answer = await fetch('/config.yaml', {cache: 'no-store'}).catch(() => null);
    if (!answer?.ok) return toast('Cannot fetch the configuration: the server is not reachable or refuses.', 'error');
    const text = await answer.text();
    try {
      await navigator.clipboard.writeText(text);
      toast('Copied. Save it as config.yaml, for: cairn live … --config config.yaml');
    } catch {
      const dialog = byId('by-hand'), area = dialog.querySelector('textarea');
      area.value = text;
      dialog.showModal();
      area.select();
    }
  }

  // ---- buttons and keys ----

  const pause = () => {
    send({op: 'setParameters', parameters: [{name: 'live.pause', value: !state.isPaused}]});
    Object.assign(state, {isPaused: !state.isPaused, pausedAt: performance.now()});
    if (!state.isPaused) life.at = performance.now();
    writeGauges();
    watch();
  };
  function step() {
    if (!state.isPaused) pause();
    send({op: 'setParameters', parameters: [{name: 'live.step', value: true}]});
  }
  const record = () => send({op: 'setParameters', parameters: [{name: 'live.record', value: newest.stats?.recording !== true}]});
  function setOverlay(name) {
    state.overlay = name;
    keep('overlay', name);
    for (const button of byId('overlay').children) button.setAttribute('aria-pressed', String(button.textContent === name));
    if (shown.picture) paintPicture(shown.picture, true);
    if (shown.picture?.labels) placeMarks(shown.picture.labels);
  }
  function showOptions(on) {
    byId('desk').classList.toggle('narrow', !on);
    byId('tune').setAttribute('aria-expanded', String(on));
    keep('options', on ? 'shown' : 'hidden');
  }
  function enlarge(panel) {
    const desk = byId('desk'), on = !panel.root.classList.contains('large');
    for (const other of Object.values(panels)) other.root.classList.toggle('large', on && other === panel);
    desk.classList.toggle('enlarged', on);
  }

  function begin() {
    byId('command').textContent = run.command;
    makeLegend();
    for (const name of kOverlays) byId('overlay').append(el('button', {type: 'button', onclick: () => setOverlay(name), title: 'Overlay on the image (m)'}, name));
    if (!kOverlays.includes(state.overlay)) state.overlay = kOverlays[0];
    setOverlay(state.overlay);
    for (const name of ['behind', 'side', 'above']) byId('viewpoints').append(el('button', {type: 'button', onclick: () => scene.lookFrom(name)}, name));
    showOptions(kept('options', innerWidth > 1240 ? 'shown' : 'hidden') === 'shown');
    for (const panel of Object.values(panels)) {
      panel.root.querySelector('.enlarge').addEventListener('click', () => enlarge(panel));
      panel.root.querySelector('figcaption').addEventListener('dblclick', (event) => { if (!event.target.closest('button')) enlarge(panel); });
    }
    panels.picture.stage.addEventListener('dblclick', () => enlarge(panels.picture));
    panels.disparity.stage.addEventListener('dblclick', () => enlarge(panels.disparity));

    const {stage} = panels.picture;
    stage.addEventListener('pointermove', (event) => near(trackUnder(event)));
    stage.addEventListener('pointerleave', () => near(null));
    stage.addEventListener('click', (event) => {
      const id = trackUnder(event);
      if (id !== null || state.picked !== null) pick(id ?? state.picked);
    });
    panels.disparity.stage.addEventListener('pointermove', readPixel);
    panels.disparity.stage.addEventListener('pointerleave', () => { panels.disparity.isRead = false; });
    strip.canvas.addEventListener('pointermove', describeTime);
    strip.canvas.addEventListener('pointerleave', hideTip);

    byId('pause').addEventListener('click', pause);
    byId('step').addEventListener('click', step);
    byId('record').addEventListener('click', record);
    byId('tune').addEventListener('click', () => showOptions(byId('desk').classList.contains('narrow')));
    byId('reset').addEventListener('click', reset);
    byId('yaml').addEventListener('click', copyYaml);
    byId('search').addEventListener('input', findOptions);
    byId('changed-only').addEventListener('change', findOptions);
    // A button that was clicked, rather than reached by keys, leaves the space bar to pause.
    byId('bar').addEventListener('click', (event) => { if (event.detail) event.target.closest('button')?.blur(); });
    addEventListener('keydown', (event) => {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      if (event.target.matches?.('input:not([type=checkbox]), select, textarea')) {
        if (event.key === 'Escape') event.target.blur();
        return;
      }
      const does = {
        ' ': () => { if (!byId('playback').hidden && !byId('pause').disabled && !event.target.matches?.('button, summary, input')) pause(); else return true; },
        ArrowRight: () => { if (!byId('playback').hidden && !byId('step').disabled) step(); },
        m: () => setOverlay(kOverlays[(kOverlays.indexOf(state.overlay) + 1) % kOverlays.length]),
        t: () => showOptions(byId('desk').classList.contains('narrow')),
        '/': () => { showOptions(true); byId('search').focus(); },
        Escape: () => { if (state.picked !== null) pick(state.picked); else if (state.reason !== null) blink(state.reason); },
      }[event.key];
      if (does && does() !== true) event.preventDefault();
    });

    const looked = new IntersectionObserver((entries) => {
      for (const {target, isIntersecting} of entries) inView.set(target.dataset.panel, isIntersecting);
      subscribe();
    });
    for (const {root} of Object.values(panels)) looked.observe(root);
    document.addEventListener('visibilitychange', subscribe);
    setInterval(() => { if (performance.now() - readAt >= 1.5 * kReading) slowly(); }, kReading);
    setInterval(askStatus, 1000);
    measured.observe(panels.picture.screen);
    measured.observe(strip.canvas);
    watch();
    connect();
  }
  /** Notices to read rather than watch; with the current frame, if there is one. */
  function slowly() {
    readAt = performance.now();
    watch();
    if (document.visibilityState !== 'visible') return;
    writeGauges();
    writeMarks();
    writeThings();
    writeLegend();
    writeStages();
    if (stripIsOld) drawStrip();
  }
  begin();
})();
