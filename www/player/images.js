/** Hands the bundle's textures to the stage, decoded by the browser: no decoder has to be shipped. */

export class Textures {
  constructor() {
    this.sent = new Set();
    this.shown = new Set();
  }

  /** Whether a picture of the actor would show it as it is: some texture is there, or there is none to come. */
  get dressed() {
    return this.shown.size > 0 || this.none;
  }

  /** A new stage has none of them. */
  forget() {
    this.sent.clear();
    this.shown.clear();
  }

  /**
   * Decodes every texture that has arrived and not been handed over yet.
   * @param {{images: {media_type: string, ready: boolean}[]}} info
   * @param {(index: number) => Uint8Array} encoded
   * @param {(index: number, bitmap: ImageBitmap) => void} send
   * @returns {Promise<void>} when those have been handed over; rejects with a `damaged` error if one does not decode
   */
  async update(info, encoded, send) {
    this.none = info.images.length === 0 && !info.appearance;
    const fresh = info.images.map((image, index) => ({ ...image, index })).filter(({ ready, index }) => ready && !this.sent.has(index));
    for (const { index } of fresh) this.sent.add(index);
    for (const { index, media_type: type } of fresh) {
      // Colours must reach the shader as they were stored; the bytes are copied, for they live in wasm memory.
      const blob = new Blob([encoded(index).slice()], { type });
      const bitmap = await createImageBitmap(blob, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' }).catch((cause) => {
        throw Object.assign(new Error(`Texture ${index} (${type}) does not decode.`, { cause }), { kind: 'damaged' });
      });
      send(index, bitmap);
      this.shown.add(index);
      bitmap.close();
    }
  }
}
