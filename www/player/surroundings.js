/** What happens around the element: it is scrolled out of view, resized, moved to another screen, and the page's taste changes. */

/** Lazy players load when they are this near to being seen. */
const NEAR = '300px';

/**
 * @param {HTMLElement} host
 * @param {HTMLElement[]} boxes whose sizes matter
 * @param {object} on
 * @param {(visible: boolean) => void} on.visible
 * @param {() => void} on.near is about to be seen
 * @param {() => void} on.resized in CSS pixels or in density
 * @param {() => void} on.taste the reader's colour scheme or wish for calm has changed
 * @returns {() => void} stops watching
 */
export function watchSurroundings(host, boxes, on) {
  const document = host.ownerDocument;
  const window = document.defaultView;
  const stop = new AbortController();
  const { signal } = stop;
  let inView = true;
  const visibility = () => on.visible(inView && document.visibilityState === 'visible');
  const seen = new window.IntersectionObserver((entries) => {
    inView = entries[entries.length - 1].isIntersecting;
    visibility();
  });
  const near = new window.IntersectionObserver((entries) => entries.some((one) => one.isIntersecting) && on.near(), { rootMargin: NEAR });
  const sized = new window.ResizeObserver(on.resized);
  seen.observe(host);
  near.observe(host);
  boxes.forEach((box) => sized.observe(box));
  document.addEventListener('visibilitychange', visibility, { signal });
  watchDensity(window, on.resized, signal);
  for (const query of ['(prefers-color-scheme: dark)', '(prefers-reduced-motion: reduce)']) {
    window.matchMedia(query).addEventListener('change', on.taste, { signal });
  }
  visibility();
  return () => {
    stop.abort();
    [seen, near, sized].forEach((observer) => observer.disconnect());
  };
}

/** Another screen, another density: the size in CSS pixels stays, so no observer of sizes tells. */
function watchDensity(window, changed, signal) {
  const again = () => {
    changed();
    watchDensity(window, changed, signal);
  };
  window.matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`).addEventListener('change', again, { once: true, signal });
}
