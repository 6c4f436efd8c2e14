/** What `goTo` and `queue` take, checked, as requests have it, and in words. */

import { PlayerError } from './errors.js';
import { poseName, words } from './format.js';

/** Of so many frames of a behaviour, the last one is planned in any case. */
const STEP = 5;

const wrong = (message) => new PlayerError('bad-argument', message);

/**
 * The frame that a target means.
 * @param {number | {frame?: number, sequence?: string, seconds?: number, behaviour?: string}} target
 * @param {import('./director.js').Director} director
 */
export function frameOfTarget(target, director) {
  const { info } = director;
  if (target && typeof target === 'object') {
    if (target.frame !== undefined) return frameOfTarget(target.frame, director);
    if (target.sequence !== undefined) return frameAt(director, target.sequence, target.seconds);
    if (target.behaviour !== undefined) return nearestOf(director, target.behaviour);
  }
  if (!Number.isInteger(target)) throw wrong('A target is a frame, a sequence with seconds, a behaviour, a place or a path.');
  if (target < 0 || target >= info.frames) throw wrong(`There is no frame ${target}; the actor has ${info.frames}.`);
  return target;
}

/**
 * Places, paths, and behaviours that are to be held have to be searched for.
 * @returns {object | null} the request's target, or null for a pose
 */
export function soughtTarget(target) {
  if (!target || typeof target !== 'object') return null;
  const { x, z, heading, path, stretches = [], shape = 'spline', vertices, behaviour, hold } = target;
  if (behaviour !== undefined && hold) return { behaviour: { name: behaviour, hold } };
  if (path !== undefined) return { path: { points: path, stretches, shape, vertices } };
  if (x === undefined && z === undefined) return null;
  return { place: { x, z, ...(heading === undefined || heading === null ? {} : { heading }) } };
}

/** What a target is in a request. */
export function requestTarget(target, director) {
  const { behaviour } = target;
  return soughtTarget(target) ?? (behaviour === undefined ? { pose: frameOfTarget(target, director) } : { behaviour: { name: behaviour } });
}

/** @returns {string} a target in a few words */
export function nameOf(target, director) {
  const { behaviour, hold } = target;
  if (behaviour !== undefined) return hold ? `${words(behaviour)} for ${hold} s` : words(behaviour);
  const frame = frameOfTarget(target, director);
  return poseName(director.timeline.sequenceOf(frame), frame, director.timeline.fps);
}

export function frameAt({ info, timeline }, sequence, seconds = 0) {
  const found = info.sequences.find(({ name }) => name === sequence);
  if (!found) throw wrong(`There is no sequence named “${sequence}”.`);
  return timeline.step(found.first, Math.round((Number(seconds) || 0) * info.fps));
}

/** Names of all behaviours: the labels, then the sequences whose name is no label. */
export function behavioursOf(info) {
  const labels = info.sequences.flatMap((sequence) => sequence.labels);
  return [...new Set([...labels, ...info.sequences.map(({ name }) => name)])];
}

/** The sequences that show a behaviour. As in the search, a label wins over a sequence of the same name. */
export function shownBy({ sequences }, behaviour) {
  const labelled = sequences.filter(({ labels }) => labels.includes(behaviour));
  return labelled.length > 0 ? labelled : sequences.filter(({ name }) => name === behaviour);
}

/**
 * The frame of a behaviour that is reached at the least cost. One in a few frames is planned, and those before it only where
 * they may be cheaper: from each of them the recording leads to it, at the cost of so many frames.
 */
function nearestOf(director, behaviour) {
  const { info } = director;
  const shows = shownBy(info, behaviour);
  if (shows.length === 0) throw wrong(`There is no behaviour named “${behaviour}”.`);
  const costs = new Map();
  let trouble = null;
  const costOf = (frame) => {
    if (!costs.has(frame)) {
      let cost = Infinity;
      try {
        ({ cost } = director.plan(frame));
      } catch (error) {
        trouble = error;
      }
      costs.set(frame, cost);
    }
    return costs.get(frame);
  };
  const gaps = shows.flatMap(({ first, count }) => {
    const ends = Array.from({ length: Math.ceil(count / STEP) }, (_, at) => Math.min(first + count - 1, first + at * STEP + STEP - 1));
    return ends.map((end, at) => ({ start: at === 0 ? first : ends[at - 1] + 1, end }));
  });
  const least = () => Math.min(...costs.values());
  gaps.forEach(({ end }) => costOf(end));
  for (const { start, end } of gaps) {
    for (let frame = start; frame < end; frame += 1) {
      if (costOf(end) - (end - frame) * info.alpha < least()) costOf(frame);
    }
  }
  const [best, cost] = [...costs].reduce((one, other) => (other[1] < one[1] ? other : one));
  if (cost === Infinity) throw trouble;
  return best;
}

/** Targets one after the other: the next one is told when the actor has arrived. */
export class Queue {
  /**
   * @param {(target: object | number) => void} go
   * @param {() => boolean} busy whether the actor is on its way to something
   */
  constructor(go, busy) {
    this.go = go;
    this.busy = busy;
    this.targets = [];
    /** Hears of every change. */
    this.changed = () => {};
    /** Hears of changes that somebody wanted, and of targets whose turn has come. */
    this.edited = () => {};
    this.taken = () => {};
  }

  /** Shows other targets, as undoing does. */
  show(targets) {
    this.targets = targets;
    this.changed();
  }

  set(targets) {
    if (targets.length === 0 && this.targets.length === 0) return;
    this.show(targets);
    this.edited();
  }

  clear() {
    this.set([]);
  }

  /** @returns whether it has to wait for its turn */
  add(target) {
    const waits = this.busy();
    if (waits) this.set([...this.targets, target]);
    else this.go(target);
    return waits;
  }

  next() {
    const [target, ...rest] = this.targets;
    if (target === undefined) return;
    this.show(rest);
    this.taken(target);
    this.go(target);
  }
}
