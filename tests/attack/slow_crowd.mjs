// TCP connections that open often and speak slowly, each from an address of this machine's loopback, and what an honest
// visitor at 127.0.0.1 meets meanwhile.
import fs from 'node:fs';
import http from 'node:http';
import net from 'node:net';

import { sleep } from '../web/support/programs.mjs';

const dripMs = 100;
const patienceMs = 1000; // of an honest visitor

// Its connections say one of `openings` in turn, and after a request that has no end yet 100 bytes every 100 ms, a
// kilobyte a second, until they are closed.
export class SlowCrowd {
  constructor(port, addresses, openings) {
    Object.assign(this, { port, addresses, openings, opened: 0, sockets: new Set(), timers: [] });
    this.timers.push(setInterval(() => this.drip(), dripMs));
  }

  // Resolves when all are open or refused: until then this process is busy, and would measure itself.
  async openAtOnce(count) {
    const isTried = (socket) => new Promise((resolve) => socket.once('connect', resolve).once('close', resolve));
    await Promise.all(Array.from({ length: count }, () => isTried(this.open())));
  }

  openOften(perSecond) {
    this.timers.push(setInterval(() => this.open(), 1000 / perSecond));
  }

  open() {
    const number = this.opened++;
    const localAddress = this.addresses[number % this.addresses.length];
    const socket = net.connect({ port: this.port, host: '127.0.0.1', localAddress });
    const opening = this.openings[number % this.openings.length];
    socket.drips = opening !== '' && !opening.endsWith('\r\n\r\n');
    socket.on('error', () => {});
    socket.on('close', () => this.sockets.delete(socket));
    socket.resume();
    if (opening !== '') socket.write(opening);
    this.sockets.add(socket);
    return socket;
  }

  drip() {
    for (const socket of this.sockets) {
      if (socket.drips && socket.writable) socket.write('x'.repeat(100));
    }
  }

  end() {
    this.timers.forEach(clearInterval);
    for (const socket of this.sockets) socket.destroy();
  }
}

// Resolves to the milliseconds until the other end closes a connection that says `opening`, and a byte every 100 ms.
export async function measurePatience(port, localAddress, opening) {
  const begin = Date.now();
  const socket = net.connect({ port, host: '127.0.0.1', localAddress });
  const timer = setInterval(() => socket.writable && socket.write('x'), dripMs);
  socket.on('error', () => {});
  socket.resume();
  socket.write(opening);
  await new Promise((resolve) => socket.on('close', resolve));
  clearInterval(timer);
  return Date.now() - begin;
}

// { status, ms, body }; status 0: no answer.
export function visit(port, path) {
  const begin = performance.now();
  return new Promise((resolve) => {
    const finish = (status, body) => resolve({ status, body, ms: performance.now() - begin });
    const options = { host: '127.0.0.1', port, path, agent: false, localAddress: '127.0.0.1', timeout: patienceMs };
    const request = http.get(options, (response) => {
      const parts = [];
      response.on('data', (part) => parts.push(part));
      response.on('end', () => finish(response.statusCode, Buffer.concat(parts)));
      response.on('error', () => finish(0));
    });
    request.on('timeout', () => request.destroy());
    request.on('error', () => finish(0));
  });
}

// Asks for /healthz so many times, or until 4 s have passed: { asked, failed, p99 } with p99 in ms. What fails counts as
// its time. With fewer than 100 the p99 is the longest, which on a busy machine is a pause of this process.
export async function askHealth(port, count, pauseMs = 15) {
  const times = [];
  let failed = 0;
  for (const end = Date.now() + 4000; times.length < count && Date.now() < end; await sleep(pauseMs)) {
    const answer = await visit(port, '/healthz');
    times.push(answer.ms);
    failed += answer.status === 200 ? 0 : 1;
  }
  times.sort((a, b) => a - b);
  return { asked: times.length, failed, p99: times[Math.ceil(0.99 * times.length) - 1] };
}

// Resolves to infinity after so long; keeps no test waiting.
export const giveUp = (ms) => new Promise((resolve) => setTimeout(resolve, ms, Infinity).unref());

export const countDescriptors = (program) => fs.readdirSync(`/proc/${program.process.pid}/fd`).length;
