// SPDX-License-Identifier: BSD-3-Clause
// Heights of the map points over the path: by them the points are coloured, and cut off.

const max_cells = 128;  // of the grid, along the longer side of the map
const min_side = 1;  // of its cells [m]
const storey = 2;  // positions higher than this over the lowest one of a cell are on another floor [m]

/** Mean position in every cell that the path passes; where it does so on several floors, on the lowest one. */
function places({x, y, z}, side) {
  const cells = new Map();
  for (let i = 0; i < x.length; ++i) {
    if (Number.isFinite(x[i]) && Number.isFinite(y[i]) && Number.isFinite(z[i])) {
      const key = `${Math.floor(x[i] / side)} ${Math.floor(y[i] / side)}`;
      if (!cells.has(key)) {
        cells.set(key, []);
      }
      cells.get(key).push(i);
    }
  }
  const mean = (values, indices) => indices.reduce((sum, i) => sum + values[i], 0) / indices.length;
  return [...cells.values()].map((all) => {
    const lowest = all.reduce((a, i) => Math.min(a, z[i]), Infinity);
    const on_floor = all.filter((i) => z[i] < lowest + storey);
    return {x: mean(x, on_floor), y: mean(y, on_floor), z: mean(z, on_floor)};
  });
}

/** Heights of the path in the nodes of a grid over the map: means, in which near positions weigh most. */
function levelsOf(path, low, size, side) {
  const columns = Math.floor(size[0] / side) + 2;
  const rows = Math.floor(size[1] / side) + 2;
  const levels = new Float32Array(columns * rows);
  const positions = places(path, side);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const x = low[0] + column * side;
      const y = low[1] + row * side;
      let sum = 0;
      let weights = 0;
      for (const p of positions) {
        const squared = (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y) + 0.1 * side * side;
        const weight = 1 / (squared * squared);
        sum += weight * p.z;
        weights += weight;
      }
      levels[row * columns + column] = weights > 0 ? sum / weights : 0;
    }
  }
  return {levels, columns};
}

/** Height of each map point over the path beside it [m]. \param points those of readPoints() */
export function heightsOverPath({map, final}, points) {
  const size = map.step.map((step) => 65535 * step);
  const side = Math.max(min_side, Math.max(size[0], size[1]) / max_cells);
  const {levels, columns} = levelsOf(final, map.low, size, side);
  const heights = new Float32Array(map.count);
  for (let i = 0; i < map.count; ++i) {
    const x = points[4 * i] * map.step[0] / side;
    const y = points[4 * i + 1] * map.step[1] / side;
    const at = Math.floor(y) * columns + Math.floor(x);
    const u = x - Math.floor(x);
    const v = y - Math.floor(y);
    const below = levels[at] + u * (levels[at + 1] - levels[at]);
    const above = levels[at + columns] + u * (levels[at + columns + 1] - levels[at + columns]);
    heights[i] = map.low[2] + points[4 * i + 2] * map.step[2] - below - v * (above - below);
  }
  return heights;
}

/** Quantiles of `count` values, by at most 20,000 of them. \param value gives the i-th */
export function quantiles(count, value, shares) {
  const step = Math.max(1, Math.floor(count / 20000));
  const values = Float32Array.from({length: Math.ceil(count / step)}, (_, k) => value(k * step)).sort();
  return shares.map((share) => values[Math.floor(share * (values.length - 1))]);
}
