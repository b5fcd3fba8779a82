// What to choose from: the forms, the branches that leave a singular point, and the goal of a route.

import { arclengthText } from "./angles.js";
import { leavingBranches } from "./crossings.js";
import { drawing, element } from "./elements.js";
import { isCurve } from "./tracks.js";

const KEYS = 9; // forms that have a key of their own
const MANY = 20; // forms up to which the table has no filter

/** A short line as the map draws the curve of a track. */
function swatch(track, color) {
  const dash = isCurve(track) ? track.dashes.map((length) => 1.6 * length).join(" ") : "1 4";
  const line = drawing("line", { x1: 1, x2: 25, y1: 5, y2: 5, stroke: color, "stroke-width": 3, "stroke-dasharray": dash });
  return drawing("svg", { width: 26, height: 10, class: "bv-swatch", "aria-hidden": "true" }, line);
}

/** The table of all tracks: a row each, sorted by a click on the head of a column. */
export class FormTable {
  /** `passes` tells the singular points that a track passes. */
  constructor(scene, tracks, passes, goToTrack) {
    this.goToTrack = goToTrack;
    this.rows = tracks.map((track, k) => ({ track, key: k, ...factsOf(scene, track, passes(track)) }));
    this.order = { column: "key", sign: 1 };
    this.body = element("tbody");
    this.columns = COLUMNS.filter(({ shown }) => !shown || this.rows.some((row) => shown(row)));
    const heads = this.columns.map(({ name, title }) => {
      const sort = element("button", { title: `sort by ${title}`, onclick: () => this.sortBy(name) }, title);
      return element("th", { scope: "col", "data-column": name }, sort);
    });
    this.heads = heads;
    const table = element("table", {}, element("thead", {}, element("tr", {}, ...heads)), this.body);
    this.list = element("div", { class: "bv-forms" }, table);
    this.node = element("div", {}, ...(tracks.length > MANY ? [this.filter()] : []), this.list);
  }

  /** A field for words that names or facts of forms have to hold to be listed. */
  filter() {
    const label = `filter ${this.rows.length} forms`;
    return element("input", { type: "search", class: "bv-filter", placeholder: label, "aria-label": label, oninput: (event) => this.narrow(event.target.value) });
  }

  narrow(text) {
    const words = text.toLowerCase().split(/\s+/);
    for (const { node, facts } of this.rows) node.hidden = !words.every((word) => facts.includes(word));
  }

  /** Sort by a column, the other way round where it is sorted by it already. */
  sortBy(column) {
    const isAgain = this.order.column === column;
    this.order = { column, sign: isAgain ? -this.order.sign : 1 };
    this.arrange();
  }

  arrange() {
    const { column, sign } = this.order;
    const order = column === "name" ? "key" : column; // names are in order as they come
    const sorted = [...this.rows].sort((a, b) => sign * compare(a[order], b[order]) || a.key - b.key);
    this.body.replaceChildren(...sorted.map(({ node }) => node));
    for (const head of this.heads) {
      const isSorted = head.dataset.column === column;
      head.setAttribute("aria-sort", isSorted ? (sign > 0 ? "ascending" : "descending") : "none");
    }
  }

  setColors(colorOf) {
    for (const row of this.rows) {
      const { track, key, node } = row;
      const number = element("kbd", {}, key < KEYS ? String(key + 1) : "");
      const button = element("button", { "data-track": track.name }, number, swatch(track, colorOf(track)), element("span", {}, track.name));
      const cells = this.columns.slice(1).map(({ shown }) => element("td", {}, shown(row)));
      row.node = element("tr", { title: `${track.name}: ${row.kind}`, hidden: node?.hidden, onclick: () => this.goToTrack(track) }, element("th", { scope: "row" }, button), ...cells);
    }
    this.arrange();
    if (this.position) this.show(this.position);
  }

  show(position) {
    this.position = position;
    for (const { track, node } of this.rows) {
      const isCurrent = track === position.track;
      const button = node.querySelector("button");
      if (isCurrent && button.getAttribute("aria-pressed") !== "true") reveal(this.list, node);
      button.setAttribute("aria-pressed", String(isCurrent));
    }
  }
}

const COLUMNS = [
  { name: "name", title: "form" },
  { name: "kind", title: "kind", shown: ({ kind }) => kind },
  { name: "mobility", title: "mobility", shown: ({ mobility }) => String(mobility ?? "") },
  { name: "size", title: "length", shown: ({ length }) => length },
  { name: "points", title: "points", shown: ({ points }) => String(points || "") },
];

/** What the table says of a track, and all of it in the words that the filter looks at. */
function factsOf(scene, track, passes) {
  const missed = track.misclosure ? `, misses closure by ${track.misclosure.toExponential(1)}` : "";
  const closure = track.closed ? "closed" : "open";
  const kind = isCurve(track) ? `${track.kind === "form" ? "" : `${track.kind}, `}${closure}${missed}` : `${track.kind}${missed}`;
  const length = isCurve(track) ? arclengthText(track.length, scene) : `${track.samples.length} place${track.samples.length === 1 ? "" : "s"}`;
  const points = new Set(passes.map(({ point }) => point.name)).size;
  const facts = [track.name, kind, length, `mobility ${track.mobility}`].join(" ").toLowerCase();
  return { kind, length, points, facts, mobility: track.mobility, size: track.length };
}

function compare(a, b) {
  if (a === b) return 0;
  return a === undefined || a < b ? -1 : 1;
}

/** Scroll a list, and nothing around it, to one of its rows. */
function reveal(list, row) {
  const [box, own] = [list.getBoundingClientRect(), row.getBoundingClientRect()];
  if (own.top < box.top + own.height || own.bottom > box.bottom) list.scrollTop += own.top - box.top - own.height; // below the head
}

/** The branches that leave the singular point at which the linkage is. */
export class BranchChoice {
  /** `leave({track, s, direction})` takes the linkage there. */
  constructor(tracks, unknowns, leave) {
    this.tracks = tracks;
    this.unknowns = unknowns;
    this.leave = leave;
    this.node = element("div", { class: "bv-choice", "aria-live": "polite" });
  }

  setColors(colorOf) {
    this.colorOf = colorOf;
    this.point = undefined;
  }

  /** Show what leaves a point, or nothing without one. */
  show(point) {
    if (point === this.point) return;
    this.point = point;
    this.node.classList.toggle("bv-open", Boolean(point));
    if (!point) {
      this.node.replaceChildren();
      return;
    }
    const buttons = this.branches(point).map((branch) => {
      const arrow = branch.direction > 0 ? "▶" : "◀";
      const attributes = { "data-branch": branch.track.name, onclick: () => this.leave(branch) };
      return element("button", attributes, swatch(branch.track, this.colorOf(branch.track)), `${branch.track.name} ${arrow}`);
    });
    this.node.replaceChildren(element("span", {}, `At ${point.name} (${point.kind}), go on along`), ...buttons);
  }

  branches(point) {
    const surfaces = point.surfaces.map((k) => surfaceAt(this.tracks, this.unknowns, k, point));
    return [...leavingBranches(point, this.tracks), ...surfaces];
  }
}

/** The configuration of a surface nearest to a singular point. */
function surfaceAt(tracks, unknowns, k, point) {
  const track = tracks.filter((candidate) => candidate.kind === "surface")[k];
  const gapOf = (i, gap) => (unknowns[i].isPeriodic ? 1 - Math.cos((2 * Math.PI * gap) / unknowns[i].period) : gap ** 2 / 2);
  const away = ({ theta }) => theta.reduce((sum, value, i) => sum + gapOf(i, value - point.angles[i]), 0);
  const nearest = track.samples.reduce((best, sample) => (away(sample) < away(best) ? sample : best));
  return { track, s: nearest.s, direction: 1 };
}

/** Where a route is to lead, and what is said of it. */
export class RouteBar {
  constructor(tracks, start) {
    const forms = tracks.filter((track) => track.kind === "form");
    this.select = element("select", { "aria-label": "goal of the route" });
    for (const track of forms) this.select.append(element("option", { value: track.name }, track.name));
    this.button = element("button", { onclick: () => start(this.select.value) }, "Go");
    this.text = element("span", { class: "bv-route-text", "aria-live": "polite" });
    this.node = element("div", { class: "bv-route" }, element("label", {}, "Route to ", this.select), this.button, this.text);
    if (forms.length > 1) this.select.value = forms[1].name;
    else this.node.classList.add("bv-hidden");
  }

  say(text) {
    this.text.textContent = text;
  }
}
