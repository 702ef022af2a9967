import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { LiveSocket, type Link } from "./socket";

class FakeSocket {
  onopen: (() => void) | null = null;
  onclose: (() => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  close(): void {
    this.onclose?.();
  }
}

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

function made(allowed = true) {
  const opened: { url: string; socket: FakeSocket }[] = [];
  const links: Link[] = [];
  let place: { run: string; event: number; tick: number } | null = null;
  const socket = new LiveSocket({
    url: "ws://x/live",
    place: () => place,
    message: (message) => (place = { run: "r", event: message.type === "event" ? message.number : 1, tick: 1 }),
    link: (link) => links.push(link),
    allowed: async () => allowed,
    open: (url) => {
      const socket = new FakeSocket();
      opened.push({ url, socket });
      return socket as unknown as WebSocket;
    },
  });
  socket.start();
  return { socket, opened, links };
}

test("opens again from where it broke", async () => {
  const { opened, links } = made();
  opened[0]!.socket.onmessage?.({ data: JSON.stringify({ type: "event", number: 7, body: {} }) });
  opened[0]!.socket.onclose?.();
  await vi.advanceTimersByTimeAsync(400);
  expect(opened[1]?.url).toBe("ws://x/live?run=r&event=7&tick=1");
  expect(links).toEqual(["connecting", "open", "broken", "broken"]);
});

test("waits longer from failure to failure, up to five seconds", async () => {
  const { opened } = made();
  for (const wait of [300, 700, 1500, 3000, 5000, 5000]) {
    const before = opened.length;
    opened.at(-1)!.socket.onclose?.();
    await vi.advanceTimersByTimeAsync(wait - 20);
    expect(opened.length).toBe(before);
    await vi.advanceTimersByTimeAsync(40);
    expect(opened.length).toBe(before + 1);
  }
});

test("does not try again when nobody is logged in", async () => {
  const { opened } = made(false);
  opened[0]!.socket.onclose?.();
  await vi.advanceTimersByTimeAsync(60_000);
  expect(opened.length).toBe(1);
});
