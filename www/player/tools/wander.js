/** The actor goes wherever it likes, for ever, and shows every pose as often as the weights of the behaviours say. */

import { h, icon } from '../dom.js';
import { behavioursOf } from '../targets.js';
import { GoRow } from './dock.js';

export class WanderTool {
  static id = 'wander';
  static title = 'Wander';
  static about = 'The actor goes wherever it likes, for ever';

  id = WanderTool.id;
  hint = 'Say what to show more or less of, and let it go.';

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    this.sliders = new Map();
    this.list = h('div', { class: 'weights' });
    this.seed = h('input', { type: 'number', min: 0, max: 4294967295, step: 1, 'aria-label': 'Seed' });
    this.seed.addEventListener('change', () => this.set({ seed: Math.max(0, Math.min(4294967295, Math.trunc(Number(this.seed.value)) || 0)) }));
    const dice = h('button', { type: 'button', class: 'round', 'aria-label': 'Another seed', title: 'Another seed' }, icon('dice'));
    dice.addEventListener('click', () => this.set({ seed: Math.floor(Math.random() * 1e6) }));
    this.row = new GoRow(() => box.go(), 'Wander');
    this.row.root.prepend(h('label', { class: 'field', title: 'The same seed gives the same walk' }, h('span', {}, 'seed'), this.seed, dice));
    this.dock = h('div', { class: 'tool-dock wander-dock', role: 'group', 'aria-label': 'Wander' }, this.list, this.row.root);
  }

  get wander() {
    return this.box.document.wander;
  }

  set(part, merge = null) {
    this.box.edit({ wander: { ...this.wander, ...part } }, merge);
  }

  opened({ info }) {
    this.sliders.clear();
    this.list.replaceChildren(...behavioursOf(info).map((behaviour) => this.slider(behaviour)));
  }

  slider(behaviour) {
    const input = h('input', { type: 'range', min: 0, max: 4, step: 0.25, value: 1, 'aria-label': behaviour.replaceAll('_', ' ') });
    const value = h('output', { class: 'figures' });
    input.addEventListener('input', () => this.set({ weights: { ...this.wander.weights, [behaviour]: Number(input.value) } }, `weight ${behaviour}`));
    input.addEventListener('change', () => this.box.history.settle());
    this.sliders.set(behaviour, { input, value });
    return h('label', { class: 'weight' }, h('span', {}, behaviour.replaceAll('_', ' ')), input, value);
  }

  refresh() {
    const { seed, weights } = this.wander;
    for (const [behaviour, { input, value }] of this.sliders) {
      const weight = weights[behaviour] ?? 1;
      input.value = String(weight);
      value.textContent = weight === 0 ? 'never' : `${weight}×`;
      input.setAttribute('aria-valuetext', value.textContent);
    }
    if (this.seed.getRootNode().activeElement !== this.seed) this.seed.value = String(seed);
    this.answered(this.box.answer);
  }

  answered(answer) {
    const spread = answer?.wander;
    this.row.tell(this.box.trouble, answer, spread ? this.sentence(spread) : this.hint);
  }

  sentence({ frames, objective }) {
    return `visits ${frames.toLocaleString('en')} frames · unevenness ${objective.toPrecision(2)}`;
  }
}
