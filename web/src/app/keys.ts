/** The keyboard: one place for what works in all views. */
import { preferences } from "./preferences.svelte";
import { go, route } from "./router.svelte";

/** Views by digits after `g`, and what a view itself answers to. */
export interface KeyNeeds {
  views: () => string[];
  help: () => void;
}

type Handler = (event: KeyboardEvent) => boolean;
const handlers: Handler[] = [];

/** Keys of a view while it is shown; true when it took the key. */
export function onKeys(handler: Handler): () => void {
  handlers.push(handler);
  return () => {
    const at = handlers.indexOf(handler);
    if (at >= 0) handlers.splice(at, 1);
  };
}

const typing = (target: EventTarget | null) =>
  target instanceof HTMLElement && (target.isContentEditable || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName));

const VIEW_KEYS: Record<string, string> = {
  m: "map",
  a: "alarms",
  e: "evacuation",
  p: "people",
  r: "replay",
  t: "attendance",
  d: "radio",
  z: "editor",
  u: "users",
  l: "audit",
  s: "settings",
};

export function bindKeys(needs: KeyNeeds): () => void {
  let afterG = 0;
  const listener = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (typing(event.target) || document.querySelector("dialog[open]")) return;
    if (afterG > event.timeStamp - 1500 && VIEW_KEYS[event.key]) {
      afterG = 0;
      const view = VIEW_KEYS[event.key]!;
      if (needs.views().includes(view)) go(view);
      event.preventDefault();
      return;
    }
    for (const handler of [...handlers].reverse()) {
      if (handler(event)) {
        event.preventDefault();
        return;
      }
    }
    if (event.key === "g") afterG = event.timeStamp;
    else if (event.key === "?") needs.help();
    else if (event.key === "m") preferences.sound = !preferences.sound;
    else if (event.key === "/" && route.view !== "map" && route.view !== "people") go("map", null, { search: "1" });
    else return;
    event.preventDefault();
  };
  addEventListener("keydown", listener);
  return () => removeEventListener("keydown", listener);
}
