/** Key poses at times. */

import assert from 'node:assert/strict';
import { using, asked, found } from './common.mjs';

export const tests = {
  'key poses are put on the ruler, moved, and reached': async (browser) => {
    const player = await using(browser, 'timing');
    const poses = player.part('.pose');
    await poses.nth(1).click();
    await found(player);
    await poses.nth(6).scrollIntoViewIfNeeded();
    const from = await poses.nth(6).boundingBox();
    const ruler = await player.part('.lane').boundingBox();
    await player.mouse.move(from.x + 18, from.y + 20);
    await player.mouse.down();
    await player.mouse.move(ruler.x + ruler.width * 0.6, ruler.y + 20, { steps: 5 });
    await player.mouse.up();
    const keys = async () => (await asked(player)).target.keys.poses;
    assert.equal((await keys()).length, 2);
    assert.ok(Math.abs((await keys())[1].time - 4.8) < 0.2, JSON.stringify(await keys()));
    await player.untilFound('both', (element) => element.answer?.keys.length === 2);
    const { keys: rows } = await player.run((element) => element.answer);
    assert.deepEqual(rows.map(({ wanted }) => wanted.toFixed(1)), (await keys()).map(({ time }) => time.toFixed(1)));
    await player.until('the table', (element) => element.shadowRoot.querySelectorAll('.times tbody tr').length === 2);
    const key = await player.part('.key-pose').first().boundingBox();
    await player.mouse.move(key.x + 18, key.y + 20);
    await player.mouse.down();
    await player.mouse.move(key.x + 18 + ruler.width / 8, key.y + 20, { steps: 4 });
    await player.mouse.up();
    assert.ok(Math.abs((await keys())[0].time - 3) < 0.2, JSON.stringify(await keys()));
    await player.part('.key-pose').first().dblclick();
    assert.equal((await keys()).length, 1);
    await player.part('.go').click();
    await player.run((element) => (element.speed = 4));
    await player.event('arrive');
    assert.equal((await player.heard('arrive'))[0].frame, (await keys())[0].pose);
    await player.close();
  },
};
