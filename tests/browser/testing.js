/**
 * What the browser tests may look at and do: importing this gives every player a `testing`. Only the tests' own server has
 * this file; pages have no such thing.
 */

/** The player's door for this file (see `www/player/element.js`). */
const INSIDE = Symbol.for('reprise.inside');

class Testing {
  /** @param {import('../../www/player/core.js').Core} core */
  constructor(core) {
    this.core = core;
  }

  get player() {
    return this.core.director.player;
  }

  get stage() {
    return this.core.view.stage.stage;
  }

  /** Lets time pass without drawing. */
  tick(seconds) {
    this.core.director.tick(seconds);
  }

  /** The pose as drawn, in the world: three numbers a vertex. */
  pose() {
    return Array.from(this.player.pose());
  }

  /** A frame as recorded, where the capture has it. */
  recordedPose(frame) {
    return Array.from(this.player.recorded_pose(frame));
  }

  /** Heading, x and z of a frame if the actor goes there from the present. */
  arrival(frame) {
    return Array.from(this.player.arrival(frame));
  }

  /** Searches for walks to poses and behaviours: how many when this was asked before, and now. */
  plans() {
    const before = this.planned ?? 0;
    this.planned = this.player.plans();
    return { before, now: this.planned };
  }

  /** Keeps to one way of rebuilding the texture, waits for it at the present moment, and reads it: RGBA, and its width. */
  async texture(setting) {
    const { stage, player } = this;
    stage.texture_setting(setting);
    for (let quiet = 0; quiet < 3; quiet = player.refine(50) || stage.dress(player) ? 0 : quiet + 1) {
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
    return Array.from(await stage.read_texture());
  }

  adapter() {
    return JSON.parse(this.stage.adapter());
  }

  /** Takes the device away, as a driver's crash would. */
  loseDevice() {
    this.stage.lose();
  }

  lost() {
    return this.stage?.lost() ?? true;
  }

  /** How the search gets on: slices of work, the milliseconds of the longest, and whether it is at work. */
  search() {
    const { search } = this.core.toolbox;
    return { ...search.slices, running: Boolean(search.task && !search.task.done) };
  }

  /** The module that searches, once it is there. */
  async searching() {
    await this.core.toolbox.search.fetch();
    return this.core.toolbox.search.module;
  }

  /** The module that edits, once it is there. */
  async editing() {
    const { toolbox } = this.core;
    await toolbox.fetch();
    await toolbox.kit.edits.fetch();
    return toolbox.kit.edits.module;
  }

  /** The driver of this actor, once it knows what it has to. */
  async driving() {
    const { toolbox } = this.core;
    await toolbox.fetch();
    const { drives } = toolbox.kit;
    await drives.learn(await drives.fetch(), () => {});
    return drives.driver;
  }

  /** Searches on without the page's rests, so many slices at most: where others have the processor, rests are all that there is. */
  searchOn(slices) {
    const { search } = this.core.toolbox;
    for (let slice = 0; slice < slices && search.task && !search.task.done; slice += 1) search.step();
  }

  /** Whether an actor is being loaded, or has been. */
  loads() {
    return this.core.session !== null;
  }

  /** Whether there is nothing to do in the next display frame. */
  rests() {
    return this.core.loop.handle === 0;
  }

  /** How the edits get on: whether they can be made, frames still to be made, frames made, the longest slice, what is held. */
  edits() {
    const { edits } = this.core.toolbox.kit ?? {};
    return { ready: Boolean(edits?.editor), due: edits?.due.length ?? 0, held: edits?.held ?? false, made: edits?.made.size ?? 0, ...edits?.slices };
  }

  /** A frame as walks show it, edited where it is, in the place where it was recorded. */
  framePose(frame) {
    return Array.from(this.player.pose_of(frame));
  }

  /** Where on the screen a point of the world is. */
  placeOfPoint(x, y, z) {
    const { left, top } = this.core.view.stage.root.getBoundingClientRect();
    const [cssX, cssY, visible] = this.stage.project(x, y, z);
    return { x: left + cssX, y: top + cssY, visible: visible > 0 };
  }

  /** Where on the screen a place on the ground is. */
  placeOnGround(x, z) {
    const { stage } = this.core.view;
    const { left, top } = stage.root.getBoundingClientRect();
    const seen = stage.seen(x, z);
    return { x: left + seen.x, y: top + seen.y, visible: seen.visible };
  }

  /** Frames whose poses are drawn as ghosts. */
  ghosts() {
    return this.core.view.stage.ghosts;
  }

  /** The frame whose texture as captured is worn, or -1. */
  looks() {
    return { worn: this.core.view.looks.worn };
  }

  thumbnails() {
    const { shelf } = this.core.view.score;
    return { drawn: shelf.pictures.size, complete: shelf.complete };
  }

  /** Where on the screen a frame's place in the score is, scrolled into view. */
  placeOf(frame) {
    const { score } = this.core.view;
    const strip = score.layout.stripOf(frame);
    score.strips[strip.index].root.scrollIntoView({ block: 'nearest' });
    const { left, top } = score.sheet.getBoundingClientRect();
    return { x: left + score.layout.xOf(frame), y: top + strip.y + strip.height / 2 };
  }

  /** Where on the screen a ghost's middle is. */
  placeOfGhost(frame) {
    const { director, view } = this.core;
    const { x, y, z } = director.arrivalOf(frame);
    const { left, top } = view.stage.root.getBoundingClientRect();
    const [cssX, cssY, visible] = this.stage.project(x, y, z);
    return { x: left + cssX, y: top + cssY, visible: visible > 0 };
  }

  /** Screenshots of a canvas that has just been drawn once can be blank: this draws on and on, until it is told to stop. */
  keepDrawing(on = true) {
    const again = () => {
      if (!this.drawing) return;
      this.core.draw();
      requestAnimationFrame(again);
    };
    const began = on && !this.drawing;
    this.drawing = on;
    if (began) again();
  }

  /** Draws, and tells what of an actor with scanned frames is shown; null while one gives way to the other. */
  shown() {
    this.core.draw();
    this.core.loop.request();
    return [0, 1].includes(this.stage.scan_shown()) ? this.core.director.shown : null;
  }

  /** Draws, and tells which share of the picture has colours for which `is` holds. */
  async share(is) {
    this.core.draw();
    const pixels = await this.stage.read_pixels();
    let count = 0;
    for (let at = 0; at < pixels.length; at += 4) count += Number(is(pixels[at], pixels[at + 1], pixels[at + 2]));
    return (4 * count) / pixels.length;
  }

  /**
   * Draws the moment as scanned and on the mesh that all frames were brought onto, both once they are there, and then as the one gives way
   * to the other in so many `pictures`. Numbers of pixels: all, what the actor covers in either, whose colour differs by more than 8 of 255, of
   * those that the actor covers, and that only one of both covers; of a picture and the next one (`step`: most of the picture, and of the actor).
   */
  async switched(pictures = 12) {
    const { looks } = this.core.view;
    const both = [];
    for (const way of ['ours', 'template']) {
      looks.choose(way);
      if (this.core.director.info.appearance) await this.texture('poisson');
      while (this.shown() !== (way === 'ours' ? 'scan' : 'template')) await new Promise((resolve) => setTimeout(resolve, 20));
      this.core.draw();
      both.push(await this.stage.read_pixels());
    }
    looks.choose('ours');
    // As the registered mesh carries it: what the page shows next where a transition leaves from here, or showed last where one arrives.
    this.stage.set_options('{"scan_carried":true}');
    this.core.draw();
    const carried = this.stage.scan_carried() ? await this.stage.read_pixels() : null;
    this.stage.set_options('{"scan_carried":false}');
    const [scan, template] = both;
    const { most, apart } = this.constructor;
    const empty = scan.subarray(0, 3);
    const counts = { pixels: scan.length / 4, covered: 0, changed: 0, within: 0, outline: 0, cut: 0, ofCut: 0 };
    for (let at = 0; at < scan.length; at += 4) {
      const [inScan, inTemplate] = [scan, template].map((pixels) => apart(pixels, at, empty, 0) > 60);
      const differs = apart(scan, at, template, at) > most;
      const cut = !carried || apart(scan, at, carried, at) > most;
      counts.cut += Number(cut);
      counts.ofCut += Number(cut && inScan);
      counts.covered += Number(inScan || inTemplate);
      counts.changed += Number(differs);
      counts.within += Number(differs && (inScan || inTemplate));
      counts.outline += Number(differs && inScan !== inTemplate);
    }
    counts.step = 0;
    let before = scan;
    for (let k = pictures - 1; k >= 0; k -= 1) {
      const after = k ? await this.mixed(k / pictures) : template;
      let changed = 0;
      for (let at = 0; at < scan.length; at += 4) changed += Number(apart(before, at, after, at) > most);
      counts.step = Math.max(counts.step, changed);
      before = after;
    }
    return counts;
  }

  /** The picture where so much of a scan is seen. */
  async mixed(share) {
    this.stage.set_options(JSON.stringify({ scan_share: share }));
    this.core.draw();
    const pixels = await this.stage.read_pixels();
    this.stage.set_options('{"scan_share":null}');
    return pixels;
  }

  static most = 8;

  /** The largest difference of two pixels in any channel. */
  static apart(one, at, other, where) {
    return Math.max(...[0, 1, 2].map((channel) => Math.abs(one[at + channel] - other[where + channel])));
  }

  /** Draws, and tells the middle of what differs from the picture's corner, in pixels. */
  async middle() {
    this.core.draw();
    const pixels = await this.stage.read_pixels();
    const { width } = this.core.view.stage.canvas;
    const [sum, count] = [[0, 0], [0]];
    for (let at = 0; at < pixels.length; at += 4) {
      if (![0, 1, 2].some((channel) => Math.abs(pixels[at + channel] - pixels[channel]) > 60)) continue;
      sum[0] += (at / 4) % width;
      sum[1] += Math.floor(at / 4 / width);
      count[0] += 1;
    }
    return sum.map((value) => value / Math.max(1, count[0]));
  }

  /** Draws, and reads the picture back: its size, its corner and how much of it differs from the corner's colour, and its mean colour. */
  async picture() {
    this.core.draw();
    const pixels = await this.stage.read_pixels();
    const { width, height } = this.core.view.stage.canvas;
    const differs = (at) => [0, 1, 2].some((channel) => Math.abs(pixels[at + channel] - pixels[channel]) > 24);
    let drawn = 0;
    const mean = [0, 0, 0];
    for (let at = 0; at < pixels.length; at += 4) {
      drawn += Number(differs(at));
      for (let channel = 0; channel < 3; channel += 1) mean[channel] += (4 * pixels[at + channel]) / pixels.length;
    }
    return { width, height, bytes: pixels.length, drawn: drawn / (width * height), corner: Array.from(pixels.slice(0, 3)), mean };
  }
}

/** One for each player that is in a page. */
const testings = new WeakMap();
const { prototype } = await customElements.whenDefined('reprise-player');
Object.defineProperty(prototype, 'testing', {
  get() {
    const core = this[INSIDE]();
    if (core && !testings.has(this)) testings.set(this, new Testing(core));
    return testings.get(this);
  },
});
