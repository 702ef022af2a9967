/** A real server for a test: `adit serve` in a folder of its own, or the one at `ADIT_URL`. */
import { spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

const repository = resolve(import.meta.dirname, "../../..");

function binary(): string | null {
  const named = process.env["ADIT_BIN"];
  const found = [named, join(repository, "target/debug/adit"), join(repository, "target/release/adit")];
  return found.find((path) => path !== undefined && existsSync(path)) ?? null;
}

async function freePort(): Promise<number> {
  return new Promise((done, fail) => {
    const probe = createServer();
    probe.on("error", fail);
    probe.listen(0, "127.0.0.1", () => {
      const at = probe.address();
      probe.close(() => done(typeof at === "object" && at ? at.port : 0));
    });
  });
}

export class Server {
  #process: ChildProcess | null = null;
  token = "";

  private constructor(
    private readonly binary: string,
    private readonly folder: string,
    /** How it is told what to serve. */
    private readonly told: string[],
    readonly port: number,
    public password: string,
  ) {}

  /** Null where there is no binary. `anybody`: how many tags that nobody entered are followed. */
  static async start({ mine = join(repository, "mines/two-level.toml"), anybody = 1000 } = {}): Promise<Server | null> {
    const found = binary();
    if (found === null) return null;
    const folder = mkdtempSync(join(tmpdir(), "adit-console-"));
    const settings = join(folder, "site.toml");
    writeFileSync(settings, `[site]\nmine = "${mine}"\n\n[rules.contact]\nunregistered_tags = ${anybody}\n`);
    const server = new Server(found, folder, ["--config", settings], await freePort(), "");
    await server.up();
    await server.logIn();
    const page = await (await fetch(server.url)).text();
    if (!page.includes('id="app"')) {
      await server.stop();
      throw new Error(`${found} has no console in it: ci/console.sh, then cargo build`);
    }
    return server;
  }

  static has(): boolean {
    return binary() !== null;
  }

  get program(): string {
    return this.binary;
  }

  /** Where the console and the API answer. */
  get url(): string {
    return `http://127.0.0.1:${this.port}`;
  }

  get pid(): number {
    return this.#process?.pid ?? 0;
  }

  /** Starts it, again too. */
  async up(): Promise<void> {
    const args = ["serve", ...this.told, "--data", join(this.folder, "data"), "--listen", `127.0.0.1:${this.port}`];
    const started = spawn(this.binary, args, { stdio: ["ignore", "pipe", "pipe"] });
    this.#process = started;
    let said = "";
    await new Promise<void>((done, fail) => {
      const hear = (bytes: Buffer) => {
        said += bytes.toString();
        const password = /password (\S+): it is not shown again/.exec(said);
        if (password) this.password = password[1]!;
        if (/keeps everything in/.test(said) && (this.password !== "" || password)) done();
      };
      started.stdout.on("data", hear);
      started.stderr.on("data", hear);
      started.on("exit", (code) => fail(new Error(`adit serve ended with ${code}: ${said}`)));
    });
  }

  /** Ends it, as a power cut would or politely. */
  async down(signal: "SIGKILL" | "SIGINT" = "SIGINT"): Promise<void> {
    const running = this.#process;
    this.#process = null;
    if (!running) return;
    running.removeAllListeners("exit");
    const ended = new Promise((done) => running.once("exit", done));
    running.kill(signal);
    await ended;
  }

  async stop(): Promise<void> {
    await this.down("SIGKILL");
    rmSync(this.folder, { recursive: true, force: true });
  }

  async logIn(): Promise<void> {
    const answer = await this.ask<{ token: string }>("POST", "/api/v1/session", {
      name: "admin",
      password: this.password,
    });
    this.token = answer.token;
  }

  async ask<T>(method: string, path: string, body?: unknown): Promise<T> {
    const headers: Record<string, string> = {};
    if (this.token !== "") headers["Authorization"] = `Bearer ${this.token}`;
    if (body !== undefined) headers["Content-Type"] = "application/json";
    const init: RequestInit = { method, headers };
    if (body !== undefined) init.body = JSON.stringify(body);
    const answer = await fetch(this.url + path, init);
    if (!answer.ok) throw new Error(`${method} ${path}: ${answer.status} ${await answer.text()}`);
    const text = await answer.text();
    return (text === "" ? undefined : JSON.parse(text)) as T;
  }
}
