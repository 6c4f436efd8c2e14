/** The page put together: two actors, the pairs between them, their files, and what came of them. */

import { button, h } from './dom.js';
import { choose, fetched, listenForDrops, save, textOf } from './files.js';
import { KeysDialog, handleKey } from './keyboard.js';
import { Links } from './links.js';
import { PairList } from './list.js';
import { MapView } from './map-view.js';
import { linearMaps, readTransfer } from './maps.js';
import { Playing } from './playing.js';
import { ResultView } from './result.js';
import { Ruler } from './ruler.js';
import { check, pairName } from './rules.js';
import { Side } from './side.js';
import { Store } from './store.js';
import { readKeys, writeKeys } from './toml.js';

export class Page {
  /** @param {Document} document */
  constructor(document) {
    const at = (selector) => document.querySelector(selector);
    this.store = new Store();
    this.transfer = null;
    this.source = new Side(at('#source'), 'Source');
    this.target = new Side(at('#target'), 'Target');
    this.line = at('.say');
    this.list = new PairList({
      select: (pair) => this.select(pair),
      edit: (pair, part, merge) => this.edit(pair, part, merge),
      remove: (pair) => this.remove(pair),
    });
    this.rulers = [new Ruler(this.source, 'fromFrame', this.ends('fromFrame')), new Ruler(this.target, 'toFrame', this.ends('toFrame'))];
    this.links = new Links((pair) => this.select(pair));
    this.playing = new Playing(this.source, this.target, () => this.shownMaps(), () => this.showPlaying());
    this.map = new MapView((from, to) => this.showFrames(from, to));
    this.result = new ResultView(this.source, { stop: () => this.stop(), say: (text) => this.say(text) });
    this.help = new KeysDialog();
    this.buildBars(at);
    at('#pairs').append(this.list.root);
    at('#map').append(this.map.root);
    at('#result').append(this.result.root);
    document.body.append(this.help.root);
    this.listen(document);
    this.update();
  }

  buildBars(at) {
    this.opener = button('Open keys.toml…', () => this.ask('.toml'));
    this.saver = button('Save keys.toml', () => this.save(), { class: 'main' });
    this.copier = button('Copy', () => this.copy(), { 'aria-label': 'Copy keys.toml as text' });
    this.learned = button('Open transfer.json…', () => this.ask('.json'));
    this.undoer = button('Undo', () => this.store.step(-1), { title: 'Ctrl + Z' });
    this.redoer = button('Redo', () => this.store.step(1), { title: 'Ctrl + Shift + Z' });
    const help = button('Keys', () => this.help.toggle(), { title: 'What keys do (?)' });
    at('.files').append(this.opener, this.saver, this.copier, this.learned, this.undoer, this.redoer, help);

    this.demo = button('Try it with the demo', () => this.openDemo(), { class: 'quiet-button' });
    this.matcher = button('Match', () => this.match(), { class: 'main', title: 'These two poses mean the same (M)', disabled: true });
    this.deleter = button('Delete', () => this.remove(this.store.selected), { title: 'Deletes the selected pair (Delete)', disabled: true });
    this.stretch = h('input', { list: 'stretches', size: 10, placeholder: 'none', spellcheck: 'false', autocomplete: 'off' });
    const label = h('label', { title: 'Frames are matched between keys of one stretch, not from one to the next' }, 'Stretch of new pairs ', this.stretch);
    this.player = button('Play matched', () => this.togglePlaying(), { title: 'Source and target at matched frames (Space)', disabled: true });
    const bar = h('div', { class: 'match-bar' }, this.matcher, this.deleter, label, this.demo, this.player);
    at('.matching').append(bar, this.rulers[0].root, this.links.root, this.rulers[1].root);
  }

  /** What a ruler asks for. */
  ends(end) {
    return {
      select: (pair) => this.select(pair),
      stop: () => this.stop(),
      move: (pair, frame, merge) => {
        this.stop();
        this.edit(pair, { [end]: frame }, merge);
      },
    };
  }

  listen(document) {
    this.store.addEventListener('change', () => this.update());
    for (const side of [this.source, this.target]) {
      side.addEventListener('open', () => this.opened(side));
      side.addEventListener('show', () => this.shown());
      side.addEventListener('trouble', ({ detail }) => this.say(detail));
    }
    listenForDrops((file, target) => this.take(file, target));
    document.addEventListener('keydown', (event) => handleKey(event, this), true);
    window.addEventListener('beforeunload', (event) => this.store.unsaved && event.preventDefault());
  }

  say(text) {
    this.line.textContent = text;
  }

  // ---- files ----------------------------------------------------------------------------------------------------

  /** Opens what the page's address names. */
  async open({ from, to, keys, transfer, result }) {
    if (from) this.source.open(from);
    if (to) this.target.open(to);
    if (result) this.result.open(result);
    for (const address of [keys, transfer]) {
      if (!address) continue;
      try {
        await this.take(await fetched(address), null);
      } catch (error) {
        this.say(error.message);
      }
    }
  }

  openDemo() {
    this.source.open('demo.reprise');
    this.target.open('demo.reprise');
  }

  async ask(accept) {
    const file = await choose(accept);
    if (file) await this.take(file, null);
  }

  /** A file that was opened, or dropped onto something. */
  async take(file, target) {
    const ending = file.name.split('.').at(-1).toLowerCase();
    try {
      if (ending === 'toml') this.readKeys(await textOf(file), file.name);
      else if (ending === 'json') this.readTransfer(await textOf(file), file.name);
      else if (ending === 'reprise') this.takeActor(file, target);
      else this.say(`${file.name}: this page reads .reprise files, keys.toml and transfer.json.`);
    } catch (error) {
      this.say(`${file.name}: ${error.message}`);
    }
  }

  takeActor(file, target) {
    const free = () => [this.source, this.target].find((side) => !side.info && !side.name) ?? this.result;
    const over = [this.source, this.target].find(({ root }) => target && root.contains(target));
    (over ?? (target?.closest('#result') ? this.result : free())).open(file);
  }

  readKeys(text, name) {
    const file = readKeys(text);
    this.stop();
    this.store.replace(file);
    this.store.keep();
    this.say(`${name}: ${counted(file.pairs.length, 'pair')} read.${this.store.canUndo ? ' Undo brings back what was here.' : ''}`);
    if (this.store.pairs[0]) this.showFirst();
  }

  /** Shows the sequences of the first pair, if these players have them. */
  showFirst() {
    const pair = this.store.pairs.find(({ from, to }) => this.source.sequenceOf(from) && this.target.sequenceOf(to));
    if (pair) this.showPair(pair);
  }

  readTransfer(text, name) {
    const transfer = readTransfer(text);
    this.transfer = transfer;
    const none = this.store.pairs.length === 0;
    if (none && transfer.pairs.length > 0) {
      this.store.replace({ pairs: transfer.pairs, tail: [] });
      this.showFirst();
    }
    const taken = none ? `, and its ${counted(transfer.pairs.length, 'key')}` : '';
    this.say(`${name}: ${counted(transfer.maps.length, 'map')} of frames read${taken}.`);
    this.result.tell(transfer);
    this.update();
  }

  get text() {
    return writeKeys(this.store.file);
  }

  save() {
    save('keys.toml', this.text);
    this.store.keep();
    this.say(`keys.toml is saved, with ${counted(this.store.pairs.length, 'pair')}.`);
  }

  async copy() {
    try {
      await navigator.clipboard.writeText(this.text);
      this.say(`keys.toml is copied as text, with ${counted(this.store.pairs.length, 'pair')}.`);
    } catch {
      this.say('The browser does not let this page copy; use Save keys.toml.');
    }
  }

  // ---- pairs ----------------------------------------------------------------------------------------------------

  match() {
    const { source, target } = this;
    if (!source.sequence || !target.sequence) return;
    this.stop();
    const stretch = this.stretch.value === '' ? null : this.stretch.value;
    const pair = { from: source.sequence.name, fromFrame: source.whole, to: target.sequence.name, toFrame: target.whole, stretch };
    const isNew = this.store.add(pair);
    // What was between two frames while it played is exactly the matched one now.
    this.showPair(pair);
    this.say(isNew ? `Matched ${pairName(pair)}.` : `${pairName(pair)} is matched already.`);
    this.list.reveal(this.store.chosen);
  }

  select(pair) {
    if (pair.id === this.store.chosen) return;
    this.stop();
    this.store.select(pair.id);
    this.showPair(pair);
    this.list.reveal(pair.id);
  }

  /** Selects the next pair, or the one before. */
  selectNext(by) {
    const { pairs, selected } = this.store;
    const at = selected ? pairs.indexOf(selected) + by : by > 0 ? 0 : pairs.length - 1;
    if (pairs[at]) this.select(pairs[at]);
  }

  edit(pair, part, merge) {
    this.store.edit(pair.id, part, merge);
    this.showPair({ ...pair, ...part });
  }

  remove(pair) {
    if (!pair) return;
    this.stop();
    const focused = document.activeElement?.dataset?.id === String(pair.id);
    this.store.remove(pair.id);
    this.say(`Deleted ${pairName(pair)}.`);
    const { selected } = this.store;
    if (selected) this.showPair(selected);
    if (focused) this.rulers[0].lane.focus();
  }

  /** Both poses of a pair. */
  showPair(pair) {
    const [from, to] = [this.source.sequenceOf(pair.from), this.target.sequenceOf(pair.to)];
    if (from) this.source.show(from, pair.fromFrame);
    if (to) this.target.show(to, pair.toFrame);
  }

  /** Frames of the sequences that are shown, fractions allowed. */
  showFrames(from, to) {
    this.stop();
    this.source.show(this.source.sequence, from);
    this.target.show(this.target.sequence, to);
  }

  // ---- playing --------------------------------------------------------------------------------------------------

  stop() {
    this.playing.stop();
    this.result.stop();
  }

  togglePlaying() {
    this.result.stop();
    if (!this.playing.toggle()) this.say('There is nothing to play: match at least two frames of these two sequences, in one stretch.');
  }

  showPlaying() {
    this.player.textContent = this.playing.on ? 'Pause' : 'Play matched';
  }

  /** The maps between the sequences that are shown: as they were learned, while the keys are those; else straight between keys. */
  shownMaps() {
    const [from, to] = [this.source.sequence?.name, this.target.sequence?.name];
    const learned = this.transfer?.fits(this.store.pairs) ? this.transfer.maps : null;
    return (learned ?? linearMaps(this.store.pairs)).filter((map) => map.from === from && map.to === to);
  }

  // ---- what is shown --------------------------------------------------------------------------------------------

  opened(side) {
    this.stop();
    if (side.info) this.showFirst();
    this.result.update();
    this.update();
  }

  /** Another frame, or another sequence. */
  shown() {
    const sequences = `${this.source.sequence?.name}\n${this.target.sequence?.name}`;
    this.rulers.forEach((ruler) => ruler.update());
    if (sequences !== this.sequences) this.update();
    this.sequences = sequences;
    this.map.point(this.source.frame, this.target.frame);
    this.result.follow();
  }

  /** Pairs, or actors, have changed. */
  update() {
    const { store, source, target } = this;
    const findings = check(store.pairs, source.info, target.info);
    const wrong = new Set(findings.filter(({ kind }) => kind === 'wrong').flatMap(({ pairs }) => pairs.map(({ id }) => id)));
    const shown = store.pairs.filter((pair) => pair.from === source.sequence?.name && pair.to === target.sequence?.name);
    const ready = Boolean(source.sequence && target.sequence);
    this.rulers.forEach((ruler) => {
      ruler.update();
      ruler.showEnds(shown, store.chosen, wrong);
    });
    this.links.show(shown, this.rulers, store.chosen, wrong, ready ? 'No frames of these two sequences are matched yet.' : 'Here, lines will join frames that mean the same.');
    this.list.show(store.pairs, store.chosen, wrong);
    this.list.tell(findings);
    this.map.show({ source, target, pairs: shown, maps: this.shownMaps(), transfer: this.transfer, stale: Boolean(this.transfer && !this.transfer.fits(store.pairs)) });
    this.matcher.disabled = !ready;
    this.player.disabled = !ready || this.shownMaps().length === 0;
    this.demo.hidden = Boolean(source.name || target.name);
    this.deleter.disabled = !store.selected;
    this.saver.disabled = this.copier.disabled = store.pairs.length === 0;
    this.undoer.disabled = !store.canUndo;
    this.redoer.disabled = !store.canRedo;
  }
}

function counted(count, what) {
  return count === 1 ? `1 ${what}` : `${count} ${what}s`;
}
