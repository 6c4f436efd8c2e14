/** One actor's way onto the stage: its bundle as it streams in, the stage, the textures; and a stage anew after a lost device. */

import { Director } from './director.js';
import { loadEngine } from './engine.js';
import { PlayerError, checkSupport } from './errors.js';
import { Textures } from './images.js';
import { actorAddress, openActor } from './loading.js';
import { Scans } from './scans.js';

/** A device lost this often within so many milliseconds is not tried again by itself. */
const LOSSES = { most: 3, within: 30_000 };
/** How often, and after how many milliseconds, a lost device is asked for again before the page says so. */
const REOPENINGS = 5;
const REOPEN_AFTER = 400;
/** Milliseconds of decoding after which the page gets a turn. */
const TURN = 8;

const rest = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/**
 * Ends for good with `close`; another actor is another session.
 *
 * It tells its owner what it comes to: `progress(loaded, total)`, `described()` when the first pose has arrived,
 * `more()` when more of the bundle has, `dressed(index)` for a texture, `shown(first)` when the stage is open,
 * `complete()`, `failed(error)`, `devicelost()` and `devicerestored()`.
 */
export class Session {
  /**
   * @param {import('./stage-view.js').StageView} view
   * @param {object} owner hears of everything above
   */
  constructor(view, owner) {
    this.view = view;
    this.owner = owner;
    this.ending = new AbortController();
    this.director = null;
    this.textures = new Textures();
    this.scans = new Scans(this);
    this.complete = false;
    this.shown = false;
    /** Whether a texture was rebuilt from the modes that have arrived. */
    this.rebuilt = false;
    this.losses = [];
  }

  get closed() {
    return this.ending.signal.aborted;
  }

  close() {
    this.ending.abort();
    this.view.close();
    this.director?.player.free?.();
  }

  /** Never rejects: trouble is told to the owner. */
  async load(address) {
    const { signal } = this.ending;
    try {
      checkSupport();
      const url = actorAddress(address);
      const [engine, { total, encoded, chunks }] = await Promise.all([loadEngine(), openActor(url, signal)]);
      if (this.closed) return;
      this.engine = engine;
      this.director = new Director(new engine.Player());
      // Parts of what is encoded on its way are not parts of the bundle.
      await this.receive(chunks, total, encoded ? null : url);
    } catch (error) {
      // Where scanned frames do not come, there is a mesh to show in their place.
      if (this.closed || (this.complete && this.scans.start < Infinity)) return;
      this.owner.failed(error);
      // What has arrived stays: a stage that is being opened just now will show it.
      if (!this.director?.info) this.ending.abort();
    }
  }

  /** @param {URL | null} address where parts of the bundle may be had */
  async receive(chunks, total, address) {
    const { director: { player }, scans } = this;
    let phase = 'empty';
    let turn = performance.now();
    for await (const { bytes, loaded } of chunks) {
      if (this.closed) return;
      scans.feed(bytes, loaded);
      if (this.complete) {
        // Frames as they were scanned: nobody waits for them.
        this.owner.more();
        continue;
      }
      this.owner.progress(Math.min(loaded, scans.start), Math.min(total, scans.start));
      const before = phase;
      phase = player.phase();
      if (phase !== before || performance.now() - turn > TURN) {
        this.arrived(phase);
        await rest(0);
        turn = performance.now();
      }
      if (loaded > scans.start && phase === 'complete') {
        this.finish().catch((error) => this.closed || this.owner.failed(error));
        if (address && loaded < total && (await scans.ask(address))) return;
      }
    }
    if (this.closed || this.complete) return;
    await this.finish();
  }

  /** All is there but frames as they were scanned. */
  async finish() {
    const { player } = this.director;
    player.finish();
    this.complete = true;
    this.arrived(player.phase());
    await this.owner.complete();
  }

  /** More of the bundle is there: show what can be shown. */
  arrived(phase) {
    if (phase === 'empty' || phase === 'header') return;
    const first = this.director.info === null;
    this.director.refresh();
    if (first) {
      this.owner.described();
      this.open();
    } else if (this.shown) {
      this.sendTextures();
      this.owner.more();
    }
  }

  /** @param {number} patience how often a missing adapter is asked for again: after a crash there is none for a moment */
  async open(patience = 0) {
    try {
      await this.view.open(this.engine, this.director.player);
      if (this.closed) return;
      this.textures.forget();
      this.scans.forget();
      this.sendTextures();
      const first = !this.shown;
      this.shown = true;
      this.owner.shown(first);
    } catch (error) {
      if (this.closed) return;
      if (patience === 0) {
        this.owner.failed(error);
        return;
      }
      await rest(REOPEN_AFTER);
      if (!this.closed) await this.open(patience - 1);
    }
  }

  /** The device is gone: the player still knows pose and target, so only the stage is made anew. */
  async recover() {
    if (this.closed || !this.director) return;
    const now = performance.now();
    this.losses = [...this.losses.filter((at) => now - at < LOSSES.within), now];
    this.owner.devicelost();
    if (this.losses.length > LOSSES.most) {
      this.losses = [];
      this.owner.failed(new PlayerError('device-lost', 'The graphics device was lost several times in a row.'));
      return;
    }
    await this.open(REOPENINGS);
    if (!this.closed && this.view.stage) this.owner.devicerestored();
  }

  sendTextures() {
    const { director, view } = this;
    const send = (index, bitmap) => {
      if (this.closed || !view.alive()) return;
      view.stage.set_image(index, bitmap);
      this.owner.dressed(index);
    };
    this.textures
      .update(director.info, (index) => director.player.image(index), send)
      .then(() => this.closed || this.owner.more())
      .catch((error) => this.closed || this.owner.failed(error));
  }

  /** The picture of a pose, or null while that would not show it as it is. */
  thumbnail(frame, width, height) {
    const ready = this.shown && (this.textures.dressed || this.rebuilt) && this.view.alive();
    return ready ? this.view.stage.thumbnail(this.director.player, frame, width, height) : null;
  }
}
