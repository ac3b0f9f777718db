// Starts the programs that are tested, on ports that the system picks, and sees to it that none outlives its test.
import { AsyncLocalStorage } from 'node:async_hooks';
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import * as runner from 'node:test';

const binFolder = process.env.WOBBLE_BIN_DIR ?? path.resolve('build/release/bin');
const patienceMs = 30_000;

// The programs that the test at hand has started; tests may run at the same time.
const started = new AsyncLocalStorage();

// A test that fails rather than hangs, and takes with it what it has started: Node waits for programs that still run.
export const test = (name, run) =>
  runner.test(name, { timeout: 2 * patienceMs }, async (context) => {
    const own = [];
    context.after(() => own.forEach((program) => program.process.kill('SIGKILL')));
    await started.run(own, () => run(context));
  });

// One program: its lines so far, and its end.
export class Program {
  constructor(name, options) {
    this.lines = [];
    this.errors = [];
    this.process = spawn(path.join(binFolder, name), options, { stdio: ['ignore', 'pipe', 'pipe'] });
    collectLines(this.process.stdout, this.lines);
    collectLines(this.process.stderr, this.errors);
    // What the process came to: its exit code, or the name of the signal that ended it.
    this.end = new Promise((resolve) => this.process.on('close', (code, signal) => resolve(code ?? signal)));
    started.getStore()?.push(this);
  }

  // The first line that matches, of standard output or standard error.
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

// What `find` returns, once it is neither false nor undefined; it is asked again and again.
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

// A server that listens on this UDP port, where 0 is one that the system picks: { program, address }.
export async function startServerOn(port, ...options) {
  const program = new Program('wobbled', ['--port', `${port}`, ...options]);
  const line = await program.waitForLine(/^listening on UDP port \d+/);
  return { program, address: `127.0.0.1:${/port (\d+)/.exec(line)[1]}` };
}

// A server that listens: { program, address, countClients }, the last by its newest status line, so it needs --status;
// -1 where there is none. Untrained, since shapes do not matter here and training takes seconds.
export async function startServer(...options) {
  const { program, address } = await startServerOn(0, '--untrained', '--log-level', 'info', ...options);
  const countClients = () => Number(/clients (\d+)/.exec(program.lines.at(-1))?.[1] ?? -1);
  return { program, address, countClients };
}

// A gateway that listens: { program, host }, host being what a browser has in the address bar.
export async function startGateway(server, page, ...options) {
  const program = new Program('wobble', ['gateway', '--http', '0', '--server', server, '--page', page, ...options]);
  const line = await program.waitForLine(/^open http:\/\/localhost:\d+ /);
  return { program, host: `localhost:${/localhost:(\d+)/.exec(line)[1]}` };
}

// A folder with these files, { name: content }, instead of the built page. removePage ends it.
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
