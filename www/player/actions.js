/** What keys and chips do, by the names in `keyboard.js`. */

/**
 * @param {import('./core.js').Core} core
 * @param {import('./element.js').ReprisePlayer} host
 */
export function actionsOf(core, host) {
  const { view } = core;
  const cursor = () => {
    const { frame, target } = core.director.state;
    return view.preview.frame >= 0 ? view.preview.frame : (target ?? Math.round(frame));
  };
  const look = (frame) => core.look(frame, null, true);
  const ready = (work) => (event) => core.director?.info && core.guard(() => work(core.director.timeline, event));
  return {
    step: ready((timeline, { key, shiftKey }) => {
      const by = (key === 'ArrowLeft' ? -1 : 1) * (shiftKey ? Math.round(timeline.fps / 2) : 1);
      look(timeline.step(cursor(), by));
    }),
    across: ready((timeline, { key }) => look(timeline.across(cursor(), key === 'ArrowUp' ? -1 : 1))),
    ends: ready((timeline, { key }) => {
      const { first, count } = timeline.sequenceOf(cursor());
      look(key === 'Home' ? first : first + count - 1);
    }),
    go: ready((_, { shiftKey }) => {
      if (view.preview.frame < 0) return;
      core.toolbox.take(view.preview.frame, shiftKey);
      core.look(-1);
    }),
    toggle: ready(() => (host.playing ? host.pause() : host.play())),
    cancel: () => {
      if (view.preview.frame >= 0) core.look(-1);
      else if (core.director?.info && core.director.state.target !== null) host.cancel();
      else view.toggleFacts(false);
    },
    facts: () => view.toggleFacts() || core.loop?.request(),
    tint: () => (host.tint = !host.tint),
    parts: () => core.view.parts.all.length > 0 && (host.parts = !host.parts),
    compare: () => core.view.looks.toggle(),
    poses: () => core.togglePoses(),
    loop: () => (host.loop = !host.loop),
    drawer: () => view.toggleDrawer(),
  };
}
