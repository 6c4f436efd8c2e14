/**
 * Motion capture that is dropped on the page: the driving module blends from where the actor is into the clip, and from its end
 * back into what was recorded; its frames are made one after the other while they are shown, with rests between them, so that the
 * page never waits. Clips are chips on the stage: a click performs one again.
 */

import { button, h } from '../dom.js';
import { loadDriver } from '../engine.js';
import { PlayerError } from '../errors.js';

/** Milliseconds after which a slice does no more, and of rest after it. */
const SLICE = 6;
const REST = 4;
/** Frames that wait to be shown at most: others are made when these have been shown. */
const AHEAD = 60;
/** The actor leaves for a clip so many seconds later, so often at most, and so many frames after that at most: `LATE` of the driver. */
const AHEAD_SECONDS = 0.5;
const ROUNDS = 3;
const LATE = 3;
/** Nobody waits for more frames than these. */
const MOST_LEFT = 400;
/** Files of more bytes are no clips for a page. */
const MOST_BYTES = 64 << 20;

const rest = (milliseconds = REST) => new Promise((resolve) => setTimeout(resolve, milliseconds));
const wrong = (message) => new PlayerError('bad-argument', message);

export class DriveDriver {
  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    this.driver = null;
    this.knows = null;
    /** What was dropped: its name, its files' names and contents, its chip. */
    this.clips = [];
    this.root = h('div', { class: 'clips', role: 'group', 'aria-label': 'Motion capture' });
    box.core.view.stage.root.parentElement.append(this.root);
    /** What is being read or performed; anything else ends it. */
    this.work = null;
    /** The end of the frames of what is performed. */
    this.feeding = null;
    /** The clip that the driver has, and the one that is performed: how many frames lead home, and which one that is. */
    this.begun = null;
    this.performed = null;
    /** For tests: frames made, and the milliseconds of the longest slice. */
    this.slices = { frames: 0, longest: 0 };
  }

  get player() {
    return this.box.director?.player;
  }

  /** The module that drives. */
  fetch() {
    return loadDriver();
  }

  /** The actor is gone. */
  forget() {
    this.work = null;
    this.feeding = null;
    this.performed = null;
    this.begun = null;
    this.driver?.free();
    this.driver = null;
    this.knows = null;
    this.clips = [];
    this.root.replaceChildren();
  }

  /**
   * Drives the actor by a clip.
   * @param {File | File[] | string} files a .bvh, or an .asf and an .amc; text is that of a .bvh
   * @returns {Promise<{name: string, frames: number, notes: string[]}>} once the actor performs it
   */
  async drive(files, { name } = {}) {
    return this.attempt(async () => {
      const given = typeof files === 'string' ? [new File([files], `${name ?? 'clip'}.bvh`)] : [files].flat();
      if (given.length === 0) throw wrong('No file was given.');
      if (given.some(({ size }) => size > MOST_BYTES)) throw wrong(`${given[0].name} has more than ${MOST_BYTES >> 20} MB: cut it first.`);
      const called = name ?? (given.find((file) => !/\.asf$/i.test(file.name)) ?? given[0]).name.replace(/\.\w+$/, '');
      this.box.core.say(`reading ${called}`, 'waiting');
      const contents = await Promise.all(given.map(async (file) => new Uint8Array(await file.arrayBuffer())));
      return { name: called, names: given.map((file) => file.name), contents };
    });
  }

  /** Performs what `find` gives; whatever was read or performed before is left. */
  async attempt(find) {
    const work = (this.work = Symbol('clip'));
    const going = () => {
      if (this.work !== work || !this.player) throw wrong('Another clip came, or another actor.');
    };
    try {
      if (!this.player) throw new PlayerError('not-loaded', 'The actor has not arrived yet.');
      const clip = await find();
      const module = await this.fetch();
      going();
      await this.learn(module, going);
      // One that is performed is performed to its end.
      await this.feeding;
      going();
      if (this.begun !== clip) {
        this.begun = null;
        clip.frames = this.driver.begin(clip.names, clip.contents);
        clip.notes = this.driver.notes();
        this.begun = clip;
      }
      if (!this.clips.includes(clip)) this.add(clip);
      await this.perform(clip, going);
      this.feeding = this.feed(this.player).catch((error) => this.failed(error, this.work));
      return { name: clip.name, frames: clip.frames, notes: clip.notes };
    } catch (error) {
      this.failed(error, work);
      throw error;
    }
  }

  failed(error, work) {
    if (this.work !== work) return;
    this.work = null;
    if (['bad-argument', 'not-loaded', 'unreachable'].includes(error?.kind)) this.box.core.say(error.message, 'waiting');
    else if (this.box.core.loop) this.box.core.fail(error);
  }

  /** Hands over the recorded poses that the driver asks for. */
  async learn({ Driver }, going) {
    if (this.knows !== this.player) {
      this.driver?.free();
      this.driver = null;
      this.driver = new Driver(this.player.editable(), this.player.rig());
      this.knows = this.player;
    }
    await this.inSlices(going, () => {
      const frame = this.driver.needs();
      if (frame === undefined) return false;
      this.driver.give(this.player.recorded_pose(frame));
      return true;
    });
  }

  /** Calls `more` until it says that there is no more, with rests. */
  async inSlices(going, more) {
    for (;;) {
      const begin = performance.now();
      let goes = true;
      while (goes && performance.now() - begin < SLICE) goes = more();
      this.slices.longest = Math.max(this.slices.longest, performance.now() - begin);
      if (!goes) return;
      await rest();
      going();
    }
  }

  add(clip) {
    const again = () => this.attempt(async () => clip).catch(() => {});
    const play = button(clip.name, `Perform ${clip.name} again`, again);
    const remove = button('×', `Remove ${clip.name}`, () => this.remove(clip), { 'aria-label': `Remove ${clip.name}` });
    clip.chip = h('span', { class: 'clip' }, play, remove);
    this.clips.push(clip);
    this.root.append(clip.chip);
  }

  remove(clip) {
    this.clips = this.clips.filter((one) => one !== clip);
    clip.chip.remove();
  }

  /** Sets off into the clip from where the actor is, once no transition is under way there. */
  async perform(clip, going) {
    const { core, director } = this.box;
    const { player, driver } = this;
    let apart = await this.approach(going);
    while (director.state.transition && player.playing()) {
      await rest(16);
      going();
    }
    if (director.state.transition) director.tell('seek', Math.floor(director.state.frame));
    const [frame, ...place] = player.leaves();
    const poses = this.windows(frame);
    apart ??= driver.aim(...poses);
    const [home, heading, x, z, count] = driver.perform(...poses, ...place);
    core.queue.clear();
    this.box.left();
    director.tell('expect', home, heading, x, z, count);
    this.over();
    this.performed = { clip, home, count };
    core.view.score.setFlag(null);
    core.say(`performs ${clip.name}, then goes on`, 'going');
    core.dispatch('drivestart', { name: clip.name, frames: clip.frames, apart: [[...apart.slice(0, 2)], [...apart.slice(2)]] });
    core.redraw();
  }

  /** The recorded poses of both blends, where the actor leaves from `frame`. */
  windows(frame) {
    const { player, driver } = this;
    const windows = driver.prepare(frame, player.pose_of(frame));
    const poses = ([first, count]) => concat(Array.from({ length: count }, (_, step) => player.pose_of(this.after(first, step))));
    return [poses(windows.slice(0, 2)), poses(windows.slice(2))];
  }

  /** The frame so many steps after another, at most the last one of its sequence. */
  after(frame, steps) {
    const { cyclic, first, count } = this.box.director.timeline.sequenceOf(frame);
    const at = frame - first + steps;
    return first + (cyclic ? at % count : Math.min(at, count - 1));
  }

  /**
   * Edits the clip's ends towards where the actor will be in a moment, makes what the blends need while the actor goes on, and waits until it
   * is there: some times, where it goes elsewhere meanwhile, each from a little farther ahead. How far apart the ends are; nothing where
   * the actor never came there.
   */
  async approach(going) {
    const { director } = this.box;
    const { player, driver } = this;
    for (let round = 1; round <= ROUNDS; round += 1) {
      const { frame, transition } = director.state;
      const here = Math.floor(frame);
      const goes = player.playing() && !transition;
      const to = goes ? this.after(here, Math.ceil(AHEAD_SECONDS * round * director.timeline.fps)) : player.leaves()[0];
      const apart = driver.aim(...this.windows(to));
      await this.inSlices(going, () => driver.make_ahead());
      if (await this.comes(to, going)) return apart;
    }
    return undefined;
  }

  /** Waits while the actor is on its way to a frame; whether it is there, or has just passed it. */
  async comes(to, going) {
    const { director } = this.box;
    const { player } = this;
    for (let least = Infinity; ; ) {
      const { frame, transition } = director.state;
      const here = Math.floor(frame);
      if (transition) {
        if (!player.playing() || player.leaves()[0] !== to) return false;
      } else {
        if (Array.from({ length: LATE + 1 }, (_, late) => this.after(to, late)).includes(here)) return true;
        const left = Array.from({ length: MOST_LEFT }, (_, steps) => this.after(here, steps)).indexOf(to);
        if (left < 0 || left > least || !player.playing()) return false;
        least = left;
      }
      await rest();
      going();
    }
  }

  /** Makes the frames of the performance, some ahead of those that are shown; ends early where the actor is gone. */
  async feed(player) {
    const { driver } = this;
    const nothing = new Float32Array();
    const going = () => {
      if (this.player !== player) throw wrong('Another actor came.');
    };
    const step = () => {
      const [waiting, due] = player.give(nothing, 0, 0, 0, 0);
      if (due === 0 || waiting >= AHEAD) return false;
      player.give(driver.next_frame(), ...driver.worn());
      this.slices.frames += 1;
      return true;
    };
    while (player.give(nothing, 0, 0, 0, 0)[1] > 0) {
      await this.inSlices(going, step);
      this.box.core.loop?.request();
      await rest(50);
      going();
    }
  }

  /** Called once a display frame: tells how far the clip is, and when it is over. */
  step() {
    const { performed } = this;
    if (!performed || !this.player) return;
    const [waiting, due] = this.player.give(new Float32Array(), 0, 0, 0, 0);
    const { clip, count } = performed;
    clip.chip.style.setProperty('--done', waiting + due === 0 ? '0%' : `${Math.round(100 - (100 * (waiting + due)) / count)}%`);
    if (waiting + due === 0) this.over();
  }

  over() {
    const { performed } = this;
    this.performed = null;
    if (performed) this.box.core.dispatch('driveend', { name: performed.clip.name, frame: performed.home });
  }
}

/** Lists of numbers as one. */
function concat(lists) {
  const all = new Float32Array(lists.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const list of lists) {
    all.set(list, at);
    at += list.length;
  }
  return all;
}
