/** Frames as they were scanned, on the demo with made-up ones: blue, and a little fatter than the mesh that all were brought onto. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';

const BUNDLE = 'dressed/scanned.reprise';

/** Opens the demo with made-up scanned frames; null, with a sentence, where nobody made it. */
async function open(browser, options = {}) {
  if (!process.env.REPRISE_DRESSED) {
    assert.notEqual(process.env.CI, 'true', 'REPRISE_DRESSED names no folder: run cargo xtask test');
    console.log('skipped: REPRISE_DRESSED names no folder of scanned frames, see cargo xtask test');
    return null;
  }
  const player = await browser.open({ search: `src=${BUNDLE}`, ...options });
  await player.loaded();
  await player.run((element) => element.pause());
  return player;
}

/** The bundle's bytes, and the groups of scanned frames in them (docs/bundle-format.md). */
async function bundle() {
  const bytes = await readFile(join(process.env.REPRISE_DRESSED, 'scanned.reprise'));
  const groups = [];
  for (let at = 48; at < bytes.readUInt32LE(12); at += 40) {
    if (bytes.readUInt16LE(at) === 41) groups.push([Number(bytes.readBigUInt64LE(at + 8)), Number(bytes.readBigUInt64LE(at + 16))]);
  }
  return { bytes, groups };
}

const shows = (player, what) => player.until(`the ${what}`, (element, wanted) => element.testing.shown() === wanted, what);

/** How much of the picture is blue. */
const blue = (player) => player.run((element) => element.testing.share((r, g, b) => b > 110 && r < 90 && g < 110));

/** Compares by the chip `name`. */
async function compare(player, name) {
  await player.run((element, wanted) => {
    const { looks } = element.testing.core.view;
    looks.choose(wanted);
  }, name);
}

export const tests = {
  'scans: recorded frames are shown as scanned, and what is made on one mesh': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    assert.ok((await player.run((element) => element.info.scanned)) > 100);
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    assert.equal(await player.run((element) => element.state.shown), 'scan');
    const scanned = await blue(player);
    await player.picture('scanned');
    await player.part('.chips .chip:has-text("compare")').click();
    assert.equal(await player.part('.choices .chip:has-text("cross-fade")').isVisible(), false, 'there are no modes');
    await player.part('.choices .chip:has-text("template")').click();
    await shows(player, 'template');
    const registered = await blue(player);
    assert.ok(scanned > 0.02 && registered < scanned / 20, `${scanned} of the picture is blue, and ${registered}`);
    await player.part('.choices .chip:has-text("ours")').click();
    await shows(player, 'scan');
    // Frame 29 is as if it had been lost; between two frames the nearer one counts.
    await player.run((element) => element.seek(29));
    await shows(player, 'template');
    await player.run((element) => element.seek(28.4));
    await shows(player, 'scan');
    await player.run((element) => element.pressKey(new KeyboardEvent('keydown', { key: 'f' })));
    await player.until('the facts', (element) => /shown\s*as scanned/.test(element.shadowRoot.querySelector('.facts').textContent));
    await player.close();
  },

  'scans: a transition carries the scans of its ends, without a change at the cut, and they stand where the actor stands': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    // The same moment as it was scanned, and as a transition carries it from here on.
    const cut = await player.run((element) => element.testing.switched(1));
    assert.ok(cut.covered > 1000 && cut.within > cut.covered / 2, JSON.stringify(cut));
    assert.ok(cut.cut < cut.pixels / 10_000, `${cut.cut} of ${cut.pixels} pixels change`);
    await shows(player, 'scan');
    const target = await player.target();
    await player.run((element, frame) => {
      element.speed = 0.2;
      element.goTo(frame);
    }, target);
    await player.until('a transition', (element) => element.state.transition?.lambda > 0.3 && element.state.transition.lambda < 0.7);
    await player.run((element) => element.pause());
    const seen = await player.run((element) => {
      element.testing.core.draw();
      return { ...element.state.transition, frames: element.info.scanned, shown: element.state.shown, share: element.testing.stage.scan_shown() };
    });
    // It leaves a scanned frame, and what it goes over into is as scanned too, or else the mesh.
    assert.ok(seen.share > 0.99 || Math.abs(seen.share - 1 + seen.lambda) < 0.1, JSON.stringify(seen));
    assert.equal(seen.shown, seen.share < 0.5 ? 'template' : 'carried');
    // Where the mesh counts for more already, the scan's blue may have faded out of what counts as blue.
    assert.ok(seen.share < 0.5 || (await blue(player)) > 0.005, JSON.stringify(seen));
    await player.picture('carried');
    await compare(player, 'template');
    await shows(player, 'template');
    assert.ok((await blue(player)) < 0.001);
    await compare(player, 'ours');
    await player.run((element) => {
      element.speed = 4;
      element.play();
    });
    await player.event('arrive');
    // And back, to where there are scanned frames.
    await player.run((element) => {
      window.heard.length = 0;
      element.goTo(45);
    });
    await player.event('arrive');
    await shows(player, 'scan');
    const places = await player.run(async (element) => [await element.testing.middle(), (element.testing.core.view.looks.choose('template'), element.testing.core.draw(), await element.testing.middle())]);
    const off = Math.hypot(places[0][0] - places[1][0], places[0][1] - places[1][1]);
    assert.ok(off < 4, `the scan is ${off} pixels from where the actor is`);
    await compare(player, 'ours');
    await player.close();
  },

  'scans: an edited frame carries its own scan, which stands where the edit moves nothing': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    // The frame as it is, edited by nothing, and with all above the hips moved aside: the same pixels, and the same below.
    const seen = await player.run(async (element) => {
      const { testing } = element;
      const pixels = async (pose) => {
        testing.player.set_edited(25, pose);
        testing.core.draw();
        return [testing.core.director.shown, await testing.stage.read_pixels()];
      };
      const recorded = testing.player.recorded_pose(25);
      const height = recorded.filter((_, k) => k % 3 === 1).reduce((a, b) => Math.max(a, b), 0);
      const moved = recorded.map((value, k) => (k % 3 === 0 ? value + 0.3 * Math.max(0, recorded[k + 1] - 0.55 * height) : value));
      const all = [await pixels([]), await pixels(recorded), await pixels(moved), await pixels([])];
      const [scan] = all.map(([, picture]) => picture);
      const differ = (picture) => {
        let count = 0;
        for (let at = 0; at < scan.length; at += 4) count += Number(scan[at] !== picture[at] || scan[at + 1] !== picture[at + 1] || scan[at + 2] !== picture[at + 2]);
        return count;
      };
      testing.player.set_edited(25, moved);
      return { shown: all.map(([shown]) => shown), differ: all.map(([, picture]) => differ(picture)) };
    });
    assert.deepEqual(seen.shown, ['scan', 'carried', 'carried', 'scan']);
    const [, nothing, moved, again] = seen.differ;
    assert.equal(nothing, 0, 'an edit that moves nothing changes the picture');
    assert.equal(again, 0, 'the scan is another one once the edit is gone');
    assert.ok(moved > 1000, JSON.stringify(seen));
    assert.ok((await blue(player)) > 0.015);
    await player.picture('edited');
    await compare(player, 'template');
    await shows(player, 'template');
    assert.ok((await blue(player)) < 0.002);
    await player.picture('edited-template');
    await player.close();
  },

  'scans: one gives way to the other little by little, and not by a jump': async (browser) => {
    const player = await open(browser);
    if (!player) return;
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    const [whole, half, none] = await player.run(async (element) => {
      const colours = [];
      for (const share of [1, 0.5, 0]) {
        const pixels = await element.testing.mixed(share);
        let blue = 0;
        for (let at = 0; at < pixels.length; at += 4) blue += pixels[at + 2] - pixels[at];
        colours.push(blue);
      }
      return colours;
    });
    const part = (half - none) / (whole - none);
    assert.ok(whole - none > 1e6 && part > 0.3 && part < 0.8, [whole, half, none].join());
    // Frame 29 is as if it had been lost: the scan goes before it, and comes again after it.
    await player.run((element) => element.seek(30));
    await shows(player, 'scan');
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    const shares = await player.run(async (element) => {
      // So slowly that a machine which draws in software sees what is between.
      element.speed = 0.05;
      element.play();
      const seen = [];
      while (element.state.frame < 31) {
        await new Promise((resolve) => requestAnimationFrame(resolve));
        seen.push(element.testing.stage.scan_shown());
      }
      return seen;
    });
    const least = shares.indexOf(Math.min(...shares));
    const between = [shares.slice(0, least), shares.slice(least)].map((side) => side.filter((share) => share > 0 && share < 0.7).length);
    assert.ok(least > 0 && shares[least] < 0.1 && Math.min(...between) > 0, shares.join());
    await player.close();
  },

  'scans: groups are fetched one by one where the server hands out parts, those ahead alone': async (browser) => {
    if (!process.env.REPRISE_DRESSED) return;
    const { bytes, groups } = await bundle();
    const asked = [];
    const parts = (page) => page.route(`**/${BUNDLE}`, (route) => {
      const [, first, last] = /bytes=(\d+)-(\d+)/.exec(route.request().headers().range ?? '') ?? [];
      if (first === undefined) return route.continue();
      asked.push(Number(first));
      return route.fulfill({ status: 206, contentType: 'application/octet-stream', body: bytes.subarray(Number(first), Number(last) + 1) });
    });
    const player = await open(browser, { before: parts });
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    const before = Math.max(...asked);
    await player.run((element) => element.seek(112));
    await shows(player, 'scan');
    // What was passed over has not come.
    assert.ok(asked.some((first) => first > before), 'nothing was asked for');
    assert.ok(new Set(asked).size < groups.length / 2, `${asked.length} of ${groups.length} groups`);
    await player.close();
  },

  'scans: a group that is damaged is shown on the registered mesh, and nothing else is wrong': async (browser) => {
    if (!process.env.REPRISE_DRESSED) return;
    const { bytes, groups } = await bundle();
    const damaged = Buffer.from(bytes);
    damaged[groups[0][0] + 20] ^= 0x55;
    const faulty = (page) => page.route(`**/${BUNDLE}`, (route) => route.fulfill({ contentType: 'application/octet-stream', body: damaged }));
    const player = await open(browser, { before: faulty });
    await player.run((element) => element.seek(0));
    await player.until('that it was tried', (element) => element.testing.core.session.scans.failed.size === 1);
    await shows(player, 'template');
    await player.run((element) => element.seek(5));
    await shows(player, 'scan');
    assert.equal(await player.part('.error').isVisible(), false);
    await player.close();
  },

  'scans: a lost device comes back with them': async (browser) => {
    const player = await open(browser, { forgive: [/Device was destroyed/] });
    if (!player) return;
    await player.run((element) => element.seek(25));
    await shows(player, 'scan');
    await player.run((element) => element.testing.loseDevice());
    await player.event('devicerestored');
    await shows(player, 'scan');
    await player.close();
  },
};
