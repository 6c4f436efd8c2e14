/** The actor goes wherever it likes, for ever, and shows every pose as often as the weights of the behaviours say. */

import { h, iconButton } from '../dom.js';
import { words } from '../format.js';
import { NumberField } from './dock.js';
import { Tool } from './tool.js';

export class WanderTool extends Tool {
  static id = 'wander';
  static title = 'Wander';
  static about = 'The actor goes wherever it likes, for ever';
  static hint = 'Say what to show more or less of, and let it go.';

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    super(box, 'Wander');
    this.sliders = new Map();
    this.list = h('div', { class: 'weights' });
    this.seed = new NumberField('seed', '', 'The same seed gives the same walk', { min: 0, max: 4294967295, step: 1 }, (seed) => this.set({ seed: Math.trunc(seed ?? 0) }));
    const dice = iconButton('dice', 'Another seed', () => this.set({ seed: Math.floor(Math.random() * 1e6) }));
    this.row.root.prepend(this.seed.root, dice);
    this.build(this.list, this.row.root);
  }

  get busy() {
    return this.hint;
  }

  get wander() {
    return this.box.document.wander;
  }

  set(part, merge = null) {
    this.box.edit({ wander: { ...this.wander, ...part } }, merge);
  }

  opened({ info }) {
    this.sliders.clear();
    this.list.replaceChildren(...info.behaviours.map((behaviour) => this.slider(behaviour)));
  }

  slider(behaviour) {
    const input = h('input', { type: 'range', min: 0, max: 4, step: 0.25, value: 1, 'aria-label': words(behaviour) });
    const value = h('output', { class: 'figures' });
    input.addEventListener('input', () => this.set({ weights: { ...this.wander.weights, [behaviour]: Number(input.value) } }, `weight ${behaviour}`));
    input.addEventListener('change', () => this.box.history.settle());
    this.sliders.set(behaviour, { input, value });
    return h('label', { class: 'weight' }, h('span', {}, words(behaviour)), input, value);
  }

  refresh() {
    const { seed, weights } = this.wander;
    for (const [behaviour, { input, value }] of this.sliders) {
      const weight = weights[behaviour] ?? 1;
      input.value = String(weight);
      value.textContent = weight === 0 ? 'never' : `${weight}×`;
      input.setAttribute('aria-valuetext', value.textContent);
    }
    this.seed.show(seed);
    this.answered(this.box.answer);
  }

  sentence({ wander, notes }) {
    const spread = Number.isFinite(wander?.objective) ? `visits ${wander.frames.toLocaleString('en')} frames · unevenness ${wander.objective.toPrecision(2)}` : this.busy;
    return notes[0] ?? spread;
  }
}
