/** Between the world, the picture and a frame as it was recorded: where a point goes that is dragged. Points are x, y, z. */

/** @typedef {{frame: number, heading: number, x: number, z: number}} Standing a recorded frame, and where it stands */

/** A point of the recorded frame in the world. @param {Standing} standing */
export function toWorld({ heading, x, z }, [px, py, pz]) {
  const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
  return [cos * px + sin * pz + x, py, cos * pz - sin * px + z];
}

/** A point of the world in the recorded frame. @param {Standing} standing */
export function toRecorded({ heading, x, z }, [wx, wy, wz]) {
  const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
  return [cos * (wx - x) - sin * (wz - z), wy, sin * (wx - x) + cos * (wz - z)];
}

/** The axes of the picture in the world: to the right, and up. @param {ArrayLike<number>} camera yaw and elevation */
function axes([yaw, elevation]) {
  const [sin, cos] = [Math.sin(yaw), Math.cos(yaw)];
  return [[cos, 0, -sin], [-sin * Math.sin(elevation), Math.cos(elevation), -cos * Math.sin(elevation)]];
}

const along = (point, axis, far) => point.map((at, k) => at + axis[k] * far);

/**
 * The point that is seen at `at`, in the plane of the view through `from`; or straight above or below it, as far as that goes. By
 * Newton's method with differences, as `StageView.under`.
 * @param {import('../stage-view.js').StageView} view
 * @param {number[]} from in the world
 * @param {{x: number, y: number}} at CSS pixels
 */
export function dragged(view, from, at, straightUp) {
  if (!view.stage) return from;
  const seen = ([x, y, z]) => view.seen(x, z, y);
  const [right, up] = straightUp ? [[0, 0, 0], [0, 1, 0]] : axes(view.stage.camera());
  let point = from;
  for (let round = 0; round < 8; round += 1) {
    const [here, aside, above] = [seen(point), seen(along(point, right, 0.01)), seen(along(point, up, 0.01))];
    const [a, b, c, d] = [aside.x - here.x, above.x - here.x, aside.y - here.y, above.y - here.y].map((by) => by / 0.01);
    const [dx, dy] = [at.x - here.x, at.y - here.y];
    if (straightUp) {
      if (Math.abs(d) < 1) return from;
      point = along(point, up, dy / d);
      continue;
    }
    const det = a * d - b * c;
    if (Math.abs(det) < 1) return from;
    point = along(along(point, right, (d * dx - b * dy) / det), up, (a * dy - c * dx) / det);
  }
  return point.every(Number.isFinite) ? point : from;
}
