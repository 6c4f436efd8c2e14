/** A ruler of seconds with key poses on it, and ticks where the actor really reaches them. */

import { h } from '../dom.js';
import { copyPicture, showScale } from './dock.js';

/** Seconds that an arrow key moves a pose. */
const STEP = 0.1;
/** Seconds shown at least, and behind the last pose. */
const LEAST = 8;
const BEHIND = 1.5;
const SIZE = { width: 36, height: 48 };

export class Ruler {
  /**
   * @param {object} act
   * @param {(index: number, seconds: number, merge: string) => number} act.move tells the index that the pose has then
   * @param {(index: number, by: number) => void} act.shift frames
   * @param {(index: number) => void} act.remove
   * @param {(key: {frame: number, seconds: number}) => string} act.describe
   */
  constructor(act) {
    this.act = act;
    this.span = LEAST;
    this.keys = [];
    this.buttons = [];
    this.scale = h('div', { class: 'scale figures', 'aria-hidden': 'true' });
    this.marks = h('div', { class: 'marks', 'aria-hidden': 'true' });
    this.lane = h('div', { class: 'lane' });
    this.shadow = h('canvas', { class: 'shadow', width: 72, height: 96, hidden: true });
    this.root = h('div', { class: 'ruler', role: 'group', 'aria-label': 'Key poses in time' }, this.marks, this.lane, this.shadow, this.scale);
  }

  show(keys, picture) {
    this.keys = keys;
    // The ruler must not change under a pose that is being dragged.
    if (!this.dragging) this.span = Math.max(LEAST, (keys.at(-1)?.seconds ?? 0) + BEHIND);
    while (this.buttons.length > keys.length) this.buttons.pop().remove();
    while (this.buttons.length < keys.length) this.buttons.push(this.lane.appendChild(this.make(this.buttons.length)));
    keys.forEach((key, index) => {
      const button = this.buttons[index];
      button.style.left = this.share(key.seconds);
      button.setAttribute('aria-valuenow', key.seconds.toFixed(2));
      button.setAttribute('aria-valuemax', String(Math.ceil(this.span)));
      button.setAttribute('aria-valuetext', `${this.act.describe(key)}, at ${key.seconds.toFixed(1)} seconds`);
    });
    this.paint(keys, picture);
    showScale(this.scale, this.span, 's', [1, 2, 5, 10, 30, 60], 16);
  }

  share(seconds) {
    return `${((seconds / this.span) * 100).toFixed(3)}%`;
  }

  paint(keys, picture) {
    keys.forEach((key, index) => this.buttons[index] && copyPicture(this.buttons[index].firstChild, picture(key)));
  }

  /** @param {{wanted: number, reached: number | null}[]} times */
  reached(times) {
    this.marks.replaceChildren(
      ...times.filter(({ wanted, reached }) => reached !== null && Math.abs(reached - wanted) > 0.005).map(({ wanted, reached }) => {
        const gap = h('span', {});
        gap.style.left = this.share(Math.min(wanted, reached));
        gap.style.width = this.share(Math.abs(reached - wanted));
        gap.dataset.late = String(reached >= wanted);
        return gap;
      }),
    );
  }

  focus(index) {
    this.buttons[Math.max(0, Math.min(this.buttons.length - 1, index))]?.focus();
  }

  make(index) {
    const button = h('button', { type: 'button', class: 'key-pose', role: 'slider', 'aria-label': 'Key pose', 'aria-valuemin': 0, title: 'Drag to another time; double click takes it away' }, h('canvas', { width: 72, height: 96 }));
    let now = index;
    let run = 0;
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      now = index;
      run += 1;
      this.dragging = true;
      button.setPointerCapture(event.pointerId);
    });
    button.addEventListener('pointermove', (event) => {
      if (button.hasPointerCapture(event.pointerId)) now = this.act.move(now, Math.max(0, this.secondsAt(event)), `retime ${index} ${run}`);
    });
    const end = () => {
      this.dragging = false;
    };
    button.addEventListener('pointerup', end);
    button.addEventListener('pointercancel', end);
    button.addEventListener('dblclick', () => this.act.remove(index));
    button.addEventListener('keydown', (event) => this.key(event, index));
    return button;
  }

  key(event, index) {
    const { key, shiftKey } = event;
    const by = { ArrowLeft: -STEP, ArrowRight: STEP }[key];
    const frames = { ArrowUp: 1, ArrowDown: -1 }[key];
    if (by) this.act.move(index, this.keys[index].seconds + by * (shiftKey ? 10 : 1), `keys ${index}`);
    else if (frames) this.act.shift(index, frames * (shiftKey ? 10 : 1));
    else if (key === 'Delete' || key === 'Backspace') this.act.remove(index);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  secondsAt(event) {
    const box = this.lane.getBoundingClientRect();
    return ((event.clientX - box.left) / box.width) * this.span;
  }

  over(event) {
    const box = this.root.getBoundingClientRect();
    return event.clientY > box.top - SIZE.height && event.clientY < box.bottom && event.clientX > box.left && event.clientX < box.right;
  }

  /** A pose from the shelf is held over the ruler. */
  hover(event, picture) {
    const over = this.over(event);
    this.shadow.hidden = !over;
    if (!over) return;
    copyPicture(this.shadow, picture);
    this.shadow.style.left = this.share(Math.max(0, this.secondsAt(event)));
  }

  /** It is let go. @returns {number | null} seconds, or null beside the ruler */
  drop(event) {
    this.shadow.hidden = true;
    if (!event || !this.over(event)) return null;
    return Math.max(0, Math.round(this.secondsAt(event) * 20) / 20);
  }
}
