/** What the browser tests may look at and do; loaded only where the page's address has `?test`. */

export class Testing {
  /** @param {() => {director: object, view: object, draw: () => void}} inside */
  constructor(inside) {
    this.inside = inside;
  }

  get player() {
    return this.inside().director.player;
  }

  get stage() {
    return this.inside().view.stage.stage;
  }

  /** Lets time pass without drawing. */
  tick(seconds) {
    this.inside().director.tick(seconds);
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
    const { search } = this.inside().toolbox;
    return { ...search.slices, running: Boolean(search.task && !search.task.done) };
  }

  /** Where on the screen a place on the ground is. */
  placeOnGround(x, z) {
    const { stage } = this.inside().view;
    const { left, top } = stage.root.getBoundingClientRect();
    const seen = stage.seen(x, z);
    return { x: left + seen.x, y: top + seen.y, visible: seen.visible };
  }

  /** Frames whose poses are drawn as ghosts. */
  ghosts() {
    return this.inside().view.stage.ghosts;
  }

  /** The frame whose texture as captured is worn, or -1. */
  looks() {
    return { worn: this.inside().view.looks.worn };
  }

  thumbnails() {
    const { shelf } = this.inside().view.score;
    return { drawn: shelf.pictures.size, complete: shelf.complete };
  }

  /** Where on the screen a frame's place in the score is, scrolled into view. */
  placeOf(frame) {
    const { score } = this.inside().view;
    const strip = score.layout.stripOf(frame);
    score.strips[strip.index].root.scrollIntoView({ block: 'nearest' });
    const { left, top } = score.sheet.getBoundingClientRect();
    return { x: left + score.layout.xOf(frame), y: top + strip.y + strip.height / 2 };
  }

  /** Where on the screen a ghost's middle is. */
  placeOfGhost(frame) {
    const { director, view } = this.inside();
    const { x, y, z } = director.arrivalOf(frame);
    const { left, top } = view.stage.root.getBoundingClientRect();
    const [cssX, cssY, visible] = this.stage.project(x, y, z);
    return { x: left + cssX, y: top + cssY, visible: visible > 0 };
  }

  /** Screenshots of a canvas that has just been drawn once can be blank: this draws on and on, until it is told to stop. */
  keepDrawing(on = true) {
    const again = () => {
      if (!this.drawing) return;
      this.inside().draw();
      requestAnimationFrame(again);
    };
    const began = on && !this.drawing;
    this.drawing = on;
    if (began) again();
  }

  /** Draws, and reads the picture back: its size, its corner and how much of it differs from the corner's colour, and its mean colour. */
  async picture() {
    this.inside().draw();
    const pixels = await this.stage.read_pixels();
    const { width, height } = this.inside().view.stage.canvas;
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
