/** One sequence of the score: its name, its film of thumbnails, and what a screen reader is told about it. */

import { h, sizedContext } from './dom.js';
import { title } from './format.js';
import { THUMBNAIL } from './layout.js';

export class Strip {
  constructor(sequence, index) {
    this.sequence = sequence;
    this.label = h('span', { class: 'label', title: sequence.labels?.length ? sequence.labels.join(', ') : title(sequence) }, title(sequence));
    this.film = h('canvas');
    this.root = h(
      'div',
      {
        class: 'strip',
        role: 'slider',
        tabindex: index === 0 ? 0 : -1,
        'aria-label': title(sequence),
        'aria-describedby': 'score-hint',
        'aria-valuemin': 0,
        'aria-valuemax': sequence.count - 1,
        'aria-valuenow': 0,
      },
      this.film,
    );
    this.place = null;
  }

  /** Puts the strip where the layout says and clears its film. */
  lay(place) {
    this.place = place;
    this.label.style.transform = `translate(${place.labelX}px, ${place.y}px)`;
    this.label.style.width = `${place.x - place.labelX - 8}px`;
    this.root.style.transform = `translate(${place.x}px, ${place.y}px)`;
    this.root.style.width = `${place.width}px`;
    this.root.style.height = `${place.height}px`;
    this.context = sizedContext(this.film, place.width, place.height);
  }

  /**
   * @param {import('./layout.js').ScoreLayout} layout
   * @param {import('./thumbnails.js').ThumbnailShelf} shelf
   * @param {string} blank colour of a pose that is not drawn yet
   */
  paint(layout, shelf, blank) {
    const { context, place } = this;
    context.clearRect(0, 0, place.width, place.height);
    for (const frame of layout.shown(place.index)) {
      const x = layout.xOf(frame) - place.x - THUMBNAIL.width / 2;
      const picture = shelf.get(frame);
      if (picture) context.drawImage(picture, x, 0, THUMBNAIL.width, THUMBNAIL.height);
      else this.paintBlank(x + THUMBNAIL.width / 2, blank);
    }
  }

  paintBlank(x, colour) {
    const { context } = this;
    context.fillStyle = colour;
    context.beginPath();
    context.arc(x, 14, 3.5, 0, 2 * Math.PI);
    context.roundRect(x - 4, 19, 8, 20, 4);
    context.fill();
  }

  /** @param {string} text where the cursor is and what going there means */
  describe(frame, text) {
    this.root.setAttribute('aria-valuenow', String(Math.round(frame) - this.sequence.first));
    this.root.setAttribute('aria-valuetext', text);
  }
}
