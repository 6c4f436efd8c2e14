/** A path above the ground: the curve, posts under its points, and the way that the body takes, drawn over the picture. */

const SVG = 'http://www.w3.org/2000/svg';

export class Air {
  constructor() {
    this.root = document.createElementNS(SVG, 'svg');
    this.root.setAttribute('class', 'air');
    this.root.setAttribute('aria-hidden', 'true');
    this.lines = Object.fromEntries(['posts', 'taken', 'wanted'].map((name) => [name, this.line(name)]));
  }

  line(name) {
    const line = this.root.appendChild(document.createElementNS(SVG, 'path'));
    line.setAttribute('class', name);
    return line;
  }

  /**
   * @param {Record<'posts' | 'taken' | 'wanted', number[][][]>} lines of points x, z, height
   * @param {import('../stage-view.js').StageView['seen']} seen
   */
  place(lines, seen) {
    for (const [name, pieces] of Object.entries(lines)) {
      this.lines[name].setAttribute('d', pieces.map((points) => drawn(points, seen)).join(''));
    }
  }
}

/** What is behind the viewer is left out. */
function drawn(points, seen) {
  let pen = 'M';
  return points
    .map((point) => {
      const { x, y, visible } = seen(...point);
      if (!visible && x === 0 && y === 0) {
        pen = 'M';
        return '';
      }
      const step = `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
      pen = 'L';
      return step;
    })
    .join('');
}
