// A branch as a piecewise polynomial of its arclength, evaluated as in bifurc/branch.py.

import { unpack } from "./arrays.js";

/** The curve of a form of the document. */
export function curveOf(form) {
  const { shape, values } = unpack(form.pieces);
  return {
    count: shape[0],
    order: shape[1] - 1,
    n: shape[2],
    pieces: values,
    breaks: form.breaks,
    centers: form.centers,
    radii: form.radii,
    travel: form.travel,
    closed: form.closed,
    length: form.length,
  };
}

/** The angles u(s), n numbers; s of a closed curve may lie beyond its length. */
export function evaluate(curve, s) {
  const { order, n, pieces, closed, length } = curve;
  const turns = closed ? Math.floor(s / length) : 0;
  const local = s - turns * length;
  const i = pieceAt(curve.breaks, curve.count, local);
  const x = (local - curve.centers[i]) / curve.radii[i];
  const out = new Float64Array(n);
  const begin = i * (order + 1) * n;
  for (let k = order; k >= 0; k -= 1) {
    for (let j = 0; j < n; j += 1) out[j] = out[j] * x + pieces[begin + k * n + j];
  }
  if (turns) for (let j = 0; j < n; j += 1) out[j] += turns * curve.travel[j];
  return out;
}

function pieceAt(breaks, count, s) {
  let low = 0;
  let high = count - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (breaks[middle] <= s) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Arclengths that show the whole curve: evenly spaced ones, and some on every piece. */
export function drawingArclengths(curve, even = 400, onPiece = 8) {
  const places = new Set();
  for (let k = 0; k <= even; k += 1) places.add((curve.length * k) / even);
  for (let i = 0; i < curve.count; i += 1) {
    const begin = curve.breaks[i];
    const step = (curve.breaks[i + 1] - begin) / onPiece;
    for (let k = 0; k < onPiece; k += 1) places.add(begin + k * step);
  }
  return [...places].sort((a, b) => a - b);
}
