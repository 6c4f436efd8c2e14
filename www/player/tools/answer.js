/** The search's answers, as the page and its pages read them. */

/**
 * @param {string} text from `Searcher.answer`
 * @returns {import('../../reprise-player').Answer}
 */
export function readAnswer(text, fps) {
  const { seconds, steps, legs, track, parts, progress, start_frame: frame, start_placement: placement } = JSON.parse(text);
  const answer = {
    seconds,
    frames: steps,
    transitions: legs.filter(({ kind }) => kind === 'synthetic').length,
    progress,
    notes: parts.flatMap(({ notes }) => notes),
    start: { frame, placement },
    legs,
    track,
  };
  for (const { goal } of parts) {
    const { place, path, keys, wander } = goal;
    if (place) answer.place = { ...place, turn: place.turn ?? null };
    if (path) answer.path = { length: path.length, travelled: path.travelled, mean: path.mean, max: path.max, meanAside: path.mean_aside, maxAside: path.max_aside, demandsKept: path.demands_kept ?? null, samples: path.track };
    if (keys) answer.keys = keys.rows.map((row) => ({ frame: row.frame, wanted: row.wanted / fps, reached: row.reached === null ? null : row.reached / fps }));
    if (wander) answer.wander = { frames: wander.frames, objective: wander.objectives[2], objectives: wander.objectives };
  }
  return answer;
}
