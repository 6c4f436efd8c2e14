/** The tools without a pointer, and what axe has to say of them. */

import assert from 'node:assert/strict';
import { WIDE, PHONE, using, asked, found, axe } from './common.mjs';

export const tests = {
  'every tool is reached and used with the keyboard alone': async (browser) => {
    const player = await using(browser, 'pose');
    const focused = () => player.run((element) => element.shadowRoot.activeElement?.getAttribute('aria-label') ?? element.shadowRoot.activeElement?.textContent);
    const names = ['pose', 'place', 'path', 'timing', 'wander', 'edit'];
    for (const [at, name] of names.entries()) {
      await player.keyboard.press(String(at + 1));
      assert.equal(await player.run((element) => element.tool), name);
    }
    assert.equal((await player.heard('toolchange')).length, 6 - 1);

    // Path: points are added, moved, inserted and deleted, a stretch is painted, and the actor goes.
    await player.keyboard.press('3');
    await player.part('.chip').filter({ hasText: 'Add point' }).focus();
    await player.keyboard.press('Enter');
    assert.match(await focused(), /^Point 2 of 2/);
    const points = async () => (await asked(player)).target.path.points;
    const before = await points();
    await player.keyboard.press('ArrowUp');
    await player.keyboard.press('Shift+ArrowRight');
    const moved = await points();
    assert.ok(Math.abs(Math.hypot(moved[1][0] - before[1][0], moved[1][1] - before[1][1]) - Math.hypot(0.1, 0.5)) < 0.01);
    await player.part('.handle').first().focus();
    await player.keyboard.press('+');
    assert.equal((await points()).length, 3);
    assert.match(await focused(), /^Point 2 of 3/);
    await player.keyboard.press('Delete');
    assert.equal((await points()).length, 2);
    await player.part('.choice [tabindex="0"]').focus();
    await player.keyboard.press('ArrowRight');
    await player.part('.path-strip').focus();
    await player.keyboard.press('ArrowRight');
    await player.keyboard.press('Shift+ArrowRight');
    assert.match(await player.part('.path-strip').getAttribute('aria-valuetext'), /metres, /);
    assert.equal((await asked(player)).target.path.stretches.length, 1);
    await found(player);
    await player.keyboard.press('Enter');
    await player.untilFound('the actor on its way', (element) => element.state.target !== null);
    await player.keyboard.press('Escape');
    assert.equal(await player.run((element) => element.state.target), null);

    // Timing: a pose is put, retimed, changed and taken away.
    await player.keyboard.press('4');
    await player.part('.pose').first().focus();
    await player.keyboard.press('Enter');
    assert.equal(await focused(), 'Key pose');
    const key = async () => (await asked(player)).target.keys.poses[0];
    const { pose, time } = await key();
    await player.keyboard.press('ArrowRight');
    await player.keyboard.press('ArrowUp');
    assert.deepEqual(await key(), { pose: pose + 1, time: Math.round((time + 0.1) * 100) / 100 });
    await player.keyboard.press('Delete');
    assert.equal(await asked(player), null);

    // Place, by numbers; and the row of tools itself.
    await player.keyboard.press('2');
    await player.part('.field input').first().focus();
    await player.keyboard.type('1');
    await player.keyboard.press('Enter');
    assert.deepEqual((await asked(player)).target.place, { x: 1, z: 0 });
    await player.part('.tool[aria-checked="true"]').focus();
    await player.keyboard.press('ArrowLeft');
    assert.equal(await player.run((element) => element.tool), 'pose');
    assert.equal(await focused(), 'Pose');
    await player.close();
  },

  'axe finds nothing amiss in any tool, light and dark, wide and narrow': async (browser) => {
    for (const options of [{ ...WIDE, colorScheme: 'light' }, { ...PHONE, colorScheme: 'dark' }]) {
      const player = await using(browser, 'pose', options);
      const state = (name) => `${name}, ${options.colorScheme}`;
      await player.run((element, frame) => {
        element.goTo(frame);
        element.pause();
        element.queue({ behaviour: element.behaviours[0], hold: 2 }, 20);
      }, await player.target());
      await axe(player, state('pose'));
      await player.run((element) => (element.direction = { version: 1, target: { place: { x: 1, z: 1, heading: 1 } } }));
      await found(player);
      await axe(player, state('place'));
      const behaviour = await player.run((element) => element.behaviours[1]);
      await player.run((element, name) => (element.direction = { version: 1, target: { path: { points: [[0, 0], [1, 1], [2, 1]], stretches: [{ from: 0.5, to: 1.5, behaviour: name }] } } }), behaviour);
      await found(player);
      await axe(player, state('path'));
      await player.part('.chip').filter({ hasText: '3D' }).click();
      await axe(player, state('path in the air'));
      await player.run((element) => (element.direction = { version: 1, target: { keys: { poses: [{ pose: 30, time: 1 }, { pose: 60, time: 3 }] } } }));
      await found(player);
      await axe(player, state('timing'));
      await player.run((element) => (element.tool = 'wander'));
      await found(player);
      await axe(player, state('wander'));
      await player.part('.share > button').click();
      await axe(player, state('share'));
      await player.keyboard.press('Escape');
      await player.run((element) => (element.tool = 'pose'));
      await player.keyboard.press('?');
      await axe(player, state('keys'));
      await player.close();
    }
  },
};
