/**
 * Which tool is in use, what has been asked with it, and the search for a walk that does it.
 *
 * A tool shows its part of the document in a dock under the stage and on the ground, and changes it; changes go through
 * `edit`, which remembers them and searches anew. The tool in use hears of the answer. The tools themselves are a script of
 * their own (`tools.js`): until that is there, and on pages that never need it, what is known below stands for them.
 */

import { loadTools } from '../engine.js';
import { PlayerError } from '../errors.js';
import { nameOf, requestTarget, soughtTarget } from '../targets.js';
import { History } from './history.js';
import { EMPTY, VERSION, documentOf, partOf, requestOf } from './request.js';
import { SearchDriver } from './search.js';

/** What is known of the tools before they are there. They are in the order of their keys. */
const KNOWN = Object.fromEntries(
  ['pose', 'place', 'path', 'timing', 'wander', 'edit'].map((id) => [id, { id, withScore: id === 'pose', onGround: id === 'place' || id === 'path' }]),
);

/** The view of tools that draw on the ground: radians above it, and the distance, more for what lies farther away. */
const OVERVIEW = { elevation: 0.66, distance: 2.1, perMetre: 0.6 };

/** A list without the first of its parts that is this one. */
function without(list, part) {
  const at = list.indexOf(part);
  return at < 0 ? list : list.toSpliced(at, 1);
}

export class Toolbox {
  /** @param {import('../core.js').Core} core */
  constructor(core) {
    this.core = core;
    this.history = new History(EMPTY);
    this.search = new SearchDriver(core, (answer, trouble) => this.answered(answer, trouble));
    /** The tools once they are there, and the promise of that; null as long as nobody needs them. @type {import('./tools.js').Tools | null} */
    this.kit = null;
    this.coming = null;
    this.tool = KNOWN.pose;
    core.queue.edited = () => this.queued();
    // What is done is not to be waited for again.
    core.queue.taken = (target) => this.history.rewrite((document) => ({ ...document, queue: without(document.queue, target) }));
    this.director = null;
    this.answer = null;
    this.trouble = null;
    this.waiting = null;
  }

  get document() {
    return this.history.now;
  }

  get tools() {
    return this.kit?.byName ?? KNOWN;
  }

  actions() {
    return {
      tool: ({ key }) => this.pick(Object.keys(KNOWN)[Number(key) - 1]),
      help: () => this.fetch().then(() => this.kit?.keys.toggle()),
    };
  }

  // ---- the tools' script ----------------------------------------------------------------------------------------

  /** Sees to it that the tools come. Never rejects: trouble is told on the page, and whoever needs them next tries again. */
  fetch() {
    this.coming ??= loadTools().then(({ Tools }) => this.arrived(Tools)).catch((error) => {
      this.coming = null;
      if (this.core.loop) this.core.fail(error);
    });
    return this.coming;
  }

  arrived(Tools) {
    const { core, director } = this;
    this.kit = new Tools(this);
    if (director) Object.values(this.tools).forEach((tool) => tool.opened?.(director));
    this.tool = this.tools[this.tool.id];
    core.queue.changed();
    this.mount();
  }

  // ---- life -----------------------------------------------------------------------------------------------------

  /** The whole actor is there: its graph too, so that searches can begin. */
  open(director) {
    this.director = director;
    for (const tool of Object.values(this.tools)) tool.opened?.(director);
    if (this.core.host.quickness !== null) director.tell('set_quickness', this.core.host.quickness);
    director.tell('set_variety', this.core.host.variety);
    this.showTool();
    if (this.waiting) this.takeWaiting();
    else this.ask();
  }

  takeWaiting() {
    const { waiting } = this;
    if (!waiting || !this.director) return;
    this.waiting = null;
    this.core.attempt(() => this.load(waiting));
  }

  close() {
    this.director = null;
    this.search.forget();
    this.kit?.edits.forget();
    this.kit?.drives.forget();
    this.kit?.families.forget();
    this.answer = null;
    this.history.reset(EMPTY);
    if (this.core.view) this.refresh();
  }

  /** A new stage shows nothing of what the last one did. */
  stageOpened() {
    this.redraw();
  }

  // ---- choosing a tool ------------------------------------------------------------------------------------------

  /** Chooses a tool as a user does, who wants to go on with the keyboard. */
  pick(name) {
    this.core.host.tool = name;
  }

  choose(name) {
    const tool = this.tools[name] ?? this.tools.pose;
    if (tool.id !== 'pose') {
      this.fetch();
      if (tool.id !== 'edit') this.search.fetch();
    }
    if (tool === this.tool) {
      if (!this.director) this.showTool();
      return;
    }
    this.tool.leave?.();
    this.search.stop();
    this.answer = null;
    this.tool = tool;
    this.core.queue.show([]);
    this.history.rewrite((document) => ({ ...document, queue: [] }));
    this.showTool();
    this.ask();
    this.core.dispatch('toolchange', { tool: tool.id });
  }

  showTool() {
    const { hint, withScore } = this.tool;
    if (this.director && (hint || !withScore)) this.core.say(withScore ? hint : '');
    this.mount();
  }

  /** Puts the tool in use into its places. */
  mount() {
    const { view } = this.core;
    const { tool } = this;
    this.kit?.bar.tools.choose(tool.id);
    view.stage.tool = tool;
    view.stage.root.dataset.tool = tool.id;
    view.dock.replaceChildren(...(tool.dock ? [tool.dock] : []));
    view.score.root.hidden = !tool.withScore;
    this.lookOver(tool.onGround);
    tool.enter?.();
    this.refresh();
    view.relay();
  }

  /** Tools that draw on the ground are used from higher up; afterwards the camera goes back to where it was. */
  lookOver(on) {
    const { stage } = this.core.view.stage;
    if (!stage) {
      this.before = null;
      this.overDue = on;
      return;
    }
    if (on) {
      this.before ??= Array.from(stage.camera());
      const { x = 0, z = 0 } = this.director?.state ?? {};
      const reach = Math.max(0, ...(this.tool.points?.() ?? []).map((point) => Math.hypot(point[0] - x, point[1] - z)));
      const distance = Math.max(OVERVIEW.distance, 0.9 + OVERVIEW.perMetre * reach);
      stage.look_from(this.before[0], OVERVIEW.elevation, distance, false);
    } else if (!on && this.before) {
      stage.look_from(...this.before, false);
      this.before = null;
    }
    this.core.redraw();
  }

  // ---- the document ---------------------------------------------------------------------------------------------

  /**
   * Changes what is asked.
   * @param {object} part of the document, by the names of its parts
   * @param {string | null} merge see `History.change`
   */
  edit(part, merge = null) {
    this.history.change({ ...this.document, ...part }, merge);
    this.refresh();
    this.ask();
    this.core.dispatch('change', { tool: this.tool.id });
  }

  /** What waits was changed by hand. */
  queued() {
    if (!this.director) return;
    this.history.change({ ...this.document, queue: this.core.queue.targets });
    this.refresh();
    this.core.dispatch('change', { tool: this.tool.id });
  }

  undo(by) {
    const { pose, queue: waited } = this.document;
    if (!this.history.step(by)) return;
    // Where the actor is under way to is not undone; what waits for that is.
    this.history.amend({ pose });
    const { queue } = this.core;
    if (this.document.queue !== waited) queue.show(this.document.queue);
    if (queue.targets.length > 0 && !this.isUnderWay) queue.next();
    this.refresh();
    this.ask();
    this.core.say(by < 0 ? 'undone' : 'done again');
    this.core.dispatch('change', { tool: this.tool.id });
  }

  /** The request of the tool in use, or null. */
  get request() {
    const { core: { queue, director }, tool: { withScore }, document } = this;
    const request = this.hurried(requestOf(this.tool.id, document));
    if (!request || !withScore || queue.targets.length === 0) return request;
    return { ...request, target: { queue: [request.target, ...queue.targets.map((target) => requestTarget(target, director))] } };
  }

  /** A request with the quickness that was chosen, where one was. */
  hurried(request) {
    const { quickness } = this.core.host;
    return request && quickness !== null ? { ...request, quickness } : request;
  }

  /** Another variety was chosen: it is seen from the next recorded stretch on. */
  vary() {
    this.director?.tell('set_variety', this.core.host.variety);
    this.showVariety();
  }

  showVariety() {
    this.kit?.bar.setVariety(this.director?.info.varies ? this.core.host.variety : null);
  }

  /** Another quickness was chosen: plans are made anew. */
  hurry() {
    const { director, core } = this;
    if (!director) return;
    director.tell('set_quickness', core.host.quickness ?? 0);
    core.poses.choose(director);
    this.refresh();
    this.ask();
    core.dispatch('change', { tool: this.tool.id });
  }

  /**
   * Takes a request that came from outside, by itself or as links and files hold it; what is wrong with it is thrown as a
   * sentence.
   */
  load(outside) {
    const asked = outside?.request || outside?.edits ? outside : { request: outside };
    const { request, edits } = asked;
    const asks = Boolean(request) || !edits;
    if (!this.director || (asks && !this.search.module) || (edits && !this.kit?.edits.ready)) {
      this.waiting = { ...this.waiting, ...asked, ...(request ? { start: asked.start } : {}) };
      // Whatever comes last of them takes it up.
      const coming = [asks && this.search.fetch(), edits && this.fetch().then(() => this.kit?.edits.fetch())];
      Promise.all(coming).then(() => this.takeWaiting(), () => {});
      return;
    }
    if (asks) this.search.check(request);
    if (edits) this.kit.edits.check(edits);
    if (edits) this.history.change({ ...this.document, edits: edits.edits });
    if (asks) this.loadRequest(request, asked);
    else {
      this.history.settle();
      this.refresh();
    }
  }

  loadRequest(request, outside) {
    const { timeline } = this.director;
    const { tool, part, queue } = partOf(request, timeline);
    this.core.host.quickness = request.quickness ?? null;
    const { frame, placement } = outside?.start ?? {};
    if (Number.isInteger(frame) && Array.isArray(placement)) this.director.tell('stand', frame, ...placement.slice(0, 3).map(Number));
    this.history.change({ ...this.document, ...part });
    this.history.settle();
    if (this.tool.id !== tool) this.core.host.tool = tool;
    else if (this.tool.onGround) this.lookOver(true);
    this.refresh();
    this.ask();
    if (queue) {
      this.core.queue.show(queue);
      this.history.amend({ queue });
      this.search.go(this.hurried(requestOf(tool, this.document)));
    }
    this.core.dispatch('change', { tool });
  }

  /** Nothing is asked with the tool in use any more. */
  forget() {
    this.waiting = null;
    if (!this.director || !this.request) return;
    const part = this.tool.id === 'timing' ? 'keys' : this.tool.id;
    if (this.tool.withScore) this.core.queue.clear();
    this.edit({ [part]: EMPTY[part] });
  }

  /** What links and files hold: the request, where the actor was when its answer was found, and the edits. */
  get shared() {
    const { request, answer } = this;
    const { edits } = this.document;
    if (!request && edits.length === 0) return null;
    return { ...(request ? { request } : {}), ...(answer ? { start: answer.start } : {}), ...(edits.length > 0 ? { edits: documentOf(edits) } : {}) };
  }

  /** Adds an edit. @returns {Promise<{notes: string[]}>} once all frames are as it has them */
  async addEdit(edit) {
    await this.fetch();
    await this.kit.edits.fetch();
    if (!this.director || !this.kit.edits.ready) throw new PlayerError('not-loaded', 'The actor has not arrived yet.');
    const edits = [...this.document.edits, JSON.parse(JSON.stringify(edit ?? null))];
    this.kit.edits.check(documentOf(edits));
    this.edit({ edits });
    return this.kit.edits.done();
  }

  /** Performs a clip of motion capture. */
  async drive(files, options) {
    await this.fetch();
    return this.kit.drives.drive(files, options);
  }

  /** Files are held over the stage, or dropped. */
  dropped(event) {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    // What is wrong is said on the page.
    if (event.type === 'drop') this.drive([...event.dataTransfer.files]).catch(() => {});
  }

  refresh() {
    const { edits } = this.document;
    if (this.kit) this.kit.edits.take(edits);
    else if (edits.length > 0) this.fetch();
    this.kit?.bar.setQuickness(this.core.host.quickness ?? this.director?.info.alpha);
    this.showVariety();
    this.kit?.bar.setSteps(this.history.canUndo, this.history.canRedo);
    this.tool.refresh?.();
    this.redraw();
  }

  // ---- searching ------------------------------------------------------------------------------------------------

  /** Searches for a walk that does what the tool in use asks. */
  ask() {
    const request = this.director && this.tool.id !== 'pose' ? this.request : null;
    this.answer = null;
    this.trouble = null;
    if (!request) this.search.stop();
    else {
      // A walk begins where the actor stands; one who only passes the time can stand still.
      if (this.tool.onGround && this.director.state.target === null) this.director.tell('pause');
      this.search.start(request);
    }
    this.tool.answered?.(null);
    this.redraw();
  }

  answered(answer, trouble) {
    this.answer = answer;
    this.trouble = trouble;
    this.tool.answered?.(answer);
    if (trouble) this.core.say(trouble, 'waiting');
    this.redraw();
    if (answer) this.core.dispatch('answer', { answer });
  }

  /** Sends the actor on the best walk so far. */
  go() {
    const request = this.director && this.request;
    if (request) this.core.attempt(() => this.search.go(request));
    else this.core.say(this.tool.hint ?? '');
  }

  /** What the user has clicked in the score or on the stage; `later`: after what is under way. */
  take(target, later = false) {
    const { core } = this;
    if (later || this.tools.pose.isLater) {
      if (core.queue.add(target)) core.say(`${nameOf(target, core.director)} comes after that`, 'going');
    } else {
      core.queue.clear();
      this.send(target);
    }
  }

  /** Sends the actor to a target; what is wrong is said on the page. */
  send(target) {
    const { core } = this;
    core.attempt(() => {
      const sought = soughtTarget(target);
      if (!sought) return core.go(target);
      core.say('looking for a way', 'waiting');
      this.history.amend({ pose: sought });
      return this.search.go(this.hurried({ version: VERSION, target: sought }));
    });
  }

  /** Whether the actor is on its way to something, or about to be. */
  get isUnderWay() {
    const { waiting, endless } = this.search;
    return Boolean(waiting) || (!endless && this.core.director.state.target !== null);
  }

  /** Called once a display frame. */
  step() {
    this.tool.step?.();
    this.search.lookAhead();
    this.kit?.drives.step();
    this.kit?.families.step();
  }

  /** The actor was sent somewhere else: to a pose, or nowhere. */
  left(frame = null) {
    this.history.amend({ pose: frame === null ? null : { pose: frame } });
    // What was found before is no answer to this.
    if (this.tool.withScore) this.answer = null;
    this.search.left();
  }

  happened(type, detail) {
    this.search.happened(type, detail);
    this.tool.happened?.(type, detail);
    this.kit?.families.happened(type);
  }

  // ---- on the stage ---------------------------------------------------------------------------------------------

  /** What the tool marks on the ground has changed. */
  redraw() {
    const { view } = this.core;
    if (!view?.stage.stage) return;
    if (this.kit) view.stage.stage.set_marks(this.kit.drawn(this.tool));
    this.core.redraw();
  }

  /** Puts handles and labels over their places on the ground; called after the picture has been drawn. */
  place() {
    if (this.overDue) {
      this.overDue = false;
      this.lookOver(true);
    }
    this.tool.place?.((...point) => this.core.view.stage.seen(...point));
  }

  /** @returns whether the key was used */
  key(event) {
    const { key } = event;
    const inField = ['INPUT', 'TEXTAREA', 'SELECT'].includes(event.composedPath()[0]?.tagName);
    if ((event.ctrlKey || event.metaKey) && !event.altKey && ['z', 'y', 'Z'].includes(key) && !inField) {
      event.preventDefault();
      this.undo(key === 'z' && !event.shiftKey ? -1 : 1);
      return true;
    }
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || this.tool.id === 'pose') return false;
    const used = this.tool.key?.(event, inField) ?? false;
    const onButton = event.composedPath()[0]?.tagName === 'BUTTON';
    if (!used && key === 'Enter' && !onButton && !inField) {
      this.go();
      event.preventDefault();
      return true;
    }
    if (used) event.preventDefault();
    // The score's keys mean nothing while another tool's dock is in its place.
    return used || ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End'].includes(key) && event.composedPath()[0] !== this.core.view.stage.root;
  }
}
