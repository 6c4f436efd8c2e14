/**
 * What editing takes in the page's WebAssembly, in milliseconds: getting ready, grabbing a hand and the head in frames all over the
 * capture, dragging each in 40 steps with the whole body following, coming to rest after it (a step, and all of them), and making a frame around an edit. And how far off, in
 * millimetres, handles and pins are at most, and the part of the drags in which the body does not reach. By `method`, "rig" or
 * "learned", which is in the figures' names where it is not the rig.
 */
export async function dragging(element, method = 'rig') {
  const { player } = element.testing;
  const { Editor } = await element.testing.editing();
  const timed = (work) => {
    const start = performance.now();
    return [work(), performance.now() - start];
  };
  const [editor, opened] = timed(() => new Editor(player.editable(), player.rig(), player.learned()));
  const give = () => editor.needs().forEach((frame) => editor.give(frame, player.recorded_pose(frame)));
  const [, given] = timed(give);
  const times = { grab: [], drag: [], step: [], rest: [], frame: [] };
  let [handle, pin, short] = [0, 0, 0];
  const at = (pose, vertex) => Array.from(pose.slice(3 * vertex, 3 * vertex + 3));
  const apart = (a, b) => 1000 * Math.hypot(...a.map((place, axis) => place - b[axis]));
  for (const { name, first, count } of element.info.sequences) {
    const frame = Math.floor(count / 2);
    const recorded = player.recorded_pose(first + frame);
    const vertices = Array.from({ length: recorded.length / 3 }, (_, vertex) => vertex);
    const most = (axis) => vertices.reduce((best, vertex) => (recorded[3 * vertex + axis] > recorded[3 * best + axis] ? vertex : best));
    for (const [vertex, by] of [[most(0), [0.15, 0.35, 0.1]], [most(1), [0.1, -0.2, 0.1]]]) {
      const from = at(recorded, vertex);
      const text = (to) => JSON.stringify({ version: 1, edits: [{ sequence: name, frame, handles: [{ vertex, to }], method }] });
      editor.replace(text(from));
      give();
      times.grab.push(timed(() => editor.grab(0))[1]);
      const soles = Array.from(editor.stands(first + frame)).flatMap((stands, foot) => (stands ? Array.from(editor.sole(foot)) : []));
      if (apart(Array.from(editor.drag(Float32Array.from(from))), Array.from(recorded)) !== 0) handle = Infinity;
      for (let step = 1; step <= 40; step += 1) {
        const to = from.map((place, axis) => place + (by[axis] * step) / 40);
        const [pose, taken] = timed(() => editor.drag(Float32Array.from(to)));
        times.drag.push(taken);
        // Where the body does not reach, a note says so.
        const isShort = editor.notes().length > 0;
        short += Number(isShort);
        if (!isShort) handle = Math.max(handle, apart(at(pose, vertex), to));
        for (const sole of soles) pin = Math.max(pin, apart(at(pose, sole), at(recorded, sole)));
      }
      editor.replace(text(from.map((place, axis) => place + by[axis])));
      const before = times.step.length;
      for (let [done, taken] = [false, 0]; !done; times.step.push(taken)) [done, taken] = timed(() => editor.settle(0));
      times.rest.push(times.step.slice(before).reduce((sum, taken) => sum + taken, 0));
      for (const other of Array.from(editor.reached(0)).slice(0, 8)) times.frame.push(timed(() => editor.make(other, player.recorded_pose(other)))[1]);
    }
  }
  editor.free();
  const share = (list, part) => [...list].sort((a, b) => a - b)[Math.floor((list.length - 1) * part)];
  const figures = {
    edit_ready: opened + given,
    edit_grab: share(times.grab, 0.95),
    edit_drag: share(times.drag, 0.5),
    edit_drag_95: share(times.drag, 0.95),
    edit_drag_worst: share(times.drag, 1),
    edit_step_worst: share(times.step, 1),
    edit_rest_worst: share(times.rest, 1),
    edit_frame: share(times.frame, 0.5),
    edit_frame_worst: share(times.frame, 1),
    edit_handle_off: handle,
    edit_pin_off: pin,
    edit_short: short / times.drag.length,
  };
  const named = (name) => (method === 'rig' ? name : name.replace('edit', `edit_${method}`));
  return Object.fromEntries(Object.entries(figures).map(([name, value]) => [named(name), value]));
}
