/** The attributes of `<reprise-player>` as properties. What they mean is told in `reprise-player.d.ts`. */

/** Servers have no elements; the class still has to exist there. */
const Base = globalThis.HTMLElement ?? class {};

/** Attributes that are words, and the words that they may be; the first one is meant where there is none. */
const WORDS = { loading: ['eager', 'lazy'], tool: ['pose', 'place', 'path', 'timing', 'wander', 'edit'], theme: [null, 'light', 'dark'] };

/** As requests have it. */
const MOST_QUICKNESS = 1000;

export class AttributeElement extends Base {
  get speed() {
    const speed = Number(this.getAttribute('speed') ?? 1);
    return Number.isFinite(speed) && speed > 0 ? speed : 1;
  }

  set speed(value) {
    reflect(this, 'speed', value);
  }

  get quickness() {
    const quickness = Number(this.getAttribute('quickness') ?? NaN);
    return quickness > 0 && quickness <= MOST_QUICKNESS ? quickness : null;
  }

  set quickness(value) {
    reflect(this, 'quickness', value);
  }

  get variety() {
    const variety = Number(this.getAttribute('variety') ?? 1);
    return Number.isFinite(variety) ? Math.min(1, Math.max(0, variety)) : 1;
  }

  set variety(value) {
    reflect(this, 'variety', value);
  }
}

const DEGREE = Math.PI / 180;

/**
 * `30deg 10deg 1.5`: the angles about the actor and above the ground, and the distance, 1 from where all of it is seen.
 * @returns {[number, number, number] | null} in radians; null for anything else
 */
export function parseCamera(text) {
  const view = /^\s*(-?[\d.]+)deg\s+(-?[\d.]+)deg(?:\s+([\d.]+))?\s*$/.exec(text);
  if (!view) return null;
  const numbers = [view[1] * DEGREE, view[2] * DEGREE, Number(view[3] ?? 1)];
  return numbers.every(Number.isFinite) && numbers[2] > 0 ? numbers : null;
}

/** Frameworks set what they do not have to null or to undefined: that is no attribute, not one with these words. */
function reflect(element, name, value) {
  if (value === null || value === undefined) element.removeAttribute(name);
  else element.setAttribute(name, String(value));
}

function define(name, get, set) {
  Object.defineProperty(AttributeElement.prototype, name, { get, set, configurable: true, enumerable: true });
}

for (const name of ['src', 'poster', 'alt', 'camera', 'originals']) {
  define(name, function () { return this.getAttribute(name) ?? ''; }, function (value) { reflect(this, name, value); });
}

for (const name of ['controls', 'autoplay', 'loop', 'tint', 'parts']) {
  define(name, function () { return this.hasAttribute(name); }, function (on) { this.toggleAttribute(name, Boolean(on)); });
}

for (const [name, words] of Object.entries(WORDS)) {
  define(
    name,
    function () {
      const word = this.getAttribute(name);
      return words.includes(word) ? word : words[0];
    },
    function (value) { reflect(this, name, value || null); },
  );
}
