/** Families: a slider that sends the actor to the member that is nearest. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { bundlePath } from '../../browser.mjs';
import { withSection } from '../../sections.mjs';
import { asked, axe, using } from './common.mjs';

/** The walk and the run of the demo's actor as a family, with speeds that are as good as others here. */
const SPEEDS = { walk: 1.25, run: 3 };

async function withFamilies(browser, write = JSON.stringify) {
  const player = await using(browser, 'pose');
  const sequences = await player.run((element) => element.info.sequences);
  const members = Object.entries(SPEEDS).map(([name, value]) => {
    const { first, count } = sequences.find((sequence) => sequence.name === name);
    return { sequence: name, frames: [first, first + count - 1], value };
  });
  const text = write([{ name: 'gait', parameter: 'speed', unit: 'm/s', members }]);
  const body = withSection(await readFile(bundlePath), { kind: 72, minor: 11, raw: Buffer.from(text) });
  await player.page.route('**/families.reprise', (route) => route.fulfill({ body, contentType: 'application/octet-stream' }));
  await player.run((element) => {
    window.heard.length = 0;
    element.src = 'families.reprise';
  });
  await player.event('load');
  await player.run((element) => element.pause());
  return { player, members };
}

/** Whether the actor is going to a frame of the member, or stands in one. */
const goesTo = (player, { frames }) =>
  player.untilFound('the actor on its way', ({ state: { target } }, [first, last]) => target !== null && target >= first && target <= last, frames);

/** Lets time pass until the actor is there, and tells whether it goes on. */
async function arrives(player) {
  await player.run((element) => {
    window.heard.length = 0;
    element.play();
  });
  await player.event('arrive');
  return player.run((element) => {
    const { playing } = element;
    element.pause();
    return playing;
  });
}

export const tests = {
  'families: a slider sends the actor to the nearest member, and shows which is performed': async (browser) => {
    const { player, members } = await withFamilies(browser);
    const [walk, run] = members;
    await player.run((element, [frame]) => element.seek(frame + 5), walk.frames);
    const told = await player.run((element) => element.families);
    assert.deepEqual(told, [{ name: 'gait', parameter: 'speed', unit: 'm/s', members, value: SPEEDS.walk }]);
    const slider = player.part('.families.docked input');
    await player.until('the thumb at the walk', (element) => Number(element.shadowRoot.querySelector('.docked input').value) === 1.25);
    assert.equal(await slider.getAttribute('aria-valuetext'), '1.25 m/s');
    // Where its row is to be seen one slider is enough.
    await player.until('one slider', (element) => element.shadowRoot.querySelector('.families.on-stage .family').hidden);
    await axe(player, 'a slider of a family');
    // The demo's page is small; the row has room for it all the same.
    await player.picture('families');
    await slider.focus();
    await player.keyboard.press('ArrowRight');
    await goesTo(player, run);
    assert.deepEqual((await asked(player)).target, { behaviour: { name: 'gait@3.0000', hold: 0 } });
    assert.ok(await arrives(player), 'it goes on at that speed');
    await player.until('what is performed', (element) => element.families[0].value === 3);
    await player.run((element) => element.pressKey(new KeyboardEvent('keydown', { key: 'f' })));
    await player.until('the facts', (element) => /gait, speed\s*3\.00 m\/s/.test(element.shadowRoot.querySelector('.facts').textContent));
    // Dragged to where the walk is nearer, it goes there; where it would be the same member, nothing is asked.
    const before = await player.run((element) => element.testing.plans().now);
    await slider.fill('2.9');
    assert.equal(await player.run((element) => element.testing.plans().now), before);
    await slider.fill('1.9');
    await goesTo(player, walk);
    await arrives(player);
    await player.close();
  },

  'families: the slider is on the stage while another tool is in use, and names with values are behaviours': async (browser) => {
    const { player, members } = await withFamilies(browser);
    const [walk, run] = members;
    await player.run((element) => void element.goTo({ behaviour: 'walk@9' }));
    // Beyond the family its end is taken.
    await goesTo(player, run);
    await arrives(player);
    await player.run((element) => (element.tool = 'place'));
    const slider = player.part('.families.on-stage input');
    await slider.waitFor({ state: 'visible' });
    await player.picture('families-on-stage');
    await slider.focus();
    await player.keyboard.press('ArrowLeft');
    await goesTo(player, walk);
    const outside = await player.run((element) => element.info.sequences.find(({ name }) => name !== 'walk' && name !== 'run').first + 20);
    await player.run((element, frame) => element.seek(frame), outside);
    await player.until('no slider', (element) => element.families[0].value === null && element.shadowRoot.querySelector('.on-stage .family').hidden);
    await player.close();
  },

  'families: what makes no sense of them is no trouble': async (browser) => {
    const { player } = await withFamilies(browser, () => '[{"name": "gait", "members": 7}]');
    assert.deepEqual(await player.run((element) => element.families), []);
    assert.equal(await player.run((element) => element.shadowRoot.querySelectorAll('.family').length), 0);
    await player.close();
  },
};
