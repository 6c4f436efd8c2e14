/** The element in components of React, Vue, Svelte and Angular, as `frameworks/build.mjs` builds them. */

import assert from 'node:assert/strict';
import { countLives, nothingLeft } from '../lives.mjs';

const FRAMEWORKS = ['react', 'vue', 'svelte', 'angular'];

/** What the component is given at first; nothing is shown yet. */
const FIRST = { shown: false, src: '/demo.reprise', alt: 'A dancer', tint: true, controls: false, speed: 2, theme: 'dark', direction: null, count: 0 };
const PLACE = { version: 1, target: { place: { x: 0.5, z: 0.25 } } };

/** What the element has of the component's. */
const given = (element) => Object.fromEntries(['src', 'alt', 'tint', 'controls', 'speed', 'theme'].map((name) => [name, element[name]]));
const told = (player, type) => player.until(`the component hears of ${type}`, (_, wanted) => window.told.includes(wanted), type);

async function drives(browser, name) {
  if (!process.env.REPRISE_FRAMEWORKS) {
    assert.notEqual(process.env.CI, 'true', 'REPRISE_FRAMEWORKS names no folder: run cargo xtask frameworks');
    console.log('skipped: REPRISE_FRAMEWORKS names no folder of pages, see cargo xtask frameworks');
    return;
  }
  const before = async (page) => {
    await page.addInitScript(countLives);
    await page.addInitScript(`window.first = ${JSON.stringify(FIRST)}; window.told = [];`);
  };
  const player = await browser.open({ path: `frameworks/${name}/index.html`, before });
  await player.until('the component', () => typeof window.set === 'function' && document.querySelector('output'));
  // A framework may have something to do of its own before it rests.
  await player.until('rest', () => window.count().timers === 0 && window.count().frames === 0);
  const alone = await player.page.evaluate(() => window.count());
  const set = (changes) => player.page.evaluate((all) => window.set(all), changes);
  const shows = (what, work, argument) => player.until(what, `(element, argument) => element !== null && (${work})(element, argument)`, argument);

  // Properties and events, from the first on.
  await set({ shown: true });
  await told(player, 'ready');
  await told(player, 'load');
  assert.deepEqual(await player.run(given), { src: '/demo.reprise', alt: 'A dancer', tint: true, controls: false, speed: 2, theme: 'dark' });
  await player.run((element) => (window.element = element));

  // Booleans are on and off, not words; nor is what there is not.
  await set({ tint: false, controls: true, speed: undefined, theme: null, alt: undefined });
  await shows('other properties', (element) => element.controls && !element.tint && element.theme === null);
  const bare = await player.run((element) => ({ speed: element.speed, alt: element.alt, html: element.outerHTML }));
  assert.deepEqual([bare.speed, bare.alt], [1, '']);
  assert.doesNotMatch(bare.html, /null|undefined|true|false|tint/);
  await shows('the tools', (element) => element.shadowRoot.querySelectorAll('.tool').length === 6);
  await set({ controls: false });
  await shows('no controls', (element) => !element.hasAttribute('controls'));

  // Drawn anew for another reason, it is the same element with the same actor.
  for (let count = 1; count <= 10; count += 1) await set({ count });
  await player.until('the last count', () => document.querySelector('output').textContent === '10');
  assert.ok(await player.run((element) => element === window.element && element.info !== null));
  assert.equal(await player.page.evaluate(() => window.told.filter((type) => type === 'load').length), 1, 'it was loaded again');
  assert.equal((await player.page.evaluate(() => window.count())).devices, 1);

  // An object as a property, a method by a reference, and what it tells.
  await set({ direction: PLACE });
  await shows('the direction', (element) => element.direction !== null);
  assert.deepEqual((await player.run((element) => element.direction)).target, PLACE.target);
  await set({ direction: undefined });
  await shows('no direction', (element) => element.direction === null);
  const target = await player.target();
  await player.page.evaluate((frame) => window.go(frame), target);
  await told(player, 'arrive');
  assert.equal(await player.run((element) => Math.round(element.state.frame)), target);

  // In and out, ready or not.
  await set({ shown: false });
  await player.until('no player', () => !document.querySelector('reprise-player'));
  await nothingLeft(player, alone, 'the component without the player');
  for (const type of ['progress', 'ready', 'load']) {
    await player.page.evaluate(() => (window.told.length = window.heard.length = 0));
    await set({ shown: true });
    await player.event(type);
    await set({ shown: false });
    await nothingLeft(player, alone, `the player was taken out with ${type}`);
  }
  await player.close();
}

export const tests = Object.fromEntries(FRAMEWORKS.map((name) => [`framework: a component of ${name} drives the element`, (browser) => drives(browser, name)]));
