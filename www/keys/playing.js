/** Source and target at matched frames, beside each other. */

import { sourceAt } from './maps.js';

/** Seconds between two display frames, at most: who was away goes on where it was. */
const LONGEST = 0.1;

/** Calls something once a display frame with the seconds since the last. */
export class Clock {
  /** @param {(seconds: number) => void} tick */
  constructor(tick) {
    this.tick = tick;
    this.handle = 0;
  }

  get on() {
    return this.handle !== 0;
  }

  start() {
    let before = performance.now();
    const step = (now) => {
      this.handle = requestAnimationFrame(step);
      this.tick(Math.min(LONGEST, Math.max(0, (now - before) / 1000)));
      before = now;
    };
    this.handle = requestAnimationFrame(step);
  }

  stop() {
    cancelAnimationFrame(this.handle);
    this.handle = 0;
  }
}

export class Playing {
  /**
   * @param {import('./side.js').Side} source
   * @param {import('./side.js').Side} target
   * @param {() => import('./maps.js').FrameMap[]} maps between the sequences that are shown
   * @param {() => void} changed it has begun, or ended
   */
  constructor(source, target, maps, changed) {
    Object.assign(this, { source, target, maps, changed });
    this.clock = new Clock((seconds) => this.step(seconds));
    this.parts = [];
  }

  get on() {
    return this.clock.on;
  }

  /** @returns whether there is anything to play */
  toggle() {
    if (this.on) {
      this.stop();
      return true;
    }
    this.parts = this.maps().filter(({ path }) => path.length > 1).sort((a, b) => a.toFirst - b.toFirst);
    if (this.parts.length === 0) return false;
    const here = this.target.frame;
    const inside = this.parts.findIndex(({ toFirst, toLast }) => here >= toFirst && here < toLast);
    this.part = Math.max(0, inside);
    this.at = inside >= 0 ? here : this.parts[0].toFirst;
    this.clock.start();
    this.changed();
    return true;
  }

  stop() {
    if (!this.on) return;
    this.clock.stop();
    this.changed();
  }

  /** Stretch after stretch, and again from the first. */
  step(seconds) {
    this.at += seconds * this.target.info.fps;
    if (this.at > this.parts[this.part].toLast) {
      this.part = (this.part + 1) % this.parts.length;
      this.at = this.parts[this.part].toFirst;
    }
    this.target.show(this.target.sequence, this.at);
    this.source.show(this.source.sequence, sourceAt(this.parts[this.part], this.at));
  }
}
