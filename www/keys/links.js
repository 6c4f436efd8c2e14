/** Lines between the rulers: each joins two frames that mean the same. */

import { h, s } from './dom.js';

/** Units of the picture from left to right and from top to bottom; it is stretched over the space that there is. */
const [WIDTH, HEIGHT] = [1000, 100];

export class Links {
  /** @param {(pair: object) => void} select */
  constructor(select) {
    this.select = select;
    this.picture = s('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', 'aria-hidden': 'true' });
    this.sentence = h('p', { class: 'links-empty' });
    this.root = h('div', { class: 'links' }, h('span'), h('div', { class: 'track' }, this.picture, this.sentence), h('span'));
    this.picture.addEventListener('click', ({ target }) => {
      const id = Number(target.closest('g')?.getAttribute('data-id'));
      const pair = this.pairs.find((one) => one.id === id);
      if (pair) this.select(pair);
    });
  }

  /** @param {import('./ruler.js').Ruler[]} rulers of the source and of the target */
  show(pairs, [from, to], chosen, wrong, sentence) {
    this.pairs = pairs;
    const ordered = [...pairs].sort((a, b) => Number(a.id === chosen) - Number(b.id === chosen));
    this.picture.replaceChildren(...ordered.map((pair) => {
      const ends = { x1: WIDTH * Math.min(1, from.share(pair.fromFrame)), y1: 0, x2: WIDTH * Math.min(1, to.share(pair.toFrame)), y2: HEIGHT };
      const group = s('g', { 'data-id': pair.id, 'data-chosen': pair.id === chosen, 'data-wrong': wrong.has(pair.id) }, s('line', { class: 'grip', ...ends }), s('line', { class: 'line', ...ends }));
      return group;
    }));
    this.sentence.textContent = pairs.length === 0 ? sentence : '';
    this.sentence.hidden = pairs.length > 0;
  }
}
