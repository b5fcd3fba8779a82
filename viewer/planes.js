// The planes in which the map is drawn: two unknowns, a torus where these are angles, or the first principal plane of all
// cosines and sines; and the lines of a curve in a plane.

const TURN = 2 * Math.PI;
const MOST_TICKS = 6;
const ON_EDGE = 1e-6; // of half a turn: so near to an edge of the frame lies on it

/** The plane of two unknowns, by their numbers from 0: angles in degrees, a period from -180 to 180. */
export function unknownPlane(unknowns, ...pair) {
  const chosen = pair.map((i) => unknowns[i]);
  return {
    isPeriodic: chosen.map((unknown) => unknown.isPeriodic),
    ticks: chosen.map(ticksOf),
    turns: chosen.map((unknown) => unknown.turns),
    labels: chosen.map((unknown) => unknown.label),
    project: (theta) => chosen.map((unknown, k) => unknown.shown(theta[pair[k]])),
    low: chosen.map((unknown) => unknown.low),
    high: chosen.map((unknown) => unknown.high),
  };
}

/** Round numbers on an axis. */
function ticksOf({ isPeriodic, low, high }) {
  if (isPeriodic) return [-180, -90, 0, 90, 180];
  const rough = (high - low) / MOST_TICKS;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * decade).find((one) => one >= rough);
  const ticks = [];
  for (let k = Math.ceil(low / step); k * step <= high; k += 1) ticks.push(Number((k * step).toPrecision(3)));
  return ticks;
}

/** The plane in which the cosines and sines of all angles, and all else as it is, spread most, around what is drawn. */
export function principalPlane(principal, unknowns, tracks) {
  const { mean, axes } = principal;
  const project = (theta) => {
    const cosines = unknowns.map((unknown, i) => (unknown.isPeriodic ? Math.cos((TURN * theta[i]) / unknown.period) : theta[i]));
    const sines = unknowns.map((unknown, i) => (unknown.isPeriodic ? Math.sin((TURN * theta[i]) / unknown.period) : 0));
    const features = [...cosines, ...sines];
    return axes.map((axis) => axis.reduce((sum, weight, k) => sum + weight * (features[k] - mean[k]), 0));
  };
  const spots = tracks.flatMap((track) => track.samples.map(({ theta }) => project(theta)));
  const middle = [0, 1].map((k) => (lowest(spots, k) + highest(spots, k)) / 2);
  const half = 0.55 * Math.max(...[0, 1].map((k) => highest(spots, k) - lowest(spots, k)), 1e-3);
  return {
    isPeriodic: [false, false],
    ticks: [[], []],
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

/** Where in the frame a configuration is shown: more than one place where a periodic unknown lies on an edge. */
export function spotsOf(plane, theta) {
  const point = plane.project(theta);
  const choices = point.map((x, k) => {
    if (!plane.isPeriodic[k]) return [x];
    const within = x - 360 * Math.round(x / 360);
    return Math.abs(Math.abs(within) - 180) < 180 * ON_EDGE ? [180, -180] : [within];
  });
  return choices[0].flatMap((x) => choices[1].map((y) => [x, y]));
}

/** The lines of a curve through configurations, as lists of places in the frame: cut where a periodic unknown is at an
 * edge. */
export function linesOf(plane, samples) {
  const points = samples.map(({ theta }) => plane.project(theta));
  const { isPeriodic } = plane;
  if (!isPeriodic.some(Boolean)) return points.length > 1 ? [points] : [];
  const lines = new Map(); // open lines by the cell of the torus' cover that they lie in
  const closed = [];
  for (let k = 0; k + 1 < points.length; k += 1) {
    const touched = new Set();
    for (const { from, to, cells } of cutSteps(isPeriodic, points[k], points[k + 1])) {
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
function cutSteps(isPeriodic, a, b) {
  const cuts = [0, 1];
  for (let k = 0; k < 2; k += 1) {
    if (!isPeriodic[k]) continue;
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
    const [columns, rows] = middle.map((x, axis) => (isPeriodic[axis] ? cellsOf(x) : [0]));
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
