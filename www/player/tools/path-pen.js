/** What the pointer does with a path on the stage: draws it, bends it, or paints on it. */

import { simplify } from './curve.js';
import { apart } from './marks.js';
import { EMPTY, MOST_POINTS } from './request.js';

/** Metres of the drawn line that simplifying may lose, and between two points of it while it is drawn. */
const SLACK = 0.07;
const SPACING = 0.04;
/** Metres from the actor within which a drawn path begins where it stands. */
const UNDER_FEET = 0.8;
/** CSS pixels around the path that belong to it. */
const REACH = 18;

export class PathPen {
  /** @param {import('./path.js').PathTool} tool */
  constructor(tool) {
    this.tool = tool;
    /** The line as far as it is drawn, or null. */
    this.drawn = null;
  }

  get stage() {
    return this.tool.box.core.view.stage;
  }

  /** @returns {import('../gestures.js').Grab | null} */
  grab(event) {
    const { tool } = this;
    if (tool.isDrawing) return this.draws(event);
    const { knot, off } = this.nearest(event);
    if (off > REACH) return null;
    return tool.brush === null ? this.bends(knot) : this.paints(knot);
  }

  /** The knot that is seen nearest to the pointer, and how many CSS pixels it is away. */
  nearest(event) {
    const { left, top } = this.stage.root.getBoundingClientRect();
    return this.tool.curve.nearest((point) => {
      const { x, y } = this.stage.seen(...point);
      return Math.hypot(x + left - event.clientX, y + top - event.clientY);
    });
  }

  draws(event) {
    const { tool, stage } = this;
    const { box } = tool;
    const start = stage.under(event, []);
    if (!start) return null;
    box.director?.tell('pause');
    const feet = box.director ? tool.part.middle().slice(0, 2) : start;
    this.drawn = apart(feet, start) < UNDER_FEET ? [feet] : [start];
    const stop = () => {
      const points = this.drawn;
      this.drawn = null;
      box.redraw();
      return points;
    };
    return {
      move: (now) => {
        const here = stage.under(now, []);
        if (!here || apart(here, this.drawn[this.drawn.length - 1]) < SPACING) return;
        this.drawn.push(here);
        box.redraw();
      },
      end: () => {
        const points = simplify(stop(), SLACK).slice(0, MOST_POINTS);
        tool.armed = false;
        if (points.length > 1) tool.set({ ...EMPTY.path, vertices: tool.path.vertices, exactness: tool.path.exactness, points });
        else tool.refresh();
      },
      drop: stop,
    };
  }

  bends(knot) {
    const { tool } = this;
    const index = Math.min(Math.floor(knot) + 1, tool.path.points.length);
    const merge = `bend ${performance.now()}`;
    tool.insertPoint(index, tool.curve.at(knot), merge);
    return {
      move: (event) => tool.handles.drag(index, event, merge),
      end: () => tool.box.history.settle(),
    };
  }

  /** Painting back and forth leaves what the pointer went over last: each time from what was before. */
  paints(start) {
    const { tool } = this;
    const merge = `paint ${performance.now()}`;
    const before = tool.path;
    return {
      move: (event) => tool.paint(start, this.nearest(event).knot, merge, before),
      end: () => tool.box.history.settle(),
    };
  }
}
