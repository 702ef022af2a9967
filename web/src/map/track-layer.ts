/** The way somebody went, by how well it is known; with a mark where a moment of it is looked at. */
import Layer from "ol/layer/Layer";
import type { FrameState } from "ol/Map";
import type { Quality, TrackFix } from "../api/types";
import { colourOf } from "./sprites";
import type { Palette } from "./palette";
import { Sheet } from "./sheet";
import type { Stack } from "./stack";

/** No line is drawn over a gap longer than this, ms. */
const GAP_MS = 120_000;

export interface TrackLook {
  fixes: TrackFix[];
  stack: Stack;
  level: string | null;
  palette: Palette;
  /** Index of the fix that is pointed at. */
  marked: number | null;
}

export class TrackLayer extends Layer {
  readonly #sheet = new Sheet("track");
  #look: TrackLook | null = null;

  show(look: TrackLook): void {
    this.#look = look;
    this.changed();
  }

  override render(frame: FrameState): HTMLElement {
    const view = this.#sheet.begin(frame);
    const context = this.#sheet.clear();
    const look = this.#look;
    if (!look) return this.#sheet.canvas;
    context.lineJoin = "round";
    context.lineCap = "round";
    context.lineWidth = 2.2;
    const pixel = (fix: TrackFix): [number, number] => {
      const [x = 0, y = 0, height = 0] = fix.position_m;
      return [view.a * x + view.e, view.d * (y + look.stack.shiftOf(fix.level, height)) + view.f];
    };
    const seen = (fix: TrackFix) => look.level === null || fix.level == null || fix.level === look.level;
    let quality = "";
    for (let at = 1; at < look.fixes.length; at += 1) {
      const [from, to] = [look.fixes[at - 1]!, look.fixes[at]!];
      const gap = Date.parse(to.time) - Date.parse(from.time) > GAP_MS || from.level !== to.level;
      if (to.quality !== quality || gap || !seen(to)) {
        if (quality !== "") context.stroke();
        quality = "";
      }
      if (gap || !seen(to)) continue;
      if (quality === "") {
        quality = to.quality;
        context.strokeStyle = colourOf(look.palette, quality as Quality);
        context.setLineDash(quality === "fixed" ? [] : quality === "lost" ? [1, 5] : [6, 4]);
        context.beginPath();
        context.moveTo(...pixel(from));
      }
      context.lineTo(...pixel(to));
    }
    if (quality !== "") context.stroke();
    context.setLineDash([]);
    const first = look.fixes.find(seen);
    if (first) {
      context.strokeStyle = look.palette.text;
      context.fillStyle = look.palette.ground;
      context.beginPath();
      context.arc(...pixel(first), 4, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
    }
    const marked = look.marked === null ? undefined : look.fixes[look.marked];
    if (marked && seen(marked)) {
      const [x, y] = pixel(marked);
      context.strokeStyle = look.palette.accent;
      context.beginPath();
      context.arc(x, y, Math.max(marked.radius_95_m * view.scale, 7), 0, 2 * Math.PI);
      context.stroke();
    }
    return this.#sheet.canvas;
  }
}
