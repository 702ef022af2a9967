import { expect, test } from "vitest";
import { search } from "./search";
import { Subject } from "./subject";

function named(id: string, name: string): Subject {
  const subject = new Subject(`p:${id}`);
  subject.person = id;
  subject.name = name;
  return subject;
}
const crew = [named("p1", "Anna Berger"), named("p2", "Bernd Anders"), named("p3", "张伟"), named("p4", "Hanna Otto")];

test("beginnings of names go before what lies within", () => {
  expect(search(crew, "an").map((it) => it.name)).toEqual(["Anna Berger", "Bernd Anders", "Hanna Otto"]);
});

test("finds by number and in Chinese", () => {
  expect(search(crew, "p3").map((it) => it.name)).toEqual(["张伟"]);
  expect(search(crew, "张").map((it) => it.person)).toEqual(["p3"]);
});

test("nothing typed finds nobody", () => {
  expect(search(crew, "  ")).toEqual([]);
});
