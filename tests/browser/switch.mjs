/**
 * How much a picture changes where a scanned frame gives way: to itself as a transition carries it, to the mesh that all frames were brought
 * onto, at once, and to that in the steps in which the page does it at 60 pictures a second: `REPRISE_BUNDLE=windows.reprise node switch.mjs [frames]`. Recorded frames, spread over the capture, are drawn both ways from two
 * views; pictures of the first ones go to out/.
 */

import { writeFileSync } from 'node:fs';
import { Browser, out } from './browser.mjs';

const VIEWS = { front: '0deg 8deg 1', 'three quarters': '55deg 15deg 0.8' };
const PICTURES = 3;

const count = Number(process.argv[2] ?? 12);
const browser = await Browser.launch();
const player = await browser.open({ viewport: { width: 1280, height: 800 }, reducedMotion: 'reduce', colorScheme: 'light' });
await player.loaded();
await player.run((element) => element.pause());
const frames = await player.run((element) => element.info.frames);
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
const percent = (value) => `${(100 * value).toFixed(2)} %`;
for (const [view, camera] of Object.entries(VIEWS)) {
  const shares = [];
  for (let k = 0; k < count; k += 1) {
    const frame = Math.floor(((k + 0.5) * frames) / count);
    await player.run((element, [at, from]) => {
      element.camera = from;
      element.seek(at);
    }, [frame, camera]);
    await player.frames(3);
    const found = await player.run((element) => element.testing.switched());
    shares.push({ frame, picture: found.changed / found.pixels, actor: found.within / found.covered, outline: found.outline / found.covered, covered: found.covered / found.pixels, cut: found.cut / found.pixels, cutOfActor: found.ofCut / found.covered, step: found.step / found.pixels, ofActor: found.step / found.covered });
    if (k >= PICTURES) continue;
    for (const way of ['ours', 'template']) {
      await player.run((element, wanted) => element.testing.core.view.looks.choose(wanted), way);
      await player.frames(3);
      const stage = player.part('.stage canvas');
      await player.run((element) => element.testing.keepDrawing());
      writeFileSync(`${out}/switch-${view.replace(' ', '-')}-${frame}-${way === 'ours' ? 'scan' : 'template'}.png`, await stage.screenshot());
      await player.run((element) => element.testing.keepDrawing(false));
    }
  }
  const both = (name) => `${percent(mean(shares.map((one) => one[name])))} on average, ${percent(Math.max(...shares.map((one) => one[name])))} at most`;
  console.log(`${view}, at once: of the picture ${both('picture')}; of the actor, which is ${percent(mean(shares.map(({ covered }) => covered)))} of it, ${both('actor')}; ${percent(mean(shares.map(({ outline }) => outline)))} are at its outline`);
  console.log(`${view}, as a transition carries it: of the picture ${both('cut')}; of the actor ${both('cutOfActor')}`);
  console.log(`${view}, from one picture to the next of a switch as the page does it: of the picture ${both('step')}; of the actor ${both('ofActor')}`);
  for (const { frame, picture, actor, outline, step, cut } of shares) console.log(`  frame ${frame}: ${percent(picture)}, carried ${percent(cut)}, ${percent(actor)}, ${percent(outline)}, a step ${percent(step)}`);
}
await player.close();
await browser.close();
