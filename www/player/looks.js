/**
 * The actor's texture where it changes from frame to frame: reads its modes a little at a time, has it rebuilt, and lets
 * the reader compare ways of changing it in transitions.
 */

import { button, h } from './dom.js';

/** Milliseconds of a display frame that go into reading modes. */
const READING = 4;

/** Ways to change the texture. Not every bundle holds a naive model beside ours; textures as captured are files beside it. */
const WAYS = [
  { name: 'ours', title: 'Colours and their warp interpolated, as the shape is' },
  { name: 'cross-fade', title: 'The two textures blended linearly: details show twice' },
  { name: 'naive', title: 'As many principal components of textures that were not aligned' },
  { name: 'original', title: 'The texture as it was captured, in recorded frames; ours in between' },
  { name: 'template', title: 'The mesh that all scanned frames were brought onto, in recorded frames, too' },
];

export class Looks {
  /**
   * @param {object} on
   * @param {(way: string) => void} on.compare
   * @param {() => void} on.dressed there is a texture to show
   * @param {() => string} on.originals where the textures as captured are, with `%d` for the frame
   * @param {(message: string) => void} on.missing one of them is not there
   */
  constructor(on) {
    this.on = on;
    this.dressed = false;
    this.way = 'ours';
    /** The frame whose captured texture is worn or on its way; -1 for none. */
    this.original = -1;
    this.worn = -1;
    this.chip = button('compare', 'Compare ways of changing the texture (C)', () => this.toggle(), { 'aria-expanded': 'false', hidden: true });
    this.list = h('div', { class: 'choices', role: 'radiogroup', 'aria-label': 'How the texture changes', hidden: true }, ...WAYS.map((way) => this.choice(way)));
  }

  choice({ name, title }) {
    return button(name, title, () => this.choose(name), { role: 'radio', 'aria-checked': String(name === 'ours') });
  }

  choose(name) {
    this.way = name;
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
    this.original = -1;
  }

  /** One display frame's share of the work. @returns whether there is more to do */
  step({ info, player, state }, stage) {
    this.chip.hidden = !info.appearance && !info.scanned;
    const { children } = this.list;
    children[1].hidden = !info.appearance;
    children[2].hidden = info.naive === null;
    children[3].hidden = !info.appearance || !this.on.originals();
    children[4].hidden = !info.scanned;
    if (!info.appearance) return false;
    this.wear(player, state, stage);
    const more = player.refine(READING);
    const busy = stage.dress(player);
    if (busy && !this.dressed) {
      this.dressed = true;
      this.on.dressed();
    }
    return more || busy;
  }

  /** Sees to it that a recorded frame wears its texture as captured, if that is wanted. */
  wear(player, { frame, mode }, stage) {
    const wanted = this.way === 'original' && mode !== 'synthetic' ? frame : -1;
    if (stage !== this.stage) [this.stage, this.original, this.worn] = [stage, -1, -1];
    if (wanted === this.original) return;
    this.original = wanted;
    if (wanted >= 0) {
      this.fetch(wanted, player, stage);
      return;
    }
    stage.set_original(player);
    this.worn = -1;
  }

  async fetch(frame, player, stage) {
    const address = this.on.originals().replace(/%0?(\d*)d/, (_, digits) => String(frame).padStart(Number(digits), '0'));
    try {
      const response = await fetch(new URL(address, document.baseURI));
      if (!response.ok) throw new Error(response.statusText);
      const bitmap = await createImageBitmap(await response.blob(), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
      // What has come too late is not worn.
      if (this.original === frame && this.stage === stage && !stage.lost()) {
        stage.set_original(player, bitmap);
        this.worn = frame;
      }
      bitmap.close();
      this.on.dressed();
    } catch {
      if (this.original !== frame) return;
      this.choose('ours');
      this.on.missing(`the texture of frame ${frame} is not at ${address}`);
    }
  }
}
