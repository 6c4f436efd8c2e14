/**
 * Where everything in the score lies: strips at one time scale, packed into rows like words into lines, each row with
 * room above it for the arcs. Pure arithmetic in CSS pixels; the score and the arcs only read it.
 */

export const THUMBNAIL = { width: 36, height: 48 };
const ROW_GAP = 22;
const STRIP_GAP = 20;
const LABEL_GAP = 8;
const SCALES = { most: 76, least: 38, step: 2 };

/**
 * @param {import('./timeline.js').Timeline} timeline
 * @param {{width: number, height: number, labels: number[]}} room the space, and the width of every label
 */
export function layoutScore(timeline, room) {
  const fits = longestScale(timeline, room);
  let plan = null;
  for (let scale = Math.min(SCALES.most, fits); ; scale -= SCALES.step) {
    plan = pack(timeline, room, Math.max(scale, Math.min(SCALES.least, fits)));
    if (plan.height <= room.height || scale <= SCALES.least) break;
  }
  return new ScoreLayout(timeline, plan);
}

/** The largest scale, in pixels a second, at which the longest sequence still fits into one row. */
function longestScale(timeline, { width, labels }) {
  const length = Math.max(60, width - Math.max(...labels) - LABEL_GAP);
  return Math.min(...timeline.sequences.map(({ count }) => (length * timeline.fps) / count));
}

function pack(timeline, { width, labels }, scale) {
  const widest = Math.max(...labels);
  const strips = [];
  let x = 0;
  let y = ROW_GAP;
  timeline.sequences.forEach(({ count }, index) => {
    const length = (count * scale) / timeline.fps;
    if (x > 0 && x + labels[index] + LABEL_GAP + length > width + 0.5) {
      x = 0;
      y += THUMBNAIL.height + ROW_GAP;
    }
    // The first strips of all rows begin at one line.
    const label = (x === 0 ? widest : labels[index]) + LABEL_GAP;
    strips.push({ index, labelX: x, x: x + label, y, width: length, height: THUMBNAIL.height });
    x += label + length + STRIP_GAP;
  });
  return { scale, strips, height: y + THUMBNAIL.height + 4 };
}

export class ScoreLayout {
  constructor(timeline, { scale, strips, height }) {
    this.timeline = timeline;
    /** CSS pixels a second. */
    this.scale = scale;
    this.strips = strips;
    this.height = height;
    /** Space above a row that belongs to its arcs. */
    this.gap = ROW_GAP;
  }

  stripOf(frame) {
    return this.strips[this.timeline.indexOf(frame)];
  }

  /** The x of a frame's middle. */
  xOf(frame) {
    const strip = this.stripOf(frame);
    const { first } = this.timeline.sequences[strip.index];
    const x = strip.x + ((frame - first + 0.5) * this.scale) / this.timeline.fps;
    return Math.min(strip.x + strip.width, Math.max(strip.x, x));
  }

  /** The frame under a point, or -1 outside every strip. A little slack above makes small rows easy to hit. */
  frameAt(x, y) {
    const strip = this.strips.find(
      (one) => x >= one.x && x < one.x + one.width && y >= one.y - ROW_GAP / 2 && y < one.y + one.height,
    );
    return strip ? this.frameIn(strip.index, x) : -1;
  }

  /** The frame of one sequence nearest to an x, however far away that is. */
  frameIn(index, x) {
    const { first, count } = this.timeline.sequences[index];
    const frame = Math.floor(((x - this.strips[index].x) * this.timeline.fps) / this.scale);
    return first + Math.min(count - 1, Math.max(0, frame));
  }

  /** Thumbnails of a sequence that have room beside each other at this scale. */
  shown(index) {
    const all = this.timeline.thumbnails(index);
    const apart = this.strips[index].width / all.length;
    const stride = Math.max(1, Math.ceil((THUMBNAIL.width - 12) / apart));
    return all.filter((_, slot) => slot % stride === Math.floor((stride - 1) / 2) || all.length <= 1);
  }
}
