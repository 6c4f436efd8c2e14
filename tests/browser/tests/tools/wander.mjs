/** Wandering. */

import assert from 'node:assert/strict';
import { using, asked, found } from './common.mjs';

export const tests = {
  'wandering goes on for ever, and the weights count': async (browser) => {
    const player = await using(browser, 'wander');
    const first = await found(player);
    assert.ok(first.wander.frames > 10 && first.wander.objective >= 0);
    const weight = player.part('.weight input').nth(1);
    await weight.focus();
    await player.keyboard.press('ArrowRight');
    const name = await player.run((element) => element.behaviours[1]);
    assert.equal((await asked(player)).target.wander.weights[name], 1.25);
    await player.part('.go').click();
    await player.untilFound('the actor on its way', (element) => element.state.target !== null);
    // A small picture leaves the search its time, where it is drawn in software.
    await player.run((element) => (element.style.cssText = 'width: 200px; height: 160px'));
    // Near the end of what has been found, more is found.
    await player.run((element) => {
      element.pause();
      const { player: inner } = element.testing;
      inner.play();
      for (let tick = 0; tick < 400 && JSON.parse(inner.state()).remaining_seconds > 15; tick += 1) inner.tick(0.2);
      element.play();
    });
    await player.untilFound('the next part', (element) => element.state.remaining_seconds > 40);
    // Even where the search comes late, as on a slow machine, the actor goes on from where it waits.
    await player.run((element) => {
      element.pause();
      const { player: inner } = element.testing;
      inner.play();
      for (let tick = 0; tick < 1000 && JSON.parse(inner.state()).remaining_seconds > 0.2; tick += 1) inner.tick(0.1);
      element.play();
    });
    await player.event('arrive');
    await player.untilFound('the actor on its way again', (element) => element.state.remaining_seconds > 20);
    await player.close();
  },
};
