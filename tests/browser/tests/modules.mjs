/** What needs no browser: sentences, layout, the import on a server, the types against the class. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';

const www = new URL('../../../www/', import.meta.url);
const format = await import(new URL('player/format.js', www));
const { layoutScore } = await import(new URL('player/layout.js', www));
const { Timeline } = await import(new URL('player/timeline.js', www));
const { actorAddress } = await import(new URL('player/loading.js', www));
const { coarseFirst } = await import(new URL('player/thumbnails.js', www));
const { EMPTY, partOf, requestOf } = await import(new URL('player/tools/request.js', www));
const link = await import(new URL('player/tools/link.js', www));

/** Sequences of these lengths, one after the other, at 50 frames a second. */
function timeline(counts) {
  let first = 0;
  const sequences = counts.map((count, index) => ({ name: `s${index}`, first: (first += count) - count, count, cyclic: false, labels: [] }));
  return new Timeline({ fps: 50, frames: first, sequences });
}

export const tests = {
  'importing on a server does not throw': async () => {
    assert.equal(globalThis.HTMLElement, undefined);
    assert.equal(globalThis.customElements, undefined);
    const { ReprisePlayer } = await import(new URL('reprise-player.js', www));
    assert.equal(typeof ReprisePlayer.prototype.goTo, 'function');
  },

  'every member that the types promise exists, and no other': async () => {
    const { ReprisePlayer } = await import(new URL('reprise-player.js', www));
    const types = await readFile(new URL('reprise-player.d.ts', www), 'utf8');
    const body = types.slice(types.indexOf('extends HTMLElement {'), types.indexOf('\n}\n'));
    const promised = [...body.matchAll(/^ {2}(?:readonly |get |set )?(\w+)(?:[:(])/gm)].map(([, name]) => name);
    const own = [ReprisePlayer, Object.getPrototypeOf(ReprisePlayer)].flatMap((one) => Object.getOwnPropertyNames(one.prototype));
    const inner = ['constructor', 'connectedCallback', 'disconnectedCallback', 'adoptedCallback', 'attributeChangedCallback'];
    assert.deepEqual([...new Set(promised)].sort(), own.filter((name) => !inner.includes(name)).sort());
  },

  'numbers and sentences': () => {
    assert.equal(format.clock(3.42), '00:03.42');
    assert.equal(format.clock(59.999), '01:00.00');
    assert.equal(format.clock(-1), '00:00.00');
    assert.equal(format.clock(NaN), '00:00.00');
    assert.equal(format.megabytes(4_100_000, 11_800_000), '4.1 of 11.8 MB');
    assert.equal(format.megabytes(4_100_000, 0), '4.1 MB');
    assert.equal(format.walkSentence({ seconds: 2.41, transitions: 2 }), 'goes there in 2.4 s, through 2 transitions');
    assert.equal(format.walkSentence({ seconds: 1, transitions: 1 }), 'goes there in 1.0 s, through 1 transition');
    assert.equal(format.walkSentence({ seconds: 0.3, transitions: 0 }), 'goes there in 0.3 s, without a transition');
  },

  'every frame has its place on one strip, and the place gives the frame back': () => {
    for (const counts of [[200, 80, 75, 400], [1], [1, 2, 3], Array(30).fill(90), [6000]]) {
      const line = timeline(counts);
      for (const [width, height] of [[1248, 148], [366, 300], [320, 200], [2528, 148]]) {
        const layout = layoutScore(line, { width, height, labels: counts.map((_, index) => 20 + (index % 5) * 14) });
        for (const strip of layout.strips) {
          assert.ok(strip.x + strip.width <= width + 0.5, `${counts} at ${width}: strip ${strip.index} is cut off`);
          const other = layout.strips.find((one) => one.index < strip.index && one.y === strip.y && one.x + one.width > strip.labelX);
          assert.equal(other, undefined, `${counts} at ${width}: strips overlap`);
        }
        for (let frame = 0; frame < line.frames; frame += 7) {
          assert.equal(layout.frameAt(layout.xOf(frame), layout.stripOf(frame).y + 20), frame);
        }
        assert.equal(layout.frameAt(-5, 30), -1);
      }
    }
  },

  'thumbnails lie inside their sequence, half a second apart': () => {
    const line = timeline([200, 1, 12, 77]);
    for (const [index, { first, count }] of line.sequences.entries()) {
      const frames = line.thumbnails(index);
      assert.ok(frames.length >= 1);
      frames.forEach((frame) => assert.ok(frame >= first && frame < first + count));
      frames.slice(1).forEach((frame, at) => assert.ok(Math.abs(frame - frames[at] - 25) <= 3));
    }
    assert.equal(line.thumbnails(0).length, 8);
  },

  'coarse before fine leaves nothing out and says nothing twice': () => {
    for (const length of [0, 1, 2, 7, 8, 9, 61]) {
      const frames = Array.from({ length }, (_, at) => at * 3);
      assert.deepEqual([...coarseFirst(frames)].sort((a, b) => a - b), frames);
    }
  },

  'stepping stays inside the capture': () => {
    const line = timeline([100, 30]);
    assert.equal(line.step(99, 1), 99);
    assert.equal(line.step(0, -1), 0);
    assert.equal(line.across(80, 1), 129);
    assert.equal(line.across(110, -1), 10);
    assert.equal(line.across(110, 1), 110);
  },

  'requests go through the tools unchanged': () => {
    const line = timeline([100, 30]);
    const targets = [
      { place: { x: 1, z: 2, realism: 0.3 } },
      { place: { x: 1, z: 2, heading: 0, realism: 0.3 } },
      { place: { x: 1.5, z: -2, exactness: 0.5 } },
      { path: { points: [[0, 0], [1, 1]], stretches: [{ from: 0, to: 1, behaviour: 's1' }], shape: 'spline', realism: 0.5, exactness: 0.25 } },
      { path: { points: [[0, 1, 0], [1, 1.5, 1]], stretches: [], shape: 'polyline', vertices: [1, 2] } },
      { keys: { poses: [{ pose: 3, time: 1 }, { pose: 120, time: 2 }] } },
      { wander: { seconds: 60, weights: { s0: 2 } } },
      { pose: 7 },
    ];
    for (const target of targets) {
      const request = { version: 1, seed: target.wander ? 4 : 0, target };
      const { tool, part } = partOf(request, line);
      assert.deepEqual(requestOf(tool, { ...EMPTY, ...part }), request);
      assert.deepEqual(link.fromHash(link.toHash(request)), request);
    }
    // Long ones too.
    const long = { version: 1, target: { path: { points: Array.from({ length: 4096 }, (_, at) => [at / 7, at / 3, at / 11]) } } };
    assert.deepEqual(link.fromHash(link.toHash(long)), long);
  },

  'a pose beyond its sequence is not one of the next': () => {
    const line = timeline([100, 30]);
    const frames = (pose) => partOf({ target: { keys: { poses: [{ pose, time: 1 }] } } }, line).part.keys[0].frame;
    assert.equal(frames({ sequence: 's1', time: 0.2 }), 110);
    assert.equal(frames({ sequence: 's0', frame: 99 }), 99);
    for (const beyond of [{ sequence: 's0', frame: 100 }, { sequence: 's0', time: 2 }, { sequence: 's1', frame: 30 }, { sequence: 'nowhere' }]) {
      assert.ok(frames(beyond) >= 130, JSON.stringify(beyond));
    }
  },

  'an address is taken only over http and https': () => {
    const base = 'https://example.org/page/';
    assert.equal(actorAddress('a.reprise', base).href, 'https://example.org/page/a.reprise');
    assert.equal(actorAddress('//cdn.example.org/a.reprise', base).href, 'https://cdn.example.org/a.reprise');
    for (const bad of ['javascript:alert(1)', 'data:,x', 'file:///etc/passwd', 'http://', 'ftp://example.org/a.reprise']) {
      assert.throws(() => actorAddress(bad, base), { kind: 'bad-address' }, bad);
    }
  },
};
