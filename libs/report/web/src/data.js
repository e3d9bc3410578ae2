// SPDX-License-Identifier: BSD-3-Clause
// Reads what the program has put into the page (libs/report/src/RunPageJson.cpp).

/** The run's figures. */
export function readData() {
  return JSON.parse(document.getElementById('data').textContent);
}

/** Map points as x, y, z, intensity, each a 16-bit share of its range, interleaved for the GPU. */
export function readPoints(count) {
  const element = document.getElementById('points');
  const binary = atob(element.textContent);
  element.textContent = '';
  const byte = (i) => binary.charCodeAt(i);
  const points = new Uint16Array(4 * count);
  for (let axis = 0; axis < 3; ++axis) {
    for (let i = 0, at = 2 * count * axis; i < count; ++i, at += 2) {
      points[4 * i + axis] = byte(at) | byte(at + 1) << 8;
    }
  }
  for (let i = 0; i < count; ++i) {
    points[4 * i + 3] = 257 * byte(6 * count + i);
  }
  return points;
}

/** Distance travelled up to each pose [m]. */
export function distances(poses) {
  const result = [0];
  for (let i = 1; i < poses.x.length; ++i) {
    const step = Math.hypot(
        poses.x[i] - poses.x[i - 1], poses.y[i] - poses.y[i - 1], poses.z[i] - poses.z[i - 1]);
    result.push(result[i - 1] + step);
  }
  return result;
}

/** What a reader calls a class of objects, and its colour. */
const kinds = {
  vehicle: {one: 'vehicle', many: 'vehicles', colour: '#d62828'},
  person: {one: 'person', many: 'persons', colour: '#ff7f0e'},
  twoWheeler: {one: 'two-wheeler', many: 'two-wheelers', colour: '#8c3cbd'},
  unknown: {one: 'unknown object', many: 'unknown objects', colour: '#3c8c3c'},
};
const kindOfClass = {
  Car: 'vehicle', Van: 'vehicle', Truck: 'vehicle', Bus: 'vehicle', Pedestrian: 'person',
  Cyclist: 'twoWheeler', Motorcyclist: 'twoWheeler',
};
export function kindOf(object) {
  return kinds[kindOfClass[object.class] || 'unknown'];
}

export const colours = {
  final: '#145abe', odometry: '#e08a00', truth: '#555555', loop: '#c828c8', bad: '#c22222',
};
