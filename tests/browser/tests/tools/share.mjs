/** Links and files with what is asked. */

import assert from 'node:assert/strict';
import { WIDE, LINE, using, asked, drag, found } from './common.mjs';

export const tests = {
  'what is asked can be passed on as a link': async (browser) => {
    const player = await using(browser, 'path');
    await drag(player, LINE);
    const { link, direction, answer } = { answer: await found(player), ...(await player.run(({ link: hash, direction: request }) => ({ link: hash, direction: request }))) };
    await player.close();
    assert.match(link, /^#direction=[\w-]+$/);
    const other = await browser.open({ ...WIDE, hash: link });
    await other.loaded();
    await other.until('the direction', (element) => element.direction !== null);
    assert.equal(await other.run((element) => element.tool), 'path');
    assert.deepEqual((await asked(other)).target.path.points, direction.target.path.points);
    const again = await found(other);
    assert.deepEqual(again.start.frame, answer.start.frame);
    await other.close();
  },

  'links that are damaged say so, in a sentence': async (browser) => {
    const encode = (value) => `#direction=${Buffer.from(typeof value === 'string' ? value : JSON.stringify(value)).toString('base64url')}`;
    const path = (points, more = {}) => ({ version: 1, target: { path: { points, ...more } } });
    const links = {
      'no base64': '#direction=%%%',
      'no UTF-8': `#direction=${Buffer.from([0xff, 0xfe, 0x80]).toString('base64url')}`,
      'no JSON': encode('{"version":1'),
      'null': encode('null'),
      'a number': encode('7'),
      'a list': encode([]),
      'another version': encode({ version: 99, target: {} }),
      'no target': encode({ version: 1 }),
      'an unknown target': encode({ version: 1, target: { fly: {} } }),
      'a path without points': encode(path([])),
      'a path without length': encode(path([[0, 0], [0, 0]])),
      'a path with words': encode(path([['a', 0], [1, 1]])),
      'a path beyond the world': encode(path([[0, 0], [1e9, 0]])),
      'a path of nulls': encode(path([[null, null], [1, 1]])),
      'too many points': encode(path(Array.from({ length: 5000 }, (_, at) => [at * 0.01, 0]))),
      'a queue of nothing': encode({ version: 1, target: { queue: [] } }),
      'a wrapped nothing': encode({ request: null, start: { frame: 'x' } }),
    };
    const player = await using(browser, 'pose');
    // Before the module that searches is there, what is wrong is said as soon as it comes.
    await player.run((element, address) => element.openLink(address), links['a path without length']);
    await player.untilFound('a sentence on the path', (element) => /no length/.test(element.shadowRoot.querySelector('.status').textContent));
    await player.run((element) => element.testing.searching().then(() => null));
    for (const [name, link] of Object.entries(links)) {
      await player.run((element) => element.seek(5));
      const used = await player.run((element, address) => element.openLink(address), link);
      assert.equal(used, false, name);
      assert.ok((await player.part('.status').textContent()).length > 15, `${name}: nothing is said`);
      assert.equal(await player.part('.error').isVisible(), false, name);
    }
    // What can only be found out by searching is said by the search.
    for (const [name, target] of Object.entries({
      'an unknown behaviour': { path: { points: [[0, 0], [1, 1]], stretches: [{ from: 0, to: 1, behaviour: 'flying' }] } },
      'an unknown frame': { keys: { poses: [{ pose: 999999, time: 1 }] } },
      'a weight of nobody': { wander: { seconds: 10, weights: { nobody: 2 } } },
    })) {
      await player.run((element, request) => (element.direction = request), { version: 1, target });
      await player.untilFound(`a sentence on ${name}`, (element) => /no (behaviour|frame)/.test(element.shadowRoot.querySelector('.outcome')?.textContent ?? ''));
      assert.equal(await player.part('.error').isVisible(), false, name);
    }
    // Vertices that there are not, and paths that different vertices are to follow.
    const along = (vertices) => ({ path: { points: [[0, 0], [1, 1]], vertices } });
    await player.run((element, target) => (element.direction = { version: 1, target }), along([1, 999999]));
    await player.untilFound('a sentence on the vertex', (element) => /no vertex 999999/.test(element.shadowRoot.querySelector('.outcome')?.textContent ?? ''));
    await player.run((element, target) => (element.direction = { version: 1, target }), { queue: [along([1, 2, 3]), along([])] });
    await player.untilFound('a sentence on groups', (element) => /followed by the same ones/.test(element.shadowRoot.querySelector('.status').textContent));
    assert.equal((await player.heard('error')).length, 0);
    await player.close();
  },

  'what is asked and its answer are saved and load again': async (browser) => {
    const player = await using(browser, 'timing');
    await player.part('.pose').nth(2).click();
    await found(player);
    const direction = await asked(player);
    const open = () => player.part('.share > button').click();
    await open();
    const download = player.page.waitForEvent('download');
    download.catch(() => {});
    await player.part('.menu .chip').filter({ hasText: 'Save' }).click();
    const path = await (await download).path();
    await player.part('.chip').filter({ hasText: 'Clear' }).click();
    assert.equal(await asked(player), null);
    await player.part('input[accept*="json"]').setInputFiles({ name: 'a.json', mimeType: 'application/json', buffer: await (await import('node:fs/promises')).readFile(path) });
    await player.until('the direction', (element) => element.direction !== null);
    assert.deepEqual((await asked(player)).target, direction.target);
    await player.part('input[accept*="json"]').setInputFiles({ name: 'b.json', mimeType: 'application/json', buffer: Buffer.from('not JSON') });
    await player.until('a sentence', (element) => /no JSON/.test(element.shadowRoot.querySelector('.status').textContent));
    assert.deepEqual((await asked(player)).target, direction.target);
    await player.close();
  },
};
