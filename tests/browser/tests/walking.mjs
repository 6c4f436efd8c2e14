/** Sending the actor somewhere: with the mouse, the keys and a ghost; on the way; with a lost device. */

import assert from 'node:assert/strict';

/** Metres between a pose as drawn and the recorded one in its place. */
const NEAR = 1e-3;

/** Runs in the page: the largest distance between the pose drawn and a recorded frame under a placement. */
function distanceToRecorded(element, { frame, placement: [heading, x, z] }) {
  const drawn = element.testing.pose();
  const recorded = element.testing.recordedPose(frame);
  const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
  let farthest = 0;
  for (let at = 0; at < recorded.length; at += 3) {
    const [px, py, pz] = recorded.slice(at, at + 3);
    const placed = [cos * px + sin * pz + x, py, cos * pz - sin * px + z];
    farthest = Math.max(farthest, Math.hypot(drawn[at] - placed[0], drawn[at + 1] - placed[1], drawn[at + 2] - placed[2]));
  }
  return recorded.length === drawn.length ? farthest : Infinity;
}

/** Loads, stops, and stands in the middle of the first sequence, where every walk begins the same. */
async function standing(browser, options) {
  const player = await browser.open(options);
  await player.loaded();
  await player.run((element) => {
    element.pause();
    element.seek(element.info.sequences[0].first + Math.floor(element.info.sequences[0].count / 3));
  });
  return player;
}

/** Waits until the page searches for nothing by itself any more: what it suggests is planned when there is time. */
async function searched(player) {
  for (let before = -1, now = 0; before !== now; ) {
    before = now;
    await new Promise((resolve) => setTimeout(resolve, 300));
    ({ now } = await player.run((element) => element.testing.plans()));
  }
}

export const tests = {
  'a click on a strip takes the actor to that pose': async (browser) => {
    const player = await standing(browser);
    const target = await player.click(await player.target());
    assert.notEqual(target, null);
    const walk = await player.run((element) => element.state.walk);
    assert.ok(walk.some(({ kind }) => kind === 'synthetic'));
    assert.match(await player.part('.status').textContent(), /^goes there in \d+\.\d s, through \d+ transitions?$/);
    assert.equal(await player.part('.flag svg').isVisible(), true);
    const placement = await player.run((element, frame) => element.testing.arrival(frame), target);
    await player.event('arrive');
    const [arrival] = await player.heard('arrive');
    assert.equal(arrival.frame, target);
    const distance = await player.run(distanceToRecorded, { frame: target, placement });
    assert.ok(distance < NEAR, `${distance} m away from the recorded pose`);
    assert.equal(await player.run((element) => element.state.target), null);
    assert.match(await player.part('.status').textContent(), /^arrived/);
    assert.notEqual(await player.part('.flag').getAttribute('data-arrived'), null);
    const [starts, ends] = [await player.heard('transitionstart'), await player.heard('transitionend')];
    assert.equal(starts.length, walk.filter(({ kind }) => kind === 'synthetic').length);
    assert.deepEqual(starts.map(({ from, to }) => [from, to]), ends.map(({ from, to }) => [from, to]));
    const picture = await player.run((element) => element.testing.picture());
    assert.ok(picture.drawn > 0.01);
    await player.picture('test-arrived');
    await player.close();
  },

  'another click on the way changes its mind without a pop': async (browser) => {
    const player = await standing(browser);
    const first = await player.target();
    const second = await player.target(first);
    // In the very event: a machine that draws slowly could be past the transition when it is asked from here.
    await player.run((element, frame) => {
      window.moved = new Promise((resolve) => {
        const change = () => {
          const before = element.testing.pose();
          element.goTo(frame);
          const after = element.testing.pose();
          resolve(Math.max(...before.map((value, at) => Math.abs(value - after[at]))));
        };
        element.addEventListener('transitionstart', change, { once: true });
      });
    }, second);
    await player.click(first);
    const moved = await player.run(() => window.moved);
    assert.equal(moved, 0, 'the body moved at the very moment of the change');
    assert.equal(await player.run((element) => element.state.target), second);

    // From here to the arrival in steps of half a frame, without the display: no step is larger than the capture's own.
    const { largest, usual } = await player.run((element) => {
      const { player: inner } = element.testing;
      const { fps, sequences } = element.info;
      const step = (a, b) => {
        let farthest = 0;
        for (let at = 0; at < a.length; at += 3) farthest = Math.max(farthest, Math.hypot(a[at] - b[at], a[at + 1] - b[at + 1], a[at + 2] - b[at + 2]));
        return farthest;
      };
      let fastest = 0;
      for (const { first: start, count } of sequences) {
        for (let frame = start + 1; frame < start + count; frame += 1) {
          fastest = Math.max(fastest, step(inner.recorded_pose(frame - 1), inner.recorded_pose(frame)));
        }
      }
      let most = 0;
      let last = inner.pose();
      for (let tick = 0; tick < 4000 && JSON.parse(inner.state()).target !== null; tick += 1) {
        inner.tick(0.5 / fps);
        const pose = inner.pose();
        most = Math.max(most, step(last, pose));
        last = pose;
      }
      return { largest: most * 2, usual: fastest };
    });
    assert.ok(largest > 0);
    assert.ok(largest < usual * 1.5, `a step of ${largest} m a frame; the capture's fastest is ${usual}`);
    await player.event('arrive');
    assert.equal((await player.heard('arrive')).at(-1).frame, second);
    await player.close();
  },

  'the keyboard reaches a pose': async (browser) => {
    const player = await standing(browser);
    await player.keyboard.press('ArrowDown');
    await player.keyboard.press('ArrowRight');
    await player.keyboard.press('Shift+ArrowRight');
    const { fps, sequences: [here, there] } = await player.run((element) => element.info);
    const value = Math.min(there.count - 1, Math.min(there.count - 1, Math.floor(here.count / 3)) + 1 + Math.round(fps / 2));
    await player.until('the cursor', (element, wanted) => element.shadowRoot.activeElement?.getAttribute('aria-valuenow') === String(wanted), value);
    const { label, text } = await player.run((element) => {
      const strip = element.shadowRoot.activeElement;
      return { label: strip.getAttribute('aria-label'), text: strip.getAttribute('aria-valuetext') };
    });
    assert.equal(label, there.name.replaceAll('_', ' '));
    assert.match(text, /goes there in|cannot be reached/);
    await player.keyboard.press('Enter');
    const target = await player.run((element) => element.state.target);
    assert.equal(target, there.first + value);
    assert.equal(await player.run((element) => element.playing), true);
    await player.event('arrive');
    await player.keyboard.press('Escape');
    await player.keyboard.press('Space');
    assert.equal(await player.run((element) => element.playing), true);
    await player.keyboard.press('Space');
    assert.equal(await player.run((element) => element.playing), false);
    await player.close();
  },

  'escape stops on the way': async (browser) => {
    const player = await standing(browser);
    await player.run((element, frame) => element.goTo(frame), await player.target());
    await player.mouse.move(5, 5);
    await player.keyboard.press('Escape');
    assert.equal(await player.run((element) => element.state.target), null);
    assert.equal(await player.part('.flag svg').isVisible(), false);
    await player.close();
  },

  'the keys are listed on demand': async (browser) => {
    const player = await standing(browser);
    await player.keyboard.press('?');
    assert.equal(await player.part('.keys').isVisible(), true);
    await player.keyboard.press('Escape');
    assert.equal(await player.part('.keys').isVisible(), false);
    await player.close();
  },

  'hovering a strip shows the pose on the stage and what going there means': async (browser) => {
    const player = await standing(browser);
    const frame = await player.target();
    const { x, y } = await player.run((element, wanted) => element.testing.placeOf(wanted), frame);
    await searched(player);
    await player.mouse.move(x, y);
    await player.until('the ghost', (element) => element.testing.ghosts().length === 1);
    const [ghost] = await player.run((element) => element.testing.ghosts());
    assert.ok(Math.abs(ghost - frame) <= 1, `${ghost} is not ${frame}`);
    assert.match(await player.part('.tooltip').textContent(), /\d+\.\d\d s.*goes there in \d+\.\d s/);
    assert.equal(await player.run((element) => element.state.target), null);
    // Ghost, sentence, marks and click are one search.
    const plans = await player.run((element) => element.testing.plans());
    assert.ok(plans.now - plans.before <= 1, `${plans.now - plans.before} searches for one look`);
    // Going there is none: what the page looks for by itself afterwards does not count.
    const own = await player.run((element, there) => {
      const before = element.testing.plans().now;
      element.goTo(there);
      return element.testing.plans().now - before;
    }, ghost);
    assert.equal(own, 0, 'what was looked at is searched for once more');
    await player.run((element) => element.cancel());
    await player.mouse.click(x, y);
    await player.until('a target', (element) => element.state.target !== null);
    await player.run((element) => element.cancel());
    await player.mouse.move(400, 100);
    await player.until('the ghost is gone', (element) => element.testing.ghosts().length === 0);
    assert.equal(await player.part('.tooltip').isVisible(), false);
    await player.close();
  },

  'a click on a ghost on the stage goes there': async (browser) => {
    const player = await standing(browser);
    await player.part('.chip', { hasText: 'poses' }).filter({ hasText: 'poses' }).click();
    await player.until('poses around the actor', (element) => element.testing.ghosts().length > 0);
    await player.until('rest', (element) => element.testing.rests());
    const places = await player.run((element) => element.testing.ghosts().map((frame) => element.testing.placeOfGhost(frame)));
    let hit = -1;
    for (const { x, y, visible } of places) {
      if (!visible || hit >= 0) continue;
      await player.mouse.move(x, y);
      hit = await player.run((element) => (element.shadowRoot.querySelector('.view').hasAttribute('data-over-ghost') ? 1 : -1));
      if (hit >= 0) await player.mouse.click(x, y);
    }
    assert.ok(hit >= 0, `no ghost was found under the pointer: ${JSON.stringify(places)}`);
    const target = await player.run((element) => element.state.target);
    assert.notEqual(target, null);
    await player.event('arrive');
    assert.equal((await player.heard('arrive'))[0].frame, target);
    await player.close();
  },

  'the pointer turns, moves and zooms the camera': async (browser) => {
    const player = await standing(browser);
    const picture = async () => {
      await player.until('the camera at rest', (element) => !element.testing.stage.camera_moving());
      return player.run((element) => {
        const [x, y] = element.testing.stage.project(1, 0, 1);
        return [x, y];
      });
    };
    const stages = [await picture()];
    const drag = async (key) => {
      if (key) await player.keyboard.down(key);
      await player.mouse.move(300, 200);
      await player.mouse.down();
      await player.mouse.move(360, 230, { steps: 4 });
      await player.mouse.up();
      if (key) await player.keyboard.up(key);
      stages.push(await picture());
    };
    await drag();
    await drag('Shift');
    await player.run(() => addEventListener('wheel', () => (window.wheeled = true), { once: true }));
    await player.mouse.wheel(0, -200);
    await player.until('the wheel', () => window.wheeled);
    stages.push(await picture());
    stages.slice(1).forEach((one, at) => assert.ok(Math.hypot(one[0] - stages[at][0], one[1] - stages[at][1]) > 2, `move ${at} did nothing`));
    await player.close();
  },

  'a lost device comes back with pose and target': async (browser) => {
    const player = await standing(browser, { forgive: [/Device was destroyed/] });
    await player.run((element) => element.addEventListener('transitionstart', () => element.pause(), { once: true }));
    const target = await player.click(await player.target());
    await player.until('a pause in a transition', (element) => element.state.mode === 'paused' && element.state.transition);
    const before = await player.run((element) => {
      element.testing.loseDevice();
      return { pose: element.testing.pose(), state: element.state };
    });
    await player.event('devicerestored');
    const after = await player.run((element) => ({ pose: element.testing.pose(), state: element.state }));
    assert.deepEqual(after.pose, before.pose);
    assert.equal(after.state.target, target);
    assert.equal((await player.heard('devicelost')).length, 1);
    const picture = await player.run((element) => element.testing.picture());
    assert.ok(picture.drawn > 0.01, 'the stage is blank after the loss');
    await player.run((element) => element.play());
    await player.event('arrive');
    assert.equal((await player.heard('arrive'))[0].frame, target);
    await player.close();
  },
};
