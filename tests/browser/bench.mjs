/**
 * The page's own figures: `node bench.mjs`. Same variables as `run.mjs`; REPRISE_FIGURES names a file for them as JSON.
 * `cargo xtask bench` builds a page with the player's own benchmark in it, which others do without, and puts each beside its mark.
 *
 * The processor's times are what counts here. Chromium draws in software on a machine without a GPU, so nothing below
 * but the return of a lost device times the drawing itself.
 */

import { writeFile } from 'node:fs/promises';
import { Browser } from './browser.mjs';
import { dragging } from './dragging.mjs';
import { turnsDuring } from './turns.mjs';

/** Bytes that a download hands over at once. */
const CHUNK = 64 * 1024;

/** What a click has to wait for on the processor: the plan, the first frame of the walk, and the commands that draw it. */
function clicks(element) {
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
  return { click_to_plan: sorted(0)[times.length >> 1], click_to_changed: sorted(1)[times.length >> 1], click_to_changed_worst: sorted(1).at(-1) };
}

/** Megabytes after which a fresh player has its first pose, which is when the page draws. */
async function bytesToFirstPicture({ address, chunk }) {
  const element = document.querySelector('reprise-player');
  const all = new Uint8Array(await (await fetch(address)).arrayBuffer());
  const fresh = new element.testing.player.constructor();
  let at = 0;
  while (at < all.length && (fresh.phase() === 'empty' || fresh.phase() === 'header')) {
    fresh.push(all.subarray(at, at + chunk));
    at += chunk;
  }
  fresh.free();
  return Math.min(at, all.length) / 1e6;
}

/** Milliseconds from the loss of the device until the same pose is on a new one's canvas. */
async function deviceLoss(element) {
  element.pause();
  const pose = element.testing.pose();
  const restored = new Promise((resolve) => element.addEventListener('devicerestored', resolve, { once: true }));
  const start = performance.now();
  element.testing.loseDevice();
  await restored;
  await element.testing.picture();
  const taken = performance.now() - start;
  const after = element.testing.pose();
  if (pose.some((value, at) => value !== after[at])) throw new Error('another pose came back');
  return taken;
}

/**
 * Five standard paths, each searched for during two seconds in slices of 4 ms: milliseconds until the first whole walk, the
 * longest slice, and how far off in centimetres the best walk then is on average and at most. The worst path counts.
 */
async function searching(element) {
  const { player } = element.testing;
  const { Searcher } = await element.testing.searching();
  const around = (count, point) => Array.from({ length: count + 1 }, (_, at) => point((at / count) * 2 * Math.PI));
  const paths = {
    line: [[0, 0], [0, 10]],
    circle: around(24, (angle) => [1.6 - 1.6 * Math.cos(angle), 1.6 * Math.sin(angle)]),
    slalom: around(40, (angle) => [0.8 * Math.sin(2 * angle), (9 * angle) / (2 * Math.PI)]),
    'right angles': [[0, 0], [0, 3], [3, 3], [3, 6], [4, 6]],
    'figure eight': around(48, (angle) => [1.35 * Math.sin(2 * angle), 2.2 * Math.sin(angle)]),
  };
  const timed = (work) => {
    const start = performance.now();
    return [work(), performance.now() - start];
  };
  let ready = false;
  const figures = { search_prepared: 0, search_first: 0, search_slice: 0 };
  let known;
  while (!known) {
    const [told, taken] = timed(() => player.known(4));
    known = told;
    figures.search_prepared += taken;
  }
  const [searcher, taken] = timed(() => new Searcher(known, '[]'));
  figures.search_prepared += taken;
  while (!ready) {
    const [done, taken] = timed(() => searcher.read(4) && searcher.prepare(4));
    ready = done;
    figures.search_prepared += taken;
  }
  for (const [name, points] of Object.entries(paths)) {
    const shape = name === 'line' || name === 'right angles' ? 'polyline' : 'spline';
    const request = { version: 1, target: { path: { points, shape, free_start: true } } };
    let [, spent] = timed(() => searcher.begin(JSON.stringify(request), 'anywhere', []));
    let first = null;
    let progress = 'running';
    figures.search_slice = Math.max(figures.search_slice, spent);
    while (progress === 'running' && spent < 2000) {
      const [now, taken] = timed(() => searcher.advance(4));
      progress = now;
      spent += taken;
      figures.search_slice = Math.max(figures.search_slice, taken);
      if (first === null && JSON.parse(searcher.answer()).legs.length > 0) first = spent;
    }
    const { path } = JSON.parse(searcher.answer()).parts[0].goal;
    figures.search_first = Math.max(figures.search_first, first ?? Infinity);
    figures[`path_${name.replace(' ', '_')}_mean`] = 100 * path.mean;
    figures[`path_${name.replace(' ', '_')}_most`] = 100 * path.max;
  }
  searcher.free();
  return figures;
}

/** Waits until everything is loaded and every thumbnail is drawn. */
async function allThere(player) {
  await player.loaded();
  await player.until('all thumbnails', (element) => element.testing.thumbnails().complete && element.testing.thumbnails().drawn > 0);
}

/** The longest turns of the main thread, by its own time and by the clock, while the path tool searches and the actor moves. */
async function turns(browser) {
  const player = await browser.open({ forgive: [/Device was destroyed/] });
  await allThere(player);
  await player.run((element) => (element.tool = 'path'));
  const target = { path: { points: [[0, 0], [2, 1], [0, 3], [-2, 1], [0, 0], [3, 3]], shape: 'spline' } };
  const found = await turnsDuring(browser.chromium, player.page, async () => {
    await player.run((element, direction) => (element.direction = direction), { version: 1, target });
    await player.until('the end of the search', (element) => element.testing.search().count > 20 && !element.testing.search().running);
  });
  await player.close();
  const most = (values) => Math.max(...values);
  return { search_turn_own: most(found.map(({ own }) => own)), search_turn_clock: most(found.map(({ clock }) => clock)) };
}

const browser = await Browser.launch();
const player = await browser.open({ forgive: [/Device was destroyed/] });
await allThere(player);
await player.run((element) => element.pause());
// The first run warms the code up.
await player.run((element) => element.testing.player.bench());
const figures = {
  ...(await player.run((element) => JSON.parse(element.testing.player.bench()))),
  ...(await player.run(clicks)),
  ...(await player.run(searching)),
  ...(await player.run(dragging)),
  ...(await player.run(dragging, 'learned')),
  bytes_to_first_picture: await player.page.evaluate(bytesToFirstPicture, { address: 'demo.reprise', chunk: CHUNK }),
  device_loss: await player.run(deviceLoss),
};
await player.close();
Object.assign(figures, await turns(browser));
await browser.close();
for (const [name, value] of Object.entries(figures)) console.log(`${name.replaceAll('_', ' ').padEnd(32)}${value.toFixed(3).padStart(10)}`);
if (process.env.REPRISE_FIGURES) await writeFile(process.env.REPRISE_FIGURES, JSON.stringify(figures));
