/** The score: a strip of poses for every sequence, the graph's arcs over them, the playhead, the flag and the walk. */

import { chooseArcs, drawGraph, drawWalk } from './arcs.js';
import { h, icon, sizedContext } from './dom.js';
import { title } from './format.js';
import { layoutScore } from './layout.js';
import { attachScorePointer } from './score-pointer.js';
import { Strip } from './strip.js';
import { ThumbnailShelf, coarseFirst } from './thumbnails.js';
import { Timeline } from './timeline.js';

const LONGEST_LABEL = 84;

/** CSS pixels above the score that belong to the stage's chips: the tooltip stays clear of them. */
const CHIPS = 34;

export class Score {
  /**
   * @param {object} act what the score asks of the player
   * @param {(frame: number) => void} act.preview -1 when there is none
   * @param {(frame: number, later: boolean) => void} act.go
   * @param {(frame: number) => void} act.seek
   * @param {(frame: number, width: number, height: number) => Promise<Uint8ClampedArray> | null} act.thumbnail
   * @param {(frame: number) => boolean} act.loaded
   */
  constructor(act) {
    this.act = act;
    this.timeline = null;
    this.layout = null;
    this.strips = [];
    this.arcs = new Float32Array(0);
    this.planned = null;
    this.walked = '';
    this.shelf = new ThumbnailShelf(act.thumbnail, (frame) => this.thumbnailReady(frame));
    /** Who else wants to know of a thumbnail. */
    this.onThumbnail = null;

    this.graph = h('canvas', { class: 'graph', 'aria-hidden': 'true' });
    this.walk = h('canvas', { class: 'walk', 'aria-hidden': 'true' });
    this.cursor = h('div', { class: 'cursor', hidden: true });
    this.grip = h('div', { class: 'grip' });
    this.playhead = h('div', { class: 'playhead', hidden: true }, this.grip);
    this.echo = h('div', { class: 'playhead echo', hidden: true });
    this.flag = h('div', { class: 'flag', hidden: true });
    this.sheet = h('div', { class: 'sheet' });
    this.hint = h('span', { id: 'score-hint', class: 'unseen' }, 'Arrow keys move over poses and sequences, Enter goes there, with shift after what is under way.');
    this.root = h('div', { class: 'strips', role: 'group', 'aria-label': 'Score: every pose of the capture', part: 'score' }, this.sheet, this.hint);
    attachScorePointer(this.sheet, this.grip, () => this.layout, act);
    this.placeholder();
  }

  /** Two empty rows until the first poses are there, so that nothing jumps when they come. */
  placeholder() {
    this.timeline = null;
    this.layout = null;
    this.strips = [];
    this.arcs = new Float32Array(0);
    this.planned = null;
    this.shelf.clear();
    this.sheet.replaceChildren(h('div', { class: 'blank' }), h('div', { class: 'blank' }));
  }

  setInfo(info) {
    this.timeline = new Timeline(info);
    this.strips = info.sequences.map((sequence, index) => new Strip(sequence, index));
    this.sheet.replaceChildren(
      this.graph,
      ...this.strips.flatMap(({ label, root }) => [label, root]),
      this.walk,
      this.cursor,
      this.echo,
      this.playhead,
      this.flag,
    );
    for (const mark of [this.cursor, this.playhead, this.echo, this.flag]) mark.hidden = true;
    this.relay();
  }

  /** @param {Float32Array} quads all arcs, from `Player.arcs` */
  setArcs(quads) {
    this.arcs = chooseArcs(this.timeline, quads);
    this.paintGraph();
  }

  /** Lays everything out anew; called when the size, the density or the theme changes. */
  relay() {
    if (!this.timeline || this.root.clientWidth === 0) return;
    this.readColours();
    const labels = this.labelWidths();
    // Twice, for a scroll bar that the first layout makes appear takes some of the width.
    for (let round = 0; round < 2; round += 1) {
      this.width = this.sheet.clientWidth;
      this.layout = layoutScore(this.timeline, { width: this.width, height: this.room(), labels });
      this.sheet.style.height = `${this.layout.height}px`;
      if (this.sheet.clientWidth === this.width) break;
    }
    this.strips.forEach((strip, index) => {
      strip.lay(this.layout.strips[index]);
      strip.paint(this.layout, this.shelf, this.colours.blank);
    });
    this.walkContext = sizedContext(this.walk, this.width, this.layout.height);
    this.paintGraph();
    this.walked = '';
    this.wantThumbnails();
    if (this.state) this.update(this.state);
    if (this.flagged !== undefined) this.setFlag(this.flagged, this.arrived);
  }

  /** The height that the style sheet allows the strips. */
  room() {
    const most = parseFloat(getComputedStyle(this.root).maxHeight);
    return Number.isFinite(most) ? most : this.root.clientHeight;
  }

  labelWidths() {
    const context = h('canvas').getContext('2d');
    const { fontSize, fontFamily, fontWeight } = getComputedStyle(this.strips[0].label);
    context.font = `${fontWeight} ${fontSize} ${fontFamily}`;
    return this.timeline.sequences.map((sequence) => Math.min(LONGEST_LABEL, Math.ceil(context.measureText(title(sequence)).width)));
  }

  readColours() {
    const style = getComputedStyle(this.root);
    const colour = (name) => style.getPropertyValue(name).trim();
    this.colours = {
      recorded: colour('--recorded'),
      synthetic: colour('--synthetic'),
      ink: colour('--ink'),
      arc: colour('--arc'),
      blank: colour('--blank'),
    };
  }

  paintGraph() {
    if (!this.layout) return;
    const context = sizedContext(this.graph, this.width, this.layout.height);
    drawGraph(context, this.layout, this.arcs, this.colours.arc);
  }

  /** Asks for the thumbnails that are shown and loaded; call it again as more frames arrive. */
  wantThumbnails() {
    if (!this.layout) return;
    const shown = this.strips.flatMap((_, index) => this.layout.shown(index)).filter((frame) => this.act.loaded(frame));
    this.shelf.want(coarseFirst(shown));
  }

  thumbnailReady(frame) {
    this.onThumbnail?.(frame);
    if (!this.layout) return;
    this.strips[this.timeline.indexOf(frame)].paint(this.layout, this.shelf, this.colours.blank);
  }

  /** Moves the playhead and the walk to the player's state. */
  update(state) {
    this.state = state;
    if (!this.layout) return;
    const { transition } = state;
    this.mark(this.playhead, transition ? transition.destination : state.frame, transition ? transition.lambda : 1);
    this.mark(this.echo, transition ? transition.source : -1, transition ? 1 - transition.lambda : 0);
    this.paintWalk();
  }

  mark(element, frame, weight) {
    element.hidden = frame < 0;
    if (frame < 0) return;
    element.style.transform = `translate(${this.layout.xOf(frame)}px, ${this.layout.stripOf(frame).y}px)`;
    element.style.opacity = String(0.35 + 0.65 * weight);
  }

  /** @param {object | null} plan a walk that is only being looked at */
  setPlan(plan) {
    this.planned = plan;
    this.paintWalk();
  }

  paintWalk() {
    if (!this.layout) return;
    const state = this.state ?? { walk: null };
    const key = JSON.stringify([state.walk, state.leg, state.leg_progress, this.planned?.legs]);
    if (key === this.walked) return;
    this.walked = key;
    this.walkContext.clearRect(0, 0, this.width, this.layout.height);
    if (this.planned) {
      const { ink } = this.colours;
      drawWalk(this.walkContext, this.layout, this.planned.legs, { recorded: ink, synthetic: ink }, null);
    }
    if (state.walk) drawWalk(this.walkContext, this.layout, state.walk, this.colours, { leg: state.leg, progress: state.leg_progress });
  }

  /** Shows which pose the pointer or the arrow keys are on; -1 for none. */
  setCursor(frame) {
    this.cursor.hidden = frame < 0 || !this.layout;
    if (this.cursor.hidden) return;
    const strip = this.layout.stripOf(frame);
    this.cursor.style.transform = `translate(${this.layout.xOf(frame)}px, ${strip.y}px)`;
  }

  /** Describes a pose to screen readers, and focuses its strip if asked to. */
  describe(frame, text, focus) {
    const index = this.timeline.indexOf(frame);
    this.strips[index].describe(frame, text);
    if (!focus) return;
    this.strips.forEach(({ root }, at) => (root.tabIndex = at === index ? 0 : -1));
    this.strips[index].root.focus({ preventScroll: true });
    this.strips[index].root.scrollIntoView({ block: 'nearest' });
  }

  /** The flag on the pose the actor goes to; a tick once it has arrived. */
  setFlag(frame, arrived = false) {
    this.flagged = frame;
    this.arrived = arrived;
    this.flag.hidden = frame === null || !this.layout;
    if (this.flag.hidden) return;
    this.flag.toggleAttribute('data-arrived', arrived);
    this.flag.replaceChildren(icon(arrived ? 'tick' : 'flag'));
    this.flag.style.transform = `translate(${this.layout.xOf(frame)}px, ${this.layout.stripOf(frame).y}px)`;
  }

  /** Where the tooltip of a pose points: over its place, above all strips, so that it hides none. */
  screenPlace(frame) {
    const { left } = this.sheet.getBoundingClientRect();
    return { x: left + this.layout.xOf(frame), y: this.root.getBoundingClientRect().top - CHIPS };
  }
}
