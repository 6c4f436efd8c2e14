/** What the keys do on this page, in one table: the handler and the dialog that lists them both read it. */

import { button, h, isWriting } from './dom.js';

/** Frames that a letter goes on with shift. */
const FAR = 10;

/** @type {{keys: string[], shown: string, does: string, act: (page: import('./page.js').Page, event: KeyboardEvent) => void}[]} */
const KEYS = [
  { keys: ['m'], shown: 'M', does: 'match: the two poses that are shown mean the same', act: (page) => page.match() },
  { keys: ['a', 'd'], shown: 'A D', does: 'the source a frame back, a frame on; ten with shift', act: (page, event) => step(page, page.source, event, 'd') },
  { keys: ['j', 'l'], shown: 'J L', does: 'the target a frame back, a frame on; ten with shift', act: (page, event) => step(page, page.target, event, 'l') },
  { keys: ['p', 'n'], shown: 'P N', does: 'the pair before, the next pair', act: (page, event) => page.selectNext(event.key.toLowerCase() === 'n' ? 1 : -1) },
  { keys: ['Delete', 'Backspace'], shown: 'Delete', does: 'delete the selected pair', act: (page) => page.remove(page.store.selected) },
  { keys: [' '], shown: 'Space', does: 'play source and target at matched frames, or pause', act: (page) => page.togglePlaying() },
  { keys: ['?'], shown: '?', does: 'these keys', act: (page) => page.help.toggle() },
];
const MORE = [
  { shown: '← → Page ↑ ↓ Home End', does: 'on a ruler: frames; on the end of a pair: moves it; on the map: along its path' },
  { shown: 'Ctrl + Z, Ctrl + Shift + Z', does: 'undo, redo' },
  { shown: 'Ctrl + S', does: 'save keys.toml' },
];
/** Keys that the players would take for their own. */
const PLAYER = /^([a-z1-6? ]|Enter|Home|End|Escape)$/;

function step(page, side, { key, shiftKey }, on) {
  page.stop();
  side.step((key.toLowerCase() === on ? 1 : -1) * (shiftKey ? FAR : 1));
}

/** Runs before the players hear of a key. @param {import('./page.js').Page} page */
export function handleKey(event, page) {
  const target = event.target;
  const writes = isWriting(target);
  if (event.altKey || page.help.root.open) return;
  if (event.ctrlKey || event.metaKey) {
    if (withControl(event, page, writes)) event.preventDefault();
    return;
  }
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (writes || (target.closest?.('button, a') && (key === ' ' || key === 'Enter'))) return;
  const entry = KEYS.find(({ keys }) => keys.includes(key));
  const inPlayer = target.localName === 'reprise-player';
  if (entry) {
    event.preventDefault();
    entry.act(page, event);
  }
  if (entry || (inPlayer && PLAYER.test(key))) event.stopPropagation();
}

/** @returns whether the key was used */
function withControl({ key, shiftKey }, page, writes) {
  const letter = key.toLowerCase();
  if (letter === 's') page.save();
  else if (writes) return false;
  else if (letter === 'z') page.store.step(shiftKey ? 1 : -1);
  else if (letter === 'y') page.store.step(1);
  else return false;
  return true;
}

export class KeysDialog {
  constructor() {
    const rows = [...KEYS, ...MORE].map(({ shown, does }) => h('div', {}, h('dt', {}, h('kbd', {}, shown)), h('dd', {}, does)));
    const close = button('Close', () => this.root.close());
    this.root = h('dialog', { 'aria-labelledby': 'keys-title' }, h('header', {}, h('h2', { id: 'keys-title' }, 'Keys'), close), h('dl', {}, ...rows));
    this.root.addEventListener('click', (event) => {
      if (event.target === this.root) this.root.close();
    });
  }

  toggle() {
    if (this.root.open) this.root.close();
    else this.root.showModal();
  }
}
