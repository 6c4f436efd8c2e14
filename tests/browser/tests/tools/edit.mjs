/** Edits: a point of the actor is dragged in the picture, and the recording changes there. */

import assert from 'node:assert/strict';
import { PHONE, WIDE, axe, using } from './common.mjs';

/** Takes the tool, and waits for the module that edits. */
async function editing(browser, options) {
  const player = await using(browser, 'edit', options);
  await player.untilFound('the editor', (element) => element.testing.edits().ready);
  return player;
}

/** The vertex farthest to the left of the body, and where on the screen it is. */
const hand = (player) =>
  player.run((element) => {
    const pose = element.testing.pose();
    let best = 0;
    for (let at = 0; at < pose.length / 3; at += 1) if (pose[3 * at] > pose[3 * best]) best = at;
    return { vertex: best, ...element.testing.placeOfPoint(...pose.slice(3 * best, 3 * best + 3)) };
  });

/** Where on the screen a vertex is drawn. */
const seenAt = (player, vertex) => player.run((element, at) => element.testing.placeOfPoint(...element.testing.pose().slice(3 * at, 3 * at + 3)), vertex);

const settled = (player) => player.untilFound('all edited frames', (element) => element.testing.edits().due === 0 && !element.testing.edits().held);
const edits = (player) => player.run((element) => element.edits?.edits ?? []);
const says = (player) => player.part('.outcome').textContent();

/** How far a frame is from what was recorded: at most, and at a vertex. */
const moved = (player, frame, vertex = 0) =>
  player.run((element, [at, one]) => {
    const [edited, recorded] = [element.testing.framePose(at), element.testing.recordedPose(at)];
    const far = (index) => Math.hypot(...[0, 1, 2].map((axis) => edited[3 * index + axis] - recorded[3 * index + axis]));
    return { most: Math.max(...Array.from({ length: recorded.length / 3 }, (_, index) => far(index))), there: far(one) };
  }, [frame, vertex]);

/** The frame of an edit over the whole capture. */
const frameOf = (player, { sequence, frame }) => player.run((element, [name, at]) => element.info.sequences.find((one) => one.name === name).first + at, [sequence, frame]);

/** Drags what is at a place by so many pixels. */
async function pull(player, { x, y }, [dx, dy], shift = false) {
  await player.mouse.move(x, y);
  await player.mouse.down();
  if (shift) await player.keyboard.down('Shift');
  await player.mouse.move(x + dx, y + dy, { steps: 8 });
  await player.mouse.up();
  if (shift) await player.keyboard.up('Shift');
}

/** A hand that is pulled aside and up; the edit. */
async function pulled(player) {
  const { x, y } = await hand(player);
  await pull(player, { x: x - 3, y }, [20, -40]);
  await settled(player);
  const [edit] = await edits(player);
  return edit;
}

export const tests = {
  'a point of the actor is dragged, the frames around follow, feet stay, and all of it is undone': async (browser) => {
    const player = await editing(browser);
    const { x, y } = await hand(player);
    await player.mouse.move(x - 3, y);
    assert.equal(await player.part('.edit-marks .part-mark').isVisible(), true, 'nothing shows what would be grabbed');
    await player.mouse.move(5, 5);
    const edit = await pulled(player);
    assert.deepEqual(Object.keys(edit), ['sequence', 'frame', 'handles'], 'what is usual is said');
    const [{ vertex, to }] = edit.handles;
    const key = await frameOf(player, edit);
    const recorded = await player.run((element, [at, one]) => element.testing.recordedPose(at).slice(3 * one, 3 * one + 3), [key, vertex]);
    const wanted = Math.hypot(...to.map((place, axis) => place - recorded[axis]));
    assert.ok(wanted > 0.1, `${wanted} m`);
    assert.ok(Math.abs((await moved(player, key, vertex)).there - wanted) < 1e-3, 'the handle is not met');
    const near = (await moved(player, key + 4, vertex)).there;
    assert.ok(near > 0.02 && near < wanted, `${near} m four frames on`);
    assert.equal((await moved(player, key + 40)).most, 0);
    const letGo = await seenAt(player, vertex);
    const soles = await player.run((element, at) => {
      const { editor } = element.testing.core.toolbox.kit.edits;
      return Array.from(editor.stands(at)).map((stands, foot) => [stands, ...editor.sole(foot)]);
    }, key);
    assert.ok(soles.some(([stands]) => stands === 1), 'no foot stands here');
    for (const [stands, ...vertices] of soles) {
      for (const one of stands ? vertices.slice(0, 5) : []) assert.ok((await moved(player, key, one)).there < 1e-3, 'a pin has moved');
    }
    assert.equal((await player.heard('editchange')).at(-1).edits.edits.length, 1);
    assert.match(await says(player), /^\d+ frames changed$/);
    await player.part('.toolbar .round').first().click();
    await settled(player);
    assert.deepEqual(await edits(player), []);
    assert.equal((await moved(player, key)).most, 0, 'the recording is not given back');
    const start = await seenAt(player, vertex);
    assert.ok(Math.hypot(letGo.x - start.x - 20, letGo.y - start.y + 40) < 2, 'the point has not followed the pointer');
    await player.keyboard.press('Control+y');
    await settled(player);
    assert.deepEqual(await edits(player), [edit]);
    assert.ok((await moved(player, key, vertex)).there > 0.1);

    // With shift it goes straight up; what is dragged by its handle is the same edit, undone at once.
    const box = await player.part('.handle').first().boundingBox();
    await pull(player, { x: box.x + box.width / 2, y: box.y + box.height / 2 }, [30, -20], true);
    await settled(player);
    const [lifted] = await edits(player);
    assert.ok(Math.abs(lifted.handles[0].to[0] - to[0]) < 2e-3 && lifted.handles[0].to[1] > to[1] + 0.03, JSON.stringify(lifted.handles));
    await player.keyboard.press('Control+z');
    assert.deepEqual(await edits(player), [edit]);

    // Other tools go through the edit.
    await player.run((element) => (element.tool = 'pose'));
    assert.equal(await player.part('.pin').count(), 0);
    assert.ok((await moved(player, key, vertex)).there > 0.1);
    await player.close();
  },

  'a click grabs without moving anything, and feet are let go and held by a click': async (browser) => {
    const player = await editing(browser);
    const { x, y } = await hand(player);
    await player.mouse.click(x - 3, y);
    await settled(player);
    const [edit] = await edits(player);
    const key = await frameOf(player, edit);
    assert.deepEqual(await moved(player, key), { most: 0, there: 0 });
    assert.equal(await player.part('.handle').count(), 1);
    const pins = player.part('.pin[aria-pressed="true"]');
    const standing = await pins.count();
    assert.ok(standing > 0, 'no foot is shown as a pin');
    await pins.first().click();
    const [{ pins: left }] = await edits(player);
    assert.ok(standing === 1 ? left === 'none' : Array.isArray(left) && left.length > 3, JSON.stringify(left));
    assert.equal(await pins.count(), standing - 1);
    await player.part('.pin[aria-pressed="false"]').first().click();
    assert.equal((await edits(player))[0].pins, undefined, 'feet that stand are what is usual');
    await player.close();
  },

  'an edit lives on the ruler: its window, on and off, copied, moved and deleted': async (browser) => {
    const player = await editing(browser);
    const edit = await pulled(player);
    const key = await frameOf(player, edit);
    const ends = player.part('.edit-end');
    const lane = await player.part('.edit-ruler .lane').boundingBox();
    const { count } = await player.run((element, name) => element.info.sequences.find((one) => one.name === name), edit.sequence);
    const xOf = (frame) => lane.x + (frame / (count - 1)) * lane.width;
    const last = await ends.nth(2).boundingBox();
    await player.mouse.move(last.x + last.width / 2, last.y + 8);
    await player.mouse.down();
    await player.mouse.move(xOf(edit.frame + 30), last.y + 8, { steps: 4 });
    await player.mouse.up();
    await ends.first().focus();
    await player.keyboard.press('ArrowRight');
    await settled(player);
    const [{ window }] = await edits(player);
    assert.equal(window[1], edit.frame + 30);
    assert.ok((await moved(player, key + 20)).most > 0.01);
    assert.equal((await moved(player, key + 30)).most, 0);

    await player.part('.edit-dock .chip').filter({ hasText: /^on$/ }).click();
    await settled(player);
    assert.equal((await edits(player))[0].on, false);
    assert.equal((await moved(player, key)).most, 0);
    await player.part('.edit-dock .chip').filter({ hasText: /^on$/ }).click();

    // Copied where the actor is.
    await player.run((element, frame) => element.seek(frame), key + 50);
    await player.part('.edit-dock .chip').filter({ hasText: /^copy$/ }).click();
    await settled(player);
    const both = await edits(player);
    assert.equal(both[1].frame, edit.frame + 50);
    assert.deepEqual(both[1].window, window.map((at) => at + 50));
    assert.ok((await moved(player, key + 50, edit.handles[0].vertex)).there > 0.1);
    await player.part('.edit-end.key').focus();
    await player.keyboard.press('ArrowLeft');
    assert.equal((await edits(player))[1].frame, edit.frame + 49);

    // The chips lead to each of them.
    await player.part('.edits .chip').first().click();
    assert.equal(await player.run((element) => element.state.frame), key);
    assert.equal(await player.part('.handle').count(), 1);
    await player.part('.edit-dock .chip').filter({ hasText: /^delete$/ }).click();
    await settled(player);
    assert.equal((await edits(player)).length, 1);
    assert.equal((await moved(player, key)).most, 0);
    await player.run((element) => element.testing.core.view.stage.root.focus());
    await player.keyboard.press('Enter');
    assert.equal(await player.run((element) => element.playing), true);
    await player.close();
  },

  'edits are typed, and made with the keyboard alone': async (browser) => {
    const player = await editing(browser);
    await player.part('.edit-dock .chip').filter({ hasText: /^grab$/ }).focus();
    await player.keyboard.press('Enter');
    // The cross goes by six pixels: to the place nearest to the hand that is on the body, with more of the body around it.
    const { x, y } = await hand(player);
    const [right, down] = await player.run((element, goal) => {
      const { stage } = element.testing.core.view;
      const { left, top } = stage.root.getBoundingClientRect();
      const place = (at, by) => at / 2 + 6 * by;
      const body = (i, j) => stage.stage.vertex_at(element.testing.player, place(stage.size.width, i), place(stage.size.height, j)) >= 0;
      const far = (i, j) => Math.hypot(left + place(stage.size.width, i) - goal.x, top + place(stage.size.height, j) - goal.y);
      const reach = Array.from({ length: 121 }, (_, index) => index - 60);
      const near = reach.flatMap((i) => reach.filter((j) => far(i, j) < 40).map((j) => [i, j]));
      return near.filter(([i, j]) => body(i, j)).sort((a, b) => far(...a) - far(...b))[0] ?? [0, 0];
    }, { x, y });
    const step = async (key, count) => {
      for (let at = 0; at < Math.abs(count); at += 1) await player.keyboard.press(key);
    };
    await player.run((element) => element.testing.core.view.stage.root.focus());
    await step(right > 0 ? 'ArrowRight' : 'ArrowLeft', right);
    await step(down > 0 ? 'ArrowDown' : 'ArrowUp', down);
    await player.keyboard.press('Enter');
    await settled(player);
    assert.equal((await edits(player)).length, 1, 'the cross has grabbed nothing');
    const place = async () => (await edits(player))[0].handles[0].to;
    const before = await place();
    // The handle has the focus.
    await player.keyboard.press('PageUp');
    await player.keyboard.press('Shift+PageUp');
    await settled(player);
    const after = await place();
    assert.ok(Math.abs(after[1] - before[1] - 0.06) < 2e-3 && Math.abs(after[0] - before[0]) < 1e-3, `${before} to ${after}`);
    await player.keyboard.press('ArrowRight');
    await settled(player);
    assert.ok(Math.hypot(...(await place()).map((at, axis) => at - after[axis])) > 0.008);
    const field = player.part('.edit-dock input[aria-label="y, cm"]');
    await field.fill('25');
    await field.press('Tab');
    await settled(player);
    const [edit] = await edits(player);
    const key = await frameOf(player, edit);
    const recorded = await player.run((element, [at, one]) => element.testing.recordedPose(at).slice(3 * one, 3 * one + 3), [key, edit.handles[0].vertex]);
    assert.ok(Math.abs(edit.handles[0].to[1] - recorded[1] - 0.25) < 1e-3);
    assert.ok(Math.abs((await moved(player, key, edit.handles[0].vertex)).there - Math.hypot(...edit.handles[0].to.map((at, axis) => at - recorded[axis]))) < 1e-3);

    // What follows, and how.
    await player.part('.edit-dock [role="radio"][value="region"]').click();
    await settled(player);
    assert.deepEqual((await edits(player))[0].scope, { radius: 0.2 });
    await player.part('.edit-dock input[aria-label="radius, cm"]').fill('30');
    await player.part('.edit-dock input[aria-label="radius, cm"]').press('Tab');
    await player.part('.edit-dock [role="radio"][value="arap"]').click();
    await player.part('.edit-dock [role="radio"][value="linear"]').click();
    await settled(player);
    const [{ scope, method, propagate }] = await edits(player);
    assert.deepEqual({ scope, method, propagate }, { scope: { radius: 0.3 }, method: 'arap', propagate: 'linear' });
    await player.part('.handle').first().focus();
    await player.keyboard.press('Delete');
    assert.deepEqual(await edits(player), []);
    await player.close();
  },

  'edits are passed on as a link, beside what is asked, and are the same there': async (browser) => {
    const player = await editing(browser);
    const edit = await pulled(player);
    const key = await frameOf(player, edit);
    const pose = await player.run((element, frame) => element.testing.framePose(frame), key + 3);
    await player.run((element) => (element.direction = { version: 1, target: { place: { x: 1, z: 1 } } }));
    await player.untilFound('an answer', (element) => element.answer !== null);
    const link = await player.run((element) => element.link);
    await player.close();
    const other = await browser.open({ ...WIDE, hash: link });
    await other.loaded();
    await other.untilFound('the edits', (element) => element.edits !== null && element.testing.edits().made > 5 && element.testing.edits().due === 0);
    assert.deepEqual(await edits(other), [edit]);
    assert.equal(await other.run((element) => element.direction.target.place.x), 1);
    assert.deepEqual(await other.run((element, frame) => element.testing.framePose(frame), key + 3), pose);
    await other.close();
  },

  'edits that make no sense are refused with a sentence, and those before stay': async (browser) => {
    const player = await editing(browser);
    const edit = await pulled(player);
    const key = await frameOf(player, edit);
    const { vertex, to } = edit.handles[0];
    const set = (document) =>
      player.run((element, wanted) => {
        try {
          element.edits = wanted;
          return '';
        } catch ({ kind, message }) {
          return `${kind}: ${message}`;
        }
      }, document);
    const one = (more) => ({ version: 1, edits: [{ ...edit, ...more }] });
    for (const [document, words] of [
      [7, /no edits/],
      [{ edits: [] }, /version/],
      [{ version: 9, edits: [] }, /version 9/],
      [{ version: 1, edits: {} }, /list/],
      [one({ farme: 3 }), /edit 0: .*farme/],
      [one({ sequence: 'somebody else' }), /there is no sequence "somebody else"/],
      [one({ frame: 99999 }), /no frame 99999/],
      [one({ handles: [{ vertex: 9999999, to }] }), /no vertex 9999999/],
      [one({ handles: [{ vertex, to: [Number.NaN, 0, 0] }] }), /number/],
      [one({ handles: [{ vertex, to: [1e9, 0, 0] }] }), /10,000 metres/],
      [one({ handles: [] }), /no handle/],
      [one({ method: 'magic' }), /rig, learned, parts, arap, laplace/],
    ]) {
      assert.match(await set(document), words, JSON.stringify(document));
      assert.deepEqual(await edits(player), [edit]);
    }
    assert.ok((await moved(player, key, vertex)).there > 0.1, 'the edit before is gone');

    // What is far away is approached, and a note says how far it stops short.
    const notes = await player.run((element, wanted) => element.edit(wanted).then(({ notes: all }) => all), { sequence: edit.sequence, frame: edit.frame + 60, handles: [{ vertex, to: [50, 30, 0] }] });
    assert.match(notes.join(' '), /edit 1: vertex \d+ stops \d+\.\d\d m short of where it is to go/);
    assert.ok((await moved(player, key + 60)).most < 3);
    assert.match(await player.run((element) => element.edit({ sequence: 'nowhere' }).then(() => '', ({ message }) => message)), /edit 2: it has no frame/);
    assert.equal((await edits(player)).length, 2);
    await player.run((element) => (element.edits = null));
    assert.equal(await player.run((element) => element.edits), null);
    assert.equal((await moved(player, key)).most, 0);
    await player.close();
  },

  'an actor without a rig says so, and its surface is moved': async (browser) => {
    const player = await using(browser, 'pose');
    await player.run((element) => {
      element.testing.player.rig = () => new Uint8Array();
      element.tool = 'edit';
    });
    await player.untilFound('the editor', (element) => element.testing.edits().ready);
    assert.match(await says(player), /no rig/);
    assert.equal(await player.part('.edit-dock [role="radio"][value="rig"]').isDisabled(), true);
    assert.equal(await player.part('.edit-dock [role="radio"][value="learned"]').isDisabled(), false, 'the space needs no rig');
    const { x, y } = await hand(player);
    await pull(player, { x: x - 3, y }, [10, -10]);
    await settled(player);
    const [edit] = await edits(player);
    assert.equal(edit.method, 'arap');
    assert.ok((await moved(player, await frameOf(player, edit), edit.handles[0].vertex)).there > 0.02);
    // A bundle's rig that cannot be read is another sentence.
    await player.run((element) => {
      element.edits = null;
      element.testing.player.rig = () => Uint8Array.of(1, 2, 3);
      element.testing.core.toolbox.kit.edits.forget();
      element.tool = 'pose';
      element.tool = 'edit';
    });
    await player.untilFound('the sentence', (element) => /the rig .*: the surface alone is moved/.test(element.shadowRoot.querySelector('.outcome').textContent));
    await player.close();
  },

  'a body follows as it was seen to move; an actor that knows no such ways says so': async (browser) => {
    const player = await editing(browser);
    await player.part('.edit-dock [role="radio"][value="learned"]').click();
    const edit = await pulled(player);
    assert.equal(edit.method, 'learned');
    const [{ vertex, to }] = edit.handles;
    const key = await frameOf(player, edit);
    const recorded = await player.run((element, [at, one]) => element.testing.recordedPose(at).slice(3 * one, 3 * one + 3), [key, vertex]);
    const wanted = Math.hypot(...to.map((place, axis) => place - recorded[axis]));
    const learned = await moved(player, key, vertex);
    assert.ok(wanted > 0.1 && Math.abs(learned.there - wanted) < 1e-3, `${learned.there} of ${wanted} m`);
    const soles = await player.run((element, at) => {
      const { editor } = element.testing.core.toolbox.kit.edits;
      return Array.from(editor.stands(at)).flatMap((stands, foot) => (stands ? Array.from(editor.sole(foot)).slice(0, 5) : []));
    }, key);
    for (const one of soles) assert.ok((await moved(player, key, one)).there < 1e-3, 'a pin has moved');
    // The same edit side by side with the others: each has its own pose, and a handle that is met.
    const pose = () => player.run((element, at) => Array.from(element.testing.framePose(at)), key);
    const seen = [await pose()];
    for (const method of ['arap', 'rig', 'laplace']) {
      await player.part(`.edit-dock [role="radio"][value="${method}"]`).click();
      await settled(player);
      assert.ok(Math.abs((await moved(player, key, vertex)).there - wanted) < 1e-3, method);
      seen.push(await pose());
    }
    for (const [a, one] of seen.entries()) for (const other of seen.slice(0, a)) assert.notDeepEqual(one, other);
    // Zero is the frame as it was recorded, to the bit.
    await player.run((element, one) => (element.edits = { version: 1, edits: [one] }), { ...edit, handles: [{ vertex, to: Array.from(recorded) }] });
    await settled(player);
    assert.deepEqual(await moved(player, key), { most: 0, there: 0 });
    // A bundle without the section.
    await player.run((element) => {
      element.testing.player.learned = () => new Uint8Array();
      element.testing.core.toolbox.kit.edits.forget();
      element.tool = 'pose';
      element.tool = 'edit';
    });
    await player.untilFound('the editor', (element) => element.testing.edits().ready);
    assert.equal(await player.part('.edit-dock [role="radio"][value="learned"]').isDisabled(), true);
    await player.run((element, one) => (element.edits = { version: 1, edits: [one] }), edit);
    await player.untilFound('the note', (element) => /no learned space/.test(element.shadowRoot.querySelector('.outcome').textContent));
    await player.close();
  },

  'a finger drags a point, bones are shown, and axe has nothing to say': async (browser) => {
    const player = await editing(browser, PHONE);
    const { x, y } = await hand(player);
    const touch = await player.page.context().newCDPSession(player.page);
    const send = (type, ...points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points.map((at, id) => ({ ...at, id })) });
    await send('touchStart', { x: x - 2, y });
    await send('touchMove', { x: x + 8, y: y - 20 });
    await send('touchEnd');
    await settled(player);
    assert.equal((await edits(player)).length, 1);
    const before = await edits(player);
    // A second finger makes it a camera move.
    const head = await player.run((element) => {
      const pose = element.testing.pose();
      let best = 0;
      for (let at = 0; at < pose.length / 3; at += 1) if (pose[3 * at + 1] > pose[3 * best + 1]) best = at;
      return element.testing.placeOfPoint(...pose.slice(3 * best, 3 * best + 3));
    });
    await send('touchStart', { x: head.x, y: head.y + 6 });
    await send('touchMove', { x: head.x + 10, y: head.y + 6 });
    await player.untilFound('a second point', async (element) => element.edits.edits[0].handles.length === 2);
    await send('touchStart', { x: head.x + 10, y: head.y + 6 }, { x: head.x + 60, y: head.y + 6 });
    await send('touchEnd');
    await settled(player);
    assert.deepEqual(await edits(player), before);
    await player.part('.edit-dock .chip').filter({ hasText: /^bones$/ }).first().click();
    await player.frames(2);
    const lines = await player.part('.edit-marks .wanted').getAttribute('d');
    assert.ok(lines.split('M').length > 10, 'no bones are drawn');
    await axe(player, 'edit');
    await player.close();
  },
};
