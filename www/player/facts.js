/** The numbers an animator asks for, in the papers' terms; shown only on demand. */

import { h } from './dom.js';
import { count, duration, figure, words } from './format.js';

export class Facts {
  constructor() {
    this.rows = new Map();
    this.list = h('dl');
    this.root = h('section', { class: 'facts', 'aria-label': 'Facts', part: 'facts', hidden: true }, this.list);
  }

  get open() {
    return !this.root.hidden;
  }

  toggle(open = !this.open) {
    this.root.hidden = !open;
  }

  /**
   * @param {object} facts
   * @param {object} facts.info of the bundle
   * @param {object} facts.state of the player
   * @param {object | null} facts.walk the walk planned or under way
   * @param {object[]} facts.families each with what is performed of it
   * @param {number} facts.frameMs CPU time of a frame of ours
   * @param {{name: string, fallback: boolean} | null} facts.adapter
   * @param {string | undefined} facts.texture how the texture is rebuilt
   */
  update({ info, state, walk, families, frameMs, adapter, texture }) {
    if (!this.open) return;
    this.group('Walk');
    this.row('cost', walk ? figure(walk.cost) : '–', 'The sum of D + αL over the walk, in the essential graph');
    this.row('duration', walk ? `${duration(walk.seconds)}, ${count(walk.frames, 'frame')}` : '–', 'L, the frames of the walk');
    this.row('deformation', walk ? figure(walk.deformation) : '–', 'D, the sum of pose distances along its transitions');
    this.row('transitions', walk ? String(walk.transitions) : '–');
    this.group('Actor');
    this.row('frame', String(Math.round(state.frame)));
    if (info.varies) this.row('alternative', state.alternative === undefined ? 'as recorded' : String(state.alternative), 'The variation of the recorded stretch that most is shown of; another one is mixed in');
    // Where none is performed, the figure is a dash.
    for (const { name, parameter, unit, value } of families) this.row(`${words(name)}, ${parameter}`, `${figure(value)} ${unit}`);
    if (info.scanned) this.row('shown', { scan: 'as scanned', carried: 'scans, carried' }[state.shown] ?? 'on one mesh', 'Recorded frames as they were scanned; edited ones, and those of both ends of a transition, carried by the mesh that all were brought onto; else that mesh');
    this.row('surface', `${info.vertices.toLocaleString('en')} vertices, ${info.triangles.toLocaleString('en')} triangles`);
    this.row('capture', `${info.frames.toLocaleString('en')} frames at ${figure(info.fps).replace(/\.?0+$/, '')} a second`);
    this.row('essential graph', `${info.transitions.toLocaleString('en')} transitions`, 'Edges that lie on a shortest path, consecutive frames not counted');
    this.row('density', figure(info.density), 'Edges kept, as a part of all pairs of frames');
    this.row('α', figure(info.alpha), 'The cost of one frame of duration');
    this.row('within reach', `${info.main.toLocaleString('en')} frames`, 'The largest strongly connected component');
    if (info.appearance) this.row('texture', `${info.appearance.join(' + ')} modes, ${texture ?? 'not yet'}`, 'Eigen textures + Eigen warps, and how they are put together here');
    this.group('Time');
    this.row('synthetic frame', Number.isFinite(state.synthesis_ms) && state.synthesis_ms > 0 ? `${state.synthesis_ms.toFixed(1)} ms` : '–', 'Median: blend, align and Poisson solve');
    this.row('whole frame', Number.isFinite(frameMs) ? `${frameMs.toFixed(1)} ms` : '–', 'Median CPU time: synthesis and drawing commands');
    this.row('drawn by', adapter ? `${adapter.name}${adapter.fallback ? ' (in software: slow)' : ''}` : '–');
  }

  group(name) {
    if (!this.rows.has(name)) this.rows.set(name, this.list.appendChild(h('div', { class: 'group' }, name)));
  }

  row(name, value, explanation = null) {
    let cell = this.rows.get(`${name}:`);
    if (!cell) {
      cell = h('dd');
      this.list.append(h('div', { title: explanation }, h('dt', {}, name), cell));
      this.rows.set(`${name}:`, cell);
    }
    if (cell.textContent !== value) cell.textContent = value;
  }
}
