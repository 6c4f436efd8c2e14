/** The tools, with the pointer, with fingers and with the keyboard; links and files; and what axe has to say. */

import assert from 'node:assert/strict';

const WIDE = { viewport: { width: 1100, height: 720 } };
const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

/** Loads, stands still, and takes a tool. */
async function using(browser, tool, options = WIDE) {
  const player = await browser.open({ reducedMotion: 'reduce', ...options });
  await player.loaded();
  await player.run((element, name) => {
    element.pause();
    element.seek(element.info.sequences[0].first + 10);
    element.tool = name;
  }, tool);
  await player.until('the camera at rest', (element) => !element.testing.stage.camera_moving());
  return player;
}

const place = (player, x, z) => player.run((element, [a, b]) => element.testing.placeOnGround(element.state.x + a, element.state.z + b), [x, z]);
const asked = (player) => player.run((element) => element.direction);
const says = (player) => player.part('.outcome').textContent();

/** Drags over points of the ground, told from where the actor stands. */
async function drag(player, points, from = null) {
  const places = [];
  for (const [x, z] of points) places.push(await place(player, x, z));
  const [first, ...rest] = from ? [from, ...places] : places;
  await player.mouse.move(first.x, first.y);
  await player.mouse.down();
  for (const { x, y } of rest) await player.mouse.move(x, y, { steps: 6 });
  await player.mouse.up();
}

/** Waits until the search has said something, and fails where a slice of it took far longer than it may. */
async function found(player) {
  await player.until('an answer', (element) => element.answer !== null, null, 60_000);
  return player.run((element) => element.answer);
}

const LINE = [[0, 0], [0.3, 0.5], [0.3, 1], [0.2, 1.5], [0, 2]];

async function axe(player, state) {
  const violations = await player.run(async () => {
    await import('/vendor/axe.js');
    const { violations: all } = await window.axe.run(document, { resultTypes: ['violations'] });
    return all.map(({ id, help, nodes }) => `${id}: ${help}: ${nodes.map(({ target, failureSummary }) => `${target} ${failureSummary}`).join(' | ')}`);
  });
  assert.deepEqual(violations, [], `axe, ${state}`);
}

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
    const middle = await player.run((element, [a, b]) => element.testing.placeOnGround((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), bent);
    await player.mouse.move(middle.x, middle.y);
    await player.mouse.down();
    await player.mouse.up();
    assert.equal((await asked(player)).target.path.points.length, count + 1);
    await player.part('.handle').nth(1).dblclick();
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
    await player.until('the actor on its way', (element) => element.state.target !== null, null, 60_000);
    await player.run((element) => (element.speed = 4));
    await player.event('arrive', 60_000);
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
      await player.page.waitForTimeout(rests);
      for (const share of [0.3, 0.6, 1]) await send('touchMove', [at(start, 0.5)[0] * (1 - share) + at(end, 0.7)[0] * share, at(end, 0.5)[1]]);
      await send('touchEnd');
    };
    await slide(0, 1, 400);
    assert.deepEqual(await queued(), [b, a, c]);
    await player.part('.toolbar .round').first().tap();
    assert.deepEqual(await queued(), [a, b, c]);
    await slide(1, 0, 0);
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
    await player.until('the actor on its way', (element) => element.state.target !== null, null, 60_000);
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
    await player.until('three arrivals', () => window.heard.filter(({ type }) => type === 'arrive').length === 3, null, 120_000);
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

  'a path is lifted into the air with the pointer, by numbers and with the keys': async (browser) => {
    const player = await using(browser, 'path');
    await player.run((element) => (element.direction = { version: 1, target: { path: { points: [[0, 0], [0.5, 1], [1, 2]], shape: 'spline' } } }));
    const points = async () => (await asked(player)).target.path.points;
    const height = player.part('.path-dock .field input');
    assert.equal(await height.isVisible(), false);
    await player.part('.chip').filter({ hasText: '3D' }).click();
    const flat = await points();
    assert.ok(flat.every(([, y]) => y > 0.4 && y < 1.6 && y === flat[0][1]), JSON.stringify(flat));
    await player.part('.handle').nth(1).focus();
    await height.fill('1.5');
    await player.keyboard.press('Enter');
    assert.deepEqual((await points()).map(([, y]) => y), [flat[0][1], 1.5, flat[0][1]]);
    await player.part('.handle').nth(2).focus();
    await player.keyboard.press('PageUp');
    await player.keyboard.press('Shift+PageUp');
    assert.ok(Math.abs((await points())[2][1] - flat[0][1] - 0.6) < 2e-3);
    assert.match(await player.part('.handle').nth(2).getAttribute('aria-label'), / high$/);

    // With alt up and down, without it along the ground: the height stays.
    const drags = async (dx, dy) => {
      const box = await player.part('.handle').nth(1).boundingBox();
      const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
      await player.mouse.move(x, y);
      await player.mouse.down();
      await player.mouse.move(x + dx, y + dy, { steps: 4 });
      await player.mouse.up();
      return (await points())[1];
    };
    const before = (await points())[1];
    await player.keyboard.down('Alt');
    const lifted = await drags(0, -30);
    await player.keyboard.up('Alt');
    assert.ok(lifted[1] > before[1] + 0.05 && lifted[0] === before[0] && lifted[2] === before[2], JSON.stringify([before, lifted]));
    const moved = await drags(25, 0);
    assert.ok(moved[1] === lifted[1] && Math.hypot(moved[0] - lifted[0], moved[2] - lifted[2]) > 0.05, JSON.stringify([lifted, moved]));
    // Handles are put in their places with the next picture, and an answer that arrives may change the stage's size.
    const apart = async () => {
      const seen = await player.run((element, [x, y, z]) => Array.from(element.testing.stage.project(x, y, z)), moved);
      const stage = await player.part('.view').boundingBox();
      const box = await player.part('.handle').nth(1).boundingBox();
      return Math.hypot(stage.x + seen[0] - box.x - box.width / 2, stage.y + seen[1] - box.y - box.height / 2);
    };
    let distance = await apart();
    for (let tries = 0; tries < 50 && distance >= 3; tries += 1) {
      await player.page.waitForTimeout(100);
      distance = await apart();
    }
    assert.ok(distance < 3, `the handle is ${distance} pixels from where its point is`);

    const { path } = await found(player);
    assert.ok(path.samples.some(([, , y]) => y > 0.4), 'the answer has no heights');
    await player.keyboard.press('Control+z');
    assert.deepEqual((await points())[1], lifted);
    await player.part('.chip').filter({ hasText: '3D' }).click();
    assert.ok((await points()).every((point) => point.length === 2));
    await player.close();
  },

  'a hand follows a path through the air, picked with the pointer or with the keys': async (browser) => {
    const player = await using(browser, 'path');
    // The hand's own way when the actor waves or dances: no middle of a body goes like that.
    const hand = await player.run((element) => {
      const { testing, info } = element;
      const { first } = info.sequences.find(({ name }) => name === 'wave') ?? info.sequences[0];
      element.seek(first + 12);
      const pose = testing.pose();
      const points = Array.from({ length: pose.length / 3 }, (_, vertex) => pose.slice(3 * vertex, 3 * vertex + 3));
      const { x, z } = element.state;
      const far = ([px, , pz]) => Math.hypot(px - x, pz - z);
      const tip = points.filter(([, y]) => y > 0.9).reduce((one, other) => (far(other) > far(one) ? other : one));
      const vertices = points.flatMap((point, vertex) => (Math.hypot(...point.map((part, axis) => part - tip[axis])) < 0.07 ? [vertex] : []));
      const middle = (vertex, axis) => vertices.reduce((sum, at) => sum + testing.recordedPose(vertex)[3 * at + axis], 0) / vertices.length;
      const way = Array.from({ length: 9 }, (_, step) => [0, 1, 2].map((axis) => middle(first + 12 + 3 * step, axis)));
      // From the frame's recorded place to where it stands.
      const [moved, sin, cos] = [way[0], Math.sin(element.state.heading), Math.cos(element.state.heading)];
      const now = [0, 1, 2].map((axis) => vertices.reduce((sum, at) => sum + pose[3 * at + axis], 0) / vertices.length);
      const points3 = way.map(([px, py, pz]) => {
        const [dx, dz] = [px - moved[0], pz - moved[2]];
        return [now[0] + cos * dx + sin * dz, py, now[2] + cos * dz - sin * dx];
      });
      const { state } = element;
      return { vertices, points: points3, frame: state.frame, stands: [state.heading, state.x, state.z] };
    });
    assert.ok(hand.vertices.length > 3, JSON.stringify(hand.vertices));
    // How far the hand itself gets from the path on the walk that was found, for whoever follows it.
    const walked = (vertices) =>
      player.run(async (element, [path, followers, frame, all]) => {
        element.cancel();
        element.seek(frame);
        const answer = await element.goTo({ path, ...(followers ? { vertices: followers } : {}) });
        const apart = [];
        while (element.state.target !== null && apart.length < 2000) {
          element.testing.tick(0.04);
          const pose = element.testing.pose();
          const at = [0, 1, 2].map((axis) => all.reduce((sum, vertex) => sum + pose[3 * vertex + axis], 0) / all.length);
          apart.push(Math.min(...path.map((point) => Math.hypot(...point.map((part, axis) => part - at[axis])))));
        }
        return { path: answer.path, mean: apart.reduce((sum, one) => sum + one, 0) / apart.length };
      }, [hand.points, vertices, hand.frame, hand.vertices]);
    const own = await walked(hand.vertices);
    const middle = await walked(null);
    console.log(`        the hand is ${(100 * own.mean).toFixed(1)} cm off the path where it follows, ${(100 * middle.mean).toFixed(1)} cm where the body's middle does; planned ${(100 * own.path.mean).toFixed(1)} and ${(100 * middle.path.mean).toFixed(1)}`);
    assert.ok(own.path.mean < 0.05 && own.mean < 0.06, `the hand is ${own.path.mean} and ${own.mean} m off`);
    assert.ok(own.mean < 0.5 * middle.mean, `${own.mean} m with the hand, ${middle.mean} m with the middle`);

    // A path of the hand's is no path of a vertex that there is not.
    const refused = await player.run((element, path) => element.goTo({ path, vertices: [1e6] }).catch(({ kind, message }) => `${kind}: ${message}`), hand.points);
    assert.match(refused, /^bad-argument: there is no vertex 1000000/);

    // Picked on the stage: the path keeps its points, and is searched for anew; undone, the middle follows again.
    await player.run((element, points) => {
      element.cancel();
      element.seek(element.info.sequences[0].first + 10);
      element.direction = { version: 1, target: { path: { points, shape: 'spline' } } };
    }, [[0, 0], [0.5, 1], [1, 2]]);
    const followers = async () => (await asked(player)).target.path.vertices ?? [];
    const part = player.part('.chip').filter({ hasText: 'Part' });
    await part.click();
    const spot = await player.run((element) => {
      const pose = element.testing.pose();
      let top = 0;
      for (let at = 0; at < pose.length; at += 3) if (pose[at + 1] > pose[top + 1]) top = at;
      return Array.from(element.testing.stage.project(pose[top], pose[top + 1] - 0.08, pose[top + 2]));
    });
    const stage = await player.part('.view').boundingBox();
    await player.mouse.click(stage.x + 8, stage.y + 8);
    assert.deepEqual(await followers(), []);
    await player.mouse.click(stage.x + spot[0], stage.y + spot[1]);
    const head = await followers();
    assert.ok(head.length > 3, `${head.length} vertices of the head`);
    assert.equal(await part.getAttribute('aria-pressed'), 'true');
    const answer = await found(player);
    assert.ok(answer.path.length > 2 && answer.path.max >= answer.path.mean);
    const link = await player.run((element) => element.link);
    await player.keyboard.press('Control+z');
    assert.deepEqual(await followers(), []);
    await player.run((element, address) => element.openLink(address), link);
    assert.deepEqual(await followers(), head);
    await part.click();
    assert.deepEqual(await followers(), []);

    // With the keys: the cross is in the middle of the stage at first.
    await part.focus();
    await player.keyboard.press('Enter');
    const steps = await player.run((element) => {
      const [x, y] = element.testing.stage.project(element.state.x, 1, element.state.z);
      const { width, height } = element.shadowRoot.querySelector('.view').getBoundingClientRect();
      return [Math.round((x - width / 2) / 6), Math.round((y - height / 2) / 6)];
    });
    for (const [axis, keys] of [['ArrowLeft', 'ArrowRight'], ['ArrowUp', 'ArrowDown']].entries()) {
      for (let step = 0; step < Math.abs(steps[axis]); step += 1) await player.keyboard.press(keys[Number(steps[axis] > 0)]);
    }
    await player.keyboard.press('Enter');
    assert.ok((await followers()).length > 3, 'the cross has picked nothing');
    await player.close();
  },

  'a click on the ground goes there, a drag says which way to face': async (browser) => {
    const player = await using(browser, 'place');
    await drag(player, [[0.6, 1], [1.2, 1]]);
    const { place: goal } = (await asked(player)).target;
    assert.ok(Math.abs(goal.heading - Math.PI / 2) < 0.15, `heading ${goal.heading}`);
    await player.run((element) => (element.speed = 4));
    await player.event('arrive', 60_000);
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

  'key poses are put on the ruler, moved, and reached': async (browser) => {
    const player = await using(browser, 'timing');
    const poses = player.part('.pose');
    await poses.nth(1).click();
    await found(player);
    await poses.nth(6).scrollIntoViewIfNeeded();
    const from = await poses.nth(6).boundingBox();
    const ruler = await player.part('.lane').boundingBox();
    await player.mouse.move(from.x + 18, from.y + 20);
    await player.mouse.down();
    await player.mouse.move(ruler.x + ruler.width * 0.6, ruler.y + 20, { steps: 5 });
    await player.mouse.up();
    const keys = async () => (await asked(player)).target.keys.poses;
    assert.equal((await keys()).length, 2);
    assert.ok(Math.abs((await keys())[1].time - 4.8) < 0.2, JSON.stringify(await keys()));
    await player.until('both', (element) => element.answer?.keys.length === 2, null, 60_000);
    const { keys: rows } = await player.run((element) => element.answer);
    assert.deepEqual(rows.map(({ wanted }) => wanted.toFixed(1)), (await keys()).map(({ time }) => time.toFixed(1)));
    await player.until('the table', (element) => element.shadowRoot.querySelectorAll('.times tbody tr').length === 2);
    const key = await player.part('.key-pose').first().boundingBox();
    await player.mouse.move(key.x + 18, key.y + 20);
    await player.mouse.down();
    await player.mouse.move(key.x + 18 + ruler.width / 8, key.y + 20, { steps: 4 });
    await player.mouse.up();
    assert.ok(Math.abs((await keys())[0].time - 3) < 0.2, JSON.stringify(await keys()));
    await player.part('.key-pose').first().dblclick();
    assert.equal((await keys()).length, 1);
    await player.part('.go').click();
    await player.run((element) => (element.speed = 4));
    await player.event('arrive', 60_000);
    assert.equal((await player.heard('arrive'))[0].frame, (await keys())[0].pose);
    await player.close();
  },

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
    await player.until('the actor on its way', (element) => element.state.target !== null, null, 60_000);
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
    await player.until('the next part', (element) => element.state.remaining_seconds > 40, null, 60_000);
    // Even where the search comes late, as on a slow machine, the actor goes on from where it waits.
    await player.run((element) => {
      element.pause();
      const { player: inner } = element.testing;
      inner.play();
      for (let tick = 0; tick < 1000 && JSON.parse(inner.state()).remaining_seconds > 0.2; tick += 1) inner.tick(0.1);
      element.play();
    });
    await player.event('arrive', 60_000);
    await player.until('the actor on its way again', (element) => element.state.remaining_seconds > 20, null, 60_000);
    await player.close();
  },

  'every tool is reached and used with the keyboard alone': async (browser) => {
    const player = await using(browser, 'pose');
    const focused = () => player.run((element) => element.shadowRoot.activeElement?.getAttribute('aria-label') ?? element.shadowRoot.activeElement?.textContent);
    const names = ['pose', 'place', 'path', 'timing', 'wander'];
    for (const [at, name] of names.entries()) {
      await player.keyboard.press(String(at + 1));
      assert.equal(await player.run((element) => element.tool), name);
    }
    assert.equal((await player.heard('toolchange')).length, 5 - 1);

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
    await player.until('the actor on its way', (element) => element.state.target !== null, null, 60_000);
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

  'what is asked can be passed on as a link': async (browser) => {
    const player = await using(browser, 'path');
    await drag(player, LINE);
    const { link, direction, answer } = { answer: await found(player), ...(await player.run(({ link: hash, direction: request }) => ({ link: hash, direction: request }))) };
    await player.close();
    assert.match(link, /^#direction=[\w-]+$/);
    const other = await browser.open({ ...WIDE, hash: link });
    await other.loaded();
    await other.until('the direction', (element) => element.direction !== null);
    assert.equal(await other.run((element) => element.tool), 'path');
    assert.deepEqual((await asked(other)).target.path.points, direction.target.path.points);
    const again = await found(other);
    assert.deepEqual(again.start.frame, answer.start.frame);
    await other.close();
  },

  'links that are damaged say so, in a sentence': async (browser) => {
    const encode = (value) => `#direction=${Buffer.from(typeof value === 'string' ? value : JSON.stringify(value)).toString('base64url')}`;
    const path = (points, more = {}) => ({ version: 1, target: { path: { points, ...more } } });
    const links = {
      'no base64': '#direction=%%%',
      'no UTF-8': `#direction=${Buffer.from([0xff, 0xfe, 0x80]).toString('base64url')}`,
      'no JSON': encode('{"version":1'),
      'null': encode('null'),
      'a number': encode('7'),
      'a list': encode([]),
      'another version': encode({ version: 99, target: {} }),
      'no target': encode({ version: 1 }),
      'an unknown target': encode({ version: 1, target: { fly: {} } }),
      'a path without points': encode(path([])),
      'a path without length': encode(path([[0, 0], [0, 0]])),
      'a path with words': encode(path([['a', 0], [1, 1]])),
      'a path beyond the world': encode(path([[0, 0], [1e9, 0]])),
      'a path of nulls': encode(path([[null, null], [1, 1]])),
      'too many points': encode(path(Array.from({ length: 5000 }, (_, at) => [at * 0.01, 0]))),
      'a queue of nothing': encode({ version: 1, target: { queue: [] } }),
      'a wrapped nothing': encode({ request: null, start: { frame: 'x' } }),
    };
    const player = await using(browser, 'pose');
    for (const [name, link] of Object.entries(links)) {
      await player.run((element) => element.seek(5));
      const used = await player.run((element, address) => element.openLink(address), link);
      assert.equal(used, false, name);
      assert.ok((await player.part('.status').textContent()).length > 15, `${name}: nothing is said`);
      assert.equal(await player.part('.error').isVisible(), false, name);
    }
    // What can only be found out by searching is said by the search.
    for (const [name, target] of Object.entries({
      'an unknown behaviour': { path: { points: [[0, 0], [1, 1]], stretches: [{ from: 0, to: 1, behaviour: 'flying' }] } },
      'an unknown frame': { keys: { poses: [{ pose: 999999, time: 1 }] } },
      'a weight of nobody': { wander: { seconds: 10, weights: { nobody: 2 } } },
    })) {
      await player.run((element, request) => (element.direction = request), { version: 1, target });
      await player.until(`a sentence on ${name}`, (element) => /no (behaviour|frame)/.test(element.shadowRoot.querySelector('.outcome')?.textContent ?? ''), null, 60_000);
      assert.equal(await player.part('.error').isVisible(), false, name);
    }
    // Vertices that there are not, and paths that different vertices are to follow.
    const along = (vertices) => ({ path: { points: [[0, 0], [1, 1]], vertices } });
    await player.run((element, target) => (element.direction = { version: 1, target }), along([1, 999999]));
    await player.until('a sentence on the vertex', (element) => /no vertex 999999/.test(element.shadowRoot.querySelector('.outcome')?.textContent ?? ''), null, 60_000);
    await player.run((element, target) => (element.direction = { version: 1, target }), { queue: [along([1, 2, 3]), along([])] });
    await player.until('a sentence on groups', (element) => /followed by the same ones/.test(element.shadowRoot.querySelector('.status').textContent), null, 60_000);
    assert.equal((await player.heard('error')).length, 0);
    await player.close();
  },

  'what is asked and its answer are saved and load again': async (browser) => {
    const player = await using(browser, 'timing');
    await player.part('.pose').nth(2).click();
    await found(player);
    const direction = await asked(player);
    const open = () => player.part('.share > button').click();
    await open();
    const download = player.page.waitForEvent('download');
    download.catch(() => {});
    await player.part('.menu .chip').filter({ hasText: 'Save' }).click();
    const path = await (await download).path();
    await player.part('.chip').filter({ hasText: 'Clear' }).click();
    assert.equal(await asked(player), null);
    await player.part('input[type="file"]').setInputFiles({ name: 'a.json', mimeType: 'application/json', buffer: await (await import('node:fs/promises')).readFile(path) });
    await player.until('the direction', (element) => element.direction !== null);
    assert.deepEqual((await asked(player)).target, direction.target);
    await player.part('input[type="file"]').setInputFiles({ name: 'b.json', mimeType: 'application/json', buffer: Buffer.from('not JSON') });
    await player.until('a sentence', (element) => /no JSON/.test(element.shadowRoot.querySelector('.status').textContent));
    assert.deepEqual((await asked(player)).target, direction.target);
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
