/** What pages ask for by themselves, and what searching costs them. */

import assert from 'node:assert/strict';
import { turnsDuring } from '../../turns.mjs';
import { using } from './common.mjs';

export const tests = {
  'pages direct the actor to places and along paths, let it wander and hold': async (browser) => {
    const player = await using(browser, 'pose');
    const outcome = await player.run(async (element) => {
      element.speed = 6;
      const arrived = () => new Promise((resolve) => element.addEventListener('arrive', resolve, { once: true }));
      const going = element.goTo({ x: 0.5, z: 1 });
      const { place: there } = await going;
      await arrived();
      const { path } = await element.goTo({ path: [[0, 0], [0, 1.5]] });
      await arrived();
      const held = await element.hold(element.behaviours[0], 1);
      await arrived();
      const direct = await element.direct({ version: 1, target: { path: { points: [[2, 2], [2, 4]], free_start: true } } }, { anywhere: true });
      const { x, z } = element.state;
      const wander = await element.wander({ seed: 3, weights: { [element.behaviours[1]]: 2 } });
      const bad = await element.direct({ version: 1, target: { behaviour: { name: 'flying' } } }).then(() => null, ({ kind, message }) => [kind, message]);
      return { there, path, held: held.seconds, direct: direct.path.mean, at: [x, z], wander: wander.wander.frames, bad };
    });
    assert.ok(outcome.there.distance < 0.5 && outcome.path.length > 1.4, JSON.stringify(outcome));
    assert.ok(outcome.held > 0.5, JSON.stringify(outcome));
    assert.ok(Math.hypot(outcome.at[0] - 2, outcome.at[1] - 2) < 0.6, 'a free start begins on the path');
    assert.ok(outcome.wander > 10);
    assert.equal(outcome.bad[0], 'bad-argument');
    assert.match(outcome.bad[1], /no behaviour "flying"; there are: /);
    await player.close();
  },

  'searching leaves the page its time': async (browser) => {
    const player = await using(browser, 'path');
    const target = { path: { points: [[0, 0], [2, 1], [0, 3], [-2, 1], [0, 0], [3, 3]], shape: 'spline' } };
    const turns = await turnsDuring(browser.chromium, player.page, async () => {
      await player.run((element, direction) => (element.direction = direction), { version: 1, target });
      await player.until('the end of the search', (element) => element.testing.search().count > 0 && !element.testing.search().running, null, 60_000);
    });
    const { count, longest } = await player.run((element) => element.testing.search());
    const most = (values) => Math.max(...values).toFixed(1);
    // By the clock a turn is also as long as those who draw in software keep the thread from its processor.
    console.log(`        longest of ${turns.length} turns of the page: ${most(turns.map(({ own }) => own))} ms of its own, ${most(turns.map(({ clock }) => clock))} ms by the clock; ${count} slices, longest ${longest.toFixed(1)} ms by the clock`);
    assert.ok(turns.length > count, `${turns.length} turns`);
    assert.ok(count > 20, `${count} slices`);
    await player.close();
  },
};
