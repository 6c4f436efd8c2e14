/** Two players: each has its own actor, clock and device; the WebAssembly module is fetched once. */

import '../reprise-player.js';

const players = [...document.querySelectorAll('reprise-player')];

document.querySelector('button').addEventListener('click', () => {
  for (const player of players) {
    const { name, count } = player.info.sequences[1];
    player.goTo({ sequence: name, seconds: count / player.info.fps / 2 });
  }
});
