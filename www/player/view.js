/** Builds the element's shadow tree and puts the parts in their places. */

import { button, h } from './dom.js';
import { ErrorCard } from './errors.js';
import { Facts } from './facts.js';
import { title } from './format.js';
import { ProgressBar } from './loading.js';
import { Looks } from './looks.js';
import { Parts } from './parts.js';
import { Preview } from './preview.js';
import { Score } from './score.js';
import { StageView } from './stage-view.js';
import { Transport } from './transport.js';
import { Styles } from './styles/sheets.js';
import { scoreStyles } from './styles/score.js';
import { stageStyles } from './styles/stage.js';
import { tokens } from './styles/tokens.js';

/** What the page may say before the first click. */
const HINT = 'Click a pose: the actor goes there.';

/**
 * @param {import('./element.js').ReprisePlayer} host
 * @param {import('./core.js').Core} core
 * @param {Record<string, (event: Event) => void>} act the actions by name
 */
export function buildView(host, core, act) {
  return new View(host, host.attachShadow({ mode: 'open' }), core, act);
}

class View {
  constructor(host, root, core, act) {
    this.host = host;
    this.root = root;
    this.styles = new Styles(root, tokens + stageStyles + scoreStyles);

    this.stage = new StageView(() => core.director?.player ?? null, {
      moved: () => core.redraw(),
      lost: () => core.session?.recover(),
      ghostClicked: (frame) => core.toolbox.take(frame),
      ghostHovered: (frame, x, y) => core.look(frame, this.onScreen(x, y)),
    });
    const thumbnail = (frame, width, height) => core.session?.thumbnail(frame, width, height) ?? null;
    const loaded = (frame) => core.director?.player.loaded(frame) ?? false;
    this.score = new Score({
      preview: (frame) => core.look(frame),
      go: (frame, later) => core.toolbox.take(frame, later),
      seek: (frame) => host.seek(frame),
      thumbnail,
      loaded,
    });
    this.transport = new Transport({ toggle: act.toggle, speed: (speed) => (host.speed = speed), loop: act.loop, drawer: act.drawer });
    this.preview = new Preview({ director: () => core.director, score: this.score, host, request: () => core.loop?.request() });
    this.progress = new ProgressBar();
    this.error = new ErrorCard((action) => core.mend(action));
    this.looks = new Looks({
      compare: (compare) => this.stage.setOptions({ compare }),
      originals: () => host.originals,
      missing: (message) => core.say(message, 'waiting'),
      dressed: () => {
        core.session.rebuilt = true;
        core.redraw();
        this.score.wantThumbnails();
      },
    });
    this.facts = new Facts();

    this.factsChip = button('facts', 'Cost, duration, deformation, frame time (F)', act.facts, { 'aria-expanded': 'false' });
    this.posesChip = button('poses', 'Poses the actor can reach, shown around it (P)', act.poses, { 'aria-pressed': 'false' });
    this.tintChip = button('tint', 'Recorded green, synthetic red (T)', act.tint, { 'aria-pressed': 'false' });
    this.parts = new Parts(act.parts);
    this.keysChip = button('keys', 'What the keys do (?)', act.help);
    this.poster = h('img', { class: 'poster', alt: '', hidden: true });
    this.dock = h('div', { class: 'dock', part: 'dock' });
    this.scoreBox = h('div', { class: 'score' }, this.score.root, this.dock, this.transport.root);
    this.handles = h('div', { class: 'handles' });
    this.bar = h('div', { class: 'bar', part: 'bar' }, slot('bar'));

    const stageBox = h(
      'div',
      { class: 'stage' },
      this.stage.root,
      this.handles,
      slot('poster', this.poster),
      this.facts.root,
      h('div', { class: 'chips left' }, this.factsChip),
      h('div', { class: 'chips right' }, this.looks.chip, this.posesChip, this.parts.chip, this.tintChip, this.keysChip),
      this.parts.legend,
      this.looks.list,
      slot('progress', this.progress.root),
      slot('error', this.error.root),
    );
    this.player = h('div', { class: 'player', part: 'player', 'data-state': 'loading' }, this.bar, stageBox, this.scoreBox, this.preview.tooltip.root);
    root.append(this.player);
    for (const type of ['dragover', 'drop']) this.player.addEventListener(type, (event) => core.toolbox.dropped(event));
    // Clicks on the stage leave the arrow keys with the score.
    this.stage.root.addEventListener('pointerdown', () => this.focusScore());
  }

  /** The element is in a page: that of this window. */
  enter(window) {
    this.window = window;
    this.dark = window.matchMedia('(prefers-color-scheme: dark)');
    this.calm = window.matchMedia('(prefers-reduced-motion: reduce)');
    this.styles.adopt(window);
  }

  /** It is in none any more. */
  leave() {
    this.window.cancelAnimationFrame(this.relaying);
    this.relaying = 0;
  }

  addStyles(text) {
    this.styles.add(text, this.window);
  }

  focusScore() {
    const strip = this.score.strips.find(({ root }) => root.tabIndex === 0);
    const target = this.host.hasAttribute('controls') && strip ? strip.root : this.stage.root;
    target.focus({ preventScroll: true, focusVisible: false });
  }

  onScreen(x, y) {
    const box = this.stage.root.getBoundingClientRect();
    return { x: box.left + x, y: box.top + y };
  }

  reset() {
    this.score.placeholder();
    this.preview.at(-1);
    this.looks.forget();
    this.parts.forget();
    this.preview.tooltip.hide();
    this.error.hide();
    this.progress.hide();
    this.transport.say('', 'hint');
    this.transport.setPlaying(false);
    this.stage.root.removeAttribute('data-shown');
    this.player.dataset.state = 'loading';
  }

  startLoading() {
    this.progress.show(0, 0);
  }

  /** What the actor is, in the page's own words; else its name. */
  setAlt(text) {
    this.alt = text;
    this.poster.alt = text;
    if (text && this.player.dataset.state !== 'shown') this.stage.root.setAttribute('aria-label', text);
  }

  showPoster(address) {
    if (address) this.poster.src = address;
    this.poster.hidden = !address || this.stage.root.hasAttribute('data-shown');
  }

  showStage() {
    this.stage.root.setAttribute('data-shown', '');
    this.player.dataset.state = 'shown';
    this.poster.hidden = true;
    if (!this.transport.status.textContent) this.transport.say(HINT, 'hint');
  }

  /** @param {boolean} over whether the picture stays to be seen behind the sentence */
  fail(kind, over) {
    this.progress.hide();
    this.preview.tooltip.hide();
    this.error.show(kind, over);
    if (!over) this.player.dataset.state = 'failed';
  }

  /** Lays the score out anew in the next frame, once, however many reasons there are. */
  relay() {
    if (this.relaying) return;
    this.relaying = this.window.requestAnimationFrame(() => {
      this.relaying = 0;
      this.score.relay();
    });
  }

  /** The page's colour behind the element, for the stage; undefined where the style gives it in another notation than rgb. */
  background() {
    const colour = getComputedStyle(this.host).backgroundColor.match(/^rgb\((\d+), (\d+), (\d+)\)$/);
    return colour ? colour.slice(1).map((part) => Number(part) / 255) : undefined;
  }

  /** @param {import('./director.js').Director} director */
  update(director, numbers) {
    const { state, timeline, info } = director;
    this.score.update(state);
    this.transport.update(state, timeline);
    this.transport.setPlaying(director.player.playing());
    this.describeStage(state, timeline, info);
    if (this.facts.open) this.facts.update({ info, state, families: director.families, ...numbers, adapter: this.adapter(), texture: this.stage.stage?.texture_setting() });
  }

  /** What a screen reader says of the picture; rewritten only when it would say something else. */
  describeStage(state, timeline, info) {
    const does = state.mode === 'paused' ? 'standing still in' : state.mode === 'synthetic' ? 'in a transition to' : 'in';
    const text = `${this.alt || info.name}, ${does} ${title(timeline.sequenceOf(state.frame))}`;
    if (this.stage.root.getAttribute('aria-label') !== text) this.stage.root.setAttribute('aria-label', text);
  }

  /** The graphics device; the engine may not know its name, the browser tells it a moment later. */
  adapter() {
    if (this.stage.stage && !this.known) {
      this.known = JSON.parse(this.stage.stage.adapter());
      if (!this.known.name) {
        const name = (info) => info?.description || [info?.vendor, info?.architecture].filter(Boolean).join(' ');
        navigator.gpu.requestAdapter().then((adapter) => (this.known.name = name(adapter?.info) || 'a device without a name'), () => {});
      }
    }
    return this.known ?? null;
  }

  toggleFacts(open) {
    this.facts.toggle(open);
    this.factsChip.setAttribute('aria-expanded', String(this.facts.open));
  }

  toggleDrawer() {
    const closed = this.scoreBox.toggleAttribute('data-closed');
    this.transport.setDrawer(!closed);
    this.relay();
  }

  setPoses(on) {
    this.posesChip.setAttribute('aria-pressed', String(on));
  }

  setTint(on) {
    this.tintChip.setAttribute('aria-pressed', String(on));
  }
}

/** A place that the page may fill; without that it holds our own. */
function slot(name, ...ours) {
  return h('slot', { name }, ...ours);
}
