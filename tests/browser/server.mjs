/** A static server as strict as a careful site: right media types, a content security policy, and faults on request. */

import { createServer } from 'node:http';
import { readFile, stat } from 'node:fs/promises';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

const TYPES = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.json': 'application/json',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
  '.reprise': 'application/octet-stream',
};

/** Modules that are not the page's: what the tests look inside with, and other people's, from the tests' own dependencies. */
const here = dirname(fileURLToPath(import.meta.url));
const MODULES = {
  '/testing.js': 'testing.js',
  '/examples/vendor/preact.js': 'node_modules/preact/dist/preact.mjs',
  '/vendor/axe.js': 'node_modules/axe-core/axe.min.js',
};

const POLICY =
  "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'";

/** What a page may do beyond that: where files of the reader's own are opened, their bytes come from blobs. */
const ALLOWED = { '/keys.html': "; connect-src 'self' blob:" };

/** Folders that other programs made for the tests, by their place on the server. */
const MADE = { native: process.env.REPRISE_NATIVE, dressed: process.env.REPRISE_DRESSED, frameworks: process.env.REPRISE_FRAMEWORKS };

/** Bundles that went wrong on their way, made from the good one. */
const FAULTS = {
  '/faults/damaged.reprise': (bundle) => {
    const bytes = Buffer.from(bundle);
    for (let at = Math.floor(bytes.length * 0.6); at < bytes.length * 0.6 + 64; at += 1) bytes[at] ^= 0x5a;
    return bytes;
  },
  '/faults/damaged-early.reprise': (bundle) => {
    const bytes = Buffer.from(bundle);
    for (let at = 40; at < 72; at += 1) bytes[at] ^= 0x5a;
    return bytes;
  },
  '/faults/truncated.reprise': (bundle) => bundle.subarray(0, Math.floor(bundle.length * 0.6)),
  '/faults/truncated-early.reprise': (bundle) => bundle.subarray(0, 64),
  // The major version stands right behind the eight bytes that say what the file is.
  '/faults/too-new.reprise': (bundle) => {
    const bytes = Buffer.from(bundle);
    bytes.writeUInt16LE(99, 8);
    return bytes;
  },
  '/faults/not-reprise.reprise': () => Buffer.from('This is a letter, not an actor.\n'.repeat(40)),
};

/**
 * @param {string} root the folder to serve
 * @param {string} bundlePath served as `/demo.reprise`
 * @returns {Promise<{address: string, close: () => void}>}
 */
export async function serve(root, bundlePath) {
  const bundle = await readFile(bundlePath);
  const server = createServer((request, response) => {
    answer(root, bundle, request, response).catch(() => response.destroy());
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { address: `http://localhost:${server.address().port}/`, close: () => server.closeAllConnections() ?? server.close() };
}

async function answer(root, bundle, request, response) {
  const { pathname } = new URL(request.url, 'http://localhost');
  response.setHeader('content-security-policy', POLICY + (ALLOWED[pathname] ?? ''));
  if (pathname === '/demo.reprise') return send(response, bundle, '.reprise');
  if (pathname === '/slow.reprise') return trickle(response, bundle);
  if (pathname === '/half.reprise') return held(response, bundle, 0.6);
  if (pathname === '/held.reprise') return held(response, bundle, 0.0001);
  if (pathname === '/rest') return send(response, (goOn?.(), ''), '.json');
  if (pathname === '/faults/broken-off.reprise') return held(response, bundle, 0.1, true);
  if (pathname in FAULTS) return send(response, FAULTS[pathname](bundle), '.reprise');
  if (Object.hasOwn(MODULES, pathname)) return send(response, await readFile(join(here, MODULES[pathname])), '.js');
  const made = Object.entries(MADE).find(([name, folder]) => folder && pathname.startsWith(`/${name}/`));
  const [folder, path] = made ? [made[1], pathname.slice(made[0].length + 1)] : [root, pathname];
  const file = join(folder, normalize(path === '/' ? '/index.html' : decodeURIComponent(path)));
  const found = file.startsWith(folder) && (await stat(file).catch(() => null))?.isFile();
  if (found) return send(response, await readFile(file), extname(file));
  response.writeHead(404, { 'content-type': 'text/plain' });
  response.end('Not found');
}

function send(response, bytes, extension) {
  response.writeHead(200, { 'content-type': TYPES[extension] ?? 'application/octet-stream', 'content-length': bytes.length });
  response.end(bytes);
}

/** Milliseconds between the pieces of a slow download. */
const PAUSE = 100;

let goOn = null;

/** A share of it, and the rest when somebody asks for `/rest`; or no rest, for the line goes dead then. */
async function held(response, bundle, share, breaks = false) {
  response.writeHead(200, { 'content-type': TYPES['.reprise'], 'content-length': bundle.length });
  const middle = Math.ceil(bundle.length * share);
  response.write(bundle.subarray(0, middle));
  await new Promise((resolve) => (goOn = resolve));
  if (breaks) response.destroy();
  else response.end(bundle.subarray(middle));
}

/** In twenty pieces with pauses. */
async function trickle(response, bundle) {
  response.writeHead(200, { 'content-type': TYPES['.reprise'], 'content-length': bundle.length });
  const piece = Math.ceil(bundle.length / 20);
  for (let at = 0; at < bundle.length; at += piece) {
    response.write(bundle.subarray(at, at + piece));
    await new Promise((resolve) => setTimeout(resolve, PAUSE));
  }
  response.end();
}
