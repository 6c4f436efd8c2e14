/** The parts of the body: a chip that colours the actor by them, and their names beside it. Actors without parts have no chip. */

import { button, h } from './dom.js';

/** The torso's first, red, green and blue; where there are more parts, they come again. */
const COLOURS = [0xb4aea4, 0xd8483e, 0x3f6fd8, 0xe2b33c, 0x3f9a5a, 0x8e5bbf, 0xe2793a, 0x3fa6a8, 0xd87398];

export class Parts {
  /** @param {() => void} toggle */
  constructor(toggle) {
    this.chip = button('parts', 'Parts of the body in colours (B)', toggle, { 'aria-pressed': 'false', hidden: true });
    this.legend = h('ul', { class: 'legend', 'aria-label': 'Parts of the body', part: 'legend', hidden: true });
    this.forget();
  }

  /** Another actor. */
  forget() {
    /** Names and colours; none where they have not arrived, or there are none. */
    this.all = [];
    this.painted = null;
    this.chip.hidden = true;
    this.legend.hidden = true;
  }

  /** All of the actor is there. */
  arrived(player) {
    const names = player.parts().split('\n').filter(Boolean);
    this.all = names.map((name, part) => ({ name, colour: `#${COLOURS[part % COLOURS.length].toString(16)}` }));
    this.chip.hidden = this.all.length === 0;
    this.legend.replaceChildren(...this.all.map(({ name, colour }) => {
      const swatch = h('span', { class: 'swatch', 'aria-hidden': 'true' });
      swatch.style.background = colour;
      return h('li', {}, swatch, name);
    }));
  }

  /** Shows them or not; a stage gets the colours when they are first wanted there. */
  show(on, stage, player) {
    const shown = on && this.all.length > 0;
    this.chip.setAttribute('aria-pressed', String(shown));
    this.legend.hidden = !shown;
    if (!shown || !stage || stage === this.painted) return;
    this.painted = stage;
    stage.set_parts(player, Uint8Array.from(COLOURS.flatMap((colour) => [colour >> 16, colour >> 8, colour])));
  }
}
