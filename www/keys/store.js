/** The pairs that have been chosen, which of them is selected, and every earlier state of them. Pairs are replaced, never changed. */

import { groupOf } from './rules.js';

const MOST = 500;

/** Tells with a `change` event that pairs or the selection have changed. */
export class Store extends EventTarget {
  constructor() {
    super();
    this.steps = [{ pairs: [], tail: [] }];
    this.at = 0;
    this.merging = null;
    this.chosen = null;
    /** What was last written to a file or read from one. */
    this.kept = this.steps[0];
    this.ids = 0;
  }

  get file() {
    return this.steps[this.at];
  }

  get pairs() {
    return this.file.pairs;
  }

  /** The selected pair, or null. */
  get selected() {
    return this.pairs.find(({ id }) => id === this.chosen) ?? null;
  }

  /** Whether there is something that no file holds. */
  get unsaved() {
    return this.file !== this.kept && (this.pairs.length > 0 || this.kept.pairs.length > 0);
  }

  select(id) {
    if (this.chosen === id) return;
    this.chosen = id;
    this.merging = null;
    this.tell();
  }

  /** What a file holds, in place of all pairs. */
  replace({ pairs, tail }) {
    this.chosen = null;
    this.change({ pairs: pairs.map((pair) => ({ ...pair, id: (this.ids += 1) })), tail });
    this.settle();
  }

  /** Adds a pair behind the one of its group that comes before it, and selects it; one that is there already is selected. @returns whether it is new */
  add(pair) {
    const there = this.pairs.find((one) => groupOf(one) === groupOf(pair) && one.fromFrame === pair.fromFrame && one.toFrame === pair.toFrame);
    if (there) {
      this.select(there.id);
      return false;
    }
    const before = this.pairs.findLastIndex((one) => groupOf(one) === groupOf(pair) && one.toFrame <= pair.toFrame);
    const after = this.pairs.findIndex((one) => groupOf(one) === groupOf(pair));
    const at = before >= 0 ? before + 1 : after >= 0 ? after : this.pairs.length;
    const added = { comments: [], ...pair, id: (this.ids += 1) };
    this.chosen = added.id;
    this.change({ ...this.file, pairs: this.pairs.toSpliced(at, 0, added) });
    return true;
  }

  /** @param {string | null} merge changes that follow each other with the same name (a drag) are undone together */
  edit(id, part, merge = null) {
    const pairs = this.pairs.map((pair) => (pair.id === id ? { ...pair, ...part } : pair));
    this.change({ ...this.file, pairs }, merge);
  }

  remove(id) {
    const at = this.pairs.findIndex((pair) => pair.id === id);
    if (at < 0) return;
    const pairs = this.pairs.toSpliced(at, 1);
    if (this.chosen === id) this.chosen = (pairs[at] ?? pairs[at - 1])?.id ?? null;
    this.change({ ...this.file, pairs });
  }

  change(file, merge = null) {
    if (merge !== null && merge === this.merging) {
      this.steps[this.at] = file;
    } else {
      this.steps = [...this.steps.slice(Math.max(0, this.at + 2 - MOST), this.at + 1), file];
      this.at = this.steps.length - 1;
      this.merging = merge;
    }
    this.tell();
  }

  /** What comes is a change of its own, whatever its name. */
  settle() {
    this.merging = null;
  }

  /** All that there is now is in a file. */
  keep() {
    this.kept = this.file;
    this.merging = null;
    this.tell();
  }

  get canUndo() {
    return this.at > 0;
  }

  get canRedo() {
    return this.at < this.steps.length - 1;
  }

  /** @param {number} by -1 undoes, 1 does again */
  step(by) {
    const to = this.at + by;
    if (to < 0 || to >= this.steps.length) return;
    this.at = to;
    this.merging = null;
    this.tell();
  }

  tell() {
    this.dispatchEvent(new Event('change'));
  }
}
