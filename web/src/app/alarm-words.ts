/** Alarms in words, and what is done with them. */
import { api } from "../api/client";
import type { Alarm } from "../api/types";
import { keyOf } from "../live/subject";
import { t } from "../i18n/index.svelte";
import { levelAt } from "../map/stack";
import { levelName, nameOf, site, zoneName } from "./live.svelte";
import { attempt } from "./toasts.svelte";

/** Whom or what it is about. */
export function subjectOf(alarm: Alarm): string {
  const id = alarm.about_id ?? "";
  switch (alarm.about) {
    case "person":
      return nameOf(id);
    case "tag":
      return t("alarms.tag", { id });
    case "zone":
      return zoneName(id);
    case "gateway":
      return t("alarms.gateway", { id });
    case "anchor":
      return t("alarms.anchor", { id });
    default:
      return site.mine?.name ?? t("alarms.mine");
  }
}

/** Key of the subject on the map, where it is somebody. */
export function keyOfAlarm(alarm: Alarm): string | null {
  if (alarm.about === "person") return keyOf(alarm.about_id, null);
  if (alarm.about === "tag") return keyOf(null, alarm.about_id);
  return null;
}

export function placeOf(alarm: Alarm): string {
  const words: string[] = [];
  const zone = alarm.zone ?? (alarm.about === "zone" ? alarm.about_id : null);
  if (zone != null && alarm.about !== "zone") words.push(zoneName(zone));
  const level =
    site.zones.find((now) => now.zone.id === zone)?.zone.level ??
    (alarm.position_m ? levelAt(site.mine?.levels ?? [], alarm.position_m[2] ?? 0) : null);
  if (level != null) words.push(levelName(level));
  return words.join(", ") || "–";
}

const path = (alarm: Alarm) => `/api/v1/alarms/${alarm.id}`;

export const acknowledge = (alarm: Alarm) =>
  attempt(() => api.post(`${path(alarm)}/acknowledge`), t("alarms.acknowledged-toast", { who: subjectOf(alarm) }));
export const clearAlarm = (alarm: Alarm) =>
  attempt(() => api.post(`${path(alarm)}/clear`), t("alarms.cleared-toast", { who: subjectOf(alarm) }));
export const comment = (alarm: Alarm, text: string) => attempt(() => api.post(`${path(alarm)}/comments`, { text }));

/** Only a human can tell that these are over. */
export const BY_HAND = new Set(["distress", "man-down"]);
