/** Requests to the server, by the session's cookie. */

/** What the server says it did not do. */
export class ApiError extends Error {
  constructor(
    /** HTTP status; 0 where no answer came. */
    readonly code: number,
    /** Kind of error, as the server names it. */
    readonly kind: string,
    message: string,
  ) {
    super(message);
  }
}

/** Called when the session is no longer valid. */
let whenLoggedOut: () => void = () => undefined;
export function onLoggedOut(then: () => void): void {
  whenLoggedOut = then;
}

export type Query = Record<string, string | number | undefined>;

export function address(path: string, query: Query = {}): string {
  const words = Object.entries(query).filter((entry): entry is [string, string | number] => entry[1] !== undefined);
  const search = new URLSearchParams(words.map(([name, value]) => [name, String(value)])).toString();
  return search ? `${path}?${search}` : path;
}

async function problem(answer: Response): Promise<ApiError> {
  const text = await answer.text();
  try {
    const body = JSON.parse(text) as { type?: string; message?: string };
    return new ApiError(answer.status, body.type ?? "", body.message ?? answer.statusText);
  } catch {
    return new ApiError(answer.status, "", answer.statusText);
  }
}

async function ask(method: string, url: string, body?: unknown, signal?: AbortSignal): Promise<Response> {
  const init: RequestInit = { method, credentials: "same-origin" };
  if (signal) init.signal = signal;
  if (body !== undefined) {
    init.body = JSON.stringify(body);
    init.headers = { "Content-Type": "application/json" };
  }
  let answer: Response;
  try {
    answer = await fetch(url, init);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new ApiError(0, "unreachable", "the server cannot be reached");
  }
  if (answer.ok) return answer;
  const error = await problem(answer);
  const tryingToLogIn = method === "POST" && url.endsWith("/api/v1/session");
  if (error.code === 401 && !tryingToLogIn) whenLoggedOut();
  throw error;
}

async function json<T>(answer: Response): Promise<T> {
  if (answer.status === 204) return undefined as T;
  return (await answer.json()) as T;
}

export const api = {
  get: async <T>(path: string, query: Query = {}, signal?: AbortSignal): Promise<T> =>
    json<T>(await ask("GET", address(path, query), undefined, signal)),
  text: async (path: string): Promise<string> => (await ask("GET", path)).text(),
  post: async <T>(path: string, body: unknown = {}): Promise<T> => json<T>(await ask("POST", path, body)),
  put: async <T>(path: string, body: unknown): Promise<T> => json<T>(await ask("PUT", path, body)),
  patch: async <T>(path: string, body: unknown): Promise<T> => json<T>(await ask("PATCH", path, body)),
  delete: async <T>(path: string): Promise<T> => json<T>(await ask("DELETE", path)),
};

/** A part of a path that may be anything. */
export const part = encodeURIComponent;
