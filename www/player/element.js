/**
 * `<reprise-player>`: the element's life and its contract with the page (see `reprise-player.d.ts`). It puts the parts
 * together; each part knows only itself.
 */

import { AttributeElement } from './attributes.js';
import { Director } from './director.js';
import { loadEngine } from './engine.js';
import { PlayerError, checkSupport, kindOf } from './errors.js';
import { poseName, title, walkSentence } from './format.js';
import { Textures } from './images.js';
import { handleKey } from './keyboard.js';
import { actorAddress, openActor } from './loading.js';
import { FrameLoop, Median } from './loop.js';
import { suggestPoses } from './suggestions.js';
import { buildView } from './view.js';

/** A device lost this often within so many milliseconds is not tried again by itself. */
const LOSSES = { most: 3, within: 30_000 };
/** How often, and after how many milliseconds, a lost device is asked for again before the page says so. */
const REOPENINGS = 5;
const REOPEN_AFTER = 400;
/** Milliseconds of decoding after which the page gets a turn. */
const TURN = 8;
/** Milliseconds between two choices of poses around a moving actor. */
const SUGGEST_ANEW = 1500;

const nextTurn = () => new Promise((resolve) => setTimeout(resolve, 0));

export class ReprisePlayer extends AttributeElement {
  static observedAttributes = ['src', 'poster', 'controls', 'loop', 'tint', 'theme', 'speed'];

  #view = null;
  #loop = null;
  #engine = null;
  #director = null;
  #textures = new Textures();
  #loading = null;
  #observers = [];
  #unlisten = null;
  #losses = [];
  #failed = null;
  #complete = false;
  #shown = false;
  #dirty = false;
  #poses = { on: false, frames: [], run: 0, at: 0 };
  #frameMs = new Median();

  // ---- life -----------------------------------------------------------------------------------------------------

  connectedCallback() {
    this.#view ??= this.#build();
    if (this.#loop) return;
    this.#loop = new FrameLoop((seconds) => this.#guard(() => this.#step(seconds)) ?? false);
    this.#observe();
    this.#applyOptions();
    this.#view.showPoster(this.poster);
    this.#attachTesting();
    if (this.src) this.reload();
  }

  disconnectedCallback() {
    // Moving the element within the page disconnects it for a moment only.
    queueMicrotask(() => {
      if (this.isConnected) return;
      this.#unload();
      this.#loop?.stop();
      this.#loop = null;
      this.#observers.forEach((observer) => observer.disconnect());
      this.#unlisten?.abort();
    });
  }

  attributeChangedCallback(name, before, after) {
    if (!this.#loop || before === after) return;
    if (name === 'src') this.reload();
    else if (name === 'poster') this.#view.showPoster(this.poster);
    else this.#applyOptions();
  }

  /** Tests look inside through `element.testing`; a page whose address does not ask for it has no such thing. */
  async #attachTesting() {
    if (this.testing || !new URLSearchParams(location.search).has('test')) return;
    const { Testing } = await import('./testing.js');
    this.testing = new Testing(() => ({ director: this.#director, view: this.#view, draw: () => this.#draw() }));
  }

  #build() {
    const view = buildView(this, {
      act: this.#actions(),
      preview: (frame, place, focus) => this.#look(frame, place, focus),
      go: (frame) => this.#userGoes(frame),
      seek: (frame) => this.seek(frame),
      speed: (speed) => (this.speed = speed),
      thumbnail: (frame, width, height) => this.#thumbnail(frame, width, height),
      loaded: (frame) => this.#director?.player.loaded(frame) ?? false,
      director: () => this.#director,
      request: () => this.#loop?.request(),
      moved: () => this.#redraw(),
      lost: () => this.#recover(),
      errorAction: (action) => this.#onErrorButton(action),
      compare: (compare) => this.#view.stage.setOptions({ compare }),
    });
    this.shadowRoot.addEventListener('keydown', (event) => this.pressKey(event));
    return view;
  }

  #observe() {
    this.#unlisten = new AbortController();
    const { signal } = this.#unlisten;
    let inView = true;
    const visibility = () => this.#loop?.setVisible(inView && document.visibilityState === 'visible');
    const seen = new IntersectionObserver((entries) => {
      inView = entries[entries.length - 1].isIntersecting;
      visibility();
    });
    const sized = new ResizeObserver(() => this.#resized());
    seen.observe(this);
    sized.observe(this);
    sized.observe(this.#view.stage.root);
    this.#observers = [seen, sized];
    document.addEventListener('visibilitychange', visibility, { signal });
    this.#watchDensity(signal);
    for (const query of ['(prefers-color-scheme: dark)', '(prefers-reduced-motion: reduce)']) {
      matchMedia(query).addEventListener('change', () => this.#applyOptions(), { signal });
    }
    visibility();
  }

  /** Another screen, another density: the size in CSS pixels stays, so no observer of sizes tells. */
  #watchDensity(signal) {
    const again = () => {
      this.#resized();
      this.#watchDensity(signal);
    };
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', again, { once: true, signal });
  }

  #resized() {
    this.#guard(() => {
      // Drawn at once: a canvas that has just changed its size is empty.
      if (this.#view.stage.resize()) this.#draw();
    });
    this.#view.relay();
  }

  // ---- loading --------------------------------------------------------------------------------------------------

  /** Loads `src` again from the start. Never rejects: trouble becomes an `error` event and a sentence on the page. */
  async reload() {
    this.#unload();
    const loading = new AbortController();
    this.#loading = loading;
    this.#view.startLoading();
    try {
      checkSupport();
      const url = actorAddress(this.src);
      const [engine, { total, chunks }] = await Promise.all([loadEngine(), openActor(url, loading.signal)]);
      if (loading.signal.aborted) return;
      this.#engine = engine;
      this.#director = new Director(new engine.Player());
      await this.#receive(chunks, total, loading.signal);
    } catch (error) {
      if (loading.signal.aborted) return;
      this.#fail(error);
      // What has arrived stays: a stage that is being opened just now will show it.
      if (!this.#director?.info) loading.abort();
    }
  }

  async #receive(chunks, total, signal) {
    const { player } = this.#director;
    let phase = 'empty';
    let turn = performance.now();
    for await (const { bytes, loaded } of chunks) {
      if (signal.aborted) return;
      player.push(bytes);
      this.#view.progress.show(loaded, total);
      this.#dispatch('progress', { loaded, total });
      const before = phase;
      phase = player.phase();
      if (phase !== before || performance.now() - turn > TURN) {
        this.#arrived(phase, signal);
        await nextTurn();
        turn = performance.now();
      }
    }
    if (signal.aborted) return;
    player.finish();
    this.#complete = true;
    this.#arrived(player.phase(), signal);
    this.#view.progress.hide();
    this.#dispatch('load', { info: this.info });
  }

  /** More of the bundle is there: show what can be shown. */
  #arrived(phase, signal) {
    if (phase === 'empty' || phase === 'header') return;
    const director = this.#director;
    const first = director.info === null;
    director.refresh();
    if (first) {
      this.#applyOptions();
      this.#view.score.setInfo(director.info);
      this.#openStage(signal);
      if (this.autoplay && !this.#view.calm.matches) director.tell('play');
    } else if (this.#shown) {
      this.#sendTextures();
      this.#view.score.wantThumbnails();
    }
    if (this.#complete) this.#view.score.setArcs(director.player.arcs(director.info.transitions));
    this.#loop?.request();
  }

  /** @param {number} patience how often a missing adapter is asked for again: after a crash there is none for a moment */
  async #openStage(signal, patience = 0) {
    try {
      await this.#view.stage.open(this.#engine, this.#director.player);
      if (signal.aborted) return;
      this.#textures.forget();
      this.#sendTextures();
      this.#draw();
      const first = !this.#shown;
      this.#shown = true;
      this.#view.showStage();
      if (this.#failed) this.#view.fail(this.#failed, true);
      if (first) this.#dispatch('ready', { info: this.info });
      this.#view.score.wantThumbnails();
      this.#view.stage.setGhosts(this.#director.player, this.#ghosts(), true);
      this.#loop?.request();
    } catch (error) {
      if (signal.aborted) return;
      if (patience === 0) return this.#fail(error);
      await new Promise((resolve) => setTimeout(resolve, REOPEN_AFTER));
      if (!signal.aborted) await this.#openStage(signal, patience - 1);
    }
  }

  #sendTextures() {
    const director = this.#director;
    const { stage } = this.#view;
    const send = (index, bitmap) => {
      if (director !== this.#director || !stage.alive()) return;
      stage.stage.set_image(index, bitmap);
      this.#redraw();
    };
    this.#textures
      .update(director.info, (index) => director.player.image(index), send)
      .then(() => director === this.#director && this.#view.score.wantThumbnails())
      .catch((error) => director === this.#director && this.#fail(error));
  }

  #unload() {
    this.#loading?.abort();
    this.#loading = null;
    this.#view?.stage.close();
    this.#view?.reset();
    this.#director?.player.free?.();
    this.#director = null;
    this.#textures = new Textures();
    this.#complete = false;
    this.#shown = false;
    this.#failed = null;
    this.#poses = { ...this.#poses, frames: [], run: this.#poses.run + 1 };
  }

  // ---- frames ---------------------------------------------------------------------------------------------------

  /** One display frame. @returns whether another one is wanted */
  #step(seconds) {
    const director = this.#director;
    if (!director?.info || this.#failed === 'internal') return false;
    const start = performance.now();
    const { changed, events } = director.tick(seconds);
    events.forEach((event) => this.#happened(event));
    const { stage, preview } = this.#view;
    const live = stage.alive();
    if (preview.update(start, changed)) stage.setGhosts(director.player, this.#ghosts(), changed);
    if (changed && this.#poses.on && start - this.#poses.at > SUGGEST_ANEW) this.#suggest();
    const moving = live && stage.stage.camera_moving();
    const dressing = live && this.#view.looks.step(director.info, director.player, stage.stage);
    const draws = changed || moving || dressing || this.#dirty;
    if (draws) this.#draw();
    this.#view.update(director, this.#numbers());
    if (changed && draws) this.#frameMs.add(performance.now() - start);
    return director.player.playing() || changed || moving || dressing || this.#dirty;
  }

  #draw() {
    const { stage } = this.#view;
    if (!stage.alive() || !this.#director?.info) return;
    this.#dirty = false;
    stage.stage.draw(this.#director.player);
  }

  #redraw() {
    this.#dirty = true;
    this.#loop?.request();
  }

  #numbers() {
    const walk = this.#view.preview.plan ?? this.#director.walk;
    return { walk, frameMs: this.#frameMs.value };
  }

  #happened(event) {
    const { timeline } = this.#director;
    const { type, ...detail } = event;
    if (type === 'arrive') {
      this.#view.score.setFlag(event.frame, true);
      this.#view.transport.say(`arrived at ${poseName(timeline.sequenceOf(event.frame), event.frame, timeline.fps)}`, 'arrived');
      this.#suggest();
    } else if (type === 'stall') {
      this.#view.transport.say('waiting for the rest of the actor', 'waiting');
    } else if (type === 'end') {
      this.#view.transport.say(`${title(timeline.sequenceOf(event.frame))} ends here`, 'hint');
    }
    this.#dispatch(type, detail);
  }

  // ---- trouble --------------------------------------------------------------------------------------------------

  /** Runs `work`; whatever it throws is shown on the page. */
  #guard(work) {
    try {
      return work();
    } catch (error) {
      this.#fail(error);
      return undefined;
    }
  }

  #fail(error) {
    const kind = kindOf(error);
    this.#failed = kind;
    this.#view.fail(kind, this.#shown && kind !== 'device-lost' && kind !== 'internal');
    this.#dispatch('error', { kind, message: error?.message ?? String(error) });
  }

  /** The device is gone: the player still knows pose and target, so only the stage is made anew. */
  async #recover() {
    if (!this.#director || !this.#loading) return;
    const now = performance.now();
    this.#losses = [...this.#losses.filter((at) => now - at < LOSSES.within), now];
    this.#dispatch('devicelost', {});
    if (this.#losses.length > LOSSES.most) {
      this.#losses = [];
      this.#fail(new PlayerError('device-lost', 'The graphics device was lost several times in a row.'));
      return;
    }
    const director = this.#director;
    await this.#openStage(this.#loading.signal, REOPENINGS);
    if (director === this.#director && this.#view.stage.stage) this.#dispatch('devicerestored', {});
  }

  #onErrorButton(action) {
    if (action === 'reload') location.reload();
    else if (action === 'secure') location.protocol = 'https:';
    else if (action === 'copy') navigator.clipboard?.writeText(location.href);
    else if (this.#failed === 'device-lost' && this.#director) {
      this.#view.error.hide();
      this.#view.showStage();
      this.#failed = null;
      this.#openStage(this.#loading.signal);
    } else this.reload();
  }

  #dispatch(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  // ---- what the user does ---------------------------------------------------------------------------------------

  /** The actions of keys and chips, by name. */
  #actions() {
    const cursor = () => {
      const { frame, target } = this.#director.state;
      return this.#view.preview.frame >= 0 ? this.#view.preview.frame : (target ?? Math.round(frame));
    };
    const move = (frame) => this.#look(frame, null, true);
    const ready = (work) => (event) => this.#director?.info && this.#guard(() => work(event));
    return {
      step: ready(({ key, shiftKey }) => {
        const { timeline } = this.#director;
        const by = (key === 'ArrowLeft' ? -1 : 1) * (shiftKey ? Math.round(timeline.fps / 2) : 1);
        move(timeline.step(cursor(), by));
      }),
      across: ready(({ key }) => move(this.#director.timeline.across(cursor(), key === 'ArrowUp' ? -1 : 1))),
      ends: ready(({ key }) => {
        const { first, count } = this.#director.timeline.sequenceOf(cursor());
        move(key === 'Home' ? first : first + count - 1);
      }),
      go: ready(() => {
        if (this.#view.preview.frame < 0) return;
        this.#userGoes(this.#view.preview.frame);
        this.#look(-1);
      }),
      toggle: ready(() => (this.playing ? this.pause() : this.play())),
      cancel: () => this.#escape(),
      facts: () => this.#view.toggleFacts() || this.#loop?.request(),
      tint: () => (this.tint = !this.tint),
      compare: () => this.#view.looks.toggle(),
      poses: () => this.#togglePoses(),
      loop: () => (this.loop = !this.loop),
      help: () => this.#view.keys.toggle(),
      drawer: () => this.#view.toggleDrawer(),
    };
  }

  #escape() {
    if (this.#view.preview.frame >= 0) this.#look(-1);
    else if (this.#director?.info && this.#director.state.target !== null) this.cancel();
    else this.#view.toggleFacts(false);
  }

  #look(frame, place = null, focus = false) {
    if (!this.#director?.info) return;
    this.#view.preview.at(frame, place, focus);
  }

  #userGoes(frame) {
    try {
      this.goTo(frame);
    } catch (error) {
      if (error.kind === 'unreachable') this.#view.transport.say('cannot be reached from here', 'waiting');
      else if (error.kind === 'not-loaded') this.#view.transport.say('not loaded yet', 'waiting');
      else this.#fail(error);
    }
  }

  #togglePoses() {
    this.#poses.on = !this.#poses.on;
    this.#view.setPoses(this.#poses.on);
    this.#suggest();
  }

  async #suggest() {
    const run = (this.#poses.run += 1);
    this.#poses.at = performance.now();
    const director = this.#director;
    const wanted = () => run === this.#poses.run && director === this.#director;
    const frames = this.#poses.on && director?.info
      ? await suggestPoses(director, wanted)
      : [];
    if (!wanted() || !director) return;
    this.#poses.frames = frames;
    this.#guard(() => this.#view.stage.setGhosts(director.player, this.#ghosts(), true));
  }

  #ghosts() {
    const looked = this.#view.preview.frame;
    return [...new Set(looked >= 0 ? [looked, ...this.#poses.frames] : this.#poses.frames)];
  }

  #thumbnail(frame, width, height) {
    const { stage } = this.#view;
    return this.#shown && (this.#textures.dressed || this.#view.looks.dressed) && stage.alive() ? stage.stage.thumbnail(this.#director.player, frame, width, height) : null;
  }

  #applyOptions() {
    const { stage, transport } = this.#view;
    const dark = this.theme ? this.theme === 'dark' : this.#view.dark.matches;
    stage.setOptions({
      theme: dark ? 'dark' : 'light',
      background: this.#view.background(),
      tint: this.tint,
      grid: true,
      path: true,
      reduced_motion: this.#view.calm.matches,
    });
    this.#view.setTint(this.tint);
    transport.setLoop(this.loop);
    transport.setSpeed(this.speed);
    this.#director?.tell('set_loop', this.loop);
    this.#director?.tell('set_speed', this.speed);
    this.#view.relay();
  }

  // ---- the contract ---------------------------------------------------------------------------------------------

  get info() { return this.#director?.info ?? null; }
  get state() { return this.#director?.info ? this.#director.state : null; }
  get complete() { return this.#complete; }
  get playing() { return this.#director?.info ? this.#director.player.playing() : false; }

  play() {
    this.#ready().tell('play');
    this.#loop?.request();
  }

  pause() {
    this.#ready().tell('pause');
    this.#loop?.request();
  }

  seek(frame) {
    this.#ready().tell('seek', frame);
    this.#view.score.setFlag(null);
    this.#view.transport.say('', 'hint');
    this.#suggest();
    this.#redraw();
  }

  plan(frame) {
    return this.#ready().plan(frame);
  }

  goTo(frame) {
    const walk = this.#ready().goTo(frame);
    this.#view.score.setFlag(frame);
    this.#view.transport.say(walkSentence(walk), 'going');
    this.#redraw();
    return walk;
  }

  cancel() {
    this.#ready().tell('cancel');
    this.#view.score.setFlag(null);
    this.#view.transport.say('stopped', 'hint');
    this.#redraw();
  }

  frameOf(sequence, seconds = 0) {
    const { info, timeline } = this.#ready();
    const found = info.sequences.find(({ name }) => name === sequence);
    if (!found) throw new PlayerError('bad-argument', `There is no sequence named “${sequence}”.`);
    return timeline.step(found.first, Math.round(seconds * info.fps));
  }

  pressKey(event) {
    if (this.#view.keys.root.open) return false;
    if (event.composedPath()[0] === this.#view.stage.root && this.#view.stage.key(event.key)) {
      event.preventDefault();
      return true;
    }
    return handleKey(event, this.#actions());
  }

  #ready() {
    if (!this.#director?.info) throw new PlayerError('not-loaded', 'There is no actor yet; wait for the ready event.');
    return this.#director;
  }
}
