/** Times, lengths and numbers as people read them. */
import { preferences } from "../app/preferences.svelte";
import { t } from "./index.svelte";

const locale = () => (preferences.language === "zh" ? "zh-CN" : "en-GB");

const pad = (value: number) => String(value).padStart(2, "0");

/** `14:03:09`, of the day's clock where the console stands. */
export function clock(time: number | string | null | undefined, seconds = true): string {
  if (time == null) return "–";
  const at = new Date(time);
  if (Number.isNaN(at.getTime())) return "–";
  const short = `${pad(at.getHours())}:${pad(at.getMinutes())}`;
  return seconds ? `${short}:${pad(at.getSeconds())}` : short;
}

export function day(time: number | string): string {
  return new Intl.DateTimeFormat(locale(), { weekday: "short", day: "numeric", month: "short" }).format(new Date(time));
}

/** Day and time. */
export function moment(time: number | string | null | undefined): string {
  return time == null ? "–" : `${day(time)} ${clock(time)}`;
}

/** `now`, `42 s`, `5 min`, `2 h 10 min`. */
export function age(seconds: number): string {
  if (!Number.isFinite(seconds)) return "–";
  if (seconds < 1.5) return t("time.now");
  if (seconds < 90) return t("time.s", { n: Math.round(seconds) });
  if (seconds < 5400) return t("time.min", { n: Math.round(seconds / 60) });
  return t("time.h-min", { h: Math.floor(seconds / 3600), min: pad(Math.floor((seconds % 3600) / 60)) });
}

/** `0:42`, `1:02:10`. */
export function stopwatch(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const rest = `${pad(Math.floor(whole / 60) % 60)}:${pad(whole % 60)}`;
  return whole >= 3600 ? `${Math.floor(whole / 3600)}:${rest}` : rest;
}

export function metres(length: number | null | undefined): string {
  if (length == null) return "–";
  const digits = Math.abs(length) < 10 ? 1 : 0;
  return `${length.toLocaleString(locale(), { minimumFractionDigits: digits, maximumFractionDigits: digits })} m`;
}

export function number(value: number | null | undefined, digits = 0): string {
  if (value == null) return "–";
  return value.toLocaleString(locale(), { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

export function percent(share: number | null | undefined): string {
  return share == null ? "–" : `${Math.round(share * 100)} %`;
}

/** For `<input type="datetime-local">`. */
export function localInput(time: number): string {
  const at = new Date(time);
  return `${at.getFullYear()}-${pad(at.getMonth() + 1)}-${pad(at.getDate())}T${pad(at.getHours())}:${pad(at.getMinutes())}`;
}
