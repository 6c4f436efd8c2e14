/** What pages ask for by themselves, and what searching costs them. */

import assert from 'node:assert/strict';
import { using } from './common.mjs';

/** Milliseconds that pass with every look at the clock, and the states that the search expands between two looks. */
const TICK = 0.25;
const STATES = 20;

/**
 * Runs in the page: asks for a direction, and notes what every slice of the search does, with the turn of the page that it
 * is in. The clock counts looks instead of time, so that no machine is too slow for this.
 */
async function countSlices(element, direction) {
  const { Searcher } = await element.testing.searching();
  let [looks, turn] = [0, 0];
  performance.now = () => (looks += 1) * 0.25;
  // Another part of the page that always has something to do.
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    turn += 1;
    port2.postMessage(null);
  };
  port2.postMessage(null);
  window.slices = [];
  for (const [worker, method] of [[element.testing.player, 'known'], [Searcher.prototype, 'prepare'], [Searcher.prototype, 'advance']]) {
    const work = worker[method];
    let before = 0;
    worker[method] = function (...values) {
      const start = looks;
      const result = work.apply(this, values);
      const expanded = method === 'advance' ? JSON.parse(this.answer()).expanded : 0;
      window.slices.push({ method, milliseconds: values.at(-1), looks: looks - start, states: Math.max(0, expanded - before), turn });
      before = expanded;
      return result;
    };
  }
  element.direction = direction;
}

export const tests = {
  'quickness changes plans at once, and goes with requests': async (browser) => {
    const player = await using(browser, 'pose');
    const seen = await player.run(async (element) => {
      // Until the search is there, what is asked waits for it.
      await element.testing.searching();
      const targets = Array.from({ length: 24 }, (_, index) => Math.floor(((index + 0.5) / 24) * element.info.frames));
      const seconds = () => targets.map((to) => { try { return element.plan(to).seconds; } catch { return 0; } }).reduce((a, b) => a + b);
      const slider = element.shadowRoot.querySelector('.toolbar .exact input');
      const smooth = [seconds(), slider.value];
      slider.value = '1';
      slider.dispatchEvent(new Event('input'));
      const quick = [seconds(), element.quickness];
      element.setAttribute('quickness', 'very');
      const nonsense = [seconds(), element.quickness, slider.value];
      element.quickness = 0.05;
      element.direction = { version: 1, target: { place: { x: 0.5, z: 1 } } };
      const without = element.quickness;
      element.quickness = 0.05;
      const { quickness } = element.direction;
      element.direction = { ...element.direction, quickness: 0.1 };
      return { smooth, quick, nonsense, without, quickness, after: [element.quickness, Number(slider.value)] };
    });
    assert.ok(seen.quick[0] < seen.smooth[0], JSON.stringify(seen));
    assert.deepEqual([seen.smooth[1], seen.quick[1], seen.without, seen.quickness, seen.after[0]], ['0', 0.2, null, 0.05, 0.1], JSON.stringify(seen));
    assert.deepEqual(seen.nonsense, [seen.smooth[0], null, '0']);
    assert.ok(Math.abs(seen.after[1] - Math.log(10) / Math.log(20)) < 0.02, JSON.stringify(seen));
    await player.untilFound('an answer', (element) => element.answer !== null);
    await player.close();
  },

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
    await player.run(countSlices, { version: 1, target });
    await player.until('many slices', () => window.slices.filter(({ method }) => method === 'advance').length >= 60);
    const slices = await player.run((element) => {
      element.direction = null;
      return window.slices;
    });
    for (const { method, milliseconds, looks, states } of slices) {
      // Whatever it works on, it stops at the first look at the clock behind its time.
      assert.ok(looks <= milliseconds / TICK + 2, `${method} has looked ${looks} times at a clock that gave it ${milliseconds} ms`);
      assert.ok(states <= looks * STATES, `${method} has expanded ${states} states between ${looks} looks`);
    }
    assert.ok(slices.some(({ states }) => states > 0), 'nothing was searched');
    // What is known of the motion and of the ways is told once, then the searching begins.
    const worked = slices.filter(({ method }) => method === 'advance');
    worked.slice(1).forEach(({ turn }, at) => assert.ok(turn > worked[at].turn, `slices ${at} and ${at + 1} in one turn of the page`));
    await player.close();
  },
};
