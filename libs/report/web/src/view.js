// SPDX-License-Identifier: BSD-3-Clause
// The 3D view with its buttons and the slider of time. Drawn only when something has changed.
import {PerspectiveCamera, Vector3, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {kindOf, readPoints, shownScans} from './data.js';
import {count, fixed, h} from './dom.js';
import {Content, no_cut, ramp} from './scene.js';

const max_labels = 60;

class NoWebGl extends Error {}

function makeRenderer() {
  try {
    return new WebGLRenderer({antialias: true, powerPreference: 'high-performance'});
  } catch (error) {
    throw new NoWebGl(error.message);
  }
}

class View {
  constructor(data, stage, info) {
    this.data = data;
    this.stage = stage;
    this.info = info;
    this.renderer = makeRenderer();
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.canvas = this.renderer.domElement;
    this.canvas.id = 'scene';
    this.canvas.tabIndex = 0;
    stage.append(this.canvas);
    this.content = new Content(data, readPoints(data.map.count));
    this.camera = new PerspectiveCamera(50, 1, 0.2, 6000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.screenSpacePanning = false;
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI * 0.55;
    this.controls.addEventListener('change', () => this.request());
    this.labels = [];
    this.follow = false;
    this.scan = 0;
    new ResizeObserver(() => this.resize()).observe(stage);
    this.canvas.addEventListener('webglcontextrestored', () => this.request());
  }

  /** Whether the whole path is in the picture, with a margin for the sensor. */
  showsPath() {
    const {x, y, z} = this.data.final;
    this.camera.lookAt(this.controls.target);
    this.camera.updateMatrixWorld();
    return x.every((_, i) => {
      const at = new Vector3(x[i], y[i], z[i]).project(this.camera);
      return at.z < 1 && Math.max(Math.abs(at.x), Math.abs(at.y)) < 0.85;
    });
  }

  /** The whole path from behind and above, or from straight above. */
  reset(above) {
    const {x, y, z} = this.data.final;
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = low.clone().negate();
    for (let i = 0; i < x.length; ++i) {
      const p = new Vector3(x[i], y[i], z[i]);
      low.min(p);
      high.max(p);
    }
    const centre = low.clone().add(high).multiplyScalar(0.5);
    const size = Math.max(30, high.distanceTo(low) + 12);
    this.controls.target.copy(centre);
    const ahead = new Vector3(x[x.length - 1] - x[0], y[y.length - 1] - y[0], 0);
    const back = ahead.length() > 1 ? ahead.normalize() : new Vector3(1, 0, 0);
    this.camera.position.copy(centre);
    if (above) {
      this.camera.position.addScaledVector(back, -0.001 * size).add(new Vector3(0, 0, 1.5 * size));
    } else {
      this.camera.position.addScaledVector(back, -0.85 * size).add(new Vector3(0, 0, 0.6 * size));
    }
    this.camera.far = Math.max(2000, 20 * size);
    this.camera.updateProjectionMatrix();
    for (let tries = 0; tries < 12 && !this.showsPath(); ++tries) {
      this.camera.position.sub(centre).multiplyScalar(1.15).add(centre);
    }
    this.controls.update();
    this.request();
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.stage;
    if (width === 0 || height === 0) {
      return;
    }
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.framed) {
      this.framed = true;
      this.reset(false);
    }
    this.request();
  }

  request() {
    if (!this.pending) {
      this.pending = requestAnimationFrame(() => this.draw());
    }
  }

  draw() {
    this.pending = 0;
    if (this.content.map) {
      this.content.map.material.uniforms.viewport.value = this.canvas.height;
    }
    this.content.sizeSensor(this.camera.position);
    this.renderer.render(this.content.scene, this.camera);
    this.drawLabels();
    this.canvas.dataset.drawn = Number(this.canvas.dataset.drawn || 0) + 1;
  }

  /** Labels of the objects; of those that would overlap, the nearest one. */
  drawLabels() {
    const on = this.content.objects.visible && this.show_labels;
    const states = on ? this.states.slice(0, max_labels).map(({object, i}) => {
      const at = new Vector3(object.x[i], object.y[i], object.z[i] + object.height[i] / 2 + 0.3);
      return {object, i, at, distance: at.distanceTo(this.camera.position)};
    }).sort((a, b) => a.distance - b.distance) : [];
    while (this.labels.length < states.length) {
      const label = h('div', {class: 'label'});
      this.labels.push(label);
      this.stage.append(label);
    }
    const drawn = [];
    this.labels.forEach((label, k) => {
      label.hidden = k >= states.length;
      if (label.hidden) {
        return;
      }
      const {object, i} = states[k];
      const at = states[k].at.project(this.camera);
      label.textContent = `${object.class} ${object.id}, ${fixed(object.speed[i], 1)} m/s`;
      label.style.background = kindOf(object).colour;
      label.style.color = kindOf(object).ink || '#fff';
      const width = label.offsetWidth;
      const height = label.offsetHeight;
      const x = Math.max(width / 2, Math.min(this.stage.clientWidth - width / 2, (at.x + 1) / 2 * this.stage.clientWidth));
      const y = (1 - at.y) / 2 * this.stage.clientHeight;
      label.hidden = at.z > 1 || Math.abs(at.x) > 1 || Math.abs(at.y) > 1 ||
          drawn.some((d) => Math.abs(d.x - x) < (d.width + width) / 2 && Math.abs(d.y - y) < height);
      if (!label.hidden) {
        drawn.push({x, y, width});
        label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -100%)`;
      }
    });
  }

  showScan(scan) {
    const before = this.content.positionAt(this.scan);
    this.scan = scan;
    this.states = this.content.showScan(scan);
    if (this.follow) {
      const step = this.content.positionAt(scan).sub(before);
      this.camera.position.add(step);
      this.controls.target.add(step);
      this.controls.update();
    }
    const {index, time, step, registered} = this.data.scans;
    this.info.textContent = `Scan ${index[scan]} (${scan * step + 1} of ${this.data.totals.scans}), ` +
        `${fixed(time[scan], 2)} s: ` +
        count(this.states.length, 'moving object') +
        (step > 1 || registered[scan] ? '' : ', not registered');
    this.request();
  }

  followVehicle(on) {
    this.follow = on;
    if (on) {
      const step = this.content.positionAt(this.scan).sub(this.controls.target);
      const away = this.camera.position.clone().sub(this.controls.target);
      this.controls.target.add(step);
      this.camera.position.copy(this.controls.target).add(away.setLength(Math.min(away.length(), 60)));
      this.controls.update();
      this.request();
    }
  }

  savePicture() {
    this.draw();  // the buffer is valid until the browser shows it
    const link = h('a', {href: this.canvas.toDataURL('image/png'), download: `${this.data.title}.png`});
    link.click();
  }
}

function checkbox(id, name, colour, on, change) {
  const input = h('input', {type: 'checkbox', id, checked: on, onchange: () => change(input.checked)});
  return h('label', {for: id}, input, colour ? h('span', {class: 'swatch', style: `background:${colour}`}) : null, name);
}

/** Slider and buttons that go through the scans in the recording's time. */
function timeControls(view, data) {
  const last = data.scans.index.length - 1;
  const slider = h('input', {type: 'range', id: 'time-slider', min: 0, max: last, step: 1, value: 0,
    'aria-label': 'Scan', oninput: () => view.showScan(Number(slider.value))});
  const speed = h('select', {id: 'play-speed', 'aria-label': 'Speed'},
      [0.5, 1, 2, 5, 10].map((v) => h('option', {value: v, selected: v === 1}, `${v}×`)));
  const button = h('button', {id: 'play', type: 'button'}, 'Play');
  let playing = false;
  let clock = 0;  // time of the recording [s]
  let before = 0;
  const step = (now) => {
    if (!playing) {
      return;
    }
    clock += (now - before) / 1000 * Number(speed.value);
    before = now;
    let scan = Number(slider.value);
    while (scan < last && data.scans.time[scan + 1] <= clock) {
      ++scan;
    }
    if (scan !== Number(slider.value)) {
      slider.value = scan;
      view.showScan(scan);
    }
    if (scan === last) {
      toggle();
    } else {
      requestAnimationFrame(step);
    }
  };
  const toggle = () => {
    playing = !playing;
    button.textContent = playing ? 'Pause' : 'Play';
    if (playing) {
      if (Number(slider.value) === last) {
        slider.value = 0;
      }
      clock = data.scans.time[Number(slider.value)];
      before = performance.now();
      requestAnimationFrame(step);
    }
  };
  button.addEventListener('click', toggle);
  slider.addEventListener('input', () => clock = data.scans.time[Number(slider.value)]);
  return h('div', {class: 'time'}, button, slider, speed);
}

function layerControls(view) {
  return h('div', {class: 'controls', id: 'layers'}, 'Show:', [...view.content.layers].map(([key, layer]) =>
    checkbox(`layer-${key}`, layer.name, layer.colour, layer.object.visible, (on) => {
      layer.object.visible = on;
      view.request();
    })), checkbox('layer-labels', 'labels', null, true, (on) => {
      view.show_labels = on;
      view.request();
    }));
}

/** What the colours of the points mean. */
class Legend {
  constructor(map) {
    this.map = map;
    this.bar = h('span', {class: 'bar'});
    this.low = h('span', {});
    this.high = h('span', {});
    this.words = h('span', {});
    this.element = h('div', {class: 'colours', id: 'colours'}, this.low, this.bar, this.high, this.words);
    this.show(0);
  }

  show(mode) {
    this.element.hidden = mode === 3;
    const by_height = mode < 2;
    const [low, high] = by_height ? this.map.ranges[mode].map((v) => `${fixed(v, 1).replace(/^-0.0$/, '0.0')} m`) : [0, 1];
    this.low.textContent = low;
    this.high.textContent = high;
    this.words.textContent = ['over the path', 'height', 'intensity'][mode] || '';
    this.bar.style.background = `linear-gradient(to right, ${by_height ? ramp : '#ccc, #545454 25%, #0d0d0d'})`;
  }
}

/** Colours of the kinds of objects that there are; null without any. */
function legendOfObjects({objects}) {
  const kinds = [...new Set(objects.map(kindOf))];
  return kinds.length === 0 ? null : h('div', {class: 'colours right', id: 'kinds'}, kinds.map((kind) =>
    h('span', {}, h('span', {class: 'swatch', style: `background:${kind.colour}`}), kind.many)));
}

/** How the points are drawn, and how much of them. */
function pointControls(view) {
  const {map} = view.content;
  const legend = new Legend(map);
  view.stage.append(legend.element);
  const colour = h('select', {id: 'colour', onchange: () => {
    map.colourBy(Number(colour.value));
    legend.show(Number(colour.value));
    view.request();
  }}, ['height over the path', 'height', 'intensity', 'none'].map((name, i) => h('option', {value: i}, name)));
  const size = h('input', {type: 'range', id: 'point-size', min: 0.02, max: 0.5, step: 0.02, value: 0.12,
    oninput: () => {
      map.material.uniforms.size.value = Number(size.value);
      view.request();
    }});
  const least = Math.floor(map.reach[0]);
  const most = Math.max(least + 1, Math.ceil(map.reach[1]));
  const cut_at = h('output', {id: 'cut-height', for: 'cut'}, 'nothing');
  const cut = h('input', {type: 'range', id: 'cut', min: least, max: most, step: 0.1, value: most, oninput: () => {
    const on = Number(cut.value) < most;
    map.cutAbove(on ? Number(cut.value) : no_cut);
    cut_at.textContent = on ? `above ${fixed(Number(cut.value), 1)} m over the path` : 'nothing';
    view.request();
  }});
  return [h('label', {}, 'colour by', colour), h('label', {}, 'point size', size),
    h('label', {title: 'Hides the points that are higher, such as ceilings and tree tops'}, 'cut off', cut, cut_at)];
}

function viewControls(view) {
  const button = (id, name, action) => h('button', {type: 'button', id, onclick: action}, name);
  return h('div', {class: 'controls'}, button('view-all', 'Whole path', () => view.reset(false)),
      button('view-above', 'From above', () => view.reset(true)),
      checkbox('follow', 'follow the sensor', null, false, (on) => view.followVehicle(on)),
      view.content.map ? pointControls(view) : null,
      button('save', 'Save picture', () => view.savePicture()));
}

function mapInWords({map}) {
  if (map.count === 0) {
    return 'The run has no map: sensor, path and moving objects are shown without it. ';
  }
  const part = map.count < map.of ?
      `${map.count.toLocaleString('en')} of ${count(map.of, 'map point')}, ` +
      (map.voxel > 0 ? `one per cube of ${fixed(map.voxel, 2)} m (report.max_points), ` : 'evenly thinned, ') :
      `${count(map.count, 'map point')}, `;
  return part + 'those of the whole run. ' + (map.ceilings > 0 ?
      `${count(map.ceilings, 'of them belongs', 'of them belong')} to ceilings, which are not shown at first. ` : '');
}

/** The section; it is filled when it is in the page, as its size must be known. */
export function view3d(data) {
  const stage = h('div', {class: 'stage'});
  const info = h('div', {id: 'scene-info'});
  const section = h('section', {id: 'view'}, h('h2', {}, '3D view'), h('p', {}, mapInWords(data),
      'Drag to turn, right button or two fingers to move, wheel or pinch to zoom. The slider goes through ' +
      'the scans: sensor and objects move. ', shownScans(data)));
  const start = () => {
    try {
      const view = new View(data, stage, info);
      view.show_labels = true;
      stage.append(...[legendOfObjects(data)].filter((legend) => legend !== null));
      section.append(layerControls(view), stage, timeControls(view, data), info, viewControls(view));
      view.showScan(0);
    } catch (error) {
      const what = error instanceof NoWebGl ?
          `The 3D view needs WebGL 2, which this browser does not offer here (${error.message}).` :
          `The 3D view could not be built: ${error.message}.`;
      console.error(error);
      section.append(h('p', {class: 'verdict warn', id: 'no-webgl'}, `${what} Everything else on the page ` +
          'works without.'));
    }
  };
  return {section, start};
}
