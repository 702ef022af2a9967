/** A canvas in the map's frame, with the way from the grid to its pixels. */
import type { FrameState } from "ol/Map";

export interface View {
  /** x = a·east + e, y = d·north + f, CSS pixels. */
  a: number;
  d: number;
  e: number;
  f: number;
  width: number;
  height: number;
  ratio: number;
  /** Pixels of a metre. */
  scale: number;
}

export class Sheet {
  readonly canvas = document.createElement("canvas");
  readonly context = this.canvas.getContext("2d")!;
  view: View | null = null;

  constructor(name: string) {
    this.canvas.className = name;
    Object.assign(this.canvas.style, {
      position: "absolute",
      inset: "0",
      width: "100%",
      height: "100%",
      pointerEvents: "none",
    });
  }

  /** Takes the frame's transformation and clears. */
  begin(frame: FrameState): View {
    const [a = 1, , , d = -1, e = 0, f = 0] = frame.coordinateToPixelTransform;
    const [width = 0, height = 0] = frame.size;
    this.view = { a, d, e, f, width, height, ratio: frame.pixelRatio, scale: Math.abs(a) };
    return this.view;
  }

  clear(): CanvasRenderingContext2D {
    const { width, height, ratio } = this.view!;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== w || this.canvas.height !== h) {
      this.canvas.width = w;
      this.canvas.height = h;
    }
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.clearRect(0, 0, w, h);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    return this.context;
  }
}
