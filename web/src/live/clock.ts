/**
 * The server's clock: what it said last, and what has gone by since at its speed. The browser's own clock is not asked; it may be wrong.
 * Times are milliseconds since 1970 (server) and of `performance.now()` (wall).
 */
export class ServerClock {
  #time = 0;
  #wall = 0;
  #speed = 1;

  constructor(private readonly wall: () => number = () => performance.now()) {}

  /** The server has said what time it is. */
  set(time: string | undefined, speed: number | undefined): void {
    if (time !== undefined) {
      this.#time = Date.parse(time);
      this.#wall = this.wall();
    } else if (speed !== undefined && speed !== this.#speed && this.known) {
      this.#time = this.now();
      this.#wall = this.wall();
    }
    this.#speed = speed ?? 1;
  }

  get known(): boolean {
    return this.#time > 0;
  }

  /** How fast the server's time goes; 1 but in a demonstration. */
  get speed(): number {
    return this.#speed;
  }

  now(): number {
    return this.#time + (this.wall() - this.#wall) * this.#speed;
  }
}
