// The graph of forms: a box for each form, a line for each bifurcation at which two of them meet.

import { drawing } from "./elements.js";

const INCH = 88; // pixels
const GAP = 40; // pixels between boxes, for the name of an edge
const NAME_WIDTH = 18; // letters of a line in a box
const LINE = 14; // pixels

export class FormGraph {
  constructor(container, scene, tracks, actions) {
    this.container = container;
    this.graph = scene.graph;
    this.tracks = tracks;
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
    const upright = layOut(points, places, boxes, room, INCH, ([x, y]) => [x, -y]);
    const turned = layOut(points, places, boxes, room, 0, ([x, y]) => [-y, x]);
    const layout = upright.width > room && turned.width < upright.width ? turned : upright;
    this.place = layout.place;
    this.svg.setAttribute("width", layout.width);
    this.svg.setAttribute("height", layout.height);
    this.boxes = new Map();
    const lines = edges.flatMap((edge) => this.edge(edge));
    this.svg.replaceChildren(...lines, ...names.map((name, k) => this.box(name, boxes[k], places[k])));
    if (this.position) this.show(this.position);
  }

  edge({ name, line, label }) {
    const d = `M${line.map((p) => this.place(p).map((x) => x.toFixed(1)).join(" ")).join("L")}`;
    const [x, y] = this.place(label);
    const go = () => this.actions.goToPointCalled(name);
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

  box(name, { lines, w, h }, place) {
    const track = this.tracks.find((candidate) => candidate.name === name);
    const [x, y] = this.place(place);
    const rect = drawing("rect", {
      x: x - w / 2,
      y: y - h / 2,
      width: w,
      height: h,
      rx: 6,
      stroke: this.colorOf(track),
      "stroke-dasharray": track.dashes.map((dash) => 2 * dash).join(" "),
    });
    const group = drawing("g", { class: "bv-box", "data-node": name, onclick: () => this.actions.goToTrack(track) }, rect);
    lines.forEach((line, k) => {
      const at = y + LINE * (k - (lines.length - 1) / 2) + 4;
      group.append(drawing("text", { x, y: at, "text-anchor": "middle" }, line));
    });
    this.boxes.set(track, group);
    return group;
  }

  show(position) {
    this.position = position;
    for (const [track, box] of this.boxes ?? []) box.classList.toggle("bv-current", track === position.track);
  }
}

/** Where places (inches) come to stand, turned, in a drawing as wide as the room, or wider where boxes would overlap.
 *
 * An inch takes up to `inch` pixels, and more only where boxes would overlap. */
function layOut(points, places, boxes, room, inch, turn) {
  const turned = points.map(turn);
  const low = [0, 1].map((k) => Math.min(...turned.map((p) => p[k])));
  const span = [0, 1].map((k) => Math.max(...turned.map((p) => p[k])) - low[k]);
  const across = Math.max(...boxes.map((box) => box.w)) + 12;
  const down = Math.max(...boxes.map((box) => box.h)) + 12;
  const fitting = Math.min(inch, (room - across) / Math.max(span[0], 1e-9));
  const scale = Math.max(fitting, scaleWithoutOverlap(places.map(turn), boxes));
  const width = Math.max(span[0] * scale + across, room);
  const shift = (width - span[0] * scale) / 2;
  const place = (point) => {
    const [x, y] = turn(point);
    return [shift + (x - low[0]) * scale, down / 2 + (y - low[1]) * scale];
  };
  return { place, width, height: span[1] * scale + down };
}

/** The least scale at which every two boxes are apart, sideways or in height. */
function scaleWithoutOverlap(places, boxes) {
  let scale = 0;
  for (let i = 0; i < places.length; i += 1) {
    for (let j = 0; j < i; j += 1) {
      const sideways = ((boxes[i].w + boxes[j].w) / 2 + GAP) / Math.abs(places[i][0] - places[j][0]);
      const inHeight = ((boxes[i].h + boxes[j].h) / 2 + GAP) / Math.abs(places[i][1] - places[j][1]);
      scale = Math.max(scale, Math.min(sideways, inHeight, 2 * INCH));
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
