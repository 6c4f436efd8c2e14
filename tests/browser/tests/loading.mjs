/** From the address to the first picture. */

import assert from 'node:assert/strict';

export const tests = {
  'loads and draws the first frame': async (browser) => {
    const player = await browser.open();
    await player.loaded();
    const picture = await player.run((element) => element.testing.picture());
    assert.equal(picture.bytes, picture.width * picture.height * 4);
    assert.ok(picture.drawn > 0.01, `only ${picture.drawn} of the picture is not background`);
    assert.equal(await player.run((element) => element.testing.lost()), false);
    const info = await player.run((element) => element.info);
    assert.ok(info.frames > 0 && info.sequences.length > 0);
    assert.equal(await player.page.locator('#actor').textContent(), info.name);
    assert.deepEqual(await player.heard('error'), []);
    assert.deepEqual(await player.heard('devicelost'), []);
    await player.close();
  },

  'tells how far the loading is, and shows the first pose before the rest has come': async (browser) => {
    const player = await browser.open({ search: 'src=half.reprise' });
    await player.event('ready');
    assert.equal(await player.run((element) => element.complete), false, 'the first pose came with the last byte');
    assert.match(await player.part('.figures').textContent(), /^\d+\.\d of \d+\.\d MB$/);
    await player.page.evaluate(() => fetch('/rest'));
    await player.event('load');
    assert.equal(await player.part('.progress').isVisible(), false);
    const progress = await player.heard('progress');
    assert.ok(progress.length > 2);
    progress.slice(1).forEach(({ loaded }, at) => assert.ok(loaded > progress[at].loaded));
    assert.equal(progress.at(-1).loaded, progress.at(-1).total);
    await player.close();
  },

  'draws a thumbnail for every place on the strips': async (browser) => {
    const player = await browser.open();
    await player.loaded();
    await player.until('all thumbnails', (element) => element.testing.thumbnails().complete && element.testing.thumbnails().drawn > 0);
    const { strips, drawn } = await player.run((element) => {
      const films = [...element.shadowRoot.querySelectorAll('.strip canvas')];
      const inked = films.map((film) => film.getContext('2d').getImageData(0, 0, film.width, film.height).data.some((value) => value > 0));
      return { strips: films.length, drawn: inked.filter(Boolean).length };
    });
    assert.equal(strips, await player.run((element) => element.info.sequences.length));
    assert.equal(drawn, strips);
    await player.close();
  },

  'draws nothing while nothing changes': async (browser) => {
    const player = await browser.open();
    await player.loaded();
    await player.until('all thumbnails', (element) => element.testing.thumbnails().complete && element.testing.thumbnails().drawn > 0);
    await player.run((element) => element.pause());
    await player.until('rest', (element) => element.testing.rests());
    await player.run((element) => {
      window.draws = 0;
      const { stage } = element.testing;
      const { draw } = stage;
      stage.draw = function (...values) {
        window.draws += 1;
        return draw.apply(this, values);
      };
    });
    await player.frames(40);
    assert.equal(await player.run(() => window.draws), 0);
    await player.run((element) => element.seek(element.info.sequences[0].first + 1));
    await player.until('a picture', () => window.draws > 0);
    await player.close();
  },

  'taking the element out and in again loads it again': async (browser) => {
    const player = await browser.open();
    await player.loaded();
    await player.run(async (element) => {
      const { parentNode } = element;
      element.remove();
      await new Promise((resolve) => requestAnimationFrame(resolve));
      window.heard.length = 0;
      parentNode.append(element);
    });
    await player.loaded();
    const picture = await player.run((element) => element.testing.picture());
    assert.ok(picture.drawn > 0.01);
    await player.close();
  },
};
