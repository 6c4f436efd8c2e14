/** What all tools' docks are made of. */

import { button, h, rove } from '../dom.js';

/** The button that sets the actor off, with the line that says what would happen. */
export class GoRow {
  /** @param {() => void} go */
  constructor(go, label) {
    this.button = button(label, `${label} (Enter)`, go, { class: 'button go' });
    this.text = h('p', { class: 'outcome figures', role: 'status' });
    this.root = h('div', { class: 'go-row' }, this.text, this.button);
  }

  /** @param {boolean} can whether there is something to go for @param {boolean} busy whether there may be more to say soon */
  show(text, can, busy) {
    if (this.text.textContent !== text) this.text.textContent = text;
    this.text.toggleAttribute('data-busy', busy);
    this.button.disabled = !can;
  }
}

/** A number with its name and unit; `change` hears of every valid one, and of null where the field was emptied. */
export class NumberField {
  constructor(name, unit, title, attributes, change) {
    this.shown = attributes.value ?? '';
    this.input = h('input', { type: 'number', 'aria-label': unit ? `${name}, ${unit}` : name, ...attributes });
    this.input.addEventListener('change', () => {
      const { validity: { badInput, rangeUnderflow, rangeOverflow }, value } = this.input;
      if (badInput || rangeUnderflow || rangeOverflow) this.input.value = this.shown;
      else change(value === '' ? null : Number(value));
    });
    this.root = h('label', { class: 'field', title }, h('span', {}, name), this.input, h('span', { class: 'unit' }, unit));
  }

  /** What is being typed stays. */
  show(value) {
    this.shown = value;
    if (this.input.getRootNode().activeElement !== this.input) this.input.value = value;
  }
}

/** Buttons of which one is chosen; arrow keys choose as well. */
export class Choice {
  /** @param {(value: string) => void} act */
  constructor(label, act, attributes = {}) {
    this.act = act;
    this.root = h('div', { class: 'choice', role: 'radiogroup', 'aria-label': label, ...attributes });
    rove(this.root, (next) => {
      act(next.value);
      next.focus();
    });
  }

  /** @param {{value: string, text: string, mark?: number, title?: string}[]} options `mark` numbers a behaviour's colour */
  set(options, chosen, look = 'chip') {
    this.root.replaceChildren(
      ...options.map(({ value, text, mark, title = text }) => {
        const one = button(text, title, () => this.act(value), { class: look, role: 'radio', value });
        if (mark !== undefined) one.prepend(h('span', { class: `dot b${mark}` }));
        return one;
      }),
    );
    this.choose(chosen);
  }

  choose(value) {
    for (const one of this.root.children) {
      one.setAttribute('aria-checked', String(one.value === value));
      one.tabIndex = one.value === value ? 0 : -1;
    }
  }
}

/** Ticks from 0 on, so many units apart that there is room for their numbers. @param {number[]} steps from which to choose */
export function showScale(root, length, unit, steps, most) {
  const every = steps.find((step) => length / step <= most) ?? 2 * steps[steps.length - 1];
  const ticks = Array.from({ length: Math.floor(length / every) + 1 }, (_, index) => index * every);
  root.replaceChildren(
    ...ticks.map((at) => {
      const tick = h('span', {}, at === 0 ? `0 ${unit}` : String(at));
      tick.style.left = `${(at / length) * 100}%`;
      return tick;
    }),
  );
}

/** Copies a thumbnail, or clears what was there. */
export function copyPicture(canvas, picture) {
  const { width, height } = canvas;
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, width, height);
  if (picture) context.drawImage(picture, 0, 0, width, height);
}

/** `12 cm`; `3.4 m` where that is more than anyone would call near. */
export function centimetres(metres) {
  return metres < 2 ? `${Math.round(metres * 100)} cm` : `${metres.toFixed(1)} m`;
}
