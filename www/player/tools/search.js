/** Drives the search in slices: a few milliseconds a display frame, so that the page never waits for it. */

/** Milliseconds of searching in a display frame. */
export const SLICE = 4;

export class SearchDriver {
  /**
   * @param {import('../core.js').Core} core
   * @param {(answer: object) => void} found hears of every better answer
   */
  constructor(core, found) {
    this.core = core;
    this.found = found;
    this.direction = null;
    this.longest = 0;
  }

  start() {
    this.stop();
  }

  stop() {
    this.direction?.free?.();
    this.direction = null;
  }

  step() {
    return false;
  }

  go() {}

  left() {}

  happened() {}
}
