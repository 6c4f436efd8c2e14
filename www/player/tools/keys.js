/** The dialog that lists what keys and pointers do. */

import { h, iconButton } from '../dom.js';
import { KEYS } from '../keyboard.js';

const ON_STAGE = [
  { shown: '← → ↑ ↓', does: 'turn the camera, when the stage has the focus' },
  { shown: '+ −', does: 'come closer, go away' },
];

const WITH_TOOLS = [
  { shown: 'Enter', does: 'go: on the path, to the place, through the key poses' },
  { shown: 'Ctrl + Z, Y', does: 'undo, redo' },
  { shown: '← → ↑ ↓', does: 'move the point or the key pose that has the focus' },
  { shown: '+, Delete', does: 'a point after it; without it' },
  { shown: 'Page ↑ ↓', does: 'lift a path’s point, or lower it; alt and drag does too' },
  { shown: 'alt + drag', does: 'turn the camera while a tool is in use' },
  { shown: 'shift, edit', does: 'while a point of the actor is dragged: straight up or down' },
];

const POINTER = [
  { shown: 'shift + click', does: 'go to that pose after what is under way' },
  { shown: 'drag', does: 'turn the camera' },
  { shown: 'shift + drag', does: 'move it; with the right button or two fingers too' },
  { shown: 'wheel, pinch', does: 'come closer, go away' },
  { shown: 'double click', does: 'back to the actor' },
];

export class KeysDialog {
  constructor() {
    const rows = (list) => list.map(({ shown, does }) => h('div', {}, h('dt', {}, h('kbd', {}, shown)), h('dd', {}, does)));
    const close = iconButton('close', 'Close (Esc)', () => this.root.close());
    this.root = h(
      'dialog',
      { class: 'keys', 'aria-labelledby': 'keys-title' },
      h('header', {}, h('h2', { id: 'keys-title' }, 'Keys'), close),
      h('dl', {}, ...rows(KEYS)),
      h('h3', {}, 'On the stage'),
      h('dl', {}, ...rows([...POINTER, ...ON_STAGE])),
      h('h3', {}, 'With the tools'),
      h('dl', {}, ...rows(WITH_TOOLS)),
    );
    this.root.addEventListener('click', (event) => {
      if (event.target === this.root) this.root.close();
    });
  }

  toggle() {
    if (this.root.open) this.root.close();
    else this.root.showModal();
  }
}
