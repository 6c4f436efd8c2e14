/**
 * Drives the search in slices of a few milliseconds with rests between them, so that the page never waits for it: about one
 * slice a display frame, and more where the display is slow.
 */

import { loadSearch } from '../engine.js';
import { PlayerError } from '../errors.js';
import { readAnswer } from './answer.js';
import { followersOf } from './request.js';

/** Milliseconds of work in a slice, and of rest after it. */
const SLICE = 4;
const REST = 8;
/** The same where somebody waits for the answer, or an endless walk is about to end. */
const HURRIED = { slice: 8, rest: 4 };
/** Milliseconds of searching before the first answer is shown, and between two. */
const FIRST_LOOK = 60;
const LOOK_AGAIN = 240;
/** Milliseconds of searching, by the clock, after which whoever waits sets off with the best walk so far. */
const PATIENCE = 500;
/** Seconds left of an endless walk when the next part of it is searched for. */
const AHEAD = 20;
/** Seconds left of it when that becomes urgent. */
const URGENT = 10;

/**
 * Whether the actor may leave. Paths and places have a whole walk from the first answer on that has any; the answers of key poses, queues
 * and the like are whole only in the end.
 */
function isReady({ answer, done, polishing, begun, request: { target } }, now) {
  return answer !== null && !polishing && (done || Boolean(target.path ?? target.place) && now - begun > PATIENCE);
}

export class SearchDriver {
  /**
   * @param {import('../core.js').Core} core
   * @param {(answer: object | null, trouble: string | null) => void} found hears of every answer, and of what is wrong
   */
  constructor(core, found) {
    this.core = core;
    this.found = found;
    this.task = null;
    this.waiting = null;
    this.endless = null;
    /** The module that searches once it is there, its searcher, and the player that told it what it knows. */
    this.module = null;
    this.searcher = null;
    this.knows = null;
    /** For tests: slices of work, and the milliseconds of the longest. */
    this.slices = { count: 0, longest: 0 };
  }

  get player() {
    return this.core.director?.player;
  }

  /** Sees to it that the module comes. @returns {Promise<void>} rejected where it does not; that is told on the page, too */
  fetch() {
    const coming = loadSearch().then(
      (module) => {
        this.module = module;
      },
      (error) => {
        if (this.core.loop) this.failed(error);
        throw error;
      },
    );
    // Not everybody waits for it.
    coming.catch(() => {});
    return coming;
  }

  /**
   * Whether a request makes sense without knowing the actor; the module has to be there.
   * @throws what is wrong with it
   */
  check(request) {
    this.module.check_request(JSON.stringify(request) ?? 'null');
  }

  /** The actor is gone. */
  forget() {
    this.stop();
    this.searcher?.free();
    this.searcher = null;
    this.knows = null;
  }

  /** @param {object} request @param {'here' | 'anywhere' | 'end'} origin */
  start(request, origin = 'here') {
    this.drop();
    this.task = { request, origin, text: JSON.stringify(request), followers: Uint32Array.from(followersOf(request)), begun: 0, looked: 0, answer: null, done: false, polishing: false };
    if (this.module) this.pump();
    else this.fetch().then(() => this.task && this.pump(), () => {});
  }

  pump() {
    this.timer ??= setTimeout(() => {
      this.timer = null;
      if (this.step()) this.pump();
    }, this.isUrgent(this.task) ? HURRIED.rest : REST);
  }

  /** Ends the search; a walk under way goes on. */
  stop() {
    this.drop();
    this.disappoint('Something else was asked for.');
  }

  /** Whoever waits for the actor to leave waits in vain. */
  disappoint(message) {
    this.waiting?.reject(new PlayerError('bad-argument', message));
    this.waiting = null;
  }

  drop() {
    this.task = null;
    clearTimeout(this.timer);
    this.timer = null;
    if (!this.endless) this.searcher?.stop();
  }

  /** One slice. @returns whether there is more to do */
  step() {
    const { task, player, module } = this;
    if (!task || !player || !module) return false;
    try {
      const begin = performance.now();
      const more = this.work(task, player, begin);
      this.slices.count += 1;
      this.slices.longest = Math.max(this.slices.longest, performance.now() - begin);
      return more;
    } catch (error) {
      this.failed(error);
      return false;
    }
  }

  work(task, player, now) {
    if (task.done && !task.polishing) return false;
    if (!task.begun) {
      if (this.isReadyFor(task, player)) this.begin(task, player, now);
      return true;
    }
    const slice = this.isUrgent(task) ? HURRIED.slice : SLICE;
    if (task.polishing) {
      task.polishing = !this.searcher.polish(slice);
      if (!task.polishing) this.look(task, now);
    } else {
      task.done = this.searcher.advance(slice) !== 'running';
      // What the answer takes besides is worked on in slices, too.
      task.polishing = task.done || (task.looked ? now - task.looked > LOOK_AGAIN : now - task.begun > FIRST_LOOK);
    }
    if (this.waiting && isReady(task, now)) this.leave();
    else if (task.done && !task.polishing && task.origin === 'end') this.goOn();
    return !task.done || task.polishing;
  }

  /** Tells the searcher what it has to know, a slice at a time. */
  isReadyFor({ followers }, player) {
    if (this.knows !== player) {
      const known = player.known(SLICE);
      if (!known) return false;
      this.searcher?.free();
      this.searcher = new this.module.Searcher(known, JSON.stringify(this.core.director.info.families));
      this.knows = player;
    }
    if (!this.searcher.read(SLICE)) return false;
    if (!this.searcher.follows(followers)) {
      const middles = player.middles(followers, SLICE);
      if (!middles) return false;
      this.searcher.follow(followers, middles);
    }
    return this.searcher.prepare(SLICE);
  }

  begin(task, player, now) {
    this.searcher.begin(task.text, task.origin, task.origin === 'here' ? player.leaves() : []);
    task.begun = now;
  }

  look(task, now) {
    task.looked = now;
    const answer = readAnswer(this.searcher.answer(), this.core.director.info.fps);
    // To stay may be the best walk in the end, but is none to show on the way; nor is a walk whose odds are being evened out.
    if (!task.done && (answer.legs.length === 0 || answer.wander?.objective === null)) return;
    task.answer = answer;
    if (task.origin !== 'end') this.found(task.answer, null);
  }

  failed(error) {
    const { waiting } = this;
    this.task = null;
    this.waiting = null;
    // What has not arrived yet, or makes no sense, is a sentence; the rest is ours to repair.
    if (['bad-argument', 'not-loaded', 'unreachable'].includes(error?.kind)) this.found(null, error.message);
    else this.core.fail(error);
    waiting?.reject(error);
  }

  /**
   * Sets off as soon as there is a walk that does what is asked.
   * @returns {Promise<object>} the answer, once the actor has left
   */
  go(request, origin = 'here') {
    const { core } = this;
    const same = this.task && this.task.text === JSON.stringify(request) && this.task.origin === origin && !this.endless;
    const { promise, resolve, reject } = Promise.withResolvers();
    this.disappoint('Something else was asked for.');
    this.waiting = { resolve, reject };
    // Who waits may not want to hear of trouble: it is said on the page.
    promise.catch(() => {});
    this.endless = null;
    if (same && isReady(this.task, performance.now())) this.leave();
    else if (!same) this.restart(request, origin);
    return promise;
  }

  /** The walk begins where the actor stands: it has to wait there. */
  restart(request, origin) {
    this.core.director.tell('pause');
    this.start(request, origin);
  }

  leave() {
    const { core, task, player, waiting } = this;
    if (task.answer.legs.length === 0) {
      this.failed(new PlayerError('unreachable', task.answer.notes[0] ?? 'Nothing leads there from here.'));
      return;
    }
    let walk;
    try {
      walk = JSON.parse(player.set_off(this.searcher.walk(), task.origin === 'anywhere'));
    } catch (error) {
      if (error.kind !== 'unreachable') throw error;
      // The actor has moved on since the search began.
      this.restart(task.request, task.origin);
      return;
    }
    this.waiting = null;
    task.done = true;
    if (task.request.target.wander) this.endless = { request: task.request, part: 0 };
    this.task = null;
    core.left(walk, task.answer);
    waiting.resolve(task.answer);
  }

  // ---- endless walks --------------------------------------------------------------------------------------------

  /** Called once a display frame: searches for the next part of an endless walk before this one is over. */
  lookAhead() {
    const { state } = this.core.director ?? {};
    if (!this.endless || this.task || !state || state.target === null || state.remaining_seconds > AHEAD) return;
    this.seekNext();
  }

  seekNext() {
    this.endless.part += 1;
    const { request, part } = this.endless;
    this.start({ ...request, seed: (request.seed ?? 0) + part }, 'end');
  }

  isUrgent(task) {
    const { state } = this.core.director ?? {};
    if (!task || !state) return false;
    const ends = state.target === null || state.remaining_seconds < URGENT;
    return this.waiting !== null || (task.origin === 'end' ? ends : task.answer === null);
  }

  goOn() {
    const { core, task, player } = this;
    this.task = null;
    core.director.known = null;
    if (task.answer === null || task.answer.legs.length === 0) this.endless = null;
    else if (!player.go_on(this.searcher.walk())) this.goOnLate(task);
  }

  /** The actor has arrived before the next part was found, and waits where that begins. */
  goOnLate({ answer }) {
    const { core, player, endless } = this;
    try {
      core.left(JSON.parse(player.set_off(this.searcher.walk(), false)), answer);
    } catch (error) {
      if (error.kind !== 'unreachable') throw error;
      this.go(endless.request);
    }
  }

  /** The actor was sent somewhere else. */
  left() {
    this.endless = null;
    this.disappoint('The actor was sent somewhere else.');
  }

  happened(type) {
    // An endless walk is over only where nothing leads on. A page that was away for as long as the walk lasted looks on late.
    if (type === 'arrive' && this.endless && !this.task) this.seekNext();
  }
}
