/** Draws pose thumbnails one after the other while the page has nothing better to do, and keeps them. */

import { THUMBNAIL } from './layout.js';

/** Thumbnails that wait for the GPU together; more would hold up the stage's own frames. */
const BATCH = 3;

const idle = globalThis.requestIdleCallback
  ? (run) => requestIdleCallback(run, { timeout: 200 })
  : (run) => setTimeout(run, 16);

export class ThumbnailShelf {
  /**
   * @param {(frame: number, width: number, height: number) => Promise<Uint8ClampedArray> | null} render null: not now
   * @param {(frame: number) => void} ready
   */
  constructor(render, ready) {
    this.render = render;
    this.ready = ready;
    this.pictures = new Map();
    this.queue = [];
    this.busy = false;
  }

  /** @returns {HTMLCanvasElement | undefined} */
  get(frame) {
    return this.pictures.get(frame);
  }

  /** Replaces what is still wanted, in this order. */
  want(frames) {
    this.queue = frames.filter((frame) => !this.pictures.has(frame));
    this.next();
  }

  /** Whether every thumbnail asked for has been drawn. */
  get complete() {
    return this.queue.length === 0 && !this.busy;
  }

  clear() {
    this.pictures.clear();
    this.queue = [];
  }

  next() {
    if (this.busy || this.queue.length === 0) return;
    this.busy = true;
    idle(async () => {
      const batch = this.queue.splice(0, BATCH);
      const drawn = await Promise.all(batch.map((frame) => this.draw(frame)));
      // A stage that cannot draw now will be asked again when the score is told of a new one.
      if (drawn.includes(false)) this.queue = [];
      this.busy = false;
      this.next();
    });
  }

  /** A device that is lost meanwhile throws or rejects; both mean: not now. */
  async pixels(frame, width, height) {
    try {
      return await this.render(frame, width, height);
    } catch {
      return null;
    }
  }

  /** Thumbnails are drawn at twice the size they are shown at, which serves every screen. */
  async draw(frame) {
    const [width, height] = [THUMBNAIL.width * 2, THUMBNAIL.height * 2];
    const pixels = await this.pixels(frame, width, height);
    if (!pixels || pixels.length !== width * height * 4) return false;
    const canvas = document.createElement('canvas');
    canvas.width = width;
    canvas.height = height;
    canvas.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(pixels), width, height), 0, 0);
    this.pictures.set(frame, canvas);
    this.ready(frame);
    return true;
  }
}

/** Coarse before fine: every eighth frame of a list, then the fourths, the halves and the rest. */
export function coarseFirst(frames) {
  const order = [];
  const seen = new Set();
  for (const stride of [8, 4, 2, 1]) {
    for (let slot = Math.floor(stride / 2); slot < frames.length; slot += stride) {
      if (!seen.has(slot)) order.push(frames[slot]);
      seen.add(slot);
    }
  }
  return order;
}
