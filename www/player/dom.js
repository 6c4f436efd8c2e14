/** Builds DOM without markup strings, so that a strict content security policy has nothing to object to. */

/**
 * An element with attributes and children. `true` sets an empty attribute, `false` and `null` leave it out.
 * @param {string} tag
 * @param {Record<string, string | number | boolean | null>} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElement}
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === false || value === null) continue;
    element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...children);
  return element;
}

const SVG = 'http://www.w3.org/2000/svg';

/** Outlines on a 16 pixel grid; each is drawn with the text colour. */
const ICONS = {
  play: { fill: true, d: 'M4.5 2.6v10.8a.6.6 0 0 0 .9.5l8.6-5.4a.6.6 0 0 0 0-1L5.4 2.1a.6.6 0 0 0-.9.5z' },
  pause: { fill: true, d: 'M4 2.5h2.6v11H4zM9.4 2.5H12v11H9.4z' },
  loop: { d: 'M3 7.5V7a3 3 0 0 1 3-3h6.5M10.5 2l2.2 2-2.2 2M13 8.5V9a3 3 0 0 1-3 3H3.5M5.5 14l-2.2-2 2.2-2' },
  flag: { fill: true, d: 'M3 1.5h1.3v13H3zM4.8 2h8.4l-2.4 3 2.4 3H4.8z' },
  tick: { d: 'M2.5 8.6l3.7 3.7 7.3-8.3', width: 2.2 },
  close: { d: 'M4 4l8 8M12 4l-8 8' },
  /** The outline of somebody who is not there. */
  absent: { d: 'M8 1.2a1.9 1.9 0 1 1 0 3.8a1.9 1.9 0 1 1 0-3.8M8 6.6c2.6 0 3.4 1.3 3.4 3v1.7M8 6.6c-2.6 0-3.4 1.3-3.4 3v1.7M6.1 9.5v5.3M9.9 9.5v5.3', width: 0.9 },
  undo: { d: 'M5.5 3.5L2.5 6.5l3 3M3 6.5h6.2a3.6 3.6 0 0 1 0 7.2H6.5' },
  redo: { d: 'M10.5 3.5l3 3-3 3M13 6.5H6.8a3.6 3.6 0 0 0 0 7.2h2.7' },
  share: { d: 'M8 10V2.2M5 4.8l3-2.8 3 2.8M3 8v5.5h10V8' },
  dice: { d: 'M3 3h10v10H3zM6 6h.01M10 10h.01M8 8h.01M10 6h.01M6 10h.01' },
  chevron: { d: 'M3.5 6l4.5 4.5L12.5 6' },
};

/**
 * An icon that screen readers pass over: the control that holds it carries the words.
 * @param {keyof typeof ICONS} name
 */
export function icon(name) {
  const { d, fill = false, width = 1.5 } = ICONS[name];
  const svg = document.createElementNS(SVG, 'svg');
  const attributes = { viewBox: '0 0 16 16', width: 16, height: 16, 'aria-hidden': 'true', class: 'icon' };
  for (const [key, value] of Object.entries(attributes)) svg.setAttribute(key, String(value));
  const path = document.createElementNS(SVG, 'path');
  path.setAttribute('d', d);
  path.setAttribute('fill', fill ? 'currentColor' : 'none');
  if (!fill) {
    path.setAttribute('stroke', 'currentColor');
    path.setAttribute('stroke-width', String(width));
    path.setAttribute('stroke-linecap', 'round');
    path.setAttribute('stroke-linejoin', 'round');
  }
  svg.append(path);
  return svg;
}

/** A button with words. @param {(event: Event) => void} act */
export function button(text, title, act, attributes = {}) {
  const element = h('button', { type: 'button', class: 'chip', title, ...attributes }, text);
  element.addEventListener('click', act);
  return element;
}

/** A button with an icon; what stands in brackets in its title is not part of its name. */
export function iconButton(name, title, act, attributes = {}) {
  return button(icon(name), title, act, { class: 'round', 'aria-label': title.split(' (')[0], ...attributes });
}

/**
 * Arrow keys lead from one button to the next; the tab key stops once for all of them.
 * @param {(button: HTMLButtonElement, event: KeyboardEvent, by: number) => void} act
 */
export function rove(root, act) {
  root.addEventListener('focusin', ({ target }) => {
    for (const one of root.children) one.tabIndex = one === target ? 0 : -1;
  });
  root.addEventListener('keydown', (event) => {
    const by = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    const all = [...root.children];
    const at = all.indexOf(event.target);
    if (!by || at < 0) return;
    event.preventDefault();
    event.stopPropagation();
    act(all[(at + by + all.length) % all.length], event, by);
  });
}

/**
 * Sizes a canvas to CSS pixels at the screen's density and returns its context, scaled to CSS pixels.
 * @param {HTMLCanvasElement} canvas
 */
export function sizedContext(canvas, width, height) {
  const density = Math.min(globalThis.devicePixelRatio || 1, 3);
  canvas.width = Math.max(1, Math.round(width * density));
  canvas.height = Math.max(1, Math.round(height * density));
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const context = canvas.getContext('2d');
  context.setTransform(canvas.width / Math.max(1, width), 0, 0, canvas.height / Math.max(1, height), 0, 0);
  return context;
}
