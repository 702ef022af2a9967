/**
 * People on a canvas of their own: one pass for all, at the pace of the screen, without drawing the mine again. Dots are sprites
 * that were drawn once; those of a crowd are written as pixels.
 */
import Layer from "ol/layer/Layer";
import type { FrameState } from "ol/Map";
import type { Walker } from "../live/walker";
import type { Palette } from "./palette";
import { CrowdBitmap } from "./crowd-bitmap";
import { Sheet, type View } from "./sheet";
import { Sprites, colourOf } from "./sprites";
import type { Stack } from "./stack";

/** Draws at most so often, ms: people walk. */
const FRAME_MS = 30;
/** From this age on a position fades; at the second it is faint. s */
const FADE_FROM_S = 8;
const FADE_TO_S = 120;
const FAINT = 0.4;
/** Names and circles of so many at most. */
const NAMES = 120;
const NAMES_IN_A_CROWD = 25;
const CIRCLES = 600;
/** From so many on dots are pixels. */
const CROWD = 1200;
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
  #sprites: Sprites | null = null;
  readonly #crowd = new CrowdBitmap();
  #running = 0;
  #drawn = 0;
  #stale = true;
  #lastCost = 0;
  /** Of the last frames, ms: how long drawing took. For the tests. */
  readonly cost: number[] = [];
  #list: Shown[] = [];
  /** Called before each frame: following moves the view. */
  beforeFrame: (() => void) | null = null;

  constructor(private readonly source: PeopleSource) {
    super({});
  }

  show(look: PeopleLook): void {
    if (look.palette !== this.#look?.palette) this.#sprites = null;
    this.#look = look;
    this.#stale = true;
  }

  start(): void {
    const frame = () => {
      this.#running = requestAnimationFrame(frame);
      const wall = performance.now();
      // Half of the time is for everything else, however many there are to draw.
      if (wall - this.#drawn < Math.max(FRAME_MS, 2 * this.#lastCost)) return;
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

  /** Who is drawn now. */
  *shown(): Iterable<Walker> {
    for (const { walker } of this.#list) yield walker;
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
    const crowd = list.length > CROWD;
    if (!this.#sprites || this.#sprites.ratio !== view.ratio) this.#sprites = new Sprites(look.palette, view.ratio);
    if (crowd) this.#pixels(context, view, list, this.#sprites);
    if (look.circles) circles(context, look, list);
    if (look.trails) trails(context, view, look, list, nowMs);
    if (chosen) spotlight(context, view, look, chosen, nowMs);
    this.#dots(
      context,
      view,
      look,
      crowd ? list.filter(({ walker }) => walker.trouble !== "none") : list,
      this.#sprites,
    );
    if (look.names) names(context, view, look, list, chosen);
    if (this.cost.length > 600) this.cost.splice(0, 300);
    this.#lastCost = performance.now() - wall;
    this.cost.push(this.#lastCost);
  }

  /** Everybody in a crowd who has no trouble. */
  #pixels(context: CanvasRenderingContext2D, view: View, list: Shown[], sprites: Sprites): void {
    const size = list.length > 3000 ? 3 : 3.6;
    const { ratio } = view;
    this.#crowd.begin(context.canvas.width, context.canvas.height);
    for (const { walker, x, y, alpha } of list) {
      if (walker.trouble === "none") this.#crowd.put(sprites.stamp(walker, size, alpha < 0.8), x * ratio, y * ratio);
    }
    this.#crowd.end(context);
  }

  #dots(context: CanvasRenderingContext2D, view: View, look: PeopleLook, list: Shown[], sprites: Sprites): void {
    const size = view.scale < 0.5 && list.length > 600 ? 3.6 : 5.2;
    const order = (shown: Shown) => (shown.walker.trouble === "urgent" ? 2 : shown.walker.trouble === "known" ? 1 : 0);
    const troubled: Shown[] = [];
    for (const shown of list) {
      if (order(shown) > 0) troubled.push(shown);
      else this.#dot(context, look, shown, size, sprites);
    }
    troubled.sort((a, b) => order(a) - order(b));
    for (const shown of troubled) this.#dot(context, look, shown, size, sprites);
    context.globalAlpha = 1;
  }

  #dot(context: CanvasRenderingContext2D, look: PeopleLook, shown: Shown, size: number, sprites: Sprites): void {
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
    const sprite = sprites.of(walker, size);
    const half = sprite.width / sprites.ratio / 2;
    context.drawImage(sprite, x - half, y - half, half * 2, half * 2);
  }
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
  const most = list.length > 1500 ? NAMES_IN_A_CROWD : NAMES;
  let written = 0;
  context.font = `500 12px ${look.palette.font}`;
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = look.palette.ground;
  const write = ({ walker, x, y, alpha }: Shown, always: boolean) => {
    const cells = Math.ceil((walker.name.length * 7 + 14) / 24);
    const [column, row] = [Math.floor(x / 24), Math.floor((y - 8) / 6)];
    const key = (cell: number) => (row + (cell % 3)) * 4096 + column + Math.floor(cell / 3);
    if (!always) for (let cell = 0; cell < 3 * cells; cell += 1) if (taken.has(key(cell))) return;
    for (let cell = 0; cell < 3 * cells; cell += 1) taken.add(key(cell));
    written += 1;
    context.globalAlpha = Math.max(alpha, 0.6);
    context.fillStyle = walker.trouble === "urgent" ? look.palette.danger : look.palette.text;
    context.strokeText(walker.name, x + 12, y + 0.5);
    context.fillText(walker.name, x + 12, y + 0.5);
  };
  if (chosen) write(chosen, true);
  for (const shown of urgent) if (shown !== chosen && written < most) write(shown, false);
  for (const shown of candidates)
    if (shown !== chosen && written < most && shown.walker.trouble !== "urgent") write(shown, false);
  context.globalAlpha = 1;
}
