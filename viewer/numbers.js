// The numbers of a configuration: joint variables, singular values, and how far the next singular points are.

import { angleName, arclengthText } from "./angles.js";
import { element } from "./elements.js";
import { nextPass } from "./crossings.js";
import { isCurve } from "./tracks.js";

const DECADES = 16; // that the bars of singular values span
const MOST_VALUES = 12; // singular values that are shown, the smallest
const SHORT = 4; // letters of a name that a narrow cell has room for
const ZERO = 1e-18; // rounding of rounding
const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

export class Numbers {
  /** Variables that follow unknowns stand behind these; singular values are shown where the figure has them. */
  constructor(unknowns, followers, figure) {
    this.shown = [...unknowns.map((unknown, i) => ({ ...unknown, of: (u) => u[i] })), ...followers];
    this.angles = [];
    this.values = [];
    const isWide = this.shown.some(({ name }) => name.length > SHORT);
    const angles = element("div", { class: isWide ? "bv-cells bv-wide" : "bv-cells" });
    const values = element("div", { class: "bv-cells" });
    for (const { name } of this.shown) this.angles.push(cell(angles, name, "bv-dial"));
    const count = figure.singularValues(unknowns.map(() => 0)).length;
    this.hidden = Math.max(count - MOST_VALUES, 0);
    for (let i = this.hidden + 1; i <= count; i += 1) this.values.push(cell(values, `σ${angleName(i).slice(1)}`, "bv-level"));
    this.node = element(
      "div",
      { class: "bv-numbers" },
      element("h2", {}, figure.valuesWord),
      angles,
      ...(count ? [element("h2", { title: this.hidden && `the ${MOST_VALUES} smallest` }, "singular values"), values] : []),
    );
  }

  show(angles, singularValues) {
    this.angles.forEach(({ text, mark }, i) => {
      const variable = this.shown[i];
      const value = variable.of(angles);
      text.textContent = variable.text(value).replace("-", "−");
      mark.style.left = `${100 * variable.share(value)}%`;
    });
    this.values.forEach(({ text, mark }, i) => {
      const value = singularValues[this.hidden + i];
      text.textContent = inWords(value);
      const height = value > 0 ? Math.min(Math.max(1 + Math.log10(value / singularValues[0]) / DECADES, 0), 1) : 0;
      mark.style.width = `${100 * height}%`;
    });
  }
}

function cell(parent, name, kind) {
  const text = element("b", {});
  const mark = element("i", {});
  parent.append(element("div", { class: "bv-cell" }, element("span", { title: name }, name), text, element("div", { class: kind }, mark)));
  return { text, mark };
}

/** A number with three digits, small ones with a power of ten. */
function inWords(value) {
  if (value < ZERO) return "0";
  if (value >= 1e-3) return value.toPrecision(3);
  const [digits, exponent] = value.toExponential(1).split("e-");
  return `${digits}·10⁻${[...exponent].map((digit) => SUPERSCRIPTS[digit]).join("")}`;
}

/** The bar between the singular points before and after the linkage. */
export class DistanceBar {
  constructor(scene, passes, goToPoint) {
    this.scene = scene;
    this.passes = passes;
    this.before = element("button", { class: "bv-before", title: "previous singular point (↓)" });
    this.after = element("button", { class: "bv-after", title: "next singular point (↑)" });
    this.mark = element("i", {});
    this.node = element("div", { class: "bv-distance" }, this.before, element("div", { class: "bv-gauge" }, this.mark), this.after);
    this.before.addEventListener("click", () => this.previous && goToPoint(this.previous.point, this.previous.s));
    this.after.addEventListener("click", () => this.next && goToPoint(this.next.point, this.next.s));
  }

  show({ track, s }) {
    const passes = isCurve(track) ? this.passes(track) : [];
    this.previous = nextPass(passes, track, s, -1);
    this.next = nextPass(passes, track, s, 1);
    this.node.classList.toggle("bv-hidden", !this.previous && !this.next);
    this.before.textContent = this.previous ? `${this.previous.point.name} ◂ ${arclengthText(this.previous.ahead, this.scene)}` : "";
    this.after.textContent = this.next ? `${arclengthText(this.next.ahead, this.scene)} ▸ ${this.next.point.name}` : "";
    const back = this.previous?.ahead ?? s;
    const ahead = this.next?.ahead ?? track.length - s;
    this.mark.style.left = `${(100 * back) / Math.max(back + ahead, 1e-12)}%`;
  }
}
