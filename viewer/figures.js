// What moves, as the picture and the scripts see it: frames of bodies at a configuration, and what is drawn of them.
//
// A figure has the frames of its bodies as the upper three rows of each transform, 12 numbers each, in characteristic
// lengths. `parts(frames)` are the {symbols, rods, panels, axes, seats, labels} of these frames: rods as {from, to,
// body}, panels as {corners, body}.

import { jointAxes, jointFrames, jointScrews, linkTable } from "./kinematics.js";
import { linkName } from "./angles.js";
import { drawnParts, seatHeights } from "./rods.js";
import { singularValues } from "./singular_values.js";
import { MechanismFigure, shortened } from "./mechanism.js";

const RODS_OF_JOINT = 3; // of a loop: two along axes, one along their normal

/** The figure of a document. */
export function figureOf(scene) {
  return scene.mechanism ? new MechanismFigure(scene.mechanism) : new LoopFigure(scene.loop);
}

/** A single loop of revolute joints; frame i is that of the link before joint i + 1. The unknowns `u` are its joint
 * angles, or those that its joints name. */
class LoopFigure {
  constructor(loop) {
    this.n = loop.lengths.length;
    this.joints = loop.joints ?? loop.lengths.map((_, i) => ({ name: String(i + 1), column: i, sign: 1, offset: 0 }));
    this.isNamed = loop.joints !== undefined;
    this.size = loop.size;
    this.table = linkTable(loop);
    this.unitTable = linkTable(loop, loop.size);
    this.heights = seatHeights(this.unitTable);
    this.names = this.joints.map(({ name }) => shortened(name));
    this.mostRods = RODS_OF_JOINT * this.n;
    this.shapes = { cylinder: this.n };
    this.mostAxes = this.n;
    this.panels = [];
    this.fixed = 0;
    this.fixedWord = "fixed link";
    this.valuesWord = this.isNamed ? "joint variables (deg)" : "joint angles (deg)";
  }

  /** What can be held still: names of links by the frames that they have. */
  get bodies() {
    const joints = Array.from({ length: this.n }, (_, frame) => (frame === 0 ? this.n : frame));
    if (!this.isNamed) return joints.map((joint) => linkName(joint, this.n));
    return joints.map((joint) => `${this.joints[joint - 1].name}–${this.joints[joint % this.n].name}`);
  }

  /** The body that has a frame: link i is that after joint i + 1. */
  bodyOf(frame) {
    return (frame + this.n - 1) % this.n;
  }

  /** The joint angles at unknowns `u`. */
  angles(u) {
    return this.joints.map(({ column, sign, offset }) => offset + sign * u[column]);
  }

  frames(u) {
    return jointFrames(this.unitTable, this.angles(u));
  }

  parts(frames) {
    const { joints, rods, axes } = drawnParts(this.unitTable, frames, this.heights);
    const symbols = joints.map(({ seat, direction }, i) => ({
      shape: "cylinder",
      seat,
      direction,
      columns: [this.joints[i].column],
    }));
    const labels = axes.map(([, place]) => ({ place, lift: 0 }));
    return { symbols, rods, panels: [], axes, seats: joints.map((joint) => joint.seat), labels };
  }

  /** What a state says of a configuration. */
  state(u) {
    const frames = jointFrames(this.table, this.angles(u));
    return { axes: jointAxes(frames), end: Array.from(frames.slice(-12)), singular_values: this.singularValues(u) };
  }

  singularValues(u) {
    return singularValues(jointScrews(this.frames(u)));
  }

  /** The smallest regular singular value at places of a track, as {s, value}. */
  smallestAlong(track, places) {
    return places.map((s) => ({ s, value: this.singularValues(track.at(s))[track.form.rank - 1] }));
  }
}
