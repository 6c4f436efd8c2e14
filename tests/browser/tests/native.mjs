/** The same walks as the native program synthesised them, in WebAssembly. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';

/** Metres that a coordinate may differ. */
const NEAR = 1e-4;

const folder = process.env.REPRISE_NATIVE;

/** Runs in the page: frames, and the largest difference of a coordinate, of a walk that a fresh player synthesises. */
async function compare({ from, to, file }) {
  const bytes = async (address) => new Uint8Array(await (await fetch(address)).arrayBuffer());
  const player = new (document.querySelector('reprise-player').testing.player.constructor)();
  player.push(await bytes('demo.reprise'));
  const ours = player.synthesise(from, to);
  const theirs = new Float32Array((await bytes(`native/${file}`)).buffer);
  const vertices = player.recorded_pose(from).length / 3;
  player.free();
  let farthest = 0;
  for (let at = 0; at < ours.length; at += 1) {
    const difference = Math.abs(ours[at] - theirs[at]);
    if (!(difference <= farthest)) farthest = difference;
  }
  return { frames: ours.length / vertices / 3, lengths: [ours.length, theirs.length], farthest };
}

/** Runs in the page: how far edited frames, and a walk that passes them, are from the native ones at most. */
async function compareEdited({ frames, from, to, file }) {
  const { testing } = document.querySelector('reprise-player');
  const theirs = new Float32Array((await (await fetch(`native/${file}`)).arrayBuffer()));
  const farthest = (ours, at) => ours.reduce((most, place, index) => Math.max(most, Math.abs(place - theirs[at + index])), 0);
  let at = 0;
  let edited = 0;
  for (const frame of frames) {
    const ours = testing.player.pose_of(frame);
    edited = Math.max(edited, farthest(ours, at));
    at += ours.length;
  }
  const walk = testing.player.synthesise(from, to);
  return { edited, walk: farthest(walk, at), lengths: [at + walk.length, theirs.length] };
}

/**
 * Runs in the page: how many frames the actor has in a clip, and how far some of them are from the native ones at most: as they are driven, and
 * with their ends edited.
 */
async function compareDriven({ clip, frames, file, from, aimed }) {
  const { testing } = document.querySelector('reprise-player');
  const floats = async (name) => new Float32Array(await (await fetch(`native/${name}`)).arrayBuffer());
  const [driver, { drives }] = [await testing.driving(), testing.core.toolbox.kit];
  const count = driver.begin(['clip.bvh'], [new TextEncoder().encode(clip)]);
  const compare = (theirs) => {
    let [at, farthest] = [0, 0];
    for (const frame of frames) {
      const ours = driver.make(frame);
      for (let index = 0; index < ours.length; index += 1, at += 1) {
        const difference = Math.abs(ours[index] - theirs[at]);
        if (!(difference <= farthest)) farthest = difference;
      }
    }
    return [farthest, at - theirs.length];
  };
  const driven = compare(await floats(file));
  const apart = [...driver.aim(...drives.windows(from))];
  return { count, driven, apart, edited: compare(await floats(aimed)) };
}

export const tests = {
  'requests are refused in the same words natively and in WebAssembly': async (browser) => {
    const list = JSON.parse(await readFile(new URL('../../fixtures/requests.json', import.meta.url), 'utf8'));
    const player = await browser.open();
    await player.loaded();
    const refused = await player.run(
      async (element, texts) => {
        const { check_request } = await element.testing.searching();
        return texts.map((text) => {
          try {
            check_request(text);
            return null;
          } catch ({ message }) {
            return message;
          }
        });
      },
      list.map(([text]) => text),
    );
    assert.deepEqual(list.map(([text], at) => [text, refused[at]]), list);
    await player.close();
  },

  'edited frames are the same natively and in WebAssembly, and walks go through them': async (browser) => {
    if (!folder) {
      assert.notEqual(process.env.CI, 'true', 'REPRISE_NATIVE names no folder of walks: run cargo xtask test');
      console.log('skipped: REPRISE_NATIVE names no folder of walks, see cargo xtask test');
      return;
    }
    const about = JSON.parse(await readFile(join(folder, 'edited.json'), 'utf8'));
    const player = await browser.open();
    await player.loaded();
    await player.run((element, document) => {
      element.pause();
      element.edits = document;
    }, about.document);
    await player.untilFound('the edited frames', (element) => element.testing.edits().made > 20 && element.testing.edits().due === 0);
    const { edited, walk, lengths } = await player.page.evaluate(compareEdited, about);
    assert.equal(lengths[0], lengths[1]);
    assert.equal(edited, 0, `edited frames are ${edited} m apart`);
    assert.ok(walk <= NEAR, `the walk is ${walk} m apart`);
    console.log(`        ${about.frames.length} frames the same to the bit, the walk ${walk.toExponential(1)} m apart at most`);
    await player.close();
  },

  'walks are the same natively and in WebAssembly': async (browser) => {
    if (!folder) {
      assert.notEqual(process.env.CI, 'true', 'REPRISE_NATIVE names no folder of walks: run cargo xtask test');
      console.log('skipped: REPRISE_NATIVE names no folder of walks, see cargo xtask test');
      return;
    }
    const walks = JSON.parse(await readFile(join(folder, 'walks.json'), 'utf8'));
    assert.ok(walks.filter(({ transitions }) => transitions > 1).length >= 3, 'too few walks with several transitions');
    const player = await browser.open();
    await player.loaded();
    // As recorded: what is drawn of alternatives hangs on what was shown before.
    await player.run((element) => {
      element.variety = 0;
      element.pause();
    });
    for (const walk of walks) {
      const { frames, lengths, farthest } = await player.page.evaluate(compare, walk);
      assert.equal(lengths[0], lengths[1], `from ${walk.from} to ${walk.to}`);
      assert.ok(frames > 10);
      assert.ok(farthest <= NEAR, `from ${walk.from} to ${walk.to}: ${farthest} m apart`);
      console.log(`        ${walk.from} to ${walk.to}: ${frames} frames, ${walk.transitions} transitions, ${farthest.toExponential(1)} m apart at most`);
    }
    await player.close();
  },

  'what a clip makes of the actor is the same natively and in WebAssembly': async (browser) => {
    const wanted = JSON.parse(await readFile(join(folder, 'driven.json'), 'utf8'));
    const clip = await readFile(join(folder, 'clip.bvh'), 'utf8');
    const player = await browser.open();
    await player.loaded();
    const { count, driven, apart, edited } = await player.page.evaluate(compareDriven, { ...wanted, clip });
    assert.equal(count, wanted.count);
    for (const [farthest, longer] of [driven, edited]) {
      assert.equal(longer, 0);
      assert.ok(farthest <= NEAR, `${farthest} m apart`);
    }
    // Both ends are nearer to the recording than they were driven.
    assert.ok(apart[1] < apart[0] && apart[3] < apart[2], apart.join(' '));
    await player.close();
  },
};
