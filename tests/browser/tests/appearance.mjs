/** Textures rebuilt on the GPU, against their twins on the processor, on the demo with made-up appearance. */

import assert from 'node:assert/strict';

/** Opens the demo with made-up appearance; null, with a sentence, where nobody made it. */
async function open(browser, options = {}) {
  if (!process.env.REPRISE_DRESSED) {
    assert.notEqual(process.env.CI, 'true', 'REPRISE_DRESSED names no folder: run cargo xtask test');
    console.log('skipped: REPRISE_DRESSED names no folder of textures, see cargo xtask test');
    return null;
  }
  const player = await browser.open({ search: 'src=dressed/dressed.reprise', ...options });
  await player.loaded();
  await player.run((element) => {
    element.pause();
    element.seek(25);
  });
  return player;
}

/** Runs in the page: how far the texture is from the one in `dressed/<wanted>.rgba`, in 255ths, where that is opaque. */
async function difference(element, [setting, wanted, most = 255]) {
  const pixels = await element.testing.texture(setting);
  const expected = new Uint8Array(await (await fetch(`dressed/${wanted}.rgba`)).arrayBuffer());
  let [worst, sum, count, over] = [0, 0, 0, 0];
  for (let at = 0; at < expected.length; at += 1) {
    if (expected[at | 3] === 0) continue;
    const apart = Math.abs(expected[at] - pixels[at]);
    worst = Math.max(worst, apart);
    over += Number(apart > most);
    sum += apart;
    count += 1;
  }
  return { worst, mean: sum / count, count, over, same: expected.length === pixels.length };
}

export const tests = {
  'appearance: the GPU rebuilds textures as the processor does': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    for (const [setting, most] of [['half', 1], ['direct', 1], ['poisson', 2]]) {
      const { worst, mean, count, over, same } = await player.run(difference, [setting, setting, most]);
      console.log(`        ${setting}: ${over} of ${count} values more than ${most} apart, at most ${worst}, ${mean.toFixed(3)} on average`);
      assert.ok(same && count > 10_000);
      // Where a warp ends between two texels of a chart's border, rounding decides which of them is read.
      assert.ok(over <= count * 1e-4 && worst <= 16, `${setting}: ${over} values more than ${most}/255 apart, at most ${worst}`);
    }
    const exact = await player.run(difference, ['poisson', 'exact']);
    const direct = await player.run(difference, ['direct', 'exact']);
    console.log(`        to the exact solution: ${exact.mean.toFixed(3)} with one cycle, ${direct.mean.toFixed(3)} moved directly`);
    assert.ok(exact.mean < 0.6 * direct.mean);
    await player.close();
  },

  'appearance: the page is dressed before all modes are there, and refines': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    assert.deepEqual((await player.run((element) => element.info)).appearance, [8, 4]);
    await player.until('a texture', (element) => element.testing.stage.texture_setting());
    // A software device begins with the quickest way, and stays with it.
    assert.equal(await player.run((element) => element.testing.stage.texture_setting()), 'half');
    await player.until('all thumbnails', (element) => element.testing.thumbnails().complete && element.testing.thumbnails().drawn > 0);
    await player.picture('dressed');
    await player.close();
  },

  'appearance: coefficients change in transitions, and the page compares': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    const target = await player.target();
    await player.run((element, frame) => {
      // Slowly, for whoever draws in software.
      element.speed = 0.2;
      element.goTo(frame);
    }, target);
    await player.until('a transition half done', (element) => element.state.transition?.lambda > 0.3 && element.state.transition.lambda < 0.7);
    await player.run((element) => element.pause());
    const apart = (a, b) => a.reduce((sum, value, at) => sum + Math.abs(value - b[at]), 0) / a.length;
    const ours = await player.run((element) => element.testing.texture('half'));
    await player.part('.chips .chip:has-text("compare")').click();
    await player.part('.choices .chip:has-text("cross-fade")').click();
    const faded = await player.run((element) => element.testing.texture('half'));
    assert.ok(apart(ours, faded) > 0.5, 'cross-fading looks the same');
    await player.part('.choices .chip:has-text("naive")').click();
    const naive = await player.run((element) => element.testing.texture('half'));
    assert.ok(apart(ours, naive) > 0.5 && apart(faded, naive) > 0.5, 'the naive model looks the same');
    assert.equal(await player.part('.choices .chip:has-text("original")').isVisible(), false, 'there are no originals');
    await player.part('.choices .chip:has-text("ours")').click();
    const again = await player.run((element) => element.testing.texture('half'));
    assert.deepEqual(again, ours);
    await player.close();
  },

  'appearance: recorded frames wear their textures as captured, if these are there': async (browser) => {
    const player = await open(browser, { forgive: [/404/] });
    if (!player) return;
    const asked = [];
    await player.page.route('**/captured/*', async (route) => {
      const name = route.request().url().split('/').pop();
      asked.push(name);
      if (name === '00027.png') return route.fulfill({ status: 404 });
      // A captured texture of one colour, as no modes make it.
      const pixel = 'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==';
      return route.fulfill({ contentType: 'image/png', body: Buffer.from(pixel, 'base64') });
    });
    await player.run((element) => (element.originals = 'captured/%05d.png'));
    const picture = () => player.run(async (element) => (await element.testing.picture()).mean);
    // All modes are read, so that nothing but the choice changes the picture.
    await player.run((element) => element.testing.texture('half'));
    const ours = await picture();
    await player.part('.chips .chip:has-text("compare")').click();
    await player.part('.choices .chip:has-text("original")').click();
    await player.until('the captured texture', (element) => element.testing.looks().worn === 25);
    assert.deepEqual(asked, ['00025.png']);
    const captured = await picture();
    assert.ok(Math.abs(ours[1] - captured[1]) > 1, `the picture is the same: ${ours} and ${captured}`);
    await player.part('.choices .chip:has-text("ours")').click();
    await player.until('what is rebuilt', (element) => element.testing.looks().worn === -1);
    await player.until('its picture', async (element, wanted) => Math.abs((await element.testing.picture()).mean[1] - wanted) < 0.5, ours[1]);

    await player.part('.choices .chip:has-text("original")').click();
    await player.run((element) => element.seek(27));
    await player.until('a sentence', (element) => /frame 27 is not at captured/.test(element.shadowRoot.querySelector('.status').textContent));
    assert.equal(await player.part('.choices [aria-checked="true"]').textContent(), 'ours');
    await player.close();
  },

  'appearance: a lost device comes back dressed': async (browser) => {
    const player = await open(browser, { forgive: [/Device was destroyed/] });
    if (!player) return;
    const before = await player.run((element) => element.testing.texture('half'));
    await player.run((element) => element.testing.loseDevice());
    await player.event('devicerestored');
    const after = await player.run((element) => element.testing.texture('half'));
    assert.deepEqual(after, before);
    await player.close();
  },
};
