/** What follows the path: the middle of the body, or a part of it that is picked with the pointer or with a cross that keys move. */

import { button, h } from '../dom.js';
import { putAt } from './handles.js';

/** CSS pixels that an arrow key moves the cross; with shift, so many times as far. */
const STEP = 6;
const FAR = 5;
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Part {
  /** @param {import('./path.js').PathTool} tool */
  constructor(tool) {
    this.tool = tool;
    /** Where the cross is on the stage while a part is being picked, or null. */
    this.cross = null;
    this.button = button('Part', 'A part of the body follows the path, such as a hand, in place of its middle', () => this.press(), { 'aria-pressed': 'false' });
    this.mark = h('div', { class: 'part-mark', 'aria-hidden': 'true', hidden: true });
  }

  get view() {
    return this.tool.box.core.view.stage;
  }

  get vertices() {
    return this.tool.path.vertices ?? [];
  }

  press() {
    if (this.vertices.length > 0) this.take();
    else if (this.cross) this.stop();
    else {
      this.tool.box.director.tell('pause');
      this.cross = [this.view.size.width / 2, this.view.size.height / 2];
      this.tool.refresh();
    }
  }

  stop() {
    this.cross = null;
    this.tool.refresh();
  }

  take(vertices) {
    this.cross = null;
    this.tool.set({ ...this.tool.path, vertices });
  }

  pick(x, y) {
    const { box } = this.tool;
    const vertices = this.view.stage.part_at(box.director.player, x, y);
    if (vertices.length > 0) this.take([...vertices]);
    else box.core.say('that is not the body', 'waiting');
  }

  /** @returns {import('../gestures.js').Grab} */
  grab({ offsetX, offsetY }) {
    return { move: () => {}, end: () => this.pick(offsetX, offsetY) };
  }

  /** @returns whether the key was used */
  key({ key, shiftKey, repeat }) {
    if (!this.cross) return false;
    const by = KEYS[key];
    if (by) this.cross = this.cross.map((at, axis) => at + by[axis] * STEP * (shiftKey ? FAR : 1));
    else if (key === 'Enter' && !repeat) this.pick(...this.cross);
    else if (key === 'Escape') this.stop();
    else return false;
    this.tool.box.core.redraw();
    return true;
  }

  /** Where what follows the path is now. @returns {[number, number, number]} x, z and height */
  middle() {
    const { player, state: { x, z } } = this.tool.box.director;
    const pose = player.pose();
    const { vertices } = this;
    const count = vertices.length || pose.length / 3;
    const sum = [0, 0, 0];
    for (let at = 0; at < count; at += 1) {
      const vertex = vertices[at] ?? at;
      for (let axis = 0; axis < 3; axis += 1) sum[axis] += (pose[3 * vertex + axis] ?? 0) / count;
    }
    return vertices.length > 0 ? [sum[0], sum[2], sum[1]] : [x, z, sum[1]];
  }

  show() {
    this.button.setAttribute('aria-pressed', String(Boolean(this.cross) || this.vertices.length > 0));
    this.mark.hidden = !this.cross && this.vertices.length === 0;
    this.mark.toggleAttribute('data-picking', Boolean(this.cross));
  }

  place(seen) {
    if (this.cross) putAt(this.mark, { x: this.cross[0], y: this.cross[1], visible: true });
    else if (!this.mark.hidden) putAt(this.mark, seen(...this.middle()));
  }
}
