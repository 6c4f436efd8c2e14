/** The parts of the body in colours: chip, key, attribute, legend; none where the actor has none. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { bundlePath } from '../browser.mjs';
import { withSection } from '../sections.mjs';
import { axe, using } from './tools/common.mjs';

const NAMES = ['left arm', 'left leg', 'right arm', 'right leg', 'torso'];

/** Colours of the picture that are strong: parts are painted, the dancer is not. */
const strong = (player) =>
  player.run(async (element) => {
    const { data } = await element.snapshot();
    const hues = new Set();
    for (let at = 0; at < data.length; at += 4) {
      const [r, g, b] = [data[at], data[at + 1], data[at + 2]];
      if (Math.max(r, g, b) - Math.min(r, g, b) < 70) continue;
      hues.add([r, g, b].map((channel) => Number(channel > (Math.max(r, g, b) + Math.min(r, g, b)) / 2)).join(''));
    }
    return [...hues].sort();
  });

/** The demo with another section, such as painted parts, which come before those that were found. */
async function withParts(browser, section) {
  const player = await using(browser, 'pose');
  const body = withSection(await readFile(bundlePath), section);
  await player.page.route('**/other.reprise', (route) => route.fulfill({ body, contentType: 'application/octet-stream' }));
  await player.run((element) => {
    window.heard.length = 0;
    element.parts = true;
    element.src = 'other.reprise';
  });
  await player.event('load');
  return player;
}

export const tests = {
  'parts: the chip, the key and the attribute colour the actor, and names stand beside': async (browser) => {
    const player = await using(browser, 'pose');
    await player.run((element) => element.pause());
    const chip = player.part('.chip:text-is("parts")');
    const legend = player.part('.legend');
    assert.deepEqual([await chip.isVisible(), await legend.isVisible(), await chip.getAttribute('aria-pressed')], [true, false, 'false']);
    const parts = await player.run((element) => element.bodyParts);
    assert.deepEqual(parts.map(({ name }) => name).sort(), NAMES);
    assert.equal(new Set(parts.map(({ colour }) => colour)).size, 5);
    const before = await strong(player);
    await chip.click();
    assert.equal(await player.run((element) => element.hasAttribute('parts')), true);
    assert.deepEqual((await legend.locator('li').allTextContents()).sort(), NAMES);
    const colours = await legend.locator('.swatch').evaluateAll((swatches) => swatches.map((swatch) => getComputedStyle(swatch).backgroundColor));
    assert.equal(new Set(colours).size, 5);
    // Red, blue, yellow and green are limbs; a part may be hidden behind the others.
    const painted = await strong(player);
    assert.ok(painted.filter((hue) => !before.includes(hue)).length >= 1 && painted.length >= 3, `${before} and ${painted}`);
    await axe(player, 'parts in colours');
    // A new stage has them, too.
    await player.run((element) => element.testing.stage.lose());
    await player.event('devicerestored');
    await player.until('the colours on a new stage', async (element) => {
      const { data } = await element.snapshot();
      return data.some((_, at) => at % 4 === 0 && data[at] - data[at + 1] > 70 && data[at] - data[at + 2] > 70);
    });
    await player.page.keyboard.press('b');
    assert.deepEqual([await legend.isVisible(), await player.run((element) => element.parts)], [false, false]);
    assert.deepEqual(await strong(player), before);
    await player.run((element) => (element.parts = true));
    assert.equal(await chip.getAttribute('aria-pressed'), 'true');
    await player.close();
  },

  'parts: what is damaged is not shown, and nothing else is lost': async (browser) => {
    const player = await withParts(browser, { kind: 71, minor: 14, raw: Buffer.from([2, 1, 65, 1, 65, 0, 0, 0, 0]) });
    assert.deepEqual(await player.run((element) => element.bodyParts), []);
    assert.deepEqual([await player.part('.chip:text-is("parts")').isVisible(), await player.part('.legend').isVisible()], [false, false]);
    await player.page.keyboard.press('b');
    assert.equal(await player.run((element) => element.parts), true, 'the key does nothing');
    await player.close();
  },
};
