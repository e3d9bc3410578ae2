// SPDX-License-Identifier: BSD-3-Clause
// Makes share/dyslam/report/page.html and LICENSE.three from src/ and node_modules/.
// With --check it writes nothing and fails if the page is not what the sources give.
import {build} from 'esbuild';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const share = join(here, '../../../share/dyslam/report');

const bundle = await build({
  entryPoints: [join(here, 'src/main.js')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'inline',
  write: false,
});
// A function as replacement: "$" has no meaning in what it returns.
const script = bundle.outputFiles[0].text.trim().replaceAll('</script', '<\\/script');
const style = readFileSync(join(here, 'src/style.css'), 'utf8').trim();
const page = readFileSync(join(here, 'src/page.html'), 'utf8')
    .replace('/*STYLE*/', () => style)
    .replace('/*SCRIPT*/', () => script);
const licence = readFileSync(join(here, 'node_modules/three/LICENSE'), 'utf8');

const products = {'page.html': page, 'LICENSE.three': licence};
for (const [name, text] of Object.entries(products)) {
  const path = join(share, name);
  if (!process.argv.includes('--check')) {
    mkdirSync(share, {recursive: true});
    writeFileSync(path, text);
  } else if (readFileSync(path, 'utf8') !== text) {
    console.error(`${path}: is not what libs/report/web gives; run scripts/build_report_page.sh`);
    process.exitCode = 1;
  }
}
