/** Targets that come one after another: with the pointer, with fingers, with the keyboard. */

import assert from 'node:assert/strict';
import { PHONE, using, asked } from './common.mjs';

export const tests = {
  'a finger that rests on what waits drags it, one that does not scrolls the row': async (browser) => {
    const player = await using(browser, 'pose', PHONE);
    await player.run((element, frame) => {
      element.goTo(frame);
      element.pause();
      element.queue(...element.behaviours.slice(1, 4).map((behaviour) => ({ behaviour, hold: 2 })));
    }, await player.target());
    const queued = () => player.run((element) => element.queued.map(({ behaviour }) => behaviour));
    const [a, b, c] = await queued();
    const touch = await player.page.context().newCDPSession(player.page);
    const send = (type, ...points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    const slide = async (from, to, rests) => {
      const [start, end] = [await player.part('.waits').nth(from).boundingBox(), await player.part('.waits').nth(to).boundingBox()];
      const at = (box, share) => [box.x + share * box.width, box.y + box.height / 2];
      await send('touchStart', at(start, 0.5));
      if (rests) await player.until('a target in hand', (element) => element.shadowRoot.querySelector('[data-held]'));
      for (const share of [0.3, 0.6, 1]) await send('touchMove', [at(start, 0.5)[0] * (1 - share) + at(end, 0.7)[0] * share, at(end, 0.5)[1]]);
      await send('touchEnd');
    };
    await slide(0, 1, true);
    assert.deepEqual(await queued(), [b, a, c]);
    await player.part('.toolbar .round').first().tap();
    assert.deepEqual(await queued(), [a, b, c]);
    // No time passes while it does, however long the machine takes: it has not rested.
    await player.run(() => {
      const { setTimeout: later } = window;
      window.setTimeout = (work, milliseconds, ...values) => (milliseconds === 250 ? 0 : later(work, milliseconds, ...values));
    });
    await slide(1, 0, false);
    assert.deepEqual(await queued(), [a, b, c], 'a finger that only passed has moved a target');
    await player.close();
  },

  'behaviours are gone to and held, and what is clicked with shift comes after': async (browser) => {
    const player = await using(browser, 'pose');
    const names = await player.run((element) => element.behaviours);
    const chip = (name) => player.part('[aria-label="Behaviours"] .chip').filter({ hasText: name.replaceAll('_', ' ') }).first();
    await player.part('.pose-dock input').fill('1');
    await player.keyboard.press('Tab');
    await chip(names[1]).click();
    await player.untilFound('the actor on its way', (element) => element.state.target !== null);
    assert.deepEqual((await asked(player)).target, { behaviour: { name: names[1], hold: 1 } });
    await player.run((element) => element.pause());

    // Two more with shift: one from the score, one by its name.
    const frame = await player.target();
    const { x, y } = await player.run((element, wanted) => element.testing.placeOf(wanted), frame);
    await player.keyboard.down('Shift');
    await player.mouse.move(x, y);
    await player.mouse.down();
    await player.mouse.up();
    await chip(names[2]).click();
    await player.keyboard.up('Shift');
    const queued = () => player.run((element) => element.queued);
    const [first, second] = await queued();
    assert.ok(Number.isInteger(first), 'a click with shift has not waited');
    assert.deepEqual(second, { behaviour: names[2], hold: 1 });
    assert.equal(await player.part('.waits').count(), 2);
    assert.match(await player.part('.status').textContent(), /comes after that/);
    assert.equal((await asked(player)).target.queue.length, 3);

    // Moved and taken out with the keys.
    await player.part('.waits').nth(1).focus();
    await player.keyboard.press('Shift+ArrowLeft');
    assert.deepEqual(await queued(), [second, first]);
    await player.keyboard.press('ArrowRight');
    await player.keyboard.press('Delete');
    assert.deepEqual(await queued(), [second]);
    // Dragged.
    await player.run((element, target) => element.queue(target), first);
    const [from, to] = [await player.part('.waits').nth(0).boundingBox(), await player.part('.waits').nth(1).boundingBox()];
    await player.mouse.move(from.x + 10, from.y + 10);
    await player.mouse.down();
    await player.mouse.move(to.x + to.width - 10, to.y + 10, { steps: 5 });
    await player.mouse.up();
    assert.deepEqual(await queued(), [first, second]);
    // Undone and done again: the drag, the target from the page, what was taken out, what was moved.
    const undo = player.part('.toolbar .round').first();
    await undo.click();
    assert.deepEqual(await queued(), [second, first]);
    await player.keyboard.press('Control+z');
    assert.deepEqual(await queued(), [second]);
    await player.keyboard.press('Control+z');
    assert.deepEqual(await queued(), [second, first]);
    await player.keyboard.press('Control+z');
    assert.deepEqual(await queued(), [first, second]);
    assert.equal(await player.part('.waits').count(), 2);
    for (let step = 0; step < 4; step += 1) await player.keyboard.press('Control+y');
    assert.deepEqual(await queued(), [first, second]);
    assert.deepEqual((await asked(player)).target.queue.length, 3);
    const link = await player.run((element) => element.link);

    // All of it is done, one after the other.
    await player.run((element) => {
      element.speed = 6;
      element.play();
    });
    await player.untilFound('three arrivals', () => window.heard.filter(({ type }) => type === 'arrive').length === 3);
    assert.deepEqual(await queued(), []);
    const shown = await player.run((element) => element.info.sequences.find(({ first: at, count }) => element.state.frame >= at && element.state.frame < at + count));
    assert.ok(shown.name === names[2] || shown.labels.includes(names[2]), `it ends in ${shown.name}`);
    // What is done is not waited for again.
    for (let step = 0; step < 3; step += 1) await player.keyboard.press('Control+z');
    assert.deepEqual(await queued(), []);
    assert.equal(await player.run((element) => element.state.target), null);

    // The link brings back what is under way and what waits.
    await player.run((element, address) => {
      element.cancel();
      element.openLink(address);
      element.pause();
    }, link);
    assert.deepEqual(await queued(), [first, second]);
    await player.close();
  },

  'the keyboard queues what it looks at, and a switch stands for shift': async (browser) => {
    const player = await using(browser, 'pose');
    await player.run((element, frame) => {
      element.goTo(frame);
      element.pause();
    }, await player.target());
    await player.part('.strip').first().focus();
    await player.keyboard.press('ArrowRight');
    await player.keyboard.press('Shift+Enter');
    assert.equal(await player.run((element) => element.queued.length), 1);
    await player.part('.chip').filter({ hasText: 'then' }).click();
    await player.part('[aria-label="Behaviours"] .chip').first().focus();
    await player.keyboard.press('ArrowRight');
    await player.keyboard.press('Enter');
    assert.deepEqual(await player.run((element) => element.queued[1]), { behaviour: await player.run((element) => element.behaviours[1]), hold: 5 });
    await player.keyboard.press('Escape');
    assert.deepEqual(await player.run((element) => [element.queued, element.state.target]), [[], null]);
    await player.close();
  },
};
