// The slider along a track, under a chart of the smallest regular singular value with the singular points on the way.

import { drawing, element } from "./elements.js";
import { isCurve } from "./tracks.js";

const STEPS = 4000; // of the slider
const HEIGHT = 46; // of the chart, pixels
const THUMB = 8; // half the slider's thumb, pixels
const LABEL_GAP = 4; // pixels between two names
const LEAST = 1e-16;

export class Strip {
  /** `smallest(track)` are {s, value} along a track; `moved(s)` and `goToPoint(point, s)` are called on input. */
  constructor(passes, smallest, misses, actions) {
    this.passes = passes;
    this.smallest = smallest;
    this.misses = misses;
    this.actions = actions;
    this.svg = drawing("svg", { class: "bv-chart", height: HEIGHT, "aria-hidden": "true" });
    this.slider = element("input", { type: "range", min: 0, max: STEPS, step: "any", class: "bv-slider", "aria-label": "place along the form" });
    this.slider.addEventListener("input", () => actions.moved((this.slider.valueAsNumber / STEPS) * this.track.length));
    this.node = element("div", { class: "bv-strip" }, this.svg, this.slider);
    new ResizeObserver(() => this.draw()).observe(this.node);
  }

  setColors(colorOf) {
    this.colorOf = colorOf;
    this.draw();
  }

  show(position) {
    const isNew = this.track !== position.track;
    this.track = position.track;
    if (isNew || !this.isAt(position)) this.slider.value = this.step(position);
    this.slider.disabled = position.track.length === 0;
    if (isNew) this.draw();
  }

  step({ track, s }) {
    return track.length ? (s / track.length) * STEPS : 0;
  }

  /** Whether the slider shows a position: at its right end that where a closed form begins again. */
  isAt(position) {
    const steps = Math.abs(this.slider.valueAsNumber - this.step(position));
    return steps === 0 || (position.track.closed && steps === STEPS);
  }

  x(s) {
    return THUMB + (this.width - 2 * THUMB) * (this.track.length ? s / this.track.length : 0);
  }

  draw() {
    this.width = this.node.clientWidth;
    if (!this.track || !this.colorOf || this.width < 40) return;
    this.svg.setAttribute("width", this.width);
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${HEIGHT}`);
    this.slider.style.setProperty("--form", this.colorOf(this.track));
    if (isCurve(this.track)) this.svg.replaceChildren(this.curve(), ...this.missMarks(), ...this.stops());
    else this.svg.replaceChildren(this.count());
  }

  /** The smallest regular singular value on a logarithmic scale. */
  curve() {
    const values = this.smallest(this.track);
    const logs = values.map(({ value }) => Math.log10(Math.max(value, LEAST)));
    const high = Math.max(...logs);
    const low = Math.min(Math.max(Math.min(...logs), high - 6), high - 1);
    const y = (log) => 16 + (HEIGHT - 19) * (1 - Math.max((log - low) / (high - low), 0));
    const path = values.map(({ s }, k) => `${this.x(s).toFixed(1)} ${y(logs[k]).toFixed(1)}`);
    const title = drawing("title", {}, "smallest regular singular value, logarithmic");
    return drawing("path", { d: `M${path.join("L")}`, stroke: this.colorOf(this.track), class: "bv-smallest" }, title);
  }

  missMarks() {
    return this.misses(this.track).map(({ s }) =>
      drawing("path", { class: "bv-miss", d: `M${this.x(s) - 3.5} ${HEIGHT - 7}h7l-3.5 6z` }),
    );
  }

  /** A line for each singular point on the way, named where there is room. */
  stops() {
    let free = -Infinity;
    return this.passes(this.track).map(({ point, s }) => {
      const x = this.x(s);
      const half = 3.6 * point.name.length;
      const at = Math.min(Math.max(x, half), this.width - half);
      const isFree = at - half >= free;
      if (isFree) free = at + half + LABEL_GAP;
      const group = drawing("g", { class: "bv-stop", "data-stop": point.name, onclick: () => this.actions.goToPoint(point, s) });
      group.append(drawing("line", { x1: x, x2: x, y1: 14, y2: HEIGHT }), drawing("rect", { x: x - 5, y: 0, width: 10, height: HEIGHT }));
      if (isFree) group.append(drawing("text", { x: at, y: 11, "text-anchor": "middle" }, point.name));
      return group;
    });
  }

  count() {
    const text = `${this.track.samples.length} ${this.track.samples.length === 1 ? "configuration" : "configurations"}`;
    return drawing("text", { x: this.width / 2, y: HEIGHT - 10, "text-anchor": "middle" }, text);
  }
}
