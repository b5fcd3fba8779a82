// What is drawn of a configuration: rods along offsets and common normals, the seats of the joints on their axes, and
// the axes. Plain numbers, no graphics.

import { axisDirection, frameOrigin } from "./kinematics.js";

const NOTHING = 1e-9; // of the size of the loop: shorter rods are not drawn
const ASIDE = 0.7; // how far along its axis a joint sits where links without length meet, in the size of the loop
const REACH = 0.22; // of the extent: how far an axis is drawn beyond its joint

/** The height of each joint on its axis over the foot of the normal before it, for a table of lengths near 1.
 *
 * A joint sits in the middle of its offset. Where two axes meet in a point and neither has an offset, their joints
 * would be in one place: both move out along their axes, and the link is the chord between them.
 */
export function seatHeights(table) {
  const heights = table.offsets.map((offset) => offset / 2);
  const isSpherical = [...table.lengths, ...table.offsets].every(isNothing);
  for (let i = 0; i < table.n; i += 1) {
    if (!isChord(table, i)) continue;
    const next = (i + 1) % table.n;
    heights[i] = heights[next] = isSpherical ? 1 : ASIDE;
  }
  return apartOnOneLine(table, heights);
}

/** The heights where joints that turn about the same line stand beside each other. */
function apartOnOneLine(table, heights) {
  const out = [...heights];
  for (let i = 0; i + 1 < table.n; i += 1) {
    const isOneLine = isNothing(table.lengths[i]) && isNothing(table.sines[i]);
    if (isOneLine && isChord(table, i)) out[i + 1] = out[i] * table.cosines[i] + ASIDE / 2;
  }
  return out;
}

/** Whether link i + 1 has no length, and no offset at either end. */
function isChord(table, i) {
  return isNothing(table.lengths[i]) && isNothing(table.offsets[i]) && isNothing(table.offsets[(i + 1) % table.n]);
}

/** {joints: [{seat, direction}], rods: [{from, to, body}], axes: [[from, to]]} of a configuration; bodies are links, from 0. */
export function drawnParts(table, frames, heights) {
  const { n } = table;
  const joints = [];
  for (let i = 0; i <= n; i += 1) {
    const origin = frameOrigin(frames, i);
    const direction = axisDirection(frames, i);
    joints.push({ origin, direction, seat: along(origin, direction, heights[i % n]) });
  }
  const rods = [];
  for (let i = 0; i < n; i += 1) rods.push(...rodsOfLink(table, joints, i));
  const extent = extentOf(joints);
  const axes = joints.slice(0, n).map((joint, i) => {
    const half = Math.abs(table.offsets[i]) / 2 + REACH * extent;
    const isAside = !isNothing(heights[i] - table.offsets[i] / 2);
    const begin = isAside ? joint.origin : along(joint.seat, joint.direction, -half);
    return [begin, along(joint.seat, joint.direction, half)];
  });
  return { joints: joints.slice(0, n), rods, axes };
}

/** The rods of the link from joint i on: along its axis, the common normal, and along the next axis. */
function rodsOfLink(table, joints, i) {
  const joint = joints[i];
  const next = joints[i + 1];
  if (isChord(table, i)) return [{ from: joint.seat, to: next.seat, body: i }];
  const foot = along(joint.origin, joint.direction, table.offsets[i]);
  const corners = [joint.seat, foot, next.origin, next.seat];
  const rods = [];
  for (let k = 0; k < 3; k += 1) {
    const [from, to] = [corners[k], corners[k + 1]];
    if (distance(from, to) > NOTHING) rods.push({ from, to, body: i });
  }
  return rods;
}

function extentOf(joints) {
  const middle = [0, 1, 2].map((k) => joints.reduce((sum, joint) => sum + joint.seat[k], 0) / joints.length);
  return Math.max(...joints.map((joint) => distance(joint.seat, middle)));
}

function isNothing(value) {
  return Math.abs(value) < NOTHING;
}

export function along(point, direction, height) {
  return [0, 1, 2].map((k) => point[k] + height * direction[k]);
}

export function distance(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
