// SPDX-License-Identifier: BSD-3-Clause
// Lines over a pair of axes as SVG, drawn anew when the width changes.
import {fixed, h, s} from './dom.js';

const max_points = 1500;  // of a line; of more, the extremes of each group are drawn

/** A round step that divides a range into about `wanted` parts. */
export function roundStep([low, high], wanted) {
  const raw = (high - low) / Math.max(1, wanted);
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((m) => m * power).find((candidate) => candidate >= 0.7 * raw);
}

/** The multiples of a step in a range, and the decimals that they need. */
export function ticks([low, high], step) {
  const result = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
    result.push(i * step);
  }
  return {values: result, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

/** Positions of the points to draw: all, or the lowest and the highest of each group. */
function thinned(y) {
  if (y.length <= max_points) {
    return y.map((_, i) => i);
  }
  const group = 2 * y.length / max_points;
  const kept = new Set([0, y.length - 1]);
  for (let start = 0; start < y.length; start += group) {
    let low = Math.floor(start);
    let high = low;
    for (let i = low; i < Math.min(y.length, start + group); ++i) {
      low = y[i] < y[low] ? i : low;
      high = y[i] > y[high] ? i : high;
    }
    kept.add(low).add(high);
  }
  return [...kept].sort((a, b) => a - b);
}

function rangeOf(series, axis, floor) {
  let low = Infinity;
  let high = -Infinity;
  for (const line of series) {
    for (const v of line[axis]) {
      if (Number.isFinite(v)) {
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
    }
  }
  if (low > high) {
    return [0, 1];
  }
  if (floor !== undefined) {
    low = Math.min(low, floor);
  }
  const least = floor === undefined ? 0.02 : 0.01;  // a flat line is not blown up to noise
  const pad = Math.max((high - low) * 0.05, (least - (high - low)) / 2, 1e-6);
  return [floor !== undefined && low === floor ? low : low - pad, high + pad];
}

/** The same length for a metre along both axes. */
function equalise(x, y, width, height) {
  const scale = Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height);
  const grow = (range, size) => {
    const extra = (scale * size - (range[1] - range[0])) / 2;
    return [range[0] - extra, range[1] + extra];
  };
  return [grow(x, width), grow(y, height)];
}

function axes(options, box, x, y, px, py) {
  const parts = [];
  const x_step = roundStep(x, box.width / 80);
  const y_step = roundStep(y, box.height / 40);
  const xt = ticks(x, options.equal ? Math.max(x_step, y_step) : x_step);
  const yt = ticks(y, options.equal ? Math.max(x_step, y_step) : y_step);
  for (const v of xt.values) {
    parts.push(
        s('line', {x1: px(v), x2: px(v), y1: box.top, y2: box.top + box.height, class: 'grid'}),
        s('text', {x: px(v), y: box.top + box.height + 16, 'text-anchor': 'middle'},
            fixed(v, xt.digits)));
  }
  for (const v of yt.values) {
    parts.push(
        s('line', {x1: box.left, x2: box.left + box.width, y1: py(v), y2: py(v), class: 'grid'}),
        s('text', {x: box.left - 6, y: py(v) + 4, 'text-anchor': 'end'}, fixed(v, yt.digits)));
  }
  parts.push(
      s('rect', {x: box.left, y: box.top, width: box.width, height: box.height, class: 'frame'}),
      s('text', {x: box.left + box.width / 2, y: box.top + box.height + 34, class: 'axis',
        'text-anchor': 'middle'}, options.x),
      s('text', {x: -(box.top + box.height / 2), y: 13, class: 'axis', 'text-anchor': 'middle',
        transform: 'rotate(-90)'}, options.y));
  return parts;
}

function lineOf(line, px, py) {
  const xs = line.equal ? line.x.map((_, i) => i) : thinned(line.y);
  const points = xs.filter((i) => Number.isFinite(line.x[i]) && Number.isFinite(line.y[i]))
      .map((i) => `${px(line.x[i]).toFixed(1)},${py(line.y[i]).toFixed(1)}`);
  return s('polyline', {points: points.join(' '), fill: 'none', stroke: line.colour,
    'stroke-width': line.width || 1.8, 'stroke-dasharray': line.dash, 'stroke-linejoin': 'round'});
}

const cross = (x, y) => `M${x - 4},${y - 4}l8,8m0,-8l-8,8`;

/** A dot with its name: the start's to the upper left, the others' to the lower right, as far as they fit. */
function markOf(mark, k, box, px, py) {
  const [cx, cy] = [px(mark.x), py(mark.y)];
  const left = k === 0 ? cx > box.left + 40 : cx > box.left + box.width - 40;
  const above = k === 0 ? cy > box.top + 20 : cy > box.top + box.height - 20;
  return s('g', {}, s('circle', {cx, cy, r: 5, fill: mark.colour, stroke: '#fff'}),
      s('text', {x: cx + (left ? -7 : 7), y: cy + (above ? -7 : 15), class: 'mark',
        'text-anchor': left ? 'end' : 'start'}, mark.name));
}

/** The first point of each line from an x on, in words. */
function readout(options, series, x) {
  const values = series.filter((line) => line.x.length > 0).map((line) => {
    let low = 0;
    let high = line.x.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (line.x[middle] < x) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return `${line.name} ${fixed(line.y[low], options.digits ?? 3)}`;
  });
  return `${options.x.replace(/ \[.*/, '')} ${fixed(x, 1)}: ${values.join(', ')}`;
}

function draw(container, svg, note, options) {
  const width = Math.max(260, container.clientWidth);
  const height = options.equal ? Math.min(560, Math.max(300, width * 0.75)) : 230;
  const box = {left: 58, top: 8, width: width - 76, height: height - 52};
  let x = rangeOf(options.series, 'x', options.equal ? undefined : 0);
  if (!options.equal) {
    x = [x[0], Math.max(...options.series.map((line) => line.x[line.x.length - 1] || 0)) || 1];
  }
  let y = rangeOf(options.series, 'y', options.floor);
  if (options.equal) {
    [x, y] = equalise(x, y, box.width, box.height);
  }
  const px = (v) => box.left + (v - x[0]) / (x[1] - x[0]) * box.width;
  const py = (v) => box.top + box.height - (v - y[0]) / (y[1] - y[0]) * box.height;
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.setAttribute('height', height);
  const crosses = (options.crosses ? options.crosses.points : [])
      .filter((p) => Number.isFinite(p.x) && Number.isFinite(p.y))
      .map((p) => cross(Math.round(px(p.x)), Math.round(py(p.y)))).join('');
  svg.replaceChildren(...axes(options, box, x, y, px, py),
      ...options.series.map((line) => lineOf({...line, equal: options.equal}, px, py)),
      ...(crosses ? [s('path', {d: crosses, stroke: options.crosses.colour, 'stroke-width': 1.8, fill: 'none'})] : []),
      ...(options.marks || []).map((mark, k) => markOf(mark, k, box, px, py)));
  svg.onpointermove = (event) => {
    const at = (event.clientX - svg.getBoundingClientRect().left - box.left) / box.width;
    if (!options.equal && at >= 0 && at <= 1) {
      note.textContent = readout(options, options.series, x[0] + at * (x[1] - x[0]));
    }
  };
  svg.onpointerleave = () => note.textContent = '';
}

export function legend(entries) {
  return h('ul', {class: 'legend'}, entries.map((line) => h('li', {},
      s('svg', {width: 26, height: 10, 'aria-hidden': 'true'},
          line.points ? s('path', {d: cross(13, 5), stroke: line.colour, 'stroke-width': 1.8, fill: 'none'}) :
              s('line', {x1: 0, x2: 26, y1: 5, y2: 5, stroke: line.colour, 'stroke-width': 3,
                'stroke-dasharray': line.dash})), line.name)));
}

/** A figure with title, legend, lines and a sentence that says what it shows.
 * series: {name, x, y, colour, dash}; equal: x and y to the same scale; floor: lowest y shown;
 * marks: named dots {name, x, y, colour}; crosses: {name, colour, points: [{x, y}]}. */
export function plot(options) {
  const svg = s('svg', {role: 'img', 'aria-label': options.title, width: '100%'});
  const note = h('p', {class: 'readout'});
  const area = h('div', {class: 'plot'}, svg);
  const crosses = options.crosses && options.crosses.points.length > 0 ? [options.crosses] : [];
  const entries = [...options.series, ...crosses];
  const figure = h('figure', {}, h('figcaption', {}, h('strong', {}, options.title), ' ',
      options.words), entries.length > 1 ? legend(entries) : null, area, note);
  new ResizeObserver(() => draw(area, svg, note, options)).observe(area);
  return figure;
}
