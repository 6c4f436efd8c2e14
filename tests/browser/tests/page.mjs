/** The page as a page: narrow, dark, calm, touched, read aloud. */

import assert from 'node:assert/strict';

const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };

async function fits(player, width) {
  const { scroll, inside } = await player.run((element) => {
    const parts = ['.transport', '.strips', '.chips.right', '.round'];
    const boxes = parts.map((part) => element.shadowRoot.querySelector(part).getBoundingClientRect());
    return { scroll: document.documentElement.scrollWidth, inside: boxes.map(({ left, right, bottom }) => ({ left, right, bottom })) };
  });
  assert.ok(scroll <= width, `the page is ${scroll} wide`);
  inside.forEach(({ left, right }) => assert.ok(left >= 0 && right <= width, `${left} to ${right} is outside`));
}

export const tests = {
  'reflows to a phone, and the score is a drawer': async (browser) => {
    const player = await browser.open(PHONE);
    await player.loaded();
    await fits(player, 390);
    const height = () => player.run((element) => element.shadowRoot.querySelector('.view').getBoundingClientRect().height);
    const before = await height();
    await player.part('.drawer').tap();
    assert.equal(await player.part('.strips').isVisible(), false);
    assert.ok((await height()) > before + 100);
    await player.part('.drawer').tap();
    assert.equal(await player.part('.strips').isVisible(), true);
    await player.close();
  },

  'fits into 360 pixels': async (browser) => {
    const player = await browser.open({ viewport: { width: 360, height: 640 } });
    await player.loaded();
    await fits(player, 360);
    await player.close();
  },

  'a tap on a strip goes there': async (browser) => {
    const player = await browser.open(PHONE);
    await player.loaded();
    await player.run((element) => element.pause());
    const frame = await player.target();
    const { x, y } = await player.run((element, wanted) => element.testing.placeOf(wanted), frame);
    await player.page.touchscreen.tap(x, y);
    const target = await player.run((element) => element.state.target);
    assert.ok(Math.abs(target - frame) <= 2, `${target} is not ${frame}`);
    assert.equal(await player.part('.tooltip').isVisible(), false);
    await player.close();
  },

  'the backing follows the screen and the window': async (browser) => {
    const player = await browser.open({ viewport: { width: 700, height: 500 }, deviceScaleFactor: 2 });
    await player.loaded();
    const sizes = () => player.run((element) => {
      const canvas = element.shadowRoot.querySelector('.view canvas');
      return { backing: [canvas.width, canvas.height] };
    });
    for (const viewport of [{ width: 700, height: 500 }, { width: 500, height: 640 }]) {
      await player.page.setViewportSize(viewport);
      await player.until('the new size', (element, width) => {
        const canvas = element.shadowRoot.querySelector('.view canvas');
        const follows = (pixels, css) => Math.abs(pixels - css * 2) <= 2;
        return canvas.clientWidth === width && follows(canvas.width, canvas.clientWidth) && follows(canvas.height, canvas.clientHeight);
      }, viewport.width);
      const { backing } = await sizes();
      const picture = await player.run((element) => element.testing.picture());
      assert.equal(picture.bytes, backing[0] * backing[1] * 4);
    }
    await player.close();
  },

  'dark where the reader prefers it': async (browser) => {
    const player = await browser.open({ colorScheme: 'dark' });
    await player.loaded();
    const corner = await player.run(async (element) => (await element.testing.picture()).corner);
    assert.ok(Math.max(...corner) < 80, `the stage's corner is ${corner}`);
    await player.page.emulateMedia({ colorScheme: 'light' });
    await player.until('a light stage', async (element) => Math.min(...(await element.testing.picture()).corner) > 180);
    await player.close();
  },

  'calm where the reader prefers less motion': async (browser) => {
    const player = await browser.open({ reducedMotion: 'reduce' });
    await player.loaded();
    assert.equal(await player.run((element) => element.playing), false);
    const moving = await player.run((element) => {
      const all = [...element.shadowRoot.querySelectorAll('*')];
      return all.filter((one) => getComputedStyle(one).transitionDuration !== '0s' || getComputedStyle(one).animationName !== 'none').length;
    });
    assert.equal(moving, 0);
    await player.run((element) => element.play());
    assert.equal(await player.run((element) => element.playing), true);
    await player.close();
  },

  'every control has a name, and the state is told': async (browser) => {
    const player = await browser.open();
    await player.loaded();
    const nameless = await player.run((element) => {
      const controls = element.shadowRoot.querySelectorAll('button, select, [tabindex], [role="img"]');
      return [...controls].filter((one) => one.checkVisibility() && !(one.getAttribute('aria-label') || one.textContent.trim())).map(({ outerHTML }) => outerHTML);
    });
    assert.deepEqual(nameless, []);
    assert.equal(await player.part('.status').getAttribute('aria-live'), 'polite');
    assert.match(await player.part('.view').getAttribute('aria-label'), new RegExp(await player.run((element) => element.info.sequences[0].name)));
    await player.close();
  },

  'facts are shown on demand': async (browser) => {
    const player = await browser.open();
    await player.loaded();
    assert.equal(await player.part('.facts').isVisible(), false);
    await player.run((element, frame) => element.goTo(frame), await player.target());
    await player.part('.chips.left .chip').click();
    await player.until('the facts', (element) => element.shadowRoot.querySelectorAll('.facts dd').length > 8);
    const text = await player.part('.facts').textContent();
    for (const word of ['cost', 'duration', 'deformation', 'density', 'synthetic frame']) assert.ok(text.includes(word), word);
    await player.close();
  },
};
