/**
 * Pictures of the page for people to look at, in out/: every state, wide and narrow, in one theme, and those that show the
 * most in the other theme, too. One page for each screen: what takes long is loading and drawing in software.
 */

import assert from 'node:assert/strict';

const SCREENS = {
  wide: { context: { viewport: { width: 1280, height: 800 } }, themes: ['light', 'dark'], asked: ['place', 'air', 'timing', 'wander', 'path'] },
  phone: { context: { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true }, themes: ['dark', 'light'], asked: ['timing', 'path'] },
};

/** Each tool in use: what is asked. Narrow screens show those that are laid out in another way there. */
const ASKED = {
  place: () => ({ place: { x: 1.3, z: 0.9, heading: 2.2 } }),
  air: () => ({ path: { points: [[0, 0.9, 0], [0.5, 0.8, 1.2], [1.6, 1.4, 1.7], [2.4, 0.9, 0.9]], shape: 'spline' } }),
  timing: ({ info: { sequences } }) => ({
    keys: { poses: sequences.slice(0, 5).map(({ first, count }, at) => ({ pose: first + Math.floor(count / 2), time: 1.5 + at * 1.75 })) },
  }),
  wander: ({ behaviours }) => ({ wander: { seconds: 60, weights: { [behaviours[0]]: 0.5, [behaviours.at(-1)]: 2.5 } } }),
  path: ({ behaviours }) => ({
    path: {
      points: [[0, 0], [0.5, 1.2], [1.6, 1.7], [2.4, 0.9], [2.2, -0.4], [1.2, -0.9]],
      shape: 'spline',
      stretches: [{ from: 1.6, to: 3.2, behaviour: behaviours.includes('run') ? 'run' : behaviours[0] }],
    },
  }),
};

/** Opens the page and goes through the states before the tools. */
async function take(browser, screen) {
  const { context, themes, asked } = SCREENS[screen];
  const player = await browser.open({ ...context, colorScheme: themes[0], search: 'src=half.reprise' });
  const album = {
    one: (state, theme = themes[0]) => player.picture(`${state}-${screen}-${theme}`),
    both: async (state) => {
      await album.one(state);
      await player.page.emulateMedia({ colorScheme: themes[1] });
      await album.one(state, themes[1]);
      await player.page.emulateMedia({ colorScheme: themes[0] });
    },
  };
  await player.event('ready');
  await album.one('loading');
  await player.page.evaluate(() => fetch('/rest'));
  await player.loaded();
  await player.run((element) => {
    element.pause();
    element.seek(element.info.sequences[0].first + 10);
  });
  await settled(player);
  await album.both('idle');
  await walk(player, album);
  await queue(player, album);
  await tools(player, album, asked);
  await player.close();
}

function settled(player) {
  return player.until('all thumbnails', ({ testing }) => testing.thumbnails().complete && testing.thumbnails().drawn > 0);
}

async function walk(player, album) {
  const frame = await player.target();
  const { x, y } = await player.run((element, wanted) => element.testing.placeOf(wanted), frame);
  await player.mouse.move(x, y);
  await player.until('the ghost', (element) => element.testing.ghosts().length === 1);
  await album.one('hover');
  // Slowly: what draws in software must not miss the transition.
  await player.run((element) => (element.speed = 0.2));
  const target = await player.click(frame);
  await player.mouse.move(5, 5);
  await player.until('a transition under way', (element) => element.state.mode === 'synthetic' && element.state.transition.lambda > 0.3);
  await player.run((element) => element.pause());
  await album.both('walking');
  await player.run((element) => (element.tint = true));
  await album.one('walking-tint');
  await player.run((element) => {
    element.tint = false;
    element.speed = 1;
    element.play();
  });
  await player.event('arrive');
  await album.one('arrived');
  assert.equal((await player.heard('arrive'))[0].frame, target);
  await player.keyboard.press('p');
  await player.keyboard.press('f');
  await player.until('poses around the actor', (element) => element.testing.ghosts().length > 0);
  await album.one('poses-facts');
  await player.keyboard.press('p');
  await player.keyboard.press('f');
}

/** A behaviour that is held, and what comes after it. */
async function queue(player, album) {
  await player.part('.pose-dock .chip').last().scrollIntoViewIfNeeded();
  await player.part('[aria-label="Behaviours"] .chip').last().click();
  await player.untilFound('the way', (element) => element.state.target !== null);
  await player.run((element) => {
    element.pause();
    element.queue(...element.info.sequences.slice(1, 3).map(({ name }) => ({ behaviour: name, hold: 3 })), 20);
  });
  await album.one('queue');
  await player.run((element) => {
    element.cancel();
    element.seek(element.info.sequences[0].first + 10);
  });
}

async function tools(player, album, asked) {
  for (const tool of asked) {
    const target = ASKED[tool];
    // From the same place each time, so that the pictures can be compared with older ones.
    await player.run(`(element) => {
      const start = { frame: element.info.sequences[0].first + 10, placement: [0, 0, 0] };
      element.direction = { request: { version: 1, target: (${target})(element) }, start };
    }`);
    await player.untilFound(`an answer for ${tool}`, (element) => element.answer && (!element.testing.search().running || element.answer.path));
    await settled(player);
    if (tool === 'path') await album.both('tool-path');
    else await album.one(`tool-${tool}`);
  }
  await player.part('.share > button').click();
  await album.one('share');
  await player.keyboard.press('Escape');
  await player.part('.go').click();
  await player.untilFound('the actor on its way', (element) => element.state.target !== null);
  // Without drawing all of it.
  await player.run((element) => {
    for (let tick = 0; tick < 200 && element.state.remaining_seconds > element.answer.seconds / 2; tick += 1) element.testing.tick(0.1);
    element.pause();
  });
  await album.one('tool-walking');
  await player.keyboard.press('?');
  await album.one('keys');
}

export const tests = Object.fromEntries(Object.keys(SCREENS).map((screen) => [`pictures: ${screen}`, (browser) => take(browser, screen)]));
