/** The direction as the part of an address behind #. */

import { PlayerError } from '../errors.js';

const KEY = 'direction';
/** A link or a file longer than this is none. */
const LONGEST = 1_000_000;

/** The part of an address behind # that carries a direction. */
export function toHash(document) {
  const bytes = new TextEncoder().encode(JSON.stringify(document));
  const text = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
  return `#${KEY}=${text.replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '')}`;
}

/** What a text holds as JSON, unchecked. */
export function parse(text) {
  try {
    if (text.length < LONGEST) return JSON.parse(text);
  } catch {
    // Said below.
  }
  throw new PlayerError('bad-argument', 'This is not a direction: it is no JSON, or far too long.');
}

/** @returns {unknown} what the address carries, unchecked; undefined where it carries no direction */
export function fromHash(hash) {
  const [, text] = new RegExp(`^#${KEY}=(.*)$`).exec(hash) ?? [];
  if (text === undefined) return undefined;
  let json;
  try {
    const binary = atob(text.replaceAll('-', '+').replaceAll('_', '/'));
    json = new TextDecoder('utf-8', { fatal: true }).decode(Uint8Array.from(binary, (letter) => letter.charCodeAt(0)));
  } catch {
    throw new PlayerError('bad-argument', 'The link is damaged: its direction cannot be read.');
  }
  return parse(json);
}
