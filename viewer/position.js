// Where the linkage is: a track, a place on it, and the direction in which it moves on. Whoever shows it subscribes.

export class Position {
  constructor(track, s) {
    this.track = track;
    this.s = track.place(s);
    this.direction = 1;
    this.listeners = [];
  }

  /** The joint angles, rad. */
  get angles() {
    return this.track.at(this.s);
  }

  /** Go to a place of a track, and on in a direction where one is given. */
  go(track, s, direction = this.direction) {
    const isNewTrack = track !== this.track;
    this.track = track;
    this.s = track.place(s);
    this.direction = direction;
    for (const listener of this.listeners) listener(this, isNewTrack);
  }

  subscribe(listener) {
    this.listeners.push(listener);
  }
}
