/** Colours of the canvas, read from the tokens of the page. */
export interface Palette {
  ground: string;
  text: string;
  muted: string;
  panel: string;
  line: string;
  accent: string;
  danger: string;
  high: string;
  medium: string;
  good: string;
  fixed: string;
  reckoned: string;
  lost: string;
  mineCase: string;
  mineFill: string;
  mineOther: string;
  mineRamp: string;
  mineText: string;
  font: string;
}

export function readPalette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const token = (name: string) => style.getPropertyValue(`--${name}`).trim();
  return {
    ground: token("ground"),
    text: token("text"),
    muted: token("muted"),
    panel: token("panel"),
    line: token("line-strong"),
    accent: token("accent"),
    danger: token("danger"),
    high: token("high"),
    medium: token("medium"),
    good: token("good"),
    fixed: token("fixed"),
    reckoned: token("reckoned"),
    lost: token("lost"),
    mineCase: token("mine-case"),
    mineFill: token("mine-fill"),
    mineOther: token("mine-other"),
    mineRamp: token("mine-ramp"),
    mineText: token("mine-text"),
    font: token("font"),
  };
}

const ZONE_COLOURS: Record<string, keyof Palette> = {
  restricted: "high",
  dangerous: "danger",
  key: "accent",
  refuge: "good",
  portal: "good",
};

export function zoneColour(palette: Palette, kind: string): string {
  return palette[ZONE_COLOURS[kind] ?? "accent"];
}
