/** The row of tools, with undo and redo beside it. */

import { h, icon } from '../dom.js';

export class ToolBar {
  /**
   * @param {{constructor: {id: string, title: string, about: string}}[]} tools
   * @param {{choose: (id: string) => void, step: (by: number) => void}} act
   */
  constructor(tools, act) {
    this.buttons = tools.map(({ constructor: { id, title, about } }, at) => {
      const button = h('button', { type: 'button', class: 'tool', role: 'radio', 'aria-checked': 'false', tabindex: -1, title: `${about} (${at + 1})`, value: id }, title);
      button.addEventListener('click', () => act.choose(id));
      return button;
    });
    const group = h('div', { class: 'tools', role: 'radiogroup', 'aria-label': 'Tools', part: 'tools' }, ...this.buttons);
    group.addEventListener('keydown', (event) => this.move(event, act.choose));
    this.undo = this.step('undo', 'Undo (Ctrl+Z)', () => act.step(-1));
    this.redo = this.step('redo', 'Redo (Ctrl+Y)', () => act.step(1));
    this.root = h('div', { class: 'toolbar' }, group, this.undo, this.redo);
  }

  step(name, title, act) {
    const button = h('button', { type: 'button', class: 'round', 'aria-label': title.split(' ')[0], title, disabled: true }, icon(name));
    button.addEventListener('click', act);
    return button;
  }

  /** Arrow keys choose, as in any group of radio buttons. */
  move(event, choose) {
    const by = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const at = this.buttons.findIndex((button) => button.getAttribute('aria-checked') === 'true');
    const next = this.buttons[(at + by + this.buttons.length) % this.buttons.length];
    choose(next.value);
    next.focus();
  }

  show(id) {
    for (const button of this.buttons) {
      button.setAttribute('aria-checked', String(button.value === id));
      button.tabIndex = button.value === id ? 0 : -1;
    }
  }

  setSteps(undo, redo) {
    this.undo.disabled = !undo;
    this.redo.disabled = !redo;
  }
}
