// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Shared by the scripts of all pages; each page's own script follows in the same <script> element. A page's data are
// JSON blocks (cairn/output/web/page_parts.hpp); `run` describes the whole run.
'use strict';

// ---- small helpers ----

const byId = (id) => document.getElementById(id);
const block = (id) => JSON.parse(byId(id).textContent);

function made(node, properties, children) {
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (name === 'style') Object.assign(node.style, value);
    else node.setAttribute(name, value === true ? '' : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}
/** Creates an element; properties that are not attributes begin with "on" (listeners) or are `style`. */
const el = (tag, properties = {}, ...children) => made(document.createElement(tag), properties, children);
const svg = (tag, properties = {}, ...children) => made(document.createElementNS('http://www.w3.org/2000/svg', tag), properties, children);

function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
}

const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
const fixed = (value, digits) => (isNumber(value) ? value.toFixed(digits) : '–');
const percent = (share, digits = 1) => (isNumber(share) ? `${(100 * share).toFixed(digits)} %` : '–');
const counted = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
const words = (name) => name.replaceAll('_', ' ');
const polar = (radius, angle) => [radius * Math.cos(angle), radius * Math.sin(angle)];
/** The first of 1, 2, 5, 10, … of which `span` contains fewer than `most`. */
const roundStep = (span, most) => [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((step) => span / step < most) ?? 200;

/** "#rrggbb" as a canvas pixel in this machine's byte order (little endian everywhere). */
function pixel(colour, alpha = 255) {
  const n = parseInt(colour.slice(1), 16);
  return ((alpha << 24) | ((n & 255) << 16) | (n & 0xff00) | (n >> 16)) >>> 0;
}
const mixed = (a, b, shareOfB) => {
  const channel = (shift) => {
    const from = (parseInt(a.slice(1), 16) >> shift) & 255;
    const to = (parseInt(b.slice(1), 16) >> shift) & 255;
    return Math.round(from + (to - from) * shareOfB) << shift;
  };
  return '#' + (channel(16) | channel(8) | channel(0)).toString(16).padStart(6, '0');
};

// ---- data ----

const run = block('run');
const idColour = (id) => run.look.objects[id % run.look.objects.length];

// Not PNGs read back from a canvas: browsers that guard against fingerprinting alter what is read.
async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The numbers of a packed map, or null. */
async function unpacked(map, count) {
  if (!map) return null;
  const planes = await inflated(map.data);
  if (map.bytes === 1) {
    for (let i = 1; i < count; ++i) planes[i] += planes[i - 1];  // modulo 256
    return planes;
  }
  const values = new Uint32Array(count);
  const mask = map.bytes === 4 ? 0xffffffff : 2 ** (8 * map.bytes) - 1;
  let value = 0;
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < map.bytes; ++k) value += planes[k * count + i] * 2 ** (8 * k);
    value = (value & mask) >>> 0;
    values[i] = value;
  }
  return values;
}

/** The image of a data URI, decoded; null if there is none or it is damaged. */
async function decodedPicture(uri) {
  if (!uri) return null;
  const image = new Image();
  image.src = uri;
  return image.decode().then(() => image, () => null);
}

/** `make(index)`, cached for the `most` indices requested last, so that a slider moves back at once. */
function keptLast(make, most) {
  const kept = new Map();
  return (index) => {
    const found = kept.get(index) ?? make(index);
    kept.delete(index);
    kept.set(index, found);
    while (kept.size > most(index)) kept.delete(kept.keys().next().value);
    return found;
  };
}

// ---- places, in m; rigid motions are rows of 3×4 ----

function motionOf({quaternion_xyzw: [x, y, z, w], position_m: [a, b, c]}) {
  return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), a,
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), b,
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), c];
}
const moved = (m, p) => [0, 4, 8].map((r) => m[r] * p[0] + m[r + 1] * p[1] + m[r + 2] * p[2] + m[r + 3]);
const movedBack = (m, p) => [0, 1, 2].map((c) => m[c] * (p[0] - m[3]) + m[4 + c] * (p[1] - m[7]) + m[8 + c] * (p[2] - m[11]));
/** The distance for a disparity; NaN without a rig. */
function metresOf(disparity, rig) {
  if (!rig) return NaN;
  const shifted = disparity + (rig.doffs_px ?? 0);
  return shifted > 0 ? rig.focal_px * rig.baseline_m / shifted : Infinity;
}
/** The viewing directions of the image's sides on the floor or map to which `m` moves the camera, from right to left. */
const sideAngles = (m, rig, width) => [width - 0.5, -0.5].map((column) => {
  const right = (column - rig.cx_px) / rig.focal_px;
  return Math.atan2(m[4] * right + m[6], m[0] * right + m[2]);
});

// ---- pictures ----

/** Whether a neighbour to the right or below has another label. */
function onBorder(labels, i, width) {
  return ((i + 1) % width !== 0 && labels[i + 1] !== labels[i]) ||
    (i + width < labels.length && labels[i + width] !== labels[i]);
}

/**
 * Fills the pixels of labelled objects: tinted (unless `outlinesAlone`), outlined; faint except for the selected one,
 * if any. `colourOf` may return null for a label that is drawn as background.
 */
function paintLabels(out, labels, width, colourOf, chosen, outlinesAlone = false) {
  const inside = [], edge = [], shade = outlinesAlone ? 0 : pixel('#000000', 50), dontCare = pixel('#9aa0a8', 110);
  for (let i = 0; i < out.length; ++i) {
    const id = labels[i];
    if (id <= 0) {
      out[i] = id < 0 ? dontCare : shade;
      continue;
    }
    if (inside[id] === undefined) {
      const dim = chosen !== null && chosen !== id, colour = colourOf(id);
      inside[id] = !colour ? shade : outlinesAlone ? 0 : pixel(colour, dim ? 35 : chosen === id ? 175 : 125);
      edge[id] = colour ? pixel(mixed(colour, '#ffffff', 0.4), dim ? 90 : 255) : shade;
    }
    const outline = onBorder(labels, i, width) || (i % width !== 0 && labels[i - 1] !== id) ||
      (i >= width && labels[i - width] !== id);
    out[i] = (outline ? edge : inside)[id];
  }
}

/** The names of labelled objects, to be laid over an image of this size. places: {id, x, y}. */
function marks(places, textOf, chosen, {width, height}) {
  return places.map(({id, x, y}) => el('span', {
    class: `mark${chosen !== null && chosen !== id ? ' dim' : ''}`, 'data-key': id,
    style: {left: `${100 * (x + 0.5) / width}%`, top: `${100 * (y + 0.5) / height}%`},
  }, textOf(id)));
}

/** Moves marks into the image where they extend beyond its sides, and down where they overlap others. */
function partMarks(all) {
  if (!all.length) return;
  // All are measured before any is moved, for a single layout.
  const inside = all[0].parentElement.getBoundingClientRect(), placed = [];
  const boxes = all.map((mark) => mark.getBoundingClientRect());
  all.forEach((mark, i) => {
    const {left, right, top, bottom} = boxes[i];
    const aside = Math.max(0, inside.left + 2 - left) + Math.min(0, inside.right - 2 - right);
    let down = 0;
    const hits = (other) => left + aside < other.right && other.left < right + aside &&
      top + down < other.bottom && other.top < bottom + down;
    for (let other = placed.find(hits); other && down < 60; other = placed.find(hits)) down = other.bottom - top + 0.5;
    placed.push({left: left + aside, right: right + aside, top: top + down, bottom: bottom + down});
    if (aside) mark.style.marginLeft = `${aside}px`;
    if (down) mark.style.marginTop = `${down}px`;
  });
}

/** The pixel under the pointer, of an image of this size that fills `stage`; null outside. */
function pixelUnder(event, stage, {width, height}) {
  const box = stage.getBoundingClientRect();
  const x = Math.floor((event.clientX - box.left) / box.width * width);
  const y = Math.floor((event.clientY - box.top) / box.height * height);
  return x < 0 || y < 0 || x >= width || y >= height ? null : {x, y, i: y * width + x};
}

function chip(colour, name, share, properties = {}) {
  return el('span', {class: `chip${share === 0 ? ' off' : ''}`, ...properties},
    el('i', {style: {background: colour}}), el('b', {}, name), isNumber(share) ? percent(share) : null);
}
const swatch = (colour) => el('span', {class: 'swatch', style: {background: colour}});

// ---- the box beside the pointer ----

function rows(pairs) {
  return el('dl', {}, pairs.filter(([, value]) => value !== null).flatMap(([key, value]) => [el('dt', {}, key), el('dd', {}, value)]));
}
function group(title, pairs) {
  return el('div', {class: 'group'}, title ? el('b', {}, title) : null, rows(pairs));
}
function showTip({clientX, clientY}, ...nodes) {
  const tip = byId('tip'), gap = 14;
  tip.replaceChildren(...nodes);
  tip.hidden = false;
  const {width, height} = tip.getBoundingClientRect();
  const left = clientX + gap + width > innerWidth ? clientX - gap - width : clientX + gap;
  const top = clientY + gap + height > innerHeight ? clientY - gap - height : clientY + gap;
  tip.style.left = `${Math.max(0, left)}px`;
  tip.style.top = `${Math.max(0, top)}px`;
}
const hideTip = () => { byId('tip').hidden = true; };

// ---- tables ----

const sorting = {};  // table → {column, descending}, kept from frame to frame

/**
 * A table with sortable columns. columns: {name, title, text, value (sort key), show (a cell's nodes), bad}. Missing
 * values come last in either direction. `refill(data)` of the result shows other rows; rows with a known key keep
 * their elements, so that a hovered row stays hovered.
 */
function table(id, columns, data, {key, pickRow, selected, enter} = {}) {
  const body = el('tbody');
  const heads = columns.map((column, c) => el('th', {scope: 'col', class: column.text ? 'text' : null, 'aria-sort': 'none'},
    column.name === '' ? null : el('button', {type: 'button', title: column.title, onclick: () => {
      const before = sorting[id];
      sorting[id] = {column: c, descending: before?.column === c ? !before.descending : false};
      fill();
    }}, column.name)));
  const shown = new Map();  // key → its row: the element, its data, and the text of its cells

  function rowOf(value) {
    const name = key?.(value);
    const row = shown.get(name) ?? {texts: [], classes: []};
    row.value = value;
    if (!row.node) {
      row.node = el('tr', {
        'data-key': name, class: pickRow ? 'pick' : null,
        onclick: pickRow && (() => pickRow(row.value)),
        onpointerenter: enter && (() => enter(row.value)), onpointerleave: enter && (() => enter(null)),
      }, columns.map(() => el('td')));
      if (key) shown.set(name, row);
    }
    if (selected) row.node.setAttribute('aria-selected', String(selected(value)));
    columns.forEach((column, c) => {
      const cell = row.node.cells[c];
      const look = [column.text ? 'text' : '', column.grow ? 'grow' : '', column.bad?.(value) ? 'bad' : ''].join(' ').trim();
      if (row.classes[c] !== look) cell.className = row.classes[c] = look;
      const content = column.show(value);
      if (typeof content === 'string' && content === row.texts[c]) return;
      row.texts[c] = content;
      cell.replaceChildren(...[content].flat());
    });
    return row.node;
  }

  const fill = () => {
    const {column, descending} = sorting[id] ?? {};
    const list = [...data];
    if (column !== undefined) {
      const valueOf = columns[column].value, sign = descending ? -1 : 1;
      const missing = (v) => v === null || v === undefined || Number.isNaN(v);
      list.sort((a, b) => {
        const p = valueOf(a), q = valueOf(b);
        if (missing(p) || missing(q)) return missing(p) - missing(q);
        return sign * (typeof p === 'string' ? p.localeCompare(q, 'en', {numeric: true}) : p - q);
      });
    }
    heads.forEach((head, c) => head.setAttribute('aria-sort', c !== column ? 'none' : descending ? 'descending' : 'ascending'));
    const wanted = list.map(rowOf), kept = new Set(wanted);
    for (const [name, row] of shown) if (!kept.has(row.node)) shown.delete(name);
    // Rows already in place are not touched.
    const same = wanted.length === body.rows.length && wanted.every((node, i) => node === body.rows[i]);
    if (!same) body.replaceChildren(...wanted);
  };
  fill();
  const result = el('div', {class: 'scroll'}, el('table', {id}, el('thead', {}, el('tr', {}, heads)), body));
  result.refill = (other) => {
    data = other;
    fill();
  };
  return result;
}

/** A column of numbers. */
const number = (name, value, digits, more = {}) => ({name, value, show: (row) => fixed(value(row), digits), ...more});
const share = (name, value, more = {}) => ({name, value, show: (row) => (isNumber(value(row)) ? fixed(100 * value(row), 1) : '–'), ...more});

/** Marks a table's row as hovered. */
function markRow(id, key) {
  for (const row of document.querySelectorAll(`#${id} tbody tr`)) row.classList.toggle('near', row.dataset.key === String(key));
}
/** Marks a table's row as selected and scrolls to it. */
function selectRow(id, key) {
  for (const row of document.querySelectorAll(`#${id} tbody tr`)) {
    row.setAttribute('aria-selected', row.dataset.key === String(key));
    if (row.dataset.key === String(key)) scrollToRow(row);
  }
}
/** Scrolls its table, not the page: the image that was clicked stays in place. */
function scrollToRow(row) {
  const box = row.closest('.scroll');
  if (row.offsetTop < box.scrollTop + row.offsetHeight || row.offsetTop + row.offsetHeight > box.scrollTop + box.clientHeight) {
    box.scrollTop = row.offsetTop - box.clientHeight / 2;
  }
}

function card(title, note, ...content) {
  return el('div', {class: 'card'}, el('div', {class: 'head'}, el('h2', {}, title), note ? el('span', {class: 'note'}, note) : null), ...content);
}

// ---- the page ----

function trouble(text) {
  byId('trouble').textContent = text;
  byId('trouble').hidden = false;
}

/** The start of every page. */
function beginPage() {
  byId('command').textContent = run.command;
  byId('title').textContent = run.title;
  byId('theme').addEventListener('click', () => {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
    root.dataset.theme = dark ? 'light' : 'dark';
  });
  if (typeof DecompressionStream === 'undefined') {
    trouble('This browser cannot decompress the images (no DecompressionStream). Use Chrome 80, Firefox 113, Safari 16.4 or later.');
  }
}

function playButton(plays) {
  byId('play').textContent = plays ? '❚❚' : '▶';
  byId('play').setAttribute('aria-pressed', plays);
}

/** The frame of the address: that of "#3" is the third. */
const linkedFrame = () => Number(location.hash.slice(1)) - 1 || 0;
function nameFrame(index, ...names) {
  byId('slider').value = index;
  byId('frame-name').replaceChildren(...names);
  byId('previous').disabled = index === 0;
  byId('next').disabled = index === run.frames - 1;
}

/**
 * Keys and buttons that change the frame. `wanted()`: the frame requested last; `more`: key → target frame, in
 * addition to arrows, Home and End.
 */
function leadThroughFrames({wanted, go, playOrPause, more = () => ({})}) {
  byId('slider').max = run.frames - 1;
  byId('previous').addEventListener('click', () => go(wanted() - 1));
  byId('next').addEventListener('click', () => go(wanted() + 1));
  byId('play').addEventListener('click', playOrPause);
  byId('slider').addEventListener('input', (event) => go(Number(event.target.value)));
  addEventListener('hashchange', () => go(linkedFrame()));
  // A button that was clicked, rather than reached by keys, leaves the space bar to play and pause.
  byId('frames').addEventListener('click', (event) => { if (event.detail && event.target.matches('button')) event.target.blur(); });
  addEventListener('keydown', (event) => {
    if (run.frames < 2 || event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.key === ' ' && !event.target.matches?.('button, select, summary, input[type=checkbox]')) {
      event.preventDefault();
      if (!event.repeat) playOrPause();
    }
    if (event.target.matches?.('select, input[type=range]:not(.scrub)')) return;
    const far = event.shiftKey ? 10 : 1;
    const to = {ArrowLeft: wanted() - far, ArrowRight: wanted() + far, Home: 0, End: run.frames - 1, ...more()}[event.key];
    if (to === undefined) return;
    event.preventDefault();
    go(to);
  });
}
