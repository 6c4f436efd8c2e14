/** The row of tools, with undo and redo beside it. */

import { h, iconButton } from '../dom.js';
import { Choice } from './dock.js';

/** The ends of the slider: what a frame costs, for which actors are packed. */
const [SMOOTH, QUICK] = [0.01, 0.2];

export class ToolBar {
  /**
   * @param {(typeof import('./tool.js').Tool)[]} tools
   * @param {{choose: (id: string) => void, step: (by: number) => void, hurry: (quickness: number) => void}} act
   */
  constructor(tools, act) {
    this.tools = new Choice('Tools', act.choose, { class: 'tools', part: 'tools' });
    this.tools.set(tools.map(({ id, title, about }, at) => ({ value: id, text: title, title: `${about} (${at + 1})` })), 'pose', 'tool');
    this.undo = iconButton('undo', 'Undo (Ctrl+Z)', () => act.step(-1), { disabled: true });
    this.redo = iconButton('redo', 'Redo (Ctrl+Y)', () => act.step(1), { disabled: true });
    this.quick = h('input', { type: 'range', min: 0, max: 1, step: 0.02, 'aria-label': 'Quickness' });
    this.quick.addEventListener('input', () => act.hurry(SMOOTH * (QUICK / SMOOTH) ** Number(this.quick.value)));
    const quick = h('label', { class: 'exact', title: 'How the actor gets there: by the smoothest way, or by the quickest' }, h('span', {}, 'quick'), this.quick);
    this.root = h('div', { class: 'toolbar' }, this.tools.root, quick, this.undo, this.redo);
  }

  /** @param {number} quickness the weight of a frame's duration */
  setQuickness(quickness = SMOOTH) {
    const place = Math.log(quickness / SMOOTH) / Math.log(QUICK / SMOOTH);
    this.quick.value = String(Math.min(1, Math.max(0, place)));
    this.quick.setAttribute('aria-valuetext', `${quickness.toFixed(3)} a frame`);
  }

  setSteps(undo, redo) {
    this.undo.disabled = !undo;
    this.redo.disabled = !redo;
  }
}
