/** Paths on the ground: drawn, bent, painted, walked; with the pointer and with fingers. */

import assert from 'node:assert/strict';
import { PHONE, LINE, using, place, asked, says, drag, found } from './common.mjs';

/** The middle of the leg that is seen longest: on shorter ones the points of both ends may lie over it. */
const middleOfLongest = (player, points) =>
  player.run((element, all) => {
    const seen = ([x, z]) => element.testing.placeOnGround(x, z);
    const lengths = all.slice(1).map((point, leg) => Math.hypot(seen(point).x - seen(all[leg]).x, seen(point).y - seen(all[leg]).y));
    const leg = lengths.indexOf(Math.max(...lengths));
    return { leg, ...seen([0, 1].map((axis) => (all[leg][axis] + all[leg + 1][axis]) / 2)) };
  }, points);

export const tests = {
  'a path is drawn, bent, painted and walked': async (browser) => {
    const player = await using(browser, 'path');
    assert.equal(await asked(player), null);
    await drag(player, LINE);
    const { path } = (await asked(player)).target;
    assert.ok(path.points.length >= 2 && path.points.length < LINE.length + 4, `${path.points.length} points`);
    const stands = await player.run((element) => [element.state.x, element.state.z]);
    assert.ok(Math.hypot(path.points[0][0] - stands[0], path.points[0][1] - stands[1]) < 1e-3, 'the path does not begin under the feet');
    const answer = await found(player);
    assert.ok(answer.path.length > 1.9 && answer.path.length < 2.6, `${answer.path.length} m`);
    assert.ok(answer.path.max >= answer.path.mean && answer.track.length > 0 && answer.legs.length > 0);
    assert.match(await says(player), /^\d\.\d m in \d+\.\d s, through \d+ transitions? · off by (\d+ cm|\d+\.\d m) on average/);

    // A point is dragged; a click beside no point makes a new one; a double click takes it away.
    const handle = player.part('.handle').last();
    const box = await handle.boundingBox();
    await drag(player, [[0.8, 1.6]], { x: box.x + box.width / 2, y: box.y + box.height / 2 });
    const bent = (await asked(player)).target.path.points;
    const last = bent[bent.length - 1];
    assert.ok(Math.hypot(last[0] - stands[0] - 0.8, last[1] - stands[1] - 1.6) < 0.1, `the last point is at ${last}`);
    const count = bent.length;
    const { leg, x, y } = await middleOfLongest(player, bent);
    await player.mouse.move(x, y);
    await player.mouse.down();
    await player.mouse.up();
    assert.equal((await asked(player)).target.path.points.length, count + 1);
    await player.part('.handle').nth(leg + 1).dblclick();
    assert.equal((await asked(player)).target.path.points.length, count);

    // Painted with a brush on the ground, and all of it undone and done again.
    const behaviour = await player.run((element) => element.behaviours[1]);
    await player.part('.choice .chip').nth(2).click();
    const points = (await asked(player)).target.path.points;
    await drag(player, [points[points.length - 1]].map(([x, z]) => [x - stands[0], z - stands[1]]), await player.run((element, point) => element.testing.placeOnGround(...point), points[0]));
    const [stretch] = (await asked(player)).target.path.stretches;
    assert.equal(stretch.behaviour, behaviour);
    assert.ok(stretch.from < 0.3 && stretch.to > points.length - 1.4, JSON.stringify(stretch));
    assert.equal(await player.part('.ground-label').textContent(), behaviour.replaceAll('_', ' '));
    await player.keyboard.press('Control+z');
    assert.deepEqual((await asked(player)).target.path.stretches, []);
    await player.keyboard.press('Control+y');
    assert.equal((await asked(player)).target.path.stretches.length, 1);
    for (let undone = 0; undone < 8; undone += 1) await player.keyboard.press('Control+z');
    assert.equal(await asked(player), null);
    assert.equal(await player.part('.toolbar .round').first().isDisabled(), true);
    for (let redone = 0; redone < 8; redone += 1) await player.keyboard.press('Control+Shift+z');
    assert.equal((await asked(player)).target.path.stretches.length, 1);

    await found(player);
    await player.part('.go').click();
    await player.untilFound('the actor on its way', (element) => element.state.target !== null);
    await player.run((element) => (element.speed = 4));
    await player.event('arrive');
    const walked = await player.run((element) => [element.state.x, element.state.z]);
    assert.ok(Math.hypot(walked[0] - stands[0], walked[1] - stands[1]) > 0.5, 'it has not left');
    await player.close();
  },

  'a finger draws, and two fingers turn to the camera': async (browser) => {
    const player = await using(browser, 'path', PHONE);
    const places = [];
    for (const [x, z] of LINE) places.push(await place(player, x, z));
    const touch = await player.page.context().newCDPSession(player.page);
    const send = (type, ...points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(({ x, y }, id) => ({ x, y, id })) });
    await send('touchStart', places[0]);
    for (const at of places.slice(1)) await send('touchMove', at);
    await send('touchEnd');
    await player.until('a path', (element) => element.direction !== null);
    const before = await asked(player);
    await player.part('.chip').filter({ hasText: 'Draw anew' }).tap();
    await send('touchStart', places[0]);
    await send('touchMove', places[1]);
    await send('touchStart', places[1], { x: places[1].x + 60, y: places[1].y });
    await send('touchMove', places[2], { x: places[1].x + 90, y: places[1].y + 20 });
    await send('touchEnd');
    assert.deepEqual(await asked(player), before, 'two fingers have drawn');
    await player.close();
  },
};
