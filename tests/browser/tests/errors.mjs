/** Everything that can go wrong on the way: a sentence, advice and a button; never a blank canvas. */

import assert from 'node:assert/strict';

/** Opens the page, waits for the error, and checks what the page says. */
async function fails(browser, kind, happened, options = {}) {
  const player = await browser.open(options);
  await options.meanwhile?.(player);
  await player.event('error');
  const [{ kind: reported }] = await player.heard('error');
  assert.equal(reported, kind);
  assert.equal(await player.part('.error').isVisible(), true);
  assert.match(await player.part('.error .happened').textContent(), happened);
  assert.ok((await player.part('.error .todo').textContent()).length > 10);
  assert.equal(await player.part('.error button').isVisible(), true);
  await player.picture(`error-${options.name ?? kind}`);
  return player;
}

const wide = { viewport: { width: 1280, height: 800 } };
const missing = [/Failed to load resource/];

/** What a busy page has not read yet would be lost with the line: that goes dead once something has come. */
async function breakOff(player) {
  await player.event('progress');
  await player.page.evaluate(() => fetch('/rest'));
}

export const tests = {
  'a damaged actor': async (browser) => {
    const player = await fails(browser, 'damaged', /damaged/, { ...wide, search: 'src=faults/damaged.reprise' });
    await player.close();
  },

  'an actor damaged at its beginning': async (browser) => {
    const player = await fails(browser, 'damaged', /damaged/, { ...wide, search: 'src=faults/damaged-early.reprise', name: 'damaged-early' });
    await player.close();
  },

  'an actor that ends too early keeps what has come': async (browser) => {
    const player = await fails(browser, 'truncated', /too early/, { ...wide, search: 'src=faults/truncated.reprise' });
    await player.event('ready');
    assert.notEqual(await player.part('.error').getAttribute('data-over'), null);
    await player.picture('error-truncated');
    const picture = await player.run((element) => element.testing.picture());
    assert.ok(picture.drawn > 0.01);
    await player.close();
  },

  'an actor of a few bytes': async (browser) => {
    const player = await fails(browser, 'truncated', /too early/, { ...wide, search: 'src=faults/truncated-early.reprise', name: 'truncated-early' });
    await player.close();
  },

  'an actor of a later version': async (browser) => {
    const player = await fails(browser, 'too-new', /newer Reprise/, { ...wide, search: 'src=faults/too-new.reprise' });
    await player.close();
  },

  'a file that is no actor': async (browser) => {
    const player = await fails(browser, 'not-reprise', /not a Reprise actor/, { ...wide, search: 'src=faults/not-reprise.reprise' });
    await player.close();
  },

  'no such file, and the way back to the demo': async (browser) => {
    const player = await fails(browser, 'not-found', /no actor at this address/, { ...wide, search: 'src=nowhere.reprise', forgive: missing });
    await player.page.locator('#demo').click();
    await player.page.waitForURL((url) => !url.searchParams.has('src'));
    await player.event('ready');
    await player.close();
  },

  'a connection that breaks off': async (browser) => {
    const player = await fails(browser, 'network', /could not be fetched/, { ...wide, search: 'src=faults/broken-off.reprise', forgive: missing, meanwhile: breakOff });
    await player.close();
  },

  'an address that is none': async (browser) => {
    const player = await fails(browser, 'bad-address', /address of the actor cannot be used/, { ...wide, search: 'src=javascript:alert(1)' });
    await player.close();
  },

  'a browser without WebGPU': async (browser) => {
    const before = (page) => page.addInitScript(() => Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined }));
    const player = await fails(browser, 'no-webgpu', /no WebGPU/, { ...wide, before });
    assert.match(await player.part('.error .todo').textContent(), /Chrome and Edge 113, Safari 26 and Firefox 141/);
    assert.deepEqual(await player.heard('progress'), [], 'the actor was fetched for nothing');
    await player.close();
  },

  'a browser without a graphics adapter': async (browser) => {
    const before = (page) => page.addInitScript(() => (GPU.prototype.requestAdapter = () => Promise.resolve(null)));
    const player = await fails(browser, 'no-adapter', /no graphics adapter/, { ...wide, before, forgive: [/adapter/i] });
    await player.close();
  },

  'a player whose program does not come': async (browser) => {
    const before = (page) => page.route('**/*.wasm', (route) => route.abort());
    const player = await fails(browser, 'engine', /own program/, { ...wide, before, forgive: missing });
    await player.close();
  },

  'a device that is lost again and again, and tried anew': async (browser) => {
    const player = await browser.open({ ...wide, forgive: [/Device was destroyed/] });
    await player.loaded();
    for (let loss = 1; loss <= 4; loss += 1) {
      await player.run((element) => element.testing.loseDevice());
      await player.until(`loss ${loss}`, (_, wanted) => window.heard.filter(({ type }) => type === 'devicelost').length === wanted, loss);
      if (loss < 4) await player.until(`recovery ${loss}`, (_, wanted) => window.heard.filter(({ type }) => type === 'devicerestored').length === wanted, loss);
    }
    await player.event('error');
    assert.equal((await player.heard('error'))[0].kind, 'device-lost');
    assert.match(await player.part('.error .happened').textContent(), /does not come back/);
    await player.picture('error-device-lost');
    await player.part('.error button').click();
    await player.until('a stage again', (element) => element.testing.stage && !element.testing.lost());
    assert.equal(await player.part('.error').isVisible(), false);
    const picture = await player.run((element) => element.testing.picture());
    assert.ok(picture.drawn > 0.01);
    await player.close();
  },
};
