/**
 * Keeps the player's edited frames as the document of edits has them: asks the editing module for one frame after the other,
 * those around the actor first, with rests between them, so that the page never waits. What is dragged is shown at once.
 */

import { loadEditor } from '../engine.js';
import { PlayerError } from '../errors.js';
import { documentOf } from './request.js';

/** Milliseconds after which a slice makes no further frame, and of rest after it. */
const SLICE = 4;
const REST = 6;

export class EditDriver {
  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    /** The module once it is there, its editor, and the player that told it what it knows. */
    this.module = null;
    this.editor = null;
    this.knows = null;
    /** The edits that were taken last, and what is wrong with them. */
    this.taken = [];
    this.trouble = '';
    /** By frame that the player has edited: by which edits. @type {Map<number, string>} */
    this.made = new Map();
    /** Frames still to be made, the nearest first, and by which edits. @type {[number, string][]} */
    this.due = [];
    /** Edits that are to come to rest before frames are made of them. @type {number[]} */
    this.restless = [];
    this.waiting = [];
    this.held = false;
    /** For tests: frames made, and the milliseconds of the longest slice. */
    this.slices = { frames: 0, longest: 0 };
  }

  get player() {
    return this.box.director?.player;
  }

  /** Sees to it that the module comes. @returns {Promise<void>} rejected where it does not; that is told on the page, too */
  fetch() {
    const coming = loadEditor().then(
      (module) => {
        this.module = module;
      },
      (error) => {
        if (this.box.core.loop) this.box.core.fail(error);
        throw error;
      },
    );
    coming.catch(() => {});
    return coming;
  }

  /** Whether edits can be checked and made at once: the module and the whole actor are there. */
  get ready() {
    if (!this.module || !this.player) return false;
    if (this.knows !== this.player) this.open();
    return true;
  }

  open() {
    const { player } = this;
    this.forget();
    this.editor = new this.module.Editor(player.editable(), player.rig(), player.learned());
    this.knows = player;
    this.give();
  }

  /** Hands over the recorded poses that the editor asks for. */
  give() {
    for (const frame of this.editor.needs()) this.editor.give(frame, this.player.recorded_pose(frame));
  }

  /** The actor is gone. */
  forget() {
    clearTimeout(this.timer);
    this.timer = null;
    this.editor?.free();
    this.editor = null;
    this.knows = null;
    this.held = false;
    this.taken = [];
    this.due = [];
    this.made.clear();
    this.settle(new PlayerError('not-loaded', 'The actor is gone.'));
  }

  /**
   * Takes a document that came from outside.
   * @throws what is wrong with it, as a sentence; nothing is changed then
   */
  check(document) {
    if (!document || typeof document !== 'object') throw new PlayerError('bad-argument', 'These are no edits: a document with a version and a list is wanted.');
    this.editor.replace(JSON.stringify(document));
    // What stands there now belongs to no list that was taken: the one that follows is compared anew.
    this.taken = [];
  }

  /** The edits are these from now on. */
  take(edits) {
    if (edits === this.taken || this.held || (edits.length === 0 && this.taken.length === 0 && this.made.size === 0)) return;
    if (!this.ready) {
      this.fetch().then(() => this.box.director && this.take(this.box.document.edits), () => {});
      return;
    }
    this.taken = edits;
    this.trouble = '';
    try {
      this.editor.replace(JSON.stringify(documentOf(edits)));
      this.give();
    } catch (error) {
      this.failed(error);
      return;
    }
    this.plan(edits);
    this.box.core.dispatch('editchange', { edits: documentOf(edits) });
  }

  /** Which frames are to be made anew. */
  plan(edits) {
    const wanted = new Map();
    edits.forEach((edit, index) => {
      const text = JSON.stringify(edit);
      for (const frame of this.editor.reached(index)) wanted.set(frame, `${wanted.get(frame) ?? ''}${text}`);
    });
    for (const frame of this.made.keys()) {
      if (wanted.has(frame)) continue;
      this.player.set_edited(frame, []);
      this.made.delete(frame);
    }
    const here = this.box.director.state.frame;
    this.due = [...wanted].filter(([frame, by]) => this.made.get(frame) !== by).sort(([a], [b]) => Math.abs(a - here) - Math.abs(b - here));
    this.box.core.redraw();
    this.restless = this.due.length > 0 ? [...edits.keys()] : [];
    if (this.due.length > 0) this.pump();
    else this.settle();
  }

  pump() {
    this.timer ??= setTimeout(() => {
      this.timer = null;
      if (this.step()) this.pump();
    }, REST);
  }

  /** One slice. @returns whether there is more to do */
  step() {
    const { player, editor } = this;
    if (!player || !editor || this.held) return false;
    const begin = performance.now();
    try {
      do {
        if (this.restless.length > 0) {
          if (editor.settle(this.restless[0])) this.restless.shift();
          continue;
        }
        const [frame, by] = this.due.shift() ?? [];
        if (frame === undefined) break;
        player.set_edited(frame, editor.make(frame, player.recorded_pose(frame)));
        this.made.set(frame, by);
        this.slices.frames += 1;
      } while (performance.now() - begin < SLICE);
    } catch (error) {
      this.failed(error);
      return false;
    }
    this.slices.longest = Math.max(this.slices.longest, performance.now() - begin);
    this.box.core.redraw();
    if (this.due.length > 0) return true;
    this.settle();
    return false;
  }

  /** All frames are there. */
  settle(error = null) {
    const { waiting } = this;
    this.waiting = [];
    for (const { resolve, reject } of waiting) {
      if (error) reject(error);
      else resolve({ notes: this.notes });
    }
    this.told?.();
  }

  failed(error) {
    this.due = [];
    if (['bad-argument', 'not-loaded'].includes(error?.kind)) {
      this.trouble = error.message;
      this.box.core.say(error.message, 'waiting');
    } else this.box.core.fail(error);
    this.settle(error);
  }

  /** @returns {Promise<{notes: string[]}>} once all frames are as the document has them */
  done() {
    const { promise, resolve, reject } = Promise.withResolvers();
    promise.catch(() => {});
    if (this.trouble) reject(new PlayerError('bad-argument', this.trouble));
    else if (this.due.length === 0 && this.taken === this.box.document.edits) resolve({ notes: this.notes });
    else this.waiting.push({ resolve, reject });
    return promise;
  }

  /** What is not as it was wanted, in sentences. */
  get notes() {
    return this.editor?.notes() ?? [];
  }

  // ---- dragging -------------------------------------------------------------------------------------------------

  /** Takes hold of an edit of the document, whose frames stay as they are until it is let go. */
  grab(edits, index) {
    clearTimeout(this.timer);
    this.timer = null;
    this.editor.replace(JSON.stringify(documentOf(edits)));
    this.give();
    this.editor.grab(index);
    this.held = true;
  }

  /** Drags its handles to these places, and shows its frame so. @param {number[]} to x, y and z of each, as recorded */
  drag(frame, to) {
    this.player.set_edited(frame, this.editor.drag(Float32Array.from(to)));
    // By no document: it is made anew once it is let go.
    this.made.set(frame, 'held');
  }

  release() {
    this.held = false;
    this.taken = [];
    this.take(this.box.document.edits);
  }
}
