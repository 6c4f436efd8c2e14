/** A page of its own making: buttons that send the actor somewhere, and a picture of it. */

import '../reprise-player.js';

const player = document.querySelector('reprise-player');
const [elsewhere, save] = document.querySelectorAll('button');
const output = document.querySelector('output');

elsewhere.addEventListener('click', () => {
  const { sequences } = player.info;
  const { frame } = player.state;
  const other = sequences.find(({ first, count }) => frame < first || frame >= first + count);
  const { seconds } = player.goTo({ sequence: other.name, seconds: 1 });
  output.textContent = `there in ${seconds.toFixed(1)} s`;
});

save.addEventListener('click', async () => {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await player.toBlob());
  link.download = 'actor.png';
  link.click();
  URL.revokeObjectURL(link.href);
});

player.addEventListener('arrive', () => (output.textContent = 'arrived'));
player.addEventListener('error', ({ detail }) => (output.textContent = detail.message));
