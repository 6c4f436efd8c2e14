/** The element's contract, as docs/embedding.md tells it: every attribute, method, event, slot and part. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { bundlePath } from '../browser.mjs';
import { withoutSection } from '../sections.mjs';
import { tests as errors } from './errors.mjs';
import { tests as loading } from './loading.mjs';
import { tests as page } from './page.mjs';
import { tests as parts } from './parts.mjs';
import { tests as toolTests } from './tools/all.mjs';
import { tests as walking } from './walking.mjs';

const www = new URL('../../../www/', import.meta.url);
const docs = new URL('../../../docs/embedding.md', import.meta.url);

/** The kind of section with alternatives of recorded stretches. */
const ALTERNATIVES = 91;

/** An empty page of the same site, with players made by the test. */
async function bare(browser, options) {
  const player = await browser.open({ ...options, path: 'examples/empty.html' });
  await player.page.evaluate(async () => {
    await import('/reprise-player.js');
    window.make = (attributes = {}, ...children) => {
      const element = document.createElement('reprise-player');
      for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
      element.append(...children);
      document.body.append(element);
      return element;
    };
  });
  return player;
}

async function loaded(browser, options) {
  const player = await browser.open(options);
  await player.loaded();
  await player.run((element) => {
    element.pause();
    element.seek(element.info.sequences[0].first + Math.floor(element.info.sequences[0].count / 3));
  });
  return player;
}

const kindOf = (player, work, argument) =>
  player.run(
    `async (element, argument) => { try { await (${work})(element, argument); return null; } catch (error) { return error.kind ?? String(error); } }`,
    argument,
  );

/** How a test that uses a documented name spells that: the name goes where NAME is. */
const USED = {
  attributes: [/\bNAME: (['"`]|true)/, /\.NAME = /, /setAttribute\('NAME'/],
  fields: [/\b(element|player|one|other)\)?\.NAME\b/, /\(\{[^{}]*\bNAME\b[^{}]*\}\) =>/],
  methods: [/\b(element|player|one|other)\.NAME\(/],
  events: [/\b(event|heard|addEventListener)\('NAME'/, /type === 'NAME'/],
  kinds: [/'NAME'/],
};

async function manifest() {
  const { modules: [{ declarations: [declared] }] } = JSON.parse(await readFile(new URL('custom-elements.json', www), 'utf8'));
  return declared;
}

export const tests = {
  'every documented attribute, member, event and error is used by a test': async () => {
    const declared = await manifest();
    const types = await readFile(new URL('reprise-player.d.ts', www), 'utf8');
    const kinds = types.slice(types.indexOf('type ErrorKind'), types.indexOf('interface PlayerError')).matchAll(/'([\w-]+)'/g);
    const documented = {
      attributes: declared.attributes,
      fields: declared.members.filter(({ kind, attribute }) => kind === 'field' && !attribute),
      methods: declared.members.filter(({ kind }) => kind === 'method'),
      events: declared.events,
      kinds: Array.from(kinds, ([, name]) => ({ name })),
    };
    // This test and the next one read lists; they use nothing.
    const [, , ...own] = Object.values(tests);
    const all = [...[errors, loading, page, parts, toolTests, walking].flatMap(Object.values), ...own].map(String);
    const untested = Object.entries(documented).flatMap(([what, list]) =>
      list
        .map(({ name }) => name)
        .filter((name) => !USED[what].some(({ source }) => all.some((text) => new RegExp(source.replaceAll('NAME', name)).test(text))))
        .map((name) => `${what}: ${name}`),
    );
    assert.deepEqual(untested, []);
  },

  'every attribute, member, event, slot and part is documented, typed, and in the manifest': async () => {
    const { ReprisePlayer } = await import(new URL('reprise-player.js', www));
    const [text, types, manifest] = await Promise.all([
      readFile(docs, 'utf8'),
      readFile(new URL('reprise-player.d.ts', www), 'utf8'),
      readFile(new URL('custom-elements.json', www), 'utf8').then(JSON.parse),
    ]);
    const [{ declarations: [player] }] = manifest.modules;
    const named = (list) => list.map(({ name }) => name).sort();
    assert.deepEqual(named(player.attributes), [...ReprisePlayer.observedAttributes, 'autoplay'].sort());
    const own = [ReprisePlayer, Object.getPrototypeOf(ReprisePlayer)].flatMap((one) => Object.getOwnPropertyNames(one.prototype));
    const inner = ['constructor', 'connectedCallback', 'disconnectedCallback', 'adoptedCallback', 'attributeChangedCallback'];
    assert.deepEqual(named(player.members), own.filter((name) => !inner.includes(name)).sort());
    const map = types.slice(types.indexOf('interface ReprisePlayerEventMap'), types.indexOf('declare global'));
    assert.deepEqual(named(player.events), [...map.matchAll(/^ {2}(\w+): CustomEvent/gm)].map(([, name]) => name).sort());
    const all = [...player.attributes, ...player.members, ...player.events, ...player.slots, ...player.cssParts, ...player.cssProperties];
    for (const { name } of all) assert.ok(text.includes(`\`${name}`), `docs/embedding.md does not tell of ${name}`);
    const kinds = types.slice(types.indexOf('type ErrorKind'), types.indexOf('interface PlayerError')).matchAll(/'([\w-]+)'/g);
    for (const [, kind] of kinds) assert.ok(text.includes(`\`${kind}\``), `docs/embedding.md does not tell of the error ${kind}`);
  },

  'every part and slot of the manifest is in the element': async (browser) => {
    const declared = await manifest();
    const player = await loaded(browser);
    const found = await player.run((element) => ({
      parts: [...element.shadowRoot.querySelectorAll('[part]')].map((one) => one.getAttribute('part')),
      slots: [...element.shadowRoot.querySelectorAll('slot')].map(({ name }) => name),
    }));
    assert.deepEqual([...new Set(found.parts)].sort(), declared.cssParts.map(({ name }) => name).sort());
    assert.deepEqual(found.slots.sort(), declared.slots.map(({ name }) => name).sort());
    await player.close();
  },

  'every part can be styled, and the custom properties reach what they say': async (browser) => {
    const declared = await manifest();
    const player = await loaded(browser);
    const styled = await player.run((element, parts) => {
      const sheet = new CSSStyleSheet();
      sheet.replaceSync(parts.map((part, at) => `reprise-player::part(${part}) { outline-color: rgb(1, 2, ${at + 1}); }`).join(''));
      document.adoptedStyleSheets = [sheet];
      return parts.map((part) => getComputedStyle(element.shadowRoot.querySelector(`[part="${part}"]`)).outlineColor);
    }, declared.cssParts.map(({ name }) => name));
    assert.deepEqual(styled, styled.map((_, at) => `rgb(1, 2, ${at + 1})`));
    const given = { '--reprise-accent': '#a01020', '--reprise-background': '#102030', '--reprise-font': 'monospace' };
    assert.deepEqual(declared.cssProperties.map(({ name }) => name).sort(), Object.keys(given).sort());
    const seen = await player.run(async (element, values) => {
      for (const [name, value] of Object.entries(values)) element.style.setProperty(name, value);
      element.theme = 'light';
      const { corner } = await element.testing.picture();
      const tool = element.shadowRoot.querySelector('.tool[aria-checked="true"]');
      return { accent: getComputedStyle(tool).color, background: getComputedStyle(element).backgroundColor, font: getComputedStyle(tool).fontFamily, corner };
    }, given);
    assert.deepEqual([seen.accent, seen.background, seen.font], ['rgb(160, 16, 32)', 'rgb(16, 32, 48)', 'monospace']);
    assert.ok(Math.abs(seen.corner[0] - 16) < 24 && Math.abs(seen.corner[2] - 48) < 24, `the stage's corner is ${seen.corner}`);
    await player.close();
  },

  'change and answer tell of what is asked and of what is found': async (browser) => {
    const player = await loaded(browser);
    await player.run((element) => {
      window.answers = [];
      element.addEventListener('answer', ({ detail }) => window.answers.push(detail.answer === element.answer));
      element.direction = { version: 1, target: { place: { x: 0.5, z: 0.5 } } };
    });
    // It is taken up once the module that searches is there to check it.
    await player.event('change');
    assert.deepEqual((await player.heard('change')).map(({ tool }) => tool), ['place']);
    await player.untilFound('an answer', () => window.answers.length > 0);
    assert.equal((await player.page.evaluate(() => window.answers)).at(-1), true);
    assert.ok((await player.heard('answer')).length > 0);
    await player.close();
  },

  'a page that is not on https says so': async (browser) => {
    const before = (page) =>
      page.addInitScript(() => {
        Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined });
        Object.defineProperty(window, 'isSecureContext', { value: false });
      });
    const player = await browser.open({ before });
    await player.event('error');
    assert.equal((await player.heard('error'))[0].kind, 'insecure');
    assert.match(await player.part('.error .happened').textContent(), /https|secure/);
    await player.close();
  },

  'what cannot be reached is thrown, what breaks inside is told': async (browser) => {
    const player = await loaded(browser);
    const kinds = await player.run((element) => {
      const { player: inner } = element.testing;
      inner.plan = inner.go_to = () => {
        throw Object.assign(new Error('No way.'), { kind: 'unreachable' });
      };
      return ['plan', 'goTo'].map((name) => {
        try {
          return element[name](20);
        } catch (error) {
          return error.kind;
        }
      });
    });
    assert.deepEqual(kinds, ['unreachable', 'unreachable']);
    const strip = await player.run((element) => element.testing.placeOf(40));
    await player.mouse.click(strip.x, strip.y);
    await player.until('a sentence', (element) => /cannot be reached/.test(element.shadowRoot.querySelector('.status').textContent));
    await player.run((element) => {
      element.testing.player.tick = () => {
        throw new Error('a fault of ours');
      };
      element.play();
    });
    await player.event('error');
    assert.equal((await player.heard('error'))[0].kind, 'internal');
    assert.match(await player.part('.error .happened').textContent(), /something went wrong/);
    await player.close();
  },

  'the package holds what it exports': async () => {
    const package_ = JSON.parse(await readFile(new URL('package.json', www), 'utf8'));
    for (const entry of [package_.main, package_.types, package_.customElements, ...package_.sideEffects]) await readFile(new URL(entry, www));
    const dist = new URL(`file://${process.env.REPRISE_DIST ?? new URL('../../../dist', import.meta.url).pathname}/`);
    for (const file of package_.files.filter((name) => name.includes('.'))) await readFile(new URL(file, dist));
  },

  'attributes are properties, and odd values do no harm': async (browser) => {
    const player = await bare(browser);
    const values = await player.page.evaluate(() => {
      const element = window.make();
      const before = ['src', 'poster', 'alt', 'loading', 'controls', 'autoplay', 'loop', 'tint', 'parts', 'theme', 'speed', 'camera', 'originals', 'tool'].map((name) => element[name]);
      for (const [name, value] of Object.entries({ speed: 'fast', theme: 'pink', loading: 'soon', tool: 'hammer', camera: 'up' })) element.setAttribute(name, value);
      const odd = ['speed', 'theme', 'loading', 'tool'].map((name) => element[name]);
      Object.assign(element, { controls: true, tint: true, parts: true, loop: true, autoplay: true, alt: 'somebody', loading: 'lazy', tool: 'path', speed: 2, theme: 'dark', camera: '10deg 5deg', originals: 'textures/%05d.webp' });
      element.theme = null;
      return { before, odd, html: element.outerHTML, state: [element.info, element.state, element.complete, element.playing, element.queued, element.behaviours, element.answer] };
    });
    assert.deepEqual(values.before, ['', '', '', 'eager', false, false, false, false, false, null, 1, '', '', 'pose']);
    assert.deepEqual(values.odd, [1, null, 'eager', 'pose']);
    for (const part of ['controls=""', 'tint=""', 'parts=""', 'loop=""', 'autoplay=""', 'alt="somebody"', 'loading="lazy"', 'tool="path"', 'speed="2"', 'camera="10deg 5deg"', 'originals="textures/%05d.webp"']) assert.ok(values.html.includes(part), part);
    assert.ok(!values.html.includes('theme'));
    assert.deepEqual(values.state, [null, null, false, false, [], [], null]);
    for (const call of ['play', 'pause', 'cancel', 'snapshot', 'toBlob']) assert.equal(await kindOf(player, `(element) => element.${call}()`), 'not-loaded', call);
    await player.close();
  },

  'null and undefined are no words': async (browser) => {
    const player = await bare(browser);
    const found = await player.page.evaluate(() => {
      const given = { src: '/a.reprise', poster: '/a.png', alt: 'a', loading: 'lazy', controls: true, autoplay: true, loop: true, tint: true, theme: 'dark', speed: 2, camera: '1deg 2deg', originals: 'a', tool: 'path' };
      // Not in the page, where an address would be fetched.
      const element = document.createElement('reprise-player');
      const fresh = Object.fromEntries(Object.keys(given).map((name) => [name, element[name]]));
      return [null, undefined].flatMap((nothing) =>
        Object.entries(given).map(([name, value]) => {
          element[name] = value;
          const [there, before] = [element.hasAttribute(name), element[name]];
          element[name] = nothing;
          return { name, there, taken: before === value, left: element.getAttribute(name), same: element[name] === fresh[name] };
        }),
      );
    });
    assert.equal(found.length, 26);
    for (const one of found) assert.deepEqual(one, { name: one.name, there: true, taken: true, left: null, same: true });
    await player.close();
  },

  'properties that were set before the class was there count': async (browser) => {
    const player = await browser.open({ path: 'examples/empty.html' });
    const found = await player.page.evaluate(async () => {
      const given = { src: '/demo.reprise', alt: 'somebody', controls: true, loop: false, tint: true, speed: 2, theme: 'dark', camera: '90deg 20deg 1.5', poster: null };
      const direction = { version: 1, target: { place: { x: 0.5, z: 0.25 } } };
      const parsed = document.createElement('div');
      parsed.setHTMLUnsafe?.('<reprise-player loop></reprise-player>');
      if (!parsed.firstChild) parsed.append(document.createElement('reprise-player'));
      const [inPage, later] = [parsed.firstChild, document.createElement('reprise-player')];
      document.body.append(parsed);
      for (const element of [inPage, later]) Object.assign(element, given, { direction, info: 'of somebody’s own', about: 'kept' });
      later.src = null;
      await import('/reprise-player.js');
      document.body.append(later);
      const read = (element) => ({ ...Object.fromEntries(Object.keys(given).map((name) => [name, element[name]])), own: Object.keys(element), info: element.info, about: element.about });
      window.given = [inPage, later];
      return { inPage: read(inPage), later: read(later), html: inPage.outerHTML };
    });
    const expected = { src: '/demo.reprise', alt: 'somebody', controls: true, loop: false, tint: true, speed: 2, theme: 'dark', camera: '90deg 20deg 1.5', poster: '', own: ['about'], info: null, about: 'kept' };
    assert.deepEqual(found.inPage, expected);
    assert.deepEqual(found.later, { ...expected, src: '' });
    assert.doesNotMatch(found.html, /null|undefined|loop/);
    // The first one has an actor: it looks that way, and is asked for that place.
    await player.event('load');
    await player.untilFound('an answer', () => window.given[0].answer !== null);
    const shown = await player.page.evaluate(() => {
      const [element] = window.given;
      return { direction: element.direction.target, tool: element.tool, camera: Array.from(element.testing.stage.camera()).at(-1), speed: element.shadowRoot.querySelector('.speed').value };
    });
    assert.deepEqual(shown.direction, { place: { x: 0.5, z: 0.25 } });
    assert.deepEqual([shown.tool, shown.speed], ['place', '2']);
    // Asked for nothing, as a framework does that takes a property away.
    await player.page.evaluate(() => {
      for (const nothing of [null, undefined]) window.given[0].direction = nothing;
    });
    assert.equal(await player.page.evaluate(() => window.given[0].direction), null);
    await player.close();
  },

  'the script of the tools is fetched when the first of them is needed, and only then': async (browser) => {
    const player = await bare(browser);
    const fetched = () => player.page.evaluate(() => performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('/reprise-tools.js')).length);
    await player.page.evaluate(() => window.make({ src: '/demo.reprise' }));
    await player.loaded();
    // What pages ask for needs no tools.
    const answer = await player.run((element) => element.goTo({ x: element.state.x + 0.5, z: element.state.z + 0.5 }));
    assert.ok(answer.place.distance < 0.5);
    await player.run((element) => {
      element.queue(20, { behaviour: element.behaviours[0], hold: 1 });
      element.cancel();
      element.goTo(40);
    });
    assert.deepEqual((await player.run((element) => element.direction)).target, { pose: 40 });
    assert.equal(await fetched(), 0);
    assert.equal(await player.run((element) => element.shadowRoot.querySelector('.tools')), null);
    // One that is asked for on the ground is drawn by its tool.
    await player.run((element) => (element.direction = { version: 1, target: { place: { x: 1, z: 1 } } }));
    assert.equal(await player.run((element) => element.tool), 'place');
    assert.deepEqual((await player.run((element) => element.direction)).target, { place: { x: 1, z: 1 } });
    await player.until('the tools', (element) => element.shadowRoot.querySelector('.place-dock'));
    assert.equal(await fetched(), 1);
    await player.untilFound('an answer', (element) => element.answer !== null);
    await player.run((element) => (element.controls = true));
    await player.until('all tools', (element) => element.shadowRoot.querySelectorAll('.tool').length === 6);
    assert.equal(await player.part('.place-dock').isVisible(), true);
    assert.equal(await fetched(), 1);
    await player.close();
  },

  'tools that do not come are told, and asked for again': async (browser) => {
    let refused = 2;
    const before = (page) => page.route('**/reprise-tools.js', (route) => (refused-- > 0 ? route.abort() : route.continue()));
    const player = await bare(browser, { before, forgive: [/Failed to load resource/] });
    await player.page.evaluate(() => window.make({ src: '/demo.reprise', controls: '' }));
    await player.event('error');
    assert.deepEqual((await player.heard('error')).map(({ kind }) => kind), ['engine']);
    // The actor is there all the same.
    await player.loaded();
    assert.ok((await player.run((element) => element.testing.picture())).drawn > 0.01);
    assert.match(await player.part('.error .happened').textContent(), /program could not be loaded/);
    await player.run((element) => (element.tool = 'path'));
    await player.until('the second trouble', () => window.heard.filter(({ type }) => type === 'error').length === 2);
    await player.run((element) => (element.tool = 'timing'));
    await player.until('the tools', (element) => element.shadowRoot.querySelector('.timing-dock'));
    await player.close();
  },

  'tools of another build are refused': async (browser) => {
    const other = { contentType: 'text/javascript', body: 'export const build00000000 = () => ({ Tools: class {} });' };
    const player = await bare(browser, { before: (page) => page.route('**/reprise-tools.js', (route) => route.fulfill(other)) });
    await player.page.evaluate(() => window.make({ src: '/demo.reprise', controls: '' }));
    await player.event('error');
    assert.deepEqual((await player.heard('error')).map(({ kind }) => kind), ['engine']);
    assert.match(await player.part('.error .todo').textContent(), /reload the page/);
    await player.loaded();
    await player.close();
  },

  'variety is a share from 0 to 1, and its slider sets it': async (browser) => {
    const player = await loaded(browser);
    const seen = await player.run(async (element) => {
      element.controls = true;
      await element.testing.searching();
      const told = ['0.25', '7', 'much', null].map((value) => {
        if (value === null) element.removeAttribute('variety');
        else element.setAttribute('variety', value);
        return element.variety;
      });
      element.variety = 0.5;
      return { told, attribute: element.getAttribute('variety'), varies: element.info.varies };
    });
    assert.deepEqual(seen, { told: [0.25, 1, 1, 1], attribute: '0.5', varies: true });
    const slider = player.part('.toolbar [aria-label="Variety"]');
    await player.until('the slider', (element) => element.shadowRoot.querySelector('.toolbar [aria-label="Variety"]')?.value === '0.5');
    await slider.fill('0.2');
    assert.equal(await player.run((element) => element.variety), 0.2);
    await player.close();
  },

  'an actor without alternatives has no slider for variety': async (browser) => {
    const body = withoutSection(await readFile(bundlePath), ALTERNATIVES);
    const before = (page) => page.route('**/plain.reprise', (route) => route.fulfill({ body, contentType: 'application/octet-stream' }));
    const player = await bare(browser, { before });
    await player.page.evaluate(() => window.make({ src: '/plain.reprise', controls: '' }));
    await player.loaded();
    assert.equal(await player.run(async (element) => (await element.testing.searching(), element.info.varies)), false);
    await player.until('the tools', (element) => element.shadowRoot.querySelector('.toolbar'));
    assert.equal(await player.part('.toolbar [aria-label="Variety"]').isVisible(), false);
    await player.close();
  },

  'controls are off unless asked for': async (browser) => {
    const player = await loaded(browser);
    for (const [on, shown] of [[false, false], [true, true]]) {
      await player.run((element, value) => (element.controls = value), on);
      for (const part of ['.strips', '.transport', '.chips.right', '.tools']) assert.equal(await player.part(part).isVisible(), shown, `${part} with controls ${on}`);
    }
    await player.close();
  },

  'a lazy player loads when it is about to be seen': async (browser) => {
    const player = await bare(browser);
    await player.page.evaluate(() => {
      const space = document.createElement('div');
      space.className = 'space';
      document.body.append(space);
      window.make({ src: '/demo.reprise', loading: 'lazy' });
    });
    // What is near is told with a display frame.
    await player.until('a look inside', (element) => Boolean(element.testing));
    await player.frames(3);
    assert.equal(await player.run((element) => element.testing.loads()), false);
    await player.run((element) => element.scrollIntoView());
    await player.event('load');
    await player.close();
  },

  'poster, progress and error can be the page’s own': async (browser) => {
    const player = await bare(browser, { forgive: [/Failed to load resource/] });
    const shown = (id) => player.page.evaluate((name) => document.getElementById(name).checkVisibility(), id);
    await player.page.evaluate(() => {
      const own = ['poster', 'progress', 'error', 'bar'].map((slot) => Object.assign(document.createElement('p'), { slot, id: slot, textContent: slot }));
      const element = window.make({ src: '/slow.reprise', controls: '' }, ...own);
      const look = () => [...own, element.shadowRoot.querySelector('.progress')].map((one) => one.checkVisibility());
      element.addEventListener('progress', () => (window.first ??= look()));
    });
    await player.until('loading', () => Boolean(window.first));
    assert.deepEqual(await player.page.evaluate(() => window.first), [true, true, false, true, false]);
    await player.event('load');
    assert.deepEqual([await shown('poster'), await shown('progress'), await shown('error')], [false, false, false]);
    await player.run((element) => (element.src = '/nowhere.reprise'));
    await player.event('error');
    assert.equal(await shown('error'), true);
    assert.equal(await player.part('.error').isVisible(), false);
    await player.close();
  },

  'the poster is there until the first pose is': async (browser) => {
    const player = await bare(browser);
    await player.page.evaluate(() => window.make({ src: '/held.reprise', poster: '/favicon.svg', alt: 'A dancer' }));
    assert.equal(await player.part('.poster').isVisible(), true);
    assert.equal(await player.part('.poster').getAttribute('alt'), 'A dancer');
    await player.event('progress');
    await player.page.evaluate(() => fetch('/rest'));
    await player.event('ready');
    assert.equal(await player.part('.poster').isVisible(), false);
    await player.until('the words', (element) => /^A dancer, /.test(element.shadowRoot.querySelector('.view').getAttribute('aria-label')));
    await player.close();
  },

  'camera is where the first view is taken from, and recentre goes back there': async (browser) => {
    const player = await bare(browser, { reducedMotion: 'reduce' });
    await player.page.evaluate(() => window.make({ src: '/demo.reprise', camera: '90deg 20deg 1.5' }));
    await player.loaded();
    const camera = () => player.run((element) => Array.from(element.testing.stage.camera(), (one) => Number(one.toFixed(3))));
    assert.deepEqual(await camera(), [1.571, 0.349, 1.5]);
    await player.run((element) => {
      element.testing.stage.orbit(60, 10);
      element.testing.stage.zoom(1.4);
    });
    assert.notDeepEqual(await camera(), [1.571, 0.349, 1.5]);
    await player.run((element) => element.recentre());
    assert.deepEqual(await camera(), [1.571, 0.349, 1.5]);
    await player.run((element) => (element.camera = '0deg 10deg'));
    assert.deepEqual(await camera(), [0, 0.175, 1]);
    await player.close();
  },

  'tint, loop, speed and theme reach the actor and the picture': async (browser) => {
    const player = await loaded(browser);
    const corner = () => player.run(async (element) => (await element.testing.picture()).corner);
    await player.run((element) => (element.theme = 'dark'));
    assert.ok(Math.max(...(await corner())) < 80);
    await player.run((element) => (element.theme = 'light'));
    assert.ok(Math.min(...(await corner())) > 180);
    await player.run((element) => (element.tint = true));
    assert.equal(await player.part('.chip[aria-pressed="true"]').textContent(), 'tint');
    const frames = async (speed) =>
      player.run((element, rate) => {
        element.speed = rate;
        element.seek(10);
        element.play();
        for (let tick = 0; tick < 4; tick += 1) element.testing.player.tick(0.05);
        element.pause();
        return JSON.parse(element.testing.player.state()).frame - 10;
      }, speed);
    const [slow, fast] = [await frames(1), await frames(2)];
    assert.ok(Math.abs(fast - 2 * slow) < 0.01, `${slow} and ${fast}`);
    const ends = await player.run((element) => {
      const { first, count } = element.info.sequences.find(({ cyclic }) => !cyclic);
      element.loop = false;
      element.speed = 1;
      element.seek(first + count - 3);
      element.play();
      for (let tick = 0; tick < 20; tick += 1) element.testing.player.tick(0.1);
      return element.playing;
    });
    assert.equal(ends, false);
    await player.event('end');
    await player.close();
  },

  'goTo, plan and queue take frames, poses and behaviours': async (browser) => {
    const player = await loaded(browser);
    const frame = await player.target();
    const walks = await player.run((element, wanted) => {
      const sequence = element.info.sequences.find(({ first, count }) => wanted >= first && wanted < first + count);
      const seconds = (wanted - sequence.first) / element.info.fps;
      return {
        plain: element.plan(wanted).to,
        record: element.plan({ frame: wanted }).to,
        pose: element.plan({ sequence: sequence.name, seconds }).to,
        frameOf: element.frameOf(sequence.name, seconds),
        behaviour: element.plan({ behaviour: sequence.name }),
        sequence,
        behaviours: element.behaviours,
      };
    }, frame);
    assert.deepEqual([walks.plain, walks.record, walks.pose, walks.frameOf], [frame, frame, frame, frame]);
    const { sequence, behaviour } = walks;
    assert.ok(behaviour.to >= sequence.first && behaviour.to < sequence.first + sequence.count);
    assert.ok(walks.behaviours.length > 0);
    // Nearest is what costs least of all frames that show it.
    const nearest = await player.run((element) => {
      const { info } = element;
      const cost = (frame) => {
        try {
          return element.plan(frame).cost;
        } catch {
          return Infinity;
        }
      };
      return element.behaviours.slice(0, 3).map((behaviour) => {
        const labelled = info.sequences.filter(({ labels }) => labels.includes(behaviour));
        const shows = labelled.length > 0 ? labelled : info.sequences.filter(({ name }) => name === behaviour);
        const all = shows.flatMap(({ first, count }) => Array.from({ length: count }, (_, at) => cost(first + at)));
        return [element.plan({ behaviour }).cost, Math.min(...all)];
      });
    });
    nearest.forEach(([found, least]) => assert.equal(found, least));
    for (const bad of ['-1', '1e9', '0.5', '"walk"', 'null', '{}', '{ behaviour: "flying" }', '{ sequence: "nowhere" }']) {
      assert.equal(await kindOf(player, `(element) => element.goTo(${bad})`), 'bad-argument', bad);
      assert.equal(await kindOf(player, `(element) => element.queue(${bad})`), 'bad-argument', bad);
    }
    // What promises an answer rejects, and throws nothing.
    const refused = await player.run((element) => {
      const asked = [element.direct({ version: 1 }), element.direct(null), element.goTo({ path: [['a']] }), element.hold(3)];
      return Promise.all(asked.map((promise) => promise.then(() => null, ({ kind }) => kind)));
    });
    assert.deepEqual(refused, Array(4).fill('bad-argument'));
    const other = await player.target(frame);
    await player.run((element, targets) => {
      element.speed = 4;
      element.queue(...targets);
    }, [frame, { frame: other }, frame]);
    assert.deepEqual(await player.run((element) => element.queued), [{ frame: other }, frame]);
    await player.until('three arrivals', () => window.heard.filter(({ type }) => type === 'arrive').length === 3);
    assert.deepEqual((await player.heard('arrive')).map(({ frame: at }) => at), [frame, other, frame]);
    assert.deepEqual(await player.run((element) => element.queue({ behaviour: element.behaviours[1], hold: 1 }) ?? element.queued), []);
    await player.untilFound('the way to a behaviour', (element) => element.state.target !== null);
    await player.run((element, targets) => {
      element.queue(...targets);
      element.cancel();
    }, [other, frame]);
    assert.deepEqual(await player.run((element) => [element.queued, element.state.target]), [[], null]);
    await player.close();
  },

  'the frame event tells every moment that is shown': async (browser) => {
    const player = await loaded(browser);
    await player.run((element) => {
      window.moments = [];
      element.addEventListener('frame', ({ detail }) => window.moments.push(detail));
      element.play();
    });
    await player.until('some frames', () => window.moments.length > 5);
    const moments = await player.page.evaluate(() => window.moments);
    moments.forEach((one) => assert.deepEqual(Object.keys(one), ['frame', 'mode', 'x', 'z', 'heading']));
    assert.ok(new Set(moments.map(({ frame }) => frame)).size > 4);
    await player.run((element) => element.pause());
    await player.until('rest', (element) => element.testing.rests());
    const count = () => player.page.evaluate(() => window.moments.length);
    const rest = await count();
    await player.frames(10);
    assert.equal(await count(), rest, 'frames are told while nothing moves');
    await player.close();
  },

  'pictures can be taken': async (browser) => {
    const player = await loaded(browser);
    const picture = await player.run(async (element) => {
      const [stage, pose] = [await element.snapshot(), await element.snapshot({ frame: 20, width: 90, height: 120 })];
      const blob = await element.toBlob({ frame: 20, width: 90, height: 120 });
      const jpeg = await element.toBlob({ type: 'image/jpeg', quality: 0.8 });
      const bitmap = await createImageBitmap(blob);
      const alpha = pose.data.filter((_, at) => at % 4 === 3);
      return { stage: [stage.width, stage.height, stage.data.length], pose: [pose.width, pose.height], clear: alpha.filter((one) => one === 0).length, drawn: alpha.filter((one) => one > 200).length, bitmap: [bitmap.width, bitmap.height], types: [blob.type, jpeg.type] };
    });
    assert.equal(picture.stage[2], picture.stage[0] * picture.stage[1] * 4);
    assert.deepEqual([picture.pose, picture.bitmap, picture.types], [[90, 120], [90, 120], ['image/png', 'image/jpeg']]);
    assert.ok(picture.clear > 2000 && picture.drawn > 500, JSON.stringify(picture));
    const largest = await player.run(async (element) => {
      const { width, height, data } = await element.snapshot({ frame: 20, width: 1024, height: 600 });
      return [width, height, data.length];
    });
    assert.deepEqual(largest, [1024, 600, 4 * 1024 * 600]);
    for (const bad of ['{ frame: 1e9 }', '{ frame: 2, width: 0 }', '{ frame: 2, height: 1e6 }', '{ frame: 2, width: 1.5 }', '{ frame: 2, width: 1025 }']) {
      assert.equal(await kindOf(player, `(element) => element.snapshot(${bad})`), 'bad-argument', bad);
    }
    await player.close();
  },

  'reload begins anew, and pressKey does what keys do': async (browser) => {
    const player = await loaded(browser);
    await player.run((element) => element.reload());
    await player.until('the second load', () => window.heard.filter(({ type }) => type === 'load').length === 2);
    const used = await player.run((element) => {
      const press = (key) => element.pressKey(new KeyboardEvent('keydown', { key, cancelable: true }));
      const before = element.loop;
      return [press('l'), element.loop !== before, press('F13')];
    });
    assert.deepEqual(used, [true, true, false]);
    await player.close();
  },

  'the frame loop waits where it stalls, and says so': async (browser) => {
    const player = await browser.open({ search: 'src=faults/broken-off.reprise', forgive: [/Failed to load resource/] });
    await player.event('ready');
    await player.page.evaluate(() => fetch('/rest'));
    await player.event('error');
    await player.until('the test hook', (element) => Boolean(element.testing));
    await player.run((element) => {
      const { player: inner } = element.testing;
      const frames = element.info.sequences.flatMap(({ first, count }) => Array.from({ length: count - 1 }, (_, at) => first + at));
      const here = frames.find((frame) => inner.loaded(frame) && !inner.loaded(frame + 1));
      element.seek(here);
      element.play();
    });
    await player.event('stall');
    await player.close();
  },

  'the plain page of the examples': async (browser) => {
    const player = await browser.open({ path: 'examples/plain.html' });
    await player.event('load');
    await player.page.locator('button').first().click();
    await player.event('arrive');
    await player.close();
  },

  'two players on one page keep apart': async (browser) => {
    const player = await browser.open({ path: 'examples/two.html' });
    await player.until('both', () => [...document.querySelectorAll('reprise-player')].every(({ complete }) => complete));
    const frames = await player.page.evaluate(() => {
      const [one, other] = document.querySelectorAll('reprise-player');
      one.pause();
      other.pause();
      one.seek(10);
      other.seek(30);
      return [one.state.frame, other.state.frame];
    });
    assert.deepEqual(frames, [10, 30]);
    await player.page.evaluate(() => document.querySelector('reprise-player').remove());
    await player.frames(3);
    assert.equal(await player.page.evaluate(() => document.querySelector('reprise-player').state.frame), 30);
    await player.close();
  },

  'a framework’s component drives the element': async (browser) => {
    const player = await browser.open({ path: 'examples/framework.html' });
    await player.event('load');
    await player.until('the list', () => document.querySelectorAll('li button').length > 1);
    await player.page.locator('li button').nth(1).click();
    await player.event('arrive');
    await player.until('the sentence', () => /arrived/.test(document.querySelector('output').textContent));
    await player.close();
  },
};
