/** Words in the language that is chosen. A key that a language lacks does not compile. */
import { preferences, type Language } from "../app/preferences.svelte";
import { en } from "./en";
import { zh } from "./zh";

export type Key = keyof typeof en;
export type Words = Record<Key, string>;

const languages: Record<Language, Words> = { en, zh };

/** The words of a key, with `{name}` replaced. */
export function t(key: Key, values: Record<string, string | number> = {}): string {
  const words = languages[preferences.language][key];
  return words.replace(/\{(\w+)\}/g, (whole, name: string) => (name in values ? String(values[name]) : whole));
}

/** A word of the server (`lost-contact`) in the language; the word itself where it is not known. */
export function word(group: string, of: string | null | undefined): string {
  if (of == null) return "–";
  const key = `${group}.${of}`;
  return key in en ? t(key as Key) : of;
}
