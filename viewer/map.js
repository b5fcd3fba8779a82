// The transition map as a drawing: forms and near motions as curves, marks for singular points, near misses and assemblies, and a dot
// where the linkage is.

import { drawing } from "./elements.js";
import { linesOf, spotsOf } from "./planes.js";
import { isCurve } from "./tracks.js";

const MARGIN = { left: 52, right: 16, top: 14, bottom: 42 };
const TALLEST = 0.58; // of the window: the frame of the map
const NEAR_MARK = 11; // pixels from a mark, and from a curve, within which a click means it
const NEAR_CURVE = 14;
const LISTS = ["surface", "assembly", "near motion"]; // kinds of tracks that are drawn as dots or crosses
const SAME_CLICK = 4; // pixels: another click here means the next of the things here

export class TransitionMap {
  /** `actions` are goTo(track, s) and goToPoint(point). */
  constructor(container, scene, tracks, actions) {
    this.container = container;
    this.scene = scene;
    this.tracks = tracks;
    this.actions = actions;
    this.svg = drawing("svg", { class: "bv-map", role: "img", "aria-label": "transition map" });
    this.svg.addEventListener("click", (event) => this.click(event));
    container.append(this.svg);
    new ResizeObserver(() => this.draw()).observe(container);
  }

  setPlane(plane) {
    this.plane = plane;
    this.draw();
  }

  setColors(colorOf) {
    this.colorOf = colorOf;
    this.draw();
  }

  // --- the drawing -----------------------------------------------------------------

  draw() {
    const width = this.container.clientWidth;
    if (!this.plane || !this.colorOf || width < 80) return;
    const tallest = Math.max(TALLEST * window.innerHeight, 240);
    const side = Math.max(Math.min(width - MARGIN.left - MARGIN.right, tallest), 120);
    this.side = side;
    this.left = MARGIN.left + Math.max((width - MARGIN.left - MARGIN.right - side) / 2, 0);
    const height = side + MARGIN.top + MARGIN.bottom;
    this.svg.setAttribute("width", width);
    this.svg.setAttribute("height", height);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.targets = { marks: [], curves: [] };
    this.curvePlaces = [];
    this.svg.replaceChildren(this.frame(), ...this.curves(), ...this.lists(), ...this.marks());
    this.dot = drawing("circle", { class: "bv-here", r: 6.5 });
    this.dotCopies = drawing("g", {}, this.dot);
    this.svg.append(...this.names(), this.dotCopies);
    this.note();
    if (this.position) this.show(this.position);
  }

  screen([x, y]) {
    const { low, high } = this.plane;
    return [
      this.left + (this.side * (x - low[0])) / (high[0] - low[0]),
      MARGIN.top + this.side * (1 - (y - low[1]) / (high[1] - low[1])),
    ];
  }

  frame() {
    const { side, left } = this;
    const top = MARGIN.top;
    const group = drawing("g", { class: "bv-frame" });
    const [across, up] = this.plane.ticks;
    const { turns } = this.plane;
    for (const tick of across) {
      const [x] = this.screen([tick, 0]);
      group.append(
        drawing("line", { x1: x, x2: x, y1: top, y2: top + side }),
        drawing("text", { x, y: top + side + 15, "text-anchor": "middle" }, minus(rounded(tick * turns[0]))),
      );
    }
    for (const tick of up) {
      const [, y] = this.screen([0, tick]);
      group.append(
        drawing("line", { x1: left, x2: left + side, y1: y, y2: y }),
        drawing("text", { x: left - 6, y: y + 4, "text-anchor": "end" }, minus(rounded(tick * turns[1]))),
      );
    }
    const middle = top + side / 2;
    const turned = { x: left - 38, y: middle, transform: `rotate(-90 ${left - 38} ${middle})`, "text-anchor": "middle" };
    group.append(
      drawing("rect", { x: left, y: top, width: side, height: side }),
      drawing("text", { class: "bv-axis", x: left + side / 2, y: top + side + 33, "text-anchor": "middle" }, this.plane.labels[0]),
      drawing("text", { class: "bv-axis", ...turned }, this.plane.labels[1]),
    );
    return group;
  }

  curves() {
    return this.tracks.filter(isCurve).map((track) => {
      const lines = linesOf(this.plane, track.samples);
      const path = lines.map((line) => `M${line.map((spot) => this.screen(spot).map(tenths).join(" ")).join("L")}`);
      this.noteCurve(track);
      return drawing("path", {
        class: "bv-curve",
        d: path.join(""),
        stroke: this.colorOf(track),
        "stroke-dasharray": track.dashes.map((dash) => 1.9 * dash).join(" "),
        "data-form": track.name,
      });
    });
  }

  /** Keep where the curve of a track is, for clicks and for the names of points. */
  noteCurve(track) {
    for (const { s, theta } of track.samples) {
      for (const spot of spotsOf(this.plane, theta)) {
        const [x, y] = this.screen(spot);
        this.targets.curves.push({ track, s, x, y });
        this.curvePlaces.push([x, y]);
      }
    }
  }

  /** Surfaces as clouds of dots, assemblies and near surfaces as crosses. */
  lists() {
    return this.tracks.filter((track) => LISTS.includes(track.kind) && !isCurve(track)).map((track) => {
      const isCloud = track.kind === "surface";
      const places = track.samples.flatMap(({ s, theta }) =>
        spotsOf(this.plane, theta).map((spot) => {
          const [x, y] = this.screen(spot);
          this.targets[isCloud ? "curves" : "marks"].push({ track, s, x, y });
          return [x, y];
        }),
      );
      const shape = isCloud ? ([x, y]) => `M${x} ${y}h0` : ([x, y]) => `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`;
      return drawing("path", { class: isCloud ? "bv-cloud" : "bv-cross", d: places.map(shape).join("") });
    });
  }

  marks() {
    const marks = [];
    this.named = [];
    for (const miss of this.scene.near_misses) {
      const track = this.tracks[miss.form];
      for (const spot of spotsOf(this.plane, track.at(miss.s))) {
        const [x, y] = this.screen(spot);
        marks.push(drawing("path", { class: "bv-miss", d: `M${x - 4} ${y - 4}h8l-4 7z` }, titled(`near miss ${miss.value.toExponential(2)}`)));
        this.targets.marks.push({ track, s: track.place(miss.s), x, y });
      }
    }
    for (const { form, s, name } of this.scene.dead_points) {
      const track = this.tracks[form];
      for (const spot of spotsOf(this.plane, track.at(s))) {
        const [x, y] = this.screen(spot);
        marks.push(drawing("rect", { class: "bv-dead", x: x - 2.5, y: y - 2.5, width: 5, height: 5 }, titled(`dead point of ${name}`)));
        this.targets.marks.push({ track, s: track.place(s), x, y });
      }
    }
    marks.push(...this.drawnMarks());
    for (const point of this.scene.points) {
      for (const spot of spotsOf(this.plane, point.angles)) {
        const [x, y] = this.screen(spot);
        marks.push(pointMark(point, x, y));
        this.targets.marks.push({ point, x, y });
        this.named.push({ name: point.name, x, y });
      }
    }
    return marks;
  }

  /** A star where the linkage is as its file draws it. */
  drawnMarks() {
    const { drawn } = this.scene;
    if (!drawn) return [];
    return spotsOf(this.plane, drawn.angles).map((spot) => {
      const [x, y] = this.screen(spot);
      if (drawn.place) this.targets.marks.push({ track: this.tracks[drawn.place[0]], s: drawn.place[1], x, y });
      const arms = [0, 1, 2, 3, 4].map((k) => starPoint(x, y, 7.5, k) + starPoint(x, y, 3, k + 0.5));
      return drawing("path", { class: "bv-drawn", d: `M${arms.join("").slice(1)}z` }, titled("as drawn"));
    });
  }

  /** The names of singular points, each where it covers least; those at one place share a label. */
  names() {
    const groups = [];
    for (const { name, x, y } of this.named) {
      const same = groups.find((group) => Math.hypot(group.x - x, group.y - y) < 5);
      if (!same) groups.push({ names: [name], x, y });
      else if (!same.names.includes(name)) same.names.push(name);
    }
    const boxes = groups.map(({ x, y }) => boxAround(x, y, 14, 14));
    return groups.map(({ names, x, y }) => {
      const text = names.length > 3 ? `${names[0]} … ${names.at(-1)}` : names.join(", ");
      const [w, h] = [7.2 * text.length, 13];
      const box = this.bestBox(x, y, w, h, boxes);
      boxes.push(box);
      return drawing("text", { class: "bv-name", x: box.x + w / 2, y: box.y + 10.5, "text-anchor": "middle" }, text);
    });
  }

  bestBox(x, y, w, h, taken) {
    const gap = 8;
    let best;
    for (let k = 0; k < 8; k += 1) {
      const [dx, dy] = [Math.cos((k * Math.PI) / 4 - Math.PI / 4), Math.sin((k * Math.PI) / 4 - Math.PI / 4)];
      const box = boxAround(x + dx * (gap + w / 2), y + dy * (gap + h / 2), w, h);
      const cost = this.costOf(box, taken) + 0.1 * k;
      if (!best || cost < best.cost) best = { ...box, cost };
    }
    return best;
  }

  costOf(box, taken) {
    let cost = 0;
    if (box.x < this.left || box.x + box.w > this.left + this.side) cost += 40;
    if (box.y < MARGIN.top || box.y + box.h > MARGIN.top + this.side) cost += 40;
    for (const other of taken) if (overlaps(box, other)) cost += 30;
    let covered = 0;
    for (const [x, y] of this.curvePlaces) covered += contains(box, x, y);
    return cost + Math.min(covered, 15);
  }

  /** Say so where there is no form. */
  note() {
    const lines = this.scene.note;
    if (!lines) return;
    const [x, y] = [this.left + this.side / 2, MARGIN.top + 26];
    this.svg.append(drawing("text", { class: "bv-note", x, y, "text-anchor": "middle" }, lines));
  }

  /** Put the dot where the linkage is. */
  show(position) {
    this.position = position;
    if (!this.dotCopies) return;
    const color = this.colorOf(position.track);
    const dots = spotsOf(this.plane, position.angles).map((spot) => {
      const [cx, cy] = this.screen(spot).map(tenths);
      return drawing("circle", { class: "bv-here", cx, cy, r: 6.5, fill: color });
    });
    this.dotCopies.replaceChildren(...dots);
  }

  // --- clicks ----------------------------------------------------------------------

  click(event) {
    const box = this.svg.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const isRepeated = this.lastClick && Math.hypot(this.lastClick.x - x, this.lastClick.y - y) < SAME_CLICK;
    const count = isRepeated ? this.lastClick.count + 1 : 0;
    this.lastClick = { x, y, count };
    const things = this.thingsAt(x, y);
    if (!things.length) return;
    const thing = things[count % things.length];
    if (thing.point) this.actions.goToPoint(thing.point);
    else this.actions.goTo(thing.track, thing.s);
  }

  /** What lies near a place: marks first, then the nearest place of each curve. */
  thingsAt(x, y) {
    const marks = this.near(this.targets.marks, x, y, NEAR_MARK);
    const onCurves = new Map();
    for (const target of this.near(this.targets.curves, x, y, NEAR_CURVE)) {
      if (!onCurves.has(target.track)) onCurves.set(target.track, target);
    }
    return [...marks, ...onCurves.values()];
  }

  near(targets, x, y, reach) {
    return targets
      .map((target) => ({ ...target, away: Math.hypot(target.x - x, target.y - y) }))
      .filter((target) => target.away <= reach)
      .sort((a, b) => a.away - b.away);
  }
}

/** A circle for a bifurcation, a diamond for a rank drop, a square for all else, as in the figures. */
function pointMark(point, x, y) {
  const title = titled(`${point.name}: ${point.kind}, rank ${point.rank}`);
  const attributes = { class: "bv-point", "data-point": point.name };
  if (point.kind === "bifurcation") return drawing("circle", { ...attributes, cx: x, cy: y, r: 5 }, title);
  const d = point.kind === "rank drop" ? `M${x} ${y - 5.5}l5.5 5.5l-5.5 5.5l-5.5 -5.5z` : `M${x - 4} ${y - 4}h8v8h-8z`;
  return drawing("path", { ...attributes, d }, title);
}

/** A point of a star with five arms, as part of a path. */
function starPoint(x, y, radius, k) {
  const angle = (2 * Math.PI * k) / 5;
  return `L${tenths(x + radius * Math.sin(angle))} ${tenths(y - radius * Math.cos(angle))}`;
}

function titled(text) {
  return drawing("title", {}, text);
}

function boxAround(x, y, w, h) {
  return { x: x - w / 2, y: y - h / 2, w, h };
}

function overlaps(a, b) {
  return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

function contains(box, x, y) {
  return x > box.x && x < box.x + box.w && y > box.y && y < box.y + box.h;
}

function tenths(x) {
  return Math.round(10 * x) / 10;
}

function rounded(value) {
  return Number(value.toPrecision(5));
}

function minus(value) {
  return String(value).replace("-", "−");
}
