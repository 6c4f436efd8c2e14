/** What `builder transfer` demands of keys (docs/transfer.md), said while they are chosen. */

/** Keys that something is learned from at least. */
const FEWEST = 3;
/** Steps of one side alone in a row, at most: one side is at most four times as fast as the other. */
const STRAIGHT = 3;

/** A pair in words, as the command names it. */
export function pairName({ from, fromFrame, to, toFrame }) {
  return `${from} ${fromFrame} → ${to} ${toFrame}`;
}

/** Pairs that are matched with each other: of the same sequences and stretch. */
export function groupOf({ from, to, stretch }) {
  return JSON.stringify([from, to, stretch]);
}

/**
 * The pairs by sequences and stretch, in the order of time.
 * @param {import('./toml.js').KeyPair[]} pairs
 * @returns {import('./toml.js').KeyPair[][]}
 */
export function grouped(pairs) {
  const groups = new Map();
  for (const pair of pairs) {
    const name = groupOf(pair);
    groups.set(name, [...(groups.get(name) ?? []), pair]);
  }
  return [...groups.values()].map((group) => group.sort((a, b) => a.toFrame - b.toFrame || a.fromFrame - b.fromFrame));
}

/**
 * @typedef {object} Finding
 * @property {'wrong' | 'hint'} kind what the command refuses, or what is still missing
 * @property {string} text
 * @property {import('./toml.js').KeyPair[]} pairs those that it is about
 */

/**
 * All that is wrong with keys, for actors as far as they are known.
 * @param {import('./toml.js').KeyPair[]} pairs
 * @param {import('../reprise-player').ActorInfo | null} source
 * @param {import('../reprise-player').ActorInfo | null} target
 * @returns {Finding[]}
 */
export function check(pairs, source, target) {
  const lost = pairs.flatMap((pair) => [unknown(pair, 'source', source, pair.from, pair.fromFrame), unknown(pair, 'target', target, pair.to, pair.toFrame)]);
  const findings = lost.filter(Boolean);
  let count = 0;
  for (const group of grouped(pairs)) {
    const once = group.filter((pair, index) => index === 0 || !same(pair, group[index - 1]));
    for (const pair of group.filter((one) => !once.includes(one))) {
      findings.push({ kind: 'hint', text: `${pairName(pair)} is there twice; it counts once.`, pairs: [pair] });
    }
    count += once.length;
    const contrary = once.slice(1).flatMap((pair, index) => contradiction(once[index], pair) ?? []);
    findings.push(...contrary);
    if (contrary.length === 0 && source && target) findings.push(...tooFast(once, target.fps / source.fps));
  }
  if (count > 0 && count < FEWEST) {
    const some = count === 1 ? '1 key' : `${count} keys`;
    findings.push({ kind: 'hint', text: `${some}: at least ${FEWEST} are needed, best five for each sequence.`, pairs: [] });
  }
  return findings;
}

function same(one, other) {
  return one.fromFrame === other.fromFrame && one.toFrame === other.toFrame;
}

function unknown(pair, which, info, name, frame) {
  if (!info) return null;
  const sequence = info.sequences.find((one) => one.name === name);
  const wrong = (text) => ({ kind: 'wrong', text: `${pairName(pair)}: ${text}`, pairs: [pair] });
  if (!sequence) return wrong(`the ${which} has no sequence “${name}”; it has: ${info.sequences.map((one) => one.name).join(', ')}.`);
  return frame < sequence.count ? null : wrong(`sequence “${name}” of the ${which} has no frame ${frame}, but 0 to ${sequence.count - 1}.`);
}

function contradiction(first, second) {
  if (second.fromFrame > first.fromFrame && second.toFrame > first.toFrame) return null;
  const where = first.stretch === null ? '' : ` in the stretch “${first.stretch}”`;
  const text = `${pairName(first)} and ${pairName(second)} contradict each other${where}: time must go on in both. Correct or remove one, or give one another stretch.`;
  return { kind: 'wrong', text, pairs: [first, second] };
}

/**
 * Whether there is a way through all keys, as the command looks for one: frames of the source as many a second as the target has, steps of
 * one in both or in one of them, at most three of the same in a row.
 * @param {number} ratio frames a second of the target, by those of the source
 * @returns {Finding[]} where there is none, the two keys between which one side is fastest beside the other
 */
function tooFast(keys, ratio) {
  if (keys.length < 2) return [];
  const [first, last] = [keys[0].fromFrame, keys.at(-1).fromFrame];
  const rows = Math.max(1, Math.round((last - first) * ratio));
  const rowOf = ({ fromFrame }) => Math.round(((fromFrame - first) / (last - first)) * rows);
  const steps = keys.slice(1).map((after, at) => {
    const before = keys[at];
    const [own, others] = [rowOf(after) - rowOf(before), after.toFrame - before.toFrame];
    return { before, after, rows: own, columns: others, ratio: Math.abs(Math.log(Math.max(own, 1e-3) / others)) };
  });
  if (steps.reduce((states, { rows: own, columns }) => reach(states, own, columns), 1) !== 0) return [];
  const worst = steps.reduce((one, other) => (other.ratio >= one.ratio ? other : one));
  const text = `Between ${pairName(worst.before)} and ${pairName(worst.after)} the ${worst.rows > worst.columns ? 'source' : 'target'} is more than four times as fast as the other. Correct one of them, or give them stretches of their own.`;
  return [{ kind: 'wrong', text, pairs: [worst.before, worst.after] }];
}

/**
 * The states in which a way may come to the end of a box of frames. A state is a bit: 0 after a step in both, 1 to 3 after so many steps of the
 * source alone, 4 to 6 after so many of the target alone.
 */
function reach(states, rows, columns) {
  // Where there is room, all ends are reached from all beginnings: nothing has to be tried in long stretches.
  if (Math.min(rows, columns) >= 8 && Math.max(rows, columns) <= 2 * Math.min(rows, columns)) return (1 << (1 + 2 * STRAIGHT)) - 1;
  const width = columns + 1;
  const seen = new Uint8Array((rows + 1) * width);
  seen[0] = states;
  const own = ((1 << STRAIGHT) - 1) << 1;
  for (let i = 0; i <= rows; i += 1) {
    for (let j = 0; j <= columns; j += 1) {
      const here = seen[i * width + j];
      if (here === 0) continue;
      if (i < rows && j < columns) seen[(i + 1) * width + j + 1] |= 1;
      // The first of a run follows a step in both, the second the first, the third the second.
      const down = ((here & 1) | (here & own & ~(1 << STRAIGHT))) << 1;
      if (i < rows) seen[(i + 1) * width + j] |= down & own;
      const right = ((here & 1) << (STRAIGHT + 1)) | ((here & (own << STRAIGHT) & ~(1 << (2 * STRAIGHT))) << 1);
      if (j < columns) seen[i * width + j + 1] |= right & (own << STRAIGHT);
    }
  }
  return seen.at(-1);
}
