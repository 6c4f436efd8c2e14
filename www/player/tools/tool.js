/** What all tools have in common: a dock under the stage, and the line in it that says what would happen. */

import { h } from '../dom.js';
import { GoRow } from './dock.js';

/**
 * Each has the statics `id`, `title` and `about`, and `hint`, which is said while nothing is asked with it. What it may
 * have besides: `opened(director)`, `enter()`, `leave()`, `refresh()`, `place(seen)`, `draw(marks, colour)`, `grab(x, y)` and
 * `key(event)`, which the toolbox calls.
 */
export class Tool {
  /** Whether it is used on the ground: from higher up, the actor standing still. */
  onGround = false;
  /** Whether the score stays to be seen above its dock. */
  withScore = false;

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box, go = 'Go') {
    this.box = box;
    this.row = new GoRow(() => box.go(), go);
  }

  get id() {
    return this.constructor.id;
  }

  /** What is said while the search has found nothing yet. */
  get busy() {
    return 'looking for a walk';
  }

  get hint() {
    return this.constructor.hint;
  }

  /** @param {...Node} rows of the dock */
  build(...rows) {
    const { id, title } = this.constructor;
    this.dock = h('div', { class: `tool-dock ${id}-dock`, role: 'group', 'aria-label': title }, ...rows);
  }

  /** The walk on the ground: recorded stretches solid, synthetic ones in dashes. */
  drawTrack(marks, colour) {
    for (const { points, synthetic } of this.box.answer?.track ?? []) {
      marks.ribbon(points, 0.03, colour(synthetic ? 'synthetic' : 'recorded', 0.9), synthetic ? [0.07, 0.05] : null);
    }
  }

  /** Hears of every answer, and of null when the search begins. */
  answered(answer) {
    const { request, trouble } = this.box;
    if (!request) this.row.show(this.hint, false, false);
    else this.row.show(trouble ?? (answer ? this.sentence(answer) : this.busy), !trouble, !trouble && !answer);
  }
}
