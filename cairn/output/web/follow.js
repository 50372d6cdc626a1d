// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The player of `cairn follow --html`. Its data are JSON blocks (cairn/output/follow_page.cpp): `run`; for each frame
// `facts-N`, its line of tracks.jsonl, parsed at once, and `maps-N`, decoded when shown; `happened`, the lines of
// events.jsonl. It follows shared.js in one <script>.
(() => {
  const {width, height, rig} = run;
  const kChi2 = Math.sqrt(5.991);  // 95 % of two degrees of freedom
  const kTrailSeconds = 8, kLongestPause = 1;  // s

  // ---- data ----

  const frames = Array.from({length: run.frames}, (_, index) => {
    const facts = block(`facts-${index}`);
    facts.index = index;
    facts.tracks.forEach((track, i) => { track.slot = i + 1; });
    facts.trackOf = [undefined, ...facts.tracks];  // by the label in the map
    facts.tracks = facts.tracks.filter((track) => track.state !== 'dead');
    facts.byTrack = new Map(facts.tracks.map((track) => [track.id, track]));
    return facts;
  });
  // Transforms the odometry's frame into the map's, frame by frame, so that landmarks and tracks share one frame.
  // Until that transform is known, the earliest known one is used.
  const inMap = frames.map((facts) => facts.map_from_odom);
  for (let k = run.frames - 2; k >= 0; --k) inMap[k] ??= inMap[k + 1];
  for (let k = 1; k < run.frames; ++k) inMap[k] ??= inMap[k - 1];
  frames.forEach((facts, index) => {
    const from = inMap[index];
    if (!from || (!from.yaw_rad && from.position_m.every((v) => v === 0))) return;
    const c = Math.cos(from.yaw_rad), s = Math.sin(from.yaw_rad);
    const turned = (v) => v && [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]];
    const moved = (p) => p && turned(p).map((v, k) => v + from.position_m[k]);
    /** R·C·Rᵀ. */
    const spread = (m) => m && transposed(rowsTurned(transposed(rowsTurned(m, turned)), turned));
    if (facts.pose) {
      const [x, y, z, w] = facts.pose.quaternion_xyzw, half = from.yaw_rad / 2, ch = Math.cos(half), sh = Math.sin(half);
      facts.pose.quaternion_xyzw = [ch * x - sh * y, ch * y + sh * x, ch * z + sh * w, ch * w - sh * z];
      facts.pose.position_m = moved(facts.pose.position_m);
      facts.pose.covariance_m2 = spread(facts.pose.covariance_m2);
    }
    for (const track of facts.tracks) {
      track.position_m = moved(track.position_m);
      track.velocity_m_s = turned(track.velocity_m_s);
      track.covariance_m2 = spread(track.covariance_m2);
    }
  });
  /** R·M. */
  function rowsTurned(m, turned) {
    const columns = [0, 1, 2].map((k) => turned([m[k], m[3 + k], m[6 + k]]));
    return [0, 1, 2].flatMap((row) => columns.map((column) => column[row]));
  }
  function transposed(m) {
    return [0, 3, 6, 1, 4, 7, 2, 5, 8].map((k) => m[k]);
  }
  const seconds = frames.map((facts) => (facts.stamp_ns - frames[0].stamp_ns) / 1e9);
  /** When each frame is shown during playback: long pauses of the sequence are shortened. */
  const playedAt = [0];
  for (let k = 1; k < run.frames; ++k) {
    const pause = seconds[k] - seconds[k - 1];
    playedAt.push(playedAt[k - 1] + (pause > 0 ? Math.min(pause, kLongestPause) : 0.1));
  }
  /** The frame in which a landmark was created; 0 for one from an earlier visit. */
  function sinceOf(landmark) {
    for (const facts of frames) {
      const track = facts.tracks.find((t) => t.landmark === landmark);
      if (track) return track.recognised ? 0 : facts.index;
    }
    return 0;
  }
  const counts = (track) => track.state !== 'tentative';
  const isSeen = (track) => track.object > 0;
  const speedOf = (track) => (track.velocity_m_s ? Math.hypot(...track.velocity_m_s) : null);

  for (const facts of frames) facts.mapFromCamera = facts.pose && motionOf(facts.pose);
  /** Depth along the camera's axis in m, the z of objects.json. Null if the camera's position is unknown. */
  function depthOf(track, facts) {
    if (!rig || !facts.pose || !track.position_m) return null;
    return movedBack(facts.mapFromCamera, track.position_m)[2];
  }

  /** The frames of each track in which it counts. */
  const lives = new Map();
  for (const facts of frames) {
    for (const track of facts.tracks) {
      if (!counts(track)) continue;
      if (!lives.has(track.id)) lives.set(track.id, {id: track.id, at: [], seen: 0, moved: false});
      const life = lives.get(track.id);
      life.at.push(facts.index);
      life.seen += isSeen(track) ? 1 : 0;
      life.moved ||= track.moving;
    }
  }

  // ---- events ----

  const kKinds = {
    new: '#2b9c8d', back: '#57a7e0', moving: '#e8863a', stopped: '#a37fd6', moved: '#e04f9b', gone: '#cf3d3d',
    relocated: '#4fb06a', refused: '#d69628', lost: '#c83c3c',
  };
  const colourOfKind = (kind) => kKinds[kind] ?? '#8d959e';
  const place = (p) => (p ? `(${p.slice(0, 2).map((v) => fixed(v, 2)).join(', ')}) m` : '');
  function sentence({kind, track, landmark, from_m: from, to_m: to, probability, count, reason}) {
    const what = track > 0 ? `track ${track}` : landmark > 0 ? `landmark ${landmark}` : '';
    const sure = isNumber(probability) ? `, p ${fixed(probability, 2)}` : '';
    const also = track > 0 && landmark > 0 ? ` (landmark ${landmark})` : '';
    const far = from && to ? Math.hypot(to[0] - from[0], to[1] - from[1]) : null;
    switch (kind) {
      case 'moved': return `${what} was moved${far === null ? '' : ` by ${fixed(far, 2)} m, to ${place(to)}`}${also}${sure}`;
      case 'gone': return `${what} is gone${from ? ` from ${place(from)}` : ''}${also}${sure}`;
      case 'new': return `${what} is new${to ? ` at ${place(to)}` : ''}${also}${sure}`;
      case 'back': return `${what} reappears${also}${sure}`;
      case 'relocated': return `camera relocalised${to ? `: ${place(to)}` : ''}${sure}`;
      case 'moving': return `${what} starts to move${also}${sure}`;
      case 'stopped': return `${what} stops${also}${sure}`;
      case 'refused': return `motion refused: ${words(reason)}${count > 1 ? `, ${count} frames` : ''}`;
      case 'lost': return `camera position unknown${count > 1 ? `, ${count} frames` : ''}`;
      default: return [words(String(kind)), what, sure].filter(Boolean).join(' ');
    }
  }
  // A run that never has motion is not a refusal of single frames.
  const kNoRefusals = ['none', 'off', 'no_rig'];
  const refusalOf = (facts) => (facts.index === 0 || kNoRefusals.includes(facts.motion.refusal) ? null : facts.motion.refusal);
  /** Runs of frames in which `value` is the same and not null: {value, from, to}. */
  function runsOf(value) {
    const all = [];
    frames.forEach((facts, index) => {
      const v = value(facts), last = all.at(-1);
      if (v === null) return;
      if (last && last.value === v && last.to === index - 1) last.to = index;
      else all.push({value: v, from: index, to: index});
    });
    return all;
  }
  const refusedRuns = runsOf((facts) => (facts.pose ? refusalOf(facts) : null)), lostRuns = runsOf((facts) => (facts.pose ? null : 'lost'));
  const hasPlace = rig !== null && frames.some((facts) => facts.pose);
  const indexOfFrame = new Map(frames.map((facts) => [facts.frame, facts.index]));
  const written = block('happened').filter((event) => indexOfFrame.has(event.frame)).map((event) => ({...event, index: indexOfFrame.get(event.frame)}));
  /** Events derived from the tracks themselves. */
  const shown = [...lives.values()].flatMap(({id, at}) => {
    const all = [{index: at[0], kind: 'new', track: id, to_m: frames[at[0]].byTrack.get(id).position_m}];
    let moving = false, seen = at[0];
    for (const index of at) {
      const track = frames[index].byTrack.get(id);
      if (track.moving !== moving) all.push({index, kind: track.moving ? 'moving' : 'stopped', track: id});
      if (isSeen(track) && seconds[index] - seconds[seen] > kLongestPause) all.push({index, kind: 'back', track: id});
      moving = track.moving;
      if (isSeen(track)) seen = index;
    }
    return all;
  });
  const kindsWritten = new Set(written.map((event) => event.kind));
  const events = [
    ...written, ...shown.filter((event) => !kindsWritten.has(event.kind)),
    ...(hasPlace ? refusedRuns.map((r) => ({index: r.from, kind: 'refused', reason: r.value, count: r.to - r.from + 1})) : []),
    ...(hasPlace ? lostRuns.map((r) => ({index: r.from, kind: 'lost', count: r.to - r.from + 1})) : []),
  ].sort((a, b) => a.index - b.index).map((event, key) => ({...event, key, text: sentence(event)}));

  // ---- decoding ----

  const kMostPixelsKept = 8e6;  // about 5 bytes each
  const mapsOf = keptLast(decode, () => Math.max(4, Math.floor(kMostPixelsKept / (width * height || 1))));
  async function decode(index) {
    const packed = block(`maps-${index}`);
    const [picture, labels] = await Promise.all([decodedPicture(packed.left), unpacked(packed.tracks, width * height)]);
    return {picture, labels};
  }

  // ---- what is shown ----

  const state = {
    frame: 0,
    maps: null,
    near: null,     // the track under the pointer
    picked: null,   // the track that was clicked, in all frames
    mode: 0,
    speed: 1,
    curve: null,
  };
  const current = () => frames[state.frame];
  const chosenTrack = () => state.near ?? state.picked;
  const stateOf = (track) => `${words(track.state)}${isSeen(track) || track.state !== 'confirmed' ? '' : ', missed'}`;

  // ---- the picture ----

  const kModes = ['Masks', 'Outlines', 'Picture alone'];
  const screen = {};
  function makeScreen() {
    screen.picture = el('canvas', {width, height, class: 'smooth'});
    screen.labels = el('canvas', {width, height});
    screen.marks = el('div');
    screen.box = el('div', {class: 'screen'}, screen.picture, screen.labels, screen.marks);
    screen.count = el('span', {class: 'count'});
    screen.pixels = new ImageData(Math.max(1, width), Math.max(1, height));
    const select = el('select', {title: 'Overlay on the image (m)', 'aria-label': 'Overlay on the image', onchange: (event) => {
      state.mode = event.target.selectedIndex;
      paintScreen();
    }}, kModes.map((name) => el('option', {}, name)));
    screen.select = select;
    const stage = el('div', {class: 'stage'}, screen.box);
    screen.box.addEventListener('pointermove', (event) => {
      const track = trackUnder(event);
      near(track?.id ?? null);
      if (track) showTip(event, ...described(track));
      else hideTip();
    });
    screen.box.addEventListener('pointerleave', () => { near(null); hideTip(); });
    screen.box.addEventListener('click', (event) => pick(trackUnder(event)?.id ?? null));
    byId('pictures').append(el('figure', {class: 'panel', 'data-panel': 'picture'}, el('figcaption', {}, select, screen.count), stage));
    document.documentElement.style.setProperty('--aspect', width && height ? width / height : 4 / 3);
  }
  function trackUnder(event) {
    const at = state.maps?.labels && pixelUnder(event, screen.box, {width, height});
    return (at && current().trackOf[state.maps.labels[at.i]]) || null;
  }
  function described(track) {
    const depth = depthOf(track, current()), speed = speedOf(track);
    return [el('div', {class: 'at'}, `track ${track.id}${track.landmark > 0 ? `, landmark ${track.landmark}` : ''}`), rows([
      ['state', stateOf(track)],
      ['distance', depth === null ? null : `${fixed(depth, 2)} m`],
      ['x, y, z', track.position_m ? `${track.position_m.map((v) => fixed(v, 2)).join(', ')} m` : null],
      ['speed', track.moving && isNumber(speed) ? `${fixed(speed, 2)} m/s` : null],
      ['confidence', fixed(track.confidence, 2)],
      ['seen', isNumber(track.hits) ? counted(track.hits, 'frame') : null],
    ])];
  }
  /** The image and its masks; the images' own pixels only when the frame changes. */
  function paintScreen(otherPicture = false) {
    const {picture, labels} = state.maps, facts = current();
    if (otherPicture) {
      const context = screen.picture.getContext('2d');
      if (picture) context.drawImage(picture, 0, 0, width, height);
      else context.clearRect(0, 0, width, height);
    }
    const plain = state.mode === 2 || !labels;
    screen.picture.classList.toggle('faded', !plain);
    screen.labels.hidden = plain;
    const chosen = chosenTrack(), slot = chosen === null ? null : facts.byTrack.get(chosen)?.slot ?? null;
    const shown = facts.marks.filter(({id}) => facts.trackOf[id] && counts(facts.trackOf[id]));
    if (!plain) {
      const out = new Uint32Array(screen.pixels.data.buffer);
      const colourOf = (id) => (facts.trackOf[id] && counts(facts.trackOf[id]) ? idColour(facts.trackOf[id].id) : null);
      paintLabels(out, labels, width, colourOf, slot, state.mode === 1);
      screen.labels.getContext('2d').putImageData(screen.pixels, 0, 0);
    }
    const names = plain && state.mode === 2 ? [] : marks(shown, (id) => {
      const depth = depthOf(facts.trackOf[id], facts);
      return `${facts.trackOf[id].id}${depth === null ? '' : `: ${fixed(depth, 2)} m`}`;
    }, slot, {width, height});
    shown.forEach(({id}, i) => names[i]?.classList.toggle('moving', facts.trackOf[id].moving));
    screen.marks.replaceChildren(...names);
    partMarks(names);
    const moving = facts.tracks.filter((track) => counts(track) && track.moving).length;
    screen.count.textContent = `${counted(shown.length, 'track')} in view${moving ? `, ${moving} moving` : ''}`;
  }

  // ---- from above ----

  const above = {nodes: new Map(), follows: false, zoom: 1, middle: null, fit: null};
  /** The bounding box of the camera's path and of all tracks but the farthest 1 %. */
  function extent() {
    const xs = [], ys = [];
    for (const facts of frames) {
      for (const track of facts.tracks) {
        if (!counts(track) || !track.position_m?.every(isNumber)) continue;
        xs.push(track.position_m[0]);
        ys.push(track.position_m[1]);
      }
    }
    const span = (list, way) => {
      list.sort((a, b) => a - b);
      const at = (share) => list[Math.round(share * (list.length - 1))];
      const all = list.length ? [at(0.01), at(0.99), ...way] : way;
      return all.length ? [Math.min(...all), Math.max(...all)] : [-1, 1];
    };
    const way = frames.filter((facts) => facts.pose).map((facts) => facts.pose.position_m);
    return {x: span(xs, way.map((p) => p[0])), y: span(ys, way.map((p) => p[1]))};
  }
  /** Positions in the map as pixels of the drawing: x goes up, y to the left. */
  const toDrawing = ([x, y]) => [above.wide / 2 - above.scale * (y - above.centre[1]), above.high / 2 - above.scale * (x - above.centre[0])];
  const text2 = (p) => `${p[0].toFixed(1)},${p[1].toFixed(1)}`;

  function makeAbove() {
    if (!hasPlace) {
      byId('pictures').append(el('figure', {class: 'panel', 'data-panel': 'above'}, el('figcaption', {}, el('h2', {}, 'From above')),
        el('div', {class: 'stage'}, el('div', {class: 'none'}, rig ? 'camera position unknown' : 'no calibration: no metres'))));
      return;
    }
    above.fit = extent();
    above.layers = Object.fromEntries(['grid', 'way', 'walked', 'moved', 'landmarks', 'camera', 'tracks'].map((name) => [name, svg('g')]));
    above.drawing = svg('svg', {class: 'above', role: 'img', 'aria-label': 'Top view of the tracks'},
      svg('defs', {}, svg('marker', {id: 'tip-of-arrow', viewBox: '0 0 8 8', refX: 7, refY: 4, markerWidth: 7, markerHeight: 7, orient: 'auto-start-reverse'},
        svg('path', {d: 'M0 0L8 4L0 8Z', fill: 'context-stroke'}))),
      ...Object.values(above.layers));
    above.walked = svg('path', {class: 'walked'});
    above.layers.walked.append(above.walked);
    const doubt = svg('ellipse', {class: 'doubt'}), sight = svg('path', {class: 'sight'}), eye = svg('circle', {class: 'eye', r: 4.5});
    Object.assign(above, {doubt, sight, eye});
    above.layers.camera.append(sight, doubt, eye);
    const button = (name, title, onclick, more = {}) => el('button', {type: 'button', title, 'aria-label': title, onclick, ...more}, name);
    above.followButton = button('follow', 'Centre the camera', () => {
      above.follows = !above.follows;
      if (above.follows && above.zoom < 2) above.zoom = 2;
      above.middle = null;
      layOutAbove();
    }, {'aria-pressed': 'false'});
    const buttons = el('div', {class: 'choice', role: 'group', 'aria-label': 'Top view'},
      button('whole', 'The whole run', () => {
        Object.assign(above, {zoom: 1, middle: null, follows: false});
        layOutAbove();
      }), above.followButton,
      button('−', 'Farther', () => zoom(1 / 1.4)), button('+', 'Nearer', () => zoom(1.4)));
    above.count = el('span', {class: 'count'});
    above.stage = el('div', {class: 'stage'}, above.drawing);
    byId('pictures').append(el('figure', {class: 'panel', 'data-panel': 'above'},
      el('figcaption', {}, el('h2', {}, 'From above'), above.count, buttons), above.stage));

    const trackAt = (event) => {
      const node = event.target.closest?.('.track');
      return node ? Number(node.dataset.key) : null;
    };
    above.drawing.addEventListener('pointermove', (event) => {
      if (event.buttons) return;
      const id = trackAt(event), track = id === null ? null : current().byTrack.get(id);
      near(id);
      if (track) showTip(event, ...described(track));
      else hideTip();
    });
    above.drawing.addEventListener('pointerleave', () => { near(null); hideTip(); });
    let dragged = null;  // since the button was pressed
    above.stage.addEventListener('pointerdown', (event) => {
      if (event.button === 0 && event.pointerType !== 'touch') dragged = {x: event.clientX, y: event.clientY, centre: above.centre, far: false};
    });
    addEventListener('pointermove', (event) => {
      if (!dragged || !event.buttons) return;
      const [dx, dy] = [event.clientX - dragged.x, event.clientY - dragged.y];
      if (Math.hypot(dx, dy) < 4 && !dragged.far) return;
      dragged.far = true;
      above.follows = false;
      above.middle = [dragged.centre[0] + dy / above.scale, dragged.centre[1] + dx / above.scale];
      layOutAbove();
    });
    addEventListener('pointerup', () => setTimeout(() => { dragged = null; }));
    above.stage.addEventListener('click', (event) => { if (!dragged?.far) pick(trackAt(event)); });
    above.stage.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.metaKey) return;  // otherwise the page scrolls
      event.preventDefault();
      zoom(Math.exp(-event.deltaY / 300));
    }, {passive: false});
    new ResizeObserver(() => layOutAbove()).observe(above.stage);
  }
  function zoom(factor) {
    above.zoom = Math.min(60, Math.max(0.3, above.zoom * factor));
    layOutAbove();
  }

  function layOutAbove() {
    if (!above.stage?.clientWidth) return;
    const {x, y} = above.fit;
    above.wide = above.stage.clientWidth;
    above.high = above.stage.clientHeight;
    const room = Math.min((above.high - 56) / Math.max(0.5, x[1] - x[0]), (above.wide - 72) / Math.max(0.5, y[1] - y[0]));
    above.scale = room * above.zoom;
    above.followButton.setAttribute('aria-pressed', above.follows);
    above.drawing.setAttribute('viewBox', `0 0 ${above.wide} ${above.high}`);
    centreAbove();
    drawGround();
    drawAbove();
  }
  function centreAbove() {
    const {x, y} = above.fit, camera = current().pose?.position_m;
    above.centre = above.follows && camera ? camera.slice(0, 2) : above.middle ?? [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2];
  }
  /** The layer that is the same in all frames, as long as the view is. */
  function drawGround() {
    const {wide, high, scale, centre} = above;
    const step = roundStep(Math.max(wide, high) / scale, 9);
    const lines = [], names = [];
    const digits = step < 1 ? 1 : 0;
    for (let n = Math.ceil((centre[0] - high / 2 / scale) / step); n * step < centre[0] + high / 2 / scale; ++n) {
      const at = toDrawing([n * step, 0])[1];
      lines.push(`M0 ${at.toFixed(1)}H${wide}`);
      if (at > 30 && at < high - 20) names.push(svg('text', {class: 'axis', x: 5, y: (at - 3).toFixed(1)}, `${fixed(n * step, digits)}`));
    }
    for (let n = Math.ceil((centre[1] - wide / 2 / scale) / step); n * step < centre[1] + wide / 2 / scale; ++n) {
      const at = toDrawing([0, n * step])[0];
      lines.push(`M${at.toFixed(1)} 0V${high}`);
      if (at > 30 && at < wide - 66) names.push(svg('text', {class: 'axis', x: (at + 3).toFixed(1), y: high - 5}, `${fixed(n * step, digits)}`));
    }
    names.push(svg('text', {class: 'axis', x: 5, y: 13}, '↑ x m'), svg('text', {class: 'axis', x: wide - 36, y: high - 5}, '← y m'));
    const [ox, oy] = toDrawing([0, 0]);
    above.layers.grid.replaceChildren(svg('path', {class: 'grid', d: lines.join('')}), ...names,
      svg('path', {class: 'origin', d: `M${ox - 5} ${oy}h10M${ox} ${oy - 5}v10`}));
    above.count.textContent = `grid of ${step} m`;
    // One piece per frame, so that the path up to a frame is a prefix.
    let broken = true;
    above.pieces = frames.map((facts) => {
      if (!facts.pose) {
        broken = true;
        return '';
      }
      const piece = `${broken ? 'M' : 'L'}${text2(toDrawing(facts.pose.position_m))}`;
      broken = false;
      return piece;
    });
    above.layers.way.replaceChildren(svg('path', {class: 'way', d: above.pieces.join('')}));
    above.layers.landmarks.replaceChildren(...run.landmarks.map((l) => {
      const [lx, ly] = toDrawing(l.position_m);
      return svg('path', {class: `landmark${l.gone ? ' gone' : ''}`, 'data-since': sinceOf(l.id), stroke: '#9fb4c7', d: `M${lx} ${ly - 9}l9 9l-9 9l-9 -9Z`},
        svg('title', {}, `landmark ${l.id}${l.name ? `, ${l.name}` : ''}${l.gone ? ': gone' : ''}`));
    }));
  }
  /** The axes of a covariance: half their lengths in m, and the angle of the longer one in the drawing. */
  function ellipse(covariance, columns) {
    const xx = covariance[0], xy = covariance[1], yy = covariance[columns + 1];
    if (![xx, xy, yy].every(isNumber)) return {rx: 0, ry: 0, turned: 0};
    const middle = (xx + yy) / 2, apart = Math.hypot((xx - yy) / 2, xy);
    const angle = 0.5 * Math.atan2(2 * xy, xx - yy);  // from x to y in the map
    // In the drawing x points up and y to the left: the angle is counted clockwise from the right.
    return {rx: kChi2 * Math.sqrt(middle + apart), ry: kChi2 * Math.sqrt(Math.max(0, middle - apart)), turned: -90 - angle * 180 / Math.PI};
  }

  function trackNode(id) {
    if (above.nodes.has(id)) return above.nodes.get(id);
    const colour = idColour(id);
    const parts = {
      trail: svg('path', {class: 'trail', stroke: colour}), ellipse: svg('ellipse', {class: 'ellipse', stroke: colour, fill: colour}),
      speed: svg('path', {class: 'speed', stroke: colour, 'marker-end': 'url(#tip-of-arrow)'}), dot: svg('circle', {class: 'dot', r: 5, fill: colour}), text: svg('text', {}, String(id)),
    };
    parts.group = svg('g', {class: 'track', 'data-key': id}, ...Object.values(parts));
    above.nodes.set(id, parts);
    return parts;
  }
  /** The path of a track in the last seconds, up to this frame. */
  function trailOf(id) {
    const life = lives.get(id);
    if (!life) return '';
    const points = [];
    for (let k = life.at.length - 1; k >= 0; --k) {
      const index = life.at[k];
      if (index > state.frame) continue;
      if (seconds[state.frame] - seconds[index] > kTrailSeconds) break;
      points.push(text2(toDrawing(frames[index].byTrack.get(id).position_m)));
    }
    return points.length > 1 ? `M${points.join('L')}` : '';
  }
  function drawAbove() {
    if (!above.pieces) return;
    const facts = current();
    set(above.walked, {d: above.pieces.slice(0, state.frame + 1).join('') || 'M0 0'});
    for (const node of above.layers.landmarks.childNodes) node.setAttribute('visibility', Number(node.dataset.since) <= state.frame ? 'visible' : 'hidden');
    const camera = facts.pose;
    for (const node of [above.sight, above.doubt, above.eye]) node.setAttribute('visibility', camera ? 'visible' : 'hidden');
    if (camera) {
      const [cx, cy] = toDrawing(camera.position_m), reach = Math.min(above.wide, above.high) * 0.2;
      set(above.eye, {cx, cy});
      set(above.sight, {d: sightOf(facts, [cx, cy], reach)});
      const {rx, ry, turned} = ellipse(camera.covariance_m2 ?? [], 3);
      set(above.doubt, {rx: rx * above.scale, ry: ry * above.scale, transform: `translate(${cx} ${cy}) rotate(${turned})`});
    }
    const places = facts.tracks.filter((track) => track.position_m?.every(isNumber));
    const shown = places.map((track) => {
      const parts = trackNode(track.id), [x, y] = toDrawing(track.position_m), {rx, ry, turned} = ellipse(track.covariance_m2 ?? [], 3);
      set(parts.ellipse, {rx: rx * above.scale, ry: ry * above.scale, transform: `translate(${x} ${y}) rotate(${turned})`});
      set(parts.dot, {cx: x, cy: y});
      set(parts.text, {x: x + 7, y: y - 6});
      set(parts.trail, {d: track.moving || track.id === state.picked || lives.get(track.id)?.moved ? trailOf(track.id) : ''});
      const v = track.velocity_m_s, to = v && track.moving ? toDrawing([track.position_m[0] + v[0], track.position_m[1] + v[1]]) : null;
      set(parts.speed, {d: to && Math.hypot(to[0] - x, to[1] - y) > 3 ? `M${x} ${y}L${text2(to)}` : ''});
      parts.kind = `track ${track.state}${isSeen(track) ? '' : ' unseen'}`;
      return parts;
    });
    const nodes = shown.map((parts) => parts.group), layer = above.layers.tracks;
    if (nodes.length !== layer.childNodes.length || nodes.some((node, i) => node !== layer.childNodes[i])) layer.replaceChildren(...nodes);
    above.layers.moved.replaceChildren(...events.filter((e) => e.kind === 'moved' && e.index <= state.frame && e.from_m && e.to_m).map((e) =>
      svg('path', {class: 'moved', stroke: e.track > 0 ? idColour(e.track) : colourOfKind('moved'), d: `M${text2(toDrawing(e.from_m))}L${text2(toDrawing(e.to_m))}`},
        svg('title', {}, e.text))));
    markAbove();
  }
  function sightOf(facts, [cx, cy], reach) {
    const [right, left] = sideAngles(facts.mapFromCamera, rig, width).map((angle) => text2([cx - reach * Math.sin(angle), cy - reach * Math.cos(angle)]));
    return `M${text2([cx, cy])}L${right}A${reach} ${reach} 0 0 0 ${left}Z`;
  }
  function markAbove() {
    const chosen = chosenTrack();
    for (const [id, parts] of above.nodes) {
      parts.group.setAttribute('class', `${parts.kind}${chosen === null ? '' : id === chosen ? ' chosen' : ' dim'}`);
    }
  }

  // ---- the time line ----

  const reliabilityOf = (facts) => facts.reliability?.reliability ?? facts.reliability ?? facts.motion.reliability;
  const kCurves = [
    {name: 'reliability', value: reliabilityOf, top: 1, show: (v) => fixed(v, 2)},
    {name: 'inlier share', value: (f) => (hasPlace && f.index > 0 && f.motion.followed > 0 ? f.motion.inliers / f.motion.followed : null), top: 1, show: (v) => percent(v, 0)},
    {name: 'tracks in view', value: (f) => f.tracks.filter((t) => counts(t) && isSeen(t)).length, show: (v) => fixed(v, 0)},
    {name: 'ms per frame', value: (f) => f.ms, show: (v) => `${fixed(v, 1)} ms`},
  ];
  const offered = kCurves.map((curve) => ({...curve, values: frames.map((f) => curve.value(f) ?? null)})).filter(({values}) => values.some(isNumber));
  const kInset = 8;  // px: half of the slider's thumb
  const kEventRow = 15, kCurveRow = 46;
  const lanes = [...lives.values()].sort((a, b) => b.at.length - a.at.length).slice(0, 60).sort((a, b) => a.at[0] - b.at[0] || a.id - b.id);
  const laneHeight = Math.max(3, Math.min(9, Math.floor(110 / (lanes.length || 1))));
  const lanesAt = kEventRow + kCurveRow + 6;
  const strip = {wide: 0};
  const timeX = (index) => kInset + (run.frames > 1 ? index / (run.frames - 1) : 0) * (strip.wide - 2 * kInset);
  const frameAt = (x) => Math.min(run.frames - 1, Math.max(0, Math.round((x - kInset) / (strip.wide - 2 * kInset) * (run.frames - 1))));
  const themed = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  function drawStrip() {
    const canvas = byId('strip').querySelector('canvas'), high = lanesAt + lanes.length * laneHeight + 4;
    byId('strip').style.setProperty('--strip', `${high}px`);
    strip.wide = byId('strip').clientWidth;
    const sharp = devicePixelRatio || 1;
    canvas.width = strip.wide * sharp;
    canvas.height = high * sharp;
    const g = canvas.getContext('2d');
    g.scale(sharp, sharp);
    const half = Math.max(1, (timeX(1) - timeX(0)) / 2);
    const band = ({from, to}, colour) => {
      g.fillStyle = colour;
      g.fillRect(timeX(from) - half, kEventRow, timeX(to) - timeX(from) + 2 * half, high - kEventRow);
    };
    if (hasPlace) for (const r of refusedRuns) band(r, themed('--band-refused'));
    if (hasPlace) for (const r of lostRuns) band(r, themed('--band-lost'));
    // Gaps in the sequence.
    g.strokeStyle = themed('--quiet');
    g.setLineDash([2, 3]);
    for (let k = 1; k < run.frames; ++k) {
      if (seconds[k] - seconds[k - 1] <= kLongestPause) continue;
      const x = (timeX(k) + timeX(k - 1)) / 2;
      g.beginPath();
      g.moveTo(x, kEventRow);
      g.lineTo(x, high);
      g.stroke();
    }
    g.setLineDash([]);
    g.strokeStyle = themed('--line');
    for (const y of [kEventRow + 0.5, kEventRow + kCurveRow + 0.5]) {
      g.beginPath();
      g.moveTo(kInset, y);
      g.lineTo(strip.wide - kInset, y);
      g.stroke();
    }
    const curve = offered[state.curve];
    if (curve) {
      const known = curve.values.filter(isNumber), top = curve.top ?? Math.max(1e-9, ...known) * 1.05;
      const y = (v) => kEventRow + kCurveRow - (kCurveRow - 6) * Math.min(1, Math.max(0, v / top));
      g.strokeStyle = g.fillStyle = themed('--accent');
      g.lineWidth = 1.5;
      let open = false;
      g.beginPath();
      curve.values.forEach((v, index) => {
        if (!isNumber(v)) {
          open = false;
          return;
        }
        if (open) g.lineTo(timeX(index), y(v));
        else g.moveTo(timeX(index), y(v));
        open = true;
      });
      g.stroke();
      const name = `${curve.name}, 0 … ${curve.show(top)}`;
      g.font = '11px system-ui, sans-serif';
      g.globalAlpha = 0.8;
      g.fillStyle = themed('--card');
      g.fillRect(kInset + 1, kEventRow + kCurveRow - 16, g.measureText(name).width + 6, 15);
      g.globalAlpha = 1;
      g.fillStyle = themed('--quiet');
      g.fillText(name, kInset + 4, kEventRow + kCurveRow - 5);
    }
    lanes.forEach((life, row) => {
      const y = lanesAt + row * laneHeight, colour = idColour(life.id), chosen = chosenTrack();
      g.globalAlpha = chosen === null || chosen === life.id ? 1 : 0.2;
      g.fillStyle = colour;
      let begin = 0;
      const kind = (k) => {
        const track = frames[life.at[k]].byTrack.get(life.id);
        return isSeen(track) ? (track.moving ? 2 : 1) : 0;
      };
      for (let k = 1; k <= life.at.length; ++k) {
        if (k < life.at.length && life.at[k] === life.at[k - 1] + 1 && kind(k) === kind(begin)) continue;
        const x = timeX(life.at[begin]) - half, w = timeX(life.at[k - 1]) + half - x, what = kind(begin);
        // In view: a bar, thicker while moving; out of view, but remembered: a thin line.
        const thick = what === 2 ? laneHeight - 1 : what === 1 ? Math.max(2, laneHeight - 4) : 1;
        g.fillRect(x, y + (laneHeight - thick) / 2, w, thick);
        begin = k;
      }
      g.globalAlpha = 1;
    });
    for (const event of events) {
      const x = timeX(event.index);
      g.fillStyle = colourOfKind(event.kind);
      g.beginPath();
      g.moveTo(x - 4, 2);
      g.lineTo(x + 4, 2);
      g.lineTo(x, 11);
      g.fill();
    }
    movePlayhead();
  }
  function movePlayhead() {
    byId('playhead').style.transform = `translateX(${timeX(wanted)}px)`;
  }
  function describeTime(event) {
    const box = byId('strip').getBoundingClientRect(), index = frameAt(event.clientX - box.left), facts = frames[index];
    const lane = lanes[Math.floor((event.clientY - box.top - lanesAt) / laneHeight)];
    const onLane = event.clientY - box.top >= lanesAt && lane && facts.byTrack.get(lane.id);
    const reach = Math.max(1, Math.ceil(5 / Math.max(1e-9, timeX(1) - timeX(0))));
    const close = events.filter((e) => Math.abs(e.index - index) < Math.min(reach, 20)).slice(0, 5);
    showTip(event, el('div', {class: 'at'}, `${index + 1} / ${run.frames}, ${facts.name}, ${fixed(seconds[index], 2)} s`),
      rows([
        ...offered.map((curve) => [curve.name, isNumber(curve.values[index]) ? curve.show(curve.values[index]) : null]),
        ['motion refused', facts.pose && refusalOf(facts) ? words(refusalOf(facts)) : null],
        ['place', facts.pose || !hasPlace ? null : 'unknown'],
        ['track', onLane ? `${lane.id}: ${stateOf(onLane)}` : null],
      ]), ...close.map((e) => group(null, [[`frame ${e.index + 1}`, e.text]])));
  }
  function timeLegend() {
    const kinds = [...new Set(events.map((e) => e.kind))].filter((kind) => kind !== 'refused' && kind !== 'lost');
    byId('time-legend').replaceChildren(el('div', {class: 'chips'},
      kinds.map((kind) => chip(colourOfKind(kind), words(kind), undefined, {title: counted(events.filter((e) => e.kind === kind).length, 'event')})),
      hasPlace && refusedRuns.length ? chip(kKinds.refused, 'motion refused') : null,
      hasPlace && lostRuns.length ? chip(kKinds.lost, 'position unknown') : null,
      lanes.length ? el('span', {}, `one line per track: thick while in view, thickest while moving${lives.size > lanes.length ? `; the ${lanes.length} longest of ${lives.size}` : ''}`) : null));
  }

  // ---- tables ----

  const tables = {};
  function makeTables() {
    const columns = [
      {name: 'id', value: (t) => t.id, show: (t) => [swatch(idColour(t.id)), t.id]},
      {name: 'state', text: true, value: (t) => stateOf(t), show: stateOf},
      {name: 'moving', text: true, value: (t) => (t.moving ? 0 : 1), show: (t) => (t.moving ? 'moving' : '')},
    ];
    if (hasPlace) {
      columns.push(number('distance m', (t) => depthOf(t, current()), 2, {title: 'along the axis of the camera'}),
        number('x m', (t) => t.position_m?.[0], 2, {title: 'in the map: forward from the start'}),
        number('y m', (t) => t.position_m?.[1], 2, {title: 'in the map: to the left'}),
        number('z m', (t) => t.position_m?.[2], 2, {title: 'in the map: up'}),
        number('± m', (t) => (t.covariance_m2 ? ellipse(t.covariance_m2, 3).rx : null), 2, {title: 'semi-major axis of the 95 % ellipse of its position'}),
        number('speed m/s', (t) => (t.moving ? speedOf(t) : null), 2));
    }
    columns.push(number('confidence', (t) => t.confidence, 2), number('seen', (t) => t.hits, 0, {title: 'frames'}));
    if (frames.some((f) => f.tracks.some((t) => t.landmark > 0))) {
      columns.push(number('landmark', (t) => (t.landmark > 0 ? t.landmark : null), 0));
    }
    tables.tracks = table('tracks', columns, [], {
      key: (t) => t.id, pickRow: (t) => pick(t.id), selected: (t) => t.id === state.picked,
      enter: (t) => near(t?.id ?? null),
    });
    tables.count = el('span', {class: 'note'});
    const tracksCard = card('Tracks', null, tables.tracks);
    tracksCard.querySelector('.head').append(tables.count);
    const eventColumns = [
      {name: 'frame', value: (e) => e.index, show: (e) => String(e.index + 1)},
      number('s', (e) => seconds[e.index], 1),
      {name: 'event', text: true, value: (e) => e.kind, show: (e) => [el('span', {class: 'kind', style: {background: colourOfKind(e.kind)}}), e.text]},
    ];
    const eventsCard = events.length
      ? card('Events', `${events.length}`, table('events', eventColumns, events, {
          key: (e) => e.key,
          pickRow: (e) => {
            if (e.track > 0 && state.picked !== e.track) pick(e.track);
            go(e.index);
          },
          enter: (e) => near(e && e.track > 0 ? e.track : null),
        }))
      : card('Events', null, el('p', {class: 'empty'}, 'none'));
    byId('tables').append(tracksCard, eventsCard);
  }
  function fillTables() {
    const facts = current(), list = facts.tracks;
    tables.tracks.refill(list);
    for (const row of byId('tracks').tBodies[0].rows) row.classList.toggle('unseen', !isSeen(facts.byTrack.get(Number(row.dataset.key))));
    tables.count.textContent = `${list.filter(isSeen).length} seen, ${list.length} remembered`;
    const body = byId('events')?.tBodies[0];
    if (!body) return;
    let last = null;
    for (const row of body.rows) {
      const {index} = events[row.dataset.key];
      row.classList.toggle('later', index > state.frame);
      row.classList.toggle('now', index === state.frame);
      if (index <= state.frame) last = row;
    }
    if (playing && last && !body.matches(':hover')) scrollToRow(last);
  }

  // ---- the chosen track ----

  function near(id) {
    if (state.near === id) return;
    state.near = id;
    showChosen();
  }
  function pick(id) {
    state.picked = id === state.picked ? null : id;
    state.near = null;
    showChosen();
    drawAbove();  // its trail
    drawStrip();
    selectRow('tracks', state.picked);
  }
  function showChosen() {
    if (!state.maps) return;
    paintScreen();
    markAbove();
    markRow('tracks', state.near);
  }

  // ---- playing ----

  let wanted = 0;  // the frame requested last
  let drawn = null;
  let drawing = false;
  /** Shows the frame once it is decoded; if more were requested meanwhile, only the last of them. */
  function show(index) {
    wanted = Math.min(run.frames - 1, Math.max(0, index));
    const facts = frames[wanted];
    byId('slider').setAttribute('aria-valuetext', `${facts.name}, ${fixed(seconds[wanted], 2)} s`);
    nameFrame(wanted, facts.name, el('small', {}, `${wanted + 1} / ${run.frames}`), el('small', {}, `${fixed(seconds[wanted], 2)} s`));
    movePlayhead();
    if (!drawing) return draw();
  }
  async function draw() {
    drawing = true;
    while (drawn !== wanted) {
      const mine = wanted;
      try {
        state.maps = await mapsOf(mine);
      } catch (error) {
        trouble(`This frame cannot be shown: ${error.message}`);
        drawn = mine;
        continue;
      }
      state.frame = drawn = mine;
      paintScreen(true);
      if (above.follows) layOutAbove();
      else drawAbove();
      fillTables();
      byId('summary').replaceChildren(...summaryText());
      document.documentElement.dataset.shown = mine;
      afterwards(mine);
    }
    drawing = false;
  }
  let later = null;
  /** Updates that can wait until the pointer or the clock rests. */
  function afterwards(index) {
    clearTimeout(later);
    if (playing) {
      for (let k = 1; k <= 3 && index + k < run.frames; ++k) mapsOf(index + k).catch(() => {});
      return;
    }
    later = setTimeout(() => {
      if (run.frames > 1) history.replaceState(null, '', `#${wanted + 1}`);
      for (const k of [1, -1]) if (frames[wanted + k]) mapsOf(wanted + k).catch(() => {});
    }, 200);
  }

  const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 4, 8];
  let playing = null;  // {clock: ms of the page at which the sequence was at `from` s}
  function play() {
    if (run.frames < 2) return;
    if (wanted === run.frames - 1) show(0);
    const mine = playing = {clock: performance.now(), from: playedAt[wanted]};
    playButton(true);
    const tick = () => {
      if (playing !== mine) return;
      const at = mine.from + (performance.now() - mine.clock) / 1000 * state.speed;
      let index = wanted;
      while (index + 1 < run.frames && playedAt[index + 1] <= at) ++index;
      if (index !== wanted) show(index);
      if (index === run.frames - 1) return pause();
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
  function pause() {
    if (!playing) return;
    playing = null;
    playButton(false);
    afterwards(wanted);
  }
  const playOrPause = () => (playing ? pause() : play());
  function setSpeed(place) {
    if (!(place in kSpeeds)) return;
    state.speed = kSpeeds[place];
    byId('speed').selectedIndex = place;
    if (playing) Object.assign(playing, {clock: performance.now(), from: playedAt[wanted]});
  }
  /** Goes to a requested frame. */
  function go(index) {
    pause();
    return show(index);
  }
  const eventAfter = () => events.find((e) => e.index > wanted)?.index ?? wanted;
  const eventBefore = () => events.findLast((e) => e.index < wanted)?.index ?? wanted;

  // ---- the page ----

  let way = 0;  // m
  if (run.frames) frames[0].way = 0;
  for (let k = 1; k < run.frames; ++k) {
    const before = frames[k - 1].pose?.position_m, now = frames[k].pose?.position_m;
    frames[k].way = way += before && now ? Math.hypot(...now.map((v, i) => v - before[i])) : 0;
  }
  function summaryText() {
    const facts = current(), p = facts.pose?.position_m;
    const parts = [el('b', {}, `${counted(lives.size, 'track')} in ${counted(run.frames, 'frame')}`), `${fixed(seconds.at(-1), 1)} s`];
    if (hasPlace) parts.push(`${fixed(facts.way, 2)} of ${fixed(way, 2)} m`, p ? `camera at x ${fixed(p[0], 2)}, y ${fixed(p[1], 2)}, z ${fixed(p[2], 2)} m` : 'position unknown');
    else parts.push(rig ? 'position unknown' : 'no calibration: no metres');
    if (facts.pose && refusalOf(facts)) parts.push(`motion refused: ${words(refusalOf(facts))}`);
    if (isNumber(facts.ms)) parts.push(`${fixed(facts.ms, 1)} ms`);
    return parts.flatMap((part, i) => (i ? [' · ', part] : [part]));
  }

  function begin() {
    beginPage();
    if (!run.frames) return trouble('This sequence has no frames.');
    byId('about').textContent = `cairn ${run.cairn}. Space plays; ← and → step, with shift by ten; e leads to the next event; ` +
      'm changes the overlay. Click a track in the image, the top view or the table to follow it; Esc deselects it.';
    makeScreen();
    makeAbove();
    makeTables();
    byId('speed').append(...kSpeeds.map((speed) => el('option', {selected: speed === 1}, `${speed}×`)));
    byId('speed').addEventListener('change', (event) => setSpeed(event.target.selectedIndex));
    state.curve = offered.length ? 0 : null;
    byId('curve').append(...offered.map(({name}) => el('option', {}, name)));
    byId('curve').hidden = offered.length < 2;
    byId('curve').addEventListener('change', (event) => {
      state.curve = event.target.selectedIndex;
      drawStrip();
    });
    byId('next-event').hidden = !events.length;
    byId('next-event').addEventListener('click', (event) => go(event.shiftKey ? eventBefore() : eventAfter()));
    leadThroughFrames({wanted: () => wanted, go, playOrPause, more: () => ({e: eventAfter(), E: eventBefore()})});
    addEventListener('keydown', (event) => {
      if (event.altKey || event.ctrlKey || event.metaKey || event.target.matches?.('select')) return;
      if (event.key === 'Escape' && state.picked !== null) pick(null);
      if (event.key === '+' || event.key === '=') setSpeed(kSpeeds.indexOf(state.speed) + 1);
      if (event.key === '-') setSpeed(kSpeeds.indexOf(state.speed) - 1);
      if (event.key === 'm') {
        screen.select.selectedIndex = state.mode = (state.mode + 1) % kModes.length;
        paintScreen();
      }
    });
    // A list used with the pointer returns the keys to the player.
    addEventListener('change', ({target}) => { if (target.matches('select:not(:focus-visible)')) target.blur(); });
    byId('strip').addEventListener('pointermove', (event) => { if (event.pointerType !== 'touch') describeTime(event); });
    byId('strip').addEventListener('pointerleave', hideTip);
    timeLegend();
    drawStrip();
    new ResizeObserver(() => { if (byId('strip').clientWidth !== strip.wide) drawStrip(); }).observe(byId('strip'));
    // The curve uses the theme's colours.
    byId('theme').addEventListener('click', drawStrip);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawStrip);
    show(linkedFrame());
  }
  begin();
})();
