/**
 * Drag a point of the actor: its recorded frame changes, the body follows, and the change fades into the frames around. Edits
 * are a document beside what is asked (docs/editing.md); walks that pass there go through them.
 */

import { button, h } from '../dom.js';
import { count, poseName } from '../format.js';
import { Choice, GoRow, NumberField } from './dock.js';
import { EditMarks } from './edit-marks.js';
import { EditRuler } from './edit-ruler.js';
import { dragged, toRecorded, toWorld } from './edit-view.js';
import { Handles } from './handles.js';
import { Tool } from './tool.js';

/** Seconds to both sides that an edit reaches where its window is not given, as the engine has it. */
const REACH = 0.25;
/** Metres within which a press takes the handle that is there, and that an arrow key moves one. */
const NEAR = 0.05;
const STEP = 0.01;
/** Metres that a region reaches unless told otherwise. */
const RADIUS = 0.2;
const MOST_EDITS = 256;
/** CSS pixels that an arrow key moves the cross; with shift, so many times as far. */
const CROSS = { step: 6, far: 5 };
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

const SCOPES = [
  { value: 'body', text: 'body', title: 'The whole body follows' },
  { value: 'limb', text: 'limb', title: 'Only the limb that is grabbed follows' },
  { value: 'region', text: 'region', title: 'Only what is near along the surface follows' },
];
const METHODS = [
  { value: 'rig', text: 'bones', title: 'Bones turn, the surface follows' },
  { value: 'learned', text: 'learned', title: 'As the actor was seen to move' },
  { value: 'parts', text: 'by part', title: 'As the actor was seen to move, each limb for itself' },
  { value: 'arap', text: 'rigid', title: 'The surface alone, as rigid as possible' },
  { value: 'laplace', text: 'smooth', title: 'The surface alone, with its details as they are: for small moves' },
];
const FADES = [
  { value: 'nonlinear', text: 'turns', title: 'Rotations fade over the frames around' },
  { value: 'linear', text: 'shifts', title: 'Displacements fade: for small moves' },
  { value: 'constraint', text: 'anew', title: 'The body reaches anew in each frame' },
];

/** A tenth of a millimetre is enough, and makes short links. */
const tidy = (point) => point.map((at) => Math.round(at * 1e4) / 1e4);

/** An edit without what it would be anyway. */
function lean({ scope, method, propagate, pins, on, ...edit }) {
  const extra = Object.entries({ pins, scope, method, propagate, on }).filter(([, value]) => value !== undefined && !['contacts', 'body', 'rig', 'nonlinear', true].includes(value));
  return { ...edit, ...Object.fromEntries(extra) };
}

/** Handles that move in the plane of the view, the body following at once. */
class EditHandles extends Handles {
  make(index) {
    const button = super.make(index);
    button.addEventListener('pointerdown', (event) => event.button === 0 && this.act.begin(index, event));
    button.addEventListener('pointerup', () => this.act.end(true));
    button.addEventListener('pointercancel', () => this.act.end(false));
    return button;
  }

  drag(_, event) {
    this.act.drag(event);
  }

  lift() {}
}

export class EditTool extends Tool {
  static id = 'edit';
  static title = 'Edit';
  static about = 'Drag a point of the actor: the recording changes there';
  static hint = 'Drag a point of the actor; shift: straight up.';

  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    super(box);
    this.row = new GoRow(() => this.play(), 'Play');
    /** The chosen edit, its handle that had the focus last, and what the next edit will be like. */
    this.at = -1;
    this.chosen = 0;
    this.next = { scope: 'body', method: 'rig', propagate: 'nonlinear' };
    /** What is being dragged, or null. */
    this.held = null;
    /** Where the cross is on the stage while a point is picked with the keyboard, or null. */
    this.cross = null;
    this.listed = '';
    this.list = h('div', { class: 'choice edits', role: 'group', 'aria-label': 'Edits' });
    const act = (text, title, work, more = {}) => button(text, title, () => this.at >= 0 && work(this.edits[this.at]), more);
    this.actions = [
      act('on', 'Switch the edit off, or on again', (edit) => this.change({ on: edit.on === false }), { 'aria-pressed': 'true' }),
      act('copy', 'The same again where the actor is now, or after this one', (edit) => this.copy(edit)),
      act('delete', 'Take the edit away', () => this.remove(this.at)),
    ];
    this.pick = button('grab', 'Grab a point with the keyboard: arrow keys move a cross, Enter grabs', () => this.aim(), { 'aria-pressed': 'false' });
    this.rigChip = button('bones', 'Show the rig: the bones that move the body', () => this.toggleBones(), { 'aria-pressed': 'false' });
    this.fields = ['x', 'y', 'z'].map((name, axis) => new NumberField(name, 'cm', `How far the point is moved along ${name}, as the frame was recorded`, { step: 1, disabled: true }, (value) => this.typed(axis, value ?? 0)));
    this.radius = new NumberField('radius', 'cm', 'How far the region reaches along the surface', { min: 1, max: 1000, step: 1, value: 100 * RADIUS }, (value) => value && this.change({ scope: { radius: value / 100 } }, 'radius'));
    this.scope = new Choice('What follows', (value) => this.change({ scope: value === 'region' ? { radius: RADIUS } : value }));
    this.method = new Choice('How it follows', (value) => this.change({ method: value }));
    this.fade = new Choice('How it fades', (value) => this.change({ propagate: value }));
    this.scope.set(SCOPES, 'body');
    this.method.set(METHODS, 'rig');
    this.fade.set(FADES, 'nonlinear');
    this.ruler = new EditRuler({
      move: (which, frame, merge) => this.moveWindow(which, frame, merge),
      seek: (frame) => this.seek(this.sequence.first + frame),
    });
    this.build(
      h('div', { class: 'row' }, this.list, ...this.actions, h('span', { class: 'space' }), this.pick, this.rigChip),
      this.ruler.root,
      h('div', { class: 'row' }, ...this.fields.map(({ root }) => root), h('span', { class: 'space' }), this.scope.root, this.radius.root, this.method.root, this.fade.root),
      this.row.root,
    );
    this.marks = new EditMarks((foot) => this.togglePin(foot));
    this.handles = new EditHandles(box, {
      step: STEP,
      begin: (index, event) => this.beginHandle(index, event),
      drag: (event) => this.drag(event),
      end: (kept) => this.end(kept),
      move: (index, [x, z, y], merge) => this.moveHandle(index, [x, y, z], merge),
      lift: (index, by, merge) => this.moveHandle(index, this.handlePlace(index).map((at, axis) => (axis === 1 ? at + by : at)), merge),
      remove: (index) => this.removeHandle(index),
      chosen: (index) => this.choose(index),
      describe: (index) => `Point ${index + 1} of ${this.edit?.handles.length ?? 0}, vertex ${this.edit?.handles[index]?.vertex ?? 0}`,
    });
  }

  // ---- what there is --------------------------------------------------------------------------------------------

  get driver() {
    return this.box.kit.edits;
  }

  get view() {
    return this.box.core.view.stage;
  }

  get edits() {
    return this.box.document.edits;
  }

  get edit() {
    return this.edits[this.at];
  }

  get hint() {
    if (this.cross) return 'Move the cross with the arrow keys; Enter grabs what is under it.';
    return this.hasRig ? EditTool.hint : `${EditTool.hint} This actor has no rig: the surface alone is moved.`;
  }

  get hasRig() {
    return this.driver.editor?.has_rig() ?? true;
  }

  /** The sequence that the ruler shows: that of the chosen edit, or the one where the actor is. */
  get sequence() {
    return this.sequenceOf(this.edit) ?? this.timeline.sequenceOf(this.box.director?.state.frame ?? 0);
  }

  sequenceOf(edit) {
    return edit && this.timeline.sequences.find(({ name }) => name === edit.sequence);
  }

  /** The frame of an edit over the whole capture. */
  frameOf(edit) {
    return (this.sequenceOf(edit)?.first ?? 0) + edit.frame;
  }

  windowOf({ frame, window }) {
    const reach = Math.max(1, Math.ceil(REACH * this.timeline.fps));
    return window ?? [frame - reach, frame + reach];
  }

  /** A frame as it was recorded. */
  recorded(frame) {
    if (this.known?.frame !== frame) this.known = { frame, pose: this.box.director.player.recorded_pose(frame) };
    return this.known.pose;
  }

  point(pose, vertex) {
    return Array.from(pose.slice(3 * vertex, 3 * vertex + 3));
  }

  // ---- life -----------------------------------------------------------------------------------------------------

  opened({ timeline }) {
    this.timeline = timeline;
    this.at = -1;
    this.known = null;
    this.listed = '';
  }

  enter() {
    const { view } = this.box.core;
    view.handles.prepend(this.marks.root);
    this.driver.told = () => this.refresh();
    if (!this.box.director) return;
    this.box.director.tell('pause');
    this.driver.fetch().then(() => {
      if (this.box.tool === this && this.driver.ready) this.refresh();
    }, () => {});
    if (this.at < 0) this.at = this.edits.length - 1;
  }

  leave() {
    this.end(true);
    this.cross = null;
    this.driver.told = null;
    this.handles.hide();
    this.marks.hide();
    this.marks.root.remove();
  }

  /** Stands still in a recorded frame. @returns {import('./edit-view.js').Standing} */
  stand() {
    const { core, director } = this.box;
    let held = director.player.hold();
    if (held.length === 0) {
      core.host.seek(Math.round(director.state.frame));
      held = director.player.hold();
      core.say('blends cannot be edited: this is the recorded frame beside it', 'waiting');
    }
    director.known = null;
    const [frame, heading, x, z] = held;
    return { frame, heading, x, z };
  }

  /** Where the frame stands that is shown, or null where that is none. */
  get standing() {
    const { director } = this.box;
    if (!director || director.player.playing()) return null;
    const held = director.player.hold();
    return held.length > 0 ? { frame: held[0], heading: held[1], x: held[2], z: held[3] } : null;
  }

  seek(frame) {
    const { core } = this.box;
    core.attempt(() => core.host.seek(frame));
    this.refresh();
  }

  play() {
    const { core: { host } } = this.box;
    if (host.playing) {
      host.pause();
      return;
    }
    if (this.edit) {
      const { first, count: frames } = this.sequence;
      this.seek(first + Math.max(0, Math.min(frames - 1, this.windowOf(this.edit)[0])));
    }
    host.play();
  }

  // ---- changing the document ------------------------------------------------------------------------------------

  set(edits, merge = null) {
    this.box.edit({ edits }, merge);
  }

  /** Changes the chosen edit; without one, what the next will be like. */
  change(part, merge = null) {
    if (!('on' in part)) this.next = { ...this.next, ...part };
    if (this.edit) this.set(this.edits.with(this.at, lean({ ...this.edit, ...part })), merge && `${merge} ${this.at}`);
    else this.refresh();
  }

  remove(index) {
    this.at = Math.min(index, this.edits.length - 2);
    this.set(this.edits.toSpliced(index, 1));
    this.box.core.say('the edit is taken away');
  }

  copy(edit) {
    if (this.edits.length >= MOST_EDITS) return;
    const [first, last] = this.windowOf(edit);
    const { first: begin, count: frames } = this.sequence;
    const here = this.timeline.sequenceOf(this.box.director.state.frame).name === edit.sequence ? Math.round(this.box.director.state.frame) - begin : edit.frame;
    const frame = Math.min(frames - 1, here === edit.frame ? last : here);
    this.at = this.edits.length;
    this.set([...this.edits, this.moved({ ...edit, window: [first, last] }, frame)]);
  }

  /** The same edit of another frame of its sequence: points are moved as far as they were. */
  moved(edit, frame) {
    const { first } = this.sequenceOf(edit);
    const [from, to] = [Array.from(this.recorded(first + edit.frame)), this.recorded(first + frame)];
    const handles = edit.handles.map(({ vertex, ...rest }) => ({ ...rest, vertex, to: tidy(this.point(to, vertex).map((at, axis) => at + rest.to[axis] - from[3 * vertex + axis])) }));
    const by = frame - edit.frame;
    return { ...edit, frame, handles, ...(edit.window ? { window: edit.window.map((at) => at + by) } : {}) };
  }

  moveWindow(which, frame, merge) {
    const { edit } = this;
    if (!edit) return;
    const { count: frames, cyclic } = this.sequence;
    const [least, most] = cyclic ? [edit.frame - frames, edit.frame + frames] : [0, frames - 1];
    if (which === 1) {
      const to = Math.max(0, Math.min(frames - 1, frame));
      if (to !== edit.frame) this.set(this.edits.with(this.at, this.moved(edit, to)), merge);
      return;
    }
    const window = [...this.windowOf(edit)];
    window[which / 2] = which === 0 ? Math.max(least, Math.min(edit.frame, frame)) : Math.min(most, Math.max(edit.frame, frame));
    this.set(this.edits.with(this.at, { ...edit, window }), merge);
  }

  setHandles(handles, merge) {
    this.set(this.edits.with(this.at, { ...this.edit, handles }), merge);
  }

  /** How far a handle is moved along an axis. */
  typed(axis, centimetres) {
    const { edit, chosen } = this;
    const handle = edit?.handles[chosen];
    if (!handle) return;
    const from = this.point(this.recorded(this.frameOf(edit)), handle.vertex);
    const to = handle.to.map((at, other) => (other === axis ? from[axis] + centimetres / 100 : at));
    this.setHandles(edit.handles.with(chosen, { ...handle, to: tidy(to) }), null);
  }

  // ---- feet -----------------------------------------------------------------------------------------------------

  /** The feet in the frame of the chosen edit: which stand, and which stay. */
  feet() {
    const { edit, driver } = this;
    if (!edit || !driver.editor) return [];
    const pins = edit.pins ?? 'contacts';
    return Array.from(driver.editor.stands(this.frameOf(edit)), (standing, foot) => {
      const vertices = driver.editor.sole(foot);
      const stands = standing === 1;
      return { vertices, stands, stays: Array.isArray(pins) ? pins.includes(vertices[0]) : pins === 'contacts' && stands };
    });
  }

  togglePin(foot) {
    const feet = this.feet().map((one, at) => (at === foot ? { ...one, stays: !one.stays } : one));
    const usual = feet.every(({ stays, stands }) => stays === stands);
    const none = feet.every(({ stays }) => !stays);
    const vertices = feet.filter(({ stays }) => stays).flatMap((one) => Array.from(one.vertices));
    this.change({ pins: usual ? 'contacts' : none ? 'none' : vertices.sort((a, b) => a - b) });
  }

  // ---- grabbing -------------------------------------------------------------------------------------------------

  vertexAt(x, y) {
    return this.view.stage?.vertex_at(this.box.director.player, x, y) ?? -1;
  }

  grab({ offsetX, offsetY }) {
    if (this.cross) {
      return { move: () => {}, end: () => this.pickAt(offsetX, offsetY) };
    }
    if (!this.takeHold(offsetX, offsetY)) return null;
    return { move: (event) => this.drag(event), end: () => this.end(true), drop: () => this.end(false) };
  }

  /** Takes hold of the point of the body that is seen there. @returns whether there is one */
  takeHold(x, y) {
    const { driver, box } = this;
    const vertex = box.director ? this.vertexAt(x, y) : -1;
    if (vertex < 0) return false;
    if (!driver.ready) {
      box.core.say('the editor is on its way', 'waiting');
      return false;
    }
    if (this.edits.length >= MOST_EDITS) {
      box.core.say(`that are ${MOST_EDITS} edits: there can be no more`, 'waiting');
      return false;
    }
    const standing = this.stand();
    const merge = `grab ${performance.now()}`;
    const at = this.editOf(standing.frame);
    const handle = at < 0 ? this.begin(vertex, standing, merge) : this.add(at, vertex, standing, merge);
    this.hold(handle, standing, { x, y }, merge);
    return true;
  }

  /** The edit of a frame that a press there goes on with: the chosen one, or the last. */
  editOf(frame) {
    const is = (edit) => edit && edit.on !== false && this.frameOf(edit) === frame;
    return is(this.edit) ? this.at : this.edits.findLastIndex(is);
  }

  /** A new edit with one handle, where it is. @returns {number} its handle */
  begin(vertex, { frame }, merge) {
    const { name, first } = this.timeline.sequenceOf(frame);
    const handles = [{ vertex, to: this.point(this.recorded(frame), vertex) }];
    const { scope, method, propagate } = this.next;
    this.at = this.edits.length;
    this.set([...this.edits, lean({ sequence: name, frame: frame - first, handles, scope, method: this.hasRig ? method : method === 'rig' ? 'arap' : method, propagate })], merge);
    return 0;
  }

  /** One more handle, unless there is one. @returns {number} which */
  add(at, vertex, standing, merge) {
    this.at = at;
    const { handles } = this.edit;
    const recorded = this.recorded(standing.frame);
    const from = this.point(recorded, vertex);
    const far = (handle) => Math.hypot(...this.point(recorded, handle.vertex).map((place, axis) => place - from[axis]));
    const near = handles.findIndex((handle) => far(handle) < NEAR);
    if (near >= 0) return near;
    const to = toRecorded(standing, this.point(this.box.director.player.pose(), vertex));
    this.setHandles([...handles, { vertex, to: tidy(to) }], merge);
    return handles.length;
  }

  beginHandle(index, { clientX, clientY }) {
    if (!this.driver.ready || !this.edit) return;
    const box = this.view.root.getBoundingClientRect();
    this.hold(index, this.stand(), { x: clientX - box.left, y: clientY - box.top }, `handle ${performance.now()}`);
  }

  /** From now on a handle of the chosen edit follows the pointer. */
  hold(handle, standing, { x, y }, merge) {
    this.chosen = handle;
    const { to } = this.edit.handles[handle];
    const shown = this.handlePlace(handle, standing);
    const seen = this.view.seen(shown[0], shown[2], shown[1]);
    try {
      this.driver.grab(this.edits, this.at);
    } catch (error) {
      this.driver.release();
      this.driver.failed(error);
      return;
    }
    // The point is taken where it was pressed, not where its vertex is.
    this.held = { at: this.at, handle, standing, merge, base: to, start: toRecorded(standing, shown), from: shown, offset: [seen.x - x, seen.y - y], target: null, moved: false };
    this.marks.showPoint(null);
    this.refresh();
  }

  /** Where a handle is in the world: where its vertex is drawn. */
  handlePlace(index, standing = this.standing) {
    const { vertex, to } = this.edit.handles[index];
    const point = this.point(this.box.director.player.pose(), vertex);
    return standing && point.length === 3 ? point : toWorld(standing ?? { heading: 0, x: 0, z: 0 }, to);
  }

  /** The pointer has moved; the body follows with the next picture. */
  drag({ clientX, clientY, shiftKey }) {
    if (!this.held) return;
    const box = this.view.root.getBoundingClientRect();
    const [dx, dy] = this.held.offset;
    this.held.target = { at: { x: clientX - box.left + dx, y: clientY - box.top + dy }, straightUp: shiftKey };
    this.box.core.redraw();
  }

  /** Called once a display frame. */
  step() {
    const { held } = this;
    if (!held?.target) return;
    const { target: { at, straightUp }, standing, start, base, handle, merge } = held;
    held.target = null;
    held.moved = true;
    const to = toRecorded(standing, dragged(this.view, held.from, at, straightUp));
    this.pull(handle, tidy(base.map((place, axis) => place + to[axis] - start[axis])), standing, merge);
  }

  pull(handle, to, { frame }, merge) {
    const { edit, driver } = this;
    const handles = edit.handles.with(handle, { ...edit.handles[handle], to });
    try {
      driver.drag(frame, handles.flatMap((one) => one.to));
    } catch (error) {
      driver.failed(error);
    }
    this.setHandles(handles, merge);
  }

  /** @param {boolean} kept whether it stays as it is now */
  end(kept) {
    const { held } = this;
    if (!held) return;
    this.step();
    this.held = null;
    this.driver.release();
    this.box.history.settle();
    if (!kept && held.moved) this.box.undo(-1);
    this.refresh();
    this.handles.focus(held.handle);
  }

  moveHandle(index, world, merge) {
    const { standing } = this;
    if (!standing) return;
    const handle = this.edit.handles[index];
    const [from, to] = [toRecorded(standing, this.handlePlace(index, standing)), toRecorded(standing, world)];
    this.setHandles(this.edit.handles.with(index, { ...handle, to: tidy(handle.to.map((at, axis) => at + to[axis] - from[axis])) }), `${merge} ${this.at}`);
  }

  removeHandle(index) {
    if (this.edit.handles.length > 1) this.setHandles(this.edit.handles.toSpliced(index, 1), null);
    else this.remove(this.at);
  }

  choose(index) {
    this.chosen = index;
    this.refresh();
  }

  // ---- with the keyboard ----------------------------------------------------------------------------------------

  aim() {
    this.cross = this.cross ? null : [this.view.size.width / 2, this.view.size.height / 2];
    if (this.cross) this.box.director?.tell('pause');
    this.refresh();
  }

  pickAt(x, y) {
    if (!this.takeHold(x, y)) {
      this.box.core.say('that is not the body', 'waiting');
      return;
    }
    this.cross = null;
    this.end(true);
  }

  key(event, inField) {
    const { key, shiftKey, repeat } = event;
    if (inField || !this.box.director) return false;
    if (this.cross) return this.crossKey(key, shiftKey, repeat);
    // A button is pressed by it.
    if (key === 'Enter' && event.composedPath()[0]?.tagName === 'BUTTON') return false;
    const by = { ArrowLeft: -1, ArrowRight: 1 }[key];
    if (by) this.seek(this.timeline.step(this.box.director.state.frame, by * (shiftKey ? 10 : 1)));
    else if (key === 'Enter' && !repeat) this.play();
    else if (key === 'Delete' && this.edit) this.remove(this.at);
    else return false;
    return true;
  }

  crossKey(key, shiftKey, repeat) {
    const by = ARROWS[key];
    if (by) this.cross = this.cross.map((at, axis) => at + by[axis] * CROSS.step * (shiftKey ? CROSS.far : 1));
    else if (key === 'Enter' && !repeat) this.pickAt(...this.cross);
    else if (key === 'Escape') this.aim();
    else return false;
    this.box.core.redraw();
    return true;
  }

  // ---- what is shown --------------------------------------------------------------------------------------------

  toggleBones() {
    this.rigChip.setAttribute('aria-pressed', String(!this.showsBones));
    if (this.showsBones && !this.hasRig) this.box.core.say('this actor has no rig', 'waiting');
    this.box.core.redraw();
  }

  get showsBones() {
    return this.rigChip.getAttribute('aria-pressed') === 'true';
  }

  /** What is under the pointer would be grabbed. */
  hover(x, y) {
    const { box, held, cross } = this;
    if (held || cross || !box.director) return;
    const vertex = x === undefined ? -1 : this.vertexAt(x, y);
    this.view.root.toggleAttribute('data-over-actor', vertex >= 0);
    const [px, py, pz] = vertex < 0 ? [] : this.point(box.director.player.pose(), vertex);
    this.marks.showPoint(vertex < 0 ? null : this.view.seen(px, pz, py));
  }

  refresh() {
    if (!this.timeline || !this.box.kit) return;
    if (this.at >= this.edits.length) this.at = this.edits.length - 1;
    // What is undone and done again, or comes in a link, is chosen where the actor stands in it.
    if (this.at < 0 && this.edits.length > 0 && this.standing) this.at = this.editOf(this.standing.frame);
    const { edit, driver } = this;
    this.chosen = Math.min(this.chosen, Math.max(0, (edit?.handles.length ?? 1) - 1));
    this.showList();
    this.showRuler();
    const { scope = 'body', method = 'rig', propagate = 'nonlinear' } = edit ?? this.next;
    const region = typeof scope === 'object';
    this.scope.choose(region ? 'region' : scope);
    this.radius.root.hidden = !region;
    if (region) this.radius.show(String(Math.round(scope.radius * 1000) / 10));
    this.method.choose(method);
    this.method.root.children[0].disabled = !this.hasRig;
    this.method.root.children[1].disabled = !(driver.editor?.has_space() ?? true);
    this.fade.choose(propagate);
    this.showFields();
    this.actions.forEach((one) => (one.disabled = !edit));
    this.actions[0].setAttribute('aria-pressed', String(Boolean(edit) && edit.on !== false));
    this.pick.setAttribute('aria-pressed', String(Boolean(this.cross)));
    const shows = this.box.tool === this && edit && driver.editor && this.standing?.frame === this.frameOf(edit);
    this.handles.show(shows ? edit.handles.map((_, index) => this.seenHandle(index)) : [], (index) => (index === this.chosen ? 'chosen' : ''));
    this.marks.showFeet(shows ? this.feet() : []);
    this.showStatus();
    this.box.core.redraw();
  }

  /** As handles have it: x, z and height. */
  seenHandle(index) {
    const [x, y, z] = this.handlePlace(index);
    return [x, z, y];
  }

  showList() {
    const { fps } = this.timeline;
    const names = this.edits.map((edit) => poseName(this.sequenceOf(edit) ?? { name: edit.sequence, first: 0 }, this.frameOf(edit), fps));
    const listed = JSON.stringify([names, this.at, this.edits.map(({ on }) => on !== false)]);
    if (listed === this.listed) return;
    this.listed = listed;
    this.list.replaceChildren(
      ...names.map((name, index) =>
        button(name, 'Go to this edit', () => this.select(index), { 'aria-pressed': String(index === this.at), class: `chip ${this.edits[index].on === false ? 'off' : ''}` }),
      ),
    );
  }

  select(index) {
    this.at = index;
    this.chosen = 0;
    this.seek(this.frameOf(this.edits[index]));
  }

  showRuler() {
    const { sequence, edits } = this;
    const shown = edits.map((edit, index) => ({ edit, index })).filter(({ edit }) => edit.sequence === sequence.name);
    const within = ([first, last]) => (sequence.cyclic ? [first, last] : [Math.max(0, first), Math.min(sequence.count - 1, last)]);
    const bars = shown.map(({ edit }) => ({ window: within(this.windowOf(edit)), frame: edit.frame, on: edit.on !== false }));
    this.ruler.show(sequence.count, this.timeline.fps, bars, shown.findIndex(({ index }) => index === this.at));
  }

  showFields() {
    const handle = this.edit?.handles[this.chosen];
    const from = handle && this.box.director ? this.point(this.recorded(this.frameOf(this.edit)), handle.vertex) : [];
    this.fields.forEach((field, axis) => {
      field.input.disabled = from.length === 0;
      field.show(from.length === 0 ? '' : (100 * (handle.to[axis] - from[axis])).toFixed(1).replace(/^-0\.0$/, '0.0'));
    });
  }

  answered() {
    this.showStatus();
  }

  showStatus() {
    const { driver, box: { director } } = this;
    const busy = !driver.editor || driver.due.length > 0;
    this.row.show(director ? this.sentence() : this.hint, Boolean(director), busy);
  }

  sentence() {
    const { driver, edit } = this;
    if (!driver.editor) return 'the editor is on its way';
    if (driver.trouble) return driver.trouble;
    const trouble = driver.editor.rig_trouble();
    if (trouble) return `${trouble}: the surface alone is moved`;
    if (!edit || this.cross) return this.hint;
    const note = driver.notes.find((one) => one.startsWith(`edit ${this.at}: `));
    if (note) return note.slice(`edit ${this.at}: `.length);
    if (driver.due.length > 0) return `changing ${count(driver.due.length, 'frame')} more`;
    return `${count(driver.made.size, 'frame')} changed`;
  }

  place(seen) {
    const { director, core } = this.box;
    if (!director?.info) return;
    const { frame } = director.state;
    const { first, count: frames } = this.sequence;
    this.ruler.showHead(frame >= first && frame < first + frames ? frame - first : null);
    const shows = this.handles.points.length > 0;
    const bones = this.showsBones && this.driver.editor;
    const pose = shows || bones ? director.player.pose() : [];
    if (shows && !this.held && this.standing?.frame !== this.frameOf(this.edit)) {
      this.refresh();
      return;
    }
    if (shows) this.handles.points = this.edit.handles.map(({ vertex }) => [pose[3 * vertex], pose[3 * vertex + 2], pose[3 * vertex + 1]]);
    this.handles.place(seen);
    this.marks.place(pose, bones ? this.driver.editor.bones(pose) : [], seen);
    if (this.cross) this.marks.showPoint({ x: this.cross[0], y: this.cross[1], visible: true });
    this.marks.point.toggleAttribute('data-picking', Boolean(this.cross));
    core.view.handles.toggleAttribute('data-bones', Boolean(bones));
  }
}
