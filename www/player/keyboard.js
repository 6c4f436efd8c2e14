/** What the keys do, in one table: the handler and the dialog that lists them (`tools/keys.js`) both read it. */

/** @type {{keys: string[], shown: string, does: string, act: string}[]} */
export const KEYS = [
  { keys: ['ArrowLeft', 'ArrowRight'], shown: '← →', does: 'move over the frames of a sequence, with shift by half a second', act: 'step' },
  { keys: ['ArrowUp', 'ArrowDown'], shown: '↑ ↓', does: 'move over the sequences', act: 'across' },
  { keys: ['Home', 'End'], shown: 'Home End', does: 'first and last frame of a sequence', act: 'ends' },
  { keys: ['Enter'], shown: 'Enter', does: 'go to that pose, with shift after what is under way', act: 'go' },
  { keys: [' '], shown: 'Space', does: 'play or pause', act: 'toggle' },
  { keys: ['Escape'], shown: 'Esc', does: 'stop on the way, or put away what is open', act: 'cancel' },
  { keys: ['1', '2', '3', '4', '5', '6'], shown: '1 to 6', does: 'choose a tool: pose, place, path, timing, wander, edit', act: 'tool' },
  { keys: ['f'], shown: 'F', does: 'facts', act: 'facts' },
  { keys: ['t'], shown: 'T', does: 'tint: recorded green, synthetic red', act: 'tint' },
  { keys: ['b'], shown: 'B', does: 'parts of the body in colours', act: 'parts' },
  { keys: ['p'], shown: 'P', does: 'poses around the actor', act: 'poses' },
  { keys: ['c'], shown: 'C', does: 'compare ways of changing the texture', act: 'compare' },
  { keys: ['l'], shown: 'L', does: 'loop', act: 'loop' },
  { keys: ['?'], shown: '?', does: 'these keys', act: 'help' },
];

/**
 * @param {KeyboardEvent} event
 * @param {Record<string, (event: KeyboardEvent) => void>} actions by the names in the table
 * @returns {boolean} whether the key was used
 */
export function handleKey(event, actions) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return false;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const entry = KEYS.find(({ keys }) => keys.includes(key));
  const target = event.composedPath()[0];
  if (!entry || usesKey(target, key)) return false;
  event.preventDefault();
  actions[entry.act]?.(event);
  return true;
}

/** Controls keep the keys that are theirs: space and enter press a button, arrows move in a list. */
function usesKey(target, key) {
  const tag = target?.tagName;
  if (tag === 'INPUT' || tag === 'TEXTAREA' || target?.isContentEditable) return true;
  if (tag === 'BUTTON' || tag === 'A') return key === ' ' || key === 'Enter';
  return tag === 'SELECT' && key !== 'Escape' && key !== '?';
}
