// The graph of forms: a box for each form, a line for each bifurcation at which two of them meet. Where boxes have no room
// beside each other, forms are dots with their names near the pointer.

import { drawing } from "./elements.js";

const INCH = 88; // pixels
const GAP = 40; // pixels between boxes, for the name of an edge
const NAME_WIDTH = 18; // letters of a line in a box
const LINE = 14; // pixels
const RIM = 6; // pixels around the boxes
const DOT = 6; // pixels: the radius of a dot, at most
const APART = 0.35; // of the distance of the nearest two dots: their radius, at most

export class FormGraph {
  constructor(container, scene, tracks, actions) {
    this.container = container;
    this.graph = scene.graph;
    this.tracks = new Map(tracks.map((track) => [track.name, track]));
    this.actions = actions;
    this.svg = drawing("svg", { class: "bv-graph", role: "img", "aria-label": "graph of forms" });
    container.append(this.svg);
    new ResizeObserver(() => this.draw()).observe(container);
  }

  setColors(colorOf) {
    this.colorOf = colorOf;
    this.draw();
  }

  draw() {
    const room = this.container.clientWidth;
    const { names, places, edges } = this.graph;
    if (!this.colorOf || !names.length || room < 80) return;
    const boxes = names.map((name) => boxOf(name));
    const points = [...places, ...edges.flatMap((edge) => edge.line)];
    const turns = [([x, y]) => [x, -y], ([x, y]) => [-y, x]];
    const layouts = turns.map((turn) => layOut(points, places, boxes, room, turn));
    const layout = layouts.find(({ isClear }) => isClear) ?? dotted(points, places, room, turns);
    const { radius } = layout;
    this.place = layout.place;
    this.svg.setAttribute("width", room);
    this.svg.setAttribute("height", layout.height);
    this.nodes = new Map();
    const lines = edges.flatMap((edge) => this.edge(edge, radius));
    const nodes = names.map((name, k) => this.node(name, radius ? dotAt(this.place(places[k]), radius) : boxAt(this.place(places[k]), boxes[k])));
    this.svg.replaceChildren(...lines, ...nodes);
    this.name = radius && this.svg.appendChild(drawing("text", { class: "bv-name", "text-anchor": "middle" }));
    this.svg.onpointerleave = () => this.nameCurrent();
    if (this.position) this.show(this.position);
  }

  edge({ name, line, label }, isDotted) {
    const d = `M${line.map((p) => this.place(p).map((x) => x.toFixed(1)).join(" ")).join("L")}`;
    const [x, y] = this.place(label);
    const go = () => this.actions.goToPointCalled(name);
    if (isDotted) {
      const point = () => this.nameAt(name, [x, y]);
      return [drawing("path", { class: "bv-edge", d }), drawing("path", { class: "bv-edge-reach", d, "data-edge": name, onclick: go, onpointerenter: point })];
    }
    const w = 7 * name.length + 8;
    return [
      drawing("path", { class: "bv-edge", d }),
      drawing(
        "g",
        { class: "bv-edge-name", "data-edge": name, onclick: go },
        drawing("rect", { x: x - w / 2, y: y - 8, width: w, height: 16, rx: 3 }),
        drawing("text", { x, y: y + 4, "text-anchor": "middle" }, name),
      ),
    ];
  }

  /** What is drawn of a form, as the shape of a box or a dot says, with its texts. */
  node(name, { shape, texts, top }) {
    const track = this.tracks.get(name);
    shape.setAttribute("stroke", this.colorOf(track));
    shape.setAttribute("stroke-dasharray", track.dashes.map((dash) => 2 * dash).join(" "));
    const point = top && (() => this.nameAt(name, top));
    const group = drawing("g", { class: "bv-box", "data-node": name, onclick: () => this.actions.goToTrack(track), ...(point && { onpointerenter: point }) }, shape, ...texts);
    this.nodes.set(track, { group, top });
    return group;
  }

  /** Write the name of a dot or a line near it, within the box. */
  nameAt(name, [x, y]) {
    const half = 3.6 * name.length;
    const room = this.container.clientWidth;
    this.name.textContent = name;
    this.name.setAttribute("x", Math.min(Math.max(x, half), Math.max(room - half, half)));
    this.name.setAttribute("y", Math.max(y - 5, 12));
  }

  nameCurrent() {
    const current = this.name && this.nodes.get(this.position?.track);
    if (current) this.nameAt(this.position.track.name, current.top);
  }

  show(position) {
    this.position = position;
    for (const [track, { group }] of this.nodes ?? []) group.classList.toggle("bv-current", track === position.track);
    this.nameCurrent();
  }
}

function boxAt([x, y], { lines, w, h }) {
  const shape = drawing("rect", { x: x - w / 2, y: y - h / 2, width: w, height: h, rx: 6 });
  const texts = lines.map((line, k) => drawing("text", { x, y: y + LINE * (k - (lines.length - 1) / 2) + 4, "text-anchor": "middle" }, line));
  return { shape, texts };
}

function dotAt([x, y], radius) {
  return { shape: drawing("circle", { cx: x, cy: y, r: radius }), texts: [], top: [x, y - radius] };
}

/** Where places (inches) come to stand, turned, in a drawing as wide as the room, and whether no boxes overlap then.
 *
 * An inch takes up to `INCH` pixels, and more only where boxes would overlap. */
function layOut(points, places, boxes, room, turn) {
  const across = Math.max(...boxes.map((box) => box.w)) + 2 * RIM;
  const down = Math.max(...boxes.map((box) => box.h)) + 2 * RIM;
  const { low, span } = extentOf(points.map(turn));
  const fitting = (room - across) / Math.max(span[0], 1e-9);
  const needed = scaleWithoutOverlap(places.map(turn), boxes);
  const scale = Math.min(fitting, Math.max(INCH, needed));
  return { ...placed(low, span, scale, across, down, room, turn), isClear: needed <= fitting && across <= room };
}

/** The same with dots, in a square of the room at most. */
function dotted(points, places, room, turns) {
  const margin = 2 * DOT + LINE;
  const scales = turns.map((turn) => {
    const { span } = extentOf(points.map(turn));
    return (room - 2 * margin) / Math.max(span[0], span[1], 1e-9);
  });
  const turn = turns[scales[0] >= scales[1] ? 0 : 1];
  const { low, span } = extentOf(points.map(turn));
  const scale = Math.min(INCH, Math.max(...scales));
  const nearest = Math.min(...places.map((place, k) => Math.min(...places.slice(0, k).map((other) => Math.hypot(place[0] - other[0], place[1] - other[1])))));
  return { ...placed(low, span, scale, 2 * margin, 2 * margin, room, turn), radius: Math.min(DOT, APART * scale * nearest) };
}

function extentOf(points) {
  const low = [0, 1].map((k) => Math.min(...points.map((p) => p[k])));
  return { low, span: [0, 1].map((k) => Math.max(...points.map((p) => p[k])) - low[k]) };
}

function placed(low, span, scale, across, down, room, turn) {
  const shift = (room - span[0] * scale) / 2;
  const place = (point) => {
    const [x, y] = turn(point);
    return [shift + (x - low[0]) * scale, down / 2 + (y - low[1]) * scale];
  };
  return { place, height: span[1] * scale + down };
}

/** The least scale at which every two boxes are apart, sideways or in height. */
function scaleWithoutOverlap(places, boxes) {
  let scale = 0;
  for (let i = 0; i < places.length; i += 1) {
    for (let j = 0; j < i; j += 1) {
      const sideways = ((boxes[i].w + boxes[j].w) / 2 + GAP) / Math.abs(places[i][0] - places[j][0]);
      const inHeight = ((boxes[i].h + boxes[j].h) / 2 + GAP) / Math.abs(places[i][1] - places[j][1]);
      scale = Math.max(scale, Math.min(sideways, inHeight));
    }
  }
  return scale;
}

function boxOf(name) {
  const lines = [];
  for (const word of name.split(" ")) {
    const last = lines.at(-1);
    if (last !== undefined && last.length + word.length < NAME_WIDTH) lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  const longest = Math.max(...lines.map((line) => line.length));
  return { lines, w: 6.6 * longest + 18, h: LINE * lines.length + 12 };
}
