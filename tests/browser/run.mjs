/**
 * Runs the browser tests: `node run.mjs [part of a name]`.
 *
 * REPRISE_DIST is the folder to serve (default: dist/), REPRISE_BUNDLE the actor (default: its demo.reprise),
 * REPRISE_NATIVE the folder that `native_walk` wrote from it, REPRISE_DRESSED the one that `dress` wrote, REPRISE_FRAMEWORKS
 * the one that `frameworks/build.mjs` wrote, CHROMIUM the browser (default: /usr/bin/chromium). Pictures go to out/.
 */

import { Browser } from './browser.mjs';
import { tests as modules } from './tests/modules.mjs';
import { tests as joined } from './tests/joined.mjs';
import { tests as native } from './tests/native.mjs';
import { tests as loading } from './tests/loading.mjs';
import { tests as appearance } from './tests/appearance.mjs';
import { tests as scans } from './tests/scans.mjs';
import { tests as walking } from './tests/walking.mjs';
import { tests as errors } from './tests/errors.mjs';
import { tests as page } from './tests/page.mjs';
import { tests as element } from './tests/element.mjs';
import { tests as lives } from './tests/lives.mjs';
import { tests as frameworks } from './tests/frameworks.mjs';
import { tests as parts } from './tests/parts.mjs';
import { tests as keys } from './tests/keys.mjs';
import { tests as tools } from './tests/tools/all.mjs';
import { tests as pictures } from './tests/pictures.mjs';

const wanted = process.argv[2] ?? '';
const chosen = [modules, joined, native, loading, appearance, scans, walking, errors, page, element, lives, frameworks, tools, parts, keys, pictures].flatMap(Object.entries).filter(([name]) => name.includes(wanted));

const browser = await Browser.launch();

/** A new browser in place of one that is gone, or that a failed test has left in a state that nobody knows. */
async function anew() {
  await browser.chromium.close().catch(() => {});
  await browser.start();
}

/** Runs a test (it may be no promise); in a new browser once more if the browser itself is gone. */
async function runOnceMoreIfGone(name, test) {
  try {
    await test(browser);
  } catch (error) {
    // A browser that has crashed (drawing in software, it may) says nothing about the page.
    if (!/has been closed|A valid external Instance reference no longer exists/.test(String(error))) throw error;
    console.log(`        ${name}: the browser is gone, once more in a new one`);
    await anew();
    await test(browser);
  }
}

/** Runs a test and tells whether it passed, and how. */
async function passes(name, test) {
  const start = Date.now();
  try {
    await runOnceMoreIfGone(name, test);
    console.log(`ok      ${name} (${((Date.now() - start) / 1000).toFixed(1)} s)`);
    return true;
  } catch (error) {
    console.log(`FAILED  ${name}\n        ${String(error?.stack ?? error).replaceAll('\n', '\n        ')}`);
    return false;
  } finally {
    await browser.tidy();
  }
}

// What fails is tried once more after all others, in a new browser: what passes then hangs on time, and is named at the end, so
// that it is mended; what fails twice fails.
const again = [];
for (const [name, test] of chosen) {
  if (!(await passes(name, test))) again.push([name, test]);
}
const failed = [];
for (const [name, test] of again) {
  console.log(`        once more: ${name}`);
  await anew();
  if (!(await passes(name, test))) failed.push(name);
}
await browser.close();
for (const [name] of again) console.log(failed.includes(name) ? `FAILED TWICE  ${name}` : `UNSTEADY      ${name}: failed, then passed`);
console.log(`${chosen.length - failed.length} passed, ${failed.length} failed`);
process.exitCode = failed.length > 0 || chosen.length === 0 ? 1 : 0;
