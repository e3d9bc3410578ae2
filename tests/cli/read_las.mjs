// SPDX-License-Identifier: BSD-3-Clause
// Prints the number of points of a LAS file and the smallest x, y and z, as loaders.gl reads them.
import {readFileSync} from 'node:fs';
import {parse} from '@loaders.gl/core';
import {LASLoader} from '@loaders.gl/las';

const bytes = readFileSync(process.argv[2]);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const cloud = await parse(buffer, LASLoader, {worker: false, las: {fp64: true}});
const at = cloud.attributes.POSITION.value;
const low = [Infinity, Infinity, Infinity];
for (let i = 0; i < at.length; ++i)
{
  low[i % 3] = Math.min(low[i % 3], at[i]);
}
console.log(at.length / 3, ...low);
