/**
 * People on a canvas of their own: one pass for all, at the pace of the screen, without drawing the mine again. Ten thousand dots are sprites
 * that were drawn once.
 */
import Layer from "ol/layer/Layer";
import type { FrameState } from "ol/Map";
import type { Quality } from "../api/types";
import type { Walker } from "../live/walker";
import type { Palette } from "./palette";
import { Sheet, type View } from "./sheet";
import type { Stack } from "./stack";

/** Draws at most so often, ms: people walk. */
const FRAME_MS = 30;
/** From this age on a position fades; at the second it is faint. s */
const FADE_FROM_S = 8;
const FADE_TO_S = 120;
const FAINT = 0.4;
/** Names and circles of so many at most. */
const NAMES = 120;
const CIRCLES = 600;
const TRAILS = 150;

export interface PeopleLook {
  stack: Stack;
  level: string | null;
  palette: Palette;
  selected: string | null;
  names: boolean;
  trails: boolean;
  circles: boolean;
  /** How long trails are, ms. */
  trailMs: number;
}

/** Who is to be drawn, and what time it is for them. */
export interface PeopleSource {
  walkers(): Iterable<Walker>;
  nowMs(): number;
  radius(walker: Walker, nowMs: number): number;
}

interface Shown {
  walker: Walker;
  x: number;
  y: number;
  alpha: number;
  radius: number;
}

export class PeopleLayer extends Layer {
  readonly #sheet = new Sheet("people");
  #look: PeopleLook | null = null;
  #sprites = new Map<string, HTMLCanvasElement>();
  #spritesOf: Palette | null = null;
  #running = 0;
  #drawn = 0;
  #stale = true;
  /** Of the last frames, ms: how long drawing took. For the tests. */
  readonly cost: number[] = [];
  #list: Shown[] = [];
  /** Called before each frame: following moves the view. */
  beforeFrame: (() => void) | null = null;

  constructor(private readonly source: PeopleSource) {
    super({});
  }

  show(look: PeopleLook): void {
    if (look.palette !== this.#spritesOf) this.#sprites.clear();
    this.#spritesOf = look.palette;
    this.#look = look;
    this.#stale = true;
  }

  start(): void {
    const frame = () => {
      this.#running = requestAnimationFrame(frame);
      const wall = performance.now();
      if (wall - this.#drawn < FRAME_MS) return;
      if (this.#advance(wall) || this.#stale || wall - this.#drawn > 1000) {
        this.beforeFrame?.();
        this.#draw(wall);
      }
    };
    this.#running = requestAnimationFrame(frame);
  }

  stop(): void {
    cancelAnimationFrame(this.#running);
  }

  override render(frame: FrameState): HTMLElement {
    this.#sheet.begin(frame);
    this.#draw(performance.now());
    return this.#sheet.canvas;
  }

  /** Who is drawn nearest to a pixel, within reach. */
  at(pixel: readonly number[], reach = 16): Walker | null {
    let nearest: Walker | null = null;
    let least = reach;
    for (const { walker, x, y } of this.#list) {
      const distance = Math.hypot(x - pixel[0]!, y - pixel[1]!);
      if (distance < least) {
        least = distance;
        nearest = walker;
      }
    }
    return nearest;
  }

  #advance(wall: number): boolean {
    let moved = false;
    for (const walker of this.source.walkers()) if (walker.advance(wall)) moved = true;
    return moved;
  }

  #draw(wall: number): void {
    const look = this.#look;
    if (!this.#sheet.view || !look) return;
    this.#drawn = wall;
    this.#stale = false;
    const view = this.#sheet.view;
    const context = this.#sheet.clear();
    const nowMs = this.source.nowMs();
    const list: Shown[] = [];
    let chosen: Shown | null = null;
    for (const walker of this.source.walkers()) {
      if (walker.fixMs === 0) continue;
      const own = walker.key === look.selected;
      if (look.level !== null && walker.level !== null && walker.level !== look.level && !own) continue;
      const x = view.a * walker.x + view.e;
      const y = view.d * (walker.y + look.stack.shiftOf(walker.level, walker.height)) + view.f;
      if (x < -20 || y < -20 || x > view.width + 20 || y > view.height + 20) continue;
      const age = (nowMs - walker.fixMs) / 1000;
      const alpha = age < FADE_FROM_S ? 1 : Math.max(FAINT, 1 - (age - FADE_FROM_S) / FADE_TO_S);
      const shown = { walker, x, y, alpha, radius: this.source.radius(walker, nowMs) * view.scale };
      list.push(shown);
      if (own) chosen = shown;
    }
    this.#list = list;
    if (look.circles) circles(context, look, list);
    if (look.trails) trails(context, view, look, list, nowMs);
    if (chosen) spotlight(context, view, look, chosen, nowMs);
    this.#dots(context, view, look, list);
    if (look.names) names(context, view, look, list, chosen);
    if (this.cost.length > 600) this.cost.splice(0, 300);
    this.cost.push(performance.now() - wall);
  }

  #dots(context: CanvasRenderingContext2D, view: View, look: PeopleLook, list: Shown[]): void {
    const size = list.length > 3000 ? 3 : view.scale < 0.5 && list.length > 600 ? 3.6 : 5.2;
    const order = (shown: Shown) => (shown.walker.trouble === "urgent" ? 2 : shown.walker.trouble === "known" ? 1 : 0);
    const troubled: Shown[] = [];
    for (const shown of list) {
      if (order(shown) > 0) troubled.push(shown);
      else this.#dot(context, view, look, shown, size);
    }
    troubled.sort((a, b) => order(a) - order(b));
    for (const shown of troubled) this.#dot(context, view, look, shown, size);
    context.globalAlpha = 1;
  }

  #dot(context: CanvasRenderingContext2D, view: View, look: PeopleLook, shown: Shown, size: number): void {
    const { walker, x, y, alpha } = shown;
    context.globalAlpha = alpha;
    if (walker.heading !== null && size > 4) {
      const [dx, dy] = [Math.sin(walker.heading), -Math.cos(walker.heading)];
      context.fillStyle = colourOf(look.palette, walker.quality);
      context.beginPath();
      context.moveTo(x + dx * (size + 6.5), y + dy * (size + 6.5));
      context.lineTo(x - dy * 4 + dx * (size - 0.5), y + dx * 4 + dy * (size - 0.5));
      context.lineTo(x + dy * 4 + dx * (size - 0.5), y - dx * 4 + dy * (size - 0.5));
      context.fill();
    }
    const sprite = this.#sprite(look.palette, walker, walker.inContact, size, view.ratio);
    const half = sprite.width / view.ratio / 2;
    context.drawImage(sprite, x - half, y - half, half * 2, half * 2);
  }

  /** Filled: measured. Half: reckoned. Hollow: lost or not heard. Square: a vehicle. A triangle above: an alarm. */
  #sprite(palette: Palette, walker: Walker, heard: boolean, size: number, ratio: number): HTMLCanvasElement {
    const key = `${walker.quality} ${walker.kind} ${walker.trouble} ${heard ? 1 : 0} ${size} ${ratio}`;
    const made = this.#sprites.get(key);
    if (made) return made;
    const sprite = document.createElement("canvas");
    const half = size + 13;
    sprite.width = sprite.height = Math.ceil(half * 2 * ratio);
    const pen = sprite.getContext("2d")!;
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
    this.#sprites.set(key, sprite);
    return sprite;
  }
}

export function colourOf(palette: Palette, quality: Quality): string {
  return quality === "fixed" ? palette.fixed : quality === "dead-reckoning" ? palette.reckoned : palette.lost;
}

/** One path for all of a quality. */
function circles(context: CanvasRenderingContext2D, look: PeopleLook, list: Shown[]): void {
  context.lineWidth = 1;
  context.globalAlpha = 0.45;
  for (const quality of ["fixed", "dead-reckoning", "lost"] as const) {
    context.strokeStyle = colourOf(look.palette, quality);
    context.beginPath();
    let count = 0;
    for (const { walker, x, y, radius } of list) {
      if (walker.quality !== quality || radius < 9 || count >= CIRCLES) continue;
      count += 1;
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
    context.stroke();
  }
  context.globalAlpha = 1;
}

function trails(context: CanvasRenderingContext2D, view: View, look: PeopleLook, list: Shown[], nowMs: number): void {
  if (list.length > TRAILS) return;
  context.lineWidth = 1.6;
  context.globalAlpha = 0.4;
  for (const shown of list) trail(context, view, look, shown, nowMs - look.trailMs);
  context.globalAlpha = 1;
}

function trail(
  context: CanvasRenderingContext2D,
  view: View,
  look: PeopleLook,
  { walker, x, y }: Shown,
  sinceMs: number,
): void {
  const shift = look.stack.shiftOf(walker.level, walker.height);
  context.strokeStyle = colourOf(look.palette, walker.quality);
  context.beginPath();
  let first = true;
  walker.trail.each(sinceMs, (east, north) => {
    const [px, py] = [view.a * east + view.e, view.d * (north + shift) + view.f];
    if (first) context.moveTo(px, py);
    else context.lineTo(px, py);
    first = false;
  });
  if (first) return;
  context.lineTo(x, y);
  context.stroke();
}

/** Who is selected: their circle filled, their way, a ring. */
function spotlight(context: CanvasRenderingContext2D, view: View, look: PeopleLook, shown: Shown, nowMs: number): void {
  const colour = colourOf(look.palette, shown.walker.quality);
  context.fillStyle = colour;
  context.strokeStyle = colour;
  if (shown.radius > 4) {
    context.beginPath();
    context.arc(shown.x, shown.y, shown.radius, 0, 2 * Math.PI);
    context.globalAlpha = 0.14;
    context.fill();
    context.globalAlpha = 0.9;
    context.lineWidth = 1.5;
    context.setLineDash([6, 4]);
    context.stroke();
    context.setLineDash([]);
  }
  context.lineWidth = 2.5;
  context.globalAlpha = 0.85;
  trail(context, view, look, shown, nowMs - look.trailMs);
  context.globalAlpha = 1;
  context.strokeStyle = look.palette.text;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(shown.x, shown.y, 12, 0, 2 * Math.PI);
  context.stroke();
}

/** Names where there is room: a name is left out that would lie over another. */
function names(
  context: CanvasRenderingContext2D,
  view: View,
  look: PeopleLook,
  list: Shown[],
  chosen: Shown | null,
): void {
  const urgent = list.filter((shown) => shown.walker.trouble === "urgent");
  const candidates = view.scale > 1.2 && list.length < 1500 ? list : urgent;
  const taken = new Set<number>();
  let written = 0;
  context.font = `500 12px ${look.palette.font}`;
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = look.palette.ground;
  const write = ({ walker, x, y, alpha }: Shown, always: boolean) => {
    const cells = Math.ceil((walker.name.length * 7 + 14) / 24);
    const [column, row] = [Math.floor(x / 24), Math.floor(y / 16)];
    const key = (cell: number) => row * 4096 + column + cell;
    if (!always) for (let cell = 0; cell < cells; cell += 1) if (taken.has(key(cell))) return;
    for (let cell = 0; cell < cells; cell += 1) taken.add(key(cell));
    written += 1;
    context.globalAlpha = Math.max(alpha, 0.6);
    context.fillStyle = walker.trouble === "urgent" ? look.palette.danger : look.palette.text;
    context.strokeText(walker.name, x + 12, y + 0.5);
    context.fillText(walker.name, x + 12, y + 0.5);
  };
  if (chosen) write(chosen, true);
  for (const shown of urgent) if (shown !== chosen && written < NAMES) write(shown, false);
  for (const shown of candidates)
    if (shown !== chosen && written < NAMES && shown.walker.trouble !== "urgent") write(shown, false);
  context.globalAlpha = 1;
}
