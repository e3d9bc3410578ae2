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

/** "every 3rd scan" */
export function everyNth(step, one) {
  const tens = step % 100 - step % 10;
  const ending = tens === 10 ? 'th' : ['th', 'st', 'nd', 'rd'][step % 10] || 'th';
  return `every ${step}${ending} ${one}`;
}

/** A sentence for long runs, of whose scans a part is shown; empty for others. */
export function shownScans(data) {
  return data.scans.step === 1 ? '' :
      `Shown is ${everyNth(data.scans.step, 'scan')} (report.max_scans). `;
}

/** What a reader calls a class of objects, its colour (as in map.png), and that of text on it where not white. */
const kinds = {
  vehicle: {one: 'vehicle', many: 'vehicles', colour: '#d62828'},
  person: {one: 'person', many: 'persons', colour: '#ff7f0e', ink: '#000'},
  twoWheeler: {one: 'two-wheeler', many: 'two-wheelers', colour: '#8c3cbd'},
  unknown: {one: 'unknown object', many: 'unknown objects', colour: '#009e73'},
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
