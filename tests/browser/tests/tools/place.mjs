/** Places on the ground. */

import assert from 'node:assert/strict';
import { using, asked, says, drag } from './common.mjs';

export const tests = {
  'a click on the ground goes there, a drag says which way to face': async (browser) => {
    const player = await using(browser, 'place');
    await drag(player, [[0.6, 1], [1.2, 1]]);
    const { place: goal } = (await asked(player)).target;
    assert.ok(Math.abs(goal.heading - Math.PI / 2) < 0.15, `heading ${goal.heading}`);
    await player.run((element) => (element.speed = 4));
    await player.event('arrive');
    const { state, answer } = await player.run((element) => ({ state: element.state, answer: element.answer }));
    assert.ok(Math.hypot(state.x - goal.x, state.z - goal.z) < answer.place.distance + 0.05, 'the actor is not where the answer said');
    assert.match(await says(player), /^there in \d+\.\d s, through \d+ transitions?; stops \d+ cm away/);
    // Typed, too.
    await player.part('.field input').first().fill('0.5');
    await player.part('.field input').nth(2).fill('');
    await player.keyboard.press('Tab');
    const typed = (await asked(player)).target.place;
    assert.equal(typed.x, 0.5);
    assert.equal(typed.heading, undefined);
    await player.close();
  },
};
