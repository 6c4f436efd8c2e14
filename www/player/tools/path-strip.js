/** The path unrolled: what is painted where, and how far the walk is from it. Painting works here with the keys, too. */

import { h, sizedContext } from '../dom.js';
import { words } from '../format.js';
import { showScale } from './dock.js';

/** Metres that an arrow key moves the brush. */
const STEP = 0.25;
const HEIGHT = 44;

export class PathStrip {
  /** @param {{paint: (from: number, to: number, merge: string) => void, brush: () => string | null}} act places in knots */
  constructor(act) {
    this.act = act;
    this.at = 0;
    this.curve = null;
    this.painted = h('div', { class: 'painted' });
    this.plot = h('canvas', { 'aria-hidden': 'true' });
    this.mark = h('div', { class: 'brush-mark' });
    this.scale = h('div', { class: 'scale figures', 'aria-hidden': 'true' });
    this.root = h(
      'div',
      { class: 'path-strip', role: 'slider', tabindex: 0, 'aria-label': 'Along the path', 'aria-valuemin': 0, 'aria-valuemax': 1, 'aria-valuenow': 0, title: 'With a brush: drag, or shift and arrow keys, to paint' },
      this.painted,
      this.plot,
      this.mark,
      this.scale,
    );
    this.root.addEventListener('keydown', (event) => this.key(event));
    this.root.addEventListener('pointerdown', (event) => this.press(event));
    this.root.addEventListener('pointermove', (event) => this.drag(event));
  }

  show(curve, stretches, hue) {
    this.curve = curve;
    this.root.hidden = !curve;
    if (!curve) return;
    this.at = Math.min(this.at, curve.length);
    const share = (knot) => (curve.lengthAt(knot) / curve.length) * 100;
    this.painted.replaceChildren(
      ...stretches.map(({ from, to, behaviour }) => {
        const piece = h('span', { class: `b${hue(behaviour)}` }, words(behaviour));
        piece.style.left = `${share(from)}%`;
        piece.style.width = `${share(to) - share(from)}%`;
        return piece;
      }),
    );
    showScale(this.scale, curve.length, 'm', [1, 2, 5, 10, 20, 50], 12);
    this.root.setAttribute('aria-valuemax', curve.length.toFixed(1));
    this.stretches = stretches;
    this.tell();
  }

  tell() {
    const knot = this.curve.knotAt(this.at);
    const behaviour = this.stretches.find(({ from, to }) => knot >= from && knot < to)?.behaviour ?? 'any behaviour';
    this.root.setAttribute('aria-valuenow', this.at.toFixed(1));
    this.root.setAttribute('aria-valuetext', `${this.at.toFixed(1)} metres, ${behaviour}`);
    this.mark.style.left = `${(this.at / this.curve.length) * 100}%`;
  }

  /** @param {[number, number][]} deviations metres along the path, and metres that the walk is off there */
  answered(deviations) {
    if (!this.curve || !this.root.clientWidth) return;
    const width = this.root.clientWidth;
    const context = sizedContext(this.plot, width, HEIGHT);
    if (deviations.length < 2) return;
    const most = Math.max(0.1, ...deviations.map(([, off]) => off));
    const style = getComputedStyle(this.root);
    context.fillStyle = style.getPropertyValue('--ink');
    context.globalAlpha = 0.22;
    context.beginPath();
    context.moveTo(0, HEIGHT);
    for (const [metres, off] of deviations) context.lineTo((metres / this.curve.length) * width, HEIGHT - (off / most) * (HEIGHT - 18));
    context.lineTo((deviations[deviations.length - 1][0] / this.curve.length) * width, HEIGHT);
    context.fill();
  }

  key(event) {
    if (!this.curve) return;
    const { length } = this.curve;
    const by = { ArrowLeft: -STEP, ArrowDown: -STEP, ArrowRight: STEP, ArrowUp: STEP, Home: -length, End: length }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const before = this.at;
    this.at = Math.max(0, Math.min(length, this.at + by));
    if (event.shiftKey && this.at !== before) this.act.paint(this.curve.knotAt(before), this.curve.knotAt(this.at), 'paint with keys');
    this.tell();
  }

  metresAt(event) {
    const box = this.root.getBoundingClientRect();
    return Math.max(0, Math.min(1, (event.clientX - box.left) / box.width)) * this.curve.length;
  }

  press(event) {
    if (event.button !== 0 || !this.curve) return;
    this.root.setPointerCapture(event.pointerId);
    this.start = this.at = this.metresAt(event);
    this.run = `strip ${performance.now()}`;
    this.tell();
  }

  drag(event) {
    if (!this.curve || !this.root.hasPointerCapture(event.pointerId)) return;
    this.at = this.metresAt(event);
    if (this.act.brush() !== null) this.act.paint(this.curve.knotAt(this.start), this.curve.knotAt(this.at), this.run);
    this.tell();
  }
}
