// Routes: the shortest chain of arcs from a place to a form, as bifurc/routes does for forms.

import { modulo } from "./tracks.js";

// Over the longest arc: of chains whose lengths differ by less the one of the earlier arcs is taken, as TIE in
// bifurc/routes/ways.py does, so that page and Python give one route.
const TIE = 1e-9;

/** The arcs of all forms as {track, start, end, first, last, rank}: nodes are names of singular points and ends of
 *  forms, the rank is the place in the order of forms, from 1. */
export function arcsOf(scene, tracks) {
  const arcs = [];
  scene.forms.forEach((form, index) => {
    const track = tracks[index];
    const stops = stopsOf(scene, track, index);
    for (let k = 0; k + 1 < stops.length; k += 1) {
      const [begin, end] = [stops[k], stops[k + 1]];
      arcs.push({ track, start: begin.s, end: end.s, first: begin.node, last: end.node, rank: arcs.length + 1 });
    }
  });
  return arcs;
}

function stopsOf(scene, track, index) {
  const stops = [];
  for (const point of scene.points) {
    for (const [form, s] of point.passes) if (form === index) stops.push({ s, node: point.name });
  }
  if (!track.closed) {
    const near = 1e-6 * Math.max(track.length, 1);
    for (const [s, word] of [[0, "start"], [track.length, "end"]]) {
      const isFree = stops.every((stop) => Math.abs(stop.s - s) > near);
      if (isFree) stops.push({ s, node: `${track.name} ${word}` });
    }
  } else if (!stops.length) {
    stops.push({ s: 0, node: `${track.name} start` });
  }
  stops.sort((a, b) => a.s - b.s);
  if (track.closed) stops.push({ s: stops[0].s + track.length, node: stops[0].node });
  return stops;
}

/** The place in the middle of the longest arc of a track. */
export function middleOf(arcs, track) {
  let longest;
  for (const arc of arcs) {
    if (arc.track !== track) continue;
    const isLonger = !longest || arc.end - arc.start > longest.end - longest.start + 1e-9;
    if (isLonger) longest = arc;
  }
  return longest ? (longest.start + longest.end) / 2 : track.length / 2;
}

/** The legs {track, start, end, at} of the shortest way between two places {track, s}; undefined where there is none. */
export function shortestRoute(arcs, from, to) {
  const ways = splitAt(splitAt(arcs, from, "from here"), to, "to there");
  const tie = TIE * Math.max(...arcs.map((arc) => arc.end - arc.start));
  const chain = shortestChain(ways, "from here", "to there", tie);
  if (!chain) return undefined;
  const legs = chain.map(({ track, start, end, at }) => ({ track, start, end, at }));
  return legs.filter((leg) => Math.abs(leg.end - leg.start) > 1e-9);
}

/** The arcs with the one that holds a place split there by a node. */
function splitAt(arcs, place, node) {
  const own = arcs.filter((arc) => arc.track === place.track);
  if (!own.length) return arcs;
  const { closed, length } = place.track;
  const begin = Math.min(...own.map((arc) => arc.start));
  const s = closed ? begin + modulo(place.s - begin, length) : place.s;
  const miss = (arc) => Math.max(arc.start - s, s - arc.end, 0);
  const nearest = own.reduce((best, arc) => (miss(arc) < miss(best) ? arc : best));
  const at = Math.min(Math.max(s, nearest.start), nearest.end);
  const last = Math.max(...arcs.map((arc) => arc.rank));
  const parts = [
    { ...nearest, end: at, last: node, rank: last + 1 },
    { ...nearest, start: at, first: node, rank: last + 2 },
  ];
  return [...arcs.filter((arc) => arc !== nearest), ...parts];
}

/** Dijkstra's shortest chain (1959) of arcs between two nodes, as legs; chains of one length, as symmetry makes them,
 *  differ by `tie` times the roots of numbers. */
function shortestChain(arcs, start, goal, tie) {
  const best = new Map([[start, { length: 0, legs: [] }]]);
  const done = new Set();
  for (;;) {
    const node = nearestOpen(best, done);
    if (node === undefined) return undefined;
    if (node === goal) return best.get(goal).legs;
    done.add(node);
    for (const leg of legsFrom(arcs, node)) {
      const { length, legs } = best.get(node);
      const total = length + Math.abs(leg.end - leg.start) + tie * Math.sqrt(leg.rank);
      const known = best.get(leg.at);
      if (!known || total < known.length) best.set(leg.at, { length: total, legs: [...legs, leg] });
    }
  }
}

function nearestOpen(best, done) {
  let nearest;
  for (const [node, { length }] of best) {
    if (done.has(node)) continue;
    if (nearest === undefined || length < best.get(nearest).length) nearest = node;
  }
  return nearest;
}

function legsFrom(arcs, node) {
  const legs = [];
  for (const { track, start, end, first, last, rank } of arcs) {
    if (first === node) legs.push({ track, start, end, at: last, rank });
    if (last === node) legs.push({ track, start: end, end: start, at: first, rank });
  }
  return legs;
}

/** The length of a route. */
export function lengthOf(legs) {
  return legs.reduce((sum, leg) => sum + Math.abs(leg.end - leg.start), 0);
}

/** Where on a route so much of its length has been gone: {leg, s, direction}. */
export function placeAlong(legs, gone) {
  let left = gone;
  for (let k = 0; k < legs.length; k += 1) {
    const leg = legs[k];
    const length = Math.abs(leg.end - leg.start);
    const direction = leg.end < leg.start ? -1 : 1;
    if (left <= length || k === legs.length - 1) {
      return { leg, number: k, s: leg.start + direction * Math.min(left, length), direction };
    }
    left -= length;
  }
  return undefined;
}
