/**
 * The page's own figures, each beside its mark: `node bench.mjs`. Same variables as `run.mjs`.
 *
 * The processor's times are what counts here. Chromium draws in software on a machine without a GPU, so nothing below
 * times the drawing itself.
 */

import { readFile } from 'node:fs/promises';
import { Browser, bundlePath } from './browser.mjs';

/** Bytes that a download hands over at once. */
const CHUNK = 64 * 1024;

/** Names of `Player.bench()`, with their marks in milliseconds. */
const MARKS = { synthetic_frame: '6 ms, stretch 3', plan: '5 ms', recorded_frame: '1 ms' };

function print(name, value, unit, mark = '') {
  console.log(`${name.padEnd(44)}${value.toFixed(2).padStart(9)} ${unit}${mark && `   (mark: ${mark})`}`);
}

const browser = await Browser.launch();
const player = await browser.open();
await player.loaded();
await player.run((element) => element.pause());

const figures = await player.run((element) => JSON.parse(element.testing.player.bench()));
for (const [name, ms] of Object.entries(figures)) if (name in MARKS || name.includes('worst')) print(name.replaceAll('_', ' '), ms, 'ms', MARKS[name]);

// What a click has to wait for on the processor: the plan, the first frame of the walk, and the commands that draw it.
const clicks = await player.run((element) => {
  const times = [];
  const { sequences, fps } = element.info;
  const { player: inner, stage } = element.testing;
  for (let run = 0; run < 24; run += 1) {
    const { first, count } = sequences[run % sequences.length];
    const start = performance.now();
    element.goTo(first + Math.floor(count / 2));
    const planned = performance.now();
    inner.tick(1 / fps);
    stage.draw(inner);
    times.push([planned - start, performance.now() - start]);
  }
  const sorted = (column) => times.map((row) => row[column]).sort((a, b) => a - b);
  return { plan: sorted(0)[times.length >> 1], changed: sorted(1)[times.length >> 1], worst: sorted(1).at(-1) };
});
print('click to plan, through the element', clicks.plan, 'ms', '5 ms');
print('click to the commands of the first frame', clicks.changed, 'ms', '50 ms');
print('the same, worst of 24', clicks.worst, 'ms', '50 ms');

const bytes = await readFile(bundlePath);
const firstPose = await player.page.evaluate(
  async ({ address, chunk }) => {
    const element = document.querySelector('reprise-player');
    const all = new Uint8Array(await (await fetch(address)).arrayBuffer());
    const fresh = new element.testing.player.constructor();
    let at = 0;
    while (at < all.length && (fresh.phase() === 'empty' || fresh.phase() === 'header')) {
      fresh.push(all.subarray(at, at + chunk));
      at += chunk;
    }
    fresh.free();
    return Math.min(at, all.length);
  },
  { address: 'demo.reprise', chunk: CHUNK },
);
print('bytes until the first pose', firstPose / 1e6, 'MB', '2 MB');
print('bytes of the bundle', bytes.length / 1e6, 'MB', '20 MB, stretch 12');
await player.close();
await browser.close();
