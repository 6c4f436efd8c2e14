/** Points on the ground that can be taken hold of: buttons over the picture, for the pointer and for the keyboard. */

import { h } from '../dom.js';

/** Metres that an arrow key moves a point. */
const STEP = 0.1;

export class Handles {
  /**
   * @param {import('./toolbox.js').Toolbox} box
   * @param {object} act
   * @param {(index: number, point: [number, number], merge: string) => void} act.move
   * @param {(index: number) => void} [act.remove]
   * @param {(index: number) => void} [act.insert]
   * @param {(index: number, point: [number, number]) => string} act.describe for screen readers
   */
  constructor(box, act) {
    this.box = box;
    this.act = act;
    this.points = [];
    this.buttons = [];
  }

  /** @param {[number, number][]} points @param {(index: number) => string} [kind] a class for each */
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

  /** @param {(x: number, z: number) => {x: number, y: number, visible: boolean}} seen */
  place(seen) {
    this.buttons.forEach((button, index) => {
      const { x, y, visible } = seen(...this.points[index]);
      button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      button.style.visibility = visible ? '' : 'hidden';
    });
  }

  focus(index) {
    this.buttons[Math.max(0, Math.min(this.buttons.length - 1, index))]?.focus();
  }

  make(index) {
    const button = h('button', { type: 'button', class: 'handle' });
    let drag = 0;
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      event.stopPropagation();
      button.focus();
      button.setPointerCapture(event.pointerId);
      drag += 1;
    });
    button.addEventListener('pointermove', (event) => {
      if (!button.hasPointerCapture(event.pointerId)) return;
      const ground = this.box.core.view.stage.groundUnder(event);
      if (ground) this.act.move(index, ground, `drag ${index} ${drag}`);
    });
    button.addEventListener('dblclick', (event) => {
      event.stopPropagation();
      this.act.remove?.(index);
    });
    button.addEventListener('keydown', (event) => this.key(event, index));
    return button;
  }

  key(event, index) {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (Object.hasOwn(moves, event.key)) {
      const [right, forth] = moves[event.key].map((by) => by * STEP * (event.shiftKey ? 5 : 1));
      // As seen: up is away from the viewer.
      const yaw = this.box.core.view.stage.stage?.camera()[0] ?? 0;
      const [x, z] = this.points[index];
      const point = [x + right * Math.cos(yaw) - forth * Math.sin(yaw), z - right * Math.sin(yaw) - forth * Math.cos(yaw)];
      this.act.move(index, point, `keys ${index}`);
    } else if ((event.key === 'Delete' || event.key === 'Backspace') && this.act.remove) {
      this.act.remove(index);
      this.focus(index);
    } else if ((event.key === 'Insert' || event.key === '+') && this.act.insert) {
      this.act.insert(index);
      this.focus(index + 1);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
