// What to choose from: the forms, the branches that leave a singular point, and the goal of a route.

import { leavingBranches } from "./crossings.js";
import { drawing, element } from "./elements.js";
import { isCurve } from "./tracks.js";

const KEYS = 9; // forms that have a key of their own
const MANY = 20; // forms up to which the list has no filter

/** A short line as the map draws the curve of a track. */
function swatch(track, color) {
  const dash = isCurve(track) ? track.dashes.map((length) => 1.6 * length).join(" ") : "1 4";
  const line = drawing("line", { x1: 1, x2: 25, y1: 5, y2: 5, stroke: color, "stroke-width": 3, "stroke-dasharray": dash });
  return drawing("svg", { width: 26, height: 10, class: "bv-swatch", "aria-hidden": "true" }, line);
}

/** The list of all tracks, as buttons. */
export class FormList {
  constructor(tracks, goToTrack) {
    this.tracks = tracks;
    this.goToTrack = goToTrack;
    this.list = element("div", { class: "bv-forms", role: "group", "aria-label": "forms" });
    this.node = element("div", {}, ...(tracks.length > MANY ? [this.filter()] : []), this.list);
  }

  /** A field for words that names or facts of forms have to hold to be listed. */
  filter() {
    const label = `filter ${this.tracks.length} forms`;
    return element("input", { type: "search", class: "bv-filter", placeholder: label, "aria-label": label, oninput: (event) => this.narrow(event.target.value) });
  }

  narrow(text) {
    const words = text.toLowerCase().split(/\s+/);
    for (const button of this.buttons) {
      const facts = button.title.toLowerCase();
      button.hidden = !words.every((word) => facts.includes(word));
    }
  }

  setColors(colorOf) {
    this.buttons = this.tracks.map((track, k) => {
      const key = k < KEYS ? element("kbd", {}, String(k + 1)) : "";
      const title = isCurve(track) ? `${track.name}: ${describe(track)}` : track.name;
      const attributes = { title, "data-track": track.name, onclick: () => this.goToTrack(track) };
      return element("button", attributes, key, swatch(track, colorOf(track)), element("span", {}, track.name));
    });
    this.list.replaceChildren(...this.buttons);
    if (this.position) this.show(this.position);
  }

  show(position) {
    this.position = position;
    this.buttons.forEach((button, k) => {
      const isCurrent = this.tracks[k] === position.track;
      if (isCurrent && button.getAttribute("aria-pressed") !== "true") reveal(this.list, button);
      button.setAttribute("aria-pressed", String(isCurrent));
    });
  }
}

/** Scroll a list, and nothing around it, to one of its buttons. */
function reveal(list, button) {
  const top = button.offsetTop - list.offsetTop;
  if (top < list.scrollTop || top + button.offsetHeight > list.scrollTop + list.clientHeight) list.scrollTop = top;
}

function describe(track) {
  const degrees = ((track.length * 180) / Math.PI).toFixed(1);
  const missed = track.misclosure ? `, misses closure by ${track.misclosure.toExponential(1)}` : "";
  return `${track.closed ? "closed" : "open"}, ${degrees} deg long${missed}`;
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
