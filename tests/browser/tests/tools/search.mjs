/** What pages ask for by themselves, and what searching costs them. */

import assert from 'node:assert/strict';
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
    const frames = player.run(async () => {
      const gaps = [];
      let last = performance.now();
      const end = last + 4000;
      while (last < end) {
        // Not the display's frames, which are drawn in software here: how long anything waits for its turn.
        await new Promise((resolve) => setTimeout(resolve, 0));
        gaps.push(performance.now() - last);
        last = performance.now();
      }
      return gaps;
    });
    await player.run((element) => (element.direction = { version: 1, target: { path: { points: [[0, 0], [2, 1], [0, 3], [-2, 1], [0, 0], [3, 3]], shape: 'spline' } } }));
    const gaps = (await frames).sort((a, b) => a - b);
    const { count, longest } = await player.run((element) => element.testing.search());
    console.log(`        turns waited for: median ${gaps[gaps.length >> 1].toFixed(1)} ms, longest ${gaps.at(-1).toFixed(1)} ms, over 50 ms ${gaps.filter((gap) => gap > 50).length} of ${gaps.length}; ${count} slices, longest ${longest.toFixed(1)} ms`);
    assert.ok(count > 20, `${count} slices`);
    await player.close();
  },
};
