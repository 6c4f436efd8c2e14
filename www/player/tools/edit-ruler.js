/** The frames of a sequence as a ruler: each edit with the window in which it fades, and the ends of the chosen one to drag. */

import { h } from '../dom.js';
import { showScale } from './dock.js';

const NAMES = ['First frame that changes', 'The edited frame', 'Last frame that changes'];

export class EditRuler {
  /**
   * @param {object} act
   * @param {(which: number, frame: number, merge: string) => void} act.move an end of the window (0 and 2), or the edited frame (1)
   * @param {(frame: number) => void} act.seek a frame of the sequence
   * @param {(index: number) => void} act.choose an edit
   */
  constructor(act) {
    this.act = act;
    this.count = 1;
    this.runs = 0;
    this.scale = h('div', { class: 'scale figures', 'aria-hidden': 'true' });
    this.bars = h('div', { class: 'edit-bars', 'aria-hidden': 'true' });
    this.head = h('div', { class: 'brush-mark playhead', 'aria-hidden': 'true' });
    this.ends = NAMES.map((name, which) => this.end(name, which));
    this.lane = h('div', { class: 'lane' }, this.bars, this.head, ...this.ends);
    this.root = h('div', { class: 'ruler edit-ruler', role: 'group', 'aria-label': 'Frames that change' }, this.lane, this.scale);
    this.lane.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || this.ends.includes(event.target)) return;
      this.lane.setPointerCapture(event.pointerId);
      this.act.seek(this.frameAt(event));
    });
    this.lane.addEventListener('pointermove', (event) => this.lane.hasPointerCapture(event.pointerId) && this.act.seek(this.frameAt(event)));
  }

  /**
   * @param {number} count frames of the sequence
   * @param {{window: [number, number], frame: number, on: boolean}[]} edits those of the sequence
   * @param {number} chosen which of them, or -1
   */
  show(count, fps, edits, chosen) {
    if (count !== this.count) showScale(this.scale, count / fps, 's', [0.5, 1, 2, 5, 10, 30, 60], 16);
    this.count = count;
    while (this.bars.children.length > edits.length) this.bars.lastChild.remove();
    while (this.bars.children.length < edits.length) this.bars.append(h('span', {}, h('i', {})));
    edits.forEach(({ window: [first, last], frame, on }, index) => {
      const bar = this.bars.children[index];
      bar.style.left = this.share(first);
      bar.style.width = `${((last - first) / this.span) * 100}%`;
      bar.firstChild.style.left = `${((frame - first) / Math.max(1, last - first)) * 100}%`;
      bar.toggleAttribute('data-off', !on);
      bar.toggleAttribute('data-chosen', index === chosen);
    });
    const one = edits[chosen];
    this.ends.forEach((end, which) => {
      end.hidden = !one;
      if (!one) return;
      const at = [one.window[0], one.frame, one.window[1]][which];
      end.style.left = this.share(at);
      end.setAttribute('aria-valuenow', String(at));
      end.setAttribute('aria-valuemin', '0');
      end.setAttribute('aria-valuemax', String(this.count - 1));
      end.setAttribute('aria-valuetext', `${NAMES[which]}: ${at}, at ${(at / fps).toFixed(2)} seconds`);
    });
  }

  /** Where the actor is, in frames of the sequence; null where it is in another one. */
  showHead(frame) {
    this.head.hidden = frame === null;
    if (frame !== null) this.head.style.left = this.share(frame);
  }

  get span() {
    return Math.max(1, this.count - 1);
  }

  share(frame) {
    return `${((frame / this.span) * 100).toFixed(3)}%`;
  }

  frameAt(event) {
    const box = this.lane.getBoundingClientRect();
    return Math.max(0, Math.min(this.count - 1, Math.round(((event.clientX - box.left) / box.width) * this.span)));
  }

  end(name, which) {
    const end = h('button', { type: 'button', class: `edit-end ${which === 1 ? 'key' : ''}`, role: 'slider', 'aria-label': name, title: `${name}: drag, or arrow keys`, hidden: true });
    end.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      this.runs += 1;
      end.setPointerCapture(event.pointerId);
      event.stopPropagation();
    });
    end.addEventListener('pointermove', (event) => {
      if (end.hasPointerCapture(event.pointerId)) this.act.move(which, this.frameAt(event), `window ${which} ${this.runs}`);
    });
    end.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!by) return;
      this.act.move(which, Number(end.getAttribute('aria-valuenow')) + by * (event.shiftKey ? 10 : 1), `window keys ${which}`);
      event.preventDefault();
      event.stopPropagation();
    });
    return end;
  }
}
