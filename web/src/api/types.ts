/** Names of the API's types; the mine's plan, which the API hands on as its file has it. */
import type { components } from "./schema";

type Schemas = components["schemas"];
export type Alarm = Schemas["Alarm"];
export type AlarmPage = Schemas["AlarmPage"];
export type Alarms = Schemas["Alarms"];
export type Device = Schemas["Device"];
export type Evacuation = Schemas["Evacuation"];
export type Evacuee = Schemas["Evacuee"];
export type EvacuationSummary = Schemas["EvacuationSummary"];
export type ApiEvent = Schemas["Event"];
export type EventPage = Schemas["EventPage"];
export type Following = Schemas["Following"];
export type Headcount = Schemas["Headcount"];
export type HealthReport = Schemas["HealthReport"];
export type Live = Schemas["Live"];
export type Me = Schemas["Me"];
export type Person = Schemas["Person"];
export type PersonNow = Schemas["PersonNow"];
export type Shift = Schemas["Shift"];
export type Tag = Schemas["Tag"];
export type TagNow = Schemas["TagNow"];
export type Track = Schemas["Track"];
export type TrackFix = Schemas["TrackFix"];
export type User = Schemas["User"];
export type Token = Schemas["Token"];
export type MadeToken = Schemas["MadeToken"];
export type Grant = Schemas["Grant"];
export type AuditRow = Schemas["AuditRow"];
export type Verification = Schemas["Verification"];
export type Role = Schemas["Role"];
export type Where = Schemas["Where"];
export type Zone = Schemas["Zone"];
export type ZoneKind = Schemas["ZoneKind"];
export type ZoneNow = Schemas["ZoneNow"];

/** `quality` of a position. */
export type Quality = "fixed" | "dead-reckoning" | "lost";
/** `severity` of an alarm. */
export type Severity = "critical" | "high" | "medium" | "low";

export type Point3 = [number, number, number];
export type Point2 = [number, number];

export interface Level {
  id: string;
  name?: string | null;
  elevation_m: number;
}
export interface Roadway {
  id: string;
  name?: string | null;
  kind: string;
  level?: string | null;
  width_m?: number | null;
  points_m: Point3[];
}
export interface Anchor {
  id: string;
  name?: string | null;
  position_m: Point3;
  level?: string | null;
}
/** `GET /api/v1/mine/anchors`: the plan's anchors with what was changed; `position_m` is null where one is taken away. */
export interface AnchorChange {
  id: string;
  name?: string | null;
  position_m: Point3 | null;
  position_now_m?: Point3 | null;
  in_force: string;
}
export interface AccessPoint {
  id: string;
  radio?: string | null;
  position_m: Point3;
  level?: string | null;
}
export interface Chamber {
  id: string;
  floor_m: number;
  outline_m: Point2[];
}

/** The mine's plan, `schema/mine.json`: what of it the console draws. */
export interface Mine {
  name: string;
  levels: Level[];
  roadways: Roadway[];
  chambers?: Chamber[];
  anchors?: Anchor[];
  access_points?: AccessPoint[];
  conveyors?: { id: string; points_m: Point3[] }[];
  doors?: { id: string; level?: string | null; ends_m: [Point2, Point2] }[];
  rfid_portals?: { id: string; position_m: Point3 }[];
  junctions?: { id: string; name?: string | null; position_m: Point3 }[];
  zones?: Zone[];
}

/** `GET /api/v1/history/positions`: what a replay plays. */
export interface HistoryPositions {
  from: string;
  until: string;
  step_s: number;
  people: {
    person: string | null;
    tag: string | null;
    time_s: number[];
    position_m: Point3[];
    radius_95_m: number[];
    quality: string[];
    level: (string | null)[];
  }[];
}

/** Messages of `/api/v1/live/socket`. */
export interface Moved extends Where {
  person: string | null;
}
export type LiveMessage =
  | {
      type: "snapshot";
      run: string;
      event: number;
      tick: number;
      time: string;
      clock_speed?: number;
      live: Live[];
      alarms: Alarm[];
      headcount: Headcount;
      evacuation: Evacuation | null;
    }
  | { type: "resumed"; run: string; event: number; tick: number; time?: string; clock_speed?: number }
  | { type: "positions"; tick: number; positions: Moved[] }
  | { type: "event"; number: number; body: ApiEvent };
