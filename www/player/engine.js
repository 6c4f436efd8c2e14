/** Loads the WebAssembly module once for all players of a page. */

import { PlayerError } from './errors.js';

let loading = null;

/**
 * The module that wasm-bindgen wrote: `Player` and `create_stage`.
 * A failure is forgotten, so that a second try fetches again.
 */
export function loadEngine() {
  loading ??= load().catch((cause) => {
    loading = null;
    throw new PlayerError('engine', 'The player’s WebAssembly module could not be loaded.', { cause });
  });
  return loading;
}

async function load() {
  const engine = await import('../pkg/web.js');
  await engine.default({ module_or_path: new URL('../pkg/web_bg.wasm', import.meta.url) });
  return engine;
}
