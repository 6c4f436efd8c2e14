/**
 * Speaks with the WebAssembly player: parses what it says, and keeps it until the clock moves on.
 * Everything here runs without a GPU; a lost device leaves it untouched.
 */

import { Timeline } from './timeline.js';

/** What the bundle says of families; nothing where it makes no sense. */
function familiesOf(player) {
  try {
    const families = JSON.parse(new TextDecoder().decode(player.families()) || '[]');
    return families.filter(({ name, members }) => name.length && members.every(({ frames: [first, last], value }) => first <= last && value < 1e9));
  } catch {
    return [];
  }
}

export class Director {
  /** @param {object} player an instance of the module's `Player` */
  constructor(player) {
    this.player = player;
    this.info = null;
    this.timeline = null;
    this.known = null;
    this.walk = null;
    /** What the last picture showed of an actor with scanned frames. */
    this.shown = undefined;
  }

  /** Reads the bundle's description again: textures and transitions arrive after the first pose. */
  refresh() {
    this.info = JSON.parse(this.player.info());
    this.info.families = familiesOf(this.player);
    this.timeline ??= new Timeline(this.info);
    this.known = null;
  }

  /** @returns {import('../reprise-player').PlayerState} */
  get state() {
    this.known ??= JSON.parse(this.player.state());
    if (this.shown) this.known.shown = this.shown;
    return this.known;
  }

  /** The families, each with the parameter of its member that is performed, or null. */
  get families() {
    const { frame } = this.state;
    return this.info.families.map((family) => ({ ...family, value: family.members.find(({ frames: [first, last] }) => first <= frame && frame <= last)?.value ?? null }));
  }

  /** Advances the clock. @returns {{changed: boolean, events: object[]}} */
  tick(seconds) {
    const changed = this.player.tick(seconds);
    if (changed) this.known = null;
    const events = JSON.parse(this.player.events());
    if (events.length > 0) this.known = null;
    return { changed, events };
  }

  plan(to) {
    return JSON.parse(this.player.plan(to));
  }

  /** The frame of a behaviour that is reached at the least cost. */
  nearest(behaviour) {
    return this.player.nearest(behaviour);
  }

  /** Where the body would stand if the actor went to a frame: the middle of some of its vertices, in its place. */
  arrivalOf(frame) {
    const [heading, x, z] = this.player.arrival(frame);
    const pose = this.player.recorded_pose(frame);
    const middle = [0, 0, 0];
    const step = 3 * Math.max(1, Math.floor(pose.length / 3 / 200));
    let count = 0;
    for (let at = 0; at + 2 < pose.length; at += step, count += 1) {
      for (let axis = 0; axis < 3; axis += 1) middle[axis] += pose[at + axis];
    }
    const [px, y, pz] = middle.map((sum) => sum / Math.max(1, count));
    const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
    return { x: cos * px + sin * pz + x, y, z: cos * pz - sin * px + z };
  }

  /** The walk under way or the last one that was begun, with its cost; the facts show it. */
  goTo(to) {
    this.walk = JSON.parse(this.player.go_to(to));
    this.known = null;
    return this.walk;
  }

  /** Calls a method of the player that changes what it does. */
  tell(method, ...values) {
    this.player[method](...values);
    this.known = null;
  }
}
