// What moves by itself: along a track until a bifurcation, or along a route to its end.

import { isCurve } from "./tracks.js";
import { nextPass } from "./crossings.js";
import { lengthOf, placeAlong } from "./route.js";

const SECONDS_OF_FORM = 14;
const LONGEST_STEP = 0.1; // s: a page that slept does not jump

export class Player {
  /** `passes(track)` are those of a track; `changed()` is called when playing starts or ends. */
  constructor(position, passes, changed) {
    this.position = position;
    this.passes = passes;
    this.changed = changed;
    this.speed = 1;
    this.pausesAtBifurcations = true;
    this.mode = "still";
    this.legs = [];
    this.gone = 0;
    this.onEnd = () => {};
  }

  get isPlaying() {
    return this.mode !== "still";
  }

  /** Move along the track, in a direction where one is given. */
  play(direction = this.position.direction) {
    this.position.direction = direction;
    this.begin("track");
  }

  /** Move along the legs of a route, in so many seconds at speed 1. */
  playRoute(legs, seconds) {
    this.legs = legs;
    this.gone = 0;
    const total = lengthOf(legs);
    this.rate = total / (seconds ?? Math.min(24, Math.max(4, (SECONDS_OF_FORM * total) / legs[0].track.length)));
    this.begin("route");
  }

  begin(mode) {
    cancelAnimationFrame(this.request); // one frame at a time is asked for, however often playing begins
    this.mode = mode;
    this.last = undefined;
    this.changed();
    this.tick();
  }

  stop() {
    if (!this.isPlaying) return;
    this.mode = "still";
    cancelAnimationFrame(this.request);
    this.changed();
  }

  tick() {
    this.request = requestAnimationFrame((now) => {
      const seconds = Math.min((now - (this.last ?? now)) / 1000, LONGEST_STEP);
      this.last = now;
      if (this.mode === "track") this.moveAlongTrack(seconds);
      if (this.mode === "route") this.moveAlongRoute(seconds);
      if (this.isPlaying) this.tick();
    });
  }

  moveAlongTrack(seconds) {
    const { track, s, direction } = this.position;
    if (!isCurve(track)) {
      this.stepThroughList(seconds);
      return;
    }
    const step = (this.speed * seconds * track.length) / SECONDS_OF_FORM;
    const stops = this.passes(track).filter((pass) => pass.point.leaving > 2);
    const next = nextPass(stops, track, s, direction);
    if (this.pausesAtBifurcations && next && next.ahead <= step) {
      this.position.go(track, next.s);
      this.stop();
      return;
    }
    const end = s + direction * step;
    const isOver = !track.closed && (end < 0 || end > track.length);
    this.position.go(track, end, isOver ? -direction : direction);
  }

  /** One configuration of a list after the other, and back. */
  stepThroughList(seconds) {
    const { track, s, direction } = this.position;
    this.waited = (this.waited ?? 0) + this.speed * seconds * Math.max(1.5, track.length / SECONDS_OF_FORM);
    if (this.waited < 1) return;
    const steps = Math.floor(this.waited);
    this.waited -= steps;
    const end = s + direction * steps;
    const isOver = end < 0 || end > track.length;
    this.position.go(track, isOver ? s - direction * steps : end, isOver ? -direction : direction);
  }

  moveAlongRoute(seconds) {
    this.gone += this.speed * seconds * this.rate;
    const place = placeAlong(this.legs, this.gone);
    this.position.go(place.leg.track, place.s, place.direction);
    if (this.gone < lengthOf(this.legs)) return;
    this.stop();
    this.onEnd();
  }
}
