/**
 * What is asked, as plain data, for links and files: `{ reprise: 1, tool, place, path, keys, wander }`. What comes from
 * outside is checked part by part; every complaint is a sentence.
 */

import { TOOLS } from '../attributes.js';
import { PlayerError } from '../errors.js';
import { behavioursOf } from '../targets.js';
import { paint } from './stretches.js';

export const VERSION = 1;
/** A document longer than this is none. */
const LONGEST = 200_000;
/** Metres from the origin, and seconds, beyond which nothing is meant. */
const FAR = 1000;
const LONG = 3600;
const MOST = { points: 200, stretches: 200, keys: 100 };

export const EMPTY = Object.freeze({
  place: null,
  path: { points: [], stretches: [] },
  keys: [],
  wander: { seed: 1, weights: {} },
});

const wrong = (message) => new PlayerError('bad-argument', message);

/** @param {string} text of a file or a link */
export function parseDocument(text) {
  if (text.length > LONGEST) throw wrong('This is too long to be a direction.');
  try {
    return JSON.parse(text);
  } catch {
    throw wrong('This is not a direction: it is no JSON.');
  }
}

/**
 * The document that something from outside means, with nothing in it that the actor does not have.
 * @param {import('../../reprise-player').ActorInfo} info
 */
export function checkDocument(outside, info) {
  if (!isRecord(outside) || outside.reprise === undefined) throw wrong('This is not a direction of Reprise.');
  if (outside.reprise !== VERSION) throw wrong('This direction is of a later Reprise than this page’s.');
  const tool = outside.tool ?? 'pose';
  if (!TOOLS.includes(tool)) throw wrong(`This direction asks for a tool “${String(tool)}”, which there is not.`);
  const behaviours = behavioursOf(info);
  return {
    tool,
    place: checkPlace(outside.place ?? null),
    path: checkPath(outside.path ?? EMPTY.path, behaviours),
    keys: checkKeys(outside.keys ?? [], info),
    wander: checkWander(outside.wander ?? EMPTY.wander, behaviours),
  };
}

function isRecord(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function number(value, least, most, what) {
  if (typeof value !== 'number' || !(value >= least && value <= most)) throw wrong(`${what} should be a number from ${least} to ${most}.`);
  return value;
}

function list(value, most, what) {
  if (!Array.isArray(value)) throw wrong(`${what} should be a list.`);
  if (value.length > most) throw wrong(`${what} are too many: ${value.length}, and ${most} at most.`);
  return value;
}

function known(behaviour, behaviours) {
  if (!behaviours.includes(behaviour)) throw wrong(`The actor has no behaviour “${String(behaviour)}”; it has ${behaviours.join(', ')}.`);
  return behaviour;
}

function checkPlace(place) {
  if (place === null) return null;
  if (!isRecord(place)) throw wrong('The place should have an x and a z.');
  const heading = place.heading ?? null;
  return {
    x: number(place.x, -FAR, FAR, 'The place’s x'),
    z: number(place.z, -FAR, FAR, 'The place’s z'),
    heading: heading === null ? null : number(heading, -100, 100, 'The place’s heading'),
  };
}

function checkPath(path, behaviours) {
  if (!isRecord(path)) throw wrong('The path should have points.');
  const points = list(path.points ?? [], MOST.points, 'The path’s points').map((point) =>
    list(point, 2, 'A point').map((part) => number(part, -FAR, FAR, 'A point’s coordinate')),
  );
  if (points.some((point) => point.length !== 2)) throw wrong('A point should have an x and a z.');
  const last = Math.max(0, points.length - 1);
  const stretches = list(path.stretches ?? [], MOST.stretches, 'The path’s stretches').reduce((painted, stretch) => {
    const [from, to] = ['from', 'to'].map((end) => number(stretch?.[end], 0, last, 'A stretch’s end'));
    return paint(painted, Math.min(from, to), Math.max(from, to), known(stretch.behaviour, behaviours));
  }, []);
  return { points, stretches };
}

function checkKeys(keys, info) {
  const checked = list(keys, MOST.keys, 'The key poses').map((key) => {
    const frame = number(key?.frame, 0, info.frames - 1, 'A key pose’s frame');
    return { frame: Math.round(frame), seconds: number(key.seconds, 0, LONG, 'A key pose’s time') };
  });
  return checked.sort((a, b) => a.seconds - b.seconds);
}

function checkWander(wander, behaviours) {
  if (!isRecord(wander) || !isRecord(wander.weights ?? {})) throw wrong('Wandering should have a seed and weights.');
  const weights = Object.entries(wander.weights ?? {}).map(([behaviour, weight]) => [known(behaviour, behaviours), number(weight, 0, 100, `The weight of ${behaviour}`)]);
  return { seed: Math.trunc(number(wander.seed ?? 1, 0, 4294967295, 'The seed')), weights: Object.fromEntries(weights) };
}

/** Without the parts in which nothing is asked, rounded to millimetres and milliradians: what a link should carry. */
export function tidied(tool, document) {
  const { place, path, keys, wander } = document;
  const asked = { reprise: VERSION, tool };
  if (place) asked.place = place;
  if (path.points.length > 0) asked.path = path;
  if (keys.length > 0) asked.keys = keys;
  if (tool === 'wander' || wander !== EMPTY.wander) asked.wander = wander;
  return JSON.parse(JSON.stringify(asked, (_, value) => (typeof value === 'number' ? Math.round(value * 1000) / 1000 : value)));
}
