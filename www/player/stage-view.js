/** The stage on the page: its canvas, its size, what is drawn besides the actor, and whether its device still lives. */

import { h } from './dom.js';
import { attachGestures } from './gestures.js';

/** How often an idle stage is asked whether its device is lost, in milliseconds. */
const LOSS_CHECK = 250;
/** More pixels than this a CSS pixel cost time and show nothing. */
const MOST_DENSITY = 2;

export class StageView {
  /**
   * @param {() => object | null} player whom the ghosts belong to
   * @param {object} events
   * @param {() => void} events.moved the picture has to be drawn again
   * @param {() => void} events.lost the device is gone
   * @param {(frame: number) => void} events.ghostClicked
   * @param {(frame: number, x: number, y: number) => void} events.ghostHovered -1 when there is none
   */
  constructor(player, events) {
    this.player = player;
    this.events = events;
    this.stage = null;
    this.canvas = h('canvas');
    this.root = h('div', { class: 'view', role: 'img', 'aria-label': 'The actor', tabindex: 0, part: 'stage' }, this.canvas);
    this.size = { width: 0, height: 0 };
    this.options = {};
    this.ghosts = [];
    this.hovered = -1;
    /** What the page wants the first view to be, or null. */
    this.home = null;
    /** The tool in use, which may take a pointer for itself; see `gestures.js`. */
    this.tool = null;
    this.attach();
  }

  attach() {
    const withStage = (act) => (...values) => {
      if (!this.stage) return;
      act(this.stage, ...values);
      this.events.moved();
    };
    attachGestures(this.root, {
      orbit: withStage((stage, dx, dy) => stage.orbit(dx, dy)),
      pan: withStage((stage, dx, dy) => stage.pan(dx, dy)),
      zoom: withStage((stage, factor) => stage.zoom(factor)),
      recentre: withStage((stage) => stage.recentre()),
      grab: (event) => (this.stage && this.tool?.grab?.(event)) || null,
      click: (x, y) => {
        const frame = this.ghostAt(x, y);
        if (frame >= 0) this.events.ghostClicked(frame);
      },
      hover: (x, y) => {
        this.tool?.hover?.(x, y);
        this.hover(this.ghostAt(x, y), x, y);
      },
      leave: () => {
        this.tool?.hover?.();
        this.hover(-1, 0, 0);
      },
    });
    // A click must not take the focus from the score: arrow keys go on moving over poses.
    this.root.addEventListener('mousedown', (event) => event.preventDefault());
  }

  /** Keys of the stage itself, when it has been reached with the tab key. @returns whether the key was used */
  key(key) {
    const moves = {
      ArrowLeft: (stage) => stage.orbit(-24, 0),
      ArrowRight: (stage) => stage.orbit(24, 0),
      ArrowUp: (stage) => stage.orbit(0, -24),
      ArrowDown: (stage) => stage.orbit(0, 24),
      '+': (stage) => stage.zoom(1.15),
      '=': (stage) => stage.zoom(1.15),
      '-': (stage) => stage.zoom(1 / 1.15),
      Home: (stage) => stage.recentre(),
    };
    if (!this.stage || !Object.hasOwn(moves, key)) return false;
    moves[key](this.stage);
    this.events.moved();
    return true;
  }

  ghostAt(x, y) {
    if (!this.stage || this.ghosts.length === 0) return -1;
    return this.stage.pick(this.player(), x, y);
  }

  hover(frame, x, y) {
    if (frame < 0 && this.hovered < 0) return;
    this.hovered = Math.max(-1, frame);
    this.root.toggleAttribute('data-over-ghost', this.hovered >= 0);
    this.events.ghostHovered(this.hovered, x, y);
  }

  /**
   * Makes a stage on a fresh canvas: a canvas whose device was lost keeps a dead context.
   * @param {{create_stage: (canvas: HTMLCanvasElement, player: object) => Promise<object>}} engine
   */
  async open(engine, player) {
    this.close();
    const opening = Symbol('opening');
    this.opening = opening;
    const canvas = h('canvas');
    this.canvas.replaceWith(canvas);
    this.canvas = canvas;
    this.measure();
    this.setBacking();
    const stage = await engine.create_stage(canvas, player);
    // Closed, or opened anew, while the device was on its way: nobody else would give it back.
    if (this.opening !== opening) {
      stage.free?.();
      return;
    }
    this.stage = stage;
    stage.resize(canvas.width, canvas.height);
    stage.set_options(JSON.stringify(this.options));
    this.aim(this.home);
    this.watch = setInterval(() => this.alive(), LOSS_CHECK);
  }

  close() {
    this.opening = null;
    clearInterval(this.watch);
    const { stage } = this;
    this.stage = null;
    this.ghosts = [];
    stage?.free?.();
  }

  /** Whether there is a device; tells once when it has gone. */
  alive() {
    if (!this.stage) return false;
    if (!this.stage.lost()) return true;
    this.close();
    this.events.lost();
    return false;
  }

  /** @param {[number, number, number] | null} view yaw, elevation and distance; null leaves the camera where it is */
  aim(view, home = true) {
    if (view) this.stage?.look_from(...view, home);
  }

  recentre() {
    this.stage?.recentre();
  }

  /** The ground under a point of the stage, or null. @returns {[number, number] | null} x and z in metres */
  groundAt(x, y) {
    const found = this.stage?.ground_at(x, y) ?? [];
    return found.length === 2 ? [found[0], found[1]] : null;
  }

  /** The height of the ground, metres. */
  get floor() {
    return this.stage?.measures()[0] ?? 0;
  }

  /**
   * Where a point is seen on the stage: on the ground, or at a height above the world's origin.
   * @returns {{x: number, y: number, visible: boolean}}
   */
  seen(x, z, height = this.floor) {
    if (!this.stage) return { x: 0, y: 0, visible: false };
    const [left, top, visible] = this.stage.project(x, height, z);
    return { x: left, y: top, visible: visible > 0 };
  }

  /**
   * The point under a pointer event that is as high as `near`: Newton's method from there, by differences.
   * @param {number[]} near x, z and, unless it is on the ground, its height
   * @returns {number[] | null} the same; null where there is none, as above the horizon
   */
  under(event, near) {
    const box = this.root.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const [, , ...height] = near;
    if (height.length === 0) return this.groundAt(x, y);
    let [px, pz] = near;
    for (let round = 0; round < 8; round += 1) {
      const at = this.seen(px, pz, ...height);
      const [right, forth] = [this.seen(px + 0.01, pz, ...height), this.seen(px, pz + 0.01, ...height)];
      const [a, b, c, d] = [right.x - at.x, forth.x - at.x, right.y - at.y, forth.y - at.y].map((by) => by / 0.01);
      const [dx, dy, det] = [x - at.x, y - at.y, a * d - b * c];
      px += (d * dx - b * dy) / det;
      pz += (a * dy - c * dx) / det;
    }
    const off = this.seen(px, pz, ...height);
    return Math.hypot(off.x - x, off.y - y) < 1 ? [px, pz, ...height] : null;
  }

  setOptions(options) {
    this.options = { ...this.options, ...options };
    this.stage?.set_options(JSON.stringify(this.options));
    this.events.moved();
  }

  /** Poses drawn translucent where the actor would arrive. Only tells the stage when they change, or when asked to. */
  setGhosts(player, frames, anew = false) {
    if (!this.stage) return;
    if (!anew && frames.length === this.ghosts.length && frames.every((frame, at) => frame === this.ghosts[at])) return;
    this.ghosts = [...frames];
    this.stage.set_ghosts(player, Uint32Array.from(frames));
    this.events.moved();
  }

  /** Reads the size from the page. */
  measure() {
    const box = this.root.getBoundingClientRect();
    this.size = { width: box.width, height: box.height };
  }

  /** @returns whether the number of pixels changed */
  resize() {
    this.measure();
    if (!this.setBacking() || !this.stage) return false;
    this.stage.resize(this.canvas.width, this.canvas.height);
    return true;
  }

  setBacking() {
    const density = Math.min(globalThis.devicePixelRatio || 1, MOST_DENSITY);
    const width = Math.max(1, Math.round(this.size.width * density));
    const height = Math.max(1, Math.round(this.size.height * density));
    if (this.canvas.width === width && this.canvas.height === height) return false;
    this.canvas.width = width;
    this.canvas.height = height;
    return true;
  }
}
