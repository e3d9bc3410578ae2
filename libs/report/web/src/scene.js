// SPDX-License-Identifier: BSD-3-Clause
// The 3D view: what is in it. view.js has the buttons and the slider.
import {AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry,
  DirectionalLight, EdgesGeometry, GLSL3, GridHelper, Group, LinearSRGBColorSpace, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, Points, RawShaderMaterial, Scene, Vector3} from 'three';
import {Line2} from 'three/addons/lines/Line2.js';
import {LineGeometry} from 'three/addons/lines/LineGeometry.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';
import {LineSegments2} from 'three/addons/lines/LineSegments2.js';
import {LineSegmentsGeometry} from 'three/addons/lines/LineSegmentsGeometry.js';
import {colours, everyNth, kindOf} from './data.js';
import {heightsOverPath, quantiles} from './heights.js';

const max_boxes = 200;  // of objects shown at one time
export const no_cut = 1e6;  // height over the path [m]

/** Colours of heights, from low to high. */
export const ramp = ['#a8b3c2', '#3385a8', '#295280', '#73336b'];
const vec3 = (colour) => `vec3(${new Color().setStyle(colour, LinearSRGBColorSpace).toArray().map((v) => v.toFixed(4))})`;

const vertex = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec3 low, extent;
uniform vec2 heights;
uniform float size, viewport, cut;
uniform int mode;
in vec4 position;  // x, y, z and intensity as shares of their ranges
in float over;  // height over the path
out vec3 colour;

vec3 byHeight(float h) {
  vec3 a = ${vec3(ramp[0])}, b = ${vec3(ramp[1])}, c = ${vec3(ramp[2])}, d = ${vec3(ramp[3])};
  return h * 3.0 < 1.0 ? mix(a, b, h * 3.0) : h * 3.0 < 2.0 ? mix(b, c, h * 3.0 - 1.0) : mix(c, d, h * 3.0 - 2.0);
}

void main() {
  vec3 p = low + extent * position.xyz;
  vec4 seen = modelViewMatrix * vec4(p, 1.0);
  gl_Position = over > cut ? vec4(0.0, 0.0, 2.0, 1.0) : projectionMatrix * seen;  // the former is not in the picture
  gl_PointSize = clamp(size * viewport * projectionMatrix[1][1] * 0.5 / max(0.1, -seen.z), 1.0, 24.0);
  float h = ((mode == 0 ? over : p.z) - heights.x) / (heights.y - heights.x);
  colour = mode < 2 ? byHeight(clamp(h, 0.0, 1.0)) : mode == 2 ? vec3(0.80 - 0.75 * sqrt(position.w)) : vec3(0.42);
}`;
const fragment = `
precision mediump float;
in vec3 colour;
out vec4 result;
void main() { result = vec4(colour, 1.0); }`;

/** A line of some pixels: those of LineBasicMaterial are one pixel wide. */
function line(poses, colour, lift) {
  const geometry = new LineGeometry();
  const values = new Float32Array(3 * poses.x.length);
  for (let i = 0; i < poses.x.length; ++i) {
    values.set([poses.x[i], poses.y[i], poses.z[i] + lift], 3 * i);
  }
  geometry.setPositions(values);
  return new Line2(geometry, new LineMaterial({color: colour, linewidth: 2.5}));
}

/** The map points; those of ceilings, the last ones of them, are an object of their own. */
class MapPoints {
  constructor(data, values) {
    const {map} = data;
    const over = heightsOverPath(data, values);
    const below = map.count - map.ceilings;  // number of the other points
    const height = (i) => map.low[2] + values[4 * i + 2] * map.step[2];
    /** Heights between which the colours change, by mode, at least 1 m apart [m]. */
    this.ranges = [(i) => over[i], height].map((value) => {
      const [low, high] = quantiles(below, value, [0.02, 0.98]);
      return [low, Math.max(high, low + 1)];
    });
    /** Heights over the path of nearly all points [m]. */
    this.reach = quantiles(map.count, (i) => over[i], [0.02, 0.999]);
    const extent = map.step.map((step) => step * 65535);
    this.material = new RawShaderMaterial({glslVersion: GLSL3, vertexShader: vertex,
      fragmentShader: fragment, uniforms: {low: {value: new Vector3(...map.low)},
        extent: {value: new Vector3(...extent)}, heights: {value: this.ranges[0]}, size: {value: 0.12},
        viewport: {value: 600}, cut: {value: no_cut}, mode: {value: 0}}});
    this.attributes = {position: new BufferAttribute(values, 4, true), over: new BufferAttribute(over, 1)};
    this.others = this.drawn(0, below);
    this.ceilings = map.ceilings > 0 ? this.drawn(below, map.ceilings) : null;
  }

  drawn(start, count) {
    const geometry = new BufferGeometry();
    Object.entries(this.attributes).forEach(([name, values]) => geometry.setAttribute(name, values));
    geometry.setDrawRange(start, count);
    const points = new Points(geometry, this.material);
    points.frustumCulled = false;  // three.js knows nothing of the shares
    return points;
  }

  colourBy(mode) {
    this.material.uniforms.mode.value = mode;
    this.material.uniforms.heights.value = this.ranges[Math.min(mode, 1)];
  }

  /** Hides what is higher over the path [m]. */
  cutAbove(height) {
    this.material.uniforms.cut.value = height;
  }
}

/** Line segments: two ends each, three coordinates an end. */
function segments(ends, colour) {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(new Float32Array(ends));
  return new LineSegments2(geometry, new LineMaterial({color: colour, linewidth: 1.5}));
}

/** Seen from above the two ends of a loop are one place: a post makes it visible. */
function loopsOf(loops) {
  return segments(loops.flatMap(({from, to}) => [...from, ...to, ...to, to[0], to[1], to[2] + 6]), colours.loop);
}

function keyframesOf(positions) {
  return segments(positions.flatMap(([x, y, z]) => [x, y, z, x, y, z + 1]), colours.final);
}

/** The vehicle: a disc with a pointer ahead. */
function sensorMark() {
  const group = new Group();
  const material = new MeshLambertMaterial({color: colours.final});
  const disc = new Mesh(new CylinderGeometry(0.7, 0.7, 0.5, 24), material);
  disc.rotation.x = Math.PI / 2;
  const pointer = new Mesh(new BoxGeometry(2.2, 0.35, 0.35), material);
  pointer.position.x = 1.1;
  group.add(disc, pointer);
  return group;
}

const box_geometry = new BoxGeometry(1, 1, 1);
const edges = new EdgesGeometry(box_geometry);

function boxMark() {
  const group = new Group();
  const body = new Mesh(box_geometry, new MeshLambertMaterial({transparent: true, opacity: 0.35, depthWrite: false}));
  const frame = new LineSegments(edges, new LineBasicMaterial());
  const nose = new Mesh(box_geometry, new MeshLambertMaterial());
  nose.scale.set(0.12, 0.6, 0.25);
  nose.position.x = 0.5;
  group.add(body, frame, nose);
  group.visible = false;
  return group;
}

/** Everything that is drawn, in layers that can be hidden, at a scan that can be chosen. */
export class Content {
  constructor(data, points) {
    this.data = data;
    this.scene = new Scene();
    this.scene.background = new Color('#ffffff');
    this.scene.add(new AmbientLight(0xffffff, 2));
    const sun = new DirectionalLight(0xffffff, 1.5);
    sun.position.set(1, -2, 3);
    this.scene.add(sun);
    this.layers = new Map();
    this.boxes = [];
    this.sensor = sensorMark();
    this.statesByScan = this.indexStates();
    if (data.map.count > 0) {
      this.map = new MapPoints(data, points);
      this.addLayer('map', 'map', '#7a8794', this.map.others, true);
      if (this.map.ceilings) {
        this.addLayer('ceilings', 'ceilings', '#7a8794', this.map.ceilings, false);
      }
    }
    const path = new Group();
    path.add(line(data.final, colours.final, 0.05), this.sensor);
    this.addLayer('path', 'path (final)', colours.final, path, true);
    this.addLayer('odometry', 'odometry', colours.odometry, line(data.odometry, colours.odometry, 0.1), false);
    if (data.reference) {
      this.addLayer('truth', data.difference_to || 'ground truth', colours.truth, line(data.reference, colours.truth, 0.15), false);
    }
    if (data.loops.length > 0) {
      this.addLayer('loops', 'loops', colours.loop, loopsOf(data.loops), true);
    }
    const {step, position} = data.keyframes;
    this.addLayer('keyframes', step === 1 ? 'keyframes' : everyNth(step, 'keyframe'), colours.final,
        keyframesOf(position), false);
    this.objects = this.addLayer('objects', 'moving objects', '#d62828', new Group(), true);
    this.addLayer('tracks', 'their paths', '#d62828', this.tracks(), true);
    this.addLayer('grid', 'grid, 10 m', '#c8ced6', this.grid(), false);
  }

  addLayer(key, name, colour, object, on) {
    object.visible = on;
    this.layers.set(key, {name, colour, object});
    this.scene.add(object);
    return object;
  }

  /** For each scan the objects seen in it and which of their states it is. */
  indexStates() {
    const result = this.data.scans.index.map(() => []);
    for (const object of this.data.objects) {
      object.scan.forEach((scan, i) => result[scan].push({object, i}));
    }
    return result;
  }

  tracks() {
    const group = new Group();
    for (const object of this.data.objects) {
      group.add(line({x: object.x, y: object.y, z: object.z}, kindOf(object).colour, 0));
    }
    return group;
  }

  grid() {
    const {x, y, z} = this.data.final;
    const least = (v) => v.reduce((a, b) => Math.min(a, b), Infinity);
    const most = (v) => v.reduce((a, b) => Math.max(a, b), -Infinity);
    const size = 10 * Math.ceil((Math.max(most(x) - least(x), most(y) - least(y)) + 120) / 10);
    const grid = new GridHelper(size, size / 10, 0xb0b8c2, 0xdde1e6);
    grid.rotation.x = Math.PI / 2;
    grid.position.set(10 * Math.round((most(x) + least(x)) / 20), 10 * Math.round((most(y) + least(y)) / 20),
        Math.min(least(z), this.map ? this.map.ranges[1][0] : 0));
    return grid;
  }

  positionAt(scan) {
    const {x, y, z} = this.data.final;
    return new Vector3(x[scan], y[scan], z[scan]);
  }

  /** Makes the sensor large enough to be seen from a position. */
  sizeSensor(from) {
    this.sensor.scale.setScalar(Math.max(0.4, from.distanceTo(this.sensor.position) / 70));
  }

  /** Moves sensor and objects to a scan. \return the objects there */
  showScan(scan) {
    const {final} = this.data;
    this.sensor.position.copy(this.positionAt(scan));
    this.sensor.rotation.set(final.roll[scan], final.pitch[scan], final.yaw[scan], 'ZYX');
    const states = this.statesByScan[scan].slice(0, max_boxes);
    while (this.boxes.length < states.length) {
      const mark = boxMark();
      this.boxes.push(mark);
      this.objects.add(mark);
    }
    this.boxes.forEach((mark, k) => {
      mark.visible = k < states.length;
      if (mark.visible) {
        const {object, i} = states[k];
        mark.position.set(object.x[i], object.y[i], object.z[i]);
        mark.rotation.z = object.yaw[i];
        mark.scale.set(object.length[i], object.width[i], object.height[i]);
        mark.children.forEach((part) => part.material.color.set(kindOf(object).colour));
      }
    });
    return states;
  }
}
