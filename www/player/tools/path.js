/** Draw a path on the ground, drag its points, paint behaviours on it; the actor walks as near to it as its motion can. */

import { h } from '../dom.js';
import { count, duration } from '../format.js';
import { behavioursOf } from '../targets.js';
import { Curve, simplify } from './curve.js';
import { Choice, GoRow, button, centimetres } from './dock.js';
import { Handles } from './handles.js';
import { apart } from './marks.js';
import { PathStrip } from './path-strip.js';
import { EMPTY } from './request.js';
import { paint, pointDeleted, pointInserted } from './stretches.js';

/** Metres of the drawn line that simplifying may lose, and between two points of it while it is drawn. */
const SLACK = 0.07;
const SPACING = 0.04;
/** Metres from the actor within which a drawn path begins under its feet. */
const UNDER_FEET = 0.8;
/** CSS pixels around the path that belong to it. */
const REACH = 18;
/** Points that a path may have. */
export const MOST_POINTS = 200;
/** Colours that tell behaviours apart, beside their names. */
export const HUES = 5;

/** Where the actor should be at each sample of its walk: as far along the curve, after the straight way to its beginning. */
function wantedPoints(curve, { length, samples }) {
  const approach = Math.max(0, length - curve.length);
  const [, x, , z] = samples[0] ?? [0, ...curve.line[0]];
  return samples.map(([travelled]) => {
    if (travelled >= approach) return curve.at(curve.knotAt(travelled - approach));
    const share = travelled / approach;
    return [x + (curve.line[0][0] - x) * share, z + (curve.line[0][1] - z) * share];
  });
}

/** Metres along the curve, and metres that the walk is off there. */
function deviations(curve, path) {
  const approach = Math.max(0, path.length - curve.length);
  return wantedPoints(curve, path).map((point, at) => {
    const [travelled, x, , z] = path.samples[at];
    return [Math.min(curve.length, Math.max(0, travelled - approach)), apart(point, [x, z])];
  });
}

export class PathTool {
  static id = 'path';
  static title = 'Path';
  static about = 'Draw a path on the ground: the actor follows it';

  id = PathTool.id;
  hint = 'Draw a path on the ground.';
  onGround = true;

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    this.drawn = null;
    this.armed = false;
    /** A behaviour, '' to rub out, or null to shape the path. */
    this.brush = null;
    this.behaviours = [];
    this.choice = new Choice('Brush', (value) => this.takeBrush(value));
    this.anew = button('Draw anew', 'Draw another path in its place', () => this.arm());
    this.longer = button('Add point', 'A point one metre on', () => this.extend());
    this.strip = new PathStrip({ paint: (from, to, merge) => this.paint(from, to, merge), brush: () => this.brush });
    this.row = new GoRow(() => box.go());
    this.dock = h(
      'div',
      { class: 'tool-dock path-dock', role: 'group', 'aria-label': 'Path' },
      h('div', { class: 'row' }, this.choice.root, h('span', { class: 'space' }), this.anew, this.longer),
      this.strip.root,
      this.row.root,
    );
    this.labels = h('div', { class: 'ground-labels', 'aria-hidden': 'true' });
    this.handles = new Handles(box, {
      move: (index, point, merge) => this.movePoint(index, point, merge),
      remove: (index) => this.removePoint(index),
      insert: (index) => this.insertPoint(index + 1, this.curve.at(Math.min(index + 0.5, this.curve.count - 1))),
      describe: (index, [x, z]) => `Point ${index + 1} of ${this.path.points.length}, ${x.toFixed(1)} by ${z.toFixed(1)} metres`,
    });
  }

  get path() {
    return this.box.document.path;
  }

  points() {
    return this.path.points;
  }

  get isDrawing() {
    return this.armed || this.path.points.length < 2;
  }

  opened({ info }) {
    this.behaviours = behavioursOf(info);
    const named = this.behaviours.map((value) => ({ value, text: value.replaceAll('_', ' '), mark: this.hue(value), title: `Paint: ${value} on this stretch` }));
    this.choice.set([{ value: 'shape', text: 'Shape', title: 'Drag points; click the path for a new one' }, ...named, { value: 'none', text: 'Any', title: 'Rub out what was painted' }], 'shape');
  }

  hue(behaviour) {
    return Math.max(0, this.behaviours.indexOf(behaviour)) % HUES;
  }

  enter() {
    this.box.core.view.handles.append(this.labels);
  }

  leave() {
    this.handles.hide();
    this.box.core.view.handles.removeAttribute('data-brush');
    this.labels.remove();
    this.drawn = null;
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
    if (points.length < 2) this.set(EMPTY.path);
    else this.set({ ...this.path, points, stretches: pointDeleted(this.path.stretches, index, points.length) });
  }

  /** One metre on from the end: a path can be made with the keyboard alone. */
  extend() {
    const { points } = this.path;
    const { x, z } = this.box.director?.state ?? { x: 0, z: 0 };
    const first = points.length < 2;
    const [end, before] = first ? [[x, z], null] : [points[points.length - 1], points[points.length - 2]];
    const yaw = this.box.core.view.stage.stage?.camera()[0] ?? 0;
    const far = before ? apart(end, before) || 1 : 1;
    const way = before ? [(end[0] - before[0]) / far, (end[1] - before[1]) / far] : [Math.cos(yaw), -Math.sin(yaw)];
    const next = [end[0] + way[0], end[1] + way[1]];
    if (first) this.set({ ...EMPTY.path, points: [end, next] });
    else this.insertPoint(points.length, next);
    this.handles.focus(this.path.points.length - 1);
  }

  paint(from, to, merge) {
    if (this.brush === null || !this.curve) return;
    this.set({ ...this.path, stretches: paint(this.path.stretches, Math.min(from, to), Math.max(from, to), this.brush || null) }, merge);
  }

  // ---- the pointer ----------------------------------------------------------------------------------------------

  grab(x, y) {
    const { stage } = this.box.core.view;
    const start = stage.groundAt(x, y);
    if (!start) return null;
    if (this.isDrawing) return this.draws(start);
    const { knot, off } = this.curve.nearest(start);
    const [here, beside] = [stage.seen(...start), stage.seen(...this.curve.at(knot))];
    if (off > 0.05 && Math.hypot(here.x - beside.x, here.y - beside.y) > REACH) return null;
    return this.brush === null ? this.bends(knot) : this.paints(knot);
  }

  draws(start) {
    const { core, director } = this.box;
    director?.tell('pause');
    const feet = director ? [director.state.x, director.state.z] : start;
    this.drawn = apart(feet, start) < UNDER_FEET ? [feet] : [start];
    return {
      move: (x, y) => {
        const here = core.view.stage.groundAt(x, y);
        if (!here || apart(here, this.drawn[this.drawn.length - 1]) < SPACING) return;
        this.drawn.push(here);
        this.box.redraw();
      },
      end: () => {
        const points = simplify(this.drawn, SLACK).slice(0, MOST_POINTS);
        this.drawn = null;
        this.armed = false;
        if (points.length > 1) this.set({ ...EMPTY.path, points });
        else this.box.redraw();
      },
      drop: () => {
        this.drawn = null;
        this.box.redraw();
      },
    };
  }

  bends(knot) {
    const index = Math.floor(knot) + 1;
    const merge = `bend ${performance.now()}`;
    this.insertPoint(Math.min(index, this.path.points.length), this.curve.at(knot), merge);
    return {
      move: (x, y) => {
        const ground = this.box.core.view.stage.groundAt(x, y);
        if (ground) this.movePoint(index, ground, merge);
      },
      end: () => this.box.history.settle(),
    };
  }

  paints(start) {
    const merge = `paint ${performance.now()}`;
    const before = this.path;
    const to = (knot) => {
      // Painting back and forth leaves what the pointer went over last: each time from what was before.
      const [a, b] = [Math.min(start, knot), Math.max(start, knot)];
      this.set({ ...before, stretches: paint(before.stretches, a, b, this.brush || null) }, merge);
    };
    return {
      move: (x, y) => {
        const ground = this.box.core.view.stage.groundAt(x, y);
        if (ground) to(this.curve.nearest(ground).knot);
      },
      end: () => this.box.history.settle(),
    };
  }

  // ---- what is shown --------------------------------------------------------------------------------------------

  refresh() {
    const { points, stretches, shape } = this.path;
    this.curve = points.length > 1 ? new Curve(points, shape) : null;
    this.handles.show(points);
    this.labels.replaceChildren(...stretches.map(({ behaviour }) => h('span', { class: `ground-label b${this.hue(behaviour)}` }, behaviour.replaceAll('_', ' '))));
    this.box.core.view.handles.toggleAttribute('data-brush', this.brush !== null || this.armed);
    this.box.core.view.stage.root.toggleAttribute('data-drawing', this.isDrawing || this.brush !== null);
    this.anew.disabled = !this.curve;
    this.strip.show(this.curve, stretches, (behaviour) => this.hue(behaviour));
    this.answered(this.box.answer);
  }

  answered(answer) {
    this.strip.answered(this.curve && answer?.path ? deviations(this.curve, answer.path) : []);
    if (!this.curve) this.row.show(this.hint, false);
    else this.row.tell(this.box.trouble, answer, answer ? this.sentence(answer) : `${this.curve.length.toFixed(1)} m; looking for a walk`);
  }

  sentence({ path, seconds, transitions }) {
    const off = path ? ` · off by ${centimetres(path.mean)} on average, ${centimetres(path.max)} at most` : '';
    return `${this.curve.length.toFixed(1)} m in ${duration(seconds)}, through ${count(transitions, 'transition')}${off}`;
  }

  place(seen) {
    this.handles.place(seen);
    this.path.stretches.forEach(({ from, to }, index) => {
      const label = this.labels.children[index];
      if (!label || !this.curve) return;
      const { x, y, visible } = seen(...this.curve.at((from + to) / 2));
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      label.style.visibility = visible ? '' : 'hidden';
    });
  }

  draw(marks, colour) {
    if (this.drawn) marks.ribbon(this.drawn, 0.04, colour('accent', 0.95));
    if (!this.curve || this.drawn) return;
    const { answer } = this.box;
    if (answer?.path) {
      const [walked, wanted] = [answer.path.samples.map(([, x, , z]) => [x, z]), wantedPoints(this.curve, answer.path)];
      const some = walked.map((_, at) => at).filter((at) => at % 4 === 0 || at === walked.length - 1);
      marks.between(some.map((at) => walked[at]), some.map((at) => wanted[at]), colour('line', 0.75));
    }
    marks.ribbon(this.curve.line, 0.045, colour('accent', 0.9));
    for (const { from, to, behaviour } of this.path.stretches) marks.ribbon(this.curve.stretch(from, to), 0.11, colour(`behaviour-${this.hue(behaviour)}`, 0.75));
    this.box.drawTrack(marks, colour);
    const end = this.curve.line;
    const [a, b] = [end[end.length - 2], end[end.length - 1]];
    marks.arrow(b, Math.atan2(b[0] - a[0], b[1] - a[1]), 0.16, colour('accent'));
  }
}
