// A mechanism: its bodies, placed one after the other along a tree, and what is drawn of them. The document is that of
// linkages/links/motion_document.py; lengths are in characteristic lengths.

import { compose, invert, moved } from "./kinematics.js";
import { along, distance } from "./rods.js";
import { singularValues } from "./singular_values.js";
import { jacobianColumns } from "./tape.js";

const SMALL = 1e-12; // sine below which two directions are parallel
const REACH = 0.14; // of the extent: how far an axis is drawn to either side of its joint
const LIFT = 15; // pixels: how far a name stands above a joint that has no axis to write it at
const LONGEST = 10; // letters of a name in the picture
const ENDING = 4; // of these, the last letters of a longer one
const SHAPES = { prismatic: "box", planar: "plate", spherical: "ball", rigid: null };

export class MechanismFigure {
  constructor(mechanism) {
    this.mechanism = mechanism;
    this.size = mechanism.size;
    this.named = mechanism.symbols.filter(({ label }) => label);
    this.names = this.named.map(({ label }) => shortened(label));
    this.bodies = mechanism.bodies.map(({ name }) => name);
    this.panels = mechanism.bodies.flatMap(({ panels }, body) => panels.map((corners) => ({ corners, body })));
    this.sheets = new Set(this.panels.map(({ body }) => body));
    this.legs = mechanism.rods.filter(({ leg, parts }) => leg && parts.every(({ bodies }) => bodies.length === 1));
    this.legBodies = new Set(this.legs.flatMap(({ parts }) => parts.map(({ bodies }) => bodies[0])));
    this.lines = mechanism.bodies.map((_, body) => this.linesOf(body));
    this.mostRods = this.lines.reduce((sum, lines) => sum + lines.length, 2 * this.legs.length);
    this.shapes = {};
    for (const symbol of mechanism.symbols) {
      const shape = shapeOf(symbol);
      if (shape) this.shapes[shape] = (this.shapes[shape] ?? 0) + Math.max(symbol.directions.length, 1);
    }
    this.mostAxes = mechanism.symbols.reduce((sum, { directions }) => sum + directions.length, 0);
    this.fixed = mechanism.held;
    this.fixedWord = "fixed body";
    this.valuesWord = "joint variables";
  }

  bodyOf(frame) {
    return frame;
  }

  /** The lines of a body: the outlines of its panels, where it has any, and none of one of the two parts of a leg, which
   * are drawn between its ends. */
  linesOf(body) {
    if (this.legBodies.has(body)) return [];
    if (!this.sheets.has(body)) return this.mechanism.bodies[body].lines;
    const own = this.mechanism.bodies[body].panels;
    return own.flatMap((corners) => corners.map((corner, k) => [corner, corners[(k + 1) % corners.length]]));
  }

  /** The displacements of all bodies from the reference configuration, the frame at rest, at unknowns `u`. */
  frames(u) {
    const { mechanism } = this;
    const poses = mechanism.bodies.map(() => identity());
    for (const step of mechanism.steps) {
      const motion = displacement(step, u);
      poses[step.goal] = compose(poses[step.origin], step.sign < 0 ? invert(motion) : motion);
    }
    for (const rod of mechanism.rods) placeRod(rod, poses, u);
    const back = invert(poses[mechanism.frame]);
    const frames = new Float64Array(12 * poses.length);
    poses.forEach((pose, k) => frames.set(compose(back, pose), 12 * k));
    return frames;
  }

  parts(frames) {
    const { bodies, symbols } = this.mechanism;
    const poses = bodies.map((_, k) => frames.subarray(12 * k, 12 * k + 12));
    const rods = this.lines.flatMap((lines, body) =>
      lines.map(([from, to]) => ({ from: moved(poses[body], from), to: moved(poses[body], to), body })),
    );
    const middles = new Map();
    for (const { ends, centers, parts: own } of this.legs) {
      const [from, to] = ends.map((body, k) => moved(poses[body], centers[k]));
      const middle = from.map((x, k) => (x + to[k]) / 2);
      const [lower, upper] = own.map(({ bodies: [body] }) => body);
      rods.push({ from, to: middle, body: lower }, { from: middle, to, body: upper });
      middles.set(lower, middle).set(upper, middle);
    }
    const panels = this.panels.map(({ corners, body }) => ({ corners: corners.map((corner) => moved(poses[body], corner)), body }));
    const seats = symbols.map(({ kind, holder, other, place }) => {
      const isOfLeg = kind === "prismatic" && middles.has(holder) && middles.has(other);
      return isOfLeg ? middles.get(holder) : moved(poses[holder], place);
    });
    const extent = extentOf(seats);
    const parts = { symbols: [], rods, panels, axes: [], seats: [], labels: [] };
    symbols.forEach((symbol, k) => addSymbol(parts, symbol, seats[k], poses, this.isCrease(symbol) ? 0 : REACH * extent));
    return parts;
  }

  /** Whether the axis of a joint is seen anyway, as the side of two panels. */
  isCrease({ holder, other }) {
    return this.sheets.has(holder) && this.sheets.has(other);
  }

  /** What a state says of a configuration: three rows of four a body, lengths in the user's unit. */
  state(u) {
    const frames = this.frames(u);
    const bodies = this.bodies.map((name, k) => {
      const pose = Array.from(frames.subarray(12 * k, 12 * k + 12));
      return { name, pose: pose.map((x, i) => (i % 4 === 3 ? x * this.size : x)) };
    });
    return { bodies, singular_values: this.singularValues(u) };
  }

  /** The singular values of F', largest first; none of a mechanism of many unknowns. */
  singularValues(u) {
    const { tape } = this.mechanism;
    return tape ? singularValues(jacobianColumns(tape, u)) : [];
  }

  /** The smallest regular singular value along a track, as {s, value}; at places where the rank drops it is 0. */
  smallestAlong(track, places, drops) {
    if (this.mechanism.tape) {
      return places.map((s) => ({ s, value: this.singularValues(track.at(s))[track.form.rank - 1] }));
    }
    const values = track.form.smallest.map(([s, value]) => ({ s, value }));
    for (const s of drops) values.push({ s, value: 0 });
    return values.sort((a, b) => a.s - b.s);
  }
}

// --- the motion ------------------------------------------------------------------------

/** The displacement of the moved body of a step with respect to its base. */
function displacement({ factors, rotation }, u) {
  if (rotation) return embedded(rotation, u);
  if (!factors.length) return identity();
  return factors.map((factor) => elementary(factor, u)).reduce((product, motion) => compose(product, motion));
}

/** A turn about an axis that advances along it, or a slide. */
function elementary({ is_turn: isTurn, direction, point, advance, column, rate, offset }, u) {
  const amount = column === null ? offset : rate * u[column] + offset;
  if (!isTurn) return translation(direction.map((x) => amount * x));
  const motion = about(turn(direction, amount), point);
  return advance ? compose(translation(direction.map((x) => advance * amount * x)), motion) : motion;
}

/** A rotation whose first two columns are unknowns, and where it has them three numbers of a translation. */
function embedded({ columns, center }, u) {
  const [a, b, shift] = [0, 3, 6].map((first) => columns.slice(first, first + 3).map((column) => u[column]));
  const c = cross(a, b);
  const motion = about([a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]], center);
  return shift.length ? compose(translation(shift), motion) : motion;
}

/** Place the bodies of a rod between its ends, turned as little as can be. */
function placeRod({ ends, centers, parts, leg }, poses, u) {
  const places = ends.map((body, k) => moved(poses[body], centers[k]));
  let now = unit(difference(places[1], places[0]));
  if (leg) {
    const sign = Math.sign(leg.length + leg.rate * u[leg.column]); // beyond length 0 it points the other way
    now = now.map((x) => sign * x);
  }
  const rotation = shortestTurn(unit(difference(parts[1].start, parts[0].start)), now);
  parts.forEach(({ start, bodies, inside }, end) => {
    const shift = difference(places[end], start);
    const pose = compose(translation(shift), about(rotation, start));
    bodies.forEach((body, k) => (poses[body] = compose(pose, inside[k])));
  });
}

/** The smallest rotation that turns one unit vector to another. */
function shortestTurn(start, goal) {
  let axis = cross(start, goal);
  const sine = Math.hypot(...axis);
  const cosine = dot(start, goal);
  if (sine < SMALL) {
    const sizes = start.map(Math.abs);
    const least = sizes.indexOf(Math.min(...sizes));
    axis = cross(start, [0, 1, 2].map((k) => (k === least ? 1 : 0)));
  }
  return turn(unit(axis), Math.atan2(sine, cosine));
}

/** A rotation about a unit vector, nine numbers row by row. */
function turn([x, y, z], angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const v = 1 - c;
  return [
    c + v * x * x, v * x * y - s * z, v * x * z + s * y,
    v * x * y + s * z, c + v * y * y, v * y * z - s * x,
    v * x * z - s * y, v * y * z + s * x, c + v * z * z,
  ];
}

/** The transform of a rotation about a point. */
function about(r, p) {
  const rows = [0, 3, 6].map((k) => [r[k], r[k + 1], r[k + 2]]);
  return Float64Array.from(rows.flatMap((row, k) => [...row, p[k] - dot(row, p)]));
}

function translation([x, y, z]) {
  return Float64Array.of(1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z);
}

function identity() {
  return translation([0, 0, 0]);
}

// --- the drawing -----------------------------------------------------------------------

function shapeOf({ kind }) {
  return kind in SHAPES ? SHAPES[kind] : "cylinder";
}

/** A name for the picture: of a long one the beginning and the end, by which names in a row differ. */
export function shortened(name) {
  if (name.length <= LONGEST) return name;
  return `${name.slice(0, LONGEST - 1 - ENDING)}…${name.slice(-ENDING)}`;
}

/** Add the symbol of a joint, its axes and its name to the parts. */
function addSymbol(parts, symbol, seat, poses, reach) {
  const { kind, label, columns, directions, holder, other } = symbol;
  const shape = shapeOf(symbol);
  const bodies = [holder, other]; // the second axis of a universal joint is on its other body
  const turned = directions.map((direction, k) => rotated(poses[bodies[k]], direction));
  if (shape === "ball") parts.symbols.push({ shape, seat, columns });
  else if (shape) for (const direction of turned) parts.symbols.push({ shape, seat, direction, columns });
  const hasAxis = reach > 0 && kind !== "prismatic" && kind !== "planar"; // the rail of a slide is a rod
  if (hasAxis) for (const d of turned) parts.axes.push([along(seat, d, -reach), along(seat, d, reach)]);
  if (!label) return;
  parts.seats.push(seat);
  const isAtEnd = hasAxis && turned.length > 0;
  parts.labels.push(isAtEnd ? { place: along(seat, turned[0], reach), lift: 0 } : { place: seat, lift: LIFT });
}

function extentOf(seats) {
  const middle = [0, 1, 2].map((k) => seats.reduce((sum, seat) => sum + seat[k], 0) / seats.length);
  return Math.max(...seats.map((seat) => distance(seat, middle)));
}

function rotated(pose, d) {
  return [0, 4, 8].map((at) => pose[at] * d[0] + pose[at + 1] * d[1] + pose[at + 2] * d[2]);
}

function unit(v) {
  const length = Math.hypot(...v);
  return v.map((x) => x / length);
}

function difference(a, b) {
  return [0, 1, 2].map((k) => a[k] - b[k]);
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
