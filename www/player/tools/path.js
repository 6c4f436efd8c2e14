/** Draw a path on the ground, drag its points, paint behaviours on it; the actor walks as near to it as its motion can. */

import { button, h } from '../dom.js';
import { count, duration, words } from '../format.js';
import { Air } from './air.js';
import { Curve, mix } from './curve.js';
import { deviation, gaps } from './deviation.js';
import { Choice, NumberField, centimetres } from './dock.js';
import { Handles, putAt } from './handles.js';
import { apart } from './marks.js';
import { PathPen } from './path-pen.js';
import { Part } from './part.js';
import { PathStrip } from './path-strip.js';
import { EMPTY, MOST_POINTS } from './request.js';
import { paint, pointDeleted, pointInserted } from './stretches.js';
import { Tool } from './tool.js';

/** Colours that tell behaviours apart, beside their names. */
const HUES = 5;
/** Metres that a point may be from the ground. */
const HIGHEST = 100;

export class PathTool extends Tool {
  static id = 'path';
  static title = 'Path';
  static about = 'Draw a path on the ground: the actor follows it';
  static hint = 'Draw a path on the ground.';

  onGround = true;

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    super(box);
    this.pen = new PathPen(this);
    this.armed = false;
    /** A behaviour, '' to rub out, or null to shape the path. */
    this.brush = null;
    this.behaviours = [];
    /** The point that had the focus last: its height can be typed. */
    this.chosen = 0;
    this.part = new Part(this);
    this.choice = new Choice('Brush', (value) => this.takeBrush(value));
    this.anew = button('Draw anew', 'Draw another path in its place', () => this.arm());
    this.longer = button('Add point', 'A point one metre on', () => this.extend());
    this.space = button('3D', 'Gives the points heights: what follows the path does so through the air', () => this.toggleHeights(), { 'aria-pressed': 'false' });
    this.height = new NumberField('height', 'm', 'Of the point chosen last; or Alt and drag it, or Page Up and Down', { min: -HIGHEST, max: HIGHEST, step: 0.05 }, (value) => value !== null && this.setHeight(this.chosen, value));
    this.exact = h('input', { type: 'range', min: 0, max: 1, step: 0.05, value: 1, 'aria-label': 'Exactness' });
    this.exact.addEventListener('input', () => this.set({ ...this.path, exactness: Number(this.exact.value) }, 'exactness'));
    this.exact.addEventListener('change', () => box.history.settle());
    const exact = h('label', { class: 'exact', title: 'How far the walk is bent onto the path: not at all, or as far as its steps can be' }, h('span', {}, 'exact'), this.exact);
    this.strip = new PathStrip({ paint: (from, to, merge) => this.paint(from, to, merge), brush: () => this.brush });
    this.build(h('div', { class: 'row' }, this.choice.root, h('span', { class: 'space' }), this.height.root, exact, this.part.button, this.space, this.anew, this.longer), this.strip.root, this.row.root);
    this.labels = h('div', { class: 'ground-labels', 'aria-hidden': 'true' });
    this.air = new Air();
    this.handles = new Handles(box, {
      move: (index, point, merge) => this.movePoint(index, point, merge),
      remove: (index) => this.removePoint(index),
      insert: (index) => this.insertPoint(index + 1, this.curve.at(Math.min(index + 0.5, this.curve.count - 1))),
      lift: (index, by, merge) => this.lift(index, by, merge),
      chosen: (index) => this.choosePoint(index),
      describe: (index, [x, z, ...height]) => `Point ${index + 1} of ${this.path.points.length}, ${x.toFixed(1)} by ${z.toFixed(1)} metres${height.map((up) => `, ${(up - this.floor).toFixed(2)} high`).join('')}`,
    });
  }

  grab(event) {
    return this.part.cross ? this.part.grab(event) : this.pen.grab(event);
  }

  key(event) {
    return this.part.key(event);
  }

  get hint() {
    return this.part.cross ? 'Click the part of the body that shall follow the path, or move the cross with the arrows.' : PathTool.hint;
  }

  get path() {
    return this.box.document.path;
  }

  points() {
    return this.path.points;
  }

  /** Whether its points have heights. */
  get isLifted() {
    return this.path.points[0]?.length > 2;
  }

  get floor() {
    return this.box.core.view.stage.floor;
  }

  get busy() {
    return `${this.curve.length.toFixed(1)} m; looking for a walk`;
  }

  get isDrawing() {
    return this.armed || this.path.points.length < 2;
  }

  opened({ info }) {
    this.behaviours = info.behaviours;
    const named = this.behaviours.map((value) => ({ value, text: words(value), mark: this.hue(value), title: `Paint: ${words(value)} on this stretch` }));
    this.choice.set([{ value: 'shape', text: 'Shape', title: 'Drag points; click the path for a new one' }, ...named, { value: 'none', text: 'Any', title: 'Rub out what was painted' }], 'shape');
  }

  hue(behaviour) {
    return Math.max(0, this.behaviours.indexOf(behaviour)) % HUES;
  }

  enter() {
    this.box.core.view.handles.prepend(this.air.root, this.labels, this.part.mark);
  }

  leave() {
    this.handles.hide();
    this.part.cross = null;
    this.box.core.view.handles.removeAttribute('data-brush');
    this.box.core.view.stage.root.removeAttribute('data-drawing');
    this.labels.remove();
    this.part.mark.remove();
    this.air.root.remove();
  }

  takeBrush(value) {
    this.brush = value === 'shape' ? null : value === 'none' ? '' : value;
    this.armed = false;
    this.choice.choose(value);
    this.refresh();
  }

  arm() {
    this.armed = true;
    this.takeShape();
    this.refresh();
  }

  takeShape() {
    this.brush = null;
    this.choice.choose('shape');
  }

  // ---- changing the path ----------------------------------------------------------------------------------------

  set(path, merge = null) {
    this.box.edit({ path }, merge);
  }

  movePoint(index, point, merge) {
    const points = this.path.points.map((one, at) => (at === index ? point : one));
    this.set({ ...this.path, points }, merge);
  }

  insertPoint(index, point, merge = null) {
    if (this.path.points.length >= MOST_POINTS) return;
    const points = this.path.points.toSpliced(index, 0, point);
    const last = index === this.path.points.length;
    this.set({ ...this.path, points, stretches: last ? this.path.stretches : pointInserted(this.path.stretches, index) }, merge);
  }

  removePoint(index) {
    const points = this.path.points.toSpliced(index, 1);
    if (points.length < 2) this.set({ ...EMPTY.path, vertices: this.path.vertices, exactness: this.path.exactness });
    else this.set({ ...this.path, points, stretches: pointDeleted(this.path.stretches, index, points.length) });
  }

  /** One metre on from the end: a path can be made with the keyboard alone. */
  extend() {
    const { points, vertices, exactness } = this.path;
    const [x, z] = this.box.director ? this.part.middle() : [0, 0];
    if (points.length < 2) {
      const yaw = this.box.core.view.stage.stage?.camera()[0] ?? 0;
      this.set({ ...EMPTY.path, vertices, exactness, points: [[x, z], [x + Math.cos(yaw), z - Math.sin(yaw)]] });
    } else {
      const [before, end] = points.slice(-2);
      this.insertPoint(points.length, mix(before, end, 1 + 1 / (apart(end, before) || 1)));
    }
    this.handles.focus(this.path.points.length - 1);
  }

  paint(from, to, merge, path = this.path) {
    if (this.brush === null || !this.curve) return;
    this.set({ ...path, stretches: paint(path.stretches, Math.min(from, to), Math.max(from, to), this.brush || null) }, merge);
  }

  // ---- heights --------------------------------------------------------------------------------------------------

  choosePoint(index) {
    this.chosen = index;
    this.showHeight();
    this.handles.show(this.path.points, (at) => (at === index ? 'chosen' : ''));
  }

  /** All points get the height that what follows the path has now; or lose theirs. */
  toggleHeights() {
    const points = this.isLifted ? this.path.points.map(([x, z]) => [x, z]) : this.lifted();
    this.set({ ...this.path, points });
  }

  lifted() {
    if (this.isLifted) return this.path.points;
    const [, , height] = this.part.middle();
    return this.path.points.map(([x, z]) => [x, z, height]);
  }

  lift(index, by, merge) {
    const points = this.lifted();
    this.setHeight(index, points[index][2] + by - this.floor, merge);
  }

  /** @param {number} height metres above the ground */
  setHeight(index, height, merge = null) {
    const up = this.floor + Math.max(-HIGHEST, Math.min(HIGHEST, height));
    const points = this.lifted().map(([x, z, before], at) => [x, z, at === index ? up : before]);
    this.set({ ...this.path, points }, merge);
  }

  // ---- what is shown --------------------------------------------------------------------------------------------

  refresh() {
    const { points, stretches, shape } = this.path;
    const { stage, handles } = this.box.core.view;
    this.curve = points.length > 1 ? new Curve(points, shape) : null;
    this.chosen = Math.max(0, Math.min(this.chosen, points.length - 1));
    this.handles.show(points, (index) => (index === this.chosen && this.isLifted ? 'chosen' : ''));
    this.labels.replaceChildren(...stretches.map(({ behaviour }) => h('span', { class: `ground-label b${this.hue(behaviour)}` }, words(behaviour))));
    handles.toggleAttribute('data-brush', this.brush !== null || this.armed);
    stage.root.toggleAttribute('data-drawing', this.isDrawing || this.brush !== null || this.part.cross !== null);
    for (const one of [this.anew, this.space]) one.disabled = !this.curve;
    this.showHeight();
    this.exact.value = String(this.path.exactness ?? 1);
    this.part.show();
    this.strip.show(this.curve, stretches, (behaviour) => this.hue(behaviour));
    this.answered(this.box.answer);
  }

  showHeight() {
    this.space.setAttribute('aria-pressed', String(this.isLifted));
    this.height.root.hidden = !this.isLifted;
    if (this.isLifted) this.height.show((this.path.points[this.chosen][2] - this.floor).toFixed(2));
  }

  answered(answer) {
    this.deviation = this.curve && answer?.path ? deviation(this.curve, answer.path) : [];
    this.strip.answered(gaps(this.deviation));
    super.answered(answer);
  }

  sentence({ path, seconds, transitions, notes }) {
    const off = path ? ` · off by ${centimetres(path.mean)} on average, ${centimetres(path.max)} at most` : '';
    const note = notes.length > 0 ? ` · ${notes[0]}` : '';
    return `${this.curve.length.toFixed(1)} m in ${duration(seconds)}, through ${count(transitions, 'transition')}${off}${note}`;
  }

  place(seen) {
    this.part.place(seen);
    this.handles.place(seen);
    this.path.stretches.forEach(({ from, to }, index) => {
      const label = this.labels.children[index];
      if (label && this.curve) putAt(label, seen(...this.curve.at((from + to) / 2)));
    });
    const { points } = this.path;
    const lifted = this.isLifted && this.curve;
    this.air.place({
      posts: lifted ? points.map(([x, z, up]) => [[x, z, this.floor], [x, z, up]]) : [],
      taken: lifted ? [this.deviation.map(({ walked }) => walked)] : [],
      wanted: lifted ? [this.curve.line] : [],
    }, seen);
  }

  draw(marks, colour) {
    const { drawn } = this.pen;
    if (drawn) marks.ribbon(drawn, 0.04, colour('accent', 0.95));
    if (!this.curve || drawn) return;
    const some = this.deviation.filter((_, at) => at % 4 === 0 || at === this.deviation.length - 1);
    marks.between(some.map(({ walked }) => walked), some.map(({ wanted }) => wanted), colour('line', 0.75));
    // Of a path in the air, this is the shadow.
    const { line } = this.curve;
    marks.ribbon(line, 0.045, colour('accent', this.isLifted ? 0.35 : 0.9));
    for (const { from, to, behaviour } of this.path.stretches) marks.ribbon(this.curve.stretch(from, to), 0.11, colour(`behaviour-${this.hue(behaviour)}`, 0.75));
    this.drawTrack(marks, colour);
    const [a, b] = line.slice(-2);
    marks.arrow(b, Math.atan2(b[0] - a[0], b[1] - a[1]), 0.16, colour('accent'));
  }
}
