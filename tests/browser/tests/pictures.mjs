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

export const tests = Object.fromEntries(
  Object.keys(SCREENS).flatMap((screen) =>
    ['light', 'dark'].map((scheme) => [`pictures: ${screen}, ${scheme}`, (browser) => take(browser, screen, scheme)]),
  ),
);
