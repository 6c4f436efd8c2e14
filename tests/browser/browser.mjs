/** Opens the player in Chromium and watches over what a good page never does. */

import { mkdirSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { serve } from './server.mjs';

const here = dirname(fileURLToPath(import.meta.url));
export const dist = resolve(process.env.REPRISE_DIST ?? join(here, '../../dist'));
export const bundlePath = resolve(process.env.REPRISE_BUNDLE ?? join(dist, 'demo.reprise'));
export const out = join(here, 'out');

const FLAGS = [
  '--no-sandbox',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--enable-unsafe-webgpu',
  // WebGPU in software; with any other ANGLE backend than this, the first picture loses the device.
  '--use-webgpu-adapter=swiftshader',
  '--ignore-gpu-blocklist',
  '--use-angle=gl-egl',
];

/**
 * Milliseconds after which an event that is waited for will not come any more. Nothing takes nearly as long, on a machine
 * that does much else besides and draws in software; it is no measure of anything.
 */
const LIMIT = Number(process.env.REPRISE_LIMIT ?? 300_000);

/** Small, for every pixel is drawn by the processor. */
const SMALL = { width: 800, height: 600 };

export class Browser {
  static async launch() {
    const browser = new Browser();
    mkdirSync(out, { recursive: true });
    browser.server = await serve(dist, bundlePath);
    await browser.start();
    return browser;
  }

  async start() {
    this.chromium = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: FLAGS });
  }

  /** Clears up after a test, however it ended: no page of one test may take time from the next. */
  async tidy() {
    if (!this.chromium.isConnected()) return this.start();
    await Promise.all(this.chromium.contexts().map((context) => context.close()));
  }

  async close() {
    await this.chromium.close();
    this.server.close();
  }

  /**
   * Opens the page. Whatever is not forgiven here fails the test when the page is closed.
   * @param {object} options
   * @param {string} options.path of the page's address
   * @param {string} options.search
   * @param {string} options.hash
   * @param {RegExp[]} options.forgive console errors that belong to the test
   * @param {(page: import('playwright-core').Page) => Promise<void>} options.before is run before the page is opened
   * @param {object} options.context for Playwright: viewport, colour scheme, touch
   */
  async open({ path = '', search = '', hash = '', forgive = [], before, ...context } = {}) {
    const session = await this.chromium.newContext({ viewport: SMALL, ...context });
    session.setDefaultTimeout(LIMIT);
    const page = await session.newPage();
    const complaints = [];
    const complain = (text) => forgive.some((pattern) => pattern.test(text)) || complaints.push(text);
    page.on('console', (message) => message.type() === 'error' && complain(`console: ${message.text()}`));
    page.on('pageerror', (error) => complain(`uncaught: ${error.message}`));
    await page.addInitScript(watchOver);
    await before?.(page);
    await page.goto(`${this.server.address}${path}?${search}${hash}`);
    return new Player(page, complaints);
  }
}

/** Runs in the page before anything else: notes violations of the policy and every event of the player, and looks inside. */
function watchOver() {
  import('/testing.js');
  window.violations = [];
  window.heard = [];
  document.addEventListener('securitypolicyviolation', (event) => window.violations.push(`${event.violatedDirective}: ${event.blockedURI}`));
  const types = ['ready', 'load', 'error', 'transitionstart', 'transitionend', 'arrive', 'stall', 'end', 'devicelost', 'devicerestored', 'progress', 'toolchange', 'change', 'answer', 'editchange', 'drivestart', 'driveend'];
  for (const type of types) {
    // In the capturing phase, for the player's events do not bubble (and load never reaches the window).
    document.addEventListener(type, ({ detail }) => detail && typeof detail === 'object' && window.heard.push({ type, ...detail }), true);
  }
}

/** The page as a test sees it. */
export class Player {
  constructor(page, complaints) {
    this.page = page;
    this.complaints = complaints;
    this.mouse = page.mouse;
    this.keyboard = page.keyboard;
  }

  /** Runs `work(player, argument)` in the page, `player` being the element. */
  run(work, argument) {
    const source = `(argument) => (${work})(document.querySelector('reprise-player'), argument)`;
    return this.page.evaluate(`(${source})(${JSON.stringify(argument) ?? 'undefined'})`);
  }

  /** Waits until `work(player, argument)` is true in the page. Playwright's own waiting needs eval, which the policy forbids. */
  async until(what, work, argument) {
    const end = Date.now() + LIMIT;
    while (!(await this.run(work, argument))) {
      if (Date.now() > end) throw new Error(`waited ${LIMIT / 1000} s in vain: ${what}\n${await this.circumstances()}`);
      await this.page.waitForTimeout(20);
    }
  }

  /** The same for what a search has to find first; it is helped along. */
  untilFound(what, work, argument) {
    return this.until(what, `(element, argument) => { element.testing.searchOn(30); return (${work})(element, argument); }`, argument);
  }

  /** Waits until so many display frames have been made: whatever was asked for before them is done. */
  frames(count) {
    return this.page.evaluate(async (wanted) => {
      for (let frame = 0; frame < wanted; frame += 1) await new Promise((resolve) => requestAnimationFrame(resolve));
    }, count);
  }

  /** Waits until the style sheets' own motion has come to its end. */
  async calm() {
    await this.page.evaluate(async () => {
      const roots = [document, ...[...document.querySelectorAll('reprise-player')].map(({ shadowRoot }) => shadowRoot)];
      const ending = roots.flatMap((root) => root?.getAnimations() ?? []).filter(({ effect }) => effect.getComputedTiming().iterations !== Infinity);
      // One that is taken away meanwhile has ended as well.
      await Promise.allSettled(ending.map(({ finished }) => finished));
    });
  }

  /** What may explain a wait in vain. */
  async circumstances() {
    const [events, state] = await this.page.evaluate(() => [
      window.heard.filter(({ type }) => type !== 'progress').map((event) => JSON.stringify({ ...event, info: undefined })),
      JSON.stringify(document.querySelector('reprise-player')?.state),
    ]);
    return [...this.complaints, `events: ${events.slice(-8).join(' ')}`, `state: ${state}`].join('\n');
  }

  /** Waits for an event of the player. */
  event(type) {
    return this.until(`the event ${type}`, (_, wanted) => window.heard.some(({ type: one }) => one === wanted), type);
  }

  heard(type) {
    return this.page.evaluate((wanted) => window.heard.filter((event) => event.type === wanted), type);
  }

  async loaded() {
    await this.event('ready');
    await this.event('load');
    await this.until('a look inside', (player) => Boolean(player.testing));
  }

  /** Something inside the player's shadow tree. */
  part(selector) {
    return this.page.locator(`reprise-player ${selector}`);
  }

  /** A frame in another sequence, a transition or more away, that is reached soonest. */
  target(except = -1) {
    return this.run((player, avoid) => {
      const here = player.state.frame;
      const walks = player.info.sequences.flatMap(({ first, count }) => {
        const frame = first + Math.floor(count / 2);
        if ((here >= first && here < first + count) || (avoid >= first && avoid < first + count)) return [];
        try {
          return [player.plan(frame)];
        } catch {
          return [];
        }
      });
      const far = walks.filter((walk) => walk.transitions > 0);
      return far.sort((a, b) => a.seconds - b.seconds)[0].to;
    }, except);
  }

  /** Clicks a frame's place on its strip with the mouse. @returns the frame that the player goes to */
  async click(frame) {
    const { x, y } = await this.run((player, wanted) => player.testing.placeOf(wanted), frame);
    await this.mouse.move(x, y);
    await this.mouse.down();
    await this.mouse.up();
    return this.run((player) => player.state.target);
  }

  /** Saves a picture of the whole page. */
  async picture(name) {
    await this.run((player) => player.testing?.stage && player.testing.keepDrawing());
    await this.frames(3);
    await this.calm();
    await this.page.screenshot({ path: join(out, `${name}.png`) });
    await this.run((player) => player.testing?.keepDrawing(false));
  }

  /** Closes the page, and fails if anything was amiss on it. */
  async close() {
    const violations = await this.page.evaluate(() => window.violations);
    await this.page.context().close();
    const amiss = [...this.complaints, ...violations.map((one) => `policy: ${one}`)];
    if (amiss.length > 0) throw new Error(`the page complained:\n${amiss.join('\n')}`);
  }
}
