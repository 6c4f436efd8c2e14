/**
 * `<reprise-player>`: the element's life and its contract with the page (see `reprise-player.d.ts`). What it does is done
 * by its core.
 */

import { actionsOf } from './actions.js';
import { AttributeElement, parseCamera } from './attributes.js';
import { Core } from './core.js';
import { PlayerError } from './errors.js';
import { handleKey } from './keyboard.js';
import { snapshot, toBlob } from './snapshot.js';
import { watchSurroundings } from './surroundings.js';
import { frameAt, frameOfTarget, isMember, soughtTarget } from './targets.js';
import { VERSION, documentOf, requestOf } from './tools/request.js';
import { fromHash, toHash } from './tools/link.js';
import { buildView } from './view.js';

export class ReprisePlayer extends AttributeElement {
  static observedAttributes = ['src', 'poster', 'alt', 'loading', 'controls', 'loop', 'tint', 'parts', 'theme', 'speed', 'camera', 'originals', 'tool', 'quickness', 'variety'];

  #core = null;
  #actions = null;
  #unwatch = null;
  #near = false;
  /** A direction that was given before there was anything to take it. */
  #wanted;
  #wantedEdits;

  // ---- life -----------------------------------------------------------------------------------------------------

  constructor() {
    super();
    // What was set before this class was there lies on the element itself and would hide what the class has.
    for (const name of Object.keys(this)) {
      const { get, set } = inherited(name) ?? {};
      if (!get) continue;
      const value = this[name];
      delete this[name];
      if (set) this[name] = value;
    }
  }

  connectedCallback() {
    // A document that no window shows (a template's, a parser's) is no place to play in.
    const window = this.ownerDocument.defaultView;
    if (!window) return;
    this.#core ??= this.#build();
    if (this.#core.loop) return;
    const { view } = this.#core;
    view.enter(window);
    this.#core.start(view);
    this.#unwatch = watchSurroundings(this, [this, view.stage.root], {
      visible: (visible) => this.#core.loop?.setVisible(visible),
      near: () => {
        if (!this.#near && this.loading === 'lazy' && this.src) this.#load();
        this.#near = true;
      },
      resized: () => this.#resized(),
      taste: () => this.#applyOptions(),
    });
    this.#core.applyOptions = () => this.#applyOptions();
    this.#applyOptions();
    view.showPoster(this.poster);
    this.#core.toolbox.choose(this.tool);
    this.#take();
    if (this.src && this.loading !== 'lazy') this.#load();
  }

  disconnectedCallback() {
    // Moving the element within the page disconnects it for a moment only.
    queueMicrotask(() => {
      if (!this.isConnected) this.#leave();
    });
  }

  /** Another document has other frames, another taste and another screen: there it begins anew. */
  adoptedCallback() {
    this.#leave();
  }

  #leave() {
    if (!this.#core?.loop) return;
    this.#core.stop();
    this.#unwatch();
    this.#near = false;
  }

  attributeChangedCallback(name, before, after) {
    if (!this.#core?.loop || before === after) return;
    if (name === 'src' || name === 'loading') this.#loadIfWanted(name);
    else if (name === 'poster') this.#core.view.showPoster(this.poster);
    else if (name === 'tool') this.#core.toolbox.choose(this.tool);
    else if (name === 'camera') this.#aim();
    else if (name === 'quickness') this.#core.toolbox.hurry();
    else if (name === 'variety') this.#core.toolbox.vary();
    else this.#applyOptions();
  }

  /** Hands on what was asked before there was anything to take it. */
  #take() {
    const [wanted, edits] = [this.#wanted, this.#wantedEdits];
    this.#wanted = undefined;
    this.#wantedEdits = undefined;
    if (wanted !== undefined) this.#core.toolbox.load(wanted);
    if (edits !== undefined) this.#core.toolbox.load({ edits });
  }

  #build() {
    const core = new Core(this);
    core.view = buildView(this, core, new Proxy({}, { get: (_, name) => (event) => this.#actions[name]?.(event) }));
    this.#actions = { ...actionsOf(core, this), ...core.toolbox.actions() };
    this.shadowRoot.addEventListener('keydown', (event) => this.pressKey(event));
    return core;
  }

  #loadIfWanted(changed) {
    if (changed === 'loading' && this.#core.session) return;
    if (this.loading !== 'lazy' || this.#near) this.#load();
  }

  #load() {
    if (this.src) this.#core.load(this.src);
    else this.#core.unload();
  }

  #resized() {
    const { view } = this.#core;
    this.#core.guard(() => {
      // Drawn at once: a canvas that has just changed its size is empty.
      if (view.stage.resize()) this.#core.draw();
    });
    view.relay();
    this.#core.redraw();
  }

  #aim() {
    this.#core.view.stage.aim(parseCamera(this.camera));
    this.#core.redraw();
  }

  /** Hands the attributes on. */
  #applyOptions() {
    const { view, director } = this.#core;
    const dark = this.theme ? this.theme === 'dark' : view.dark.matches;
    view.stage.setOptions({
      theme: dark ? 'dark' : 'light',
      background: view.background(),
      tint: this.tint,
      parts: this.parts,
      grid: true,
      path: true,
      reduced_motion: view.calm.matches,
    });
    view.stage.home = parseCamera(this.camera);
    view.setAlt(this.alt);
    view.setTint(this.tint);
    this.#core.showParts();
    view.transport.setLoop(this.loop);
    view.transport.setSpeed(this.speed);
    director?.tell('set_loop', this.loop);
    director?.tell('set_speed', this.speed);
    if (this.controls) this.#core.toolbox.fetch();
    view.relay();
  }

  // ---- the contract ---------------------------------------------------------------------------------------------

  get info() { return this.#core?.director?.info ?? null; }
  get state() { return this.info ? this.#core.director.state : null; }
  get complete() { return this.#core?.complete ?? false; }
  get playing() { return this.info ? this.#core.director.player.playing() : false; }
  get behaviours() { return [...(this.info?.behaviours ?? [])]; }
  get families() { return this.info ? this.#core.director.families : []; }
  get bodyParts() { return (this.#core?.view.parts.all ?? []).map((part) => ({ ...part })); }
  get answer() { return this.#core?.toolbox.answer ?? null; }
  get queued() { return [...(this.#core?.queue.targets ?? [])]; }

  /** Loads `src` again from the start. Never rejects: trouble becomes an `error` event and a sentence on the page. */
  async reload() {
    if (this.#core?.loop) await this.#core.load(this.src);
  }

  play() {
    this.#ready().tell('play');
    this.#core.loop?.request();
  }

  pause() {
    this.#ready().tell('pause');
    this.#core.loop?.request();
  }

  seek(frame) {
    this.#ready().tell('seek', frame);
    this.#core.queue.clear();
    this.#core.toolbox.left();
    this.#core.view.score.setFlag(null);
    this.#core.say('');
    this.#core.poses.choose(this.#core.director);
    this.#core.redraw();
  }

  plan(target) {
    const director = this.#ready();
    return director.plan(frameOfTarget(target, director));
  }

  goTo(target) {
    this.#ready();
    const sought = soughtTarget(target);
    if (sought) return this.direct({ version: VERSION, target: sought });
    this.#core.queue.clear();
    return this.#core.go(target);
  }

  queue(...targets) {
    const director = this.#ready();
    targets.forEach((target) => isMember(target) || frameOfTarget(target, director));
    for (const target of targets) this.#core.queue.add(target);
  }

  cancel() {
    this.#ready().tell('cancel');
    this.#core.queue.clear();
    this.#core.toolbox.left();
    this.#core.view.score.setFlag(null);
    this.#core.say('stopped');
    this.#core.redraw();
  }

  get direction() { return this.#core?.toolbox.request ?? null; }

  set direction(request) {
    const nothing = request === null || request === undefined;
    if (!this.#core) this.#wanted = nothing ? undefined : request;
    else if (nothing) this.#core.toolbox.forget();
    else this.#core.toolbox.load(request);
    this.#core?.loop?.request();
  }

  get edits() {
    const { edits = [] } = this.#core?.toolbox.document ?? {};
    return edits.length > 0 ? documentOf(edits) : null;
  }

  set edits(document) {
    const wanted = document ?? documentOf([]);
    if (!this.#core) this.#wantedEdits = wanted;
    else this.#core.toolbox.load({ edits: wanted });
    this.#core?.loop?.request();
  }

  async edit(edit) {
    this.#ready();
    return this.#core.toolbox.addEdit(edit);
  }

  async drive(files, options) {
    this.#ready();
    return this.#core.toolbox.drive(files, options);
  }

  direct(request, { anywhere = false } = {}) {
    const begin = () => {
      this.#ready();
      const { queue, toolbox: { search } } = this.#core;
      search.check(request);
      queue.clear();
      return search.go(request, anywhere ? 'anywhere' : 'here');
    };
    try {
      this.#ready();
      const { search } = this.#core.toolbox;
      return search.module ? begin() : search.fetch().then(begin);
    } catch (error) {
      // Whoever is promised an answer hears of trouble in one way.
      return Promise.reject(error);
    }
  }

  wander({ seed = 1, weights = {} } = {}) {
    return this.direct(requestOf('wander', { wander: { seed, weights } }));
  }

  hold(behaviour, seconds = 10) {
    return this.direct({ version: VERSION, target: { behaviour: { name: behaviour, hold: seconds } } });
  }

  get link() {
    const { shared } = this.#core?.toolbox ?? {};
    return shared ? toHash(shared) : '';
  }

  openLink(address) {
    if (!this.#core) return false;
    return this.#core.attempt(() => {
      const direction = fromHash(new URL(address, location.href).hash);
      if (direction !== undefined) this.#core.toolbox.load(direction);
      return direction !== undefined;
    }) ?? false;
  }

  frameOf(sequence, seconds = 0) {
    return frameAt(this.#ready(), sequence, seconds);
  }

  async snapshot(options) {
    this.#ready();
    return snapshot(this.#core, options);
  }

  async toBlob(options) {
    this.#ready();
    return toBlob(this.#core, options);
  }

  recentre() {
    this.#core?.view.stage.recentre();
    this.#core?.redraw();
  }

  pressKey(event) {
    if (!this.#core) return false;
    const { view, toolbox } = this.#core;
    if (toolbox.kit?.keys.root.open) return false;
    if (toolbox.key(event)) return true;
    if (event.composedPath()[0] === view.stage.root && view.stage.key(event.key)) {
      event.preventDefault();
      return true;
    }
    return handleKey(event, this.#actions);
  }

  /** For the tests of this project alone, which look inside by it: no part of the contract, gone or other in any version. */
  [Symbol.for('reprise.inside')]() {
    return this.#core;
  }

  #ready() {
    if (!this.info) throw new PlayerError('not-loaded', 'There is no actor yet; wait for the ready event.');
    return this.#core.director;
  }
}

/** What the class itself says of a property. */
function inherited(name) {
  const { prototype } = ReprisePlayer;
  return Object.getOwnPropertyDescriptor(prototype, name) ?? Object.getOwnPropertyDescriptor(Object.getPrototypeOf(prototype), name);
}
