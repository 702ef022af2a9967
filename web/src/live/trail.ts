/** The last places of somebody: a ring of fixed size, one place in so many seconds. */
export class Trail {
  static readonly PLACES = 96;
  /** Between two places that are kept, ms of the server's time. */
  static readonly EVERY_MS = 2000;

  readonly #east = new Float32Array(Trail.PLACES);
  readonly #north = new Float32Array(Trail.PLACES);
  readonly #time = new Float64Array(Trail.PLACES);
  #next = 0;
  #count = 0;

  /** Positions are kept relative to the first one: 32 bits are 4 mm within 65 km. */
  #origin: [number, number] | undefined;

  get count(): number {
    return this.#count;
  }

  push(east: number, north: number, timeMs: number): void {
    this.#origin ??= [east, north];
    const last = (this.#next + Trail.PLACES - 1) % Trail.PLACES;
    if (this.#count > 0 && timeMs - this.#time[last]! < Trail.EVERY_MS) return;
    this.#east[this.#next] = east - this.#origin[0];
    this.#north[this.#next] = north - this.#origin[1];
    this.#time[this.#next] = timeMs;
    this.#next = (this.#next + 1) % Trail.PLACES;
    this.#count = Math.min(this.#count + 1, Trail.PLACES);
  }

  clear(): void {
    this.#count = 0;
  }

  /** From the oldest that is younger than `sinceMs` to the newest. */
  each(sinceMs: number, draw: (east: number, north: number) => void): void {
    if (!this.#origin) return;
    for (let back = this.#count; back > 0; back -= 1) {
      const at = (this.#next + Trail.PLACES - back) % Trail.PLACES;
      if (this.#time[at]! < sinceMs) continue;
      draw(this.#east[at]! + this.#origin[0], this.#north[at]! + this.#origin[1]);
    }
  }
}
