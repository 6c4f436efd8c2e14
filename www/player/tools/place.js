/** Click the ground, and the actor goes there; drag, and it arrives facing that way. */

import { h } from '../dom.js';
import { count, duration } from '../format.js';
import { GoRow, button, centimetres, numberField } from './dock.js';
import { Handles } from './handles.js';
import { apart } from './marks.js';

const DEGREE = Math.PI / 180;
/** Metres from the place to the handle that turns it. */
const ARM = 0.6;

export class PlaceTool {
  static id = 'place';
  static title = 'Place';
  static about = 'Click the ground: the actor goes there; drag to say which way it faces';

  id = PlaceTool.id;
  hint = 'Click the ground; drag to say which way to face.';
  onGround = true;

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    const at = (index) => (value) => this.set({ [['x', 'z', 'heading'][index]]: index === 2 && value !== null ? value * DEGREE : value });
    this.fields = [
      numberField('x', 'm', { step: 0.1 }, at(0)),
      numberField('z', 'm', { step: 0.1 }, at(1)),
      numberField('facing', '°', { step: 5, placeholder: 'any' }, at(2)),
    ];
    this.row = new GoRow(() => box.go());
    this.dock = h(
      'div',
      { class: 'tool-dock place-dock', role: 'group', 'aria-label': 'Place' },
      h('div', { class: 'row' }, ...this.fields.map(({ root }) => root), button('Any facing', 'Arrive facing any way', () => this.set({ heading: null }))),
      this.row.root,
    );
    this.handles = new Handles(box, {
      move: (index, point, merge) => this.moved(index, point, merge),
      remove: (index) => this.removed(index),
      describe: (index, [x, z]) => (index === 0 ? `Place, ${x.toFixed(1)} by ${z.toFixed(1)} metres` : 'Facing'),
    });
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
    const before = this.goal ?? { x: 0, z: 0, heading: null };
    const place = { ...before, ...part };
    this.box.edit({ place: { x: place.x ?? 0, z: place.z ?? 0, heading: place.heading ?? null } }, merge);
  }

  moved(index, [x, z], merge) {
    if (index === 0) this.set({ x, z }, merge);
    else this.set({ heading: Math.atan2(x - this.goal.x, z - this.goal.z) }, merge);
  }

  removed(index) {
    if (index === 0) this.box.edit({ place: null });
    else this.set({ heading: null });
  }

  grab(x, y) {
    const start = this.box.core.view.stage.groundAt(x, y);
    if (!start) return null;
    const merge = `place ${performance.now()}`;
    this.aiming = true;
    this.set({ x: start[0], z: start[1], heading: null }, merge);
    return {
      move: (nowX, nowY) => {
        const here = this.box.core.view.stage.groundAt(nowX, nowY);
        if (here && apart(start, here) > ARM / 3) this.set({ heading: Math.atan2(here[0] - start[0], here[1] - start[1]) }, merge);
      },
      end: () => {
        this.aiming = false;
        this.box.go();
      },
      drop: () => {
        this.aiming = false;
        this.box.undo(-1);
      },
    };
  }

  refresh() {
    const place = this.goal;
    const points = place ? [[place.x, place.z], ...(place.heading === null ? [] : [this.arm(place, ARM)])] : [];
    this.handles.show(points, (index) => (index === 0 ? 'spot' : 'turn'));
    const values = place ? [place.x.toFixed(2), place.z.toFixed(2), place.heading === null ? '' : Math.round(place.heading / DEGREE)] : ['', '', ''];
    this.fields.forEach(({ input }, index) => {
      if (input.getRootNode().activeElement !== input) input.value = values[index];
    });
    this.answered(this.box.answer);
  }

  arm({ x, z, heading }, far) {
    return [x + Math.sin(heading) * far, z + Math.cos(heading) * far];
  }

  answered(answer) {
    if (!this.goal) this.row.show(this.hint, false);
    else this.row.tell(this.box.trouble, null, answer ? this.sentence(answer) : 'looking for a way');
  }

  sentence({ seconds, transitions, place }) {
    const { distance = 0, turn = null } = place ?? {};
    const facing = turn === null ? '' : `, ${Math.round(Math.abs(turn) / DEGREE)}° off the way it should face`;
    return `there in ${duration(seconds)}, through ${count(transitions, 'transition')}; stops ${centimetres(distance)} away${facing}`;
  }

  place(seen) {
    this.handles.place(seen);
  }

  draw(marks, colour) {
    const place = this.goal;
    this.box.drawTrack(marks, colour);
    if (!place) return;
    const centre = [place.x, place.z];
    marks.disc(centre, 0.24, colour('accent', 0.16));
    marks.disc(centre, 0.24, colour('accent', 0.9), 0.215);
    if (place.heading === null) return;
    marks.ribbon([this.arm(place, 0.24), this.arm(place, ARM - 0.06)], 0.03, colour('accent', 0.9));
    marks.arrow(this.arm(place, ARM - 0.1), place.heading, 0.14, colour('accent', 0.9));
  }
}
