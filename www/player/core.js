/** One player's parts put together: a session with an actor, the view, and what happens in a display frame. */

import { kindOf } from './errors.js';
import { poseName, title, walkSentence } from './format.js';
import { FrameLoop, Median } from './loop.js';
import { Poses } from './poses.js';
import { Session } from './session.js';
import { Queue, frameOfTarget } from './targets.js';
import { Toolbox } from './tools/toolbox.js';

export class Core {
  /** @param {import('./element.js').ReprisePlayer} host */
  constructor(host) {
    this.host = host;
    this.view = null;
    this.loop = null;
    this.session = null;
    this.failed = null;
    this.dirty = false;
    this.frameMs = new Median();
    this.poses = new Poses(() => this.guard(() => this.showGhosts(true)));
    this.queue = new Queue((target) => this.toolbox.send(target), () => this.toolbox.isUnderWay);
    this.toolbox = new Toolbox(this);
  }

  /** @returns {import('./director.js').Director | null} */
  get director() {
    return this.session?.director ?? null;
  }

  get complete() {
    return this.session?.complete ?? false;
  }

  start(view) {
    this.view = view;
    this.loop = new FrameLoop(view.window, (seconds) => this.guard(() => this.step(seconds)) ?? false);
  }

  stop() {
    this.unload();
    this.loop?.stop();
    this.loop = null;
    this.view.leave();
  }

  // ---- the actor ------------------------------------------------------------------------------------------------

  async load(address) {
    this.unload();
    this.view.startLoading();
    this.session = new Session(this.view.stage, this.sessionOwner());
    await this.session.load(address);
  }

  unload() {
    this.session?.close();
    this.session = null;
    this.failed = null;
    this.queue.clear();
    this.poses.clear();
    this.toolbox.close();
    this.view?.reset();
  }

  sessionOwner() {
    const { view } = this;
    return {
      progress: (loaded, total) => {
        view.progress.show(loaded, total);
        this.dispatch('progress', { loaded, total });
      },
      described: () => {
        this.applyOptions();
        view.score.setInfo(this.director.info);
        if (this.host.autoplay && !view.calm.matches) this.director.tell('play');
        this.loop?.request();
      },
      more: () => {
        view.score.wantThumbnails();
        this.toolbox.tool.wantThumbnails?.();
        this.loop?.request();
      },
      dressed: () => this.redraw(),
      shown: (first) => {
        this.draw();
        view.showStage();
        if (this.failed) view.fail(this.failed, true);
        view.score.wantThumbnails();
        this.showGhosts(true);
        this.showParts();
        this.toolbox.stageOpened();
        if (first) this.dispatch('ready', { info: this.director.info });
        this.loop?.request();
      },
      complete: async () => {
        const { session, director: { player, info } } = this;
        view.score.setArcs(player.arcs(info.transitions));
        view.progress.hide();
        view.parts.arrived(player);
        this.showParts();
        this.toolbox.open(this.director);
        this.loop?.request();
        // Tools that are wanted are a part of what loads.
        await this.toolbox.coming;
        if (!session.closed) this.dispatch('load', { info });
      },
      failed: (error) => this.fail(error),
      devicelost: () => this.dispatch('devicelost', {}),
      devicerestored: () => this.dispatch('devicerestored', {}),
    };
  }

  // ---- frames ---------------------------------------------------------------------------------------------------

  /** One display frame. @returns whether another one is wanted */
  step(seconds) {
    const { director, view, poses } = this;
    if (!director?.info || this.failed === 'internal') return false;
    const start = performance.now();
    const { changed, events } = director.tick(seconds);
    events.forEach((event) => this.happened(event));
    this.toolbox.step();
    const live = view.stage.alive();
    if (view.preview.update(start, changed)) this.showGhosts(changed);
    if (changed && poses.due(start)) poses.choose(director);
    const moving = live && view.stage.stage.camera_moving();
    const dressing = live && view.looks.step(director, view.stage.stage);
    this.session.scans.step();
    const draws = changed || moving || dressing || this.dirty;
    if (draws) this.draw();
    const walk = view.preview.plan ?? director.walk;
    view.update(director, { walk, frameMs: this.frameMs.value });
    if (changed && draws) this.frameMs.add(performance.now() - start);
    if (changed) this.tellFrame();
    return director.player.playing() || changed || moving || dressing || this.dirty;
  }

  draw() {
    const { stage } = this.view;
    if (!stage.alive() || !this.director?.info) return;
    this.dirty = false;
    stage.stage.draw(this.director.player);
    if (this.director.info.scanned) this.director.shown = stage.stage.scan_shown() < 0.5 ? 'template' : stage.stage.scan_carried() ? 'carried' : 'scan';
    this.toolbox.place();
  }

  redraw() {
    this.dirty = true;
    this.loop?.request();
  }

  tellFrame() {
    const { frame, mode, x, z, heading } = this.director.state;
    this.dispatch('frame', { frame, mode, x, z, heading });
  }

  happened({ type, ...detail }) {
    const { timeline } = this.director;
    const named = (frame) => title(timeline.sequenceOf(frame));
    if (type === 'arrive') {
      this.view.score.setFlag(detail.frame, true);
      this.say(`arrived at ${poseName(timeline.sequenceOf(detail.frame), detail.frame, timeline.fps)}`, 'arrived');
      this.poses.choose(this.director);
    } else if (type === 'stall') {
      this.say('waiting for the rest of the actor', 'waiting');
    } else if (type === 'end') {
      this.say(`${named(detail.frame)} ends here`, 'hint');
    }
    this.toolbox.happened(type, detail);
    this.dispatch(type, detail);
    if (type === 'arrive') this.queue.next();
  }

  // ---- trouble --------------------------------------------------------------------------------------------------

  /** Runs `work`; whatever it throws is shown on the page. */
  guard(work) {
    try {
      return work();
    } catch (error) {
      this.fail(error);
      return undefined;
    }
  }

  fail(error) {
    const kind = kindOf(error);
    this.failed = kind;
    this.view.fail(kind, Boolean(this.session?.shown) && kind !== 'device-lost' && kind !== 'internal');
    this.dispatch('error', { kind, message: error?.message ?? String(error) });
  }

  /** The button of the card that says what went wrong. */
  mend(action) {
    if (action === 'reload') location.reload();
    else if (action === 'secure') location.protocol = 'https:';
    else if (action === 'copy') navigator.clipboard?.writeText(location.href);
    else if (this.failed === 'device-lost' && this.director) {
      this.view.error.hide();
      this.view.showStage();
      this.failed = null;
      this.session.open();
    } else this.host.reload();
  }

  dispatch(type, detail) {
    return this.host.dispatchEvent(new CustomEvent(type, { detail }));
  }

  say(text, kind = 'hint') {
    this.view.transport.say(text, kind);
  }

  // ---- going somewhere ------------------------------------------------------------------------------------------

  /** Leaves for a target; throws where there is no way. */
  go(target) {
    const { director, view } = this;
    const frame = frameOfTarget(target, director);
    const walk = director.goTo(frame);
    this.toolbox.left(frame);
    view.score.setFlag(frame);
    this.say(walkSentence(walk), 'going');
    this.redraw();
    return walk;
  }

  /** The actor has left on a walk that a search found. */
  left(walk, answer) {
    this.director.known = null;
    this.director.walk = walk;
    this.view.score.setFlag(walk.to);
    this.say(walkSentence(walk).replace('goes there in', 'on its way,'), 'going');
    this.redraw();
  }

  /** Runs what a user asked for; what cannot be is a sentence, what is broken an error. */
  attempt(work) {
    try {
      return work();
    } catch (error) {
      if (error?.kind === 'unreachable') this.say('cannot be reached from here', 'waiting');
      else if (error?.kind === 'not-loaded') this.say('not loaded yet', 'waiting');
      else if (error?.kind === 'bad-argument') this.say(error.message, 'waiting');
      else this.fail(error);
      return undefined;
    }
  }

  look(frame, place = null, focus = false) {
    if (this.director?.info) this.view.preview.at(frame, place, focus);
  }

  showParts() {
    this.guard(() => this.view.parts.show(this.host.parts, this.view.stage.alive() ? this.view.stage.stage : null, this.director?.player));
    this.redraw();
  }

  togglePoses() {
    this.poses.on = !this.poses.on;
    this.view.setPoses(this.poses.on);
    this.poses.choose(this.director);
  }

  showGhosts(anew) {
    if (!this.director) return;
    const looked = this.view.preview.frame;
    const frames = [...(looked >= 0 ? [looked] : []), ...this.poses.frames];
    this.view.stage.setGhosts(this.director.player, [...new Set(frames)], anew);
  }
}
