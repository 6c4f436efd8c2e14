/**
 * Where an element lives: in and out of a page, in a shadow tree, in another document. What it leaves behind is counted:
 * devices, timers, observers, listeners, memory.
 */

import assert from 'node:assert/strict';
import { countLives, nothingLeft } from '../lives.mjs';

/**
 * Megabytes that the page's heap, and pages of 64 KB that the module's memory, may grow by while players come and go in one round.
 * The module's memory never shrinks and grows where its holes do not fit, once or twice and then no more: what is left behind
 * by every player makes it grow in every round, so one round of a few in which it does not grow says that nothing is.
 */
const HEAP = 0.5;
const MEMORY = 4;
/** Players that come and go in a round, and rounds at most after the first. */
const ROUND = 25;
const ROUNDS = 4;

/** An empty page of the site that counts, with what it has of itself. */
async function counting(browser, options = {}) {
  const player = await browser.open({ path: 'examples/empty.html', before: (page) => page.addInitScript(countLives), ...options });
  await player.page.evaluate(async () => {
    await import('/reprise-player.js');
    window.make = (attributes = {}, parent = document.body) => {
      const element = document.createElement('reprise-player');
      for (const [name, value] of Object.entries({ src: '/demo.reprise', ...attributes })) element.setAttribute(name, value);
      parent.append(element);
      return element;
    };
    // Where the machine is slow to draw, all has come before the first picture.
    window.there = (element) => Promise.all(['ready', 'load'].map((type) => new Promise((resolve) => element.addEventListener(type, resolve, { once: true }))));
    // Once an element has had its turn, microtasks and all.
    window.turn = () => new Promise((resolve) => setTimeout(resolve));
  });
  return { player, alone: await player.page.evaluate(() => window.count()) };
}

/** Moments of a player's life, and how the page finds them: each takes the element out itself, in that very moment. */
const MOMENTS = {
  'at once': (element) => element.remove(),
  'in the next microtask': (element) => queueMicrotask(() => element.remove()),
  'in the next frame': (element) => requestAnimationFrame(() => element.remove()),
  'with the first bytes': (element) => element.addEventListener('progress', () => element.remove(), { once: true }),
  'when an adapter is asked for': (element) => (window.moment = (name) => name === 'adapter' && element.remove()),
  'when a device is asked for': (element) => (window.moment = (name) => name === 'device' && element.remove()),
  'when the device is there': (element) => (window.moment = (name) => name === 'opened' && element.remove()),
  'after the device is there': (element) => (window.moment = (name) => name === 'opened' && setTimeout(() => element.remove())),
  'when it is ready': (element) => element.addEventListener('ready', () => element.remove(), { once: true }),
  'when all has come': (element) => element.addEventListener('load', () => element.remove(), { once: true }),
};

/** Bytes of the page's heap and of the modules' memories, after the garbage has been collected. */
async function memory(player, session) {
  await session.send('HeapProfiler.collectGarbage');
  await session.send('HeapProfiler.collectGarbage');
  const { usedSize } = await session.send('Runtime.getHeapUsage');
  const { metrics } = await session.send('Performance.getMetrics');
  const metric = (name) => metrics.find((one) => one.name === name).value;
  const modules = await player.page.evaluate(() => window.lives.memories.map(({ buffer }) => buffer.byteLength / 65536));
  return { heap: usedSize / 1e6, modules, listeners: metric('JSEventListeners'), nodes: metric('Nodes') };
}

async function measuring(player) {
  const session = await player.page.context().newCDPSession(player.page);
  await session.send('HeapProfiler.enable');
  await session.send('Performance.enable');
  return session;
}

export const tests = {
  'a player that is taken out at any moment leaves nothing behind': async (browser) => {
    const { player, alone } = await counting(browser);
    for (const controls of [false, true]) {
      for (const [name, take] of Object.entries(MOMENTS)) {
        await player.page.evaluate(`{
          window.moment = () => {};
          const element = window.make({ tool: ${controls ? "'path', controls: ''" : "'pose'"} });
          (${take})(element);
        }`);
        await player.until(`taken out ${name}`, () => document.querySelector('reprise-player') === null);
        // What was on its way when it was taken out comes later.
        await player.page.evaluate(() => window.turn());
        await nothingLeft(player, alone, name);
      }
    }
    await player.close();
  },

  'players that come and go fifty times leave no memory behind': async (browser) => {
    const { player, alone } = await counting(browser);
    const session = await measuring(player);
    const cycle = async (again, all) => {
      await player.page.evaluate(async ([wanted, whole]) => {
        const element = wanted ? document.body.appendChild(window.kept) : window.make({ controls: '' });
        window.kept = element;
        await (whole ? window.there(element) : new Promise((resolve) => element.addEventListener('ready', resolve, { once: true })));
        element.remove();
        await window.turn();
        // What the test itself has heard is no memory of the players'.
        window.heard.length = 0;
      }, [again, all]);
      await nothingLeft(player, alone, 'a player that was ready');
    };
    let at = 0;
    const round = async () => {
      for (const end = at + ROUND; at < end; at += 1) {
        // The same one again, and another one, in turn. The first ones get all of the actor, later ones as much of it as has
        // come before the first picture: the module's memory is soon as large as one player makes it.
        await cycle(at % 2 === 1, at < 4);
      }
      return memory(player, session);
    };
    let [before, after] = [null, await round()];
    const grown = () => after.modules[0] - before.modules[0];
    for (let rounds = 0; rounds < ROUNDS && (before === null || grown() > MEMORY); rounds += 1) {
      [before, after] = [after, await round()];
      console.log(`        to the ${at}th: ${JSON.stringify(before)} to ${JSON.stringify(after)}`);
    }
    assert.equal(after.modules.length, 1, 'the module was loaded more than once');
    assert.ok(grown() <= MEMORY, `the module's memory grew in every round, in the last one by ${grown()} pages`);
    assert.ok(after.heap - before.heap < HEAP, `the heap grew from ${before.heap} to ${after.heap} MB`);
    assert.ok(after.listeners <= before.listeners, `${before.listeners} listeners became ${after.listeners}`);
    assert.ok(after.nodes <= before.nodes, `${before.nodes} nodes became ${after.nodes}`);
    await player.close();
  },

  'a player in a shadow tree is a player': async (browser) => {
    const { player, alone } = await counting(browser);
    for (const mode of ['open', 'closed']) {
      const seen = await player.page.evaluate(async (shadow) => {
        const host = document.body.appendChild(document.createElement('section'));
        const root = host.attachShadow({ mode: shadow });
        const sheet = new CSSStyleSheet();
        sheet.replaceSync('reprise-player { display: block; block-size: 400px; }');
        root.adoptedStyleSheets = [sheet];
        const element = window.make({ controls: '' }, root);
        await window.there(element);
        const picture = await element.testing.picture();
        const walk = element.goTo({ sequence: element.info.sequences[1].name, seconds: 0.5 });
        const leaves = element.state.target;
        // The keys reach it, and the focus is told within its own tree.
        const tools = element.shadowRoot.querySelectorAll('.tool');
        tools[1].focus();
        tools[1].click();
        const { tool } = element;
        const styled = getComputedStyle(element.shadowRoot.querySelector('.bar')).display;
        host.remove();
        await window.turn();
        return { drawn: picture.drawn, to: walk.to, leaves, tool, styled, tools: tools.length };
      }, mode);
      assert.ok(seen.drawn > 0.01, `${mode}: ${JSON.stringify(seen)}`);
      assert.deepEqual([seen.to, seen.tool, seen.styled, seen.tools], [seen.leaves, 'place', 'flex', 6], mode);
      await nothingLeft(player, alone, `a player in a tree that is ${mode}`);
    }
    await player.close();
  },

  'a player that is moved within the page goes on, and in another document begins anew': async (browser) => {
    const { player, alone } = await counting(browser);
    const look = () =>
      player.page.evaluate(async () => {
        const { kept: element } = window;
        const { drawn } = await element.testing.picture();
        const style = element.ownerDocument.defaultView.getComputedStyle(element.shadowRoot.querySelector('.view'));
        return { drawn, position: style.position, frame: element.state.frame, devices: window.lives.devices.size };
      });
    await player.page.evaluate(async () => {
      window.kept = window.make({ controls: '' });
      await window.there(window.kept);
      window.kept.pause();
      window.kept.seek(20);
      window.loads = 0;
      const again = () => window.there(window.kept).then(() => (window.loads += 1)).then(again);
      again();
      document.body.appendChild(document.createElement('div')).append(window.kept);
      await window.turn();
    });
    assert.deepEqual(await player.page.evaluate(() => window.loads), 0, 'moved within the page, it was loaded again');
    const here = await look();
    assert.ok(here.drawn > 0.01 && here.frame === 20, JSON.stringify(here));

    await player.page.evaluate(() => {
      window.frame = document.body.appendChild(document.createElement('iframe'));
      window.frame.style.cssText = 'inline-size: 600px; block-size: 420px';
    });
    for (const [at, where] of ['frame.contentDocument', 'document'].entries()) {
      await player.page.evaluate(`{ const { frame } = window; const to = ${where}; to.body.append(window.kept); }`);
      await player.until(`the actor in ${where}`, (_, wanted) => window.loads === wanted, at + 1);
      const there = await look();
      assert.ok(there.drawn > 0.01, JSON.stringify(there));
      assert.deepEqual([there.position, there.devices], ['absolute', 1], where);
    }
    // A document that is shown nowhere.
    await player.page.evaluate(async () => {
      document.implementation.createHTMLDocument('').body.append(window.kept);
      await window.turn();
    });
    await nothingLeft(player, alone, 'a player in a document without a window');
    await player.page.evaluate(() => document.body.append(window.kept));
    await player.until('the actor back in the page', () => window.loads === 3);
    await player.page.evaluate(async () => {
      window.kept.remove();
      await window.turn();
    });
    await nothingLeft(player, alone, 'a player that was about');
    await player.close();
  },
};
