/** The attributes of `<reprise-player>` as properties. What they mean is told in `reprise-player.d.ts`. */

/** Servers have no elements; the class still has to exist there. */
const Base = globalThis.HTMLElement ?? class {};

export class AttributeElement extends Base {
  get theme() {
    const theme = this.getAttribute('theme');
    return theme === 'light' || theme === 'dark' ? theme : null;
  }

  set theme(value) {
    if (value) this.setAttribute('theme', value);
    else this.removeAttribute('theme');
  }

  get speed() {
    const speed = Number(this.getAttribute('speed') ?? 1);
    return Number.isFinite(speed) && speed > 0 ? speed : 1;
  }

  set speed(value) {
    this.setAttribute('speed', String(value));
  }
}

for (const name of ['src', 'poster']) {
  Object.defineProperty(AttributeElement.prototype, name, {
    get() {
      return this.getAttribute(name) ?? '';
    },
    set(value) {
      this.setAttribute(name, value);
    },
  });
}

for (const name of ['controls', 'autoplay', 'loop', 'tint']) {
  Object.defineProperty(AttributeElement.prototype, name, {
    get() {
      return this.hasAttribute(name);
    },
    set(on) {
      this.toggleAttribute(name, Boolean(on));
    },
  });
}
