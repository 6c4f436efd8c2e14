/** The page around the player: which actor, its name at the top, the direction in the address, and the whole page's keys. */

import './reprise-player.js';

const player = document.querySelector('reprise-player');
const wanted = new URLSearchParams(location.search).get('src');

player.addEventListener('ready', () => {
  document.querySelector('#actor').textContent = player.info.name;
  document.title = `${player.info.name} · Reprise`;
});

// A direction refers to behaviours and frames, which are known once all has arrived.
player.addEventListener('load', () => player.openLink(location.href));
addEventListener('hashchange', () => player.complete && player.openLink(location.href));

// An address that somebody passed on may have grown stale: the way out is the demo.
player.addEventListener('error', () => {
  document.querySelector('#demo').hidden = wanted === null;
});

// Here the player is all there is, so keys need not be aimed at it.
document.addEventListener('keydown', (event) => {
  if (event.target === document.body) player.pressKey(event);
});

player.src = wanted ?? 'demo.reprise';
