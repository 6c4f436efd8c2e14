/** Calls a step once a display frame for as long as it asks for another, and never while nobody can see it. */

/** A longer pause (a hidden tab, a debugger) counts as this many seconds. */
const LONGEST_STEP = 0.25;

export class FrameLoop {
  /**
   * @param {Window} window whose display frames count
   * @param {(seconds: number) => boolean} step does one frame; true asks for the next
   */
  constructor(window, step) {
    this.window = window;
    this.step = step;
    this.visible = false;
    this.handle = 0;
    this.last = 0;
  }

  setVisible(visible) {
    this.visible = visible;
    if (visible) this.request();
    else this.stop();
  }

  request() {
    if (!this.visible || this.handle) return;
    this.handle = this.window.requestAnimationFrame((now) => this.run(now));
  }

  stop() {
    this.window.cancelAnimationFrame(this.handle);
    this.handle = 0;
    this.last = 0;
  }

  run(now) {
    this.handle = 0;
    const seconds = this.last ? Math.min(LONGEST_STEP, Math.max(0, (now - this.last) / 1000)) : 0;
    const again = this.step(seconds);
    // After a rest the clock starts anew: idle time is not time in which the actor moved.
    this.last = again ? now : 0;
    if (again) this.request();
  }
}

/** The median of the last measurements, for figures that should not flicker. */
export class Median {
  constructor(size = 31) {
    this.size = size;
    this.values = [];
  }

  add(value) {
    this.values.push(value);
    if (this.values.length > this.size) this.values.shift();
  }

  get value() {
    if (this.values.length === 0) return NaN;
    const sorted = [...this.values].sort((a, b) => a - b);
    return sorted[sorted.length >> 1];
  }
}
