/**
 * Between what the tools hold and requests, the JSON that searches, links, files and the command line share (see
 * docs/directing.md). Requests from outside are checked by the engine before they get here.
 */

export const VERSION = 1;

/** What the tools hold when nothing has been asked. */
export const EMPTY = Object.freeze({
  /** Where the actor was sent from the score, as a request's target. */
  pose: null,
  place: null,
  /** Points are x and z, or x, z and a height; `vertices`, where there are any, follow it in place of the body's middle. */
  path: { points: [], stretches: [], shape: 'spline' },
  keys: [],
  wander: { seed: 1, weights: {} },
  /** Edits of recorded frames, as docs/editing.md has them: beside whatever is asked. */
  edits: [],
  /** Targets that wait, as `queue` takes them. */
  queue: [],
});

/** Seconds of wandering that are searched for at a time; the walk is gone on with before they are over. */
const WANDER = 60;
/** No capture has this frame. */
const NOWHERE = 4294967295;
/** Points of a path that can be taken hold of. */
export const MOST_POINTS = 200;

/** @returns {object | null} the request of a tool, or null where nothing is asked with it */
export function requestOf(tool, { place, path, keys, wander, pose }) {
  const request = (target, seed = 0) => ({ version: VERSION, seed, target });
  if (tool === 'place') return place && request({ place: tidy({ ...place, heading: place.heading ?? undefined }) });
  if (tool === 'path') return path.points.length > 1 ? request({ path: tidy({ ...path, points: path.points.map(swapped) }) }) : null;
  if (tool === 'timing') return keys.length > 0 ? request({ keys: { poses: keys.map(({ frame, seconds }) => ({ pose: frame, time: seconds })) } }) : null;
  if (tool === 'edit') return null;
  if (tool === 'wander') return request({ wander: { seconds: WANDER, weights: wander.weights } }, wander.seed);
  return pose ? request(pose) : null;
}

/** The document of edits as links, files and films have it. */
export function documentOf(edits) {
  return { version: VERSION, edits };
}

/** The vertices that a request wants to follow its paths. */
export function followersOf({ target }) {
  return [target, ...(target.queue ?? [])].find(({ path }) => path?.vertices?.length)?.path.vertices ?? [];
}

/** Requests have the height in the middle. */
function swapped([a, ...rest]) {
  return [a, ...rest.reverse()];
}

/** Millimetres and milliradians are enough, and make short links. */
function tidy(value) {
  return JSON.parse(JSON.stringify(value, (_, part) => (typeof part === 'number' ? Math.round(part * 1000) / 1000 : part)));
}

/**
 * What a checked request means for the tools: which one shows it, and the part of the document.
 * @param {import('../timeline.js').Timeline} timeline
 * @returns {{tool: string, part: object, queue?: object[]}} the queue is what comes after the document's pose
 */
export function partOf({ target, seed = 0 }, timeline) {
  const { place, path, keys, wander } = target;
  if (place) return { tool: 'place', part: { place: { ...place, heading: place.heading ?? null } } };
  const editable = path && path.points.length <= MOST_POINTS && !path.free_start;
  if (editable) {
    const { points, stretches = [], shape = 'polyline', vertices, realism, exactness } = path;
    return { tool: 'path', part: { path: { points: points.map(swapped), stretches, shape, vertices, realism, exactness } } };
  }
  if (keys) {
    const poses = keys.poses.map(({ pose, time }) => ({ frame: frameOf(pose, timeline), seconds: time }));
    return { tool: 'timing', part: { keys: poses.sort((a, b) => a.seconds - b.seconds) } };
  }
  if (wander) return { tool: 'wander', part: { wander: { seed, weights: wander.weights ?? {} } } };
  // A queue of poses and behaviours is gone through one by one, so that what waits can be seen and changed.
  const [first, ...rest] = target.queue ?? [];
  if (first && target.queue.every(({ pose, behaviour }) => pose !== undefined || behaviour)) {
    return { tool: 'pose', part: { pose: first }, queue: rest.map((one) => targetOf(one, timeline)) };
  }
  return { tool: 'pose', part: { pose: target }, queue: [] };
}

/** As `queue` takes it. */
function targetOf({ pose, behaviour }, timeline) {
  return behaviour ? { behaviour: behaviour.name, hold: behaviour.hold ?? 0 } : frameOf(pose, timeline);
}

/** A frame that does not exist is left for the search to complain about. */
export function frameOf(pose, timeline) {
  if (typeof pose === 'number') return pose;
  const sequence = timeline.sequences.find(({ name }) => name === pose.sequence);
  const local = pose.frame ?? Math.round((pose.time ?? 0) * timeline.fps);
  // Not one of the sequence behind it.
  return sequence && local >= 0 && local < sequence.count ? sequence.first + local : NOWHERE;
}
