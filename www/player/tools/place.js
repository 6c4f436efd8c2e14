/** Click the ground, and the actor goes there; drag, and it arrives facing that way. It may end in a pose that is chosen. */

import { button, h } from '../dom.js';
import { count, duration, poseName, title } from '../format.js';
import { NumberField, centimetres } from './dock.js';
import { Handles } from './handles.js';
import { apart } from './marks.js';
import { frameOf } from './request.js';
import { Tool } from './tool.js';

const DEGREE = Math.PI / 180;
/** Metres from the place to the handle that turns it. */
const ARM = 0.6;

export class PlaceTool extends Tool {
  static id = 'place';
  static title = 'Place';
  static about = 'Click the ground: the actor goes there; drag to say which way it faces';
  static hint = 'Click the ground; drag to say which way to face.';

  onGround = true;

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    super(box);
    const field = (part, name, unit, attributes) =>
      new NumberField(name, unit, null, attributes, (value) => this.set({ [part]: part === 'heading' && value !== null ? value * DEGREE : value }));
    this.fields = [field('x', 'x', 'm', { step: 0.1 }), field('z', 'z', 'm', { step: 0.1 }), field('heading', 'facing', '°', { step: 5, placeholder: 'any' })];
    this.any = button('Any', 'Arrive facing any way', () => this.set({ heading: null }));
    this.sequence = h('select', { 'aria-label': 'Pose to end in' });
    this.sequence.addEventListener('change', () => this.endIn(this.sequence.value, 0));
    this.time = new NumberField('at', 's', 'When in the recording the pose is', { min: 0, step: 0.1 }, (value) => this.endIn(this.sequence.value, value ?? 0));
    const pose = h('label', { class: 'field', title: 'The walk ends in this pose' }, h('span', {}, 'in'), this.sequence);
    this.build(h('div', { class: 'row' }, ...this.fields.map(({ root }) => root), this.any, h('span', { class: 'space' }), pose, this.time.root), this.row.root);
    this.handles = new Handles(box, {
      move: (index, point, merge) => this.moved(index, point, merge),
      remove: (index) => this.removed(index),
      describe: (index, [x, z]) => (index === 0 ? `Place, ${x.toFixed(1)} by ${z.toFixed(1)} metres` : 'Facing'),
    });
  }

  get busy() {
    return 'looking for a way';
  }

  opened({ timeline }) {
    this.timeline = timeline;
    const option = (sequence) => h('option', { value: sequence.name }, title(sequence));
    this.sequence.replaceChildren(h('option', { value: '' }, 'any pose'), ...timeline.sequences.map(option));
  }

  get goal() {
    return this.box.document.place;
  }

  points() {
    return this.goal ? [[this.goal.x, this.goal.z]] : [];
  }

  leave() {
    this.handles.hide();
  }

  /** @param {{x?: number, z?: number, heading?: number | null}} part */
  set(part, merge = null) {
    const { x, z, heading, ...rest } = { ...this.goal, ...part };
    this.box.edit({ place: { ...rest, x: x ?? 0, z: z ?? 0, heading: heading ?? null } }, merge);
  }

  /** The pose that walks end in, of a sequence of this name; any where it has none. */
  endIn(name, time) {
    this.set({ pose: name ? { sequence: name, time } : undefined });
  }

  /** The sequence and the time in it of the pose to end in; null where there is none. */
  get ends() {
    const { timeline, goal } = this;
    const pose = goal?.pose;
    if (pose === undefined || pose === null || !timeline) return null;
    const frame = frameOf(pose, timeline);
    const sequence = timeline.sequences.find(({ first, count: frames }) => frame >= first && frame < first + frames);
    return sequence ? { name: sequence.name, time: (frame - sequence.first) / timeline.fps } : null;
  }

  moved(index, [x, z], merge) {
    if (index === 0) this.set({ x, z }, merge);
    else this.set({ heading: Math.atan2(x - this.goal.x, z - this.goal.z) }, merge);
  }

  removed(index) {
    if (index === 0) this.box.edit({ place: null });
    else this.set({ heading: null });
  }

  grab(event) {
    const { stage } = this.box.core.view;
    const start = stage.under(event, []);
    if (!start) return null;
    const merge = `place ${performance.now()}`;
    this.set({ x: start[0], z: start[1], heading: null }, merge);
    return {
      move: (now) => {
        const here = stage.under(now, []);
        if (here && apart(start, here) > ARM / 3) this.set({ heading: Math.atan2(here[0] - start[0], here[1] - start[1]) }, merge);
      },
      end: () => this.box.go(),
      drop: () => this.box.undo(-1),
    };
  }

  refresh() {
    const place = this.goal;
    const points = place ? [[place.x, place.z], ...(place.heading === null ? [] : [this.arm(place, ARM)])] : [];
    this.handles.show(points, (index) => (index === 0 ? 'spot' : 'turn'));
    const values = place ? [place.x.toFixed(2), place.z.toFixed(2), place.heading === null ? '' : Math.round(place.heading / DEGREE)] : ['', '', ''];
    this.fields.forEach((field, index) => field.show(values[index]));
    this.any.disabled = !place || place.heading === null;
    const { ends } = this;
    this.sequence.value = ends?.name ?? '';
    this.time.root.hidden = !ends;
    if (ends) this.time.show(String(Math.round(ends.time * 100) / 100));
    this.answered(this.box.answer);
  }

  arm({ x, z, heading }, far) {
    return [x + Math.sin(heading) * far, z + Math.cos(heading) * far];
  }

  sentence({ seconds, transitions, place }) {
    const { distance = 0, turn = null, frame } = place ?? {};
    const facing = turn === null ? '' : `, ${Math.round(Math.abs(turn) / DEGREE)}° off the way it should face`;
    const sequence = frame === undefined ? null : this.timeline.sequenceOf(frame);
    const pose = sequence ? `, in ${poseName(sequence, frame, this.timeline.fps)}` : '';
    return `there in ${duration(seconds)}, through ${count(transitions, 'transition')}; stops ${centimetres(distance)} away${facing}${pose}`;
  }

  place(seen) {
    this.handles.place(seen);
  }

  draw(marks, colour) {
    const place = this.goal;
    this.drawTrack(marks, colour);
    if (!place) return;
    const centre = [place.x, place.z];
    marks.disc(centre, 0.24, colour('accent', 0.16));
    marks.disc(centre, 0.24, colour('accent', 0.9), 0.215);
    if (place.heading === null) return;
    marks.ribbon([this.arm(place, 0.24), this.arm(place, ARM - 0.06)], 0.03, colour('accent', 0.9));
    marks.arrow(this.arm(place, ARM - 0.1), place.heading, 0.14, colour('accent', 0.9));
  }
}
