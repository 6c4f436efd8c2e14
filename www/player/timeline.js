/** The capture's sequences as time: which sequence a frame belongs to, and where its thumbnails are taken. */

/** Seconds between thumbnails. */
const THUMBNAIL_STEP = 0.5;

export class Timeline {
  /** @param {{fps: number, frames: number, sequences: {name: string, first: number, count: number}[]}} info */
  constructor(info) {
    this.fps = info.fps;
    this.frames = info.frames;
    this.sequences = info.sequences;
  }

  /** The index of the sequence that holds `frame`; fractions belong to the frame before. */
  indexOf(frame) {
    const whole = Math.floor(frame);
    const found = this.sequences.findIndex(({ first, count }) => whole >= first && whole < first + count);
    return found < 0 ? 0 : found;
  }

  sequenceOf(frame) {
    return this.sequences[this.indexOf(frame)];
  }

  /** `frame` moved by `by` frames, kept inside its sequence. */
  step(frame, by) {
    const { first, count } = this.sequenceOf(frame);
    return Math.min(first + count - 1, Math.max(first, Math.round(frame) + by));
  }

  /** The frame at the same time in the sequence `by` places further on. */
  across(frame, by) {
    const from = this.indexOf(frame);
    const to = Math.min(this.sequences.length - 1, Math.max(0, from + by));
    const { first, count } = this.sequences[to];
    return first + Math.min(count - 1, Math.round(frame) - this.sequences[from].first);
  }

  /** Frames of a sequence that are shown as thumbnails: the middle of every half second. */
  thumbnails(index) {
    const { first, count } = this.sequences[index];
    const step = THUMBNAIL_STEP * this.fps;
    const slots = Math.max(1, Math.round(count / step));
    return Array.from({ length: slots }, (_, slot) => first + Math.min(count - 1, Math.floor(((slot + 0.5) * count) / slots)));
  }
}
