/** What `goTo` and `queue` take, checked, as requests have it, and in words. */

import { PlayerError } from './errors.js';
import { poseName, words } from './format.js';

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
    if (target.behaviour !== undefined) return director.nearest(String(target.behaviour));
  }
  if (!Number.isInteger(target)) throw wrong('A target is a frame, a sequence with seconds, a behaviour, a place or a path.');
  if (target < 0 || target >= info.frames) throw wrong(`There is no frame ${target}; the actor has ${info.frames}.`);
  return target;
}

/** Whether a target is a member of a family, `gait@1.4`: which one, the module that searches knows. */
export const isMember = (target) => /@[\d.-]+$/.test(target?.behaviour);

/**
 * Places, paths, members of families, and behaviours that are to be held have to be searched for.
 * @returns {object | null} the request's target, or null for a pose
 */
export function soughtTarget(target) {
  if (!target || typeof target !== 'object') return null;
  const { x, z, heading, pose, path, stretches = [], shape = 'spline', vertices, behaviour, hold, exactness } = target;
  if (behaviour !== undefined && (hold || isMember(target))) return { behaviour: { name: behaviour, hold: hold || 0 } };
  if (path !== undefined) return { path: { points: path, stretches, shape, vertices, exactness } };
  if (x === undefined && z === undefined) return null;
  return { place: { x, z, pose, exactness, ...(heading === undefined || heading === null ? {} : { heading }) } };
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
