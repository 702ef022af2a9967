/** Serves web/dist before a server that has no console in it, and hands on the rest: HTTP and WebSocket. */
import { existsSync, readFileSync } from "node:fs";
import { createServer, request, type IncomingMessage, type Server as HttpServer } from "node:http";
import { connect, type Socket } from "node:net";
import { extname, join, resolve } from "node:path";

const dist = resolve(import.meta.dirname, "../../dist");
const TYPES: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
};
/** That of the server (contract, point 1): what breaks it shall break here too. */
const POLICY =
  "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; connect-src 'self'; worker-src 'self' blob:; frame-ancestors 'none'";

export class Front {
  readonly #open = new Set<Socket>();

  private constructor(
    private readonly server: HttpServer,
    readonly url: string,
  ) {
    server.on("connection", (socket) => {
      this.#open.add(socket);
      socket.on("close", () => this.#open.delete(socket));
    });
  }

  /** Null where the server has the console itself. */
  static async before(target: string): Promise<Front | null> {
    const page = await fetch(`${target}/`);
    if (page.ok && (await page.text()).includes('id="app"')) return null;
    if (!existsSync(join(dist, "index.html"))) throw new Error("web/dist is not built: npm run build");
    const { hostname, port } = new URL(target);
    const server = createServer((asked, answer) => {
      const path = (asked.url ?? "/").split("?")[0]!;
      const file = join(dist, path === "/" ? "index.html" : path);
      if (file.startsWith(dist) && !/^\/(api|v2|metrics|health)/.test(path) && existsSync(file)) {
        answer.writeHead(200, {
          "Content-Type": TYPES[extname(file)] ?? "application/octet-stream",
          "Content-Security-Policy": POLICY,
        });
        answer.end(readFileSync(file));
        return;
      }
      const on = request({ hostname, port, path: asked.url, method: asked.method, headers: asked.headers }, (reply) => {
        answer.writeHead(reply.statusCode ?? 502, reply.headers);
        reply.pipe(answer);
      });
      on.on("error", () => answer.writeHead(502).end());
      asked.pipe(on);
    });
    server.on("upgrade", (asked: IncomingMessage, socket: Socket) => {
      const on = connect(Number(port), hostname, () => {
        const headers = Object.entries(asked.headers).map(([name, value]) => `${name}: ${String(value)}`);
        on.write(`${asked.method} ${asked.url} HTTP/1.1\r\n${headers.join("\r\n")}\r\n\r\n`);
        socket.pipe(on).pipe(socket);
      });
      const end = () => {
        on.destroy();
        socket.destroy();
      };
      on.on("error", end).on("close", end);
      socket.on("error", end).on("close", end);
    });
    await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
    const at = server.address();
    return new Front(server, `http://127.0.0.1:${typeof at === "object" && at ? at.port : 0}`);
  }

  async close(): Promise<void> {
    for (const socket of this.#open) socket.destroy();
    await new Promise((done) => this.server.close(done));
  }
}
