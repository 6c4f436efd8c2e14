/** The style sheets of a shadow tree: constructed ones, for a content security policy would refuse style elements. */

/** One sheet for all players of a window: a document takes only those that were made in its own. @type {WeakMap<Window, Map<string, CSSStyleSheet>>} */
const made = new WeakMap();

function sheetOf(text, window) {
  const sheets = made.get(window) ?? made.set(window, new Map()).get(window);
  if (!sheets.has(text)) {
    const sheet = new window.CSSStyleSheet();
    sheet.replaceSync(text);
    sheets.set(text, sheet);
  }
  return sheets.get(text);
}

export class Styles {
  /** @param {ShadowRoot} root */
  constructor(root, ...texts) {
    this.root = root;
    this.texts = texts;
  }

  add(text, window) {
    this.texts.push(text);
    this.adopt(window);
  }

  /** A tree that is moved to another document loses its sheets. */
  adopt(window) {
    this.root.adoptedStyleSheets = this.texts.map((text) => sheetOf(text, window));
  }
}
