import { expect, test } from "vitest";
import { en } from "./en";
import { zh } from "./zh";

const places = (words: string) => [...words.matchAll(/\{(\w+)\}/g)].map((it) => it[1]).sort();

test("each language fills the same places", () => {
  for (const [key, words] of Object.entries(en))
    expect([key, places(zh[key as keyof typeof en])]).toEqual([key, places(words)]);
});

test("Chinese is Chinese", () => {
  const same = Object.entries(zh).filter(([key, words]) => words === en[key as keyof typeof en]);
  expect(same.map(([key]) => key)).toEqual(["radio.nis"]);
});
