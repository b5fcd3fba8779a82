// The planes in which the map is drawn: two joint angles on a torus, or the first principal plane of the angles' cosines
// and sines; and the lines of a curve in a plane.

import { angleName, DEGREES } from "./angles.js";

const ON_EDGE = 1e-6; // of half a turn: so near to an edge of the frame lies on it

/** The plane of two joints, from 0: angles in degrees, a frame from -180 to 180. */
export function jointPlane(i, j) {
  return {
    isTorus: true,
    labels: [`${angleName(i + 1)} (deg)`, `${angleName(j + 1)} (deg)`],
    project: (theta) => [theta[i] * DEGREES, theta[j] * DEGREES],
    low: [-180, -180],
    high: [180, 180],
  };
}

/** The plane in which the cosines and sines of all angles spread most, around everything that is drawn. */
export function principalPlane(principal, tracks) {
  const { mean, axes } = principal;
  const project = (theta) => {
    const features = [...Array.from(theta, Math.cos), ...Array.from(theta, Math.sin)];
    return axes.map((axis) => axis.reduce((sum, weight, k) => sum + weight * (features[k] - mean[k]), 0));
  };
  const spots = tracks.flatMap((track) => track.samples.map(({ theta }) => project(theta)));
  const middle = [0, 1].map((k) => (lowest(spots, k) + highest(spots, k)) / 2);
  const half = 0.55 * Math.max(...[0, 1].map((k) => highest(spots, k) - lowest(spots, k)), 1e-3);
  return {
    isTorus: false,
    labels: ["first principal axis", "second principal axis"],
    project,
    low: middle.map((x) => x - half),
    high: middle.map((x) => x + half),
  };
}

function lowest(spots, k) {
  return spots.reduce((least, spot) => Math.min(least, spot[k]), Infinity);
}

function highest(spots, k) {
  return spots.reduce((most, spot) => Math.max(most, spot[k]), -Infinity);
}

/** Where in the frame a configuration is shown: more than one place where it lies on an edge of a torus. */
export function spotsOf(plane, theta) {
  const point = plane.project(theta);
  if (!plane.isTorus) return [point];
  const choices = point.map((x) => {
    const within = x - 360 * Math.round(x / 360);
    return Math.abs(Math.abs(within) - 180) < 180 * ON_EDGE ? [180, -180] : [within];
  });
  return choices[0].flatMap((x) => choices[1].map((y) => [x, y]));
}

/** The lines of a curve through configurations, as lists of places in the frame: cut at the edges of a torus. */
export function linesOf(plane, samples) {
  const points = samples.map(({ theta }) => plane.project(theta));
  if (!plane.isTorus) return points.length > 1 ? [points] : [];
  const lines = new Map(); // open lines by the cell of the torus' cover that they lie in
  const closed = [];
  for (let k = 0; k + 1 < points.length; k += 1) {
    const touched = new Set();
    for (const { from, to, cells } of cutSteps(points[k], points[k + 1])) {
      for (const cell of cells) {
        const key = cell.join();
        const shift = (p) => [p[0] - 360 * cell[0], p[1] - 360 * cell[1]];
        const line = lines.get(key);
        const start = shift(from);
        if (line && Math.hypot(line.at(-1)[0] - start[0], line.at(-1)[1] - start[1]) < 1e-6) line.push(shift(to));
        else {
          if (line) closed.push(line);
          lines.set(key, [start, shift(to)]);
        }
        touched.add(key);
      }
    }
    for (const [key, line] of lines) {
      if (touched.has(key)) continue;
      closed.push(line);
      lines.delete(key);
    }
  }
  return [...closed, ...lines.values()];
}

/** A straight step cut at the edges of all cells, each part with the cells whose frame shows it. */
function cutSteps(a, b) {
  const cuts = [0, 1];
  for (let k = 0; k < 2; k += 1) {
    const [u, v] = [(a[k] + 180) / 360, (b[k] + 180) / 360];
    for (let edge = Math.ceil(Math.min(u, v)); edge <= Math.max(u, v); edge += 1) {
      const t = (edge - u) / (v - u);
      if (t > 0 && t < 1) cuts.push(t);
    }
  }
  cuts.sort((x, y) => x - y);
  const parts = [];
  for (let k = 0; k + 1 < cuts.length; k += 1) {
    const [from, to] = [pointBetween(a, b, cuts[k]), pointBetween(a, b, cuts[k + 1])];
    const middle = pointBetween(a, b, (cuts[k] + cuts[k + 1]) / 2);
    const columns = cellsOf(middle[0]);
    const rows = cellsOf(middle[1]);
    parts.push({ from, to, cells: columns.flatMap((x) => rows.map((y) => [x, y])) });
  }
  return parts;
}

/** The numbers of the turns that show a coordinate: two on an edge. */
function cellsOf(x) {
  const u = (x + 180) / 360;
  const edge = Math.round(u);
  return Math.abs(u - edge) < 0.5 * ON_EDGE ? [edge - 1, edge] : [Math.floor(u)];
}

function pointBetween(a, b, t) {
  return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
}
