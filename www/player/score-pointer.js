/** Pointers on the score: hovering previews, letting go goes there, dragging the playhead scrubs. */

/**
 * @param {HTMLElement} sheet what the strips lie on
 * @param {HTMLElement} handle the playhead's grip
 * @param {() => import('./layout.js').ScoreLayout | null} layout
 * @param {object} act
 * @param {(frame: number) => void} act.preview -1 when there is none
 * @param {(frame: number, later: boolean) => void} act.go later: with shift, after what is under way
 * @param {(frame: number) => void} act.seek with fractions
 */
export function attachScorePointer(sheet, handle, layout, act) {
  let pressed = -1;
  let scrubbed = -1;

  const place = (event) => {
    const box = sheet.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const frameAt = (event) => {
    const { x, y } = place(event);
    return layout()?.frameAt(x, y) ?? -1;
  };

  sheet.addEventListener('pointermove', (event) => {
    if (scrubbed < 0) act.preview(frameAt(event));
  });
  sheet.addEventListener('pointerleave', () => act.preview(-1));
  sheet.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || scrubbed >= 0) return;
    pressed = event.pointerId;
    act.preview(frameAt(event));
  });
  sheet.addEventListener('pointerup', (event) => {
    if (event.pointerId !== pressed) return;
    pressed = -1;
    const frame = frameAt(event);
    if (event.pointerType === 'touch') act.preview(-1);
    if (frame >= 0) act.go(frame, event.shiftKey);
  });
  // The browser takes a finger over for scrolling: then nothing was meant.
  sheet.addEventListener('pointercancel', () => {
    pressed = -1;
    act.preview(-1);
  });

  handle.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !layout()) return;
    event.stopPropagation();
    event.preventDefault();
    handle.setPointerCapture(event.pointerId);
    const { x, y } = place(event);
    scrubbed = layout().timeline.indexOf(layout().frameAt(x, y + 12));
    act.preview(-1);
  });
  handle.addEventListener('pointermove', (event) => {
    if (scrubbed < 0 || !layout()) return;
    event.stopPropagation();
    const { first, count } = layout().timeline.sequences[scrubbed];
    const exact = ((place(event).x - layout().strips[scrubbed].x) * layout().timeline.fps) / layout().scale - 0.5;
    act.seek(first + Math.min(count - 1, Math.max(0, exact)));
  });
  const end = (event) => {
    if (scrubbed >= 0) event.stopPropagation();
    scrubbed = -1;
  };
  handle.addEventListener('pointerup', end);
  handle.addEventListener('pointercancel', end);
}
