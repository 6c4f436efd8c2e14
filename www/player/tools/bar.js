/** The row of tools, with undo and redo beside it. */

import { h, iconButton } from '../dom.js';
import { Choice } from './dock.js';

export class ToolBar {
  /**
   * @param {(typeof import('./tool.js').Tool)[]} tools
   * @param {{choose: (id: string) => void, step: (by: number) => void}} act
   */
  constructor(tools, act) {
    this.tools = new Choice('Tools', act.choose, { class: 'tools', part: 'tools' });
    this.tools.set(tools.map(({ id, title, about }, at) => ({ value: id, text: title, title: `${about} (${at + 1})` })), 'pose', 'tool');
    this.undo = iconButton('undo', 'Undo (Ctrl+Z)', () => act.step(-1), { disabled: true });
    this.redo = iconButton('redo', 'Redo (Ctrl+Y)', () => act.step(1), { disabled: true });
    this.root = h('div', { class: 'toolbar' }, this.tools.root, this.undo, this.redo);
  }

  setSteps(undo, redo) {
    this.undo.disabled = !undo;
    this.redo.disabled = !redo;
  }
}
