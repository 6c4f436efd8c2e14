/** The frames of a side's sequence as a ruler: scrubbed with pointer and arrow keys; the ends of pairs on it are dragged. */

import { h } from './dom.js';
import { pairName } from './rules.js';

/** Steps between marks of the scale, in frames. */
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
/** Pixels between numbers of the scale, at least. */
const APART = 44;
/** Frames that an arrow key goes on with shift, and a page key. */
const FAR = 10;

/** The frames that a key goes on by; null for other keys. */
export function stepOf({ key, shiftKey }) {
  const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -FAR, PageUp: FAR, Home: -Infinity, End: Infinity }[key];
  return by === undefined ? null : Math.abs(by) === 1 && shiftKey ? by * FAR : by;
}

export class Ruler {
  /**
   * @param {import('./side.js').Side} side
   * @param {'fromFrame' | 'toFrame'} end which end of a pair lies on it
   * @param {object} act
   * @param {(pair: object) => void} act.select
   * @param {(pair: object, frame: number, merge: string | null) => void} act.move the pair's end
   * @param {() => void} act.stop what plays
   */
  constructor(side, end, act) {
    this.side = side;
    this.end = end;
    this.act = act;
    this.handles = new Map();
    this.drags = 0;
    const name = `Frame of the ${side.title.toLowerCase()}`;
    this.scale = h('div', { class: 'scale', 'aria-hidden': 'true' });
    this.head = h('div', { class: 'head', 'aria-hidden': 'true' });
    this.lane = h('div', { class: 'lane', role: 'slider', tabindex: '0', 'aria-label': name, 'aria-valuemin': 0, 'aria-valuemax': 0, 'aria-valuenow': 0 }, this.scale, this.head);
    this.marks = h('div', { class: 'ends', role: 'group', 'aria-label': `Ends of pairs in the ${side.title.toLowerCase()}` });
    this.figure = h('output', { class: 'figure' }, '–');
    this.label = h('span', { class: 'ruler-name' }, side.title);
    this.root = h('div', { class: `ruler ${end === 'fromFrame' ? 'of-source' : 'of-target'}` }, this.label, h('div', { class: 'track' }, this.lane, this.marks), this.figure);
    this.listen();
  }

  listen() {
    const { lane, side } = this;
    lane.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || !side.sequence) return;
      this.act.stop();
      lane.setPointerCapture(event.pointerId);
      side.show(side.sequence, this.frameAt(event));
    });
    lane.addEventListener('pointermove', (event) => lane.hasPointerCapture(event.pointerId) && side.show(side.sequence, this.frameAt(event)));
    lane.addEventListener('keydown', (event) => {
      const by = stepOf(event);
      if (by === null || !side.sequence || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      this.act.stop();
      side.step(by);
    });
    new ResizeObserver(() => this.drawScale()).observe(lane);
  }

  get last() {
    return Math.max(1, (this.side.sequence?.count ?? 1) - 1);
  }

  /** A frame that there is. */
  within(frame) {
    return Math.min((this.side.sequence?.count ?? 1) - 1, Math.max(0, frame));
  }

  share(frame) {
    return frame / this.last;
  }

  frameAt({ clientX }) {
    const { left, width } = this.lane.getBoundingClientRect();
    return this.within(Math.round(((clientX - left) / width) * this.last));
  }

  /** The frame shown has changed, and perhaps the sequence. */
  update() {
    const { side, lane } = this;
    const { sequence, whole, info } = side;
    this.root.toggleAttribute('data-empty', !sequence);
    if (!sequence) {
      this.figure.textContent = '–';
      this.scale.replaceChildren();
      return;
    }
    const seconds = (whole / info.fps).toFixed(2);
    this.head.style.left = `${this.share(side.frame) * 100}%`;
    this.figure.textContent = `${whole} of ${sequence.count - 1}`;
    this.figure.title = `${seconds} s`;
    lane.setAttribute('aria-valuemax', String(sequence.count - 1));
    lane.setAttribute('aria-valuenow', String(whole));
    lane.setAttribute('aria-valuetext', `${sequence.name}, frame ${whole} of ${sequence.count - 1}, at ${seconds} seconds`);
    if (this.drawn !== sequence) this.drawScale();
  }

  drawScale() {
    const { sequence } = this.side;
    this.drawn = sequence;
    if (!sequence) return;
    const room = Math.max(1, Math.floor(this.lane.clientWidth / APART));
    const step = STEPS.find((one) => this.last / one <= room) ?? STEPS.at(-1);
    const marks = [];
    for (let frame = 0; frame < sequence.count; frame += step) {
      const mark = h('span', {}, String(frame));
      mark.style.left = `${this.share(frame) * 100}%`;
      marks.push(mark);
    }
    this.scale.replaceChildren(...marks);
  }

  /** Shows the ends of these pairs. @param {number | null} chosen the id of the selected one @param {Set<number>} wrong ids of those with errors */
  showEnds(pairs, chosen, wrong) {
    const ids = new Set(pairs.map(({ id }) => id));
    for (const [id, handle] of this.handles) {
      if (ids.has(id)) continue;
      handle.remove();
      this.handles.delete(id);
    }
    for (const pair of pairs) {
      const handle = this.handles.get(pair.id) ?? this.handle(pair.id);
      const frame = pair[this.end];
      handle.pair = pair;
      handle.style.left = `${Math.min(1, this.share(frame)) * 100}%`;
      handle.toggleAttribute('data-chosen', pair.id === chosen);
      handle.toggleAttribute('data-wrong', wrong.has(pair.id));
      handle.setAttribute('aria-label', `Pair ${pairName(pair)}${pair.stretch === null ? '' : `, stretch ${pair.stretch}`}: end in the ${this.side.title.toLowerCase()}`);
      handle.setAttribute('aria-valuemax', String(this.last));
      handle.setAttribute('aria-valuenow', String(frame));
      handle.setAttribute('aria-valuetext', `frame ${frame}${wrong.has(pair.id) ? ', wrong' : ''}`);
    }
  }

  handle(id) {
    const handle = h('div', { class: 'end', role: 'slider', tabindex: '0', 'aria-valuemin': 0, 'data-id': id });
    let merge = null;
    handle.addEventListener('focus', () => this.act.select(handle.pair));
    handle.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      merge = `drag ${(this.drags += 1)} ${this.end}`;
      this.act.select(handle.pair);
    });
    handle.addEventListener('pointermove', (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const frame = this.frameAt(event);
      if (frame !== handle.pair[this.end]) this.act.move(handle.pair, frame, merge);
    });
    handle.addEventListener('keydown', (event) => {
      const by = stepOf(event);
      if (by === null || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      const frame = this.within(handle.pair[this.end] + by);
      if (frame !== handle.pair[this.end]) this.act.move(handle.pair, frame, `keys ${id} ${this.end}`);
    });
    this.handles.set(id, handle);
    this.marks.append(handle);
    return handle;
  }
}
