/**
 * The actor's texture where it changes from frame to frame: reads its modes a little at a time, has it rebuilt, and lets
 * the reader compare ways of changing it in transitions.
 */

import { button, h } from './dom.js';

/** Milliseconds of a display frame that go into reading modes. */
const READING = 4;

/** Ways to change the texture. Not every bundle holds a naive model beside ours; none holds the textures as captured. */
const WAYS = [
  { name: 'ours', title: 'Colours and their warp interpolated, as the shape is' },
  { name: 'cross-fade', title: 'The two textures blended linearly: details show twice' },
  { name: 'naive', title: 'As many principal components of textures that were not aligned' },
  { name: 'original', title: 'Missing: the textures as captured are not in this file', missing: true },
];

export class Looks {
  /**
   * @param {object} on
   * @param {(way: string) => void} on.compare
   * @param {() => void} on.dressed there is a texture to show
   */
  constructor(on) {
    this.on = on;
    this.dressed = false;
    this.chip = button('compare', 'Compare ways of changing the texture (C)', () => this.toggle(), { 'aria-expanded': 'false', hidden: true });
    this.list = h('div', { class: 'choices', role: 'radiogroup', 'aria-label': 'How the texture changes', hidden: true }, ...WAYS.map((way) => this.choice(way)));
  }

  choice({ name, title, missing }) {
    const attributes = { role: 'radio', 'aria-checked': String(name === 'ours'), disabled: Boolean(missing) };
    return button(missing ? `${name} (missing)` : name, title, () => this.choose(name), attributes);
  }

  choose(name) {
    [...this.list.children].forEach((button, at) => button.setAttribute('aria-checked', String(WAYS[at].name === name)));
    this.on.compare(name);
  }

  toggle(open = this.list.hidden) {
    this.list.hidden = !open || this.chip.hidden;
    this.chip.setAttribute('aria-expanded', String(!this.list.hidden));
  }

  /** Another actor, or a new stage. */
  forget() {
    this.dressed = false;
  }

  /** One display frame's share of the work. @returns whether there is more to do */
  step(info, player, stage) {
    this.chip.hidden = !info.appearance;
    this.list.children[2].hidden = info.naive === null;
    if (!info.appearance) return false;
    const more = player.refine(READING);
    const busy = stage.dress(player);
    if (busy && !this.dressed) {
      this.dressed = true;
      this.on.dressed();
    }
    return more || busy;
  }
}
