/** Draws a map of frames: target to the right, source upwards; low costs as strong greys, the path, keys, and where the players are. */

/** Pixels around the picture: for the axes at the left and below. */
const MARGIN = { left: 52, right: 12, top: 10, bottom: 40 };
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
const APART = 40;
/** Low costs are made to stand out by this power, for that is where paths are told apart; and how strong the lowest is. */
const GAMMA = 2;
const STRONGEST = 0.8;

/**
 * @param {HTMLCanvasElement} canvas as wide as the element around it
 * @param {object} scene `pairs`, `maps`, the names `from` and `to`, and the frames that are seen
 * @param {{from: number, to: number}} here what the players show
 * @returns {{frameAt: (x: number, y: number) => {from: number, to: number}}} for pointers
 */
export function drawMatrix(canvas, scene, here) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const scale = devicePixelRatio || 1;
  const [pixelWidth, pixelHeight] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== pixelWidth || canvas.height !== pixelHeight) Object.assign(canvas, { width: pixelWidth, height: pixelHeight });
  const context = canvas.getContext('2d');
  const style = getComputedStyle(canvas);
  const colour = (name) => style.getPropertyValue(name).trim();
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = `11px ${style.fontFamily}`;
  const area = layout(scene, width, height);
  context.fillStyle = colour('--strip');
  context.fillRect(area.left, area.top, area.width, area.height);
  context.save();
  context.beginPath();
  context.rect(area.left, area.top, area.width, area.height);
  context.clip();
  for (const map of scene.maps) if (map.costs) drawCosts(context, area, map, colour('--ink'), colour('--surface'));
  drawCross(context, area, here, colour('--muted'));
  context.restore();
  scene.maps.forEach((map) => drawPath(context, area, map, colour('--accent')));
  scene.pairs.forEach((pair) => drawKey(context, area, pair, colour('--accent'), colour('--surface')));
  drawAxes(context, area, scene, colour('--muted'), colour('--ink'));
  return area;
}

/** Where frames are on the canvas, each a cell wide. */
function layout({ fromFirst, fromLast, toFirst, toLast }, width, height) {
  const area = { left: MARGIN.left, top: MARGIN.top, width: Math.max(1, width - MARGIN.left - MARGIN.right), height: Math.max(1, height - MARGIN.top - MARGIN.bottom) };
  const [rows, columns] = [fromLast - fromFirst + 1, toLast - toFirst + 1];
  const within = (value, first, last) => Math.min(last, Math.max(first, value));
  return {
    ...area,
    x: (frame) => area.left + ((frame - toFirst + 0.5) / columns) * area.width,
    y: (frame) => area.top + area.height - ((frame - fromFirst + 0.5) / rows) * area.height,
    frameAt: (x, y) => ({
      from: within(Math.floor(fromFirst + ((area.top + area.height - y) / area.height) * rows), fromFirst, fromLast),
      to: within(Math.floor(toFirst + ((x - area.left) / area.width) * columns), toFirst, toLast),
    }),
  };
}

/** Pictures of costs that have been made, by map and colours. */
const pictures = new WeakMap();

function drawCosts(context, area, map, ink, paper) {
  const look = `${ink} ${paper}`;
  if (pictures.get(map)?.look !== look) pictures.set(map, { look, picture: paint(map.costs, ink, paper) });
  const { picture } = pictures.get(map);
  const [left, right] = [area.x(map.toFirst - 0.5), area.x(map.toLast + 0.5)];
  const [top, bottom] = [area.y(map.fromLast + 0.5), area.y(map.fromFirst - 0.5)];
  context.imageSmoothingEnabled = false;
  context.drawImage(picture, left, top, right - left, bottom - top);
}

/** Row 0 is the lowest. */
function paint({ rows, columns, values }, ink, paper) {
  const picture = document.createElement('canvas');
  Object.assign(picture, { width: columns, height: rows });
  const context = picture.getContext('2d');
  context.fillStyle = paper;
  context.fillRect(0, 0, columns, rows);
  context.fillStyle = ink;
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      context.globalAlpha = STRONGEST * (1 - values[row * columns + column] / 255) ** GAMMA;
      context.fillRect(column, rows - 1 - row, 1, 1);
    }
  }
  return picture;
}

function drawPath(context, area, { path, toFirst }, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.lineJoin = 'round';
  context.beginPath();
  path.forEach((from, index) => context.lineTo(area.x(toFirst + index), area.y(from)));
  context.stroke();
}

function drawKey(context, area, { fromFrame, toFrame }, colour, paper) {
  context.beginPath();
  context.arc(area.x(toFrame), area.y(fromFrame), 4.5, 0, 2 * Math.PI);
  context.fillStyle = paper;
  context.fill();
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.stroke();
}

function drawCross(context, area, { from, to }, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.setLineDash([3, 3]);
  context.beginPath();
  const [x, y] = [area.x(to), area.y(from)];
  context.moveTo(x, area.top);
  context.lineTo(x, area.top + area.height);
  context.moveTo(area.left, y);
  context.lineTo(area.left + area.width, y);
  context.stroke();
  context.setLineDash([]);
}

function drawAxes(context, area, { from, to, fromFirst, fromLast, toFirst, toLast }, muted, ink) {
  const bottom = area.top + area.height;
  context.fillStyle = muted;
  context.textBaseline = 'top';
  context.textAlign = 'center';
  for (const frame of ticks(toFirst, toLast, area.width)) context.fillText(String(frame), area.x(frame), bottom + 5);
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const frame of ticks(fromFirst, fromLast, area.height)) context.fillText(String(frame), area.left - 6, area.y(frame));
  context.fillStyle = ink;
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  context.fillText(`target: ${to}, frames`, area.left + area.width / 2, bottom + MARGIN.bottom - 2, area.width);
  context.save();
  context.translate(4, area.top + area.height / 2);
  context.rotate(-Math.PI / 2);
  context.textBaseline = 'top';
  context.fillText(`source: ${from}, frames`, 0, 0, area.height);
  context.restore();
}

function ticks(first, last, room) {
  const step = STEPS.find((one) => (last - first) / one <= room / APART) ?? STEPS.at(-1);
  const all = [];
  for (let frame = Math.ceil(first / step) * step; frame <= last; frame += step) all.push(frame);
  return all;
}
