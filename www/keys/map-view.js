/** The map of frames between the sequences that are shown, as a matrix with its path, and in words. */

import { button, h } from './dom.js';
import { drawMatrix } from './matrix.js';
import { sourceAt } from './maps.js';
import { stepOf } from './ruler.js';
import { pairName } from './rules.js';

export class MapView {
  /** @param {(from: number, to: number) => void} showFrames of the sequences that are shown */
  constructor(showFrames) {
    this.showFrames = showFrames;
    this.here = { from: 0, to: 0 };
    this.scene = null;
    this.canvas = h('canvas', { role: 'slider', tabindex: '0', 'aria-label': 'Map of frames: which frame of the source belongs to which of the target' });
    this.frame = h('div', { class: 'matrix', hidden: true }, this.canvas);
    this.sentence = h('p', { class: 'quiet' });
    this.doubts = h('ul', { class: 'findings', 'aria-label': 'What builder transfer warned of' });
    this.command = h('code', {});
    this.commandLine = h('p', { class: 'command' }, this.command, button('Copy', () => this.copy(), { class: 'quiet-button', 'aria-label': 'Copy the commands' }));
    this.root = h('div', {}, this.frame, this.sentence, this.doubts, this.commandLine);
    this.canvas.addEventListener('click', (event) => this.click(event));
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(this.frame);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
  }

  /**
   * @param {object} what
   * @param {import('./side.js').Side} what.source
   * @param {import('./side.js').Side} what.target
   * @param {object[]} what.pairs of the sequences that are shown
   * @param {import('./maps.js').FrameMap[]} what.maps between them
   * @param {object | null} what.transfer what the command has told
   * @param {boolean} what.stale whether it was made of other keys
   */
  show({ source, target, pairs, maps, transfer, stale }) {
    this.source = source;
    this.target = target;
    const ready = Boolean(source.sequence && target.sequence) && pairs.length + maps.length > 0;
    this.scene = ready ? { pairs, maps, from: source.sequence.name, to: target.sequence.name, ...bounds(pairs, maps) } : null;
    this.frame.hidden = !ready;
    this.sentence.textContent = words(source, target, pairs, maps, transfer, stale);
    this.showDoubts(transfer && !stale ? transfer : { doubts: [], warnings: [] });
    this.command.textContent = `builder transfer --from ${shell(source.name || 'SOURCE')} \\\n  --to ${shell(target.name || 'TARGET')} --keys keys.toml -o more/\nbuilder pack more/ -o more.reprise`;
    this.point(source.frame, target.frame);
  }

  showDoubts({ doubts, warnings }) {
    const text = JSON.stringify([doubts, warnings]);
    if (text === this.told) return;
    this.told = text;
    const said = doubts.map(({ key, better_from_frame: better, off }) => {
      const pair = { from: key.from, fromFrame: key.from_frame, to: key.to, toFrame: key.to_frame };
      return `${pairName(pair)} looks wrong by ${off.toFixed(1)} frames: ${key.to} ${key.to_frame} is more like ${key.from} ${Math.round(better)}. It was not trusted.`;
    });
    this.doubts.replaceChildren(...[...said, ...warnings].map((words) => h('li', { 'data-kind': 'hint' }, words)));
  }

  /** The moments that are shown in the players. */
  point(from, to) {
    this.here = { from, to };
    if (!this.scene) return;
    const { canvas, scene } = this;
    canvas.setAttribute('aria-valuemin', String(scene.toFirst));
    canvas.setAttribute('aria-valuemax', String(scene.toLast));
    canvas.setAttribute('aria-valuenow', String(Math.round(to)));
    canvas.setAttribute('aria-valuetext', `target ${scene.to} ${Math.round(to)}, source ${scene.from} ${Math.round(from)}`);
    this.draw();
  }

  /** Once in the next display frame, however often it is asked for. */
  draw() {
    if (this.drawing) return;
    this.drawing = requestAnimationFrame(() => {
      this.drawing = 0;
      if (this.scene && this.frame.clientWidth > 0) this.area = drawMatrix(this.canvas, this.scene, this.here);
    });
  }

  click({ clientX, clientY }) {
    if (!this.area) return;
    const { left, top } = this.canvas.getBoundingClientRect();
    const { from, to } = this.area.frameAt(clientX - left, clientY - top);
    this.showFrames(from, to);
  }

  key(event) {
    const by = stepOf(event);
    if (by === null || !this.scene || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const { scene, here } = this;
    if (event.key === 'ArrowUp' || event.key === 'ArrowDown') {
      this.showFrames(Math.round(here.from) + by, Math.round(here.to));
      return;
    }
    const to = Math.min(scene.toLast, Math.max(scene.toFirst, Math.round(here.to) + by));
    const map = scene.maps.find(({ toFirst, toLast }) => to >= toFirst && to <= toLast);
    this.showFrames(map ? sourceAt(map, to) : here.from, to);
  }

  async copy() {
    await navigator.clipboard.writeText(this.command.textContent).catch(() => getSelection().selectAllChildren(this.command));
  }
}

/** The frames that the picture shows, in both. */
function bounds(pairs, maps) {
  const from = [...pairs.map((pair) => pair.fromFrame), ...maps.flatMap((map) => [map.fromFirst, map.fromLast])];
  const to = [...pairs.map((pair) => pair.toFrame), ...maps.flatMap((map) => [map.toFirst, map.toLast])];
  return { fromFirst: Math.min(...from), fromLast: Math.max(...from), toFirst: Math.min(...to), toLast: Math.max(...to) };
}

function words(source, target, pairs, maps, transfer, stale) {
  if (!source.sequence || !target.sequence) return 'Which frames belong together is drawn here once source and target are open.';
  if (pairs.length + maps.length === 0) return `No frames of “${source.sequence.name}” and “${target.sequence.name}” are matched: there is no map of them yet.`;
  const learned = maps.some(({ costs }) => costs);
  if (learned) return 'As builder transfer has found it (transfer.json): the stronger a point, the more probable that its two frames belong together. The line is the path that was taken, rings are keys; a click shows both frames.';
  const straight = 'The line is drawn straight from key to key; a click shows both frames. ';
  if (stale) return `${straight}The keys are no longer those of the opened transfer.json: transfer again, or undo.`;
  if (transfer) return `${straight}The opened transfer.json has no map of these two sequences.`;
  return `${straight}What lies between is found by the commands below; open the transfer.json in their folder to see it here.`;
}

function shell(name) {
  return /^[\w./+-]+$/.test(name) ? name : `'${name.replaceAll("'", String.raw`'\''`)}'`;
}
