/** A map of the mine in its own grid: OpenLayers' view and hands, our own layers. */
import OlMap from "ol/Map";
import View from "ol/View";
import { defaults as interactions } from "ol/interaction/defaults";
import type BaseLayer from "ol/layer/Base";
import Projection from "ol/proj/Projection";
import type { Mine, Point3 } from "../api/types";
import { PeopleLayer, type PeopleLook, type PeopleSource } from "./people-layer";
import { PlanLayer, type PlanLook } from "./plan-layer";
import { Stack, boundsOf, type Bounds } from "./stack";

/** Metres of a pixel at zoom 0; each zoom halves it. */
const COARSEST = 8;
const ZOOMS = 10;
const PAD_M = 400;

export interface Spot {
  east: number;
  north: number;
  zoom: number;
}

export class MineMap {
  readonly map: OlMap;
  readonly plan = new PlanLayer({});
  readonly people: PeopleLayer;
  readonly #projection: Projection;
  #fittedTo = "";

  constructor(
    element: HTMLElement,
    mine: Mine,
    source: PeopleSource,
    private readonly does: {
      select?: (key: string | null) => void;
      moved?: (spot: Spot) => void;
      scale?: (pixelsPerMetre: number) => void;
    },
  ) {
    this.#projection = new Projection({ code: `mine:${mine.name}`, units: "m" });
    this.people = new PeopleLayer(source);
    this.map = new OlMap({
      target: element,
      controls: [],
      interactions: interactions({ altShiftDragRotate: false, pinchRotate: false, keyboard: true }),
      layers: [this.plan, this.people],
      view: new View({
        projection: this.#projection,
        center: [0, 0],
        resolution: 1,
        maxResolution: COARSEST,
        minResolution: COARSEST / 2 ** ZOOMS,
        constrainResolution: false,
        showFullExtent: true,
        enableRotation: false,
      }),
    });
    this.map.on("singleclick", (event) => this.does.select?.(this.people.at(event.pixel)?.key ?? null));
    this.map.on("pointermove", (event) => {
      if (!event.dragging) element.style.cursor = this.people.at(event.pixel) ? "pointer" : "";
    });
    this.map.on("moveend", () => {
      const spot = this.spot();
      if (spot) this.does.moved?.(spot);
    });
    this.map.getView().on("change:resolution", () => this.does.scale?.(1 / (this.map.getView().getResolution() ?? 1)));
    this.people.start();
  }

  add(layer: BaseLayer): void {
    this.map.getLayers().insertAt(1, layer);
  }

  show(plan: PlanLook, people: PeopleLook): void {
    this.plan.show(plan);
    this.people.show(people);
    this.map.render();
  }

  /** Shows a whole level, or the sheet of all. Once for each, unless forced. */
  fit(mine: Mine, stack: Stack, level: string | null, force = false): void {
    const key = `${level ?? "*"} ${stack.spread}`;
    if (!force && key === this.#fittedTo) return;
    this.#fittedTo = key;
    const bounds = sheetBounds(mine, stack, level);
    if (bounds) this.fitBounds(bounds);
  }

  fitBounds(bounds: Bounds, animate = false): void {
    const [width, height] = this.map.getSize() ?? [800, 600];
    const pad = Math.min(60, width! / 10, height! / 10);
    this.map.getView().fit([bounds.west, bounds.south, bounds.east, bounds.north], {
      padding: [height! > 500 ? pad + 44 : pad, pad, pad, pad],
      minResolution: 0.12,
      duration: animate ? 250 : 0,
    });
  }

  spot(): Spot | null {
    const center = this.map.getView().getCenter();
    const resolution = this.map.getView().getResolution();
    if (!center || !resolution) return null;
    return { east: center[0]!, north: center[1]!, zoom: Math.log2(COARSEST / resolution) };
  }

  goTo(spot: Spot, animate = false): void {
    const view = this.map.getView();
    const resolution = COARSEST / 2 ** spot.zoom;
    this.#fittedTo = "elsewhere";
    if (animate) {
      view.animate({ center: [spot.east, spot.north], resolution, duration: 300 });
    } else {
      view.setCenter([spot.east, spot.north]);
      view.setResolution(resolution);
    }
  }

  /** Marks that the view was chosen: it is not fitted any more. */
  keepView(level: string | null, stack: Stack): void {
    this.#fittedTo = `${level ?? "*"} ${stack.spread}`;
  }

  zoomBy(steps: number): void {
    const view = this.map.getView();
    view.animate({ zoom: (view.getZoom() ?? 0) + steps, duration: 160 });
  }

  panBy(right: number, down: number): void {
    const view = this.map.getView();
    const [x = 0, y = 0] = view.getCenter() ?? [];
    const resolution = view.getResolution() ?? 1;
    view.animate({ center: [x + right * resolution, y - down * resolution], duration: 120 });
  }

  centre(east: number, north: number): void {
    this.map.getView().setCenter([east, north]);
  }

  dispose(): void {
    this.people.stop();
    this.map.setTarget(undefined);
    this.map.dispose();
  }
}

export function sheetBounds(mine: Mine, stack: Stack, level: string | null): Bounds | null {
  const points: Point3[] = [];
  for (const road of mine.roadways) {
    if (level !== null && road.level !== level) continue;
    const shift = stack.shiftOf(road.level);
    for (const [x, y, h] of road.points_m)
      points.push([x, y + (road.level == null ? stack.shiftOf(null, h) : shift), h]);
  }
  for (const zone of mine.zones ?? []) {
    if (level !== null && zone.level !== level) continue;
    for (const [x = 0, y = 0] of zone.outline_m) points.push([x, y + stack.shiftOf(zone.level), 0]);
  }
  return boundsOf(points) ?? { west: -PAD_M, south: -PAD_M, east: PAD_M, north: PAD_M };
}
