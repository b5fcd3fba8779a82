// The singular points that a form passes: which is next, and which branches leave one.

import { modulo } from "./tracks.js";

const AT_POINT = 1e-6; // of the length of a form: so near to a singular point is at it

/** The passes of a track as {point, s}, in order. */
export function passesOf(scene, tracks, track) {
  const passes = [];
  for (const point of scene.points) {
    for (const [form, s] of point.passes) {
      if (tracks[form] === track) passes.push({ point, s: track.place(s) });
    }
  }
  return passes.sort((a, b) => a.s - b.s);
}

/** The pass at which a place of a track lies, if any. */
export function passAt(passes, track, s) {
  return passes.find((pass) => distance(track, pass.s, s) <= AT_POINT * track.length);
}

function distance(track, a, b) {
  const gap = Math.abs(a - b);
  return track.closed ? Math.min(gap, track.length - gap) : gap;
}

/** The next pass from a place in a direction, and how far it is; undefined where there is none. */
export function nextPass(passes, track, s, direction) {
  let best;
  for (const pass of passes) {
    let ahead = direction * (pass.s - s);
    if (track.closed) ahead = modulo(ahead, track.length);
    const isHere = ahead <= AT_POINT * track.length || track.length - ahead <= AT_POINT * track.length;
    if (isHere && track.closed) ahead = track.length;
    if (ahead <= (track.closed ? 0 : AT_POINT * track.length)) continue;
    if (!best || ahead < best.ahead) best = { point: pass.point, s: pass.s, ahead };
  }
  return best;
}

/** The half-branches that leave a singular point: {track, s, direction}, two for every pass but at ends of forms. */
export function leavingBranches(point, tracks) {
  const branches = [];
  for (const [form, s] of point.passes) {
    const track = tracks[form];
    const place = track.place(s);
    const near = AT_POINT * track.length;
    if (track.closed || place < track.length - near) branches.push({ track, s: place, direction: 1 });
    if (track.closed || place > near) branches.push({ track, s: place, direction: -1 });
  }
  return branches;
}
