/** What the edit tool shows over the actor: the point that would be grabbed, feet that stay, and the bones. */

import { h } from '../dom.js';
import { Air } from './air.js';
import { putAt } from './handles.js';

export class EditMarks {
  /** @param {(foot: number) => void} toggle a foot that is to stay, or not */
  constructor(toggle) {
    this.toggle = toggle;
    this.point = h('div', { class: 'part-mark', 'aria-hidden': 'true', hidden: true });
    this.pins = [];
    this.feet = [];
    this.bones = new Air();
    this.root = h('div', { class: 'edit-marks' }, this.bones.root, this.point);
  }

  /** @param {{vertices: Uint32Array, stays: boolean, stands: boolean}[]} feet */
  showFeet(feet) {
    this.feet = feet;
    while (this.pins.length > feet.length) this.pins.pop().remove();
    while (this.pins.length < feet.length) {
      const foot = this.pins.length;
      this.pins.push(this.root.appendChild(h('button', { type: 'button', class: 'pin' })));
      this.pins[foot].addEventListener('click', () => this.toggle(foot));
    }
    feet.forEach(({ stays, stands }, foot) => {
      const name = `Foot ${foot + 1}${stands ? ', which stands' : ''}`;
      this.pins[foot].setAttribute('aria-label', name);
      this.pins[foot].setAttribute('aria-pressed', String(stays));
      this.pins[foot].title = `${name}: ${stays ? 'stays where it is; click to let it go' : 'goes along; click to make it stay'}`;
    });
  }

  /**
   * @param {Float32Array} pose as drawn
   * @param {ArrayLike<number>} bones where each begins and ends, in the world
   * @param {import('../stage-view.js').StageView['seen']} seen
   */
  place(pose, bones, seen) {
    this.feet.forEach(({ vertices }, foot) => putAt(this.pins[foot], seen(...middle(pose, vertices))));
    const lines = [];
    for (let at = 0; at + 5 < bones.length; at += 6) {
      const [ax, ay, az, bx, by, bz] = bones.slice(at, at + 6);
      lines.push([[ax, az, ay], [bx, bz, by]]);
    }
    this.bones.place({ wanted: lines }, seen);
  }

  /** @param {{x: number, y: number, visible: boolean} | null} at where it is seen */
  showPoint(at) {
    this.point.hidden = at === null;
    if (at) putAt(this.point, at);
  }

  hide() {
    this.showFeet([]);
    this.showPoint(null);
    this.bones.place({ wanted: [] }, () => null);
  }
}

/** The middle of some vertices: x, z and height. */
function middle(pose, vertices) {
  const sum = [0, 0, 0];
  for (const vertex of vertices) {
    for (let axis = 0; axis < 3; axis += 1) sum[axis] += (pose[3 * vertex + axis] ?? 0) / vertices.length;
  }
  return [sum[0], sum[2], sum[1]];
}
