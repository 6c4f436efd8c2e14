/** Points that can be taken hold of: buttons over the picture, for the pointer and for the keyboard. */

import { h } from '../dom.js';

/** Metres that an arrow key moves a point. */
const STEP = 0.1;

/** A point on the ground (x, z), or in the air (x, z, height). @typedef {number[]} Point */

export class Handles {
  /**
   * @param {import('./toolbox.js').Toolbox} box
   * @param {object} act
   * @param {(index: number, point: Point, merge: string) => void} act.move
   * @param {(index: number) => void} [act.remove]
   * @param {(index: number) => void} [act.insert]
   * @param {(index: number, by: number, merge: string) => void} [act.lift] metres
   * @param {(index: number) => void} [act.chosen] it has the focus
   * @param {(index: number, point: Point) => string} act.describe for screen readers
   * @param {number} [act.step] metres that an arrow key moves a point
   */
  constructor(box, act) {
    this.box = box;
    this.act = act;
    this.points = [];
    this.buttons = [];
  }

  /** @param {Point[]} points @param {(index: number) => string} [kind] a class for each */
  show(points, kind = () => '') {
    this.points = points;
    const { handles } = this.box.core.view;
    while (this.buttons.length > points.length) this.buttons.pop().remove();
    while (this.buttons.length < points.length) this.buttons.push(handles.appendChild(this.make(this.buttons.length)));
    this.buttons.forEach((button, index) => {
      button.setAttribute('aria-label', this.act.describe(index, points[index]));
      button.className = `handle ${kind(index)}`;
    });
  }

  hide() {
    this.show([]);
  }

  /** @param {import('../stage-view.js').StageView['seen']} seen */
  place(seen) {
    this.buttons.forEach((button, index) => putAt(button, seen(...this.points[index])));
  }

  focus(index) {
    this.buttons[Math.max(0, Math.min(this.buttons.length - 1, index))]?.focus();
  }

  make(index) {
    const button = h('button', { type: 'button', class: 'handle' });
    let drag = 0;
    let last = 0;
    button.addEventListener('focus', () => this.act.chosen?.(index));
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      event.stopPropagation();
      button.focus();
      button.setPointerCapture(event.pointerId);
      drag += 1;
      last = event.clientY;
    });
    button.addEventListener('pointermove', (event) => {
      if (!button.hasPointerCapture(event.pointerId)) return;
      if (event.altKey && this.act.lift) this.lift(index, last - event.clientY, `lift ${index} ${drag}`);
      else this.drag(index, event, `drag ${index} ${drag}`);
      last = event.clientY;
    });
    button.addEventListener('dblclick', (event) => {
      event.stopPropagation();
      this.act.remove?.(index);
    });
    button.addEventListener('keydown', (event) => this.key(event, index));
    return button;
  }

  drag(index, event, merge) {
    const point = this.box.core.view.stage.under(event, this.points[index]);
    if (point) this.act.move(index, point, merge);
  }

  /** Straight up by so many pixels. */
  lift(index, rise, merge) {
    const { stage } = this.box.core.view;
    const [x, z, height = stage.floor] = this.points[index];
    const pixels = stage.seen(x, z, height).y - stage.seen(x, z, height + 1).y;
    if (pixels > 1) this.act.lift(index, rise / pixels, merge);
  }

  key(event, index) {
    const { key, shiftKey } = event;
    const step = (this.act.step ?? STEP) * (shiftKey ? 5 : 1);
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const lifts = { PageUp: 1, PageDown: -1 };
    if (Object.hasOwn(moves, key)) {
      const [right, forth] = moves[key].map((by) => by * step);
      // As seen: up is away from the viewer.
      const yaw = this.box.core.view.stage.stage?.camera()[0] ?? 0;
      const [x, z, ...height] = this.points[index];
      const point = [x + right * Math.cos(yaw) - forth * Math.sin(yaw), z - right * Math.sin(yaw) - forth * Math.cos(yaw), ...height];
      this.act.move(index, point, `keys ${index}`);
    } else if (Object.hasOwn(lifts, key) && this.act.lift) {
      this.act.lift(index, lifts[key] * step, `lifts ${index}`);
    } else if ((key === 'Delete' || key === 'Backspace') && this.act.remove) {
      this.act.remove(index);
      this.focus(index);
    } else if ((key === 'Insert' || key === '+') && this.act.insert) {
      this.act.insert(index);
      this.focus(index + 1);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/** Puts an element over its place on the stage. */
export function putAt(element, { x, y, visible }) {
  element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  element.style.visibility = visible ? '' : 'hidden';
}
