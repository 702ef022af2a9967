/** What somebody likes to see, kept in the browser. */
export type Theme = "system" | "dark" | "light";
export type Language = "en" | "zh";
export type Layout = "desk" | "wall";

const KEY = "adit.preferences";

interface Stored {
  theme: Theme;
  language: Language;
  layout: Layout;
  sound: boolean;
  volume: number;
  trails: boolean;
  circles: boolean;
  names: boolean;
  devices: boolean;
}

function load(): Stored {
  const preferred: Stored = {
    theme: "system",
    language: navigator.language.startsWith("zh") ? "zh" : "en",
    layout: "desk",
    sound: true,
    volume: 0.6,
    trails: true,
    circles: true,
    names: true,
    devices: false,
  };
  try {
    return { ...preferred, ...(JSON.parse(localStorage.getItem(KEY) ?? "{}") as Partial<Stored>) };
  } catch {
    return preferred;
  }
}

export const preferences = $state(load());

/** Kept and put on the page whenever something of it changes; to be called once. */
export function keepPreferences(): void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  let system = $state(dark.matches);
  dark.addEventListener("change", () => (system = dark.matches));
  $effect.root(() => {
    $effect(() => {
      try {
        localStorage.setItem(KEY, JSON.stringify(preferences));
      } catch {
        // Storage is full or forbidden: the preferences last as long as the page.
      }
    });
    $effect(() => {
      const { theme, layout, language } = preferences;
      const root = document.documentElement;
      root.dataset["theme"] = theme === "system" ? (system ? "dark" : "light") : theme;
      root.dataset["layout"] = layout;
      root.lang = language === "zh" ? "zh-CN" : "en";
      shown.theme = root.dataset["theme"] as "dark" | "light";
    });
  });
}

/** What is in force: `system` resolved. */
export const shown = $state<{ theme: "dark" | "light" }>({ theme: "dark" });
