/** The menu that passes the direction on: as a link and as a file, with what came of it. */

import { button, h, iconButton } from '../dom.js';
import { PlayerError } from '../errors.js';
import { parse } from './link.js';

export class Share {
  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    this.box = box;
    const item = (text, title, act) =>
      button(text, title, () => {
        this.open(false);
        box.core.attempt(act);
      });
    this.file = h('input', { type: 'file', accept: '.json,application/json', hidden: true, 'aria-label': 'A direction from a file' });
    this.file.addEventListener('change', () => this.read(this.file.files[0]));
    this.clip = h('input', { type: 'file', accept: '.bvh,.asf,.amc', multiple: true, hidden: true, 'aria-label': 'A clip of motion capture' });
    this.clip.addEventListener('change', () => {
      box.drive([...this.clip.files]).catch(() => {});
      this.clip.value = '';
    });
    this.menu = h(
      'div',
      { class: 'menu', role: 'group', 'aria-label': 'Share', hidden: true },
      item('Copy link', 'What is asked, as a link', () => this.copy()),
      item('Save as JSON', 'What is asked, and what came of it', () => this.save()),
      item('Load JSON…', 'What was saved', () => this.file.click()),
      item('Motion capture…', 'A clip that the actor performs: .bvh, or .asf with .amc', () => this.clip.click()),
    );
    this.button = iconButton('share', 'Share (what is asked, as a link or a file; motion capture)', () => this.open(this.menu.hidden), { 'aria-expanded': 'false' });
    this.root = h('div', { class: 'share' }, this.button, this.menu, this.file, this.clip);
    this.root.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || this.menu.hidden) return;
      event.stopPropagation();
      this.open(false);
      this.button.focus();
    });
    this.root.addEventListener('focusout', ({ relatedTarget }) => this.root.contains(relatedTarget) || this.open(false));
  }

  open(on) {
    this.menu.hidden = !on;
    this.button.setAttribute('aria-expanded', String(on));
    if (on) this.menu.firstChild.focus();
  }

  copy() {
    if (!this.box.shared) throw new PlayerError('bad-argument', 'There is nothing to share yet.');
    return this.write(`${location.href.split('#')[0]}${this.box.core.host.link}`);
  }

  async write(link) {
    try {
      await navigator.clipboard.writeText(link);
      this.box.core.say('the link is copied');
    } catch {
      // Without leave to copy, the address bar has it.
      location.hash = this.box.core.host.link;
      this.box.core.say('the link is in the address bar');
    }
  }

  save() {
    const { shared, answer, tool } = this.box;
    if (!shared) throw new PlayerError('bad-argument', 'There is nothing to save yet.');
    const text = `${JSON.stringify({ ...shared, answer })}\n`;
    const address = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
    h('a', { href: address, download: `${tool.id}.json` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
  }

  async read(file) {
    this.file.value = '';
    if (!file) return;
    const text = await file.text().catch(() => '');
    this.box.core.attempt(() => this.box.load(parse(text)));
  }
}
