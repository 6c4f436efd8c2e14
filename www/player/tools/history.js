/** What was asked before: documents are never changed, only replaced, so that every earlier one can come back. */

const MOST = 200;

export class History {
  constructor(document) {
    this.reset(document);
  }

  reset(document) {
    this.steps = [document];
    this.at = 0;
    this.merging = null;
  }

  get now() {
    return this.steps[this.at];
  }

  /** @param {string | null} merge changes that follow each other with the same name (a drag) are undone together */
  change(document, merge = null) {
    if (merge !== null && merge === this.merging) {
      this.steps[this.at] = document;
      return;
    }
    this.steps = [...this.steps.slice(Math.max(0, this.at + 2 - MOST), this.at + 1), document];
    this.at = this.steps.length - 1;
    this.merging = merge;
  }

  /** Changes what is there now, not to be undone. */
  amend(part) {
    this.steps[this.at] = { ...this.now, ...part };
  }

  /** Changes all that was asked before and after. @param {(document: object) => object} work */
  rewrite(work) {
    this.steps = this.steps.map(work);
  }

  /** What comes is a change of its own, whatever its name. */
  settle() {
    this.merging = null;
  }

  get canUndo() {
    return this.at > 0;
  }

  get canRedo() {
    return this.at < this.steps.length - 1;
  }

  /** @param {number} by -1 undoes, 1 does again. @returns whether there was such a step */
  step(by) {
    const to = this.at + by;
    if (to < 0 || to >= this.steps.length) return false;
    this.at = to;
    this.merging = null;
    return true;
  }
}
