/** Paths through the air, and parts of the body that follow them. */

import assert from 'node:assert/strict';
import { using, asked, found } from './common.mjs';

export const tests = {
  'a path is lifted into the air with the pointer, by numbers and with the keys': async (browser) => {
    const player = await using(browser, 'path');
    await player.run((element) => (element.direction = { version: 1, target: { path: { points: [[0, 0], [0.5, 1], [1, 2]], shape: 'spline' } } }));
    const points = async () => (await asked(player)).target.path.points;
    const height = player.part('.path-dock .field input[type="number"]');
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

    // Handles are put in their places with the next picture, and an answer that arrives may change the stage's size.
    const inPlace = (point) =>
      player.until('the handle within 3 pixels of where its point is', (element, [x, y, z]) => {
        const seen = element.testing.stage.project(x, y, z);
        const stage = element.shadowRoot.querySelector('.view').getBoundingClientRect();
        const box = element.shadowRoot.querySelectorAll('.handle')[1].getBoundingClientRect();
        return Math.hypot(stage.x + seen[0] - box.x - box.width / 2, stage.y + seen[1] - box.y - box.height / 2) < 3;
      }, point);

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
    await inPlace(lifted);
    const moved = await drags(25, 0);
    assert.ok(moved[1] === lifted[1] && Math.hypot(moved[0] - lifted[0], moved[2] - lifted[2]) > 0.05, JSON.stringify([lifted, moved]));
    await inPlace(moved);

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
    const part = player.part('.chip').filter({ hasText: /^Part$/ });
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
};
