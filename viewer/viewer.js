// The viewer: the linkage beside its map, kept together by one position.

import { arclengthText } from "./angles.js";
import { BranchChoice, FormTable, RouteBar } from "./choices.js";
import { leavingBranches, nextPass, passAt, passesOf } from "./crossings.js";
import { element } from "./elements.js";
import { FormGraph } from "./graph.js";
import { listenToKeys } from "./keyboard.js";
import { figureOf } from "./figures.js";
import { LinkageView } from "./linkage.js";
import { TransitionMap } from "./map.js";
import { DistanceBar, Numbers } from "./numbers.js";
import { principalPlane, unknownPlane } from "./planes.js";
import { Player } from "./player.js";
import { Position } from "./position.js";
import { arcsOf, lengthOf, middleOf, placeAlong, shortestRoute } from "./route.js";
import { Strip } from "./strip.js";
import { header, legend, MapTools, MotionTools, SpaceTools } from "./tools.js";
import { findTrack, inOrder, isCurve, tracksOf } from "./tracks.js";
import { followersOf, unknownsOf } from "./unknowns.js";

const GHOST_SPACING = 1 / 30; // of a form, between ghosts
const CHART_POINTS = 360;

function offersWebGL() {
  const context = document.createElement("canvas").getContext("webgl2");
  context?.getExtension("WEBGL_lose_context")?.loseContext(); // browsers allow but a few of them
  return Boolean(context);
}

export class Viewer {
  /** Show a document of linkages/viewing/document.py in `root`; keys are listened to at `keys`. */
  constructor(root, scene, keys = root) {
    this.root = root;
    this.scene = scene;
    this.tracks = tracksOf(scene);
    this.listed = inOrder(this.tracks);
    this.unknowns = unknownsOf(scene, this.tracks);
    this.figure = figureOf(scene);
    this.arcs = arcsOf(scene, this.tracks);
    this.passesByTrack = new Map(this.tracks.map((track) => [track, passesOf(scene, this.tracks, track)]));
    this.smallestByTrack = new Map();
    for (const point of scene.points) point.leaving = leavingBranches(point, this.tracks).length + point.surfaces.length;
    const first = this.listed[0];
    const [form, s] = scene.drawn?.place ?? [];
    this.position = form === undefined ? new Position(first, this.startOf(first)) : new Position(this.tracks[form], s);
    this.passes = (track) => this.passesByTrack.get(track);
    this.player = new Player(this.position, this.passes, () => this.showPlaying());
    this.player.onEnd = () => this.routeBar.say("arrived");
    this.build();
    this.position.subscribe((_, isNewTrack) => this.showPosition(isNewTrack));
    listenToKeys(keys, this);
    this.followTheme();
    this.showPosition(true);
  }

  // --- what stands where -------------------------------------------------------------

  build() {
    const { scene, tracks } = this;
    const actions = {
      goTo: (track, s) => this.goTo(track, s),
      goToPoint: (point) => this.goToPoint(point),
      goToPointCalled: (name) => this.goToPoint(scene.points.find((point) => point.name === name)),
      goToTrack: (track) => this.goToTrack(track),
    };
    this.space = element("div", { class: "bv-space" });
    this.mapBox = element("div", { class: "bv-map-box" });
    this.graphBox = element("div", { class: "bv-graph-box" });
    this.formTable = new FormTable(scene, this.listed, (track) => (isCurve(track) ? this.passes(track) : []), actions.goToTrack);
    this.choice = new BranchChoice(tracks, this.unknowns, (branch) => this.leave(branch));
    this.routeBar = new RouteBar(this.listed, (name) => this.playRoute(name));
    this.numbers = new Numbers(this.unknowns, followersOf(scene, tracks), this.figure);
    this.distanceBar = new DistanceBar(scene, this.passes, (_, s) => this.goTo(this.position.track, s));
    this.strip = new Strip(this.passes, (track) => this.smallestAlong(track), (track) => this.missesOn(track), {
      moved: (s) => this.goTo(this.position.track, s),
      goToPoint: (_, s) => this.goTo(this.position.track, s),
    });
    this.root.classList.add("bifurc-viewer");
    this.root.setAttribute("tabindex", "0");
    this.spaceTools = new SpaceTools(this.figure, this);
    this.mapTools = new MapTools(scene, this.unknowns, () => this.choosePlane());
    this.motionTools = new MotionTools(scene, this);
    const controls = [
      this.formTable.node,
      this.strip.node,
      this.motionTools.node,
      this.distanceBar.node,
      this.routeBar.node,
      this.numbers.node,
    ];
    this.root.append(
      header(scene, () => this.toggleTheme()),
      element("section", { class: "bv-left" }, this.spaceTools.node, this.space, element("div", { class: "bv-controls" }, ...controls)),
      element("section", { class: "bv-right" }, this.mapTools.node, this.mapBox, legend(scene), this.graphBox),
    );
    this.map = new TransitionMap(this.mapBox, scene, tracks, actions);
    this.graph = new FormGraph(this.graphBox, scene, tracks, actions);
    this.graphBox.classList.toggle("bv-hidden", !scene.graph.names.length);
    this.makeSpace();
    this.space.append(this.choice.node);
    this.choosePlane();
  }

  makeSpace() {
    if (offersWebGL()) {
      this.view = new LinkageView(this.space, this.scene, this.figure, this.listed);
      return;
    }
    const words = "The linkage cannot be drawn: this browser offers no WebGL 2. Map and numbers work without it.";
    this.space.append(element("p", { class: "bv-no-webgl" }, words));
  }

  choosePlane() {
    const { isPrincipal, chosen } = this.mapTools;
    const { unknowns, scene, tracks } = this;
    this.map.setPlane(isPrincipal ? principalPlane(scene.principal, unknowns, tracks) : unknownPlane(unknowns, ...chosen));
  }

  // --- colours -----------------------------------------------------------------------

  followTheme() {
    this.systemTheme = window.matchMedia("(prefers-color-scheme: dark)");
    this.onSystemTheme = () => this.setColors();
    this.systemTheme.addEventListener("change", this.onSystemTheme);
    this.setColors();
  }

  get isDark() {
    const chosen = this.root.dataset.theme;
    return chosen ? chosen === "dark" : this.systemTheme.matches;
  }

  toggleTheme() {
    this.root.dataset.theme = this.isDark ? "light" : "dark";
    this.setColors();
  }

  setColors() {
    this.root.classList.toggle("bv-dark", this.isDark);
    const style = getComputedStyle(this.root);
    const variable = (name) => style.getPropertyValue(name).trim();
    const colorOf = (track) => track?.form?.[this.isDark ? "dark_color" : "color"] ?? variable("--bv-muted");
    this.colorOf = colorOf;
    this.surroundings = {
      fixed: variable("--bv-fixed"),
      joint: variable("--bv-joint"),
      idle: variable("--bv-idle"),
      axis: variable("--bv-axis"),
      trace: variable("--bv-trace"),
    };
    for (const part of [this.formTable, this.choice, this.strip, this.graph, this.map]) part.setColors(colorOf);
    this.view?.setColors({ ...this.surroundings, link: colorOf(this.position.track) });
    this.showPoint();
  }

  // --- the position ------------------------------------------------------------------

  showPosition(isNewTrack) {
    const { position } = this;
    const { track, s } = position;
    const angles = position.angles;
    if (this.view && isNewTrack) {
      this.view.ghosts = [];
      this.view.colors = { ...this.surroundings, link: this.colorOf(track) };
    }
    if (isNewTrack) this.view?.follow(track);
    this.view?.show(angles, track.form?.inactive_joints);
    this.leaveGhost();
    this.map.show(position);
    this.graph.show(position);
    this.formTable.show(position);
    this.strip.show(position);
    this.numbers.show(angles, this.figure.singularValues(angles));
    this.distanceBar.show(position);
    this.showPoint();
    this.motionTools.show(position);
    this.root.dispatchEvent(new CustomEvent("bifurc-position", { detail: { form: track.name, s } }));
  }

  /** The branches to choose from, where the linkage is at a singular point. */
  showPoint() {
    const { track, s } = this.position;
    const here = isCurve(track) ? passAt(this.passes(track), track, s)?.point : track.samples[s]?.point;
    this.choice.show(here && here.leaving > 0 ? here : undefined);
  }

  leaveGhost() {
    if (!this.view || !this.ghostsAreOn) return;
    const { track, s } = this.position;
    const spacing = Math.max(GHOST_SPACING * track.length, 1e-9);
    const gap = Math.abs(s - (this.ghostPlace ?? Infinity));
    const away = track.closed ? Math.min(gap, track.length - gap) : gap;
    if (this.view.ghosts.length && away < spacing) return;
    this.ghostPlace = s;
    this.view.addGhost();
    this.view.update();
  }

  /** {s, value} of the smallest regular singular value along a form. */
  smallestAlong(track) {
    if (!this.smallestByTrack.has(track)) {
      const places = [];
      for (let k = 0; k <= CHART_POINTS; k += 1) places.push((track.length * k) / CHART_POINTS);
      for (const pass of this.passes(track)) places.push(pass.s);
      places.sort((a, b) => a - b);
      const drops = this.passes(track).filter(({ point }) => point.rank < track.form.rank);
      this.smallestByTrack.set(track, this.figure.smallestAlong(track, places, drops.map(({ s }) => s)));
    }
    return this.smallestByTrack.get(track);
  }

  missesOn(track) {
    return this.scene.near_misses.filter((miss) => this.tracks[miss.form] === track);
  }

  // --- actions -----------------------------------------------------------------------

  goTo(track, s) {
    this.player.stop();
    this.position.go(track, s);
  }

  goToTrack(track) {
    if (track === this.position.track) return;
    this.goTo(track, this.startOf(track));
  }

  /** Where a track is first shown: a mechanism where its document says, a loop in the middle of the longest arc. */
  startOf(track) {
    if (!isCurve(track)) return 0;
    return track.form.start ?? middleOf(this.arcs, track);
  }

  goToNumber(number) {
    const track = this.listed[number - 1];
    if (track) this.goToTrack(track);
  }

  /** Go to a singular point: along the form where it passes there, else on the first form that does. */
  goToPoint(point) {
    const { track, s } = this.position;
    const own = isCurve(track) ? this.passes(track).filter((pass) => pass.point === point) : [];
    if (own.length) {
      const nearest = own.reduce((best, pass) => (Math.abs(pass.s - s) < Math.abs(best.s - s) ? pass : best));
      this.goTo(track, nearest.s);
    } else if (point.passes.length) {
      const [form, place] = point.passes[0];
      this.goTo(this.tracks[form], place);
    } else {
      const list = this.tracks.find((candidate) => candidate.kind === "singular point");
      this.goTo(list, list.samples.findIndex((sample) => sample.point === point));
    }
  }

  goToNextPoint(direction) {
    const { track, s } = this.position;
    if (!isCurve(track)) this.goTo(track, s + direction);
    const next = isCurve(track) && nextPass(this.passes(track), track, s, direction);
    if (next) this.goTo(track, next.s);
  }

  /** Go to a track by its name or number, to the middle of its longest arc where `s` is left out. */
  goByName(name, s) {
    const track = this.trackCalled(name);
    if (s !== undefined && !Number.isFinite(s)) throw new RangeError(`s = ${s}: it must be a finite number`);
    this.goTo(track, s ?? (isCurve(track) ? middleOf(this.arcs, track) : 0));
  }

  /** The track of a name or number, as `findTrack`; throws a RangeError for another one. */
  trackCalled(name) {
    const track = findTrack(this.listed, name);
    if (track) return track;
    throw new RangeError(`form ${name}: it must be one of ${this.listed.map((one) => one.name).join(", ")}`);
  }

  /** Leave a singular point along a branch that it offers. */
  leave({ track, s, direction }) {
    this.player.stop();
    this.position.go(track, s, direction);
    if (isCurve(track)) this.player.play(direction);
  }

  /** Move on by a share of the form. */
  step(share) {
    const { track, s } = this.position;
    this.goTo(track, isCurve(track) ? s + share * track.length : s + Math.sign(share));
  }

  togglePlay() {
    if (this.player.isPlaying) this.player.stop();
    else this.player.play(Math.abs(this.position.direction));
  }

  playBackwards() {
    if (this.player.isPlaying) this.player.stop();
    else this.player.play(-1);
  }

  stop() {
    this.player.stop();
  }

  showPlaying() {
    this.motionTools.showPlaying(this.player.isPlaying);
  }

  /** The legs of the shortest route from here to the middle of a form's longest arc; undefined where there is none. */
  legsTo(name) {
    const { track, s } = this.position;
    const goal = this.trackCalled(name);
    if (!isCurve(goal) || !isCurve(track)) return undefined;
    return shortestRoute(this.arcs, { track, s }, { track: goal, s: middleOf(this.arcs, goal) });
  }

  /** The same as plain data. */
  routeTo(name) {
    const legs = this.legsTo(name);
    return legs && { length: lengthOf(legs), legs: legs.map(({ track, ...leg }) => ({ form: track.name, ...leg })) };
  }

  /** Play the route to a form, in so many seconds where they are given. */
  playRoute(name, seconds) {
    if (seconds != null && !(Number.isFinite(seconds) && seconds > 0)) {
      throw new RangeError(`seconds = ${seconds}: it must be a finite number above 0`);
    }
    const legs = this.legsTo(name);
    this.player.stop();
    if (!legs) {
      this.routeBar.say("there is no route along forms from here");
      return;
    }
    if (!legs.length) {
      this.routeBar.say("already there");
      return;
    }
    const through = legs.slice(0, -1).map((leg) => leg.at);
    const length = arclengthText(lengthOf(legs), this.scene);
    this.routeBar.say(`${length}${through.length ? ` through ${through.join(", ")}` : ""}`);
    const { leg, s, direction } = placeAlong(legs, 0);
    this.position.go(leg.track, s, direction);
    this.player.playRoute(legs, seconds);
  }

  toggleGhosts() {
    this.ghostsAreOn = !this.ghostsAreOn;
    this.spaceTools.showGhosts(this.ghostsAreOn);
    if (this.ghostsAreOn) this.leaveGhost();
    else this.view?.clearGhosts();
  }

  holdLink(frame) {
    this.view?.fixLink(frame);
  }

  holdNextLink() {
    this.holdLink(this.spaceTools.chooseNextLink());
  }

  resetView() {
    this.view?.resetView(this.scene);
  }

  dispose() {
    this.player.stop();
    this.systemTheme.removeEventListener("change", this.onSystemTheme);
    this.view?.dispose();
  }
}
