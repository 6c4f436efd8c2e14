/** Shapes on the ground as triangles, in the bytes that the stage takes: X, Z, and a colour with its opacity. */

const CORNER = 12;
/** Sides of a disc. */
const SIDES = 40;

export class Marks {
  constructor() {
    this.bytes = new DataView(new ArrayBuffer(CORNER * 3 * 256));
    this.length = 0;
  }

  clear() {
    this.length = 0;
  }

  get data() {
    return new Uint8Array(this.bytes.buffer, 0, this.length);
  }

  /** @param {[number, number]} point @param {[number, number, number, number]} colour bytes, the last one the opacity */
  corner([x, z], colour) {
    if (this.length + CORNER > this.bytes.byteLength) this.grow();
    this.bytes.setFloat32(this.length, x, true);
    this.bytes.setFloat32(this.length + 4, z, true);
    for (let channel = 0; channel < 4; channel += 1) this.bytes.setUint8(this.length + 8 + channel, colour[channel]);
    this.length += CORNER;
  }

  grow() {
    const larger = new Uint8Array(this.bytes.byteLength * 2);
    larger.set(new Uint8Array(this.bytes.buffer));
    this.bytes = new DataView(larger.buffer);
  }

  quad(a, b, c, d, colour) {
    for (const point of [a, b, c, c, b, d]) this.corner(point, colour);
  }

  /**
   * A line of points `width` metres wide, mitred where it bends; heights do not count.
   * @param {number[][]} points
   * @param {[number, number] | null} dash metres drawn and left out, in turn
   */
  ribbon(points, width, colour, dash = null) {
    const line = points.map(([x, z]) => [x, z]).filter((point, at, all) => at === 0 || apart(point, all[at - 1]) > 1e-4);
    if (line.length < 2) return;
    if (dash) {
      for (const piece of dashes(line, dash)) this.ribbon(piece, width, colour);
      return;
    }
    const sides = line.map((point, at) => edges(line[at - 1] ?? point, point, line[at + 1] ?? point, width / 2));
    for (let at = 1; at < line.length; at += 1) this.quad(...sides[at - 1], ...sides[at], colour);
  }

  /** The area between two lines of as many points. */
  between(one, other, colour) {
    for (let at = 1; at < Math.min(one.length, other.length); at += 1) this.quad(one[at - 1], other[at - 1], one[at], other[at], colour);
  }

  disc([x, z], radius, colour, hole = 0) {
    const rim = (side, size) => {
      const angle = (side / SIDES) * 2 * Math.PI;
      return [x + Math.sin(angle) * size, z + Math.cos(angle) * size];
    };
    for (let side = 0; side < SIDES; side += 1) this.quad(rim(side, hole), rim(side, radius), rim(side + 1, hole), rim(side + 1, radius), colour);
  }

  /** An arrow head at a point; heading 0 is along +Z. */
  arrow([x, z], heading, size, colour) {
    const at = (angle, far) => [x + Math.sin(heading + angle) * far, z + Math.cos(heading + angle) * far];
    for (const point of [at(0, size), at(2.45, size * 0.75), at(-2.45, size * 0.75)]) this.corner(point, colour);
  }
}

/** Metres between two points: through the air where both have a height behind x and z, else along the ground. */
export function apart(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a.length > 2 && b.length > 2 ? a[2] - b[2] : 0);
}

/** The pieces of a line that a dash draws. */
function dashes(line, [drawn, left]) {
  const pieces = [[line[0]]];
  let [on, rest] = [true, drawn];
  for (let at = 1; at < line.length; at += 1) {
    let here = line[at - 1];
    let far = apart(here, line[at]);
    while (far > rest) {
      const share = rest / far;
      here = [here[0] + (line[at][0] - here[0]) * share, here[1] + (line[at][1] - here[1]) * share];
      far -= rest;
      if (on) pieces[pieces.length - 1].push(here);
      else pieces.push([here]);
      on = !on;
      rest = on ? drawn : left;
    }
    rest -= far;
    if (on) pieces[pieces.length - 1].push(line[at]);
  }
  return pieces;
}

/** Both edges of a line at a point. */
function edges(before, here, after, half) {
  const unit = (from, to) => {
    const far = apart(from, to) || 1;
    return [(to[0] - from[0]) / far, (to[1] - from[1]) / far];
  };
  const [back, forth] = [unit(before, here), unit(here, after)];
  const sum = [back[0] + forth[0], back[1] + forth[1]];
  const size = Math.hypot(...sum) || 1;
  const normal = [-sum[1] / size, sum[0] / size];
  const straight = before === here ? forth : back;
  // A hairpin's mitre would be endless.
  const stretch = half / Math.max(0.5, Math.abs(normal[1] * straight[0] - normal[0] * straight[1]));
  return [[here[0] - normal[0] * stretch, here[1] - normal[1] * stretch], [here[0] + normal[0] * stretch, here[1] + normal[1] * stretch]];
}
