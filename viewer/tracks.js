// Tracks: what a slider can run along. Forms and near motions are curves; a surface, the rigid assemblies and near
// surfaces are lists of configurations that are passed one by one.

import { unpackRows } from "./arrays.js";
import { curveOf, drawingArclengths, evaluate } from "./pieces.js";

/** All tracks of a document, the forms first. */
export function tracksOf(scene) {
  const tracks = scene.forms.map((form) => curveTrack("form", form));
  for (const surface of scene.surfaces) {
    tracks.push({ ...listTrack("surface", surface.name, unpackRows(surface.samples)), mobility: surface.dimension });
  }
  if (scene.assemblies.length) tracks.push({ ...listTrack("assembly", "rigid assemblies", scene.assemblies), mobility: 0 });
  for (const { name, sample, misclosure, curve } of scene.near_motions) {
    const track = curve ? curveTrack("near motion", curve) : listTrack("near motion", name, [sample]);
    tracks.push({ ...track, misclosure });
  }
  const alone = scene.points.filter((point) => !point.passes.length);
  if (alone.length) tracks.push(pointTrack(alone));
  if (!tracks.length) {
    tracks.push(listTrack("open", "open chain", [unassembled(scene)]));
  }
  return tracks;
}

/** All unknowns at 0. */
function unassembled({ loop, mechanism }) {
  return (loop?.lengths ?? mechanism.unknowns).map(() => 0);
}

function curveTrack(kind, form) {
  const curve = curveOf(form);
  const samples = drawingArclengths(curve).map((s) => ({ s, theta: evaluate(curve, s) }));
  return {
    kind,
    name: form.name,
    mobility: kind === "form" ? 1 : undefined,
    length: curve.length,
    closed: curve.closed,
    color: form.color,
    dashes: form.dashes,
    samples,
    at: (s) => evaluate(curve, s),
    place: (s) => (curve.closed ? modulo(s, curve.length) : clamp(s, 0, curve.length)),
    form,
  };
}

function listTrack(kind, name, configurations) {
  const last = configurations.length - 1;
  const nearest = (s) => Math.round(clamp(s, 0, last));
  return {
    kind,
    name,
    length: last,
    closed: false,
    color: null,
    dashes: [],
    samples: configurations.map((theta, s) => ({ s, theta })),
    at: (s) => configurations[nearest(s)],
    place: nearest,
    form: null,
  };
}

/** The singular points that no form passes, as a list; each sample knows its point. */
function pointTrack(points) {
  const track = listTrack("singular point", "singular points", points.map((point) => point.angles));
  points.forEach((point, k) => (track.samples[k].point = point));
  return track;
}

/** The tracks as they are listed and numbered: forms by their names, as in the summary, then near motions, then the
 *  others. */
export function inOrder(tracks) {
  const forms = tracks.filter((track) => track.kind === "form");
  forms.sort((a, b) => compareNames(a.name, b.name));
  const others = tracks.filter((track) => track.kind !== "form");
  return [...forms, ...others.filter(isCurve), ...others.filter((track) => !isCurve(track))];
}

/** Less than 0 where a name comes before another: Form 2 before Form 10, as linkages/app/forms.py has it. */
function compareNames(a, b) {
  const [one, other] = [a, b].map((name) => name.split(/([0-9]+)/)); // words and numbers in turn
  const k = one.findIndex((part, i) => part !== other[i]);
  if (k < 0 || other[k] === undefined) return one.length - other.length;
  if (k % 2) return Number(one[k]) - Number(other[k]);
  return one[k] < other[k] ? -1 : 1;
}

/** Whether the slider moves along the track without steps. */
export function isCurve(track) {
  return track.form !== null;
}

/** The track of a name, of the beginning of a name that only one has, or of a number from 1; undefined where none. */
export function findTrack(tracks, name) {
  if (typeof name === "number") return tracks[name - 1];
  const equal = tracks.filter((track) => track.name === name);
  if (equal.length) return equal[0];
  if (/^\d+$/.test(name)) return tracks[name - 1]; // as on the command line
  if (!String(name).trim()) return undefined; // every name contains it
  const beginning = tracks.filter((track) => beginsWith(track.name, name));
  if (beginning.length === 1) return beginning[0];
  const containing = tracks.filter((track) => track.name.toLowerCase().includes(String(name).toLowerCase()));
  return containing.length === 1 ? containing[0] : undefined;
}

function beginsWith(full, name) {
  const text = String(name).toLowerCase();
  return full.toLowerCase().startsWith(text) && !/[a-z0-9]/i.test(full.charAt(text.length));
}

/** What is left of a value after whole periods, from 0 on: exact before the last sum, however far away the value is. */
export function modulo(value, period) {
  const rest = value % period;
  const shifted = rest < 0 ? rest + period : rest;
  return shifted >= period ? 0 : shifted;
}

export function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}
