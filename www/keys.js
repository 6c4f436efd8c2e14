/**
 * The page on which key poses are picked for `builder transfer` (docs/transfer.md): which pose of the source means the same as which of the
 * target. It writes and reads `keys.toml`, and shows what the command made of it.
 */

import './reprise-player.js';
import { Page } from './keys/page.js';

const page = new Page(document);
const asked = new URLSearchParams(location.search);
page.open({ from: asked.get('from'), to: asked.get('to'), keys: asked.get('keys'), transfer: asked.get('transfer'), result: asked.get('result') });
