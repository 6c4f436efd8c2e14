/** Which behaviour each stretch of a path demands, as painting and changing the path's points leave it. */

/** Knots below which a stretch is nothing. */
const LEAST = 0.02;

/**
 * Paints a behaviour over a stretch; null rubs out. Stretches never overlap, and those alike that touch become one.
 * @param {{from: number, to: number, behaviour: string}[]} stretches places in knots
 */
export function paint(stretches, from, to, behaviour) {
  const rest = stretches.flatMap((one) => [
    { ...one, to: Math.min(one.to, from) },
    { ...one, from: Math.max(one.from, to) },
  ]);
  const all = behaviour === null ? rest : [...rest, { from, to, behaviour }];
  const sorted = all.filter((one) => one.to - one.from > LEAST).sort((a, b) => a.from - b.from);
  const joined = [];
  for (const one of sorted) {
    const last = joined[joined.length - 1];
    if (last && last.behaviour === one.behaviour && one.from - last.to < LEAST) joined[joined.length - 1] = { ...last, to: one.to };
    else joined.push(one);
  }
  return joined;
}

/** After point `index` of the path is new: knots behind it count one more. */
export function pointInserted(stretches, index) {
  const move = (knot) => {
    if (knot >= index) return knot + 1;
    // The segment that was divided has two now.
    return knot > index - 1 ? index - 1 + (knot - index + 1) * 2 : knot;
  };
  return stretches.map((one) => ({ ...one, from: move(one.from), to: move(one.to) }));
}

/** After point `index` is gone. */
export function pointDeleted(stretches, index, left) {
  const move = (knot) => {
    if (knot >= index + 1) return knot - 1;
    return knot > index - 1 ? index - 1 + (knot - index + 1) / 2 : knot;
  };
  const moved = stretches.map((one) => ({ ...one, from: Math.max(0, move(one.from)), to: Math.min(left - 1, move(one.to)) }));
  return moved.filter(({ from, to }) => to - from > LEAST);
}
