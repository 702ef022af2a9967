/** Short words about what was done, or was not. */
import { ApiError } from "../api/client";
import { t, type Key } from "../i18n/index.svelte";

export interface Toast {
  id: number;
  kind: "good" | "bad";
  text: string;
}

export const toasts = $state<Toast[]>([]);
let last = 0;

export function say(text: string, kind: Toast["kind"] = "good"): void {
  const id = (last += 1);
  toasts.push({ id, kind, text });
  setTimeout(() => dismiss(id), kind === "bad" ? 9000 : 4000);
}

export function dismiss(id: number): void {
  const at = toasts.findIndex((toast) => toast.id === id);
  if (at >= 0) toasts.splice(at, 1);
}

/** An error in words: what kind it is in the reader's language, and what the server said. */
export function inWords(error: unknown): string {
  if (!(error instanceof ApiError)) return error instanceof Error ? error.message : String(error);
  const kinds: Record<number, Key> = {
    0: "error.unreachable",
    401: "error.401",
    403: "error.403",
    404: "error.404",
    409: "error.409",
    422: "error.422",
    429: "error.429",
    503: "error.503",
  };
  const kind = kinds[error.code];
  if (!kind) return error.message;
  return error.code === 0 ? t(kind) : `${t(kind)}: ${error.message}`;
}

/** Does it, and says what came of it. True when it was done. */
export async function attempt(work: () => Promise<unknown>, done?: string): Promise<boolean> {
  try {
    await work();
    if (done) say(done);
    return true;
  } catch (error) {
    say(inWords(error), "bad");
    return false;
  }
}
