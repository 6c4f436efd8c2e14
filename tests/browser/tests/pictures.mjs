/** Pictures of the page for people to look at, in out/: every state, wide and narrow, light and dark. */

import assert from 'node:assert/strict';

const SCREENS = {
  wide: { viewport: { width: 1280, height: 800 } },
  phone: { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true },
};

async function take(browser, screen, colorScheme) {
  const context = { ...SCREENS[screen], colorScheme };
  const name = (state) => `${state}-${screen}-${colorScheme}`;

  const loading = await browser.open({ ...context, search: 'src=slow.reprise' });
  await loading.event('ready');
  await loading.picture(name('loading'));
  await loading.close();

  const player = await browser.open(context);
  await player.loaded();
  await player.run((element) => element.pause());
  await player.until('all thumbnails', (element) => element.testing.thumbnails().complete && element.testing.thumbnails().drawn > 0, null, 120_000);
  await player.picture(name('idle'));
  const frame = await player.target();
  const { x, y } = await player.run((element, wanted) => element.testing.placeOf(wanted), frame);
  await player.mouse.move(x, y);
  await player.page.waitForTimeout(300);
  await player.picture(name('hover'));
  const target = await player.click(frame);
  await player.mouse.move(5, 5);
  await player.until('a transition under way', (element) => element.state.mode === 'synthetic' && element.state.transition.lambda > 0.3);
  await player.run((element) => element.pause());
  await player.picture(name('walking'));
  await player.run((element) => (element.tint = true));
  await player.picture(name('walking-tint'));
  await player.run((element) => {
    element.tint = false;
    element.play();
  });
  await player.event('arrive', 120_000);
  await player.picture(name('arrived'));
  assert.equal((await player.heard('arrive'))[0].frame, target);
  await player.keyboard.press('p');
  await player.keyboard.press('f');
  await player.page.waitForTimeout(800);
  await player.picture(name('poses-facts'));
  await player.close();
}

/** Each tool in use: what is asked, and the answer. */
const ASKED = {
  place: () => ({ place: { x: 1.3, z: 0.9, heading: 2.2 } }),
  path: ({ behaviours }) => ({
    path: {
      points: [[0, 0], [0.5, 1.2], [1.6, 1.7], [2.4, 0.9], [2.2, -0.4], [1.2, -0.9]],
      shape: 'spline',
      stretches: [{ from: 1.6, to: 3.2, behaviour: behaviours.includes('run') ? 'run' : behaviours[0] }],
    },
  }),
  timing: ({ info: { sequences } }) => ({
    keys: { poses: sequences.slice(0, 5).map(({ first, count }, at) => ({ pose: first + Math.floor(count / 2), time: 1.5 + at * 1.75 })) },
  }),
  wander: ({ behaviours }) => ({ wander: { seconds: 60, weights: { [behaviours[0]]: 0.5, [behaviours.at(-1)]: 2.5 } } }),
};

async function takeTools(browser, screen, colorScheme) {
  const player = await browser.open({ ...SCREENS[screen], colorScheme });
  await player.loaded();
  await player.run((element) => {
    element.pause();
    element.seek(element.info.sequences[0].first + 10);
  });
  await player.until('all thumbnails', (element) => element.testing.thumbnails().complete && element.testing.thumbnails().drawn > 0, null, 120_000);
  for (const [tool, target] of Object.entries(ASKED)) {
    await player.run(`(element) => (element.direction = { version: 1, target: (${target})(element) })`);
    await player.until(`an answer for ${tool}`, (element) => element.answer && (!element.testing.search().running || element.answer.path), null, 60_000);
    await player.until('all thumbnails', (element) => element.testing.thumbnails().complete, null, 120_000);
    await player.page.waitForTimeout(1500);
    await player.picture(`tool-${tool}-${screen}-${colorScheme}`);
  }
  await player.run(`(element) => (element.direction = { version: 1, target: (${ASKED.path})(element) })`);
  await player.until('an answer', (element) => element.answer !== null, null, 60_000);
  await player.part('.go').click();
  await player.until('half the way', (element) => element.state.target !== null && element.state.remaining_seconds < element.answer.seconds / 2, null, 120_000);
  await player.run((element) => element.pause());
  await player.page.waitForTimeout(1200);
  await player.picture(`tool-walking-${screen}-${colorScheme}`);
  await player.close();
}

export const tests = Object.fromEntries(
  Object.keys(SCREENS).flatMap((screen) =>
    ['light', 'dark'].flatMap((scheme) => [
      [`pictures: ${screen}, ${scheme}`, (browser) => take(browser, screen, scheme)],
      [`pictures: tools, ${screen}, ${scheme}`, (browser) => takeTools(browser, screen, scheme)],
    ]),
  ),
);
