/** The walk as one bar in time: recorded stretches solid green, synthetic ones hatched red, and how far the actor is. */

import { h } from './dom.js';
import { duration, title } from './format.js';

export class WalkBar {
  constructor() {
    this.legs = h('div', { class: 'legs' });
    this.mark = h('div', { class: 'mark' });
    this.root = h('div', { class: 'walk-bar', role: 'img', part: 'walk', hidden: true }, this.legs, this.mark);
    this.drawn = '';
    this.ends = [];
  }

  /**
   * @param {object} state the player's state
   * @param {import('./timeline.js').Timeline} timeline
   */
  update(state, timeline) {
    this.root.hidden = !state.walk || state.walk.length === 0;
    if (this.root.hidden) return;
    const key = JSON.stringify(state.walk);
    if (key !== this.drawn) this.rebuild(state.walk, timeline);
    this.drawn = key;
    const before = state.leg > 0 ? this.ends[state.leg - 1] : 0;
    const share = before + (this.ends[state.leg] - before) * state.leg_progress;
    this.mark.style.left = `${(Math.min(1, Math.max(0, share || 0)) * 100).toFixed(2)}%`;
    this.root.setAttribute('aria-label', `The walk: ${duration(state.remaining_seconds)} left`);
  }

  rebuild(walk, timeline) {
    const frames = walk.map((leg) => Math.max(0.5, leg.kind === 'recorded' ? leg.steps : leg.frames));
    const total = frames.reduce((sum, one) => sum + one, 0);
    let end = 0;
    this.ends = frames.map((one) => (end += one / total));
    this.legs.replaceChildren(
      ...walk.map((leg, index) => {
        const piece = h('div', { class: `leg ${leg.kind}`, title: legTitle(leg, timeline) });
        piece.style.flexGrow = String(frames[index]);
        return piece;
      }),
    );
  }
}

function legTitle(leg, timeline) {
  if (leg.kind === 'recorded') return `${title(timeline.sequenceOf(leg.first))}, ${duration(leg.steps / timeline.fps)} as recorded`;
  const [from, to] = [leg.from, leg.to].map((frame) => title(timeline.sequenceOf(frame)));
  return `${from} to ${to}, ${duration(leg.frames / timeline.fps)} synthetic`;
}
