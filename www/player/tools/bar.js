/** The row of tools, with undo and redo beside it. */

import { h, iconButton } from '../dom.js';
import { Choice } from './dock.js';

/** The ends of the slider: what a frame costs, for which actors are packed. */
const [SMOOTH, QUICK] = [0.01, 0.2];

export class ToolBar {
  /**
   * @param {(typeof import('./tool.js').Tool)[]} tools
   * @param {{choose: (id: string) => void, step: (by: number) => void, hurry: (quickness: number) => void, vary: (variety: number) => void}} act
   */
  constructor(tools, act) {
    this.tools = new Choice('Tools', act.choose, { class: 'tools', part: 'tools' });
    this.tools.set(tools.map(({ id, title, about }, at) => ({ value: id, text: title, title: `${about} (${at + 1})` })), 'pose', 'tool');
    this.undo = iconButton('undo', 'Undo (Ctrl+Z)', () => act.step(-1), { disabled: true });
    this.redo = iconButton('redo', 'Redo (Ctrl+Y)', () => act.step(1), { disabled: true });
    this.quick = h('input', { type: 'range', min: 0, max: 1, step: 0.02, 'aria-label': 'Quickness' });
    this.quick.addEventListener('input', () => act.hurry(SMOOTH * (QUICK / SMOOTH) ** Number(this.quick.value)));
    const quick = h('label', { class: 'exact', title: 'How the actor gets there: by the smoothest way, or by the quickest' }, h('span', {}, 'quick'), this.quick);
    this.varied = h('input', { type: 'range', min: 0, max: 1, step: 0.05, 'aria-label': 'Variety' });
    this.varied.addEventListener('input', () => act.vary(Number(this.varied.value)));
    this.variety = h('label', { class: 'exact', title: 'How much what was recorded varies whenever it is shown', hidden: true }, h('span', {}, 'varied'), this.varied);
    this.root = h('div', { class: 'toolbar' }, this.tools.root, quick, this.variety, this.undo, this.redo);
  }

  /** @param {number} quickness the weight of a frame's duration */
  setQuickness(quickness = SMOOTH) {
    const place = Math.log(quickness / SMOOTH) / Math.log(QUICK / SMOOTH);
    this.quick.value = String(Math.min(1, Math.max(0, place)));
    this.quick.setAttribute('aria-valuetext', `${quickness.toFixed(3)} a frame`);
  }

  /** @param {number | null} variety null where the actor has no alternatives */
  setVariety(variety) {
    this.variety.hidden = variety === null;
    if (variety === null) return;
    this.varied.value = String(variety);
    this.varied.setAttribute('aria-valuetext', `${Math.round(100 * variety)} %`);
  }

  setSteps(undo, redo) {
    this.undo.disabled = !undo;
    this.redo.disabled = !redo;
  }
}
