/** The live WebSocket, kept open: opened again after every break, from where it broke. */
import { address } from "../api/client";
import type { LiveMessage } from "../api/types";

export type Link = "connecting" | "open" | "broken";

export interface SocketNeeds {
  url: string;
  /** Where to go on, as the last messages said. */
  place: () => { run: string; event: number; tick: number } | null;
  message: (message: LiveMessage) => void;
  link: (link: Link) => void;
  /** Asked after every failure: false ends it (nobody is logged in). */
  allowed: () => Promise<boolean>;
  open?: (url: string) => WebSocket;
}

const WAIT_MS = [300, 700, 1500, 3000, 5000];
/** A server that says nothing for so long, not even a position, is asked whether it is there, ms. */
const SILENT_MS = 20_000;

export class LiveSocket {
  #socket: WebSocket | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #watchdog: ReturnType<typeof setInterval> | undefined;
  #failures = 0;
  #ended = false;
  #heard = 0;

  constructor(private readonly needs: SocketNeeds) {}

  start(): void {
    this.#ended = false;
    this.#open();
    this.#watchdog = setInterval(() => void this.#check(), SILENT_MS / 2);
  }

  stop(): void {
    this.#ended = true;
    clearTimeout(this.#timer);
    clearInterval(this.#watchdog);
    this.#socket?.close();
    this.#socket = null;
  }

  /** Does not wait any longer: the network is said to be back. */
  hurry(): void {
    if (this.#ended || this.#socket) return;
    clearTimeout(this.#timer);
    this.#open();
  }

  #open(): void {
    this.needs.link(this.#failures > 0 ? "broken" : "connecting");
    const url = address(this.needs.url, { ...this.needs.place() });
    const socket = this.needs.open?.(url) ?? new WebSocket(url);
    this.#socket = socket;
    socket.onmessage = (event: MessageEvent<string>) => {
      this.#heard = Date.now();
      if (this.#failures > 0 || !this.#told) {
        this.#failures = 0;
        this.#told = true;
        this.needs.link("open");
      }
      this.needs.message(JSON.parse(event.data) as LiveMessage);
    };
    socket.onopen = () => {
      this.#heard = Date.now();
    };
    socket.onclose = () => {
      if (this.#socket === socket) void this.#again();
    };
  }
  #told = false;

  async #again(): Promise<void> {
    this.#socket = null;
    this.#told = false;
    if (this.#ended) return;
    this.needs.link("broken");
    const wait = WAIT_MS[Math.min(this.#failures, WAIT_MS.length - 1)]!;
    this.#failures += 1;
    const allowed = await this.needs.allowed();
    if (this.#ended || !allowed) return;
    this.#timer = setTimeout(() => this.#open(), wait);
  }

  /** A connection that died without a word. */
  async #check(): Promise<void> {
    const socket = this.#socket;
    if (!socket || Date.now() - this.#heard < SILENT_MS) return;
    try {
      const answer = await fetch("/health/live", { signal: AbortSignal.timeout(5000) });
      if (answer.ok) {
        this.#heard = Date.now();
        return;
      }
    } catch {
      // It does not answer: as good as closed.
    }
    if (this.#socket === socket) {
      socket.onclose = null;
      socket.close();
      void this.#again();
    }
  }
}
