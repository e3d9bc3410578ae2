// SPDX-License-Identifier: BSD-3-Clause
import {readData} from './data.js';
import {h} from './dom.js';
import {details, drift, errors, furtherLidars, picture, summary, times, tracks, trajectory} from './sections.js';
import {view3d} from './view.js';

const data = readData();
const page = document.getElementById('page');
const {section: view, start} = data.scans.index.length > 0 ?
    view3d(data) : {section: null, start: () => {}};
const sections = data.scans.index.length > 0 ?
    [summary(data), view, picture(data), errors(data), trajectory(data), drift(data), tracks(data),
      furtherLidars(data), times(data), details(data)] :
    [summary(data), details(data)];
const shown = sections.filter((section) => section !== null);
const link = (section) => h('a', {href: '#' + section.id}, section.querySelector('h2').textContent);
page.replaceChildren(
    h('header', {}, h('h1', {}, data.title), h('p', {}, `Run of DySLAM on ${data.input}`)),
    h('nav', {}, shown.map(link)), ...shown);
start();
