// The buttons and lists around the pictures.

import { arclengthText } from "./angles.js";
import { element } from "./elements.js";
import { KEYS_IN_WORDS } from "./keyboard.js";
import { isCurve } from "./tracks.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4];

/** The head of the page: what the linkage is, the theme, and the keys. */
export function header(scene, toggleTheme) {
  const help = element("details", { class: "bv-help" }, element("summary", { title: "keys" }, "?"));
  const rows = KEYS_IN_WORDS.map(([keys, words]) => element("tr", {}, element("th", {}, keys), element("td", {}, words)));
  help.append(element("table", {}, ...rows));
  const theme = element("button", { class: "bv-theme", title: "dark or light (D)", onclick: toggleTheme }, "◐");
  const words = [scene.verdict, scene.completeness].filter(Boolean).join(" ");
  return element("header", {}, element("h1", {}, scene.title), element("p", { title: words }, words), theme, help);
}

/** What the marks of the map mean, as far as there are any. */
export function legend(scene) {
  const kinds = new Set(scene.points.map((point) => point.kind));
  const entries = [];
  if (kinds.delete("bifurcation")) entries.push("○ bifurcation");
  if (kinds.delete("rank drop")) entries.push("◇ rank drop");
  for (const kind of kinds) entries.push(`□ ${kind}`);
  if (scene.near_misses.length) entries.push("▾ near miss");
  if (scene.assemblies.length) entries.push("× rigid assembly");
  if (scene.near_motions.length) entries.push(nearMotions(scene.near_motions));
  const dead = [...new Set(scene.dead_points.map(({ name }) => name))];
  if (dead.length) entries.push(`▪ dead point of ${dead.join(", ")}`);
  if (scene.drawn) entries.push("★ as drawn");
  if (scene.surfaces.length) entries.push("∴ mobility 2 or more");
  return element("div", { class: "bv-legend" }, ...entries.map((entry) => element("span", {}, entry)));
}

/** How near motions are drawn, and by how much they miss closure. */
function nearMotions(motions) {
  const [least, most] = [Math.min, Math.max].map((end) => end(...motions.map((motion) => motion.misclosure)).toExponential(1));
  const missed = least === most ? least : `${least} to ${most}`;
  const mark = motions.some((motion) => motion.curve) ? "┈" : "×";
  return `${mark} near motion: no motion, closure is missed by ${missed}`;
}

/** Above the linkage: which link stands still, ghosts, and the whole picture. */
export class SpaceTools {
  /** `actions` are holdLink(frame), toggleGhosts() and resetView(). */
  constructor(figure, actions) {
    const hold = () => actions.holdLink(Number(this.link.value));
    this.link = element("select", { "aria-label": "link that is held still", onchange: hold });
    figure.bodies.forEach((name, frame) => {
      this.link.append(element("option", { value: frame, selected: frame === figure.fixed }, name));
    });
    const ghosts = { title: "ghosts of earlier positions (G)", "aria-pressed": "false", onclick: () => actions.toggleGhosts() };
    this.ghosts = element("button", ghosts, "Ghosts");
    const all = element("button", { title: "see all again (R)", onclick: () => actions.resetView() }, "See all");
    this.node = element("div", { class: "bv-space-tools" }, element("label", {}, `${figure.fixedWord} `, this.link), this.ghosts, all);
  }

  showGhosts(areOn) {
    this.ghosts.setAttribute("aria-pressed", String(areOn));
  }

  /** The frame of the link after the one that is held, now chosen. */
  chooseNextLink() {
    this.link.value = (Number(this.link.value) + 1) % this.link.options.length;
    return Number(this.link.value);
  }
}

/** Below the linkage: playing, its speed, and where the linkage is. */
export class MotionTools {
  /** `actions` are togglePlay(), playBackwards() and the `player`. */
  constructor(scene, actions) {
    const { player } = actions;
    this.scene = scene;
    this.play = element("button", { class: "bv-play", title: "play and pause (Space)", onclick: () => actions.togglePlay() }, "▶");
    this.back = element("button", { class: "bv-back", title: "play backwards", onclick: () => actions.playBackwards() }, "◀");
    const speed = element("select", { "aria-label": "speed", onchange: () => (player.speed = Number(speed.value)) });
    for (const factor of SPEEDS) speed.append(element("option", { value: factor, selected: factor === 1 }, `${factor}×`));
    const pause = element("input", { type: "checkbox", checked: true });
    pause.addEventListener("change", () => (player.pausesAtBifurcations = pause.checked));
    const pauses = element("label", {}, pause, " pause at bifurcations");
    pauses.classList.toggle("bv-hidden", scene.points.every((point) => point.leaving <= 2));
    this.place = element("span", { class: "bv-place" });
    this.node = element("div", { class: "bv-row" }, this.back, this.play, speed, pauses, this.place);
  }

  showPlaying(isPlaying) {
    this.play.textContent = isPlaying ? "❚❚" : "▶";
    this.back.disabled = isPlaying;
  }

  show({ track, s }) {
    const shown = (length) => arclengthText(length, this.scene);
    this.place.textContent = isCurve(track)
      ? `${shown(s)} of ${shown(track.length)} along ${track.name}`
      : `${track.name}: ${s + 1} of ${track.samples.length}`;
  }
}

/** Above the map: its plane. */
export class MapTools {
  /** `changed()` is called when another plane is chosen. */
  constructor(scene, unknowns, changed) {
    const choose = () => {
      for (const axis of this.axes) axis.disabled = this.isPrincipal;
      changed();
    };
    this.axes = ["horizontal", "vertical"].map((word, k) => {
      const select = element("select", { "aria-label": `${word} axis of the map`, onchange: choose });
      unknowns.forEach(({ name }, i) => {
        select.append(element("option", { value: i, selected: i === scene.plane[k] }, name));
      });
      return select;
    });
    this.principal = element("input", { type: "checkbox", onchange: choose });
    this.node = element(
      "div",
      { class: "bv-row bv-map-tools" },
      element("label", {}, "map: ", this.axes[0]),
      element("label", {}, " against ", this.axes[1]),
      element("label", {}, this.principal, " principal plane"),
    );
  }

  get isPrincipal() {
    return this.principal.checked;
  }

  /** The two unknowns of the plane, from 0. */
  get chosen() {
    return this.axes.map((axis) => Number(axis.value));
  }
}
