/** All pairs as a table, to read and to correct, and below it what is wrong with them. */

import { button, h } from './dom.js';
import { pairName } from './rules.js';

export class PairList {
  /**
   * @param {object} act
   * @param {(pair: object) => void} act.select
   * @param {(pair: object, part: object, merge: string | null) => void} act.edit
   * @param {(pair: object) => void} act.remove
   */
  constructor(act) {
    this.act = act;
    this.rows = new Map();
    this.body = h('tbody');
    const head = ['Source', 'Frame', 'Target', 'Frame', 'Stretch'].map((name) => h('th', { scope: 'col' }, name));
    this.table = h('table', {}, h('caption', { class: 'unseen' }, 'All pairs'), h('thead', {}, h('tr', {}, ...head, h('td'))), this.body);
    this.names = h('datalist', { id: 'stretches' });
    this.sentence = h('p', { class: 'quiet' }, 'No pairs yet. Show a pose of the source and the pose of the target that means the same, then match them: three pairs at least, best five for each sequence.');
    this.findings = h('ul', { class: 'findings', 'aria-live': 'polite', 'aria-label': 'What is wrong with the pairs' });
    this.root = h('div', { class: 'pairs' }, this.findings, this.sentence, this.table, this.names);
  }

  show(pairs, chosen, wrong) {
    this.table.hidden = pairs.length === 0;
    this.sentence.hidden = pairs.length > 0;
    const ids = new Set(pairs.map(({ id }) => id));
    for (const [id, row] of this.rows) {
      if (ids.has(id)) continue;
      row.root.remove();
      this.rows.delete(id);
    }
    pairs.forEach((pair, index) => {
      const row = this.rows.get(pair.id) ?? this.row(pair.id);
      if (this.body.children[index] !== row.root) this.body.insertBefore(row.root, this.body.children[index] ?? null);
      row.show(pair, pair.id === chosen, wrong.has(pair.id));
    });
    const names = [...new Set(pairs.map(({ stretch }) => stretch).filter((name) => name !== null))];
    if (names.join('\n') !== this.known) this.names.replaceChildren(...names.map((value) => h('option', { value })));
    this.known = names.join('\n');
  }

  /** Shows the row of a pair. */
  reveal(id) {
    this.rows.get(id)?.root.scrollIntoView({ block: 'nearest' });
  }

  /** @param {import('./rules.js').Finding[]} findings */
  tell(findings) {
    const text = findings.map((one) => one.kind + one.text).join('\n');
    if (text === this.told) return;
    this.told = text;
    this.findings.replaceChildren(...findings.map(({ kind, text: words, pairs }) => {
      const [pair] = pairs;
      const what = pair ? button(words, () => this.act.select(pair), { title: 'Show it' }) : words;
      return h('li', { 'data-kind': kind }, what);
    }));
  }

  row(id) {
    const row = new Row(id, this.act);
    this.rows.set(id, row);
    return row;
  }
}

class Row {
  constructor(id, act) {
    this.id = id;
    this.act = act;
    this.from = h('td');
    this.to = h('td');
    this.fromFrame = this.number('fromFrame');
    this.toFrame = this.number('toFrame');
    this.stretch = h('input', { list: 'stretches', size: 8, placeholder: 'none', spellcheck: 'false', autocomplete: 'off' });
    this.stretch.addEventListener('change', () => act.edit(this.pair, { stretch: this.stretch.value === '' ? null : this.stretch.value }, null));
    this.gone = button('✕', () => this.remove(), { class: 'quiet-button', title: 'Delete' });
    const cell = (...children) => h('td', {}, ...children);
    this.root = h('tr', {}, this.from, cell(this.fromFrame), this.to, cell(this.toFrame), cell(this.stretch), cell(this.gone));
    const select = ({ target }) => target !== this.gone && act.select(this.pair);
    this.root.addEventListener('click', select);
    this.root.addEventListener('focusin', select);
  }

  /** The focus goes on to the next row. */
  remove() {
    const next = this.root.nextElementSibling ?? this.root.previousElementSibling;
    this.act.remove(this.pair);
    next?.querySelector('button').focus();
  }

  number(end) {
    const input = h('input', { type: 'number', min: 0, step: 1, inputmode: 'numeric' });
    input.addEventListener('input', () => {
      const frame = input.valueAsNumber;
      if (Number.isInteger(frame) && frame >= 0) this.act.edit(this.pair, { [end]: frame }, `typed ${this.id} ${end}`);
    });
    // What is no frame is not taken.
    input.addEventListener('change', () => (input.value = String(this.pair[end])));
    return input;
  }

  show(pair, chosen, wrong) {
    this.pair = pair;
    const name = pairName(pair);
    this.root.toggleAttribute('data-chosen', chosen);
    this.root.toggleAttribute('data-wrong', wrong);
    this.root.setAttribute('aria-current', String(chosen));
    [this.from.textContent, this.to.textContent] = [pair.from, pair.to];
    for (const [input, value, label] of [
      [this.fromFrame, String(pair.fromFrame), `Frame of the source in ${name}`],
      [this.toFrame, String(pair.toFrame), `Frame of the target in ${name}`],
      [this.stretch, pair.stretch ?? '', `Stretch of ${name}`],
    ]) {
      if (input.value !== value) input.value = value;
      input.setAttribute('aria-label', label);
    }
    this.gone.setAttribute('aria-label', `Delete ${name}`);
  }
}
