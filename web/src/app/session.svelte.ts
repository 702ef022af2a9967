/** Who is logged in, and what they may do. */
import { ApiError, api, onLoggedOut } from "../api/client";
import type { Me } from "../api/types";

export type Permission =
  | "own-account"
  | "see-live"
  | "see-history"
  | "manage-people"
  | "handle-alarms"
  | "evacuate"
  | "end-evacuation"
  | "manage-zones"
  | "export"
  | "see-audit"
  | "manage-users"
  | "manage-tokens"
  | "see-settings";

/** The least role that has a permission, for whoever wonders why they may not. */
export const LEAST_ROLE: Record<Permission, string> = {
  "own-account": "viewer",
  "see-live": "viewer",
  "see-history": "dispatcher",
  "manage-people": "dispatcher",
  "handle-alarms": "dispatcher",
  evacuate: "dispatcher",
  "end-evacuation": "safety-officer",
  "manage-zones": "safety-officer",
  export: "safety-officer",
  "see-audit": "safety-officer",
  "manage-users": "admin",
  "manage-tokens": "admin",
  "see-settings": "admin",
};

type State = { is: "asking" } | { is: "out" } | { is: "unreachable" } | { is: "in"; me: Me };

export const session = $state<{ now: State }>({ now: { is: "asking" } });

export function me(): Me | null {
  return session.now.is === "in" ? session.now.me : null;
}

export function may(permission: Permission): boolean {
  return me()?.permissions.includes(permission) ?? false;
}

/** Asks the server who one is. False when nobody. */
export async function refresh(): Promise<boolean> {
  try {
    const found = await api.get<Me>("/api/v1/session");
    const known = me();
    if (JSON.stringify(known?.permissions) !== JSON.stringify(found.permissions) || known?.name !== found.name) {
      session.now = { is: "in", me: found };
    }
    return true;
  } catch (error) {
    if (error instanceof ApiError && error.code === 401) session.now = { is: "out" };
    else if (session.now.is !== "in") session.now = { is: "unreachable" };
    return session.now.is === "in";
  }
}

export async function logIn(name: string, password: string): Promise<void> {
  await api.post("/api/v1/session", { name, password });
  await refresh();
}

export async function logOut(): Promise<void> {
  try {
    await api.delete("/api/v1/session");
  } finally {
    session.now = { is: "out" };
  }
}

/** `#login=NAME:PASSWORD`: logs in at once and takes it from the address. */
async function logInByAddress(): Promise<boolean> {
  const found = /^#login=([^:]*):(.*)$/.exec(location.hash);
  if (!found) return false;
  history.replaceState(null, "", "#/map");
  try {
    await logIn(decodeURIComponent(found[1]!), decodeURIComponent(found[2]!));
    return me() !== null;
  } catch {
    return false;
  }
}

export async function begin(): Promise<void> {
  onLoggedOut(() => (session.now = { is: "out" }));
  // Also in a page that is open already: a password does not stay in the address.
  addEventListener("hashchange", () => void logInByAddress());
  if (!(await logInByAddress())) await refresh();
}
