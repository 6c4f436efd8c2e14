/** What all tools' docks are made of. */

import { h } from '../dom.js';

/** A button with words. */
export function button(text, title, act, attributes = {}) {
  const element = h('button', { type: 'button', class: 'chip', title, ...attributes }, text);
  element.addEventListener('click', act);
  return element;
}

/** The button that sets the actor off, with the line that says what would happen. */
export class GoRow {
  /** @param {() => void} go */
  constructor(go, label = 'Go') {
    this.button = h('button', { type: 'button', class: 'button go', title: `${label} (Enter)` }, label);
    this.text = h('p', { class: 'outcome figures', role: 'status' });
    this.button.addEventListener('click', go);
    this.root = h('div', { class: 'go-row' }, this.text, this.button);
  }

  /** What the search says, or what is wrong with what was asked. */
  tell(trouble, answer, sentence) {
    const notes = answer?.notes.length ? ` · ${answer.notes[0]}` : '';
    this.show(trouble ?? `${sentence}${notes}`, !trouble);
  }

  /** @param {boolean} can whether there is something to go for */
  show(text, can) {
    if (this.text.textContent !== text) this.text.textContent = text;
    this.button.disabled = !can;
  }
}

/** A number with its name and unit; `change` hears of every valid one, and of null where the field was emptied. */
export function numberField(name, unit, attributes, change) {
  const input = h('input', { type: 'number', 'aria-label': `${name}, ${unit}`, ...attributes });
  input.addEventListener('change', () => {
    const value = input.value === '' ? null : Number(input.value);
    if (value === null || Number.isFinite(value)) change(value);
  });
  return { input, root: h('label', { class: 'field' }, h('span', {}, name), input, h('span', { class: 'unit' }, unit)) };
}

/** Buttons of which one is chosen; arrow keys choose as well. */
export class Choice {
  /** @param {(value: string) => void} act */
  constructor(label, act) {
    this.act = act;
    this.root = h('div', { class: 'choice', role: 'radiogroup', 'aria-label': label });
    this.root.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!by) return;
      event.preventDefault();
      event.stopPropagation();
      const at = this.buttons.findIndex(({ value }) => value === this.chosen);
      const next = this.buttons[(at + by + this.buttons.length) % this.buttons.length];
      act(next.value);
      next.focus();
    });
  }

  /** @param {{value: string, text: string, mark?: number, title?: string}[]} options `mark` numbers a behaviour's colour */
  set(options, chosen) {
    this.buttons = options.map(({ value, text, mark, title }) => {
      const dot = mark === undefined ? [] : [h('span', { class: `dot b${mark}` })];
      const one = h('button', { type: 'button', class: 'chip', role: 'radio', value, title: title ?? text }, ...dot, text);
      one.addEventListener('click', () => this.act(value));
      return one;
    });
    this.root.replaceChildren(...this.buttons);
    this.choose(chosen);
  }

  choose(value) {
    this.chosen = value;
    for (const one of this.buttons ?? []) {
      one.setAttribute('aria-checked', String(one.value === value));
      one.tabIndex = one.value === value ? 0 : -1;
    }
  }
}

/** `12 cm`; `3.4 m` where that is more than anyone would call near. */
export function centimetres(metres) {
  return metres < 2 ? `${Math.round(metres * 100)} cm` : `${metres.toFixed(1)} m`;
}
