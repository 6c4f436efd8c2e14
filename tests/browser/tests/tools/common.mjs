/** What tests of the tools share: taking a tool, drawing on the ground, waiting for an answer, asking axe. */

import assert from 'node:assert/strict';

export const WIDE = { viewport: { width: 1100, height: 720 } };
export const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

/** Loads, stands still, and takes a tool. */
export async function using(browser, tool, options = WIDE) {
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

/** Where on the screen a place on the ground is, told from where the actor stands. */
export const place = (player, x, z) => player.run((element, [a, b]) => element.testing.placeOnGround(element.state.x + a, element.state.z + b), [x, z]);
export const asked = (player) => player.run((element) => element.direction);
export const says = (player) => player.part('.outcome').textContent();

/** Drags over points of the ground, told from where the actor stands. */
export async function drag(player, points, from = null) {
  const places = [];
  for (const [x, z] of points) places.push(await place(player, x, z));
  const [first, ...rest] = from ? [from, ...places] : places;
  await player.mouse.move(first.x, first.y);
  await player.mouse.down();
  for (const { x, y } of rest) await player.mouse.move(x, y, { steps: 6 });
  await player.mouse.up();
}

/** Waits until the search has said something. */
export async function found(player) {
  await player.untilFound('an answer', (element) => element.answer !== null);
  return player.run((element) => element.answer);
}

/** A path a little to the side, from where the actor stands. */
export const LINE = [[0, 0], [0.3, 0.5], [0.3, 1], [0.2, 1.5], [0, 2]];

/** Fails on whatever axe finds amiss. */
export async function axe(player, state) {
  const violations = await player.run(async () => {
    await import('/vendor/axe.js');
    const { violations: all } = await window.axe.run(document, { resultTypes: ['violations'] });
    return all.map(({ id, help, nodes }) => `${id}: ${help}: ${nodes.map(({ target, failureSummary }) => `${target} ${failureSummary}`).join(' | ')}`);
  });
  assert.deepEqual(violations, [], `axe, ${state}`);
}
