/** How somebody is drawn. Filled: measured. Half: reckoned. Hollow: lost or not heard. Square: a vehicle. A triangle above: an alarm. */
import type { Quality } from "../api/types";
import type { Walker } from "../live/walker";
import { stampOf, type Stamp } from "./crowd-bitmap";
import type { Palette } from "./palette";

const QUALITIES = ["fixed", "dead-reckoning", "lost"];
const TROUBLES = ["none", "known", "urgent"];

export function colourOf(palette: Palette, quality: Quality): string {
  return quality === "fixed" ? palette.fixed : quality === "dead-reckoning" ? palette.reckoned : palette.lost;
}

export class Sprites {
  readonly #bitmaps = new Map<number, ImageBitmap>();
  readonly #stamps = new Map<number, Stamp>();

  constructor(
    private readonly palette: Palette,
    /** Device pixels of a CSS pixel. */
    readonly ratio: number,
  ) {}

  of(walker: Walker, size: number): ImageBitmap {
    const key = keyOf(walker, size);
    let made = this.#bitmaps.get(key);
    if (!made) {
      made = this.#paint(walker, size).transferToImageBitmap();
      this.#bitmaps.set(key, made);
    }
    return made;
  }

  /** For a crowd; `faint`: not heard for a while. */
  stamp(walker: Walker, size: number, faint: boolean): Stamp {
    const key = 2 * keyOf(walker, size) + (faint ? 1 : 0);
    let made = this.#stamps.get(key);
    if (!made) {
      made = stampOf(this.#paint(walker, size), faint ? 0.6 : 1);
      this.#stamps.set(key, made);
    }
    return made;
  }

  #paint(walker: Walker, size: number): OffscreenCanvas {
    const { palette, ratio } = this;
    const heard = walker.inContact;
    // As small as it can be: all its pixels are copied for each of ten thousand.
    const half = walker.trouble === "none" ? size + 1.5 : size + 13;
    const pixels = Math.ceil(half * 2 * ratio);
    const canvas = new OffscreenCanvas(pixels, pixels);
    const pen = canvas.getContext("2d")!;
    pen.scale(ratio, ratio);
    pen.translate(half, half);
    const colour = colourOf(palette, walker.quality);
    if (walker.trouble !== "none") {
      const warning = walker.trouble === "urgent" ? palette.danger : palette.high;
      pen.strokeStyle = warning;
      pen.lineWidth = 2.2;
      pen.beginPath();
      pen.arc(0, 0, size + 4, 0, 2 * Math.PI);
      pen.stroke();
      pen.fillStyle = warning;
      pen.beginPath();
      pen.moveTo(size + 5, -size - 12);
      pen.lineTo(size + 11, -size - 1.5);
      pen.lineTo(size - 1, -size - 1.5);
      pen.fill();
      pen.fillStyle = palette.ground;
      pen.fillRect(size + 4.2, -size - 8.6, 1.7, 3.8);
      pen.fillRect(size + 4.2, -size - 4, 1.7, 1.5);
    }
    const outline = () => {
      pen.beginPath();
      if (walker.kind === "person") pen.arc(0, 0, size, 0, 2 * Math.PI);
      else pen.rect(-size, -size, 2 * size, 2 * size);
    };
    outline();
    pen.fillStyle = palette.ground;
    pen.fill();
    pen.lineWidth = size > 4 ? 2 : 1.2;
    pen.strokeStyle = heard ? colour : palette.muted;
    if (!heard) pen.setLineDash([2.2, 2]);
    if (heard && walker.quality === "fixed") {
      pen.fillStyle = colour;
      pen.fill();
      pen.strokeStyle = palette.ground;
      pen.lineWidth = 1;
    } else if (heard && walker.quality === "dead-reckoning") {
      pen.save();
      outline();
      pen.clip();
      pen.fillStyle = colour;
      pen.fillRect(-size, 0, 2 * size, size);
      pen.restore();
      outline();
    }
    pen.stroke();
    return canvas;
  }
}

function keyOf(walker: Walker, size: number): number {
  const look = QUALITIES.indexOf(walker.quality) + 4 * TROUBLES.indexOf(walker.trouble);
  return look + (walker.inContact ? 16 : 0) + (walker.kind === "person" ? 32 : 0) + 64 * Math.round(size * 10);
}
