/**
 * A drawn line as a few points, and the curve through them. The same centripetal Catmull-Rom spline as the search's. Points
 * are x and z, or x, z and a height.
 */

import { apart } from './marks.js';

/** Pieces of a segment between two points. */
const PIECES = 16;

/**
 * Leaves out points that the rest describes within `slack` metres (Ramer, Douglas and Peucker).
 * @param {[number, number][]} points
 */
export function simplify(points, slack) {
  if (points.length < 3) return points;
  const [first, last] = [points[0], points[points.length - 1]];
  let [farthest, at] = [0, 0];
  for (let index = 1; index < points.length - 1; index += 1) {
    const off = offLine(points[index], first, last);
    if (off > farthest) [farthest, at] = [off, index];
  }
  if (farthest <= slack) return [first, last];
  return [...simplify(points.slice(0, at + 1), slack).slice(0, -1), ...simplify(points.slice(at), slack)];
}

function offLine(point, a, b) {
  const [dx, dz] = [b[0] - a[0], b[1] - a[1]];
  const square = dx * dx + dz * dz;
  const share = square ? Math.max(0, Math.min(1, ((point[0] - a[0]) * dx + (point[1] - a[1]) * dz) / square)) : 0;
  return apart(point, [a[0] + dx * share, a[1] + dz * share]);
}

/** A curve by arc length. Places on it are told as knots: 1.5 is between its second and its third point. */
export class Curve {
  /** @param {number[][]} points all with a height or all without; at least one @param {'spline' | 'polyline'} shape */
  constructor(points, shape = 'spline') {
    const straight = shape === 'polyline' || points.length < 3;
    this.count = points.length;
    this.line = [points[0]];
    for (let segment = 0; segment + 1 < points.length; segment += 1) {
      const [a, b] = [points[segment], points[segment + 1]];
      const before = points[segment - 1] ?? mix(a, b, -1);
      const after = points[segment + 2] ?? mix(a, b, 2);
      for (let piece = 1; piece <= PIECES; piece += 1) {
        this.line.push(straight ? mix(a, b, piece / PIECES) : catmullRom([before, a, b, after], piece / PIECES));
      }
    }
    this.lengths = [0];
    for (let at = 1; at < this.line.length; at += 1) this.lengths.push(this.lengths[at - 1] + apart(this.line[at], this.line[at - 1]));
  }

  get length() {
    return this.lengths[this.lengths.length - 1];
  }

  /** Metres along the curve at a knot. */
  lengthAt(knot) {
    return this.interpolate(knot, (at) => this.lengths[at], (a, b, t) => a + (b - a) * t);
  }

  at(knot) {
    return this.interpolate(knot, (at) => this.line[at], mix);
  }

  interpolate(knot, value, between) {
    const place = Math.max(0, Math.min(this.line.length - 1, knot * PIECES));
    const index = Math.floor(place);
    return index + 1 < this.line.length ? between(value(index), value(index + 1), place - index) : value(index);
  }

  /** The knot at so many metres. */
  knotAt(metres) {
    const index = this.lengths.findIndex((length) => length >= metres);
    if (index < 0) return this.count - 1;
    if (index === 0) return 0;
    const span = this.lengths[index] - this.lengths[index - 1];
    return (index - 1 + (span ? (metres - this.lengths[index - 1]) / span : 0)) / PIECES;
  }

  /** The knot of its point that is nearest, and how far away it is. @param {(point: number[]) => number} distance of a point */
  nearest(distance) {
    let [knot, off] = [0, Infinity];
    this.line.forEach((here, at) => {
      const far = distance(here);
      if (far < off) [knot, off] = [at / PIECES, far];
    });
    return { knot, off };
  }

  /** Its points from one knot to another, for drawing. */
  stretch(from, to) {
    const inner = this.line.filter((_, at) => at / PIECES > from && at / PIECES < to);
    return [this.at(from), ...inner, this.at(to)];
  }
}

/** Between two points, or beyond them. */
export function mix(a, b, t) {
  return a.map((from, axis) => from + (b[axis] - from) * t);
}

/** Barry and Goldman, "A recursive evaluation algorithm for a class of Catmull-Rom splines" (1988). */
function catmullRom(p, u) {
  const t = [0];
  for (let index = 1; index < 4; index += 1) t.push(t[index - 1] + Math.sqrt(Math.max(1e-9, apart(p[index], p[index - 1]))));
  const at = t[1] + (t[2] - t[1]) * u;
  const blend = (a, b, from, to) => mix(a, b, (at - from) / (to - from));
  const [a, b, c] = [0, 1, 2].map((index) => blend(p[index], p[index + 1], t[index], t[index + 1]));
  return blend(blend(a, b, t[0], t[2]), blend(b, c, t[1], t[3]), t[1], t[2]);
}
