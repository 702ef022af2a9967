/**
 * Dots of a crowd, written into pixels: thousands of `drawImage` a frame are slow in software rendering, thousands of small copies are not.
 * Edges are not blended where dots lie over one another; at three pixels nobody sees it.
 */
export interface Stamp {
  pixels: Uint32Array;
  side: number;
}

/** Opaque from this on. */
const SOLID = 128;

export class CrowdBitmap {
  #image: ImageData | null = null;
  #pixels = new Uint32Array();

  /** Begins an empty picture of a size in device pixels. */
  begin(width: number, height: number): void {
    if (this.#image?.width !== width || this.#image.height !== height) {
      this.#image = new ImageData(width, height);
      this.#pixels = new Uint32Array(this.#image.data.buffer);
    } else {
      this.#pixels.fill(0);
    }
  }

  /** Puts a stamp with its middle at a device pixel; what would lie outside is left out. */
  put(stamp: Stamp, x: number, y: number): void {
    const image = this.#image;
    if (!image) return;
    const { pixels, side } = stamp;
    const left = Math.round(x - side / 2);
    const top = Math.round(y - side / 2);
    if (left < 0 || top < 0 || left + side > image.width || top + side > image.height) return;
    for (let row = 0; row < side; row += 1) {
      let to = (top + row) * image.width + left;
      for (let from = row * side; from < (row + 1) * side; from += 1, to += 1) {
        const pixel = pixels[from]!;
        const alpha = pixel >>> 24;
        if (alpha >= SOLID || (alpha > 0 && this.#pixels[to] === 0)) this.#pixels[to] = pixel;
      }
    }
  }

  /** Onto the canvas, in place of what is there. */
  end(context: CanvasRenderingContext2D): void {
    if (this.#image) context.putImageData(this.#image, 0, 0);
  }
}

/** The pixels of a drawing, fainter where wanted. Little-endian: the highest byte is alpha. */
export function stampOf(canvas: OffscreenCanvas, alpha: number): Stamp {
  const context = canvas.getContext("2d")!;
  const { data, width } = context.getImageData(0, 0, canvas.width, canvas.height);
  if (alpha < 1) for (let at = 3; at < data.length; at += 4) data[at] = Math.round(data[at]! * alpha);
  return { pixels: new Uint32Array(data.buffer), side: width };
}
