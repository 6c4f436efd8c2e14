/**
 * How long each slice of a search takes, outside of a page: `node slices.mjs WORDS [pkg]`. WORDS is what
 * `cargo run -p reprise-searcher --example known -- ACTOR.reprise WORDS` writes; pkg is the folder of the modules (default:
 * dist/pkg). Milliseconds of processor time of the whole process, so that it should have nothing else to do.
 */

import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const [words, pkg = fileURLToPath(new URL('../../dist/pkg', import.meta.url))] = process.argv.slice(2);
/** Milliseconds that a slice may take, as on the page, and that the search may. */
const SLICE = 4;
const PATIENCE = 40_000;
const PATH = { points: [[0, 0], [2, 1], [0, 3], [-2, 1], [0, 0], [3, 3]], shape: 'spline', free_start: true };

const module = await import(`${pkg}/searcher.js`);
module.initSync({ module: readFileSync(`${pkg}/searcher_bg.wasm`) });
const bytes = readFileSync(words);
const known = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);

const spent = () => {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1000;
};
const taken = new Map();
function timed(name, work) {
  const begin = spent();
  const result = work();
  taken.set(name, [...(taken.get(name) ?? []), spent() - begin]);
  return result;
}

const searcher = timed('handing over', () => new module.Searcher(known, '[]'));
while (!timed('reading', () => searcher.read(SLICE)));
while (!timed('getting ready', () => searcher.prepare(SLICE)));
timed('beginning', () => searcher.begin(JSON.stringify({ version: 1, target: { path: PATH } }), 'anywhere', []));
const end = performance.now() + PATIENCE;
while (performance.now() < end && timed('searching', () => searcher.advance(SLICE)) === 'running');
while (!timed('polishing', () => searcher.polish(SLICE)));
timed('answer', () => searcher.answer());
timed('walk', () => searcher.walk());
for (const [name, times] of taken) {
  const most = times.toSorted((a, b) => b - a).slice(0, 3);
  console.log(name.padEnd(16), `${times.length} slices,`, `${times.reduce((a, b) => a + b).toFixed(0)} ms, longest`, most.map((time) => time.toFixed(1)).join(' '));
}
