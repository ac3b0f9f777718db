// Starts the programs under test, on ports that the system picks, and ends each with its test.
import { AsyncLocalStorage } from 'node:async_hooks';
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import * as runner from 'node:test';

export const binFolder = process.env.WOBBLE_BIN_DIR ?? path.resolve('build/release/bin');
const patienceMs = 30_000;

// The programs that the present test has started; tests may run at the same time.
const started = new AsyncLocalStorage();

// A test that fails instead of hanging, and ends the programs it started: Node would wait for running programs.
export const test = (name, run) =>
  runner.test(name, { timeout: 4 * patienceMs }, async (context) => {
    const own = [];
    context.after(() => own.forEach((program) => program.process.kill('SIGKILL')));
    await started.run(own, () => run(context));
  });

// A program of the build, or one with an absolute path, with its lines so far and its end.
export class Program {
  constructor(name, options) {
    this.lines = [];
    this.errors = [];
    this.process = spawn(path.resolve(binFolder, name), options, { stdio: ['ignore', 'pipe', 'pipe'] });
    collectLines(this.process.stdout, this.lines);
    collectLines(this.process.stderr, this.errors);
    // Resolves to the exit code, or to the name of the signal that ended the process.
    this.end = new Promise((resolve) => this.process.on('close', (code, signal) => resolve(code ?? signal)));
    started.getStore()?.push(this);
  }

  // The first matching line, of standard output or standard error.
  async waitForLine(pattern) {
    return await waitFor(`a line ${pattern} of ${this.process.spawnfile}`, () =>
      [...this.lines, ...this.errors].find((line) => pattern.test(line)),
    );
  }

  async stop(signal = 'SIGINT') {
    this.process.kill(signal);
    const killer = setTimeout(() => this.process.kill('SIGKILL'), patienceMs);
    const result = await this.end;
    clearTimeout(killer);
    return result;
  }
}

function collectLines(stream, lines) {
  let pending = '';
  stream.setEncoding('utf8').on('data', (text) => {
    const parts = (pending + text).split('\n');
    pending = parts.pop();
    lines.push(...parts);
  });
}

// Calls `find` repeatedly until it returns neither false nor undefined, and returns that value.
export async function waitFor(what, find) {
  const end = Date.now() + patienceMs;
  for (;;) {
    const found = await find();
    if (found) return found;
    if (Date.now() > end) throw new Error(`${what} did not come within ${patienceMs / 1000} s`);
    await sleep(20);
  }
}

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// Starts a server on this UDP port, where 0 lets the system pick one: { program, address }.
export async function startServerOn(port, ...options) {
  const program = new Program('wobbled', ['--port', `${port}`, ...options]);
  const line = await program.waitForLine(/^listening on UDP port \d+/);
  return { program, address: `127.0.0.1:${/port (\d+)/.exec(line)[1]}` };
}

// Starts a server: { program, address, countClients }. countClients reads the newest status line, so it needs --status,
// and is -1 without one. Untrained, since shapes do not matter here and training takes seconds.
export async function startServer(...options) {
  const { program, address } = await startServerOn(0, '--untrained', '--log-level', 'info', ...options);
  const countClients = () => Number(/clients (\d+)/.exec(program.lines.at(-1))?.[1] ?? -1);
  return { program, address, countClients };
}

// Starts a relay to a server over a bad network: { program, address }.
export async function startRelay(server, conditions) {
  const program = new Program('wobble', ['link', '--listen', '0', '--bind', '127.0.0.1', '--to', server, conditions]);
  const line = await program.waitForLine(/^relaying UDP port \d+/);
  return { program, address: `127.0.0.1:${/port (\d+)/.exec(line)[1]}` };
}

// Starts a gateway: { program, host }; host is the address for a browser.
export async function startGateway(server, page, ...options) {
  const program = new Program('wobble', ['gateway', '--http', '0', '--server', server, '--page', page, ...options]);
  const line = await program.waitForLine(/^open https?:\/\/localhost:\d+ /);
  return { program, host: `localhost:${/localhost:(\d+)/.exec(line)[1]}` };
}

// Makes a folder with these files, { name: content }, in place of the built page. removePage deletes it.
export function makePage(files) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-page-'));
  for (const [name, content] of Object.entries(files)) {
    fs.mkdirSync(path.join(folder, path.dirname(name)), { recursive: true });
    fs.writeFileSync(path.join(folder, name), content);
  }
  return folder;
}

export function removePage(folder) {
  fs.rmSync(folder, { recursive: true, force: true });
}
