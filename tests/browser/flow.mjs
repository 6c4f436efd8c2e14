/**
 * How much of its pattern an actor keeps in the middle of transitions that carry scans, with their colours flowing into each other and
 * without: `REPRISE_BUNDLE=windows.reprise node tests/browser/flow.mjs [walks]`. Detail is the mean difference of pixels beside each other
 * within the actor, given in parts of what the scanned frames at both ends have. Pictures go to out/.
 */

import { writeFileSync } from 'node:fs';
import { Browser, out } from './browser.mjs';

const count = Number(process.argv[2] ?? 4);
const MIDDLE = 0.48;

/** Mean difference of neighbours within the actor, and pixels of it. */
const detail = (player) =>
  player.run(async (element) => {
    element.testing.core.draw();
    const pixels = await element.testing.stage.read_pixels();
    const { width } = element.testing.core.view.stage.canvas;
    const inside = (at) => [0, 1, 2].some((channel) => Math.abs(pixels[at + channel] - pixels[channel]) > 60);
    let [sum, number] = [0, 0];
    for (let at = 0; at + 4 * width < pixels.length; at += 4) {
      if (![at, at + 4, at + 4 * width].every(inside)) continue;
      for (const next of [at + 4, at + 4 * width]) for (let channel = 0; channel < 3; channel += 1) sum += Math.abs(pixels[at + channel] - pixels[next + channel]);
      number += 6;
    }
    return sum / number;
  });

/** Lets time pass, without drawing, until `when` is true of the element, for `most` seconds; whether it became so. It stands still then. */
const until = (player, when, most) =>
  player.run(`(element) => {
    element.play();
    for (let time = 0; time < ${most} && element.playing && !(${when})(element); time += 0.002) element.testing.tick(0.002);
    element.pause();
    return Boolean((${when})(element));
  }`);

/** Goes on into a transition, a little at a time, with what is wanted on the way. */
async function inside(player, flowing) {
  for (let steps = 0; steps < 80; steps += 1) {
    await player.until('the scans', (element) => !element.testing.stage.scans_wanted(element.testing.player).length);
    if (flowing) await player.until('the flow', (element) => !element.testing.stage.flow_wanted(element.testing.player).length);
    if (await until(player, '(element) => element.state.transition', 0.2)) return true;
  }
  return false;
}

const browser = await Browser.launch();
const player = await browser.open({ viewport: { width: 900, height: 700 }, reducedMotion: 'reduce', colorScheme: 'light' });
await player.loaded();
await player.run((element) => element.pause());
const frames = await player.run((element) => element.info.frames);
for (let k = 0; k < count; k += 1) {
  const [from, to] = [0.5, 1.5].map((part) => Math.floor((((k + part) / count) * frames) % frames));
  const found = [];
  // What was found once is kept: without comes first.
  for (const flowing of [false, true]) {
    await player.run((element, on) => {
      const { scans } = element.testing.core.session;
      scans.flow = on ? Object.getPrototypeOf(scans).flow : async () => {};
    }, flowing);
    await player.run((element, at) => element.seek(at), from);
    await player.until('the scan', (element) => element.testing.shown() === 'scan');
    const whole = await detail(player);
    await player.run((element, at) => {
      element.goTo(at);
      element.pause();
    }, to);
    if (!(await inside(player, flowing)) || !(await until(player, `(element) => element.state.transition?.lambda >= ${MIDDLE}`, 10))) break;
    await player.frames(3);
    const state = await player.run((element) => ({ ...element.state.transition, shown: element.state.shown }));
    found.push((await detail(player)) / whole);
    await player.run((element) => element.testing.keepDrawing());
    writeFileSync(`${out}/flow-${k}-${flowing ? 'with' : 'without'}.png`, await player.part('.stage canvas').screenshot());
    await player.run((element) => element.testing.keepDrawing(false));
    console.log(flowing ? 'with flow' : 'without', from, to, JSON.stringify(state), found.at(-1).toFixed(3));
  }
}
await player.close();
await browser.close();
