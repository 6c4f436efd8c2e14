/** Key poses at given times: dropped on a ruler from the poses below it, moved, retimed; and when the actor reaches them. */

import { button, h } from '../dom.js';
import { count, poseName, title } from '../format.js';
import { coarseFirst } from '../thumbnails.js';
import { copyPicture } from './dock.js';
import { Ruler } from './ruler.js';
import { Tool } from './tool.js';

/** Seconds after the last key pose at which a new one is put. */
const APART = 2;
const MOST_KEYS = 100;
/** A press that goes no farther than this many CSS pixels is a click. */
const TREMBLE = 6;

export class TimingTool extends Tool {
  static id = 'timing';
  static title = 'Timing';
  static about = 'Put poses on a ruler: the actor is there in time';
  static hint = 'Drag poses onto the ruler, or click them.';

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    super(box);
    this.ruler = new Ruler({
      move: (index, seconds, merge) => this.retime(index, seconds, merge),
      shift: (index, by) => this.shift(index, by),
      remove: (index) => this.remove(index),
      describe: (key) => this.named(key.frame),
    });
    this.shelf = h('div', { class: 'shelf', role: 'group', 'aria-label': 'Poses to put on the ruler' });
    this.row.root.prepend((this.clear = button('Clear', 'Take all key poses away', () => this.set([]))));
    this.table = h('table', { class: 'figures' });
    this.times = h('div', { class: 'times', tabindex: 0, role: 'group', 'aria-label': 'Wanted and reached times', hidden: true }, this.table);
    this.build(this.ruler.root, this.times, this.shelf, this.row.root);
  }

  get keys() {
    return this.box.document.keys;
  }

  opened({ timeline }) {
    this.timeline = timeline;
    this.thumbs = new Map();
    this.shelf.replaceChildren(
      ...timeline.sequences.map((sequence, index) =>
        h('div', { class: 'shelf-part' }, h('span', { class: 'label' }, title(sequence)), ...timeline.thumbnails(index).map((frame) => this.pose(frame))),
      ),
    );
  }

  /** A pose on the shelf: a click puts it at the end, a drag where it is let go. */
  pose(frame) {
    const picture = h('canvas', { width: 72, height: 96 });
    let start = null;
    let moved = false;
    const pose = button(picture, this.named(frame), () => moved || this.add(frame), { class: 'pose', 'aria-label': `Add ${this.named(frame)}` });
    this.thumbs.set(frame, picture);
    pose.addEventListener('pointerdown', (event) => {
      start = { x: event.clientX, y: event.clientY };
      moved = false;
      pose.setPointerCapture(event.pointerId);
    });
    pose.addEventListener('pointermove', (event) => {
      if (!start || Math.hypot(event.clientX - start.x, event.clientY - start.y) < TREMBLE) return;
      moved = true;
      this.ruler.hover(event, picture);
    });
    pose.addEventListener('pointerup', (event) => {
      const seconds = moved ? this.ruler.drop(event) : null;
      start = null;
      if (seconds !== null) this.add(frame, seconds);
    });
    pose.addEventListener('pointercancel', () => {
      start = null;
      this.ruler.drop(null);
    });
    return pose;
  }

  named(frame) {
    return poseName(this.timeline.sequenceOf(frame), frame, this.timeline.fps);
  }

  enter() {
    const { view } = this.box.core;
    view.score.onThumbnail = (frame) => this.paint(frame);
    this.wantThumbnails();
  }

  /** Asks for all poses that are loaded; called again as more can be drawn. */
  wantThumbnails() {
    if (!this.timeline) return;
    const frames = [...this.thumbs.keys()].filter((frame) => this.box.director?.player.loaded(frame));
    frames.forEach((frame) => this.paint(frame));
    this.box.core.view.score.shelf.want(coarseFirst(frames));
  }

  leave() {
    this.box.core.view.score.onThumbnail = null;
  }

  paint(frame) {
    const picture = this.box.core.view.score.shelf.get(frame);
    const canvas = this.thumbs?.get(frame);
    if (!picture || !canvas) return;
    copyPicture(canvas, picture);
    this.ruler.paint(this.keys, (key) => this.picture(key));
  }

  /** The picture of the pose on the shelf that is nearest to a key pose. */
  picture({ frame }) {
    let nearest = null;
    for (const one of this.thumbs?.keys() ?? []) {
      if (this.timeline.indexOf(one) === this.timeline.indexOf(frame) && (nearest === null || Math.abs(one - frame) < Math.abs(nearest - frame))) nearest = one;
    }
    return this.thumbs?.get(nearest) ?? null;
  }

  // ---- changing the key poses -----------------------------------------------------------------------------------

  /** Key poses are kept in the order of their times. */
  set(keys, merge = null) {
    const sorted = [...keys].sort((a, b) => a.seconds - b.seconds);
    this.box.edit({ keys: sorted }, merge);
    return sorted;
  }

  add(frame, seconds = (this.keys.at(-1)?.seconds ?? 0) + APART) {
    if (this.keys.length >= MOST_KEYS) return;
    const key = { frame, seconds };
    const keys = this.set([...this.keys, key]);
    this.ruler.focus(keys.indexOf(key));
    this.box.core.say(`${this.named(frame)} at ${seconds.toFixed(1)} s`);
  }

  retime(index, seconds, merge) {
    const key = { ...this.keys[index], seconds: Math.max(0, Math.round(seconds * 100) / 100) };
    // While a key pose is dragged it keeps its place in the order.
    const keys = this.keys.with(index, key);
    const sorted = keys.every((one, at) => at === 0 || keys[at - 1].seconds <= one.seconds);
    if (sorted) this.box.edit({ keys }, merge);
    else this.ruler.focus(this.set(keys, merge).indexOf(key));
    return this.keys.indexOf(key);
  }

  /** Another pose at the same time. */
  shift(index, by) {
    const key = this.keys[index];
    this.set(this.keys.with(index, { ...key, frame: this.timeline.step(key.frame, by) }), `shift ${index}`);
  }

  remove(index) {
    this.set(this.keys.toSpliced(index, 1));
    this.ruler.focus(index);
  }

  // ---- what is shown --------------------------------------------------------------------------------------------

  refresh() {
    if (!this.timeline) return;
    this.ruler.show(this.keys, (key) => this.picture(key));
    this.answered(this.box.answer);
  }

  answered(answer) {
    super.answered(answer);
    const reached = answer?.keys ?? [];
    this.ruler.reached(reached);
    this.times.hidden = this.clear.disabled = this.keys.length === 0;
    // The last times stay to be read until there are others.
    if (!answer && this.keys.length > 0) return;
    const cells = (tag, ...texts) => h('tr', {}, ...texts.map((text) => h(tag, tag === 'th' ? { scope: 'col' } : {}, text)));
    this.table.replaceChildren(
      h('caption', { class: 'unseen' }, 'Key poses: wanted and reached times'),
      h('thead', {}, cells('th', 'pose', 'wanted', 'reached', 'off')),
      h('tbody', {}, ...reached.map(({ frame, wanted, reached: at }) => cells('td', this.named(frame), `${wanted.toFixed(2)} s`, at === null ? '–' : `${at.toFixed(2)} s`, at === null ? '–' : `${at >= wanted ? '+' : '−'}${Math.abs(at - wanted).toFixed(2)}`))),
    );
  }

  sentence({ keys: reached = [], transitions }) {
    const off = reached.filter(({ reached: at }) => at !== null).map(({ wanted, reached: at }) => Math.abs(at - wanted));
    if (off.length === 0) return 'no way through these poses';
    const mean = off.reduce((sum, one) => sum + one, 0) / off.length;
    return `${count(reached.length, 'pose')}, through ${count(transitions, 'transition')} · off by ${mean.toFixed(2)} s on average, ${Math.max(...off).toFixed(2)} s at most`;
  }
}
