/** The page of key poses: two actors, pairs between them, keys.toml, transfer.json, and the result. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { bundlePath } from '../browser.mjs';
import { axe } from './tools/common.mjs';

const www = new URL('../../../www/', import.meta.url);
const fixtures = new URL('../fixtures/', import.meta.url);
const { readKeys, writeKeys } = await import(new URL('keys/toml.js', www));
const { check } = await import(new URL('keys/rules.js', www));
const { linearMaps, readTransfer, sourceAt } = await import(new URL('keys/maps.js', www));

const pair = (from, fromFrame, to, toFrame, stretch = null, comments = []) => ({ from, fromFrame, to, toFrame, stretch, comments });

/** What `fixtures/keys.toml` holds; the command's own tests read it, too. */
const WRITTEN = {
  pairs: [
    pair('walk', 3, 'walk', 5, null, [' Right foot lands.']),
    pair('walk', 40, 'walk', 44),
    pair('walk', 77, 'walk', 90),
    pair('turn "left"', 0, 'Drehung \\ links', 4294967295, 'über\tden Zaun'),
    pair("it's", 12, '', 0, "'one'"),
  ],
  tail: [' Nothing after this.'],
};

/** What is refused, with the line that is wrong and what has to be told. */
const REFUSED = [
  ['[[pair]]\nfrm = 3\n', 2, /no “frm”, but: from, from_frame, to, to_frame, stretch/],
  ['[pair]\nfrom = "walk"\n', 1, /\[\[pair\]\] with two brackets/],
  ['[[keys]]\n', 1, /no \[\[keys\]\]; write \[\[pair\]\]/],
  ['# keys\n\nfrom = "walk"\n', 3, /before the first pair/],
  ['[[pair]]\nfrom = walk\n', 2, /put it into quotes/],
  ['[[pair]]\nfrom = "walk\nfrom_frame = 3\n', 2, /quote " is missing/],
  ['[[pair]]\nfrom = """walk"""\n', 2, /triple quotes/],
  ['[[pair]]\nfrom = "w\\alk"\n', 2, /\\a means nothing/],
  ['pair = [{ from = "a" to = "b" }]', 1, /a comma or } is missing/],
  ['pair = [{ , }]', 1, /is no entry/],
  ['[[pair]]\nfrom_frame = 3.0\n', 2, /whole number from 0, not 3\.0/],
  ['[[pair]]\nfrom_frame = -3\n', 2, /whole number from 0, not -3/],
  ['[[pair]]\nfrom_frame = 03\n', 2, /not 03/],
  ['[[pair]]\nfrom_frame = "3"\n', 2, /without quotes/],
  ['[[pair]]\nto_frame = 4294967296\n', 2, /whole number/],
  ['[[pair]]\nto_frame = 4 to = "walk"\n', 2, /line of its own/],
  ['[[pair]]\nfrom = "walk"\nfrom = "run"\n', 3, /“from” is given twice/],
  ['[[pair]]\nfrom.name = "walk"\n', 2, /dot/],
  ['[[pair]]\nfrom "walk"\n', 2, /= is missing/],
  ['[[pair]]\nfrom = "a"\nfrom_frame = 1\nto = "b"\n\n[[pair]]\n', 1, /no “to_frame”; add to_frame = /],
  ['pair = [{ from = "a", from_frame = 1, to = "b", to_frame = 2 }]\n[[pair]]\n', 2, /one list/],
  ['pair = { from = "a" }\n', 1, /a list of tables/],
  ['[[pair]]\nfrom = "a\u0007"\n', 2, /control character/],
];

/** Opens the page; with actors, waits for both. */
async function opened(browser, search = 'from=demo.reprise&to=demo.reprise', options = {}) {
  const page = await browser.open({ viewport: { width: 1100, height: 1000 }, ...options, path: 'keys.html', search });
  if (search.includes('from=')) await actors(page, 2);
  return page;
}

function actors(page, count) {
  return page.until('all actors', (_, wanted) => [...document.querySelectorAll('reprise-player')].filter((one) => one.complete && one.testing?.stage).length === wanted, count);
}

/** The whole frames that source and target show, counted in their sequences, and as their rulers have it. */
function shown(page) {
  return page.page.evaluate(() => {
    const rulers = [...document.querySelectorAll('.lane')].map((lane) => Number(lane.getAttribute('aria-valuenow')));
    const frames = ['#source', '#target'].map((id) => {
      const player = document.querySelector(`${id} reprise-player`);
      return player.state.frame - player.info.sequences.find(({ first, count }) => player.state.frame >= first && player.state.frame < first + count).first;
    });
    return { rulers, frames };
  });
}

const lane = (page, which) => page.page.locator(`.of-${which} .lane`);

/** Scrubs a ruler to a frame with the mouse: down beside it, and dragged there. */
async function scrub(page, which, frame) {
  const { x, y, width, height } = await lane(page, which).boundingBox();
  const last = Number(await lane(page, which).getAttribute('aria-valuemax'));
  const at = (wanted) => [x + (width * wanted) / last, y + height / 2];
  await page.mouse.move(...at(frame > 5 ? frame - 5 : frame + 5));
  await page.mouse.down();
  await page.mouse.move(...at(frame), { steps: 3 });
  await page.mouse.up();
}

const rows = (page) => page.page.locator('tbody tr').evaluateAll((all) => all.map((row) => [...row.cells].slice(0, 5).map((cell) => cell.querySelector('input')?.value ?? cell.textContent)));
const told = (page) => page.page.locator('.say').textContent();
const findings = (page) => page.page.locator('#pairs .findings li').allTextContents();

/** Drops files onto a part of the page. */
function drop(page, selector, name, bytes) {
  return page.page.evaluate(([where, called, content]) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([Uint8Array.from(atob(content), (sign) => sign.charCodeAt(0))], called));
    document.querySelector(where).dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, composed: true, dataTransfer }));
  }, [selector, name, Buffer.from(bytes).toString('base64')]);
}

export const tests = {
  'key poses: keys.toml is written as the command reads it, and read again': async () => {
    const text = writeKeys(WRITTEN);
    assert.equal(text, await readFile(new URL('keys.toml', fixtures), 'utf8'));
    assert.deepEqual(readKeys(text), WRITTEN);
    assert.deepEqual(readKeys(''), { pairs: [], tail: [] });
    assert.equal(writeKeys({ pairs: [] }), '');
  },

  'key poses: keys.toml is read as others write it': () => {
    const one = pair('walk', 3, 'run', 5);
    const forms = [
      "[[pair]]\r\nfrom='walk'\r\nfrom_frame=3\r\nto='run'\r\nto_frame=5",
      '\ufeff[[ pair ]]\n\t"to" = "run"\n  to_frame = +5\nfrom = "w\\u0061lk"\n\'from_frame\' = 0x03\n',
      'pair = [\n { from = "walk", from_frame = 3, to = "run", to_frame = 0b101 },\n]\n',
      'pair = [ {\n from = "walk", from_frame = 3,\n to = "\\x72un", to_frame = 5, } ]',
      '"pair" = [{from="walk",from_frame=3,to="run",to_frame=0o5}]',
    ];
    for (const text of forms) assert.deepEqual(readKeys(text).pairs, [one], text);
    const noted = '# first\n[[pair]] # a\n# b\nfrom = "walk" # c\nfrom_frame = 1_000\nto = "run"\nto_frame = 5\n# second\n[[pair]]\nfrom = "a"\nfrom_frame = 0\nto = "b"\nto_frame = 0\n#last';
    const read = readKeys(noted);
    assert.deepEqual(read.pairs.map(({ comments }) => comments), [[' first', ' a', ' b', ' c'], [' second']]);
    assert.deepEqual([read.tail, read.pairs[0].fromFrame], [['last'], 1000]);
    assert.deepEqual(readKeys(writeKeys(read)), read);
  },

  'key poses: what keys.toml cannot be is refused with its line and a remedy': () => {
    for (const [text, line, words] of REFUSED) {
      assert.throws(() => readKeys(text), (error) => error.line === line && words.test(error.message) && error.message.startsWith(`line ${line}: `), text);
    }
  },

  'key poses: rules are those of the command': () => {
    const info = (fps) => ({ fps, sequences: [{ name: 'walk', count: 200 }] });
    const wrong = (pairs, ...fps) => check(pairs, ...(fps.length > 0 ? fps.map(info) : [null, null])).filter(({ kind }) => kind === 'wrong').map(({ text }) => text);
    const walk = (from, to, stretch) => pair('walk', from, 'walk', to, stretch);
    assert.deepEqual(wrong([walk(0, 0), walk(20, 10), walk(30, 40)], 25, 25), []);
    assert.match(wrong([walk(0, 0), walk(20, 10), walk(10, 40)])[0], /walk 20 → walk 10 and walk 10 → walk 40 contradict/);
    assert.match(wrong([walk(0, 10), walk(20, 10)])[0], /contradict/);
    assert.deepEqual(wrong([walk(0, 0), walk(20, 10), walk(10, 40, 'b')]), []);
    // Nine rows and three columns have a way, as the command's own test says, thirty rows have none.
    assert.deepEqual(wrong([walk(0, 0), walk(8, 2)], 25, 25), []);
    assert.match(wrong([walk(0, 0), walk(29, 2)], 25, 25)[0], /Between walk 0 → walk 0 and walk 29 → walk 2 the source is more than four times/);
    assert.match(wrong([walk(0, 0), walk(2, 12)], 25, 25)[0], /the target is more than four times/);
    // A run that goes on over a key is as long as one that does not.
    assert.equal(wrong([walk(0, 0), walk(1, 4), walk(2, 11)], 25, 25).length, 0);
    assert.equal(wrong([walk(0, 0), walk(1, 7), walk(2, 11)], 25, 25).length, 0);
    assert.match(wrong([walk(0, 0), walk(1, 7), walk(2, 12)], 25, 25)[0], /Between walk 0 → walk 0 and walk 1 → walk 7 the target/);
    // Time counts, not frames: the target has twice as many a second.
    assert.equal(wrong([walk(0, 0), walk(2, 18)], 25, 50).length, 0);
    assert.match(wrong([walk(0, 0), walk(10, 200)], 25, 25)[0], /no frame 200, but 0 to 199/);
    assert.match(wrong([pair('fly', 0, 'walk', 0)], 25, 25)[0], /the source has no sequence “fly”; it has: walk/);
    assert.match(check([walk(0, 0)], null, null)[0].text, /1 key: at least 3/);
  },

  'key poses: maps are straight between keys, and read from transfer.json': async () => {
    const [map] = linearMaps([pair('a', 20, 'b', 10), pair('a', 0, 'b', 0), pair('a', 25, 'b', 20), pair('a', 3, 'b', 3, 'alone')]);
    assert.deepEqual([map.fromFirst, map.fromLast, map.toFirst, map.toLast, map.path.length], [0, 25, 0, 20, 21]);
    assert.deepEqual([sourceAt(map, 5), sourceAt(map, 15), sourceAt(map, 99), sourceAt(map, -1)], [10, 22.5, 25, 0]);
    const text = await readFile(new URL('transfer.json', fixtures), 'utf8');
    const transfer = readTransfer(text);
    assert.ok(transfer.maps.length > 0 && transfer.fits(transfer.pairs) && !transfer.fits(transfer.pairs.slice(1)));
    for (const broken of ['{', 'null', '[]', '{"sequences":[]}', '{"sequences":[],"maps":[{}]}', text.replace(/"rows": \d+/, '"rows": 3')]) {
      assert.throws(() => readTransfer(broken), /transfer|JSON/, broken.slice(0, 40));
    }
  },

  'key poses: pairs are made by mouse and keys, moved, undone, and saved': async (browser) => {
    const page = await opened(browser);
    await page.page.selectOption('#source select', 'walk');
    await page.page.selectOption('#target select', 'walk');
    // With the mouse: scrubbed, and the button.
    await scrub(page, 'source', 20);
    await scrub(page, 'target', 30);
    assert.deepEqual(await shown(page), { rulers: [20, 30], frames: [20, 30] });
    await page.page.getByRole('button', { name: 'Match', exact: true }).click();
    // With keys alone.
    await lane(page, 'source').focus();
    await page.keyboard.press('Home');
    for (const key of ['ArrowRight', 'ArrowRight', 'ArrowLeft']) await page.keyboard.press(key);
    await lane(page, 'target').focus();
    await page.keyboard.press('Home');
    for (const key of ['PageUp', 'ArrowLeft', 'ArrowRight']) await page.keyboard.press(key);
    assert.deepEqual(await shown(page), { rulers: [1, 10], frames: [1, 10] });
    await page.keyboard.press('m');
    for (const key of ['Shift+D', 'Shift+D', 'Shift+D', 'a', 'Shift+L', 'Shift+L', 'Shift+L', 'Shift+L', 'j']) await page.keyboard.press(key);
    await page.keyboard.press('m');
    assert.deepEqual(await rows(page), [['walk', '1', 'walk', '10', ''], ['walk', '20', 'walk', '30', ''], ['walk', '30', 'walk', '49', '']]);
    assert.deepEqual(await findings(page), []);
    assert.equal(await page.page.locator('.links g').count(), 3);
    const line = await page.page.locator('.links g').first().locator('.grip').boundingBox();
    await page.mouse.click(line.x + line.width / 2, line.y + line.height / 2);
    assert.deepEqual([await page.page.locator('tbody tr[data-chosen] input').first().inputValue(), (await shown(page)).frames], ['1', [1, 10]]);
    await page.keyboard.press('n');
    await page.keyboard.press('n');
    assert.deepEqual((await shown(page)).frames, [30, 49]);
    await page.keyboard.press('m');
    assert.match(await told(page), /matched already/);

    // An end dragged, and another moved by keys: what is wrong is said with both keys.
    const end = page.page.locator('.of-source .end[data-chosen]');
    const box = await end.boundingBox();
    const { x, width } = await lane(page, 'source').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(x + (width * 15) / 157, box.y + 5, { steps: 4 });
    await page.mouse.up();
    assert.deepEqual((await rows(page))[2], ['walk', '15', 'walk', '49', '']);
    assert.match((await findings(page))[0], /walk 20 → walk 30 and walk 15 → walk 49 contradict each other: time must go on/);
    assert.equal(await page.page.locator('.links g[data-wrong]').count(), 2);
    assert.deepEqual((await shown(page)).frames, [15, 49]);
    await page.keyboard.press('Control+z');
    assert.deepEqual((await rows(page))[2], ['walk', '30', 'walk', '49', '']);
    await page.page.locator('.of-target .end[data-chosen]').focus();
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('Shift+ArrowLeft');
    assert.deepEqual((await rows(page))[2], ['walk', '30', 'walk', '38', '']);
    assert.deepEqual(await findings(page), []);
    await page.keyboard.press('Delete');
    assert.equal((await rows(page)).length, 2);
    assert.match((await findings(page))[0], /2 keys: at least 3/);
    await page.keyboard.press('Control+z');
    await page.keyboard.press('p');
    await page.keyboard.press('p');
    assert.deepEqual((await shown(page)).frames, [1, 10]);
    await page.page.locator('tbody tr').nth(1).locator('input').last().fill('a "stretch"');
    await page.keyboard.press('Enter');

    // Written, and read again.
    const download = page.page.waitForEvent('download');
    await page.page.getByRole('button', { name: 'Save keys.toml' }).click();
    const text = await readFile(await (await download).path(), 'utf8');
    const expected = [pair('walk', 1, 'walk', 10), pair('walk', 20, 'walk', 30, 'a "stretch"'), pair('walk', 30, 'walk', 38)];
    assert.deepEqual(readKeys(text).pairs, expected);
    for (let at = 0; at < 3; at += 1) await page.page.locator('tbody tr').first().getByRole('button').click();
    assert.equal((await rows(page)).length, 0);
    await drop(page, '#source reprise-player', 'keys.toml', text);
    await page.until('the pairs', () => document.querySelectorAll('tbody tr').length === 3);
    assert.deepEqual(await rows(page), [['walk', '1', 'walk', '10', ''], ['walk', '20', 'walk', '30', 'a "stretch"'], ['walk', '30', 'walk', '38', '']]);
    await drop(page, 'main', 'keys.toml', `${text}\nstretch = 3`);
    await page.until('the error', () => /line 20: “stretch” is a name; put it into quotes/.test(document.querySelector('.say').textContent));
    assert.equal((await rows(page)).length, 3, 'what cannot be read changes nothing');
    await page.close();
  },

  'key poses: what transfer.json tells is drawn, and a click on it shows both frames': async (browser) => {
    const page = await opened(browser);
    assert.match(await page.page.locator('#map .quiet').textContent(), /There is no map|there is no map/);
    assert.equal(await page.page.locator('.matrix').isVisible(), false);
    await drop(page, 'main', 'transfer.json', await readFile(new URL('transfer.json', fixtures)));
    await page.until('the matrix', () => !document.querySelector('.matrix').hidden);
    assert.match(await page.page.locator('#map .quiet').textContent(), /As builder transfer has found it/);
    const { maps: [map], pairs } = readTransfer(await readFile(new URL('transfer.json', fixtures), 'utf8'));
    assert.equal((await rows(page)).length, pairs.length, 'its keys are taken where there are none');
    await page.frames(3);
    const canvas = page.page.locator('.matrix canvas');
    const colours = await canvas.evaluate((one) => {
      const { data } = one.getContext('2d').getImageData(0, 0, one.width, one.height);
      return new Set(Array.from({ length: data.length / 4 }, (_, at) => data.slice(4 * at, 4 * at + 3).join())).size;
    });
    assert.ok(colours > 40, `costs are greys: ${colours} colours`);
    await axe(page, 'key poses with a map');
    await canvas.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await canvas.boundingBox();
    // The first keys are at the lower left, the last at the upper right, within the axes.
    await page.mouse.click(x + 53, y + height - 41);
    assert.deepEqual((await shown(page)).frames, [map.fromFirst, map.toFirst]);
    await page.mouse.click(x + width - 13, y + 11);
    assert.deepEqual((await shown(page)).frames, [map.fromLast, map.toLast]);
    await canvas.focus();
    await page.keyboard.press('Shift+ArrowLeft');
    const { rulers } = await shown(page);
    assert.deepEqual(rulers, [Math.round(sourceAt(map, map.toLast - 10)), map.toLast - 10]);
    // Played at matched frames.
    await page.keyboard.press('Space');
    await page.until('matched playing', (_, last) => {
      const [, to] = [...document.querySelectorAll('.lane')].map((one) => Number(one.getAttribute('aria-valuenow')));
      return to !== last - 10;
    }, map.toLast);
    await page.keyboard.press('Space');
    const after = await shown(page);
    assert.ok(Math.abs(after.rulers[0] - sourceAt(map, after.rulers[1])) <= 1.5, after.rulers.join());
    assert.equal(await page.page.getByRole('button', { name: 'Play matched' }).isVisible(), true);
    // Other keys: the map is not theirs any more.
    await page.page.locator('tbody tr').first().getByRole('button').click();
    assert.match(await page.page.locator('#map .quiet').textContent(), /no longer those/);
    await drop(page, 'main', 'transfer.json', '{"sequences": []}');
    await page.until('a sentence', () => /older builder/.test(document.querySelector('.say').textContent));
    await page.close();
  },

  'key poses: actors are opened from files, and the result moves in step': async (browser) => {
    const page = await opened(browser, 'none');
    assert.equal(await page.page.getByRole('button', { name: 'Match', exact: true }).isDisabled(), true);
    // The result before the source, to see that neither waits for the other in vain.
    for (const [which, count] of [['result', 1], ['source', 2]]) {
      const chooser = page.page.waitForEvent('filechooser');
      await page.page.getByRole('button', { name: `Open the ${which}` }).click();
      await (await chooser).setFiles(bundlePath);
      await actors(page, count);
      const sentence = await page.page.locator('.result-bar .quiet').textContent();
      assert.match(sentence, count === 1 ? /Open the source, too/ : /“idle” does what “idle” of the source does/);
      assert.equal(await page.page.getByRole('button', { name: 'Play in step' }).isDisabled(), count === 1);
    }
    await page.page.selectOption('#source select', 'walk');
    await lane(page, 'source').focus();
    for (const key of ['PageUp', 'ArrowRight', 'ArrowRight']) await page.keyboard.press(key);
    await page.page.selectOption('#result select', 'run');
    const both = () => page.page.evaluate(() => ['#source', '#result'].map((id) => {
      const { state, info } = document.querySelector(`${id} reprise-player`);
      const { name, first } = info.sequences.find((one) => state.frame >= one.first && state.frame < one.first + one.count);
      return [name, Math.round(state.frame - first)];
    }));
    assert.deepEqual(await both(), [['run', 0], ['run', 0]], 'a sequence of the result shows where it comes from');
    await page.page.getByRole('button', { name: 'Play in step' }).click();
    await page.until('playing', () => document.querySelector('#result reprise-player').state.frame > document.querySelector('#result reprise-player').info.sequences.find(({ name }) => name === 'run').first + 3);
    await page.page.locator('#result').getByRole('button', { name: 'Pause' }).click();
    const [[, from], [, to]] = await both();
    assert.ok(Math.abs(from - to) <= 1 && from > 0, `${from} ${to}`);
    await drop(page, '#target', 'notes.txt', 'hello');
    assert.match(await told(page), /reads \.reprise files, keys\.toml and transfer\.json/);
    await drop(page, '#target', 'broken.reprise', 'This is a letter, not an actor.');
    await page.until('a sentence', () => /^Target: /.test(document.querySelector('.say').textContent));
    await page.close();
  },

  'key poses: fits a phone, by touch, and everything has a name': async (browser) => {
    const page = await opened(browser, undefined, { viewport: { width: 390, height: 844 }, deviceScaleFactor: 1, hasTouch: true, isMobile: true });
    await lane(page, 'source').scrollIntoViewIfNeeded();
    const { x, y, width, height } = await lane(page, 'source').boundingBox();
    await page.page.touchscreen.tap(x + width / 2, y + height / 2);
    assert.deepEqual((await shown(page)).rulers, [55, 0]);
    await page.page.getByRole('button', { name: 'Match', exact: true }).tap();
    assert.equal((await rows(page)).length, 1);
    assert.ok((await page.page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
    await axe(page, 'key poses on a phone');
    await page.close();
  },
};
