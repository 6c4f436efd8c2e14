/** Pictures of the actor as data: what is on the stage, or one pose alone. */

import { PlayerError } from './errors.js';

/** The stage draws no pose larger. */
const LARGEST = 1024;

/**
 * @param {import('./core.js').Core} core
 * @param {{frame?: number, width?: number, height?: number}} options with a frame: that pose on a transparent background
 * @returns {Promise<ImageData>}
 */
export async function snapshot(core, { frame, width = 512, height = 512 } = {}) {
  const { stage, canvas } = core.view.stage;
  if (!stage || !core.view.stage.alive()) throw new PlayerError('not-loaded', 'There is no picture yet; wait for the ready event.');
  if (frame === undefined) {
    core.draw();
    return new ImageData(new Uint8ClampedArray(await stage.read_pixels()), canvas.width, canvas.height);
  }
  const size = [width, height];
  if (!size.every((side) => Number.isInteger(side) && side > 0 && side <= LARGEST)) {
    throw new PlayerError('bad-argument', `A picture is 1 to ${LARGEST} pixels wide and high.`);
  }
  return new ImageData(new Uint8ClampedArray(await stage.thumbnail(core.director.player, frame, ...size)), ...size);
}

/** @returns {Promise<Blob>} the same, encoded */
export async function toBlob(core, { type = 'image/png', quality, ...options } = {}) {
  const picture = await snapshot(core, options);
  const canvas = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height });
  canvas.getContext('2d').putImageData(picture, 0, 0);
  return new Promise((resolve, reject) => {
    const refused = () => reject(new PlayerError('bad-argument', `This browser cannot write ${type}.`));
    canvas.toBlob((blob) => (blob ? resolve(blob) : refused()), type, quality);
  });
}
