/** What can go wrong, and what the page says about it: one sentence what happened, one what to do, a button that does it. */

import { h, icon } from './dom.js';

/** An error with a kind from the closed set below; the wasm module throws errors of the same shape. */
export class PlayerError extends Error {
  /** @param {import('../reprise-player').ErrorKind} kind */
  constructor(kind, message, options) {
    super(message, options);
    this.name = 'PlayerError';
    this.kind = kind;
  }
}

/** Names an action; `element.js` knows how to do each. */
const AGAIN = { label: 'Try again', action: 'again' };
const RELOAD = { label: 'Reload the page', action: 'reload' };
const FETCH = { label: 'Load it again', action: 'again' };

/** @type {Record<string, {happened: string, todo: string, button: {label: string, action: string}}>} */
const WORDS = {
  'no-webgpu': {
    happened: 'This browser has no WebGPU.',
    todo: 'Reprise needs it to draw; Chrome and Edge 113, Safari 26 and Firefox 141 have it.',
    button: { label: 'Copy this page’s address', action: 'copy' },
  },
  'insecure': {
    happened: 'This page was opened without https, and browsers offer WebGPU only with it.',
    todo: 'Open the same page over https.',
    button: { label: 'Open over https', action: 'secure' },
  },
  'no-adapter': {
    happened: 'The browser found no graphics adapter to draw with.',
    todo: 'Switch on hardware acceleration in the browser’s settings, or restart the browser.',
    button: AGAIN,
  },
  'device-lost': {
    happened: 'The graphics device was lost and does not come back.',
    todo: 'Close other pages that draw a lot, then try again.',
    button: AGAIN,
  },
  'bad-address': {
    happened: 'The address of the actor cannot be used.',
    todo: 'Give the http or https address of a .reprise file.',
    button: AGAIN,
  },
  'not-found': {
    happened: 'There is no actor at this address.',
    todo: 'Check the address: it should be that of a .reprise file.',
    button: AGAIN,
  },
  'network': {
    happened: 'The actor could not be fetched.',
    todo: 'Check the connection, and whether that site lets other pages read its files.',
    button: AGAIN,
  },
  'not-reprise': {
    happened: 'This file is not a Reprise actor.',
    todo: 'Give the address of a file that builder pack has written.',
    button: AGAIN,
  },
  'too-new': {
    happened: 'This actor was packed by a newer Reprise than this page’s.',
    todo: 'Reload to get the newest player; if that does not help, the site has to bring it up to date.',
    button: RELOAD,
  },
  'damaged': {
    happened: 'The actor’s file is damaged.',
    todo: 'Load it again; if that does not help, pack it again.',
    button: FETCH,
  },
  'truncated': {
    happened: 'The actor’s file ends too early.',
    todo: 'Load it again; if that does not help, the copy on the server is incomplete.',
    button: FETCH,
  },
  'engine': {
    happened: 'The player’s own program could not be loaded.',
    todo: 'Check the connection, then reload the page.',
    button: RELOAD,
  },
  'internal': {
    happened: 'The player has stopped: something went wrong inside it.',
    todo: 'Reload the page; if it happens again, please report it.',
    button: RELOAD,
  },
};

/** The kind of anything that was thrown; what is not ours is `internal`. */
export function kindOf(error) {
  const kind = error?.kind;
  return typeof kind === 'string' && kind in WORDS ? kind : 'internal';
}

/** The page's sentences for a kind. */
export function wordsFor(kind) {
  return WORDS[kind] ?? WORDS.internal;
}

/** Throws when this browser cannot draw at all, before anything is fetched. */
export function checkSupport() {
  if (globalThis.navigator?.gpu) return;
  if (globalThis.isSecureContext === false && location.protocol === 'http:') {
    throw new PlayerError('insecure', wordsFor('insecure').happened);
  }
  throw new PlayerError('no-webgpu', wordsFor('no-webgpu').happened);
}

/** The card that says it. */
export class ErrorCard {
  /** @param {(action: string) => void} act called with the button's action */
  constructor(act) {
    this.happened = h('p', { class: 'happened' });
    this.todo = h('p', { class: 'todo' });
    this.button = h('button', { type: 'button', class: 'button' });
    this.root = h('div', { class: 'error', role: 'alert', part: 'error', hidden: true }, icon('absent'), this.happened, this.todo, this.button);
    this.button.addEventListener('click', () => act(this.button.value));
  }

  /** @param {boolean} over whether there is a picture behind, which the card then leaves to be seen */
  show(kind, over) {
    const { happened, todo, button } = wordsFor(kind);
    this.happened.textContent = happened;
    this.todo.textContent = todo;
    this.button.textContent = button.label;
    this.button.value = button.action;
    this.root.dataset.kind = kind;
    this.root.toggleAttribute('data-over', over);
    this.root.hidden = false;
  }

  hide() {
    this.root.hidden = true;
  }
}
