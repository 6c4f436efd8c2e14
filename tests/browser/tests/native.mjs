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
    await player.run((element) => element.pause());
    for (const walk of walks) {
      const { frames, lengths, farthest } = await player.page.evaluate(compare, walk);
      assert.equal(lengths[0], lengths[1], `from ${walk.from} to ${walk.to}`);
      assert.ok(frames > 10);
      assert.ok(farthest <= NEAR, `from ${walk.from} to ${walk.to}: ${farthest} m apart`);
      console.log(`        ${walk.from} to ${walk.to}: ${frames} frames, ${walk.transitions} transitions, ${farthest.toExponential(1)} m apart at most`);
    }
    await player.close();
  },
};
