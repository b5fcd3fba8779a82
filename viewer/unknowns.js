// The unknowns: what they are called, in what they are shown, and which of them are periodic.

import { angleName, DEGREES, inDegrees, wrapped } from "./angles.js";

const TURN = 2 * Math.PI;

const DIGITS = 4; // of numbers that are no angles

/** The unknowns of a document; `tracks` say how far those without a period go.
 *
 * Each has its `name`, its `label` on an axis, `shown(u)` on that axis, whether it `isPeriodic`, the ends `low` and
 * `high` of the axis, by what its ticks are multiplied (`turns`), and `text(u)`. A periodic one has its period from -180
 * to 180, however many turns that are: joints that are coupled come back after several.
 */
export function unknownsOf(scene, tracks) {
  if (scene.loop) return namesOfLoop(scene.loop).map((name) => periodicAngle(name));
  return scene.mechanism.unknowns.map((unknown, i) => {
    if (unknown.is_angle && unknown.period !== null) return periodicAngle(unknown.name, unknown.period / TURN);
    const factor = unknown.is_angle ? DEGREES : unknown.factor;
    return openUnknown(unknown, factor, shownRange(tracks, i, factor));
  });
}

/** The names of the unknowns of a loop: of its joints, in the order of the unknowns, or else of its angles. */
function namesOfLoop({ lengths, joints }) {
  if (!joints) return lengths.map((_, i) => angleName(i + 1));
  return [...joints].sort((a, b) => a.column - b.column).map(({ name }) => name);
}

/** The joint variables that are coupled to unknowns: each as an unknown, with its value `of(u)` at unknowns u. */
export function followersOf(scene, tracks) {
  return (scene.mechanism?.followers ?? []).map((follower) => {
    const { name, is_angle: isAngle, column, rate, offset } = follower;
    const of = (u) => rate * u[column] + offset;
    if (isAngle && scene.mechanism.unknowns[column].period !== null) return { ...periodicAngle(name), of };
    const factor = isAngle ? DEGREES : follower.factor;
    const range = shownRange(tracks, column, factor * rate).map((end) => end + factor * offset);
    return { ...openUnknown(follower, factor, range), of };
  });
}

function periodicAngle(name, turns = 1) {
  return {
    name,
    label: `${name} (deg)`,
    shown: (u) => (u * DEGREES) / turns,
    isPeriodic: true,
    period: turns * TURN,
    turns,
    low: -180,
    high: 180,
    text: (u) => (turns === 1 ? inDegrees(u) : (turns * wrapped(u / turns) * DEGREES).toFixed(2)),
    share: (u) => 0.5 + wrapped(u / turns) / TURN,
  };
}

function openUnknown({ name, is_angle: isAngle }, factor, [low, high]) {
  return {
    name,
    label: isAngle ? `${name} (deg)` : name,
    shown: (u) => u * factor,
    isPeriodic: false,
    turns: 1,
    low,
    high,
    text: (u) => plain(isAngle ? (u * factor).toFixed(2) : (u * factor).toPrecision(DIGITS)),
    share: (u) => (u * factor - low) / (high - low),
  };
}

/** From where to where an axis goes that shows all places of an unknown on all tracks, with room around them. */
function shownRange(tracks, i, factor) {
  let [low, high] = [Infinity, -Infinity];
  for (const { samples } of tracks) {
    for (const { theta } of samples) {
      low = Math.min(low, theta[i] * factor);
      high = Math.max(high, theta[i] * factor);
    }
  }
  const middle = (low + high) / 2;
  const half = Math.max(0.55 * (high - low), 0.01 * Math.abs(factor));
  return [middle - half, middle + half];
}

/** No zero with a sign, and no power of ten for what is rounding. */
function plain(text) {
  const value = Number(text);
  return Math.abs(value) < 1e-12 ? "0" : text;
}
