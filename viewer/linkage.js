// The linkage in space: rods, joints and axes as a handful of instanced meshes, numbers as labels over the picture.

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  DoubleSide,
  HemisphereLight,
  InstancedMesh,
  LineBasicMaterial,
  LineDashedMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Quaternion,
  Scene,
  ShapeUtils,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { compose, invert, moved } from "./kinematics.js";
import { distance } from "./rods.js";
import { element } from "./elements.js";
import { isCurve } from "./tracks.js";

const MOST_GHOSTS = 8;
const FIELD_OF_VIEW = 26; // degrees
const FRAMING_SAMPLES = 60; // places of a track, at least, that must all be in the picture
const MARGIN = 1.05; // around these, in their radius: for the places between
const NUMBER_ROOM = 22; // pixels that stay free for numbers on each side
const BALL_ROUNDS = 100;
const ROUNDS_APART = 60; // in which names are pushed away from each other
const LEAST_AWAY = 1; // in the radius of all positions: a linkage that is seen as a line is not blown up
const JOINT_LENGTH = 1.7; // of half the cylinder of a joint, in its radius
const JOINT_REACH = Math.hypot(JOINT_LENGTH, 1); // of its farthest corner from its seat
const PALE = 0.45; // how white panels are beside their outlines
const LEVELS = 6; // of thickness, so that rods of several bodies are told apart that lie in each other
const THICKER = 0.06; // a level than the one below: rods have 14 sides, which lie within 0.025 of their radius
const LETTER = 9; // pixels: the width of a letter of a name
const NAME_GAP = 17; // pixels between the middles of two names, one above the other
const BESIDE_JOINT = 9; // pixels between the edge of a joint and the middle of its name
const FARTHEST = 3; // of a name's place from where it belongs, in NAME_GAP beyond its own width
const MANY_NAMES = 30; // more of them appear near the pointer only
const [NEAR, MOST_NEAR] = [70, 6]; // pixels; names that are shown there
const MANY_RODS = 300; // more of them are drawn with fewer sides
// symbols of joints, their axis along y, of the size of a joint's radius and of length 1
const SHAPES = {
  cylinder: () => new CylinderGeometry(1, 1, 1, 24),
  box: () => new BoxGeometry(3.4, 1.7, 3.4),
  plate: () => new BoxGeometry(7, 0.25, 7),
  ball: () => new SphereGeometry(1.5, 20, 14).scale(1, 0.5 / JOINT_LENGTH, 1),
};
const DOT = 1.3; // the radius of a traced point, in that of a joint
const LIFT = 20; // pixels: how far its name stands above it
const UP = new Vector3(0, 1, 0); // the axis of a cylinder of three.js

export class LinkageView {
  /** A view in `container` of the figure of a scene, with room for all its tracks. */
  constructor(container, scene, figure, tracks) {
    this.container = container;
    this.tracks = tracks;
    this.figure = figure;
    this.fixed = figure.fixed; // the number of the frame that stands still
    this.hold = identity();
    this.traced = scene.trace.map((point) => tracedPoint(point, figure));
    this.ghosts = [];
    this.colors = { link: "#0072B2", fixed: "#888", joint: "#333", idle: "#999", axis: "#888", trace: "#c2185b" };
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("aria-label", "the linkage in space; drag to turn it");
    this.labels = element("div", { class: "bv-labels" });
    container.append(this.canvas, this.labels);
    this.jointSize = scene.joint_radius / figure.size;
    this.makeScene();
    this.makeLabels();
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
    this.camera.up.set(...scene.view.up);
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.addEventListener("change", () => this.requestFrame());
    this.canvas.addEventListener("webglcontextrestored", () => this.requestFrame());
    this.fit(lookOf(scene.view));
    new ResizeObserver(() => this.resize()).observe(container);
  }

  makeScene() {
    this.scene = new Scene();
    this.scene.add(new HemisphereLight(0xffffff, 0xb0b0b0, 2.9));
    this.lamp = new DirectionalLight(0xffffff, 1.1);
    this.scene.add(this.lamp, this.lamp.target);
    const { mostRods, mostAxes, shapes } = this.figure;
    const [around, upright] = mostRods > MANY_RODS ? [6, 4] : [14, 10];
    const rod = new CylinderGeometry(1, 1, 1, around, 1, true); // elbows close its ends
    this.rods = instances(rod, mostRods);
    this.elbows = instances(new SphereGeometry(1, around, upright), 2 * mostRods);
    this.symbols = Object.entries(shapes).map(([shape, count]) => ({ shape, mesh: instances(SHAPES[shape](), count) }));
    this.ghostRods = instances(rod, mostRods * MOST_GHOSTS);
    this.ghostRods.material.transparent = true;
    this.ghostRods.material.opacity = 0.22;
    this.ghostRods.material.depthWrite = false;
    const lines = new BufferGeometry();
    lines.setAttribute("position", new BufferAttribute(new Float32Array(6 * mostAxes), 3));
    this.axes = new LineSegments(lines, new LineDashedMaterial({ dashSize: 0.05, gapSize: 0.03 }));
    this.axes.frustumCulled = false;
    this.makePanels();
    this.dots = instances(new SphereGeometry(1, 20, 14), this.traced.length);
    this.paths = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.paths.frustumCulled = false;
    this.scene.add(this.dots, this.paths);
    this.scene.add(this.rods, this.elbows, ...this.symbols.map(({ mesh }) => mesh), this.ghostRods, this.axes, this.panels);
  }

  /** The panels of all bodies as one mesh of triangles, each with its own three vertices. */
  makePanels() {
    this.triangles = this.figure.panels.flatMap(({ corners }, panel) => trianglesOf(corners).map((corner) => ({ panel, corner })));
    const geometry = new BufferGeometry();
    const count = 9 * this.triangles.length;
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(count), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(count), 3));
    const material = new MeshLambertMaterial({ side: DoubleSide, flatShading: true, vertexColors: true });
    this.panels = new Mesh(geometry, material);
    this.panels.frustumCulled = false;
  }

  makeLabels() {
    this.numbers = [];
    for (const name of [...this.figure.names, ...this.traced.map((point) => point.name)]) {
      const label = element("span", { class: "bv-joint-number" }, name);
      this.numbers.push(label);
      this.labels.append(label);
    }
    const longest = this.figure.names.reduce((most, name) => Math.max(most, name.length), 0);
    this.nameWidth = Math.max(LETTER * longest + 3, NAME_GAP);
    if (this.numbers.length <= MANY_NAMES) return;
    this.pointer = { x: Infinity, y: Infinity };
    this.container.addEventListener("pointermove", (event) => this.pointAt(event));
    this.container.addEventListener("pointerdown", (event) => this.pointAt(event)); // a finger does not hover
    this.container.addEventListener("pointerleave", () => this.pointAt({ clientX: Infinity, clientY: Infinity }));
  }

  /** Show the names near the pointer. */
  pointAt({ clientX, clientY }) {
    const { left, top } = this.container.getBoundingClientRect();
    this.pointer = { x: clientX - left, y: clientY - top };
    this.placeLabels();
  }

  /** The colours of the picture: {link, fixed, joint, idle, axis, trace}. */
  setColors(colors) {
    this.colors = colors;
    this.update();
  }

  /** Keep the body of this frame still, where it now is. */
  fixLink(frame) {
    this.hold = this.poseOf(this.frames, frame);
    this.fixed = frame;
    this.ghosts = [];
    this.fit(this.lookNow());
    this.placePaths();
    this.update();
  }

  /** Draw the paths that traced points have along a track. */
  follow(track) {
    this.track = track;
    this.placePaths();
  }

  /** Where the traced points are in frames of a configuration, as the picture has them. */
  tracedIn(frames) {
    return this.traced.map(({ frame, place }) => moved(this.poseOf(frames, frame), place));
  }

  /** The paths (a list of places each) of the traced points along the track; none along a list of configurations. */
  pathsOfTrack() {
    if (!this.traced.length || !isCurve(this.track)) return this.traced.map(() => []);
    const rows = this.track.samples.map(({ theta }) => this.tracedIn(this.figure.frames(theta)));
    return this.traced.map((_, k) => rows.map((row) => row[k]));
  }

  /** The frames of a configuration as the picture has them. */
  poseOf(frames, frame) {
    return compose(this.worldOf(frames), frames.slice(12 * frame, 12 * frame + 12));
  }

  worldOf(frames) {
    return compose(this.hold, invert(frames.slice(12 * this.fixed, 12 * this.fixed + 12)));
  }

  /** The drawn parts of a configuration, in the picture's frame. */
  partsOf(theta) {
    const frames = this.figure.frames(theta);
    const world = this.worldOf(frames);
    const turned = new Float64Array(frames.length);
    for (let at = 0; at < frames.length; at += 12) {
      turned.set(compose(world, frames.slice(at, at + 12)), at);
    }
    return { frames, parts: this.figure.parts(turned), traced: this.tracedIn(frames) };
  }

  /** Show a configuration; `idle` are the unknowns (from 1) that stand still along its form. */
  show(theta, idle = []) {
    this.theta = theta;
    this.idle = new Set(idle);
    this.update();
  }

  addGhost() {
    this.ghosts.push(Float64Array.from(this.theta));
    if (this.ghosts.length > MOST_GHOSTS) this.ghosts.shift();
  }

  clearGhosts() {
    this.ghosts = [];
    this.update();
  }

  // --- the picture -----------------------------------------------------------------

  /** Have all positions along all tracks in the picture, seen along `look`. */
  fit(look) {
    const points = [];
    const seats = [];
    for (const { samples } of this.tracks) {
      const step = Math.max(1, Math.floor(samples.length / FRAMING_SAMPLES));
      for (let k = 0; k < samples.length; k += step) {
        const { parts, traced } = this.partsOf(samples[k].theta);
        seats.push(...parts.seats, ...traced);
        for (const rod of parts.rods) points.push(rod.from, rod.to);
        for (const axis of parts.axes) points.push(...axis);
      }
    }
    const ball = enclosingBall([...seats, ...points]);
    this.center = ball.center;
    this.unit = ball.radius || 1;
    this.jointRadius = this.jointSize / this.unit;
    this.rodRadius = 0.42 * this.jointRadius;
    const reach = JOINT_REACH * this.jointRadius;
    this.spots = [
      ...seats.map((seat) => ({ place: this.scaled(seat), reach })),
      ...points.map((point) => ({ place: this.scaled(point), reach: this.rodRadius })),
    ];
    this.look = look;
    this.placeCamera();
  }

  /** From where the picture is seen now. */
  lookNow() {
    return this.camera.position.clone().sub(this.orbit.target).normalize();
  }

  /** The camera as near as it may be so that all spots are on the canvas, with room for numbers, and its target in the
   * middle of them. */
  placeCamera() {
    const { clientWidth: width, clientHeight: height } = this.container;
    const upward = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const [right, up] = [new Vector3(), new Vector3()];
    new Matrix4().lookAt(this.look, new Vector3(), this.camera.up).extractBasis(right, up, new Vector3());
    const across = spanOf(this.spots, right, this.look, upward * this.camera.aspect * usable(width));
    const above = spanOf(this.spots, up, this.look, upward * usable(height));
    const away = MARGIN * Math.max(across.away, above.away, LEAST_AWAY);
    this.orbit.target.copy(right.multiplyScalar(across.middle)).add(up.multiplyScalar(above.middle));
    this.camera.position.copy(this.look).multiplyScalar(away).add(this.orbit.target);
    this.camera.far = 10 * away;
    this.camera.updateProjectionMatrix();
    this.orbit.minDistance = 0.2;
    this.orbit.maxDistance = 6 * away;
    this.orbit.update();
  }

  /** See the linkage from where it is clearest again. */
  resetView(scene) {
    this.fit(lookOf(scene.view));
    this.placePaths();
    this.update();
  }

  update() {
    if (!this.theta) return;
    const { frames, parts, traced } = this.partsOf(this.theta);
    this.frames = frames;
    this.placeRods(this.rods, parts.rods, 0, this.rodRadius);
    this.rods.count = parts.rods.length;
    this.colorRods(parts.rods);
    this.placeElbows(parts.rods);
    for (const { shape, mesh } of this.symbols) {
      this.placeSymbols(mesh, parts.symbols.filter((symbol) => symbol.shape === shape));
    }
    this.placePanels(parts.panels);
    this.placeAxes(parts.axes);
    this.placeGhosts();
    this.placeDots(traced);
    const labels = [...parts.labels, ...traced.map((place) => ({ place, lift: LIFT }))];
    const seats = [...parts.seats, ...traced];
    this.labelPlaces = labels.map(({ place, lift }, i) => ({ place: this.scaled(place), seat: this.scaled(seats[i]), lift }));
    this.requestFrame();
  }

  scaled(point) {
    return new Vector3(...point.map((x, k) => (x - this.center[k]) / this.unit));
  }

  placeRods(mesh, rods, first, radius) {
    rods.forEach((rod, k) => {
      mesh.setMatrixAt(first + k, rodMatrix(this.scaled(rod.from), this.scaled(rod.to), radius * thicknessOf(rod.body)));
    });
    mesh.instanceMatrix.needsUpdate = true;
  }

  /** Bodies in the colour of the form; the one that stands still in grey. */
  colorRods(rods) {
    if (!rods.length) return;
    const still = this.figure.bodyOf(this.fixed);
    const color = new Color();
    rods.forEach((rod, k) => {
      color.set(rod.body === still ? this.colors.fixed : this.colors.link);
      this.rods.setColorAt(k, color);
      this.elbows.setColorAt(2 * k, color);
      this.elbows.setColorAt(2 * k + 1, color);
    });
    this.rods.instanceColor.needsUpdate = true;
    this.elbows.instanceColor.needsUpdate = true;
  }

  placeElbows(rods) {
    const matrix = new Matrix4();
    rods.forEach((rod, k) => {
      const size = new Vector3().setScalar(this.rodRadius * thicknessOf(rod.body));
      [rod.from, rod.to].forEach((end, side) => {
        matrix.compose(this.scaled(end), new Quaternion(), size);
        this.elbows.setMatrixAt(2 * k + side, matrix);
      });
    });
    this.elbows.count = 2 * rods.length;
    this.elbows.instanceMatrix.needsUpdate = true;
  }

  /** The symbols of joints of one shape; pale where all unknowns of a joint stand still. */
  placeSymbols(mesh, symbols) {
    const color = new Color();
    symbols.forEach(({ seat, direction, columns }, i) => {
      const half = (direction ? new Vector3(...direction) : UP.clone()).multiplyScalar(JOINT_LENGTH * this.jointRadius);
      const middle = this.scaled(seat);
      const [from, to] = [middle.clone().sub(half), middle.clone().add(half)];
      mesh.setMatrixAt(i, rodMatrix(from, to, this.jointRadius));
      const isIdle = columns?.every((column) => this.idle.has(column + 1));
      color.set(isIdle ? this.colors.idle : this.colors.joint);
      mesh.setColorAt(i, color);
    });
    mesh.count = symbols.length;
    mesh.instanceMatrix.needsUpdate = true;
    mesh.instanceColor.needsUpdate = true;
  }

  /** The panels, paler than their outlines. */
  placePanels(panels) {
    const { position, color } = this.panels.geometry.attributes;
    const still = this.figure.bodyOf(this.fixed);
    const white = new Color("#fff");
    const colors = panels.map(({ body }) => new Color(body === still ? this.colors.fixed : this.colors.link).lerp(white, PALE));
    this.triangles.forEach(({ panel, corner }, k) => {
      position.setXYZ(k, ...this.scaled(panels[panel].corners[corner]));
      color.setXYZ(k, colors[panel].r, colors[panel].g, colors[panel].b);
    });
    position.needsUpdate = true;
    color.needsUpdate = true;
  }

  placeAxes(axes) {
    const position = this.axes.geometry.attributes.position;
    axes.flat().forEach((end, k) => position.setXYZ(k, ...this.scaled(end)));
    position.needsUpdate = true;
    this.axes.computeLineDistances();
    this.axes.material.color.set(this.colors.axis);
  }

  /** The paths of the traced points, each from place to place. */
  placePaths() {
    const ends = this.pathsOfTrack().flatMap((path) => path.slice(1).flatMap((place, k) => [path[k], place]));
    this.paths.geometry.dispose();
    this.paths.geometry = new BufferGeometry().setFromPoints(ends.map((place) => this.scaled(place)));
  }

  placeDots(traced) {
    const size = new Vector3().setScalar(DOT * this.jointRadius);
    traced.forEach((place, k) => {
      this.dots.setMatrixAt(k, new Matrix4().compose(this.scaled(place), new Quaternion(), size));
    });
    this.dots.count = traced.length;
    this.dots.instanceMatrix.needsUpdate = true;
    for (const { material } of [this.dots, this.paths]) material.color.set(this.colors.trace);
  }

  placeGhosts() {
    let count = 0;
    for (const theta of this.ghosts) {
      const { rods } = this.partsOf(theta).parts;
      this.placeRods(this.ghostRods, rods, count, this.rodRadius);
      count += rods.length;
    }
    this.ghostRods.count = count;
    this.ghostRods.visible = count > 0;
    this.ghostRods.material.color.set(this.colors.link);
  }

  // --- frames ----------------------------------------------------------------------

  resize() {
    const { clientWidth: width, clientHeight: height } = this.container;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.look = this.lookNow();
    this.placeCamera();
    this.draw();
  }

  requestFrame() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.draw();
    });
  }

  draw() {
    if (!this.labelPlaces || this.isGone) return;
    this.lamp.position.copy(this.camera.position).add(new Vector3(0.6, 0.3, 1.2));
    this.renderer.render(this.scene, this.camera);
    this.placeLabels();
  }

  /** The names at the ends of the axes and beside the joints, pushed apart where they would overlap. Where there is no
   * room for all, some are left out; of many only those near the pointer are shown. */
  placeLabels() {
    if (!this.labelPlaces) return;
    const { clientWidth: width, clientHeight: height } = this.container;
    const wanted = this.wantedSpots();
    const chosen = this.pointer ? nearestFirst(wanted, this.pointer) : [...wanted.keys()];
    const spots = chosen.map((i) => ({ ...wanted[i] }));
    if (!this.figure.panels.length) pushApart(spots, this.nameWidth, NAME_GAP); // creases are next to each other
    const shown = new Map();
    spots.forEach(({ x, y }, k) => {
      const i = chosen[k];
      const half = (LETTER * this.numbers[i].textContent.length) / 2;
      const edge = Math.max(half, 10);
      const spot = { x: Math.min(Math.max(x, edge), width - edge), y: Math.min(Math.max(y, 10), height - 10), half };
      const strayed = Math.hypot(spot.x - wanted[i].x, spot.y - wanted[i].y) > this.nameWidth + FARTHEST * NAME_GAP;
      const isFull = this.pointer && shown.size === MOST_NEAR;
      if (!strayed && !isFull && [...shown.values()].every((other) => !cover(spot, other))) shown.set(i, spot);
    });
    this.numbers.forEach((number, i) => {
      const spot = shown.get(i);
      number.classList.toggle("bv-hidden", !spot);
      if (spot) number.style.transform = `translate(-50%, -50%) translate(${spot.x.toFixed(1)}px, ${spot.y.toFixed(1)}px)`;
    });
  }

  /** Where names belong, in pixels: at the ends of axes, and beside joints whose axes are seen end on. */
  wantedSpots() {
    const seats = this.labelPlaces.map(({ seat }) => this.spotOf(seat));
    const middle = { x: mean(seats.map(({ x }) => x)), y: mean(seats.map(({ y }) => y)) };
    const gap = this.pixelsOf(JOINT_LENGTH * this.jointRadius) + BESIDE_JOINT;
    return this.labelPlaces.map(({ place, lift }, i) => {
      const { x, y } = this.spotOf(place);
      const seat = seats[i];
      if (Math.hypot(x - seat.x, y - lift - seat.y) >= gap) return { x, y: y - lift };
      const [outX, outY] = [seat.x - middle.x, seat.y - middle.y];
      const out = Math.hypot(outX, outY);
      if (out < 1) return { x: seat.x, y: seat.y - gap };
      return { x: seat.x + (gap * outX) / out, y: seat.y + (gap * outY) / out };
    });
  }

  /** How many pixels a length takes that is as far away as the middle of the picture. */
  pixelsOf(length) {
    const away = this.camera.position.distanceTo(this.orbit.target);
    return (length * this.container.clientHeight) / (2 * away * Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
  }

  /** Where a place of the picture is on the canvas, in pixels from its upper left corner. */
  spotOf(place) {
    const { clientWidth: width, clientHeight: height } = this.container;
    const p = place.clone().project(this.camera);
    return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height };
  }

  /** The size of the canvas and where the joints are on it, in pixels. */
  get canvasPlaces() {
    const { clientWidth: width, clientHeight: height } = this.container;
    const { seats } = this.partsOf(this.theta).parts;
    const spots = seats.map((seat) => this.spotOf(this.scaled(seat)));
    return { width, height, joints: spots.map(({ x, y }) => [x, y]) };
  }

  /** The traced points as {name, place, path}, in the user's unit, seen from the body that stands still. */
  get tracedPlaces() {
    const { size } = this.figure;
    const inUnit = (place) => place.map((x) => size * x);
    const places = this.tracedIn(this.frames);
    return this.pathsOfTrack().map((path, k) => ({ name: this.traced[k].name, place: inUnit(places[k]), path: path.map(inUnit) }));
  }

  /** What the last frame took: draw calls, and triangles in all of them. */
  get effort() {
    const { calls, triangles } = this.renderer.info.render;
    return { calls, triangles };
  }

  dispose() {
    this.isGone = true;
    this.orbit.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // browsers allow but a few of them, and take their time to collect old ones
  }
}

/** The numbers of the corners of a flat polygon, three for each of the triangles that it is made of. */
function trianglesOf(corners) {
  const places = corners.map((corner) => new Vector3(...corner));
  const normal = new Vector3();
  for (let k = 1; k + 1 < places.length; k += 1) {
    normal.add(places[k].clone().sub(places[0]).cross(places[k + 1].clone().sub(places[0])));
  }
  const flat = new Quaternion().setFromUnitVectors(normal.normalize(), new Vector3(0, 0, 1));
  const outline = places.map((place) => place.applyQuaternion(flat)).map(({ x, y }) => new Vector2(x, y));
  return ShapeUtils.triangulateShape(outline, []).flat();
}

/** A traced point of the document, with the number of the frame of its body, its place in characteristic lengths. */
function tracedPoint({ name, body, place }, figure) {
  const frame = figure.bodies.findIndex((_, candidate) => figure.bodyOf(candidate) === body);
  return { name, frame, place: place.map((x) => x / figure.size) };
}

/** How thick the rods of a body are, over those of others: rods that lie in each other do not flicker. */
function thicknessOf(body) {
  return 1 + THICKER * ((body % LEVELS) - (LEVELS - 1) / 2);
}

function instances(geometry, count) {
  const mesh = new InstancedMesh(geometry, new MeshLambertMaterial(), Math.max(count, 1));
  mesh.frustumCulled = false;
  mesh.count = 0;
  return mesh;
}

function rodMatrix(from, to, radius) {
  const way = to.clone().sub(from);
  const length = way.length();
  const turn = new Quaternion().setFromUnitVectors(UP, length > 0 ? way.divideScalar(length) : UP);
  const middle = from.clone().add(to).multiplyScalar(0.5);
  return new Matrix4().compose(middle, turn, new Vector3(radius, Math.max(length, 1e-9), radius));
}

/** A small ball around points: its centre steps towards the farthest point, ever less far (Badoiu and Clarkson 2003). */
function enclosingBall(points) {
  let center = points[0];
  for (let round = 1; round <= BALL_ROUNDS; round += 1) {
    const far = farthestFrom(center, points);
    center = center.map((x, k) => x + (far[k] - x) / (round + 1));
  }
  return { center, radius: distance(farthestFrom(center, points), center) };
}

/** How far away along `look` a camera must be, and how far along `side` its target, so that all spots are seen between
 * the angles of this tangent to both sides of it. */
function spanOf(spots, side, look, tangent) {
  let [low, high] = [Infinity, -Infinity];
  for (const { place, reach } of spots) {
    const x = place.dot(side);
    const nearer = place.dot(look) * tangent + reach * Math.hypot(1, tangent);
    low = Math.min(low, x - nearer);
    high = Math.max(high, x + nearer);
  }
  return { away: (high - low) / (2 * tangent), middle: (high + low) / 2 };
}

/** The share of so many pixels that is left between the rooms for numbers. */
function usable(pixels) {
  const size = Math.max(pixels, 4 * NUMBER_ROOM);
  return 1 - (2 * NUMBER_ROOM) / size;
}

/** The numbers of the spots near a pointer, the nearest first. */
function nearestFirst(spots, pointer) {
  const away = spots.map(({ x, y }) => Math.hypot(x - pointer.x, y - pointer.y));
  return [...spots.keys()].filter((i) => away[i] < NEAR).sort((i, j) => away[i] - away[j]);
}

function farthestFrom(center, points) {
  let [farthest, most] = [points[0], -1];
  for (const point of points) {
    const away = (point[0] - center[0]) ** 2 + (point[1] - center[1]) ** 2 + (point[2] - center[2]) ** 2;
    if (away > most) [farthest, most] = [point, away];
  }
  return farthest;
}

/** Whether one name would cover another; a pixel or two do not matter, for letters differ in width. */
function cover(one, other) {
  return Math.abs(one.x - other.x) < 0.92 * (one.half + other.half) && Math.abs(one.y - other.y) < 0.92 * NAME_GAP;
}

function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / Math.max(values.length, 1);
}

function lookOf({ elevation, azimuth }) {
  const e = (elevation * Math.PI) / 180;
  const a = (azimuth * Math.PI) / 180;
  return new Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e));
}

function identity() {
  return Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0);
}

/** Move spots away from each other until they are apart, as seen in units of `width` and `height`, or a few rounds have
 * passed. */
function pushApart(spots, width, height) {
  for (let round = 0; round < ROUNDS_APART; round += 1) {
    for (let i = 0; i < spots.length; i += 1) {
      for (let j = i + 1; j < spots.length; j += 1) {
        const dx = (spots[j].x - spots[i].x) / width;
        const dy = (spots[j].y - spots[i].y) / height;
        const apart = Math.hypot(dx, dy);
        if (apart >= 1) continue;
        const [ux, uy] = apart > 1e-6 ? [dx / apart, dy / apart] : [1, 0];
        const push = (1 - apart) / 2;
        spots[i].x -= push * ux * width;
        spots[i].y -= push * uy * height;
        spots[j].x += push * ux * width;
        spots[j].y += push * uy * height;
      }
    }
  }
}

