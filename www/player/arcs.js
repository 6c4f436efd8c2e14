/** Draws transitions as arcs over the strips: the graph's in thin grey, the planned walk's bold, the walk under way in colour. */

/**
 * Corners of a cubic Bézier from one frame of the score to another. Within a row it rises into the gap above; between
 * rows it leaves and enters at the edges that face each other, so that it does not cross the poses of either.
 */
export function arcBetween(layout, from, to) {
  const [source, target] = [layout.stripOf(from), layout.stripOf(to)];
  const start = { x: layout.xOf(from), y: source.y < target.y ? source.y + source.height : source.y };
  const end = { x: layout.xOf(to), y: target.y < source.y ? target.y + target.height : target.y };
  if (source.y !== target.y) {
    const bend = (end.y - start.y) * 0.8;
    return { start, a: { x: start.x, y: start.y + bend }, b: { x: end.x, y: end.y - bend }, end };
  }
  // Higher for a longer way, but never out of the row's own gap: a cubic reaches three quarters of its handles.
  const lift = Math.min(layout.gap - 4, 6 + Math.abs(end.x - start.x) * 0.1) / 0.75;
  return { start, a: { x: start.x, y: start.y - lift }, b: { x: end.x, y: end.y - lift }, end };
}

/** The point at `t` from 0 to 1. */
export function pointOn({ start, a, b, end }, t) {
  const s = 1 - t;
  const mix = (key) => s * s * s * start[key] + 3 * s * s * t * a[key] + 3 * s * t * t * b[key] + t * t * t * end[key];
  return { x: mix('x'), y: mix('y') };
}

function trace(context, { start, a, b, end }) {
  context.moveTo(start.x, start.y);
  context.bezierCurveTo(a.x, a.y, b.x, b.y, end.x, end.y);
}

/** An arc within a sequence is shown only if it leads this many seconds away. */
const AWAY = 1;

/**
 * A few arcs that stand for all: the cheapest from every sequence to every other. The cheapest of all would be
 * neighbours of each other, thousands of them.
 * @param {import('./timeline.js').Timeline} timeline
 * @param {Float32Array} quads from, to, deformation, frames; cheapest first
 * @returns {Float32Array} some of them, in the same order
 */
export function chooseArcs(timeline, quads) {
  const chosen = [];
  const pairs = new Set();
  for (let at = 0; at < quads.length; at += 4) {
    const [from, to] = [quads[at], quads[at + 1]];
    const [source, target] = [timeline.indexOf(from), timeline.indexOf(to)];
    const pair = `${source} ${target}`;
    const near = source === target && Math.abs(from - to) < AWAY * timeline.fps;
    if (near || pairs.has(pair)) continue;
    pairs.add(pair);
    chosen.push(...quads.subarray(at, at + 4));
  }
  return Float32Array.from(chosen);
}

/**
 * The graph behind the strips.
 * @param {Float32Array} quads from, to, deformation, frames; cheapest first
 */
export function drawGraph(context, layout, quads, colour) {
  context.lineWidth = 1;
  context.strokeStyle = colour;
  const last = Math.max(1, quads.length / 4 - 1);
  // The cheapest are the darkest, and on top.
  for (let at = quads.length / 4 - 1; at >= 0; at -= 1) {
    context.globalAlpha = 0.42 - 0.3 * (at / last);
    context.beginPath();
    trace(context, arcBetween(layout, quads[at * 4], quads[at * 4 + 1]));
    context.stroke();
  }
  context.globalAlpha = 1;
}

/**
 * A walk over the strips: recorded stretches as a line along their strip, synthetic ones as arcs. Solid against hatched
 * tells them apart without colour.
 * @param {object[]} legs of a walk as the player gives them
 * @param {{recorded: string, synthetic: string}} colours
 * @param {{leg: number, progress: number} | null} now how far the actor is; null for a walk that is only planned
 */
export function drawWalk(context, layout, legs, colours, now) {
  legs.forEach((leg, index) => {
    const done = !now || index < now.leg ? 1 : index > now.leg ? 0 : now.progress;
    if (leg.kind === 'recorded') drawRecorded(context, layout, leg, colours.recorded, now ? done : 0.999);
    else drawSynthetic(context, layout, leg, colours.synthetic, now ? done : 0.999, Boolean(now));
  });
}

function drawRecorded(context, layout, leg, colour, done) {
  for (const [from, to] of stretches(layout, leg)) {
    const y = layout.stripOf(from).y + layout.stripOf(from).height - 1.5;
    const [x0, x1] = [layout.xOf(from), layout.xOf(to)];
    context.lineWidth = 3;
    context.lineCap = 'round';
    context.strokeStyle = colour;
    line(context, x0, x1, y, 0.3);
    if (done > 0) line(context, x0, x0 + (x1 - x0) * done, y, 1);
  }
}

/** A cyclic sequence may be left over its end: then the stretch has two pieces. Out of a dead end it runs backwards. */
function stretches(layout, { first, last, back }) {
  if (last >= first || back) return [[first, last]];
  const sequence = layout.timeline.sequenceOf(first);
  return [[first, sequence.first + sequence.count - 1], [sequence.first, last]];
}

function line(context, from, to, y, alpha) {
  context.globalAlpha = alpha;
  context.beginPath();
  context.moveTo(from, y);
  context.lineTo(to, y);
  context.stroke();
  context.globalAlpha = 1;
}

function drawSynthetic(context, layout, { from, to }, colour, done, underWay) {
  const arc = arcBetween(layout, from, to);
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineCap = 'butt';
  context.lineWidth = underWay ? 3 : 2;
  context.setLineDash(underWay ? [3, 2.5] : []);
  context.globalAlpha = done > 0 ? 1 : 0.55;
  context.beginPath();
  trace(context, arc);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
  const tip = underWay && done > 0 && done < 1 ? pointOn(arc, done) : arc.end;
  context.beginPath();
  context.arc(tip.x, tip.y, underWay && done > 0 && done < 1 ? 4 : 2.5, 0, 2 * Math.PI);
  context.fill();
}
