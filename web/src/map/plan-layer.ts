/** The mine itself: roadways with their width, zones, refuges, ways out, devices. Drawn when the view changes, not when people move. */
import Layer from "ol/layer/Layer";
import type { FrameState } from "ol/Map";
import type { Mine, Point2, Roadway, Zone } from "../api/types";
import { zoneColour, type Palette } from "./palette";
import { Sheet, type View } from "./sheet";
import { Stack, boundsOf, levelAt } from "./stack";

/** Width of a roadway without one, m. */
const WIDTH_M = 4;
const SHAFT_KINDS = new Set(["shaft", "raise"]);

export interface PlanLook {
  mine: Mine;
  zones: Zone[];
  stack: Stack;
  /** Drawn fully; all where null. */
  level: string | null;
  palette: Palette;
  devices: boolean;
  /** Anchors that are silent. */
  down: Set<string>;
  zoneName: (zone: Zone) => string;
  levelName: (id: string) => string;
  /** Zones that the editor draws itself. */
  hidden: string | null;
}

export class PlanLayer extends Layer {
  readonly #sheet = new Sheet("plan");
  #look: PlanLook | null = null;

  show(look: PlanLook): void {
    this.#look = look;
    this.changed();
  }

  override render(frame: FrameState): HTMLElement {
    const view = this.#sheet.begin(frame);
    const context = this.#sheet.clear();
    if (this.#look) draw(context, view, this.#look);
    return this.#sheet.canvas;
  }
}

function draw(context: CanvasRenderingContext2D, view: View, look: PlanLook): void {
  const { mine, level, palette, stack } = look;
  context.lineCap = "round";
  context.lineJoin = "round";
  const on = (road: Roadway) => level === null || road.level === level;
  const between = mine.roadways.filter((road) => road.level == null);
  const levelled = mine.roadways.filter((road) => road.level != null);

  // Ways between levels, and faintly what lies on other levels.
  for (const road of between)
    way(context, view, look, road, palette.mineRamp, SHAFT_KINDS.has(road.kind) ? [2, 5] : [9, 6]);
  if (level !== null)
    for (const road of levelled) if (!on(road)) stroke(context, view, look, road, palette.mineOther, 0);

  // The walls of all first, then the floors: crossings stay open.
  const shown = levelled.filter(on);
  for (const road of shown) stroke(context, view, look, road, palette.mineCase, 2.4);
  chambers(context, view, look);
  for (const road of shown) stroke(context, view, look, road, palette.mineFill, 0);
  for (const zone of look.zones)
    if ((level === null || zone.level === level) && zone.id !== look.hidden) zoneArea(context, view, look, zone);
  if (view.scale > 0.9) doors(context, view, look);
  if (look.devices) devices(context, view, look);
  for (const zone of look.zones) if (level === null || zone.level === level) zoneMark(context, view, look, zone);
  if (stack.spread && level === null) titles(context, view, look);
}

function path(context: CanvasRenderingContext2D, view: View, points: Iterable<Point2>): void {
  context.beginPath();
  let first = true;
  for (const [x, y] of points) {
    if (first) context.moveTo(view.a * x + view.e, view.d * y + view.f);
    else context.lineTo(view.a * x + view.e, view.d * y + view.f);
    first = false;
  }
}

function lifted(look: PlanLook, road: Roadway): Point2[] {
  const own = look.stack.shiftOf(road.level);
  return road.points_m.map(([x, y, h]) => [x, y + (road.level == null ? look.stack.shiftOf(null, h) : own)]);
}

function stroke(
  context: CanvasRenderingContext2D,
  view: View,
  look: PlanLook,
  road: Roadway,
  colour: string,
  wall: number,
): void {
  path(context, view, lifted(look, road));
  context.setLineDash([]);
  context.strokeStyle = colour;
  context.lineWidth = Math.max((road.width_m ?? WIDTH_M) * view.scale, 3.4) + wall;
  context.stroke();
}

function way(
  context: CanvasRenderingContext2D,
  view: View,
  look: PlanLook,
  road: Roadway,
  colour: string,
  dash: number[],
): void {
  const points = lifted(look, road);
  context.strokeStyle = colour;
  const flat = points.every(([x, y]) => Math.hypot(x - points[0]![0], y - points[0]![1]) < 1);
  if (flat) {
    // A shaft in plan: a ring with a cross.
    const [x, y] = [view.a * points[0]![0] + view.e, view.d * points[0]![1] + view.f];
    const radius = Math.max(((road.width_m ?? WIDTH_M) / 2) * view.scale, 5);
    context.setLineDash([]);
    context.lineWidth = 1.6;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.moveTo(x - radius * 0.7, y - radius * 0.7);
    context.lineTo(x + radius * 0.7, y + radius * 0.7);
    context.moveTo(x - radius * 0.7, y + radius * 0.7);
    context.lineTo(x + radius * 0.7, y - radius * 0.7);
    context.stroke();
    return;
  }
  path(context, view, points);
  context.setLineDash(dash);
  context.lineWidth = 2;
  context.stroke();
  context.setLineDash([]);
}

function chambers(context: CanvasRenderingContext2D, view: View, look: PlanLook): void {
  for (const chamber of look.mine.chambers ?? []) {
    const level = levelAt(look.mine.levels, chamber.floor_m);
    if (look.level !== null && level !== look.level) continue;
    const shift = look.stack.shiftOf(level);
    path(
      context,
      view,
      chamber.outline_m.map(([x, y]): Point2 => [x, y + shift]),
    );
    context.closePath();
    context.fillStyle = look.palette.mineFill;
    context.strokeStyle = look.palette.mineCase;
    context.lineWidth = 2.4;
    context.fill();
    context.stroke();
  }
}

/** Hatching says the kind without its colour. */
const HATCH: Record<string, "lines" | "cross" | undefined> = { restricted: "lines", dangerous: "cross" };
const patterns = new Map<string, CanvasPattern | null>();

function hatch(context: CanvasRenderingContext2D, colour: string, kind: "lines" | "cross"): CanvasPattern | null {
  const key = `${colour} ${kind}`;
  const made = patterns.get(key);
  if (made !== undefined) return made;
  const tile = document.createElement("canvas");
  tile.width = tile.height = 8;
  const pen = tile.getContext("2d")!;
  pen.strokeStyle = colour;
  pen.lineWidth = 1.3;
  pen.beginPath();
  for (const at of [-8, 0, 8]) {
    pen.moveTo(at, 8);
    pen.lineTo(at + 8, 0);
    if (kind === "cross") {
      pen.moveTo(at, 0);
      pen.lineTo(at + 8, 8);
    }
  }
  pen.stroke();
  const pattern = context.createPattern(tile, "repeat");
  patterns.set(key, pattern);
  return pattern;
}

function zoneArea(context: CanvasRenderingContext2D, view: View, look: PlanLook, zone: Zone): void {
  const shift = look.stack.shiftOf(zone.level);
  const colour = zoneColour(look.palette, zone.kind);
  path(
    context,
    view,
    zone.outline_m.map(([x = 0, y = 0]): Point2 => [x, y + shift]),
  );
  context.closePath();
  context.globalAlpha = 0.16;
  context.fillStyle = colour;
  context.fill();
  const kind = HATCH[zone.kind];
  const pattern = kind && hatch(context, colour, kind);
  if (pattern) {
    context.globalAlpha = 0.5;
    context.fillStyle = pattern;
    context.fill();
  }
  context.globalAlpha = 0.9;
  context.strokeStyle = colour;
  context.lineWidth = 1.4;
  context.setLineDash(zone.kind === "key" ? [5, 4] : []);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

const MARKS: Record<string, string> = { refuge: "R", portal: "⇧", restricted: "⊘", dangerous: "!", key: "★" };

function zoneMark(context: CanvasRenderingContext2D, view: View, look: PlanLook, zone: Zone): void {
  const bounds = boundsOf(zone.outline_m as Point2[]);
  if (!bounds) return;
  const shift = look.stack.shiftOf(zone.level);
  const x = view.a * ((bounds.west + bounds.east) / 2) + view.e;
  const y = view.d * ((bounds.south + bounds.north) / 2 + shift) + view.f;
  if (x < -80 || y < -30 || x > view.width + 80 || y > view.height + 30) return;
  const colour = zoneColour(look.palette, zone.kind);
  const width = (bounds.east - bounds.west) * view.scale;
  const roomy = width > 26;
  const top = y - ((bounds.north - bounds.south) / 2) * view.scale;
  const size = 15;
  const markY = roomy ? top - 11 : y - 12;
  context.fillStyle = colour;
  context.beginPath();
  context.roundRect(x - size / 2, markY - size / 2, size, size, 3);
  context.fill();
  context.fillStyle = look.palette.ground;
  context.font = `700 11px ${look.palette.font}`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(MARKS[zone.kind] ?? "·", x, markY + 0.5);
  if (view.scale < 1.1 && zone.id !== look.hidden) return;
  context.font = `600 12px ${look.palette.font}`;
  context.lineWidth = 3;
  context.strokeStyle = look.palette.ground;
  context.fillStyle = colour;
  context.textAlign = "left";
  const name = look.zoneName(zone);
  context.strokeText(name, x + size / 2 + 4, markY);
  context.fillText(name, x + size / 2 + 4, markY);
}

function doors(context: CanvasRenderingContext2D, view: View, look: PlanLook): void {
  context.strokeStyle = look.palette.muted;
  context.lineWidth = 2.5;
  for (const door of look.mine.doors ?? []) {
    if (look.level !== null && door.level !== look.level) continue;
    const shift = look.stack.shiftOf(door.level);
    path(
      context,
      view,
      door.ends_m.map(([x, y]): Point2 => [x, y + shift]),
    );
    context.stroke();
  }
}

function devices(context: CanvasRenderingContext2D, view: View, look: PlanLook): void {
  const { mine, palette } = look;
  const size = view.scale > 1.5 ? 5 : 3.2;
  const spot = (position: readonly number[], level: string | null | undefined): Point2 | null => {
    const [x = 0, y = 0, h = 0] = position;
    const own = level ?? levelAt(mine.levels, h);
    if (look.level !== null && own !== look.level) return null;
    return [view.a * x + view.e, view.d * (y + look.stack.shiftOf(own)) + view.f];
  };
  for (const anchor of mine.anchors ?? []) {
    const at = spot(anchor.position_m, anchor.level);
    if (!at) continue;
    const down = look.down.has(anchor.id);
    context.strokeStyle = down ? palette.danger : palette.muted;
    context.fillStyle = down ? palette.danger : palette.ground;
    context.lineWidth = 1.4;
    context.beginPath();
    context.moveTo(at[0], at[1] - size);
    context.lineTo(at[0] + size, at[1] + size * 0.8);
    context.lineTo(at[0] - size, at[1] + size * 0.8);
    context.closePath();
    context.fill();
    context.stroke();
    if (down) {
      context.beginPath();
      context.moveTo(at[0] - 8, at[1] - 8);
      context.lineTo(at[0] + 8, at[1] + 8);
      context.stroke();
    }
  }
  context.strokeStyle = palette.muted;
  context.fillStyle = palette.ground;
  for (const point of mine.access_points ?? []) {
    const at = spot(point.position_m, point.level);
    if (!at) continue;
    context.beginPath();
    context.rect(at[0] - size * 0.8, at[1] - size * 0.8, size * 1.6, size * 1.6);
    context.fill();
    context.stroke();
  }
}

/** Names of the levels on the sheet of all. */
function titles(context: CanvasRenderingContext2D, view: View, look: PlanLook): void {
  context.textAlign = "left";
  context.textBaseline = "bottom";
  for (const level of look.stack.levels) {
    const bounds = boundsOf(Stack.pointsOf(look.mine, level.id));
    if (!bounds) continue;
    const x = view.a * bounds.west + view.e;
    const y = view.d * (bounds.north + look.stack.shiftOf(level.id)) + view.f;
    context.font = `650 14px ${look.palette.font}`;
    context.lineWidth = 4;
    context.strokeStyle = look.palette.ground;
    context.fillStyle = look.palette.mineText;
    const title = look.levelName(level.id);
    context.strokeText(title, x, y - 26);
    context.fillText(title, x, y - 26);
  }
}
