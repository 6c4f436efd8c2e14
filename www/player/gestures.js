/** Turns pointers on the stage into camera moves and clicks. Knows nothing of the stage itself. */

/** CSS pixels that a pointer may tremble and still click. */
const TREMBLE = 6;

/**
 * @typedef {object} Camera
 * @property {(dx: number, dy: number) => void} orbit
 * @property {(dx: number, dy: number) => void} pan
 * @property {(factor: number) => void} zoom above 1 comes closer
 * @property {() => void} recentre
 * @property {(x: number, y: number) => void} click CSS pixels from the surface's corner
 * @property {(x: number, y: number) => void} hover
 * @property {() => void} leave
 * @property {(event: PointerEvent) => Grab | null} grab offers a press to the tool in use
 */

/**
 * A press that a tool has taken for itself. `drop` is called in place of `end` when a second finger makes it a camera move.
 * @typedef {{move: (event: PointerEvent) => void, end: () => void, drop?: () => void}} Grab
 */

/**
 * One finger or the left button orbits; two fingers, the right button or shift pan; pinch and wheel zoom. With alt the
 * left button orbits also where a tool would take it.
 * @param {HTMLElement} surface
 * @param {Camera} camera
 */
export function attachGestures(surface, camera) {
  const pointers = new Map();
  let travelled = 0;
  let grabbed = null;

  surface.addEventListener('pointerdown', (event) => {
    surface.setPointerCapture(event.pointerId);
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    if (pointers.size > 1) {
      travelled = Infinity;
      grabbed?.drop?.();
      grabbed = null;
    } else if (event.button === 0 && !event.shiftKey && !event.altKey) {
      grabbed = camera.grab(event);
    }
  });

  surface.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) {
      if (event.pointerType !== 'touch') camera.hover(event.offsetX, event.offsetY);
      return;
    }
    const before = spread(pointers);
    const [dx, dy] = [event.offsetX - last.x, event.offsetY - last.y];
    pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    travelled += Math.hypot(dx, dy);
    if (grabbed) {
      grabbed.move(event);
      return;
    }
    if (travelled < TREMBLE) return;
    camera.leave();
    if (pointers.size >= 2) {
      const after = spread(pointers);
      camera.pan(after.x - before.x, after.y - before.y);
      if (before.size > 0 && after.size > 0) camera.zoom(after.size / before.size);
    } else if (event.shiftKey || event.buttons & 6) {
      camera.pan(dx, dy);
    } else {
      camera.orbit(dx, dy);
    }
  });

  const release = (event) => {
    const held = pointers.delete(event.pointerId);
    if (grabbed && held) {
      if (event.type === 'pointerup') grabbed.end();
      else grabbed.drop?.();
      grabbed = null;
      return;
    }
    const left = event.type === 'pointerup' && event.button === 0;
    if (held && left && pointers.size === 0 && travelled < TREMBLE) camera.click(event.offsetX, event.offsetY);
  };
  surface.addEventListener('pointerup', release);
  surface.addEventListener('pointercancel', release);
  surface.addEventListener('pointerleave', () => camera.leave());

  surface.addEventListener('dblclick', () => camera.recentre());
  surface.addEventListener('contextmenu', (event) => event.preventDefault());
  surface.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
      // A pinch on a touchpad arrives as a wheel with ctrl, in much smaller steps.
      const step = event.deltaY * lines * (event.ctrlKey ? 5 : 1);
      camera.zoom(Math.exp(-Math.max(-240, Math.min(240, step)) / 600));
    },
    { passive: false },
  );
}

/** Centre and mean distance of the fingers that are down. */
function spread(pointers) {
  const all = [...pointers.values()];
  const x = all.reduce((sum, one) => sum + one.x, 0) / all.length;
  const y = all.reduce((sum, one) => sum + one.y, 0) / all.length;
  const size = all.reduce((sum, one) => sum + Math.hypot(one.x - x, one.y - y), 0) / all.length;
  return { x, y, size };
}
