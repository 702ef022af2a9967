/** Hands for the editor: drawing an outline, dragging its corners, dragging an anchor. */
import Feature from "ol/Feature";
import type { Coordinate } from "ol/coordinate";
import Point from "ol/geom/Point";
import Polygon from "ol/geom/Polygon";
import Draw from "ol/interaction/Draw";
import Modify from "ol/interaction/Modify";
import type Interaction from "ol/interaction/Interaction";
import VectorLayer from "ol/layer/Vector";
import VectorSource from "ol/source/Vector";
import CircleStyle from "ol/style/Circle";
import Fill from "ol/style/Fill";
import Stroke from "ol/style/Stroke";
import Style from "ol/style/Style";
import type { Point2 } from "../api/types";
import type { MineMap } from "./mine-map";

/** To a decimetre, as outlines of mines are. */
const round = (value: number) => Math.round(value * 10) / 10;

export function outlineOf(ring: Coordinate[]): Point2[] {
  const open =
    ring.length > 1 && ring[0]![0] === ring.at(-1)![0] && ring[0]![1] === ring.at(-1)![1] ? ring.slice(0, -1) : ring;
  return open.map(([x = 0, y = 0]): Point2 => [round(x), round(y)]);
}

export class Drawing {
  readonly #source = new VectorSource();
  readonly #layer: VectorLayer;
  #hands: Interaction[] = [];

  constructor(
    private readonly map: MineMap,
    colour: string,
  ) {
    const stroke = new Stroke({ color: colour, width: 2.5 });
    const fill = new Fill({ color: `${colour}33` });
    const corner = new CircleStyle({ radius: 5.5, stroke, fill: new Fill({ color: "#ffffff" }) });
    this.#layer = new VectorLayer({
      source: this.#source,
      style: (feature) => {
        const shape = feature.getGeometry();
        const corners = new Style({
          image: corner,
          geometry: () => (shape instanceof Polygon ? new Polygon(shape.getCoordinates()) : (shape as Point)),
        });
        return shape instanceof Polygon
          ? [
              new Style({ stroke, fill }),
              ...shape.getCoordinates()[0]!.map((at) => new Style({ image: corner, geometry: new Point(at) })),
            ]
          : [corners];
      },
    });
    map.map.addLayer(this.#layer);
  }

  clear(): void {
    for (const hand of this.#hands) this.map.map.removeInteraction(hand);
    this.#hands = [];
    this.#source.clear();
  }

  /** A new outline, corner by corner; double click ends it. */
  draw(drawn: (outline: Point2[]) => void): void {
    this.clear();
    const draw = new Draw({ source: this.#source, type: "Polygon" });
    draw.on("drawend", (event) => {
      const shape = event.feature.getGeometry();
      this.map.map.removeInteraction(draw);
      if (shape instanceof Polygon) setTimeout(() => drawn(outlineOf(shape.getCoordinates()[0]!)));
    });
    this.#add(draw);
  }

  /** An outline whose corners can be dragged; a click on an edge makes a corner, with Alt one is taken away. */
  edit(outline: Point2[], changed: (outline: Point2[]) => void): void {
    this.clear();
    const shape = new Polygon([[...outline, outline[0]!]]);
    this.#source.addFeature(new Feature(shape));
    const modify = new Modify({ source: this.#source });
    modify.on("modifyend", () => changed(outlineOf(shape.getCoordinates()[0]!)));
    this.#add(modify);
  }

  /** A place that can be dragged. */
  move(at: Point2, moved: (at: Point2) => void): void {
    this.clear();
    const shape = new Point([...at]);
    this.#source.addFeature(new Feature(shape));
    const modify = new Modify({ source: this.#source, pixelTolerance: 20 });
    modify.on("modifyend", () => {
      const [x = 0, y = 0] = shape.getCoordinates();
      moved([round(x), round(y)]);
    });
    this.#add(modify);
  }

  #add(hand: Interaction): void {
    this.#hands.push(hand);
    this.map.map.addInteraction(hand);
  }
}
