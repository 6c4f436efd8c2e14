/** Chooses the poses that are shown around the actor: a few it can reach soon, far enough apart to be told from each other. */

/** Seconds within which a pose must be reached. */
const SOON = { least: 0.4, most: 6 };
const MOST_POSES = 6;
/** Metres between two poses, and between a pose and the actor. */
const APART = 1;

const rest = () => new Promise((resolve) => setTimeout(resolve, 0));

/**
 * @param {import('./director.js').Director} director
 * @param {() => boolean} wanted false when the answer is no longer of use
 * @returns {Promise<number[]>} frames
 */
export async function suggestPoses(director, wanted) {
  const actor = director.state;
  const reachable = [];
  for (const frame of candidates(director.timeline)) {
    const way = approach(director, frame);
    if (way) reachable.push(way);
    await rest();
    if (!wanted()) return [];
  }
  reachable.sort((a, b) => a.seconds - b.seconds);
  return spreadOut(reachable, actor).map(({ frame }) => frame);
}

/** Parts of the way through every sequence: no pose at a sequence's end, where the actor would be stuck. */
const SHARES = [0.25, 0.4, 0.55, 0.7, 0.85];

function candidates(timeline) {
  return timeline.sequences.flatMap(({ first, count }) => SHARES.map((share) => first + Math.floor(count * share)));
}

function approach(director, frame) {
  try {
    if (!director.player.loaded(frame)) return null;
    const { seconds } = director.plan(frame);
    if (seconds < SOON.least || seconds > SOON.most) return null;
    return { frame, seconds, ...director.arrivalOf(frame) };
  } catch {
    // Out of reach from here: not a pose to suggest.
    return null;
  }
}

function spreadOut(reachable, actor) {
  const chosen = [];
  for (const pose of reachable) {
    const near = [actor, ...chosen].some((other) => Math.hypot(other.x - pose.x, other.z - pose.z) < APART);
    if (!near) chosen.push(pose);
    if (chosen.length === MOST_POSES) break;
  }
  return chosen;
}
