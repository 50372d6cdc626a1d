// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The page of `cairn segment --html` and `cairn evaluate --html`. Its data are JSON blocks next to this script
// (cairn/output/web/html_page.cpp): `run`, and for each frame `facts-N`, parsed at once, and `maps-N`, decoded when shown. It
// follows shared.js in one <script>.
(() => {
  // ---- data ----

  const evaluates = run.command === 'evaluate';
  const frames = Array.from({length: run.frames}, (_, i) => {
    const facts = block(`facts-${i}`);
    facts.rig = facts.result?.rig ?? null;
    facts.found = new Map((facts.result?.objects ?? []).map((o) => [o.id, o]));
    const scores = run.evaluation?.frames[i] ?? null;
    facts.scores = scores;
    facts.ours = new Map((scores?.objects?.ours ?? []).map((o) => [o.id, o]));
    facts.truth = new Map((scores?.objects?.true ?? []).map((t) => [t.id, t]));
    return facts;
  });

  async function disparities(map, count) {
    const steps = await unpacked(map, count);
    return steps && Float32Array.from(steps, (n) => (n === 0 ? NaN : map.low + (n - 1) / map.steps));
  }

  const kMostPixelsKept = 5e6;  // about 40 bytes each
  const mapsOf = keptLast(decode, (index) => Math.max(2, Math.floor(kMostPixelsKept / (frames[index].width * frames[index].height || 1))));
  async function decode(index) {
    const packed = block(`maps-${index}`);
    const count = frames[index].width * frames[index].height;
    const maps = {left: packed.left || null, right: packed.right || null, floor_frame: frames[index].result?.floor_frame ?? null};
    const names = ['reject', 'confidence', 'by_intensity', 'by_disparity', 'superpixels', 'groups', 'objects', 'space'];
    for (const name of names) maps[name] = await unpacked(packed[name], count);
    maps.disparity = await disparities(packed.disparity, count);
    maps.true_disparity = await disparities(packed.true_disparity, count);
    const truth = await unpacked(packed.true_objects, count);
    maps.true_objects = truth && Int32Array.from(truth, (n) => n - 1);  // −1 = don't care
    for (const source of [maps.left, maps.right]) await decodedPicture(source);  // so that it is shown without delay
    return maps;
  }

  // ---- what is shown ----

  const state = {
    frame: 0,
    maps: null,
    columns: 0,        // 0: as many as fit
    modes: {},         // panel → index of its mode
    reason: null,      // the hole reason that the legend points at
    near: null,        // the object under the pointer in a table or picture
    picked: null,      // the object that was clicked
    nearLeftOut: null, // the row under the pointer in the table of what is no object
    leftOut: null,     // the row that was clicked there
    bin: null,         // the histogram's bar that was clicked
    onlyThisFrame: false,
  };
  const current = () => frames[state.frame];

  const metres = (disparity) => metresOf(disparity, current().rig);
  /** Position of a pixel with a disparity in the left camera's frame, in m: x right, y down, z forward. Null without
      a rig. */
  function placeInCamera(x, y, disparity) {
    const {rig} = current(), z = metres(disparity);
    return isNumber(z) ? [(x - rig.cx_px) * z / rig.focal_px, (y - rig.cy_px) * z / rig.focal_px, z] : null;
  }
  /** The same position relative to the floor below the camera: x forward, y left, z up. Null without a floor. */
  function placeOnFloor(place) {
    const matrix = current().result?.floor_frame?.floor_from_camera;
    return place && matrix ? moved(matrix, place) : null;
  }
  const distanceText = (object) =>
    object?.position_m ? `${fixed(object.position_m[2], 2)} m`
      : isNumber(object?.disparity_px) ? `${fixed(object.disparity_px, 1)} px` : '';

  /** A true object has the colour of the matched object of ours; a missed one has none. */
  const kMissed = '#ff4d6a', kNotScored = '#b8bec6';
  const truthColour = (id) => {
    const ours = current().truth.get(id)?.ours;
    return ours ? idColour(ours) : current().truth.has(id) ? kMissed : kNotScored;
  };
  const reasonOf = (bits) => run.look.reasons.find((reason) => bits & reason.bit) ?? run.look.reasons[0];
  const reasonsOf = (bits) => run.look.reasons.filter((reason) => bits & reason.bit).map((r) => r.name);

  // Enough hues to distinguish neighbours; the assignment has no meaning.
  const kRegionColours = Array.from({length: 64}, (_, i) => {
    const hue = (i * 0.61803399) % 1, light = [0.62, 0.5, 0.74][i % 3];
    const channel = (shift) => {
      const k = (shift + hue * 12) % 12;
      const v = light - 0.55 * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
      return Math.round(255 * v).toString(16).padStart(2, '0');
    };
    return '#' + channel(0) + channel(8) + channel(4);
  });
  const kErrorClasses = [[0.5, '#2f6fb5'], [1, '#6db7d8'], [2, '#f2d16b'], [4, '#e8863a'], [Infinity, '#cf3d3d']];
  const kUnsure = '#d3632c', kSure = '#2b9c8d', kNothing = '#24272b';

  // ---- painting: each mode fills the pixels (0 = the picture shows through) and returns its legend ----

  function paintDisparity(out, disparity, reject) {
    const [low, high] = current().span;
    const ramp = run.look.ramp.map((c) => pixel(c)), pale = run.look.ramp.map((c) => pixel(mixed(c, kNothing, 0.8)));
    const holes = new Map(run.look.reasons.map((r) => [r.name, 0]));
    const colours = new Map(run.look.reasons.map((r) => [r.name, pixel(r.colour)]));
    let valid = 0;
    for (let i = 0; i < out.length; ++i) {
      if (!Number.isNaN(disparity[i])) {
        const share = Math.min(1, Math.max(0, (disparity[i] - low) / (high - low)));
        out[i] = (state.reason ? pale : ramp)[Math.round(share * 255)];
        ++valid;
        continue;
      }
      const name = reject ? reasonOf(reject[i]).name : null;
      if (name) holes.set(name, holes.get(name) + 1);
      out[i] = !name ? pixel(kNothing)
        : !state.reason ? colours.get(name)
          : reject[i] & state.reason ? pixel('#ff3df2') : pixel(mixed(reasonOf(reject[i]).colour, kNothing, 0.7));
    }
    const chips = run.look.reasons.filter((reason) => holes.get(reason.name)).map((reason) => chip(reason.colour, reason.name, holes.get(reason.name) / out.length, {
      onpointerenter: () => { state.reason = reason.bit; repaint('disparity', false); },
      onpointerleave: () => { state.reason = null; repaint('disparity', false); },
    }));
    return {count: `${percent(valid / out.length)} have one`, legend: [disparityScale(low, high), reject && el('div', {class: 'chips'}, chips)]};
  }

  function disparityScale(low, high) {
    const steps = [0, 1, 2, 3, 4].map((i) => low + (high - low) * i / 4);
    const text = (d) => {
      const z = metres(d);
      return [`${fixed(d, 1)} px`, isNumber(z) ? el('br') : null, isNumber(z) ? `${fixed(z, 2)} m` : null];
    };
    return el('div', {},
      el('div', {class: 'scale', style: {background: `linear-gradient(to right, ${run.look.ramp.filter((_, i) => i % 15 === 0).join(',')})`}}),
      el('div', {class: 'ticks'}, steps.map((d) => el('span', {}, text(d)))));
  }

  function paintConfidence(out, {confidence, disparity}) {
    const ramp = Array.from({length: 256}, (_, c) => pixel(mixed(kUnsure, kSure, c / 255)));
    let sure = 0, valid = 0;
    for (let i = 0; i < out.length; ++i) {
      const hole = Number.isNaN(disparity[i]);
      out[i] = hole ? pixel(kNothing) : ramp[confidence[i]];
      valid += hole ? 0 : 1;
      sure += !hole && confidence[i] >= 204 ? 1 : 0;
    }
    return {
      count: `${percent(valid ? sure / valid : NaN)} of them ≥ 0.8`,
      legend: [
        el('div', {class: 'scale', style: {background: `linear-gradient(to right, ${kUnsure}, ${kSure})`}}),
        el('div', {class: 'ticks'}, ['0', 'probability of an error below 1 px', '1'].map((t) => el('span', {}, t))),
        el('div', {class: 'chips'}, chip(kNothing, 'hole')),
      ],
    };
  }

  function paintError(out, {disparity, true_disparity: truth}) {
    const colours = kErrorClasses.map(([, c]) => pixel(c)), counts = kErrorClasses.map(() => 0);
    let known = 0, holes = 0;
    for (let i = 0; i < out.length; ++i) {
      out[i] = pixel('#000000');
      if (Number.isNaN(truth[i])) continue;
      ++known;
      if (Number.isNaN(disparity[i])) {
        ++holes;
        out[i] = pixel('#4b5057');
        continue;
      }
      const place = kErrorClasses.findIndex(([limit]) => Math.abs(disparity[i] - truth[i]) <= limit);
      ++counts[place];
      out[i] = colours[place];
    }
    const names = kErrorClasses.map(([limit], i) => limit === Infinity ? `over ${kErrorClasses[i - 1][0]} px` : `to ${limit} px`);
    return {
      count: `of ${percent(known / out.length, 0)} with truth`,
      legend: [el('div', {class: 'chips'},
        names.map((name, i) => chip(kErrorClasses[i][1], name, counts[i] / known)), chip('#4b5057', 'hole', holes / known),
        known < out.length ? chip('#000000', 'no ground truth') : null)],
    };
  }

  function paintRegions(out, labels) {
    const {width} = current();
    const colours = kRegionColours.map((c) => pixel(c, 150)), border = pixel('#111111', 190);
    const seen = new Set();
    for (let i = 0; i < out.length; ++i) {
      seen.add(labels[i]);
      out[i] = onBorder(labels, i, width) ? border : colours[labels[i] % colours.length];
    }
    return {count: counted(seen.size, 'region'), legend: []};
  }

  function paintFound(out, {objects}) {
    const chosen = state.near ?? state.picked;
    paintLabels(out, objects, current().width, idColour, chosen);
    const {found, objects: places, ours} = current();
    return {
      count: counted(places.length, 'object'),
      marks: marks(places, (id) => [id, distanceText(found.get(id))].filter((t) => t !== '').join(': '), chosen, current()),
      legend: evaluates && ours.size ? [el('div', {class: 'chips'}, verdicts())] : [],
    };
  }
  function verdicts() {
    const all = [...current().ours.values()];
    const right = all.filter((o) => o.iou >= 0.5).length, phantoms = all.filter((o) => o.phantom).length;
    return [`${right} of ${all.length} with IoU ≥ 0.5`, counted(phantoms, 'phantom')].map((t) => el('span', {}, t));
  }

  function errorText(score) {
    if (!score) return 'not scored';
    return score.error === null ? 'missed' : `E ${fixed(100 * score.error, 0)} %`;
  }
  function paintTruth(out, {true_objects: labels}) {
    // A true object is selected together with the matched object of ours.
    const ours = state.near ?? state.picked;
    const chosen = ours === null ? null : [...current().truth.values()].find((t) => t.ours === ours)?.id ?? -2;
    paintLabels(out, labels, current().width, truthColour, chosen);
    const {truth, true_objects: places} = current();
    return {
      count: counted(places.length, 'object'),
      marks: marks(places, (id) => `${id}: ${errorText(truth.get(id))}`, chosen, current()),
      legend: [el('div', {class: 'chips'}, el('span', {}, 'coloured like the best-matching object of ours'),
        [...truth.values()].some((t) => !t.ours) ? chip(kMissed, 'missed') : null,
        places.some(({id}) => !truth.has(id)) ? chip(kNotScored, 'not scored') : null)],
    };
  }

  const kScan = '#f2d16b', kSeen = '#23282d';
  const kSpaces = [['obstacle: object', '#d3632c'], ['obstacle: no object', '#f2d16b'], ['floor', '#2b9c8d'], ['sky', '#aad7fa'], ['unknown', kNothing]];
  const kFloor = 2;
  const kLabels = {128: kFloor, 64: 3};  // of space.png; 255: obstacle
  const spaceOf = ({space, objects}, i) => (space[i] === 255 ? (objects?.[i] > 0 ? 0 : 1) : kLabels[space[i]] ?? 4);

  /** All of the space, or one class of it. */
  function paintSpace(out, maps, only = null) {
    const shown = (kind) => only === null || only === kind;
    const colours = kSpaces.map(([, colour], kind) => (shown(kind) ? pixel(colour, 165) : 0)), counts = kSpaces.map(() => 0);
    for (let i = 0; i < out.length; ++i) {
      const kind = spaceOf(maps, i);
      ++counts[kind];
      out[i] = colours[kind];
    }
    const share = (...kinds) => percent(kinds.reduce((sum, kind) => sum + counts[kind], 0) / out.length);
    return {
      count: only === null ? `${share(0, 1)} obstacle` : share(only),
      legend: [el('div', {class: 'chips'}, kSpaces.map(([name, colour], kind) => (shown(kind) ? chip(colour, name, counts[kind] / out.length) : null)))],
    };
  }

  // ---- from above ----

  function cornersOf({centre_m: [x, y], size_m: [long, short], yaw_rad: yaw}) {
    const [ax, ay] = polar(long / 2, yaw), [bx, by] = polar(short / 2, yaw + Math.PI / 2);
    return [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([a, b]) => [x + a * ax + b * bx, y + a * ay + b * by]);
  }

  let drawnPlace = null;  // floor → drawing, of the current view from above
  function drawAbove() {
    const facts = current(), {obstacle_scan: scan, objects, config} = facts.result;
    const wide = 480, high = 360, bottom = 18;
    const dots = (scan?.ranges_m ?? []).flatMap((range, i) =>
      (range === null ? [] : [polar(range, scan.angle_min_rad + i * scan.angle_increment_rad)]));
    const boxes = objects.filter((o) => o.box_on_floor).map((o) => ({...o, corners: cornersOf(o.box_on_floor)})).reverse();  // nearest on top
    const places = [...dots, ...boxes.flatMap((o) => o.corners)];
    const reach = 1.05 * (places.length ? Math.max(...places.map((p) => Math.hypot(...p))) : config?.obstacles?.range ?? 6);
    const [right, left] = sideAngles(facts.result.floor_frame.floor_from_camera, facts.rig, facts.width);
    const beside = Math.max(reach * Math.sin(Math.max(-right, left)), ...places.map(([, y]) => Math.abs(y)));
    const scale = Math.min((high - bottom - 16) / reach, (wide / 2 - 34) / beside);
    const at = ([x, y]) => [wide / 2 - scale * y, high - bottom - scale * x].map((v) => v.toFixed(1));
    drawnPlace = at;
    const arc = (radius) => `M${at(polar(radius, right))}A${scale * radius} ${scale * radius} 0 0 0 ${at(polar(radius, left))}`;
    const step = roundStep(reach, 7);
    const rings = Array.from({length: Math.floor(reach / step)}, (_, i) => Number((step * (i + 1)).toPrecision(3)));
    const drawing = svg('svg', {class: 'above', viewBox: `0 0 ${wide} ${high}`, role: 'img', 'aria-label': 'Top view of the floor'},
      svg('path', {class: 'seen', fill: kSeen, d: `${arc(reach)}L${at([0, 0])}Z`}),
      ...rings.flatMap((radius) => {
        const [x, y] = at(polar(radius, right));
        return [svg('path', {class: 'ring', d: arc(radius)}), svg('text', {x: Number(x) + 4, y: Number(y) + 8}, `${radius} m`)];
      }),
      ...dots.map((dot) => svg('circle', {class: 'dot', fill: kScan, r: 2, cx: at(dot)[0], cy: at(dot)[1]})),
      ...boxes.map(({id, corners, box_on_floor: {centre_m: centre, size_m: size}}) => svg('g', {
        class: 'thing', 'data-key': id,
        onpointerenter: () => near(id), onpointerleave: () => near(null), onclick: () => pick(id === state.picked ? null : id),
      }, svg('polygon', {points: corners.map(at).join(' '), fill: idColour(id), stroke: mixed(idColour(id), '#ffffff', 0.4)}),
      svg('text', {x: at(centre)[0], y: Number(at(centre)[1]) + 4}, String(id)),
      svg('title', {}, `object ${id}: ${size.slice(0, 2).map((length) => fixed(length, 2)).join(' × ')} m, ${fixed(size[2], 2)} m high`))),
      svg('path', {class: 'camera', d: `M${at([0, 0])}l-7 10h14Z`}), svg('circle', {class: 'here', r: 6, visibility: 'hidden'}));
    return {
      drawing, count: `rings every ${step} m`,
      legend: [el('div', {class: 'chips'}, chip(kScan, 'obstacle scan'), chip(kSeen, 'field of view'), el('span', {}, 'numbered: the objects’ boxes on the floor'))],
    };
  }
  /** Rings a position in the view from above; removes the ring if there is none. */
  function ringAbove(onFloor) {
    const ring = document.querySelector('.above .here');
    if (!ring) return;
    const [x, y] = onFloor ? drawnPlace(onFloor) : [0, 0];
    set(ring, {cx: x, cy: y, visibility: onFloor ? 'visible' : 'hidden'});
  }

  /** panel → its modes; `needs` are the maps that it requires. */
  const kPanels = {
    left: [
      {name: 'Left image', needs: ['left'], base: 'plain'},
      {name: 'Right image', needs: ['right'], base: 'plain', picture: 'right'},
    ],
    disparity: [
      {name: 'Disparity', needs: ['disparity'], paint: (out, m) => paintDisparity(out, m.disparity, m.reject)},
      {name: 'Disparity error', needs: ['disparity', 'true_disparity'], paint: paintError},
      {name: 'True disparity', needs: ['true_disparity'], paint: (out, m) => paintDisparity(out, m.true_disparity, null)},
      {name: 'Confidence', needs: ['disparity', 'confidence'], paint: paintConfidence},
    ],
    ...(evaluates
      ? {truth: [{name: 'True objects', needs: ['true_objects'], base: 'faded', paint: paintTruth}]}
      : {regions: [
          {name: 'Regions by intensity', needs: ['by_intensity'], base: 'faded', paint: (out, m) => paintRegions(out, m.by_intensity)},
          {name: 'Regions by disparity', needs: ['by_disparity'], base: 'faded', paint: (out, m) => paintRegions(out, m.by_disparity)},
          {name: 'Superpixels', needs: ['superpixels'], base: 'faded', paint: (out, m) => paintRegions(out, m.superpixels)},
          {name: 'Groups', needs: ['groups'], base: 'faded', paint: (out, m) => paintRegions(out, m.groups)},
        ]}),
    objects: [{name: evaluates ? 'Objects found' : 'Objects', needs: ['objects'], base: 'faded', paint: paintFound}],
    space: [
      {name: 'Obstacles', needs: ['space'], base: 'faded', paint: (out, m) => paintSpace(out, m)},
      {name: 'Floor', needs: ['space'], base: 'plain', paint: (out, m) => paintSpace(out, m, kFloor)},
    ],
    ...(frames.some((facts) => facts.result?.floor_frame)
      ? {above: [{name: 'From above', needs: ['floor_frame'], draw: drawAbove}]} : {}),
  };

  const panels = {};
  function makePanels() {
    for (const name of Object.keys(kPanels)) {
      const stage = el('div', {class: 'stage'});
      if (name !== 'above') {
        stage.addEventListener('pointermove', (event) => point(event, name));
        stage.addEventListener('pointerleave', leave);
        stage.addEventListener('click', (event) => pickUnderPointer(event, name));
      }
      const caption = el('figcaption'), legend = el('div', {class: 'legend'});
      byId('panels').append(el('figure', {class: 'panel', 'data-panel': name}, caption, stage, legend));
      panels[name] = {stage, caption, legend};
      state.modes[name] = 0;
    }
  }

  function repaint(name, withLegend = true) {
    const {stage, caption, legend} = panels[name];
    const {width, height} = current();
    const offered = kPanels[name].filter((mode) => mode.needs.every((map) => state.maps[map]));
    const mode = offered[Math.min(state.modes[name], offered.length - 1)];
    const title = kPanels[name][0].name;
    stage.style.aspectRatio = mode?.draw || !width ? '4 / 3' : `${width} / ${height}`;
    if (!mode) {
      stage.replaceChildren(el('div', {class: 'none'}, 'not there'));
      caption.replaceChildren(el('h2', {}, title));
      legend.replaceChildren();
      return;
    }
    panels[name].isRight = mode.picture === 'right';
    const children = [], picture = state.maps[mode.picture ?? 'left'];
    if (mode.base && picture) children.push(el('img', {src: picture, alt: '', class: mode.base, draggable: 'false'}));
    let shown = {count: `${width} × ${height} px`, legend: [rigText()]};
    if (mode.paint) {
      const canvas = el('canvas', {width, height});
      const image = new ImageData(width, height);
      shown = mode.paint(new Uint32Array(image.data.buffer), state.maps);
      canvas.getContext('2d').putImageData(image, 0, 0);
      children.push(canvas);
    }
    if (mode.draw) {
      shown = mode.draw();
      children.push(shown.drawing);
    }
    stage.replaceChildren(...children, ...(shown.marks ?? []), ...leftOutBox(name));
    partMarks(shown.marks ?? []);
    if (!withLegend) return;
    const heading = offered.length === 1 ? el('h2', {}, mode.name)
      : el('select', {'aria-label': `Content of the panel ${title}`, onchange: (event) => {
          state.modes[name] = event.target.selectedIndex;
          repaint(name);
        }}, offered.map((other) => el('option', {selected: other === mode}, other.name)));
    caption.replaceChildren(heading, el('span', {class: 'count'}, shown.count));
    legend.replaceChildren(...shown.legend.filter(Boolean));
  }
  function rigText() {
    const {rig, result} = current();
    if (!rig) return result ? 'no calibration: no metres' : null;
    return `focal length ${fixed(rig.focal_px, 1)} px, baseline ${fixed(rig.baseline_m, 3)} m`;
  }
  /** The box of an obstacle that is not an object, while its row is hovered or selected. */
  function leftOutBox(name) {
    const left = state.nearLeftOut ?? state.leftOut;
    if (!left || name === 'above') return [];
    const [, , wide, high] = left.bbox, {width, height} = current();
    const [x, y] = panels[name].isRight ? inRight(left.bbox[0], left.bbox[1], left.disparity_px) : left.bbox;
    return [el('div', {class: 'box', style: {
      left: `${100 * x / width}%`, top: `${100 * y / height}%`, width: `${100 * wide / width}%`, height: `${100 * high / height}%`,
    }})];
  }
  function showLeftOut() {
    for (const box of document.querySelectorAll('.box')) box.remove();
    for (const [name, {stage}] of Object.entries(panels)) stage.append(...leftOutBox(name));
    ringLeftOut();
  }
  const ringLeftOut = () => ringAbove(placeOnFloor((state.nearLeftOut ?? state.leftOut)?.position_m));
  function repaintObjects() {
    for (const name of ['objects', 'truth']) if (panels[name] && state.maps) repaint(name, false);
    // Not redrawn, because that would replace the element under the pointer.
    const chosen = state.near ?? state.picked;
    for (const thing of document.querySelectorAll('.above .thing')) thing.classList.toggle('dim', chosen !== null && thing.dataset.key !== String(chosen));
  }
  /** The object under the pointer, outside of the images. */
  function near(id) {
    state.near = id;
    markRow('objects', id);
    repaintObjects();
  }

  // ---- the right picture ----

  /** The vertical shift of the right image there, if the frame was corrected for it. */
  function rowsLower(x) {
    const epipolar = current().result?.epipolar;
    return epipolar?.outcome === 'corrected' ? epipolar.rows + epipolar.rows_per_px * (x - (current().width - 1) / 2) : 0;
  }
  /** The position in the right image that matches (x, y) of the left one. */
  const inRight = (x, y, disparity) => [x - disparity, y + rowsLower(x - disparity)];
  /** The pixel of the left image matched with this one of the right: the nearest of several, or null. */
  function fromRight({x, y}) {
    const {width, height} = current(), {disparity} = state.maps;
    const row = Math.round(y - rowsLower(x));
    let best = null;
    for (let left = 0, i = row * width; disparity && row >= 0 && row < height && left < width; ++left, ++i) {
      if (Math.abs(left - disparity[i] - x) <= 0.5 && !(best && disparity[best.i] >= disparity[i])) best = {x: left, y: row, i};
    }
    return best;
  }

  // ---- the pointer ----

  /** The pixel of the left image under the pointer, or matched with the one under it. */
  function placeOf(event, name) {
    const {stage, isRight} = panels[name], at = pixelUnder(event, stage, current());
    return at && isRight ? fromRight(at) : at;
  }

  /** All data of one pixel. */
  function described({x, y, i}) {
    const {maps} = state, facts = current();
    const parts = [el('div', {class: 'at'}, `x ${x}, y ${y}`)];
    if (maps.disparity) {
      const d = maps.disparity[i], hole = Number.isNaN(d), truth = maps.true_disparity?.[i];
      const place = placeInCamera(x, y, d), above = placeOnFloor(place);
      parts.push(group(null, [
        ['disparity', hole ? 'none' : `${fixed(d, 2)} px`],
        ['refused', hole && maps.reject ? reasonsOf(maps.reject[i]).join(', ') : null],
        ['depth z', place ? `${fixed(place[2], 2)} m` : metres(d) === Infinity ? 'infinite' : null],
        ['x, y', place && `${fixed(place[0], 2)}, ${fixed(place[1], 2)} m`],
        ['above the floor', above && `${fixed(above[2], 2)} m`],
        ['confidence', !hole && maps.confidence ? fixed(maps.confidence[i] / 255, 2) : null],
        ['true disparity', maps.true_disparity ? (Number.isNaN(truth) ? 'unknown' : `${fixed(truth, 2)} px`) : null],
      ]));
    }
    if (maps.space) parts.push(group(null, [['space', kSpaces[spaceOf(maps, i)][0]]]));
    if (maps.by_intensity) {
      parts.push(group(null, [['region by intensity', maps.by_intensity[i]], ['by disparity', maps.by_disparity?.[i] ?? null]]));
    }
    if (maps.superpixels) {
      parts.push(group(null, [['superpixel', maps.superpixels[i]], ['group', maps.groups?.[i] ?? null]]));
    }
    const id = maps.objects?.[i] ?? 0;
    if (id > 0) {
      const object = facts.found.get(id), score = facts.ours.get(id);
      parts.push(group(`object ${id}`, [
        ['distance', distanceText(object) || null],
        ['confidence', object ? fixed(object.confidence, 2) : null],
        ['area', object ? `${object.area} px` : null],
        ['fits', score ? (score.true === null ? 'no true object' : `true object ${score.true}, IoU ${fixed(score.iou, 2)}`) : null],
      ]));
    }
    const trueId = maps.true_objects?.[i] ?? 0;
    if (trueId !== 0) {
      const score = facts.truth.get(trueId);
      parts.push(group(trueId < 0 ? 'truth: don’t care' : `true object ${trueId}`, trueId < 0 ? [] : [
        ['E', errorText(score).replace(/^E /, '')],
        ['best fit', score?.ours ? `object ${score.ours}, IoU ${fixed(score.iou, 2)}` : null],
      ]));
    }
    return parts;
  }

  function point(event, name) {
    const at = state.maps && placeOf(event, name);
    if (!at) return leave();
    showTip(event, ...described(at));
    const disparity = state.maps.disparity?.[at.i];
    for (const [other, {stage, isRight}] of Object.entries(panels)) {
      let cross = stage.querySelector('.cross');
      if (other === name || other === 'above' || (isRight && !isNumber(disparity))) {
        cross?.remove();
        continue;
      }
      const [x, y] = isRight ? inRight(at.x, at.y, disparity) : [at.x, at.y];
      if (!cross) stage.append(cross = el('div', {class: 'cross'}));
      cross.style.left = `${100 * (x + 0.5) / current().width}%`;
      cross.style.top = `${100 * (y + 0.5) / current().height}%`;
    }
    ringAbove(placeOnFloor(placeInCamera(at.x, at.y, disparity)));
    markRow('objects', state.maps.objects?.[at.i] ?? 0);
  }
  function leave() {
    hideTip();
    for (const cross of document.querySelectorAll('.cross')) cross.remove();
    ringLeftOut();
    for (const row of document.querySelectorAll('tr.near')) row.classList.remove('near');
  }
  function pickUnderPointer(event, name) {
    const at = state.maps?.objects && placeOf(event, name);
    const id = at ? state.maps.objects[at.i] : 0;
    pick(id > 0 && id !== state.picked ? id : null);
  }
  function pick(id) {
    state.picked = id;
    state.near = null;
    selectRow('objects', id);
    repaintObjects();
  }
  // ---- tables ----

  function objectsCard() {
    const {found, objects: places, ours, name} = current();
    const list = places.map(({id}) => ({id, ...found.get(id), score: ours.get(id)}));
    const note = run.frames > 1 ? name : null;
    if (!list.length) return card(evaluates ? 'Objects found' : 'Objects', note, el('p', {class: 'empty'}, 'none'));
    const has = (property) => list.some((o) => o[property]);
    const columns = [{name: 'id', value: (o) => o.id, show: (o) => [swatch(idColour(o.id)), o.id]}];
    if (has('position_m')) columns.push(number('distance m', (o) => o.position_m?.[2], 2));
    if (has('depth_interval_m')) {
      columns.push({name: 'interval m', title: '95 % interval of the distance; sorted by its width',
        value: (o) => o.depth_interval_m && (o.depth_interval_m[1] ?? Infinity) - o.depth_interval_m[0],
        show: (o) => o.depth_interval_m?.map((z) => (z === null ? '∞' : fixed(z, 2))).join(' – ') ?? '–'});
    }
    if (has('confidence')) columns.push(number('confidence', (o) => o.confidence, 2));
    if (has('disparity_px')) columns.push(number('disparity px', (o) => o.disparity_px, 1));
    if (evaluates) {
      columns.push(
        number('true id', (o) => o.score?.true, 0), number('IoU', (o) => o.score?.iou, 3, {bad: (o) => o.score && o.score.iou < 0.5}),
        {name: 'verdict', text: true, value: verdict, show: verdict, bad: (o) => verdict(o) === 'phantom'});
    } else {
      if (has('position_m')) {
        columns.push(number('x m', (o) => o.position_m?.[0], 2, {title: 'to the right of the left camera'}),
          number('y m', (o) => o.position_m?.[1], 2, {title: 'below the left camera'}));
      }
      if (has('extent_m')) {
        columns.push({name: 'size m', title: 'width × height × depth; sorted by the largest',
          value: (o) => (o.extent_m ? Math.max(...o.extent_m) : null),
          show: (o) => o.extent_m?.map((length) => fixed(length, 2)).join(' × ') ?? '–'});
      }
      columns.push(share('valid %', (o) => o.valid_share, {title: 'share of its pixels with a disparity'}));
    }
    columns.push(number('area px', (o) => o.area ?? o.score?.area_px, 0));
    return card(evaluates ? 'Objects found' : 'Objects', note, table('objects', columns, list, {
      key: (o) => o.id, pickRow: (o) => pick(o.id === state.picked ? null : o.id), selected: (o) => o.id === state.picked,
      enter: (o) => near(o?.id ?? null),
    }));
  }
  function verdict({score}) {
    if (!score) return '–';
    if (score.mostly_dont_care) return 'don’t care';
    if (score.phantom) return 'phantom';
    return score.iou >= 0.5 ? 'right' : 'poor';
  }

  function leftOutCard() {
    const found = current().result?.left_out;
    if (!found) return null;  // a result from an earlier version without this list
    const title = 'Not objects, and why';
    if (!found.length) return card(title, null, el('p', {class: 'empty'}, 'none'));
    const list = found.map((left, key) => ({key, ...left}));
    const columns = [{name: 'reason', text: true, value: (l) => l.reason, show: (l) => l.reason,
      title: 'background: mostly on a wall; too small: below objects.min_area; low confidence: no region has a sufficient score'}];
    if (list.some((l) => l.position_m)) columns.push(number('distance m', (l) => l.position_m?.[2], 2));
    columns.push(number('disparity px', (l) => l.disparity_px, 1));
    if (list.some((l) => l.confidence > 0)) columns.push(number('confidence', (l) => l.confidence, 2, {title: 'highest score of the regions that contain its centre'}));
    columns.push(number('area px', (l) => l.area, 0));
    return card(title, counted(list.length, 'obstacle'), table('left-out', columns, list, {
      key: (l) => l.key, selected: (l) => l.key === state.leftOut?.key,
      pickRow: (l) => {
        state.leftOut = l.key === state.leftOut?.key ? null : l;
        state.nearLeftOut = null;
        selectRow('left-out', state.leftOut?.key);
        showLeftOut();
      },
      enter: (l) => { state.nearLeftOut = l; showLeftOut(); },
    }));
  }

  const total = (times) => Object.values(times ?? {}).reduce((sum, t) => sum + t, 0);

  function framesCard() {
    const list = frames.map((facts, index) => ({index, ...facts}));
    const objects = (f) => f.scores?.objects, counts = (f) => objects(f)?.counts;
    const visible = (f) => f.scores?.disparity?.both_cameras ?? f.scores?.disparity?.all;
    const meanError = (f) => {
      const errors = (objects(f)?.true ?? []).map(cappedError);
      return errors.length ? errors.reduce((a, b) => a + b) / errors.length : null;
    };
    const columns = [{name: 'frame', text: true, value: (f) => f.name, show: (f) => f.name}];
    if (evaluates) {
      columns.push(
        share('E %', meanError, {title: 'mean, capped at 200 % each'}),
        {name: 'found', title: 'share of the scored true objects with IoU ≥ 0.5', value: (f) => counts(f) && counts(f).found_50 - counts(f).scored,
          show: (f) => (counts(f) ? `${counts(f).found_50}/${counts(f).scored}` : '–'), bad: (f) => counts(f)?.found_50 < counts(f)?.scored},
        number('ours', (f) => counts(f)?.ours, 0), number('right', (f) => counts(f)?.right_50, 0),
        number('phantoms', (f) => counts(f)?.phantoms, 0, {bad: (f) => counts(f)?.phantoms > 0}),
        share('bad-1 %', (f) => visible(f)?.bad_of_matched['1'], {title: 'of the matched pixels visible to both cameras'}),
        share('density %', (f) => visible(f)?.density));
    } else {
      columns.push(
        number('objects', (f) => f.objects.length, 0),
        number('nearest m', (f) => f.result?.objects[0]?.position_m?.[2], 2),
        share('disparity %', (f) => f.valid_share, {title: 'share of the pixels with a disparity'}),
        {name: 'ground', text: true, value: groundText, show: (f) => el('span', {title: groundText(f)}, groundText(f).split(':')[0])},
        number('ms', (f) => total(f.result?.timings_ms), 1));
    }
    return card('Frames', `${run.frames}`, table('frames-table', columns, list, {
      key: (f) => f.index, pickRow: (f) => go(f.index), selected: (f) => f.index === state.frame,
    }));
  }
  function groundText({result}) {
    if (!result) return '–';
    return result.ground?.plane ? 'found' : `none: ${words(result.ground?.refusal ?? 'unknown')}`;
  }

  function timesCard() {
    const times = Object.entries(current().result?.timings_ms ?? {});
    if (!times.length) return null;
    const most = Math.max(...times.map(([, t]) => t));
    return card('Time per stage', `${fixed(total(current().result.timings_ms), 1)} ms in total`, table('times', [
      {name: 'stage', text: true, value: ([stage]) => stage, show: ([stage]) => words(stage)},
      number('ms', ([, t]) => t, 2),
      {name: '', grow: true, text: true, value: ([, t]) => t, show: ([, t]) => el('span', {class: 'bar', style: {width: `${100 * t / most}%`}})},
    ], times));
  }

  let optionsOpen = false;
  function optionsCard() {
    const config = current().result?.config;
    if (!config) return null;
    const list = Object.entries(config).flatMap(([section, options]) =>
      Object.entries(options).map(([name, value]) => [`${section}.${name}`, Array.isArray(value) ? JSON.stringify(value) : String(value)]));
    return el('details', {class: 'card', open: optionsOpen, ontoggle: (event) => { optionsOpen = event.target.open; }},
      el('summary', {}, `Options (preset ${current().result.preset})`),
      table('options', [0, 1].map((k) => ({name: ['option', 'value'][k], text: true, value: (o) => o[k], show: (o) => o[k]})), list));
  }

  // ---- evaluation ----

  const kCap = run.evaluation?.summary.objects?.error_cap ?? 2;
  const cappedError = (score) => (score.error === null ? kCap : Math.min(score.error, kCap));
  const allTrue = frames.flatMap((facts, frame) =>
    [...facts.truth.values()].map((score) => ({frame, name: facts.name, ...score})));

  function tiles() {
    const o = run.evaluation.summary.objects, d = run.evaluation.summary.disparity;
    const list = [];
    if (o) {
      list.push([percent(o.recall_50), `of ${counted(o.scored, 'object')} found`, 'true objects with IoU ≥ 0.5']);
      if (o.ours !== null) list.push([percent(o.precision_50), `precision of ${counted(o.ours, 'object')}`, 'IoU ≥ 0.5'],
        [fixed(o.phantoms_per_frame, 2), 'phantoms per frame', 'objects with less than a quarter on any true object']);
      list.push([percent(o.median_error), `median E; mean ${percent(o.mean_error)}`, 'Eq. 5: 1/IoU − 1, counted as 200 % at most'],
        [fixed(o.mean_boundary_f, 3), 'boundary F', 'mean over all scored']);
    }
    const seen = d?.both_cameras ?? d?.all;
    if (seen) {
      list.push([percent(seen.bad_of_matched['1']), 'bad-1 of the matched', d.both_cameras ? 'pixels visible to both cameras' : 'all pixels with truth'],
        [percent(seen.density), 'density', 'share of the pixels with ground truth that have a disparity']);
    }
    byId('tiles').replaceChildren(...list.map(([value, name, title]) => el('div', {class: 'tile', title}, el('b', {}, value), el('span', {}, name))));
    byId('tiles').hidden = list.length === 0;
  }

  const kBins = 20;
  /** The last bin contains values at the cap, mostly misses. */
  const binOf = (score) => Math.min(kBins, Math.floor(cappedError(score) / kCap * kBins));
  const binText = (bin) => bin === kBins ? `${100 * kCap} % and more, or missed`
    : `${Math.round(100 * kCap * bin / kBins)} to ${Math.round(100 * kCap * (bin + 1) / kBins)} %`;

  function histogramCard() {
    const counts = Array.from({length: kBins + 1}, () => 0);
    for (const score of allTrue) ++counts[binOf(score)];
    const most = Math.max(...counts, 1);
    const width = 640, height = 190, left = 34, bottom = 34, top = 22, step = (width - left - 6) / (kBins + 1.6);
    const x = (bin) => left + step * (bin === kBins ? kBins + 0.6 : bin);
    const y = (count) => top + (height - top - bottom) * (1 - count / most);
    const drawing = svg('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'Histogram of E'});
    const ticks = [...new Set([0, 0.5, 1].map((s) => Math.round(s * most)))];
    for (const count of ticks) {
      drawing.append(svg('line', {x1: left, x2: width - 6, y1: y(count), y2: y(count)}),
        svg('text', {x: left - 6, y: y(count) + 4, 'text-anchor': 'end'}, String(count)));
    }
    counts.forEach((count, bin) => {
      const kind = bin === kBins ? ' miss' : bin * kCap / kBins >= 1 ? ' poor' : '';
      drawing.append(svg('rect', {class: `bar${kind}`, x: x(bin) + 1, width: step - 2, y: y(count), height: height - bottom - y(count)}));
    });
    for (let bin = 0; bin <= kBins; bin += kBins / 4) {
      if (bin < kBins) drawing.append(svg('text', {x: x(bin), y: height - bottom + 14, 'text-anchor': 'middle'}, `${100 * kCap * bin / kBins}`));
    }
    drawing.append(svg('text', {x: x(kBins) + step / 2, y: height - bottom + 14, 'text-anchor': 'middle'}, `≥ ${100 * kCap}`),
      svg('text', {x: left + step * kBins / 2, y: height - 6, 'text-anchor': 'middle'}, 'E in %; up to 100 % is IoU ≥ 0.5'));
    const middle = run.evaluation.summary.objects?.median_error;
    if (isNumber(middle) && middle < kCap) {
      const at = left + step * kBins * middle / kCap;
      drawing.append(svg('line', {class: 'median', x1: at, x2: at, y1: top - 8, y2: height - bottom}),
        svg('text', {x: at, y: top - 11, 'text-anchor': 'middle'}, 'median'));
    }
    counts.forEach((count, bin) => drawing.append(svg('rect', {
      class: `hit${state.bin === bin ? ' on' : ''}`, 'data-bin': bin, x: x(bin), width: step, y: top, height: height - top - bottom,
      onclick: () => { state.bin = state.bin === bin ? null : bin; fillTables(); },
    }, svg('title', {}, `E ${binText(bin)}: ${counted(count, 'true object')}`))));
    const result = card('Histogram of E', 'true objects of all frames; click a bar to list them', el('div', {class: 'histogram'}, drawing));
    result.id = 'histogram';
    return result;
  }

  function truthCard() {
    const list = allTrue.filter((t) => (state.bin === null || binOf(t) === state.bin) && (!state.onlyThisFrame || t.frame === state.frame));
    const columns = [
      {name: 'id', value: (t) => t.id, show: (t) => t.id},
      share('E %', (t) => t.error ?? Infinity, {show: (t) => (t.error === null ? 'missed' : fixed(100 * t.error, 1)), bad: (t) => t.iou < 0.5}),
      number('IoU', (t) => t.iou, 3), number('boundary F', (t) => t.boundary_f, 3),
      number('ours', (t) => t.ours, 0, {title: 'the best-matching object of ours'}), number('area px', (t) => t.area_px, 0),
      {name: 'segmented', text: true, value: segmented, show: segmented},
    ];
    if (run.frames > 1) columns.unshift({name: 'frame', text: true, value: (t) => t.name, show: (t) => t.name});
    const note = state.bin === null ? counted(list.length, 'scored object') : `${counted(list.length, 'object')} with E ${binText(state.bin)}`;
    const result = card('True objects', note, table('truth', columns, list, {
      key: (t) => `${t.frame}:${t.id}`, pickRow: (t) => go(t.frame).then(() => pick(t.ours)),
      enter: (t) => { state.near = t?.frame === state.frame ? t.ours : null; repaintObjects(); },
    }));
    if (run.frames > 1) {
      result.querySelector('.head').append(el('label', {}, el('input', {type: 'checkbox', checked: state.onlyThisFrame, onchange: (event) => {
        state.onlyThisFrame = event.target.checked;
        fillTables();
      }}), 'this frame only'));
    }
    return result;
  }
  const segmented = (t) => [t.over_segmented ? 'over' : '', t.under_segmented ? 'under' : ''].filter(Boolean).join(', ');

  // ---- the page ----

  function fillTables() {
    const many = run.frames > 1, scored = allTrue.length > 0;
    const columns = evaluates
      ? [[scored ? histogramCard() : null, objectsCard(), leftOutCard(), timesCard()], [scored ? truthCard() : null, many ? framesCard() : null, optionsCard()]]
      : [[objectsCard(), leftOutCard(), many ? timesCard() : null], [many ? framesCard() : timesCard(), optionsCard()]];
    // A table keeps its scroll position when it is refilled.
    const scrolled = [...document.querySelectorAll('#tables table')].map((t) => [t.id, t.parentElement.scrollTop]);
    byId('tables').replaceChildren(...columns.map((cards) => el('div', {class: 'column'}, cards)));
    for (const [id, to] of scrolled) if (to && byId(id)) byId(id).parentElement.scrollTop = to;
  }

  function summaryText() {
    const {result, valid_share: valid, objects} = current();
    const parts = [el('b', {}, counted(objects.length, 'object'))];
    if (isNumber(valid)) parts.push(`disparity on ${percent(valid)} of the pixels`);
    if (result) {
      const {ground, epipolar} = result;
      parts.push(ground?.plane ? `ground found, support ${percent(ground.support, 0)}` : `no ground (${words(ground?.refusal ?? 'unknown')})`);
      if (epipolar?.outcome === 'corrected') parts.push(`right image shifted by ${fixed(epipolar.rows, 2)} rows`);
      if (result.external_disparity) parts.push('disparity given');
      parts.push(`preset ${result.preset}`, `${fixed(total(result.timings_ms), 1)} ms`);
    }
    return parts.flatMap((part, i) => (i ? [' · ', part] : [part]));
  }

  let wanted = 0;  // the frame requested last: an earlier one that is decoded later is not shown
  async function show(index) {
    wanted = Math.min(run.frames - 1, Math.max(0, index));
    const mine = wanted;
    nameFrame(mine, frames[mine].name, el('small', {}, `${mine + 1} / ${run.frames}`));
    let maps;
    try {
      maps = await mapsOf(mine);
    } catch (error) {
      trouble(`This frame cannot be shown: ${error.message}`);
      return;
    }
    if (mine !== wanted) return;
    if (state.frame !== mine) Object.assign(state, {picked: null, near: null, leftOut: null, nearLeftOut: null});
    Object.assign(state, {frame: mine, maps, reason: null});
    byId('summary').replaceChildren(...summaryText());
    leave();
    for (const name of Object.keys(panels)) repaint(name);
    sharpen();
    fillTables();
    if (run.frames > 1) history.replaceState(null, '', `#${mine + 1}`);
    document.documentElement.dataset.shown = mine;
    if (mine + 1 < run.frames) setTimeout(() => mapsOf(mine + 1).catch(() => {}), 150);
  }

  const kMsPerFrame = 200;
  let playing = null;  // token of the current playback
  /** Plays from the current frame to the last; from the first if the last is shown. */
  async function play() {
    const mine = playing = {};
    playButton(true);
    if (wanted === run.frames - 1) await show(0);
    while (playing === mine && wanted < run.frames - 1) {
      await new Promise((resolve) => setTimeout(resolve, kMsPerFrame));
      if (playing === mine) await show(wanted + 1);
    }
    if (playing === mine) pause();
  }
  function pause() {
    playing = null;
    playButton(false);
  }
  const playOrPause = () => (playing ? pause() : play());
  /** Goes to a requested frame. */
  function go(index) {
    pause();
    return show(index);
  }

  function layOut() {
    const fitting = innerWidth >= 1080 ? 3 : innerWidth >= 560 ? 2 : 1;
    document.documentElement.style.setProperty('--columns', state.columns || fitting);
    for (const button of byId('columns').children) {
      button.setAttribute('aria-pressed', Number(button.dataset.columns) === (state.columns || fitting));
    }
    sharpen();
  }

  /** Enlarged maps show single pixels; reduced ones are smoothed, which keeps thin outlines intact. */
  function sharpen() {
    for (const {stage} of Object.values(panels)) stage.classList.toggle('reduced', stage.clientWidth < current().width);
  }

  function begin() {
    beginPage();
    byId('about').textContent = `cairn ${run.cairn}. Point at a pixel to inspect it; click an object to highlight it` +
      (run.frames > 1 ? '; ← and → change the frame, space plays.' : '.');
    byId('columns').append(...[4, 3, 2, 1].map((n) => el('button', {type: 'button', 'data-columns': n, title: `${n} columns`, onclick: () => {
      state.columns = n;
      layOut();
    }}, String(n))));
    addEventListener('resize', layOut);
    layOut();
    makePanels();
    if (!evaluates) byId('tables').style.setProperty('--first', '1.6fr');  // its objects have more columns
    if (run.evaluation) tiles();
    byId('frames').hidden = run.frames < 2;
    leadThroughFrames({wanted: () => wanted, go, playOrPause});
    show(linkedFrame());
  }
  begin();
})();
