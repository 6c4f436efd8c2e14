/**
 * Reads and writes `keys.toml` (docs/transfer.md): all of TOML that such a file needs. What is something else is refused with its line and
 * what to write instead. Comments stay with the pair that they stand at.
 */

/** The entries of a pair, what they hold, and what they are called here. */
const FIELDS = {
  from: { kind: 'text', name: 'from' },
  from_frame: { kind: 'frame', name: 'fromFrame' },
  to: { kind: 'text', name: 'to' },
  to_frame: { kind: 'frame', name: 'toFrame' },
  stretch: { kind: 'text', name: 'stretch', optional: true },
};
const KNOWN = Object.keys(FIELDS).join(', ');
/** The largest frame that the command can read. */
const MOST = 2 ** 32 - 1;
const ESCAPES = { b: '\b', t: '\t', n: '\n', f: '\f', r: '\r', '"': '"', '\\': '\\' };

/** What is wrong with a file, its line counted from 1. */
export class KeysError extends Error {
  constructor(line, message) {
    super(`line ${line}: ${message}`);
    this.name = 'KeysError';
    this.line = line;
  }
}

/**
 * @typedef {object} KeyPair
 * @property {string} from a sequence of the source
 * @property {number} fromFrame a frame in it, from 0
 * @property {string} to a sequence of the target
 * @property {number} toFrame the frame in it that means the same
 * @property {string | null} stretch frames are matched between keys of one stretch alone
 * @property {string[]} comments lines of comment, without `#`
 */

/**
 * @param {string} text
 * @returns {{pairs: KeyPair[], tail: string[]}} `tail` is what is noted after the last pair
 * @throws {KeysError}
 */
export function readKeys(text) {
  return new Reader(text).file();
}

/** @param {{pairs: KeyPair[], tail?: string[]}} file */
export function writeKeys({ pairs, tail = [] }) {
  const noted = (comments) => comments.map((comment) => `#${comment}\n`).join('');
  const pair = ({ from, fromFrame, to, toFrame, stretch, comments = [] }) => {
    const last = stretch === null || stretch === undefined ? '' : `stretch = ${quoted(stretch)}\n`;
    return `${noted(comments)}[[pair]]\nfrom = ${quoted(from)}\nfrom_frame = ${fromFrame}\nto = ${quoted(to)}\nto_frame = ${toFrame}\n${last}`;
  };
  return [...pairs.map(pair), ...(tail.length > 0 ? [noted(tail)] : [])].join('\n');
}

function quoted(text) {
  const escaped = (sign) => {
    const short = Object.keys(ESCAPES).find((letter) => ESCAPES[letter] === sign);
    return short ? `\\${short}` : `\\u${sign.charCodeAt(0).toString(16).padStart(4, '0').toUpperCase()}`;
  };
  return `"${text.replace(/[\\"\u0000-\u001f\u007f]/g, escaped)}"`;
}

class Reader {
  constructor(text) {
    this.text = text.replace(/^\ufeff/, '').replaceAll('\r\n', '\n');
    this.at = 0;
    this.line = 1;
    this.comments = [];
  }

  file() {
    const pairs = [];
    /** The pair whose entries come now, and whether all pairs came as one list. */
    let open = null;
    let listed = false;
    for (;;) {
      this.blank();
      if (this.ended) break;
      if (this.text.startsWith('[[', this.at)) {
        if (listed) this.refuse('the pairs are given as one list above; write this pair into that list, or all of them as [[pair]]');
        pairs.push((open = { line: this.header(), values: {}, comments: this.noted() }));
      } else if (this.next === '[') {
        this.refuse('a table in single brackets is no list of pairs; write [[pair]] with two brackets on each side');
      } else if (open) {
        open.comments.push(...this.noted());
        this.entry(open);
        this.endOfLine();
      } else {
        listed = this.list(pairs, listed);
      }
      open?.comments.push(...this.inline());
    }
    return { pairs: pairs.map((pair) => this.finished(pair)), tail: this.noted() };
  }

  /** `[[pair]]`. @returns its line */
  header() {
    const { line } = this;
    this.at += 2;
    this.space();
    const name = this.key();
    this.space();
    if (!this.take(']]')) this.refuse('[[pair]] is closed by two brackets: ]]');
    if (name !== 'pair') this.refuse(`a file of keys has no [[${name}]]; write [[pair]]`);
    this.endOfLine();
    return line;
  }

  /** `pair = [{ ... }, ...]`, the other way to write a list of tables. */
  list(pairs, listed) {
    const { line } = this;
    const name = this.key();
    if (name !== 'pair') this.refuse(`“${name}” stands before the first pair; write [[pair]] on a line of its own above it`, line);
    if (listed) this.refuse('“pair” is given twice; write all pairs into one list');
    this.equals();
    if (!this.take('[')) this.refuse('“pair” is a list of tables; write each as [[pair]], its entries on the lines below');
    for (;;) {
      this.blank();
      if (this.take(']')) break;
      const pair = { line: this.line, values: {}, comments: this.noted() };
      this.table(pair);
      pairs.push(pair);
      this.blank();
      if (this.take(',')) continue;
      if (this.next !== ']') this.refuse('a comma or ] is missing behind this pair');
    }
    pairs.at(-1)?.comments.push(...this.noted());
    this.endOfLine();
    return true;
  }

  /** `{ from = "walk", ... }`. */
  table(pair) {
    if (!this.take('{')) this.refuse('each pair of the list is a table: { from = "...", from_frame = 0, to = "...", to_frame = 0 }');
    for (;;) {
      this.blank();
      if (this.take('}')) break;
      this.entry(pair);
      this.blank();
      if (!this.take(',') && this.next !== '}') this.refuse('a comma or } is missing behind this entry');
    }
    pair.comments.push(...this.noted());
  }

  entry(pair) {
    const { line } = this;
    const name = this.key();
    this.space();
    if (this.next === '.') this.refuse(`“${name}.” with a dot is no entry of a pair; a pair has: ${KNOWN}`);
    const field = Object.hasOwn(FIELDS, name) ? FIELDS[name] : null;
    if (!field) this.refuse(`a pair has no “${name}”, but: ${KNOWN}; correct or remove it`, line);
    if (field.name in pair.values) this.refuse(`“${name}” is given twice in this pair; remove one, or begin a new pair with [[pair]]`, line);
    this.equals();
    pair.values[field.name] = field.kind === 'text' ? this.string(name) : this.frame(name);
  }

  finished({ line, values, comments }) {
    for (const [name, field] of Object.entries(FIELDS)) {
      if (!(field.name in values) && !field.optional) {
        throw new KeysError(line, `this pair has no “${name}”; add ${name} = ${field.kind === 'text' ? '"the name of a sequence"' : 'the number of a frame'}`);
      }
    }
    return { stretch: null, ...values, comments };
  }

  // ---- values ---------------------------------------------------------------------------------------------------

  string(name) {
    const quote = this.next;
    if (quote !== '"' && quote !== "'") this.refuse(`“${name}” is a name; put it into quotes: ${name} = "..."`);
    if (this.text.startsWith(quote.repeat(3), this.at)) this.refuse(`“${name}” is in triple quotes; put it into one pair of quotes, on one line`);
    this.at += 1;
    let text = '';
    for (;;) {
      if (this.ended || this.next === '\n') this.refuse(`a quote ${quote} is missing at the end of “${name}”`);
      if (this.take(quote)) return text;
      if (quote === '"' && this.take('\\')) text += this.escape();
      else text += this.sign();
    }
  }

  /** What stands behind a backslash. */
  escape() {
    const letter = this.next;
    if (letter in ESCAPES || letter === 'e') {
      this.at += 1;
      return ESCAPES[letter] ?? '\u001b';
    }
    const length = { x: 2, u: 4, U: 8 }[letter];
    const digits = length ? this.text.slice(this.at + 1, this.at + 1 + length) : '';
    const code = length && new RegExp(`^[0-9a-fA-F]{${length}}$`).test(digits) ? parseInt(digits, 16) : -1;
    if (code < 0 || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) {
      this.refuse(`\\${letter ?? ''} means nothing in a quoted name; a backslash itself is written \\\\, or the name in single quotes`);
    }
    this.at += 1 + length;
    return String.fromCodePoint(code);
  }

  frame(name) {
    const written = /^[^\s,#}\]]*/.exec(this.text.slice(this.at))[0];
    const plain = /^[+-]?(?:0|[1-9](?:_?\d)*)$/.test(written) || /^0(?:x[\da-fA-F](?:_?[\da-fA-F])*|o[0-7](?:_?[0-7])*|b[01](?:_?[01])*)$/.test(written);
    const value = plain ? Number(written.replaceAll('_', '')) : NaN;
    if (!(value >= 0 && value <= MOST)) {
      this.refuse(`“${name}” is the number of a frame, a whole number from 0${written ? `, not ${written}` : ''}; write it without quotes or a point: ${name} = 12`);
    }
    this.at += written.length;
    return value + 0;
  }

  // ---- signs ----------------------------------------------------------------------------------------------------

  get next() {
    return this.text[this.at];
  }

  get ended() {
    return this.at >= this.text.length;
  }

  take(wanted) {
    const there = this.text.startsWith(wanted, this.at);
    if (there) this.at += wanted.length;
    return there;
  }

  space() {
    while (this.next === ' ' || this.next === '\t') this.at += 1;
  }

  /** A sign of a name or a comment. */
  sign() {
    const sign = String.fromCodePoint(this.text.codePointAt(this.at));
    if (/[\u0000-\u0008\u000a-\u001f\u007f]/.test(sign)) this.refuse('there is a control character here that no TOML file may hold; remove it');
    this.at += sign.length;
    return sign;
  }

  key() {
    if (this.next === '"' || this.next === "'") return this.string('the entry’s name');
    const [name] = /^[\w-]*/.exec(this.text.slice(this.at));
    if (!name) this.refuse(`“${this.text.slice(this.at).split('\n')[0].slice(0, 20)}” is no entry; write one as name = value: ${KNOWN}`);
    this.at += name.length;
    return name;
  }

  equals() {
    this.space();
    if (!this.take('=')) this.refuse('an entry is written as name = value; = is missing');
    this.space();
  }

  /** Nothing but a comment may follow. */
  endOfLine() {
    this.space();
    if (this.next === '#') this.comment();
    if (!this.ended && !this.take('\n')) this.refuse('one line holds one entry; put what follows on a line of its own');
    else this.line += 1;
  }

  /** Over what is blank, and comments. */
  blank() {
    for (;;) {
      this.space();
      if (this.next === '\n') {
        this.at += 1;
        this.line += 1;
      } else if (this.next === '#') {
        this.comment();
      } else {
        return;
      }
    }
  }

  comment() {
    const alone = this.text.slice(this.text.lastIndexOf('\n', this.at) + 1, this.at).trim() === '';
    this.at += 1;
    let text = '';
    while (!this.ended && this.next !== '\n') text += this.sign();
    this.comments.push({ text, alone });
  }

  /** All comments since the last entry. */
  noted() {
    return this.comments.splice(0).map(({ text }) => text);
  }

  /** Comments at the end of entries: those that stand alone belong to what follows. */
  inline() {
    const own = this.comments.filter(({ alone }) => !alone);
    this.comments = this.comments.filter(({ alone }) => alone);
    return own.map(({ text }) => text);
  }

  refuse(message, line = this.line) {
    throw new KeysError(line, message);
  }
}
