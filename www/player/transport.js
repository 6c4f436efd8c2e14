/** Play and pause, the time, speed and loop, and the line that says where the actor is going. */

import { h, icon, iconButton } from './dom.js';
import { clock, title } from './format.js';
import { WalkBar } from './walk-bar.js';

const SPEEDS = [0.25, 0.5, 1, 1.5, 2];

export class Transport {
  /**
   * @param {object} act
   * @param {() => void} act.toggle play or pause
   * @param {(speed: number) => void} act.speed
   * @param {() => void} act.loop
   * @param {() => void} act.drawer opens or closes the strips where they are a drawer
   */
  constructor(act) {
    this.play = iconButton('play', 'Play (space)', () => act.toggle());
    this.name = h('span', { class: 'name' });
    this.time = h('span', { class: 'time' });
    this.speed = h('select', { class: 'speed', 'aria-label': 'Speed' }, ...SPEEDS.map((speed) => h('option', { value: speed }, `${speed}×`)));
    this.loop = iconButton('loop', 'Loop (L)', () => act.loop(), { 'aria-pressed': 'false' });
    this.status = h('span', { class: 'status', role: 'status', 'aria-live': 'polite' });
    this.walk = new WalkBar();
    this.drawer = iconButton('chevron', 'Poses', () => act.drawer(), { class: 'round drawer', 'aria-expanded': 'true' });
    this.root = h(
      'div',
      { class: 'transport', part: 'transport' },
      this.play,
      h('span', { class: 'where' }, this.time, this.name),
      this.speed,
      this.loop,
      this.status,
      this.walk.root,
      this.drawer,
    );
    this.speed.addEventListener('change', () => act.speed(Number(this.speed.value)));
    this.setPlaying(false);
    this.setSpeed(1);
  }

  setPlaying(playing) {
    if (this.playing === playing) return;
    this.playing = playing;
    const label = playing ? 'Pause' : 'Play';
    this.play.setAttribute('aria-label', label);
    this.play.title = `${label} (space)`;
    this.play.replaceChildren(icon(playing ? 'pause' : 'play'));
  }

  setSpeed(speed) {
    const known = SPEEDS.includes(speed);
    this.speed.value = known ? String(speed) : '1';
  }

  setLoop(on) {
    this.loop.setAttribute('aria-pressed', String(on));
  }

  setDrawer(open) {
    this.drawer.setAttribute('aria-expanded', String(open));
  }

  /** @param {string} kind `hint`, `going`, `arrived` or `waiting`: how the line looks */
  say(text, kind) {
    this.status.dataset.kind = kind;
    if (this.status.textContent !== text) this.status.textContent = text;
  }

  update(state, timeline) {
    const sequence = timeline.sequenceOf(state.frame);
    this.time.textContent = clock((state.frame - sequence.first) / timeline.fps);
    if (this.name.textContent !== title(sequence)) this.name.textContent = title(sequence);
    this.walk.update(state, timeline);
  }
}
