/**
 * Click a pose in the score or the name of a behaviour, and the actor goes there; with shift, after what is under way. What
 * waits stands in a row.
 */

import { button, h, rove } from '../dom.js';
import { words } from '../format.js';
import { nameOf } from '../targets.js';
import { NumberField } from './dock.js';
import { Tool } from './tool.js';

/** CSS pixels that a press may tremble and still be a click. */
const TREMBLE = 6;
/** Milliseconds that a finger rests on a target before it drags it. */
const REST = 250;
/** Seconds that a behaviour is held unless told otherwise, and at most. */
const HOLD = 5;
const LONGEST = 3600;

export class PoseTool extends Tool {
  static id = 'pose';
  static title = 'Pose';
  static about = 'Click a pose: the actor goes there';
  static hint = 'Click a pose: the actor goes there.';

  withScore = true;

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    super(box);
    this.queue = box.core.queue;
    this.queue.changed = () => this.showQueue();
    this.hold = HOLD;
    this.names = h('div', { class: 'choice', role: 'toolbar', 'aria-label': 'Behaviours' });
    rove(this.names, (next) => next.focus());
    const hold = new NumberField('hold', 's', 'How long a behaviour goes on, in a loop; 0 only goes there', { min: 0, max: LONGEST, step: 1, value: HOLD }, (value) => (this.hold = value ?? 0));
    this.later = button('then', 'What is clicked comes after what is under way (or click with shift)', () => this.setLater(!this.isLater), { 'aria-pressed': 'false' });
    this.list = h('div', { class: 'choice queue', role: 'group', 'aria-label': 'What comes after' });
    rove(this.list, (next, { shiftKey, target }, by) => {
      const at = this.indexOf(target);
      if (shiftKey) this.move(at, at + by);
      else next.focus();
    });
    this.list.addEventListener('keydown', (event) => {
      if (event.key !== 'Delete' && event.key !== 'Backspace') return;
      event.stopPropagation();
      this.remove(this.indexOf(event.target));
    });
    this.list.addEventListener('pointerdown', (event) => this.press(event));
    this.list.addEventListener('pointermove', (event) => this.drag(event));
    this.list.addEventListener('pointerup', () => this.release(true));
    this.list.addEventListener('pointercancel', () => this.release(false));
    this.list.addEventListener('touchmove', (event) => this.held && event.preventDefault(), { passive: false });
    this.build(this.names, hold.root, this.later, this.list);
  }

  answered() {}

  opened(director) {
    const { info } = director;
    const { families } = this.box.kit;
    families.opened(director);
    this.names.after(families.docked);
    // What is made between what was recorded, the sliders show.
    const isMade = (behaviour) => info.families.some(({ name, members }) => behaviour.startsWith(`${name} `) && members.some(({ sequence }) => sequence === behaviour));
    const names = info.behaviours.filter((behaviour) => !isMade(behaviour)).map((behaviour) => {
      const act = ({ shiftKey }) => this.box.take(this.hold ? { behaviour, hold: this.hold } : { behaviour }, shiftKey);
      return button(words(behaviour), `Go to ${words(behaviour)}; with shift: after what is under way`, act);
    });
    this.names.replaceChildren(...names);
  }

  get isLater() {
    return this.later.getAttribute('aria-pressed') === 'true';
  }

  setLater(on) {
    this.later.setAttribute('aria-pressed', String(on));
  }

  // ---- what waits -----------------------------------------------------------------------------------------------

  indexOf(element) {
    return [...this.list.children].indexOf(element);
  }

  showQueue() {
    const { director } = this.box.core;
    const had = this.indexOf(this.list.getRootNode().activeElement);
    const last = this.queue.targets.length - 1;
    this.list.replaceChildren(
      ...this.queue.targets.map((target, at) => {
        const name = nameOf(target, director);
        const label = `${name}, ${at + 1} of ${last + 1}: Enter takes it out, shift and arrow keys move it`;
        return button(name, 'Click to take it out; drag, or shift and arrow keys, to move it', () => this.remove(at), { class: 'chip waits', 'aria-label': label });
      }),
    );
    // Who takes things out with the keyboard goes on from the same place.
    if (had >= 0) (this.list.children[Math.min(had, last)] ?? this.later).focus();
  }

  remove(at) {
    const name = nameOf(this.queue.targets[at], this.box.core.director);
    this.queue.set(this.queue.targets.toSpliced(at, 1));
    this.box.core.say(`${name} is taken out`);
  }

  move(from, to) {
    const { targets } = this.queue;
    if (from < 0 || to < 0 || to >= targets.length || from === to) return;
    this.queue.set(targets.toSpliced(from, 1).toSpliced(to, 0, targets[from]));
    this.list.children[to].focus();
    this.box.core.say(`${nameOf(targets[from], this.box.core.director)} is number ${to + 1}`);
  }

  /** A finger scrolls the row, unless it rests on a target first. */
  press({ pointerType, target, clientX }) {
    const at = this.indexOf(target);
    if (at < 0) return;
    const take = () => {
      this.held = { chip: target, at, x: clientX };
      target.dataset.held = '';
    };
    if (pointerType === 'touch') this.taking = setTimeout(take, REST);
    else take();
  }

  drag({ buttons, clientX, pointerId }) {
    const { held, list } = this;
    if (!held || !buttons || Math.abs(clientX - held.x) < TREMBLE || this.indexOf(held.chip) < 0) return;
    // From here on the list has the pointer, so that letting go is no click on a button.
    list.setPointerCapture(pointerId);
    const over = [...list.children].find((one) => clientX < one.getBoundingClientRect().right) ?? list.lastChild;
    if (over === held.chip) return;
    held.x = clientX;
    if (this.indexOf(over) > this.indexOf(held.chip)) over.after(held.chip);
    else over.before(held.chip);
  }

  /** @param {boolean} drops whether it stays where it was dragged */
  release(drops) {
    clearTimeout(this.taking);
    const { held } = this;
    this.held = null;
    if (!held) return;
    delete held.chip.dataset.held;
    if (drops) this.move(held.at, this.indexOf(held.chip));
    else this.showQueue();
  }
}
