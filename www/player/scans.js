/**
 * Frames as they were scanned: a few groups of them are fetched ahead of the playhead, and handed to the stage.
 *
 * They lie at the end of the bundle. Where the server hands out parts of it, each group is fetched when it is wanted; else the rest
 * of the bundle is kept as blobs, which browsers put on the disk. Until a group is there the registered mesh is shown.
 */

import { loadScanner } from './engine.js';

/** Groups on their way at once. */
const COMING = 3;
/** Bytes that are read at a time until all of the header is there. */
const HEADER = 4096;
/** Bytes that are put together into one blob. */
const PIECE = 8_000_000;

export class Scans {
  /** @param {import('./session.js').Session} session */
  constructor(session) {
    this.session = session;
    /** The first byte of the first group; known once the bundle's header is. */
    this.start = Infinity;
    this.kept = new Blob();
    this.pieces = [];
    this.size = 0;
    this.address = null;
    this.forget();
  }

  /** A new stage has none of them. */
  forget() {
    this.coming = new Set();
    this.failed = new Set();
  }

  get player() {
    return this.session.director.player;
  }

  /** Hands the player what is its of `bytes`, which end at `loaded`; a little at a time until its header says where groups begin. */
  feed(bytes, loaded) {
    const before = loaded - bytes.byteLength;
    for (let at = 0; at < bytes.byteLength; ) {
      const end = Math.min(bytes.byteLength, this.player.phase() === 'empty' ? at + HEADER : Infinity);
      const part = bytes.subarray(at, end);
      this.player.push(this.take(part, before + end));
      this.learn(part, before + end);
      at = end;
    }
  }

  /** Keeps what belongs to groups. @returns {Uint8Array} what of `bytes`, which end at `loaded`, comes before */
  take(bytes, loaded) {
    const before = Math.max(0, this.start - loaded + bytes.byteLength);
    this.keep(bytes.subarray(before));
    return bytes.subarray(0, before);
  }

  /** The player has read on: where do groups begin? What came too early is kept, too. */
  learn(bytes, loaded) {
    if (this.start < Infinity) return;
    [this.start = Infinity] = this.player.scan_section(0);
    this.take(bytes, loaded);
  }

  keep(bytes) {
    if (!bytes.byteLength) return;
    this.pieces.push(bytes);
    this.size += bytes.byteLength;
    if (this.size >= PIECE) this.fold();
  }

  fold() {
    this.kept = new Blob([this.kept, ...this.pieces]);
    this.pieces = [];
    this.size = 0;
  }

  /** Whether groups can be fetched from `address` one by one: then the rest of the bundle need not come. */
  async ask(address) {
    try {
      const response = await this.part(address, this.player.scan_section(0));
      response.body?.cancel();
      if (response.status !== 206) return false;
    } catch {
      return false;
    }
    this.address = address;
    this.kept = new Blob();
    this.pieces = [];
    return true;
  }

  part(address, [first, length]) {
    return fetch(address, { headers: { Range: `bytes=${first}-${first + length - 1}` }, signal: this.session.ending.signal });
  }

  /** The bytes of a group's section, or null while they are to come. */
  async read([first, length]) {
    if (this.address) {
      const response = await this.part(this.address, [first, length]);
      if (response.status !== 206) throw new Error(`the server answered ${response.status}`);
      return response.arrayBuffer();
    }
    if (this.size) this.fold();
    const at = first - this.start;
    return at + length > this.kept.size ? null : this.kept.slice(at, at + length).arrayBuffer();
  }

  /** Sends for what is wanted; called once a display frame. */
  step() {
    const { complete, director, view } = this.session;
    if (!complete || !director.info.scanned || !view.alive()) return;
    for (const group of view.stage.scans_wanted(this.player)) {
      if (this.coming.size >= COMING) return;
      if (!this.coming.has(group) && !this.failed.has(group)) this.bring(group);
    }
  }

  /** How the registered mesh carries the frames of `scan`, of which `head` tells; a frame at a time, so that the page stays alive. */
  async carry(scan, [first, count]) {
    this.carrier ??= this.player.carrier();
    const parts = [];
    for (let frame = 0; frame < count && !this.session.closed; frame += 1) {
      parts.push(scan.carried(frame, this.carrier, this.player.recorded_pose(first + frame)));
      await new Promise((resolve) => setTimeout(resolve));
    }
    return new Uint8Array(await new Blob(parts).arrayBuffer());
  }

  async bring(group) {
    const { coming, failed, player, session } = this;
    const { stage } = session.view;
    coming.add(group);
    try {
      const section = await this.read(player.scan_section(group));
      if (!section || session.closed) return;
      const bytes = new Uint8Array(section);
      const { Scan } = await loadScanner();
      const head = player.scan_head(group, bytes);
      const scan = new Scan(head, bytes);
      const places = scan.images();
      const bitmaps = [];
      for (let at = 0; at < places.length; at += 2) {
        bitmaps.push(await createImageBitmap(new Blob([bytes.subarray(places[at], places[at + 1])]), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' }));
      }
      const carried = await this.carry(scan, head);
      if (!session.closed && session.view.stage === stage && session.view.alive()) {
        for (const bitmap of bitmaps) stage.add_scan_image(bitmap);
        if (!stage.take_scan(player, group, scan.corners(), scan.triangles(), scan.poses(), carried)) failed.add(group);
        session.owner.dressed();
      }
      bitmaps.forEach((bitmap) => bitmap.close());
      scan.free();
    } catch {
      // The registered mesh is shown in its place.
      failed.add(group);
    } finally {
      coming.delete(group);
    }
  }
}
