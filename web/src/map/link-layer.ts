/** From somebody to the anchors that were heard: a whole line where the signal came straight, a broken one where it did not. */
import Layer from "ol/layer/Layer";
import type { FrameState } from "ol/Map";
import type { Walker } from "../live/walker";
import type { Palette } from "./palette";
import { Sheet } from "./sheet";
import type { Stack } from "./stack";

/** How a signal came: straight, round something, or nobody knows. */
export type Sight = "clear" | "blocked" | "not-judged";

export interface Heard {
  east: number;
  north: number;
  height: number;
  level: string | null;
  sight: Sight;
  /** Whether the method believed it; null where it was not weighed. */
  believed: boolean | null;
}

export interface LinkLook {
  walker: () => Walker | undefined;
  heard: Heard[];
  stack: Stack;
  level: string | null;
  palette: Palette;
}

const DASHES = { clear: [], blocked: [5, 5], "not-judged": [1.5, 3.5] };

export class LinkLayer extends Layer {
  readonly #sheet = new Sheet("links");
  #look: LinkLook | null = null;

  show(look: LinkLook): void {
    this.#look = look;
    this.changed();
  }

  override render(frame: FrameState): HTMLElement {
    const view = this.#sheet.begin(frame);
    const context = this.#sheet.clear();
    const look = this.#look;
    const walker = look?.walker();
    if (!look || !walker || (look.level !== null && walker.level !== look.level)) return this.#sheet.canvas;
    const pixel = (x: number, y: number, level: string | null, height: number): [number, number] => [
      view.a * x + view.e,
      view.d * (y + look.stack.shiftOf(level, height)) + view.f,
    ];
    const from = pixel(walker.x, walker.y, walker.level, walker.height);
    const { palette } = look;
    context.lineCap = "butt";
    for (const heard of look.heard) {
      // Between two plans of the sheet a line means nothing.
      if (heard.level !== walker.level) continue;
      const to = pixel(heard.east, heard.north, heard.level, heard.height);
      context.strokeStyle = { clear: palette.good, blocked: palette.high, "not-judged": palette.muted }[heard.sight];
      context.fillStyle = heard.believed === false ? palette.ground : context.strokeStyle;
      context.lineWidth = 1.6;
      context.setLineDash(DASHES[heard.sight]);
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      context.rect(to[0] - 3.5, to[1] - 3.5, 7, 7);
      context.fill();
      context.stroke();
    }
    return this.#sheet.canvas;
  }
}
