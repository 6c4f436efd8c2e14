/** Which moment of the source belongs to each frame of the target: straight between keys, or as `transfer.json` tells it was found. */

import { groupOf, grouped } from './rules.js';

/**
 * @typedef {object} FrameMap
 * @property {string} from a sequence of the source
 * @property {string} to a sequence of the target
 * @property {string | null} stretch
 * @property {number} fromFirst first frame of the source, counted within its sequence
 * @property {number} fromLast
 * @property {number} toFirst first frame of the target, counted within its sequence
 * @property {number} toLast
 * @property {number[]} path for each frame of the target the moment of the source, in frames of its sequence
 * @property {{rows: number, columns: number, values: Uint8Array} | null} costs how improbable it is that frames belong together, 0 to 255:
 * rows are the source's frames from the first to the last, columns the target's
 */

/** @param {import('./toml.js').KeyPair[]} pairs @returns {FrameMap[]} of all stretches with two keys or more in which time goes on */
export function linearMaps(pairs) {
  const maps = [];
  for (const keys of grouped(pairs)) {
    const good = keys.filter((key, index) => index === 0 || (key.fromFrame > keys[index - 1].fromFrame && key.toFrame > keys[index - 1].toFrame));
    if (good.length < 2) continue;
    const [first, last] = [good[0], good.at(-1)];
    const path = [first.fromFrame];
    for (let at = 1; at < good.length; at += 1) {
      const [a, b] = [good[at - 1], good[at]];
      for (let frame = a.toFrame + 1; frame <= b.toFrame; frame += 1) {
        path.push(a.fromFrame + ((frame - a.toFrame) / (b.toFrame - a.toFrame)) * (b.fromFrame - a.fromFrame));
      }
    }
    maps.push({ from: first.from, to: first.to, stretch: first.stretch, fromFirst: first.fromFrame, fromLast: last.fromFrame, toFirst: first.toFrame, toLast: last.toFrame, path, costs: null });
  }
  return maps;
}

/** The moment of the source at a moment of the target, both in frames of their sequences. */
export function sourceAt({ path, toFirst }, frame) {
  const at = Math.min(path.length - 1, Math.max(0, frame - toFirst));
  const before = Math.floor(at);
  const after = Math.min(path.length - 1, before + 1);
  return path[before] + (path[after] - path[before]) * (at - before);
}

/** What `builder transfer` has told. */
class Transfer {
  constructor(told) {
    this.source = String(told.source ?? '');
    this.target = String(told.target ?? '');
    this.pairs = (told.keys?.pair ?? []).map((pair) => ({ from: pair.from, fromFrame: pair.from_frame, to: pair.to, toFrame: pair.to_frame, stretch: pair.stretch ?? null, comments: [] }));
    this.maps = told.maps.map(mapOf);
    this.doubts = told.learned?.doubts ?? [];
    /** Sentences, but for those on doubts. */
    this.warnings = (told.warnings ?? []).filter(({ code }) => code !== 'W_TRANSFER_KEY').map(({ message }) => `${message}.`);
    this.sequences = told.sequences ?? [];
    this.known = signature(this.pairs);
  }

  /** Whether it was made of exactly these pairs. */
  fits(pairs) {
    return signature(pairs) === this.known;
  }
}

function signature(pairs) {
  const names = pairs.map((pair) => `${groupOf(pair)} ${pair.fromFrame} ${pair.toFrame}`);
  return [...new Set(names)].sort().join('\n');
}

/** @throws a sentence where it is no `transfer.json` @returns {Transfer} */
export function readTransfer(text) {
  let told;
  try {
    told = JSON.parse(text);
  } catch (error) {
    throw new Error(`this is no JSON (${error.message}).`);
  }
  if (told === null || typeof told !== 'object' || !Array.isArray(told.sequences) || !Array.isArray(told.keys?.pair ?? [])) {
    throw new Error('this is no transfer.json; builder transfer writes one into its output folder.');
  }
  if (!Array.isArray(told.maps)) throw new Error('this transfer.json has no maps of frames; an older builder wrote it: transfer again.');
  return new Transfer(told);
}

function mapOf(told, index) {
  const { from, to, stretch = null, from_first: fromFirst, from_last: fromLast, to_first: toFirst, to_last: toLast, path, costs } = told;
  const broken = () => new Error(`map ${index + 1} of this transfer.json is damaged; transfer again.`);
  const frames = [fromFirst, fromLast, toFirst, toLast];
  if (typeof from !== 'string' || typeof to !== 'string' || !frames.every((frame) => Number.isInteger(frame) && frame >= 0)) throw broken();
  if (!Array.isArray(path) || path.length !== toLast - toFirst + 1 || !path.every(Number.isFinite)) throw broken();
  const map = { from, to, stretch, fromFirst, fromLast, toFirst, toLast, path, costs: null };
  if (costs) {
    const values = bytesOf(costs.values);
    const [rows, columns] = [Number(costs.rows), Number(costs.columns)];
    if (!values || rows < 1 || columns < 1 || values.length !== rows * columns) throw broken();
    map.costs = { rows, columns, values };
  }
  return map;
}

/** The bytes of a text in base64, or null. */
function bytesOf(text) {
  try {
    return Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  } catch {
    return null;
  }
}
