// SPDX-License-Identifier: BSD-3-Clause
// The parts of the page that need no 3D.
import {colours, kindOf, shownScans} from './data.js';
import {count, fixed, h, s} from './dom.js';
import {legend, plot, roundStep, ticks} from './plots.js';

function kindsInWords(objects) {
  const numbers = new Map();
  for (const object of objects) {
    const kind = kindOf(object);
    numbers.set(kind, (numbers.get(kind) || 0) + 1);
  }
  return [...numbers].map(([kind, n]) => count(n, kind.one, kind.many)).join(', ');
}

/** The tracks of tracks.csv that are none of the moving objects, in brackets; empty without such. */
function otherTracks({totals, objects, files}) {
  const others = totals.reported_tracks - objects.length;
  return others > 0 && files.includes('tracks.csv') ?
      ` (${count(totals.reported_tracks, 'track')} in tracks.csv: ${others} of them never moved)` : '';
}

/** What loops were found, and what they and satellite positions did. */
function loopsInWords({totals, georeference, prior_map: prior}) {
  const {loops, loops_left_out: rejected, correction} = totals;
  const fixes = georeference && georeference.fused ? georeference.fixes : 0;
  const moved = `moved the trajectory by up to ${fixed(correction, 2)} m.`;
  if (loops === 0) {
    const none = rejected === 0 ? 'No place was recognised a second time (no loops)' :
        `${count(rejected, 'loop')} left out, as they contradict the odometry or each other`;
    if (fixes === 0) {
      return prior && prior.localised ? `${none}.` : `${none}, so nothing corrects the drift of the odometry.`;
    }
    return `${none}. ${count(fixes, 'satellite position')} ${moved}`;
  }
  const found = `${count(loops, 'loop')}: places recognised a second time. ` +
      (fixes === 0 ? `They ${moved}` : `They and ${count(fixes, 'satellite position')} ${moved}`);
  return rejected === 0 ? found :
      `${found} ${rejected.toLocaleString('en')} left out, as they contradict the others.`;
}

/** What satellite positions and accelerations say of the map; nothing for a run without them. */
function earthInWords({georeference, gravity}) {
  const result = [];
  if (georeference) {
    const {fixes, horizontal_rmse: horizontal, vertical_rmse: vertical, epsg} = georeference;
    result.push(`${count(fixes, 'satellite position')} show where the map is on the earth ` +
        `(georeference.ini${epsg > 0 ? `; UTM: EPSG ${epsg}` : ''}); they are ${fixed(horizontal, 2)} m from ` +
        `the trajectory, ${fixed(vertical, 2)} m in height (RMS).`);
  }
  if (gravity) {
    result.push(`By the accelerometer, z of the map ${gravity.levelled ? 'was' : 'is'} ` +
        `${fixed(gravity.tilt_deg, 1)}° from the vertical (sigma ${fixed(gravity.tilt_sigma_deg, 1)}°)` +
        (gravity.levelled ? '; the map was levelled.' : '.'));
  }
  return result;
}

/** How the run fits a prior map; nothing without one, or if it was not localised, which a warning says. */
function priorMapInWords({prior_map: prior}) {
  return !prior || !prior.localised ? [] :
      [`Localised in a prior map after ${fixed(prior.path_length, 1)} m; ${prior.registered.toLocaleString('en')} of ` +
          `${count(prior.keyframes, 'keyframe')} within it were registered to it (RMSE ${fixed(prior.rmse, 3)} m).`];
}

/** Where the ground truth is from, in brackets. */
function origin(data) {
  return data.reference_origin ? ` (${data.reference_origin})` : '';
}

/** What a difference to poses that are not exact can be; nothing for other ground truth. */
function limits({difference_to: other}) {
  return other ? [h('p', {id: 'limits'}, `The errors of ${other} are part of all figures. Gross errors of the run show; ` +
      'differences of some decimetres, or of a few per cent of the path, may be of either. ',
      h('code', {}, 'dyslam-eval map --self'), ' compares the maps along both.')] : [];
}

/** Of all stages; checkpoints are none, as for console and report.json. */
function millisecondsPerScan(data) {
  return Object.entries(data.stage_ms).filter(([name]) => !name.startsWith('checkpoint'))
      .reduce((sum, [, ms]) => sum + ms, 0);
}

function sentences(data) {
  const {scans: n, seconds} = data.totals;
  const lost = n - data.totals.registered;
  const ms = millisecondsPerScan(data);
  const result = [];
  result.push(`${count(n, 'scan')} in ${fixed(seconds, 1)} s; the sensor travelled ${fixed(data.length, 1)} m.`);
  if (data.sensor) {
    result.push(`Sensor: ${data.sensor}.`);
  }
  if (data.further_lidars.length > 0) {
    result.push(`Merged with its scans are those of ${data.further_lidars.map((l) => l.label).join(', ')}.`);
  }
  result.push(lost === 0 ?
      'The motion of every scan was found by registration.' :
      `${lost} of ${count(n, 'scan')} could not be registered (crosses in the plots): their motion was predicted ` +
      'from the motion before. The first scan of a recording that starts in motion is often among them.');
  result.push(...priorMapInWords(data), loopsInWords(data), ...earthInWords(data));
  result.push(data.objects.length === 0 ? `No moving object was tracked${otherTracks(data)}.` :
      `${count(data.objects.length, 'moving object')} tracked${otherTracks(data)}: ${kindsInWords(data.objects)}.`);
  const final = data.errors.find((e) => e.name === 'final');
  if (final) {
    const rmse = `${fixed(final.ate.translation_m.rmse, 3)} m (RMSE, after alignment)`;
    result.push(data.difference_to ? `The final trajectory differs by ${rmse} from ${data.difference_to}, ` +
        'which is not exact.' :
        `Against the ground truth of the recording${origin(data)} the final trajectory is off by ${rmse}.`);
  } else {
    result.push(data.reference ?
        'The ground truth of the recording has fewer than two poses at scans, so the errors are not known.' :
        'The recording has no ground truth, so the errors are not known.');
  }
  if (n > 1 && seconds > 0) {
    const period = 1000 * seconds / (n - 1);
    result.push((data.run_time > 0 ? `The run took ${fixed(data.run_time, 1)} s for ${fixed(data.recording_time, 1)} s ` +
        'of recording. ' : '') + `The stages took ${fixed(ms, 1)} ms per scan, added up, though some run side by side; ` +
        `a scan came every ${fixed(period, 0)} ms.`);
  }
  return result;
}

function warningList(data) {
  return data.warnings.length > 0 ? h('ul', {}, data.warnings.map((w) => h('li', {}, w))) : null;
}

function verdict(data) {
  if (data.failure) {
    return h('div', {class: 'verdict bad', id: 'verdict'}, h('strong', {}, 'This run is unusable. '),
        data.failure, warningList(data));
  }
  if (data.verdict === 'doubtful') {
    return h('div', {class: 'verdict warn', id: 'verdict'},
        h('strong', {}, 'Check trajectory and map. '), 'Parts of them may be wrong:', warningList(data));
  }
  if (data.warnings.length > 0) {
    return h('div', {class: 'verdict warn', id: 'verdict'},
        h('strong', {}, `${count(data.warnings.length, 'warning')}. `), 'See what they say before you ' +
        'trust the results:', warningList(data));
  }
  return h('div', {class: 'verdict good', id: 'verdict'}, h('strong', {}, 'No warnings.'));
}

function tile(value, unit, name) {
  return h('div', {class: 'tile'}, h('b', {}, value), unit ? ' ' + unit : '', h('span', {}, name));
}

export function summary(data) {
  const {scans: n, keyframes, loops} = data.totals;
  const time = data.run_time > 0 && data.recording_time > 0 ? tile(fixed(data.recording_time / data.run_time, 2), '×', 'real time') :
      tile(fixed(millisecondsPerScan(data), 1), 'ms', 'per scan, all stages');
  return h('section', {id: 'summary'}, h('h2', {}, 'Summary'), verdict(data),
      h('div', {class: 'tiles'}, tile(n.toLocaleString('en'), '', 'scans'),
          tile(fixed(data.length, 1), 'm', 'path'), tile(keyframes.toLocaleString('en'), '', 'keyframes'),
          tile(loops, '', 'loops'), tile(data.objects.length, '', 'moving objects'),
          tile(data.map.of.toLocaleString('en'), '', 'map points'), time),
      h('ul', {class: 'sentences'}, sentences(data).map((line) => h('li', {}, line))));
}

const has = (e) => e.kitti.segments > 0;
const figures = [
  ['t_rel', '%', 3, (e) => has(e) ? e.kitti.t_rel_percent : null,
    'Drift of the position per distance travelled, mean over stretches of 100 to 800 m, as the KITTI ' +
    'benchmark defines it.'],
  ['r_rel', '°/100 m', 3, (e) => has(e) ? e.kitti.r_rel_deg_per_100m : null,
    'Drift of the orientation over the same stretches.'],
  ['RPE, position', 'm', 4, (e) => e.rpe.translation_m.rmse,
    'Relative pose error: error of the motion from one scan to the next (RMSE).'],
  ['RPE, rotation', '°', 4, (e) => e.rpe.rotation_deg.rmse, 'The same for the rotation.'],
  ['ATE, position', 'm', 3, (e) => e.ate.translation_m.rmse,
    'Absolute trajectory error: distance from the true position after the whole trajectory is moved ' +
    'rigidly onto the truth (RMSE). How well the map fits together as a whole.'],
  ['ATE, rotation', '°', 3, (e) => e.ate.rotation_deg.rmse, 'The same for the orientation.'],
  ['forward ratio', '', 4, (e) => e.forward_ratio,
    'Estimated distance by true distance: 1 is right, below 1 the motion is underestimated.'],
  ['end error', 'm', 3, (e) => e.end_error.translation_m,
    'Distance from the true position at the end, the first poses made to coincide.'],
  ['end error', '% of path', 3, (e) => e.end_error.percent, 'The same as a share of the path.'],
];

export function errors(data) {
  const section = h('section', {id: 'errors'},
      h('h2', {}, data.difference_to ? `Differences to ${data.difference_to}` : 'Errors'));
  if (data.errors.length === 0) {
    section.append(h('p', {}, 'The recording has no ground truth that could be compared. ',
        h('code', {}, 'dyslam-eval map --self'), ' rates a trajectory by how sharp the map is that it ' +
        'gives; so two trajectories of one recording can be compared without ground truth.'));
    return section;
  }
  const rows = figures.filter(([, , , value]) => data.errors.some((e) => Number.isFinite(value(e))));
  section.append(
      h('p', {}, `Against the ${data.difference_to ? 'poses' : 'ground truth'} of the recording${origin(data)}. "Odometry" is the ` +
          'trajectory before the factor graph, "final" the one after it, which the map is built with. ' +
          (data.difference_to ? '' : 'Smaller is better, except for the ratio, where 1 is best.')),
      ...limits(data),
      h('div', {class: 'scroll'}, h('table', {id: 'error-table'},
          h('thead', {}, h('tr', {}, h('th', {}, 'figure'),
              data.errors.map((e) => h('th', {class: 'number'}, e.name)), h('th', {}, 'unit'),
              h('th', {}, 'meaning'))),
          h('tbody', {}, rows.map(([name, unit, digits, value, words]) => h('tr', {}, h('td', {}, name),
              data.errors.map((e) => h('td', {class: 'number'}, fixed(value(e), digits))),
              h('td', {}, unit), h('td', {class: 'words'}, words)))))));
  return section;
}

function lines(data, build) {
  const all = [{name: 'final', poses: data.final, colour: colours.final}];
  all.push({name: 'odometry', poses: data.odometry, colour: colours.odometry, dash: '7 4'});
  if (data.reference) {
    all.push({name: data.difference_to || 'ground truth', poses: data.reference, colour: colours.truth, dash: '2 3'});
  }
  return all.map((line) => ({...line, ...build(line.poses)}));
}

/** Crosses at the scans that were not registered; of long runs, at the shown scan before each. */
function notRegistered(data, x, y) {
  const points = data.scans.registered.flatMap((ok, i) => ok ? [] : [{x: x[i], y: y[i]}]);
  return {name: 'not registered', colour: colours.bad, points};
}

export function trajectory(data) {
  const n = data.final.x.length;
  const mark = (i, name, colour) => ({x: data.final.x[i], y: data.final.y[i], name, colour});
  const shown = shownScans(data);
  return h('section', {id: 'trajectory'}, h('h2', {}, 'Trajectory'), shown ? h('p', {}, shown) : null,
      h('div', {class: 'columns'},
      plot({title: 'From above.', words: 'Where lines lie on one another, only the upper one is seen.',
          equal: true, x: 'x [m]', y: 'y [m]', series: lines(data, (p) => ({x: p.x, y: p.y})),
          crosses: notRegistered(data, data.final.x, data.final.y),
          marks: n > 0 ? [mark(0, 'start', '#1c8f3a'), mark(n - 1, 'end', colours.bad)] : []}),
      h('div', {},
          plot({title: 'Height.', words: 'z of the sensor\'s vehicle over the distance travelled.',
            x: 'distance [m]', y: 'z [m]', series: lines(data, (p) => ({x: p.distance, y: p.z}))}),
          plot({title: 'Speed.', words: 'By the final trajectory, over half a second.', x: 'time [s]',
            y: 'speed [m/s]', floor: 0, digits: 2,
            series: [{name: 'final', colour: colours.final, x: data.scans.time, y: data.scans.speed}],
            crosses: notRegistered(data, data.scans.time, data.scans.speed)}))));
}

export function drift(data) {
  const names = Object.keys(data.drift);
  const truth = data.drift_against === 'truth';
  const section = h('section', {id: 'drift'}, h('h2', {}, 'Drift over distance'));
  if (names.length === 0) {
    return null;
  }
  if (!truth && data.totals.correction < 0.0005) {
    section.append(h('p', {}, 'There is no ground truth, and final trajectory and odometry are the same: no loop or ' +
        'satellite position has corrected the odometry. That does not mean that nothing has drifted.'));
    return section;
  }
  section.append(h('p', {}, truth ?
    `${data.difference_to ? `Differences to ${data.difference_to}` : 'Errors against the ground truth'}, the first ` +
    'poses made to coincide: what odometry accumulates grows ' +
    'with the distance.' :
    'There is no ground truth. Shown is by how much the odometry differs from the final trajectory: what ' +
    'loops and graph have corrected. Zero everywhere means that nothing was corrected, not that ' +
    'nothing has drifted.'));
  const what = truth && !data.difference_to ? 'error' : 'difference';
  const series = (key) => names.map((name) => ({name, x: data.drift[name].distance,
    y: data.drift[name][key], colour: colours[name], dash: name === 'odometry' ? '7 4' : undefined}));
  section.append(h('div', {class: 'columns three'},
      plot({title: 'Position,', words: 'horizontal distance.', x: 'distance [m]', y: `position ${what} [m]`,
        floor: 0, series: series('position')}),
      plot({title: 'Height,', words: truth ? `estimate minus ${data.difference_to || 'truth'}.` : 'odometry minus final.',
        x: 'distance [m]', y: `height ${what} [m]`, series: series('height')}),
      plot({title: 'Heading,', words: 'positive is to the left.', x: 'distance [m]', y: `heading ${what} [°]`,
        series: series('heading')})));
  return section;
}

const stages = {
  preprocess: 'crops the scan and corrects the motion during the revolution',
  deskew: 'corrects the scan again, with the motion that was found',
  dyseg: 'decides which points move',
  odometry: 'matches the scan with the one before it',
  refine: 'registers the scan to the local map',
  tracking: 'detects and tracks the moving objects',
  'hindsight.tracking': 'detects and tracks the moving objects again, on the final labels',
  backend: 'factor graph and search for loops',
  'backend.finish': 'last optimisation of the graph, spread over all scans',
  map: 'adds keyframes to the static map',
  'map.finish': 'stitches the map again, spread over all scans',
  hindsight: 'decides again what moves, from the scans before and after',
  'hindsight.finish': 'decides again what moves in the last scans, spread over all',
  'checkpoint.front_end': 'saves the state of odometry and tracks, spread over all scans',
  'checkpoint.back_end': 'saves the state of graph and map, spread over all scans',
};

export function times(data) {
  const rows = Object.entries(data.stage_ms).sort((a, b) => b[1] - a[1]);
  const most = rows.length > 0 ? rows[0][1] : 1;
  return h('section', {id: 'times'}, h('h2', {}, 'Time per stage'),
      h('p', {}, 'Mean per scan in milliseconds, without reading and writing.'),
      h('table', {class: 'bars'}, h('tbody', {}, rows.map(([name, ms]) => h('tr', {},
          h('td', {}, h('code', {}, name), h('small', {}, stages[name] || '')),
          h('td', {class: 'number'}, fixed(ms, 2)),
          h('td', {class: 'bar'}, h('div', {style: `width:${(100 * ms / most).toFixed(2)}%`})))))));
}

function chart(data, area) {
  const width = Math.max(260, area.clientWidth);
  const objects = [...data.objects].sort((a, b) => a.scan[0] - b.scan[0] || a.id - b.id);
  const row = objects.length > 60 ? Math.max(2, 900 / objects.length) : 15;
  const label = 58;  // as the plots, so that the times are below each other
  const height = objects.length * row + 46;
  const t = data.scans.time;
  const end = t[t.length - 1] || 1;
  const px = (v) => label + v / end * (width - label - 18);
  const svg = s('svg', {width: '100%', height, viewBox: `0 0 ${width} ${height}`, role: 'img',
    'aria-label': 'Tracks over time'});
  const {values, digits} = ticks([0, end], roundStep([0, end], (width - label) / 80));
  for (const v of values) {
    svg.append(s('line', {x1: px(v), x2: px(v), y1: 4, y2: height - 40, class: 'grid'}),
        s('text', {x: px(v), y: height - 24, 'text-anchor': 'middle'}, fixed(v, digits)));
  }
  svg.append(s('text', {x: (label + width) / 2, y: height - 6, 'text-anchor': 'middle', class: 'axis'},
      'time [s]'));
  const gap = 1.5 * end / Math.max(1, t.length - 1);
  objects.forEach((object, k) => {
    const y = 4 + k * row;
    const g = s('g', {class: 'track'}, s('title', {}, `${object.class} ${object.id}: ` +
        `${fixed(t[object.scan[0]], 1)} to ${fixed(t[object.scan[object.scan.length - 1]], 1)} s, ` +
        `fastest ${fixed(Math.max(...object.speed), 1)} m/s`));
    for (let a = 0, b = 0; a < object.scan.length; a = b + 1) {
      for (b = a; b + 1 < object.scan.length && object.scan[b + 1] === object.scan[b] + 1;) {
        ++b;
      }
      g.append(s('rect', {x: px(t[object.scan[a]]), y: y + row * 0.12, height: row * 0.76, rx: 2,
        width: Math.max(2, px(Math.min(end, t[object.scan[b]] + gap)) - px(t[object.scan[a]])),
        fill: kindOf(object).colour}));
    }
    svg.append(g);
    if (row >= 12) {
      svg.append(s('text', {x: label - 6, y: y + row * 0.8, 'text-anchor': 'end'}, `no. ${object.id}`));
    }
  });
  area.replaceChildren(svg);
}

export function tracks(data) {
  const section = h('section', {id: 'tracks'}, h('h2', {}, 'Moving objects'));
  const share = data.scans.points.map((n, i) => n > 0 ? 100 * data.scans.moving[i] / n : 0);
  const moving = plot({title: 'Moving points', words: 'of each scan, found by the segmenter.',
    x: 'time [s]', y: 'moving points [%]', floor: 0, digits: 2,
    series: [{name: 'share of the scan', x: data.scans.time, y: share, colour: colours.bad}]});
  if (data.objects.length === 0) {
    section.append(h('p', {}, 'No moving object was tracked.'), moving);
    return section;
  }
  const kinds = [...new Set(data.objects.map(kindOf))];
  const area = h('div', {class: 'plot', id: 'track-chart'});
  new ResizeObserver(() => chart(data, area)).observe(area);
  section.append(
      h('figure', {}, h('figcaption', {}, h('strong', {}, 'Tracks over time.'), ' One row per object, ' +
          'as long as it was tracked as moving. Point at a row for its class and speed.'),
      legend(kinds.map((kind) => ({name: kind.one, colour: kind.colour}))), area), moving);
  return section;
}

/** The scans of further lidars that were merged with those of the first one. */
export function furtherLidars(data) {
  if (data.further_lidars.length === 0) {
    return null;
  }
  const head = ['lidar', 'its scans', 'merged into', 'time offset [ms]', 'largest [ms]', 'points per scan'];
  return h('section', {id: 'lidars'}, h('h2', {}, 'Further lidars'),
      h('p', {}, 'Scans of these lidars were merged with those of the first one. Time offset: stamp of the ' +
          'scan minus that of the one that it was merged into, median and largest. ', h('code', {}, 'scan_parts.csv'),
          ' has a row for each.'),
      h('div', {class: 'scroll'}, h('table', {}, h('thead', {}, h('tr', {}, head.map((name, i) =>
        h('th', {class: i > 0 ? 'number' : false}, name)))),
      h('tbody', {}, data.further_lidars.map((lidar) => h('tr', {}, h('td', {}, h('code', {}, lidar.label)),
          [lidar.scans.toLocaleString('en'), `${lidar.merged_into.toLocaleString('en')} of ` +
            count(data.totals.scans, 'scan'), fixed(lidar.offset_ms, 1), fixed(lidar.largest_offset_ms, 1),
          Math.round(lidar.points).toLocaleString('en')].map((text) => h('td', {class: 'number'}, text))))))));
}

export function picture(data) {
  const image = document.getElementById('picture');
  const section = h('section', {id: 'above'}, h('h2', {}, 'Map from above'));
  if (data.map.count === 0 || image.getAttribute('src').endsWith(',')) {
    image.remove();
    section.append(h('p', {}, data.map.count === 0 ? 'The run has no map.' : 'There is no picture.'));
    return section;
  }
  image.hidden = false;
  section.append(h('p', {}, 'The static map (darker: higher over the ground), the path of the sensor with start ' +
      '(green dot) and end (red square), and the moving objects with their paths and last boxes. The same picture is the file ',
      h('code', {}, 'map.png'), '.'), image);
  return section;
}

const contents = {
  'trajectory_tum.txt': 'final trajectory: time [s], x y z [m], quaternion x y z w',
  'trajectory_kitti.txt': 'final trajectory as 3x4 matrices, KITTI\'s layout',
  'odometry_tum.txt': 'trajectory before the factor graph',
  'reference_tum.txt': 'ground truth of the recording',
  'graph.graph': 'pose graph for MRPT', 'graph.g2o': 'pose graph for g2o',
  'georeference.ini': 'where the map is on the earth',
  'trajectory_utm.txt': 'final trajectory in UTM: time [s], easting, northing, height [m], quaternion x y z w',
  'factor_graph.txt': 'factor graph with its objects', 'scans.csv': 'what became of each scan',
  'scan_parts.csv': 'which scans of further lidars were merged into each scan',
  'motions.csv': 'covariance of each motion', 'tracks.csv': 'tracked objects as a table',
  'tracks.txt': 'tracked objects in KITTI\'s layout', 'labels': 'moving or static for each point',
  'probabilities': 'probability that a point moves, for each point',
  'static_scans': 'scans without moving points', 'static_scans.rawlog': 'scans without moving points',
  'replay.rawlog': 'the run as a replay for RawLogViewer',
  'keyframes.simplemap': 'static points of the keyframes for MRPT',
  'map_static.pcd': 'static map', 'map_static.ply': 'static map',
  'map.3Dscene': '3D scene for SceneViewer3D', 'map.png': 'the picture above',
  'trajectory.png': 'plot against the ground truth', 'effective.ini': 'every setting of the run',
};

export function details(data) {
  return h('section', {id: 'details'}, h('h2', {}, 'Files and settings'),
      h('p', {}, 'Recording: ', h('code', {}, data.input), '. Methods: ', h('code', {}, data.method),
          `. DySLAM ${data.version}.`),
      h('details', {}, h('summary', {}, 'Files in the folder of the run'), h('table', {}, h('tbody', {},
          data.files.map((name) => h('tr', {}, h('td', {}, h('code', {}, name)),
              h('td', {class: 'words'}, contents[name] || '')))))),
      h('details', {}, h('summary', {}, 'Every setting (effective.ini)'), h('pre', {}, data.settings)));
}
