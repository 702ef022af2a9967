/** Alarms are heard: made tones, no files. Critical ones are repeated until somebody acknowledges. */
import type { Alarm } from "../api/types";
import { preferences } from "./preferences.svelte";

let context: AudioContext | null = null;

/** The browser lets a page be heard only after somebody has touched it. */
export const sound = $state({ blocked: false });

const TONES: Record<string, { hz: number[]; every: number }> = {
  critical: { hz: [880, 660, 880, 660], every: 0.16 },
  high: { hz: [740, 740], every: 0.2 },
  medium: { hz: [590], every: 0.2 },
  low: { hz: [440], every: 0.15 },
};
/** Between two calls of what nobody has acknowledged, ms. */
const AGAIN_MS: Record<string, number> = { critical: 5000, high: 20_000 };

function ready(): AudioContext | null {
  context ??= typeof AudioContext === "undefined" ? null : new AudioContext();
  if (context?.state === "suspended") void context.resume();
  sound.blocked = context !== null && context.state !== "running";
  return context;
}

export function unlock(): void {
  if (!preferences.sound) return;
  ready();
  setTimeout(() => (sound.blocked = context !== null && context.state !== "running"), 200);
}

export function play(severity: string): void {
  const audio = preferences.sound ? ready() : null;
  const tone = TONES[severity];
  if (!audio || !tone || audio.state !== "running") return;
  tone.hz.forEach((hz, index) => {
    const at = audio.currentTime + index * tone.every;
    const oscillator = audio.createOscillator();
    const gain = audio.createGain();
    oscillator.type = "triangle";
    oscillator.frequency.value = hz;
    gain.gain.setValueAtTime(0, at);
    gain.gain.linearRampToValueAtTime(preferences.volume * 0.5, at + 0.02);
    gain.gain.exponentialRampToValueAtTime(0.001, at + tone.every * 0.95);
    oscillator.connect(gain).connect(audio.destination);
    oscillator.start(at);
    oscillator.stop(at + tone.every);
  });
}

/** Tells what is new, and again what waits. */
export class Announcer {
  readonly #known = new Map<number, number>();
  #last = 0;

  /** `waiting`: unacknowledged alarms, the most urgent first. */
  hear(waiting: Alarm[], now: number): void {
    const numbers = new Set(waiting.map((alarm) => alarm.id));
    for (const id of this.#known.keys()) if (!numbers.has(id)) this.#known.delete(id);
    const fresh = waiting.find((alarm) => (this.#known.get(alarm.id) ?? -1) < alarm.escalation);
    for (const alarm of waiting) this.#known.set(alarm.id, alarm.escalation);
    const worst = waiting[0];
    const again = worst ? AGAIN_MS[worst.severity] : undefined;
    if (fresh) {
      this.#last = now;
      play(fresh.severity);
    } else if (worst && again !== undefined && now - this.#last >= again) {
      this.#last = now;
      play(worst.severity);
    }
  }
}
