/**
 * Families: what lies between a walk and a run, by a slider. Moving it sends the actor to the member that is nearest in its
 * parameter, and it goes on in that; the thumb shows the one that is performed. The sliders stand beside the behaviours, and on the stage while another
 * tool is in use and one of their members is performed.
 */

import { h } from '../dom.js';
import { figure, words } from '../format.js';

/** Members that are nearer to each other than this part of the range are one on the slider. */
const ALIKE = 0.01;

export class Families {
  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    const row = (kind) => h('div', { class: `families ${kind}`, role: 'group', 'aria-label': 'Families' });
    this.docked = row('docked');
    this.onStage = row('on-stage');
    box.core.view.stage.root.parentElement.append(this.onStage);
    this.forget();
  }

  /** The actor is gone. */
  forget() {
    this.sliders = [];
    for (const row of [this.docked, this.onStage]) row.replaceChildren();
  }

  opened({ info }) {
    this.forget();
    this.sliders = info.families.filter(({ members }) => members.length > 1).flatMap((family) => [this.docked, this.onStage].map((row) => {
      const slider = new Slider(family, (value) => this.box.take({ behaviour: `${family.name}@${value}` }));
      row.append(slider.root);
      return slider;
    }));
  }

  /** Who came by a slider goes on at that speed; where the member repeats, for ever. */
  happened(type) {
    if (type === 'arrive' && this.sliders.some(({ asked }) => asked !== null)) this.box.core.host.play();
  }

  /** Called once a display frame. */
  step() {
    if (this.sliders.length === 0) return;
    const { director, tool, isUnderWay } = this.box;
    if (!director) return;
    const families = new Map(director.families.map(({ name, value }) => [name, value]));
    for (const slider of this.sliders) {
      const performed = families.get(slider.family.name) ?? null;
      slider.show(performed, isUnderWay);
      if (slider.root.parentElement === this.onStage) slider.root.hidden = tool.withScore || performed === null;
    }
  }
}

class Slider {
  /** @param {(value: string) => void} go hears of the member to go to, by its parameter */
  constructor(family, go) {
    const { name, parameter, unit, members } = family;
    this.family = family;
    this.go = go;
    const all = members.map(({ value }) => value).sort((a, b) => a - b);
    const [least, most] = [all[0], all[all.length - 1]];
    this.values = all.filter((value, at) => at === 0 || value - all[at - 1] > ALIKE * (most - least));
    /** The member that was asked for and is not there yet. */
    this.asked = null;
    this.input = h('input', { type: 'range', min: least, max: most, step: 'any', value: least, 'aria-label': `${words(name)}, ${parameter}` });
    this.output = h('output', { class: 'figures' });
    this.input.addEventListener('input', () => this.ask(this.nearest(Number(this.input.value))));
    this.input.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!by) return;
      event.preventDefault();
      const at = this.values.indexOf(this.nearest(Number(this.input.value))) + by;
      if (at in this.values) this.ask(this.values[at], true);
    });
    this.root = h('label', { class: 'exact family', title: `${words(name)} by ${parameter}, in ${unit}` }, h('span', {}, words(name)), this.input, this.output);
    this.tell(least);
  }

  nearest(wanted) {
    return this.values.reduce((best, value) => (Math.abs(value - wanted) < Math.abs(best - wanted) ? value : best));
  }

  /** @param {boolean} moves whether the thumb is to go there, too */
  ask(value, moves = false) {
    if (moves) this.input.value = String(value);
    this.tell(value);
    if (value === (this.asked ?? this.performed)) return;
    this.asked = value;
    this.go(value.toFixed(4));
  }

  tell(value) {
    const text = `${figure(value)} ${this.family.unit}`;
    if (this.output.textContent === text) return;
    this.output.textContent = text;
    this.input.setAttribute('aria-valuetext', text);
  }

  /** @param {number | null} performed the parameter of the member that is performed */
  show(performed, isUnderWay) {
    const value = performed === null ? null : this.nearest(performed);
    this.root.toggleAttribute('data-performed', value !== null);
    if (this.asked !== null && isUnderWay) return;
    this.asked = null;
    if (value === null || value === this.performed) {
      this.performed = value;
      return;
    }
    this.performed = value;
    this.input.value = String(value);
    this.tell(value);
  }
}
