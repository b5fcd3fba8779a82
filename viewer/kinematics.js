// Forward kinematics of a loop: the transform of joint i and its link is
// Rz(theta_i) Tz(R_i) Tx(a_i) Rx(alpha_i), as in linkages/kinematics.py.

/** The table of a loop with what the transforms read of it, lengths divided by `unit`. */
export function linkTable(loop, unit = 1) {
  return {
    n: loop.lengths.length,
    lengths: loop.lengths.map((length) => length / unit),
    offsets: loop.offsets.map((offset) => offset / unit),
    cosines: loop.twists.map(Math.cos),
    sines: loop.twists.map(Math.sin),
  };
}

/** Frames 0 to n, before each joint is turned, as the upper three rows of each transform: 12 (n + 1) numbers. */
export function jointFrames(table, theta) {
  const { n, lengths, offsets, cosines, sines } = table;
  const frames = new Float64Array(12 * (n + 1));
  frames[0] = frames[5] = frames[10] = 1;
  for (let i = 0; i < n; i += 1) {
    const c = Math.cos(theta[i]);
    const s = Math.sin(theta[i]);
    const ca = cosines[i];
    const sa = sines[i];
    for (let row = 0; row < 3; row += 1) {
      const at = 12 * i + 4 * row;
      const x = frames[at];
      const y = frames[at + 1];
      const z = frames[at + 2];
      const next = at + 12;
      const across = -s * x + c * y;
      frames[next] = c * x + s * y;
      frames[next + 1] = ca * across + sa * z;
      frames[next + 2] = ca * z - sa * across;
      frames[next + 3] = frames[at + 3] + lengths[i] * frames[next] + offsets[i] * z;
    }
  }
  return frames;
}

/** The origin of frame i. */
export function frameOrigin(frames, i) {
  const at = 12 * i;
  return [frames[at + 3], frames[at + 7], frames[at + 11]];
}

/** The axis of joint i + 1: the z axis of frame i. */
export function axisDirection(frames, i) {
  const at = 12 * i;
  return [frames[at + 2], frames[at + 6], frames[at + 10]];
}

/** The joint axes as [[point, direction], ...] in the frame of the link that joins the last joint to the first. */
export function jointAxes(frames) {
  const axes = [];
  for (let i = 0; i < frames.length / 12 - 1; i += 1) {
    axes.push([frameOrigin(frames, i), axisDirection(frames, i)]);
  }
  return axes;
}

/** The joint screws as columns [direction, moment] of six numbers: the Jacobian of closure. */
export function jointScrews(frames) {
  return jointAxes(frames).map(([p, d]) => [...d, ...cross(p, d)]);
}

/** The product of two transforms of 12 numbers each. */
export function compose(a, b) {
  const out = new Float64Array(12);
  for (let row = 0; row < 3; row += 1) {
    for (let column = 0; column < 4; column += 1) {
      let sum = column === 3 ? a[4 * row + 3] : 0;
      for (let k = 0; k < 3; k += 1) sum += a[4 * row + k] * b[4 * k + column];
      out[4 * row + column] = sum;
    }
  }
  return out;
}

/** The inverse of a transform of 12 numbers. */
export function invert(a) {
  const out = new Float64Array(12);
  for (let row = 0; row < 3; row += 1) {
    for (let k = 0; k < 3; k += 1) {
      out[4 * row + k] = a[4 * k + row];
      out[4 * row + 3] -= a[4 * k + row] * a[4 * k + 3];
    }
  }
  return out;
}

/** A point moved by a transform of 12 numbers. */
export function moved(a, p) {
  const out = [0, 0, 0];
  for (let row = 0; row < 3; row += 1) {
    const at = 4 * row;
    out[row] = a[at] * p[0] + a[at + 1] * p[1] + a[at + 2] * p[2] + a[at + 3];
  }
  return out;
}

function cross(p, d) {
  return [p[1] * d[2] - p[2] * d[1], p[2] * d[0] - p[0] * d[2], p[0] * d[1] - p[1] * d[0]];
}
