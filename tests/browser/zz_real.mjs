import { readFile } from 'node:fs/promises';
import { Browser } from './browser.mjs';
const browser = await Browser.launch();
const player = await browser.open({ reducedMotion: 'reduce', viewport: { width: 500, height: 400 } });
await player.loaded();
for (const names of [['02_01_60fps.bvh'], ['02.asf', '02_06.amc'], ['cmu1_jumping_jacks.bvh']]) {
  const files = [];
  for (const name of names) files.push([name, await readFile('/work/shared/data/mocap/' + name, 'utf8')]);
  const told = await player.run(async (element, list) => {
    window.heard.length = 0;
    const drives = element.testing.core.toolbox.kit?.drives;
    if (drives) drives.slices = { frames: 0, longest: 0 };
    const begin = performance.now();
    let longest = 0; let last = begin; let on = true;
    const watch = () => { const now = performance.now(); longest = Math.max(longest, now - last); last = now; if (on) setTimeout(watch, 0); };
    watch();
    const told = await element.drive(list.map(([name, text]) => new File([text], name)));
    const started = performance.now() - begin; const longestBefore = longest; longest = 0;
    const frames0 = element.testing.core.toolbox.kit.drives.slices.frames;
    const t0 = performance.now();
    while (element.testing.core.toolbox.kit.drives.slices.frames < Math.min(150, told.frames - 30)) { element.testing.tick(0.02); await new Promise((r) => setTimeout(r, 5)); }
    const per = (performance.now() - t0) / (element.testing.core.toolbox.kit.drives.slices.frames - frames0);
    on = false;
    return { told, started, longestBefore, longest, per, slices: element.testing.core.toolbox.kit.drives.slices, ms: element.state.synthesis_ms };
  }, files);
  console.log(JSON.stringify(told));
  await player.page.screenshot({ path: '/tmp/real-' + names[0] + '.png' });
  await player.run((element) => { element.seek(10); element.play(); });
}
await browser.close();
