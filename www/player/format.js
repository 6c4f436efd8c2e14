/** Numbers and sentences as the page says them. Pure functions, so that they can be tested without a browser. */

/** `00:03.42` */
export function clock(seconds) {
  const hundredths = Math.max(0, Math.round((Number.isFinite(seconds) ? seconds : 0) * 100));
  const pad = (value) => String(value).padStart(2, '0');
  return `${pad(Math.floor(hundredths / 6000))}:${pad(Math.floor(hundredths / 100) % 60)}.${pad(hundredths % 100)}`;
}

/** `2.4 s` */
export function duration(seconds) {
  return `${Math.max(0, seconds).toFixed(1)} s`;
}

/** `4.1 of 11.8 MB`, or `4.1 MB` where the server does not say how much is to come. */
export function megabytes(loaded, total) {
  const mega = (bytes) => (bytes / 1e6).toFixed(1);
  return total ? `${mega(loaded)} of ${mega(total)} MB` : `${mega(loaded)} MB`;
}

/** `1 transition`, `2 transitions` */
export function count(number, noun) {
  return `${number.toLocaleString('en')} ${noun}${number === 1 ? '' : 's'}`;
}

/** `goes there in 2.4 s, through 2 transitions` */
export function walkSentence(walk) {
  const way = walk.transitions === 0 ? 'without a transition' : `through ${count(walk.transitions, 'transition')}`;
  return `goes there in ${duration(walk.seconds)}, ${way}`;
}

/** A name as people write it: file names have underscores for spaces. */
export function words(name) {
  return name.replaceAll('_', ' ');
}

/** A sequence's name. */
export function title({ name }) {
  return words(name);
}

/** `walk, 3.42 s`: a pose by its sequence and the time within it. */
export function poseName(sequence, frame, fps) {
  return `${title(sequence)}, ${((frame - sequence.first) / fps).toFixed(2)} s`;
}

/** Up to four significant digits, without an exponent for the sizes that occur here. */
export function figure(value) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}
