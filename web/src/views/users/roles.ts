import type { Grant, Role } from "../../api/types";

/** The least first. */
export const ROLES: readonly Role[] = ["viewer", "dispatcher", "safety-officer", "admin"];
/** What a token may be good for; for gateways first. */
export const GRANTS: readonly Grant[] = ["ingest", ...ROLES];
