/** One of the players: the actor that is opened in it, and the frame of a sequence that it shows. */

import { button, h } from './dom.js';
import { choose } from './files.js';

/**
 * Tells with events: `open` when an actor is there, or another is on its way, `show` when another sequence or frame is shown, `choose` when a
 * sequence was chosen from the list, `trouble` (detail: a sentence).
 */
export class Side extends EventTarget {
  /**
   * @param {HTMLElement} root a panel with a player
   * @param {string} title what the actor is here, such as “Source”
   */
  constructor(root, title) {
    super();
    this.root = root;
    this.title = title;
    this.info = null;
    this.sequence = null;
    this.frame = 0;
    /** The file's name, or its address. */
    this.name = '';
    this.address = null;
    this.player = root.querySelector('reprise-player');
    this.opener = button('Open…', () => this.ask(), { 'aria-label': `Open the ${title.toLowerCase()}, a .reprise file` });
    this.what = h('span', { class: 'what' });
    this.choice = h('select', { 'aria-label': `Sequence of the ${title.toLowerCase()}`, disabled: true });
    this.empty = h('p', { class: 'empty' }, `Open the ${title.toLowerCase()}’s .reprise file, or drop it here.`);
    const heading = h('h2', {}, title);
    root.prepend(h('div', { class: 'panel-bar' }, heading, this.what, this.choice, this.opener));
    this.player.after(this.empty);
    this.listen();
  }

  listen() {
    this.choice.addEventListener('change', () => {
      this.show(this.info.sequences[this.choice.selectedIndex], 0);
      this.dispatchEvent(new Event('choose'));
    });
    this.player.addEventListener('ready', () => this.ready());
    // A pose may have been asked for before it had come.
    this.player.addEventListener('load', () => this.show());
    this.player.addEventListener('error', ({ detail }) => this.failed(detail.message));
  }

  async ask() {
    const file = await choose('.reprise');
    if (file) this.open(file);
  }

  /** @param {File | string} actor a file, or an address */
  open(actor) {
    if (this.address) URL.revokeObjectURL(this.address);
    this.address = actor instanceof File ? URL.createObjectURL(actor) : null;
    this.name = actor instanceof File ? actor.name : actor.split(/[?#]/)[0].split('/').at(-1);
    this.info = null;
    this.sequence = null;
    this.empty.hidden = true;
    this.root.toggleAttribute('data-opened', true);
    this.what.textContent = this.name;
    this.choice.replaceChildren();
    this.choice.disabled = true;
    this.player.src = this.address ?? actor;
    this.dispatchEvent(new Event('open'));
  }

  ready() {
    this.info = this.player.info;
    this.player.pause();
    this.what.textContent = this.info.name === this.name.replace(/\.reprise$/, '') ? this.info.name : `${this.info.name} · ${this.name}`;
    this.what.title = `${this.info.frames} frames, ${round(this.info.fps)} a second`;
    this.choice.replaceChildren(...this.info.sequences.map(({ name, count }) => h('option', { value: name }, `${name} (${count})`)));
    this.choice.disabled = false;
    this.sequence = this.info.sequences[0];
    this.frame = 0;
    this.dispatchEvent(new Event('open'));
    this.show();
  }

  /** The player itself says what is wrong, too. */
  failed(message) {
    // Another actor may take this place.
    if (!this.info) this.name = '';
    this.say(`${this.title}: ${message}`);
    this.dispatchEvent(new Event('open'));
  }

  sequenceOf(name) {
    return this.info?.sequences.find((one) => one.name === name) ?? null;
  }

  /**
   * Shows exactly this frame as it was recorded, or what lies between two.
   * @param {object} sequence one of `info.sequences`
   * @param {number} frame counted within it
   */
  show(sequence = this.sequence, frame = this.frame) {
    if (!sequence) return;
    const changed = sequence !== this.sequence;
    this.sequence = sequence;
    this.frame = Math.min(sequence.count - 1, Math.max(0, frame));
    if (changed || this.choice.selectedIndex < 0) this.choice.selectedIndex = this.info.sequences.indexOf(sequence);
    try {
      if (this.player.playing) this.player.pause();
      this.player.seek(sequence.first + this.frame);
    } catch (error) {
      // A frame that has not arrived is shown once all has.
      if (error?.kind !== 'not-loaded') this.say(`${this.title}: ${error.message}`);
    }
    this.dispatchEvent(new Event('show'));
  }

  /** The whole frame nearest to what is shown. */
  get whole() {
    return Math.round(this.frame);
  }

  step(by) {
    this.show(this.sequence, this.whole + by);
  }

  say(text) {
    this.dispatchEvent(new CustomEvent('trouble', { detail: text }));
  }
}

function round(number) {
  return Math.round(number * 100) / 100;
}
