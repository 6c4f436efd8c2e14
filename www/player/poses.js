/** The poses shown around the actor, chosen anew as it moves. */

import { suggestPoses } from './suggestions.js';

/** Milliseconds between two choices of poses around a moving actor. */
const ANEW = 1500;

export class Poses {
  /** @param {() => void} changed the choice has */
  constructor(changed) {
    this.changed = changed;
    this.on = false;
    this.frames = [];
    this.run = 0;
    this.at = 0;
  }

  /** Forgets what was chosen, and drops the answer of a choice under way. */
  clear() {
    this.frames = [];
    this.run += 1;
  }

  due(now) {
    return this.on && now - this.at > ANEW;
  }

  /** @param {import('./director.js').Director | null} director */
  async choose(director) {
    const run = (this.run += 1);
    this.at = performance.now();
    const wanted = () => run === this.run;
    const frames = this.on && director?.info ? await suggestPoses(director, wanted) : [];
    if (!wanted()) return;
    this.frames = frames;
    this.changed();
  }
}
