// The clock of a page: plays from a first to a last time at a chosen speed, again and again.

/** A clock. `onTime` is called whenever the time changes, `onPlaying` when it starts or stops. */
export class Player {
  constructor(start, end, { onTime, onPlaying }) {
    Object.assign(this, { start, end, time: start, speed: 1, isPlaying: false, onTime, onPlaying });
  }

  /** Starts or stops the clock; one that stands at the end begins anew. */
  play(isPlaying) {
    if (isPlaying === this.isPlaying) return;
    this.isPlaying = isPlaying;
    if (isPlaying && this.time >= this.end) this.time = this.start;
    this.last = undefined;
    this.onPlaying(isPlaying);
    if (isPlaying) requestAnimationFrame((now) => this.#tick(now));
  }

  /** Goes to a time. */
  go(time) {
    this.time = Math.min(this.end, Math.max(this.start, time));
    this.onTime(this.time);
  }

  #tick(now) {
    if (!this.isPlaying) return;
    const passed = this.last === undefined ? 0 : Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    const next = this.time + passed * this.speed;
    this.go(next > this.end ? this.start : next);
    requestAnimationFrame((later) => this.#tick(later));
  }
}
