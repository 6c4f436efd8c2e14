/** How far the body is from the path, as the papers measure: against the point of equal length. */

import { mix } from './curve.js';
import { apart } from './marks.js';

/**
 * @param {import('./curve.js').Curve} curve
 * @param {{length: number, samples: [number, number, number, number][]}} path of an answer
 * @returns {{metres: number, wanted: number[], walked: number[]}[]} metres along the curve; where the body should be there
 *   and where it is, with a height where the path has one. Before the path, there is the straight way to its beginning
 */
export function deviation(curve, { length, samples }) {
  const [first] = curve.line;
  const isFlat = first.length < 3;
  const approach = Math.max(0, length - curve.length);
  const walked = samples.map(([, x, y, z]) => (isFlat ? [x, z] : [x, z, y]));
  return samples.map(([travelled], at) => {
    const metres = Math.min(curve.length, Math.max(0, travelled - approach));
    const wanted = travelled >= approach ? curve.at(curve.knotAt(metres)) : mix(walked[0], first, travelled / approach);
    return { metres, wanted, walked: walked[at] };
  });
}

/** Metres along the curve, and metres that the walk is off there. */
export function gaps(deviations) {
  return deviations.map(({ metres, wanted, walked }) => [metres, apart(wanted, walked)]);
}
