/** Loads what is not in the first script, once for all players of a page: the WebAssembly modules, and the tools. */

import { PlayerError } from './errors.js';

/** A failure is forgotten, so that a second try fetches again. */
function once(load, message) {
  let loading = null;
  return () => {
    loading ??= load().catch((cause) => {
      loading = null;
      throw new PlayerError('engine', message, { cause });
    });
    return loading;
  };
}

/** The module that wasm-bindgen wrote: `Player` and `create_stage`. */
export const loadEngine = once(async () => {
  const engine = await import('../pkg/web.js');
  await engine.default({ module_or_path: new URL('../pkg/web_bg.wasm', import.meta.url) });
  return engine;
}, 'The player’s WebAssembly module could not be loaded.');

/** The module that searches: `Searcher` and `check_request`. It has a memory of its own. */
export const loadSearch = once(async () => {
  const search = await import('../pkg/searcher.js');
  await search.default({ module_or_path: new URL('../pkg/searcher_bg.wasm', import.meta.url) });
  return search;
}, 'The WebAssembly module that searches could not be loaded.');

/** The module that edits: `Editor` and `check_edits`. It has a memory of its own, too. */
export const loadEditor = once(async () => {
  const editor = await import('../pkg/editor.js');
  await editor.default({ module_or_path: new URL('../pkg/editor_bg.wasm', import.meta.url) });
  return editor;
}, 'The WebAssembly module that edits could not be loaded.');

/** The module that drives by motion capture: `Driver`. */
export const loadDriver = once(async () => {
  const driver = await import('../pkg/driver.js');
  await driver.default({ module_or_path: new URL('../pkg/driver_bg.wasm', import.meta.url) });
  return driver;
}, 'The WebAssembly module of motion capture could not be loaded.');

/** The module that reads frames as they were scanned: `Scan`. */
export const loadScanner = once(async () => {
  const scanner = await import('../pkg/scanner.js');
  await scanner.default({ module_or_path: new URL('../pkg/scanner_bg.wasm', import.meta.url) });
  return scanner;
}, 'The WebAssembly module of scanned frames could not be loaded.');

/** The module `tools/tools.js`, a script of its own once it is built. */
export const loadTools = once(async () => {
  const tools = await import('./tools/tools.js');
  return tools;
}, 'The script of the tools could not be loaded.');
