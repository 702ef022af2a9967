/** Views by the address' hash: `#/people/p1?from=…`. */
export interface Route {
  view: string;
  id: string | null;
  query: Record<string, string>;
  /** Counted up with every step by a link; not by `note`. */
  visit: number;
}

let visits = 0;

function split(hash: string): Pick<Route, "view" | "id" | "query"> {
  // `#login=…` is no view: the session takes it from the address.
  const [path = "", search = ""] = (hash.startsWith("#login=") ? "" : hash).replace(/^#\/?/, "").split("?");
  const [view = "", id] = path.split("/");
  return {
    view: view || "map",
    id: id ? decodeURIComponent(id) : null,
    query: Object.fromEntries(new URLSearchParams(search)),
  };
}

function parse(hash: string): Route {
  return { ...split(hash), visit: (visits += 1) };
}

export const route = $state<Route>(parse(location.hash));

export function link(view: string, id?: string | null, query: Record<string, string> = {}): string {
  const search = new URLSearchParams(query).toString();
  return `#/${view}${id != null ? `/${encodeURIComponent(id)}` : ""}${search ? `?${search}` : ""}`;
}

export function go(view: string, id?: string | null, query: Record<string, string> = {}): void {
  location.hash = link(view, id, query);
}

/** Changes the query in place, without a step in the browser's history. */
export function note(query: Record<string, string>): void {
  const { view, id } = route;
  // A link was followed, and its event has not come yet: the address is not ours any more.
  const now = split(location.hash);
  if (now.view !== view || now.id !== id) return;
  history.replaceState(null, "", link(view, id, query));
  route.query = query;
}

export function followAddress(): void {
  addEventListener("hashchange", () => {
    if (location.hash.startsWith("#login=")) return;
    Object.assign(route, parse(location.hash));
  });
}
