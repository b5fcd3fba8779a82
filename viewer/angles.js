// Angles on the screen: degrees, above -180 and up to 180.

export const DEGREES = 180 / Math.PI;
const SEAM = 1e-12; // of a turn, so near to an end lies at the end

/** An angle (rad) within (-pi, pi]; what lies at either end comes out at pi. */
export function wrapped(angle) {
  const within = angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
  return Math.abs(within) >= (0.5 - SEAM) * 2 * Math.PI ? Math.PI : within;
}

/** An angle (rad) in degrees with so many digits, and no negative zero. */
export function inDegrees(angle, digits = 2) {
  const shown = (wrapped(angle) * DEGREES).toFixed(digits);
  const zero = (0).toFixed(digits);
  if (shown === `-${zero}`) return zero;
  return shown === (-180).toFixed(digits) ? (180).toFixed(digits) : shown;
}

/** An arclength as text: in degrees where all unknowns of a scene are angles. */
export function arclengthText(length, scene) {
  const isAngular = !scene.mechanism || scene.mechanism.unknowns.every((unknown) => unknown.is_angle);
  return isAngular ? `${(length * DEGREES).toFixed(1)}°` : length.toPrecision(4);
}

const SUBSCRIPTS = "₀₁₂₃₄₅₆₇₈₉";

/** The name of the angle of a joint, counted from 1. */
export function angleName(joint) {
  return `θ${[...String(joint)].map((digit) => SUBSCRIPTS[digit]).join("")}`;
}

/** The link that follows a joint (from 1), as elsewhere: "12", or "9-10" where numbers have two digits. */
export function linkName(joint, n) {
  return `${joint}${n > 9 ? "-" : ""}${(joint % n) + 1}`;
}
