/** Builds the element's shadow tree and puts the parts in their places. */

import { h } from './dom.js';
import { ErrorCard } from './errors.js';
import { Facts } from './facts.js';
import { title } from './format.js';
import { KeysDialog } from './keyboard.js';
import { ProgressBar } from './loading.js';
import { Preview } from './preview.js';
import { Score } from './score.js';
import { StageView } from './stage-view.js';
import { Transport } from './transport.js';
import { scoreStyles } from './styles/score.js';
import { stageStyles } from './styles/stage.js';
import { tokens } from './styles/tokens.js';

let sheet = null;

/** One constructed style sheet for all players: no style element that a content security policy would refuse. */
function styles() {
  if (!sheet) {
    sheet = new CSSStyleSheet();
    sheet.replaceSync(tokens + stageStyles + scoreStyles);
  }
  return sheet;
}

/** What the page may say before the first click. */
const HINT = 'Click a pose: the actor goes there.';

/**
 * @param {HTMLElement} host
 * @param {object} on what the parts report; see `ReprisePlayer`
 */
export function buildView(host, on) {
  const root = host.attachShadow({ mode: 'open' });
  root.adoptedStyleSheets = [styles()];
  return new View(host, root, on);
}

class View {
  constructor(host, root, on) {
    this.host = host;
    this.dark = matchMedia('(prefers-color-scheme: dark)');
    this.calm = matchMedia('(prefers-reduced-motion: reduce)');
    const { act } = on;

    this.stage = new StageView(() => on.director()?.player ?? null, {
      moved: on.moved,
      lost: on.lost,
      ghostClicked: on.go,
      ghostHovered: (frame, x, y) => on.preview(frame, this.onScreen(x, y), false),
    });
    this.score = new Score({ ...on, preview: (frame) => on.preview(frame, null, false) });
    this.transport = new Transport({ toggle: act.toggle, speed: on.speed, loop: act.loop, drawer: act.drawer });
    this.preview = new Preview({ director: on.director, score: this.score, host, request: on.request });
    this.progress = new ProgressBar();
    this.error = new ErrorCard(on.errorAction);
    this.facts = new Facts();
    this.keys = new KeysDialog();

    this.factsChip = chip('facts', 'Cost, duration, deformation, frame time (F)', act.facts);
    this.posesChip = chip('poses', 'Poses the actor can reach, shown around it (P)', act.poses);
    this.tintChip = chip('tint', 'Recorded green, synthetic red (T)', act.tint);
    this.keysChip = chip('keys', 'What the keys do (?)', act.help);
    this.factsChip.setAttribute('aria-expanded', 'false');
    this.poster = h('img', { class: 'poster', alt: '', hidden: true });
    this.scoreBox = h('div', { class: 'score' }, this.score.root, this.transport.root);

    const stageBox = h(
      'div',
      { class: 'stage' },
      this.stage.root,
      this.poster,
      this.facts.root,
      h('div', { class: 'chips left' }, this.factsChip),
      h('div', { class: 'chips right' }, this.posesChip, this.tintChip, this.keysChip),
      this.progress.root,
      this.error.root,
    );
    this.player = h('div', { class: 'player', part: 'player', 'data-state': 'loading' }, stageBox, this.scoreBox, this.preview.tooltip.root);
    root.append(this.player, this.keys.root);
    // Clicks on the stage leave the arrow keys with the score.
    this.stage.root.addEventListener('pointerdown', () => this.focusScore());
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
    this.relaying = requestAnimationFrame(() => {
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
    if (this.facts.open) this.facts.update({ info, state, ...numbers, adapter: this.adapter() });
  }

  /** What a screen reader says of the picture; rewritten only when it would say something else. */
  describeStage(state, timeline, info) {
    const does = state.mode === 'paused' ? 'standing still in' : state.mode === 'synthetic' ? 'in a transition to' : 'in';
    const text = `${info.name}, ${does} ${title(timeline.sequenceOf(state.frame))}`;
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

function chip(text, title, act) {
  const button = h('button', { type: 'button', class: 'chip', title, 'aria-pressed': text === 'poses' || text === 'tint' ? 'false' : null }, text);
  button.addEventListener('click', act);
  return button;
}
