/** Looking at a pose before going there: ghost on the stage, walk in the score, a sentence beside the pointer. */

import { h } from './dom.js';
import { poseName, walkSentence } from './format.js';

/** While the actor moves, what is looked at is planned anew this often, in milliseconds. */
const PLAN_ANEW = 250;

export class Tooltip {
  constructor() {
    this.pose = h('strong');
    this.way = h('span');
    this.root = h('div', { class: 'tooltip', 'aria-hidden': 'true', hidden: true }, this.pose, this.way);
  }

  /** @param {{x: number, y: number}} place on the screen; the tooltip stands above it, inside `frame` */
  show(place, frame, pose, way) {
    this.pose.textContent = pose;
    this.way.textContent = way;
    this.root.hidden = false;
    const width = this.root.offsetWidth;
    const x = Math.max(8, Math.min(frame.width - width - 8, place.x - frame.left - width / 2));
    const y = Math.max(8, place.y - frame.top - this.root.offsetHeight - 12);
    this.root.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
  }

  hide() {
    this.root.hidden = true;
  }
}

export class Preview {
  /**
   * @param {object} parts
   * @param {() => import('./director.js').Director | null} parts.director
   * @param {import('./score.js').Score} parts.score
   * @param {HTMLElement} parts.host the tooltip stays inside it
   * @param {() => void} parts.request asks for a frame, in which `update` is called
   */
  constructor({ director, score, host, request }) {
    this.director = director;
    this.score = score;
    this.host = host;
    this.request = request;
    this.tooltip = new Tooltip();
    this.frame = -1;
    this.stale = false;
    this.plannedAt = 0;
    this.place = null;
    this.focus = false;
    /** The walk to the pose that is looked at, or null. */
    this.plan = null;
  }

  /**
   * Looks at a pose; -1 looks away.
   * @param {{x: number, y: number} | null} place on the screen, for the tooltip; null: above the score
   * @param {boolean} focus whether the keyboard asked
   */
  at(frame, place = null, focus = false) {
    if (frame === this.frame && !focus && !place) return;
    this.stale ||= frame !== this.frame || focus;
    this.frame = frame;
    this.place = place;
    this.focus = focus;
    this.request();
  }

  /** Does the work, at most once a display frame. @returns whether the ghosts are to be placed anew */
  update(now, moving) {
    const due = moving && this.frame >= 0 && now - this.plannedAt > PLAN_ANEW;
    if (!this.stale && !due) {
      if (this.frame >= 0 && this.place) this.showTooltip();
      return false;
    }
    this.stale = false;
    this.plannedAt = now;
    this.score.setCursor(this.frame);
    if (this.frame < 0) {
      this.plan = null;
      this.score.setPlan(null);
      this.tooltip.hide();
      return true;
    }
    this.think();
    return true;
  }

  think() {
    const director = this.director();
    this.plan = null;
    this.way = '';
    try {
      this.plan = director.plan(this.frame);
      this.way = walkSentence(this.plan);
    } catch (error) {
      if (error?.kind === 'not-loaded') this.way = 'not loaded yet';
      else if (error?.kind === 'unreachable') this.way = 'cannot be reached from here';
      else throw error;
    }
    this.pose = poseName(director.timeline.sequenceOf(this.frame), this.frame, director.timeline.fps);
    this.score.setPlan(this.plan);
    this.score.describe(this.frame, `${this.pose}, ${this.way}`, this.focus);
    this.focus = false;
    this.showTooltip();
  }

  showTooltip() {
    const place = this.place ?? this.score.screenPlace(this.frame);
    this.tooltip.show(place, this.host.getBoundingClientRect(), this.pose, this.way);
  }
}
