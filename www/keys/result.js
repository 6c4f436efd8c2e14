/** The transferred actor in a third player, in step with the source. */

import { button, h } from './dom.js';
import { Clock } from './playing.js';
import { Side } from './side.js';

export class ResultView {
  /**
   * @param {Side} source
   * @param {object} act
   * @param {() => void} act.stop all that plays
   * @param {(text: string) => void} act.say
   */
  constructor(source, act) {
    this.source = source;
    this.act = act;
    this.transfer = null;
    const panel = h('div', { class: 'panel' }, h('reprise-player', { alt: 'The result' }));
    this.side = new Side(panel, 'Result');
    this.side.empty.textContent = 'Pack what builder transfer has written, and open the .reprise file here: it moves in step with the source.';
    this.clock = new Clock((seconds) => this.step(seconds));
    this.player = button('Play in step', () => this.toggle(), { disabled: true, title: 'The source and the result at the same time' });
    this.sentence = h('p', { class: 'quiet', role: 'status' });
    this.root = h('div', { class: 'result' }, panel, h('div', { class: 'result-bar' }, this.player, this.sentence));
    this.side.addEventListener('open', () => this.opened());
    this.side.addEventListener('choose', () => this.chosen());
    this.side.addEventListener('trouble', ({ detail }) => act.say(detail));
  }

  open(actor) {
    this.act.stop();
    this.side.open(actor);
  }

  /** What is known of where its sequences come from. */
  tell(transfer) {
    this.transfer = transfer;
    this.chosen();
  }

  opened() {
    if (!this.side.info) return this.update();
    const shown = this.source.sequence?.name;
    const { sequences } = this.side.info;
    // One that was made, rather than one of the target's own that is called alike.
    const made = sequences.find(({ name }) => this.made(name) && this.originOf(name) === shown) ?? sequences.find(({ name }) => this.made(name));
    this.side.show(made ?? sequences[0], 0);
    return this.chosen();
  }

  /** Whether a sequence is known, or looks, to have been transferred. */
  made(name) {
    return Boolean(this.transfer?.sequences.some((one) => one.name === name)) || /_transferred$/.test(name);
  }

  /** The name of the source's sequence that one of the result does, or null. */
  originOf(name) {
    const told = this.transfer?.sequences.find((one) => one.name === name)?.from;
    const origin = told ?? name?.replace(/(_transferred)+$/, '');
    return this.source.sequenceOf(origin) ? origin : null;
  }

  get origin() {
    return this.side.info ? this.originOf(this.side.sequence.name) : null;
  }

  /** Another sequence of the result is to be seen: the source shows where it comes from. */
  chosen() {
    const { origin } = this;
    if (origin) this.source.show(this.source.sequenceOf(origin), origin === this.source.sequence.name ? this.source.frame : 0);
    this.update();
  }

  /** The source shows another frame. */
  follow() {
    const { side, source } = this;
    if (!side.info || !source.sequence) return;
    if (this.origin !== source.sequence.name) {
      const other = side.info.sequences.find(({ name }) => this.made(name) && this.originOf(name) === source.sequence.name);
      if (other) side.show(other, 0);
      this.update();
      if (!other) return;
    }
    side.show(side.sequence, (source.frame / source.info.fps) * side.info.fps);
  }

  update() {
    const { side, source, origin } = this;
    this.player.disabled = !origin;
    this.sentence.textContent = this.words(side.sequence?.name, origin, source);
  }

  words(name, origin, source) {
    if (!this.side.info) return '';
    if (!source.info) return 'Open the source, too: the two are shown in step.';
    if (!origin) return `No sequence of the source is known to be where “${name}” comes from; open the transfer.json that tells.`;
    return origin === source.sequence.name ? `“${name}” does what “${origin}” of the source does, at the same time.` : `“${name}” comes from “${origin}”; the source shows another sequence.`;
  }

  toggle() {
    if (this.clock.on) return this.stop();
    this.act.stop();
    const { origin, source } = this;
    if (!origin) return undefined;
    if (source.sequence.name !== origin) source.show(source.sequenceOf(origin), 0);
    if (source.frame >= source.sequence.count - 1) source.show(source.sequence, 0);
    this.player.textContent = 'Pause';
    return this.clock.start();
  }

  stop() {
    this.clock.stop();
    this.player.textContent = 'Play in step';
  }

  /** The source goes on, and the result follows it. */
  step(seconds) {
    const { source } = this;
    const frame = source.frame + seconds * source.info.fps;
    source.show(source.sequence, frame > source.sequence.count - 1 ? 0 : frame);
  }
}
