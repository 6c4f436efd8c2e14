/** Fetches an actor as a stream, piece by piece, so that its first pose can be drawn before the rest has come. */

import { h } from './dom.js';
import { PlayerError } from './errors.js';
import { megabytes } from './format.js';

/**
 * Checks an address that came from an attribute or the page's own address.
 * @returns {URL}
 */
export function actorAddress(text, base = globalThis.document?.baseURI) {
  let url;
  try {
    url = new URL(text, base);
  } catch {
    throw new PlayerError('bad-address', `“${text}” is not an address.`);
  }
  if (url.protocol !== 'http:' && url.protocol !== 'https:' && url.protocol !== 'blob:') {
    throw new PlayerError('bad-address', `An actor can only come over http or https, not ${url.protocol}`);
  }
  return url;
}

/**
 * Opens the stream.
 * @param {URL} url
 * @param {AbortSignal} signal
 * @returns {Promise<{total: number, encoded: boolean, chunks: AsyncGenerator<{bytes: Uint8Array, loaded: number}>}>} `total` is 0 if unknown
 */
export async function openActor(url, signal) {
  let response;
  try {
    response = await fetch(url, { signal });
  } catch (cause) {
    if (signal.aborted) throw cause;
    throw new PlayerError('network', `${url.href} could not be fetched.`, { cause });
  }
  if (!response.ok || !response.body) {
    const kind = response.status === 404 || response.status === 410 ? 'not-found' : 'network';
    throw new PlayerError(kind, `${url.href} answered ${response.status}.`);
  }
  // With a content encoding, the length counts the encoded bytes, which nobody sees.
  const encoded = Boolean(response.headers.get('content-encoding'));
  const total = encoded ? 0 : Number(response.headers.get('content-length')) || 0;
  return { total, encoded, chunks: read(response.body, url, signal) };
}

async function* read(body, url, signal) {
  const reader = body.getReader();
  let loaded = 0;
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      loaded += value.byteLength;
      yield { bytes: value, loaded };
    }
  } catch (cause) {
    if (signal.aborted) throw cause;
    throw new PlayerError('network', `The connection to ${url.host} broke off after ${megabytes(loaded, 0)}.`, { cause });
  } finally {
    reader.cancel().catch(() => {});
  }
}

/** The thin bar and the figures beside it. */
export class ProgressBar {
  constructor() {
    this.bar = h('div', { class: 'bar' });
    this.text = h('span', { class: 'figures' });
    this.root = h(
      'div',
      { class: 'progress', role: 'progressbar', 'aria-label': 'Loading the actor', 'aria-valuemin': 0, 'aria-valuemax': 100, hidden: true },
      h('div', { class: 'rail' }, this.bar),
      this.text,
    );
  }

  show(loaded, total) {
    this.root.hidden = false;
    const share = total ? Math.min(1, loaded / total) : 0;
    this.root.toggleAttribute('data-unknown', !total);
    this.bar.style.width = `${(share * 100).toFixed(2)}%`;
    this.text.textContent = loaded ? megabytes(loaded, total) : 'Loading';
    if (total) this.root.setAttribute('aria-valuenow', String(Math.round(share * 100)));
    else this.root.removeAttribute('aria-valuenow');
    this.root.setAttribute('aria-valuetext', this.text.textContent);
  }

  hide() {
    this.root.hidden = true;
  }
}
