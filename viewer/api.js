// What a page offers to scripts, as `window.bifurc`.

import { isCurve } from "./tracks.js";

export function makeApi(viewer) {
  return {
    forms: viewer.listed.filter(isCurve).map(({ name, length, closed }) => ({ name, length, closed })),
    lists: viewer.listed.filter((track) => !isCurve(track)).map(({ name, samples }) => ({ name, count: samples.length })),
    points: viewer.scene.points.map(({ name, kind }) => ({ name, kind })),
    go: (form, s) => {
      viewer.goByName(form, s);
      return stateOf(viewer);
    },
    state: () => stateOf(viewer),
    rods: () => rodsOf(viewer),
    traced: () => viewer.view?.tracedPlaces,
    canvas: () => viewer.view?.canvasPlaces,
    play: () => viewer.player.play(),
    stop: () => viewer.stop(),
    route: (form) => viewer.routeTo(form),
    playRoute: (form, seconds) => viewer.playRoute(form, seconds),
    effort: () => viewer.view?.effort,
  };
}

function stateOf(viewer) {
  const { track, s, angles } = viewer.position;
  return {
    form: track.name,
    s,
    angles: Array.from(angles),
    ...viewer.figure.state(angles),
    playing: viewer.player.isPlaying,
  };
}

/** The rods that are drawn, as [[from, to], ...] in the user's unit and the frame of axes or bodies. */
function rodsOf({ figure, position }) {
  const { size } = figure;
  const { rods } = figure.parts(figure.frames(position.angles));
  return rods.map(({ from, to }) => [from, to].map((end) => end.map((x) => size * x)));
}
