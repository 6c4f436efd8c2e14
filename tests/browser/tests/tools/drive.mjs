/** Motion capture: a clip is dropped on the stage, the actor performs it, and goes back into its graph. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { WIDE, axe } from './common.mjs';

/** A stick figure that squats, as the native program wrote it. */
const clip = () => readFile(join(process.env.REPRISE_NATIVE, 'clip.bvh'), 'utf8');

/** Loads, and stands still in a frame from which recorded ones go on. */
async function standing(browser, options = {}) {
  const player = await browser.open({ reducedMotion: 'reduce', ...WIDE, ...options });
  await player.loaded();
  await player.run((element) => {
    element.pause();
    element.seek(element.info.sequences[0].first + 10);
  });
  return player;
}

/** Drops files, by name and text, on the stage. */
const drop = (player, files) =>
  player.run((element, list) => {
    const transfer = new DataTransfer();
    for (const [name, text] of list) transfer.items.add(new File([text], name));
    const stage = element.shadowRoot.querySelector('.view');
    stage.dispatchEvent(new DragEvent('dragover', { dataTransfer: transfer, bubbles: true, cancelable: true }));
    stage.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, files);

/** Waits until something is said under the stage that has these words. */
const untilSaid = (player, words) =>
  player.until(`“${words}”`, (element, text) => element.shadowRoot.querySelector('.status').textContent.includes(text), words);

/** Plays, faster than the clock, until something was heard. */
const playUntil = (player, type) =>
  player.run(async (element, event) => {
    for (let round = 0; round < 4000 && !window.heard.some((one) => one.type === event); round += 1) {
      element.testing.tick(1 / element.info.fps);
      // The frames are made meanwhile.
      await new Promise((resolve) => setTimeout(resolve, 15));
    }
  }, type);

/** Plays, faster than the clock, to where the actor is under way to. */
const arrive = (player) =>
  player.run((element) => {
    for (let round = 0; round < 4000 && element.state.target !== null; round += 1) element.testing.tick(1 / element.info.fps);
  });

export const tests = {
  'a clip is dropped on the stage, performed, and the actor goes on in its graph': async (browser) => {
    const player = await standing(browser);
    await drop(player, [['squat.bvh', await clip()]]);
    await player.until('the performance', () => window.heard.some(({ type }) => type === 'drivestart'));
    const [{ name, frames, apart }] = await player.heard('drivestart');
    assert.equal(name, 'squat');
    for (const [driven, edited] of apart) assert.ok(edited < driven && edited >= 0, JSON.stringify(apart));
    assert.equal(await player.part('.clip .chip').first().textContent(), 'squat');
    await player.until('half of the frames', (element) => element.testing.core.toolbox.kit.drives.slices.frames > 38);
    await player.run((element) => {
      element.testing.tick(0.6);
      element.pause();
    });
    await player.picture('drive');
    await player.run((element) => element.play());
    await axe(player, 'a clip is performed');
    await playUntil(player, 'driveend');
    const [{ frame }] = await player.heard('driveend');
    const { made, state, playing, size } = await player.run((element) => {
      // It is told while the last frame of the clip is shown, which wears the looks of another one.
      for (let step = 0; step < 3; step += 1) element.testing.tick(1 / element.info.fps);
      const { state, playing, info } = element;
      return { made: element.testing.core.toolbox.kit.drives.slices.frames, state, playing, size: info.frames };
    });
    assert.ok(made > frames - 10 && frame < size, JSON.stringify({ made, frames, frame }));
    assert.ok(playing && state.mode !== 'paused' && state.frame >= frame, JSON.stringify({ home: frame, playing, state }));

    // From here any pose is reached as ever.
    const to = await player.run((element) => {
      const target = element.info.sequences[1].first + 30;
      element.goTo(target);
      return target;
    });
    await arrive(player);
    assert.equal(await player.run((element) => element.state.frame), to);

    // Once more by its chip; who is sent somewhere meanwhile goes there from where the clip ends.
    await player.run(() => (window.heard.length = 0));
    await player.part('.clip .chip').first().click();
    await player.until('another performance', () => window.heard.some(({ type }) => type === 'drivestart'));
    await player.run((element) => element.goTo(element.info.sequences[0].first + 40));
    await playUntil(player, 'driveend');
    await arrive(player);
    assert.equal(await player.run((element) => element.state.frame), (await player.run((element) => element.info.sequences[0].first)) + 40);
    assert.equal((await player.heard('driveend')).length, 1);
    await player.part('.clip .chip').nth(1).click();
    assert.equal(await player.part('.clip').count(), 0);
    await player.close();
  },

  'an actor that walks goes into a clip from where it will be, without waiting for frames': async (browser) => {
    const player = await browser.open(WIDE);
    await player.loaded();
    await player.run((element, text) => {
      element.seek(element.info.sequences[1].first + 20);
      element.play();
      element.drive(text, { name: 'squat' });
    }, await clip());
    await player.until('the performance', () => window.heard.some(({ type }) => type === 'drivestart'));
    const [{ apart }] = await player.heard('drivestart');
    assert.ok(apart.flat().length === 4 && apart.every(([driven, edited]) => edited < driven), JSON.stringify(apart));
    await player.close();
  },

  'what is no clip is told in a sentence, and the actor stays as it is': async (browser) => {
    const player = await standing(browser);
    const before = await player.run((element) => element.state.frame);
    await drop(player, [['bad.bvh', 'HIERARCHY\nROOT a\n{\nOFFSET 0 x 0\n']]);
    await untilSaid(player, 'bad.bvh: line 4: "x" is not a number');
    await drop(player, [['walk.amc', '']]);
    await untilSaid(player, 'its skeleton (.asf) is missing');
    // Chosen with the menu's entry as well.
    await player.part('input[accept*="bvh"]').setInputFiles({ name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('nothing') });
    await untilSaid(player, 'no motion capture that is read');
    const refused = await player.run((element) => element.drive('HIERARCHY').then(() => null, ({ kind, message }) => `${kind}: ${message}`));
    assert.match(refused, /^bad-argument: clip\.bvh: the file ends/);
    assert.equal(await player.run((element) => element.state.frame), before);
    assert.equal(await player.part('.clip').count(), 0);
    // An API call with a clip does what dropping it does.
    const told = await player.run((element, text) => element.drive(text, { name: 'mine' }), await clip());
    assert.equal(told.name, 'mine');
    assert.equal(told.notes.length, 2, told.notes.join('\n'));
    await player.close();
  },

  'an actor without bones is said to have none, and how to pack it': async (browser) => {
    const player = await standing(browser);
    await player.run((element) => {
      element.testing.player.rig = () => new Uint8Array();
    });
    await drop(player, [['squat.bvh', await clip()]]);
    await untilSaid(player, 'builder pack --rig');
    await player.close();
  },
};
