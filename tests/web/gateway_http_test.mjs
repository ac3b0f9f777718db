// The gateway as a web server: the page's files, and malformed or hostile requests. No game server is behind it.
import assert from 'node:assert';
import { spawn } from 'node:child_process';
import crypto from 'node:crypto';
import http from 'node:http';
import net from 'node:net';
import path from 'node:path';
import { after, before } from 'node:test';
import zlib from 'node:zlib';

import { binFolder, makePage, Program, removePage, sleep, startGateway, test, waitFor } from './support/programs.mjs';

const script = 'export const answer = 42;\n'.repeat(100);
const picture = crypto.randomBytes(300);
const files = {
  'index.html': '<!doctype html><title>wobble</title><p>hello hello hello hello hello</p>',
  'assets/main-1a2B_c-d.js': script,
  'assets/wobble-0123abcd.wasm': Buffer.from([0, 97, 115, 109]),
  'assets/plain.css': 'body { margin: 0 }',
  'picture.png': picture,
  '.hidden': 'not for the world',
};
let page;
let gateway;

before(async () => {
  page = makePage(files);
  gateway = await startGateway('127.0.0.1:9', page);
});
after(async () => {
  await gateway?.program.stop();
  removePage(page);
});

// { status, headers, body }
function request(target, options = {}) {
  const [hostname, port] = gateway.host.split(':');
  return new Promise((resolve, reject) => {
    const sent = http.request({ hostname, port, family: 4, path: target, agent: false, ...options }, (response) => {
      const parts = [];
      response.on('data', (part) => parts.push(part));
      response.on('end', () =>
        resolve({ status: response.statusCode, headers: response.headers, body: Buffer.concat(parts) }),
      );
    });
    sent.on('error', reject);
    sent.end(options.body);
  });
}

// All bytes that come back until the other end closes; null when it does not close within the time.
function exchange(bytes, patienceMs = 5000) {
  const [, port] = gateway.host.split(':');
  return new Promise((resolve) => {
    const socket = net.connect({ port, host: '127.0.0.1' });
    let received = '';
    const timer = setTimeout(() => {
      resolve(null);
      socket.destroy();
    }, patienceMs);
    socket.on('data', (data) => (received += data.toString('latin1')));
    socket.on('error', () => {});
    socket.on('close', () => {
      clearTimeout(timer);
      resolve(received);
    });
    socket.write(bytes);
  });
}

test('serves the page and its files with the right headers', async () => {
  for (const target of ['/', '/index.html', '/?scene=arena']) {
    const index = await request(target);
    assert.equal(index.status, 200);
    assert.equal(index.headers['content-type'], 'text/html; charset=utf-8');
    assert.equal(index.headers['cache-control'], 'no-cache');
    assert.equal(index.headers['x-content-type-options'], 'nosniff');
    assert.match(index.headers['content-security-policy'], /default-src 'none'; script-src 'self' 'wasm-unsafe-eval';/);
    assert.doesNotMatch(index.headers['content-security-policy'], /unsafe-inline|'unsafe-eval'|\*/);
    assert.equal(index.body.toString(), files['index.html']);
  }
  const main = await request('/assets/main-1a2B_c-d.js');
  assert.equal(main.headers['content-type'], 'text/javascript; charset=utf-8');
  assert.equal(main.headers['cache-control'], 'public, max-age=31536000, immutable');
  assert.equal(main.body.toString(), script);
  const wasm = await request('/assets/wobble-0123abcd.wasm');
  assert.equal(wasm.headers['content-type'], 'application/wasm');
  const css = await request('/assets/plain.css');
  assert.equal(css.headers['content-type'], 'text/css; charset=utf-8');
  assert.equal(css.headers['cache-control'], 'no-cache');
});

test('compresses for those who accept it, where it saves anything', async () => {
  const headers = { 'accept-encoding': 'br, gzip;q=0.8' };
  const compressed = await request('/assets/main-1a2B_c-d.js', { headers });
  assert.equal(compressed.headers['content-encoding'], 'gzip');
  assert.equal(compressed.headers.vary, 'Accept-Encoding');
  assert.ok(compressed.body.length < script.length / 5);
  assert.equal(zlib.gunzipSync(compressed.body).toString(), script);
  const refused = await request('/assets/main-1a2B_c-d.js', { headers: { 'accept-encoding': 'gzip;q=0, br' } });
  assert.equal(refused.headers['content-encoding'], undefined);
  const noise = await request('/picture.png', { headers });
  assert.equal(noise.headers['content-encoding'], undefined);
  assert.deepEqual(noise.body, picture);
});

test('answers HEAD without a body, and several requests on one connection', async () => {
  const head = await request('/', { method: 'HEAD' });
  assert.equal(head.status, 200);
  assert.equal(Number(head.headers['content-length']), files['index.html'].length);
  assert.equal(head.body.length, 0);
  const both = await exchange('GET /healthz HTTP/1.1\r\n\r\nGET /healthz HTTP/1.1\r\nConnection: close\r\n\r\n');
  assert.equal(both.match(/HTTP\/1\.1 200 OK/g).length, 2);
});

test('says that it is healthy', async () => {
  const health = await request('/healthz');
  assert.equal(health.status, 200);
  assert.equal(health.body.toString(), 'ok\n');
});

test('has no file but the page', async () => {
  const targets = ['/none.js', '/assets', '/assets/', '/.hidden', '//index.html', '/../../../../etc/passwd'];
  targets.push('/%2e%2e/%2e%2e/etc/passwd', '/assets/../index.html', 'http://example.org/etc/passwd', '/\\etc\\passwd');
  for (const target of targets) assert.equal((await request(target)).status, 404, target);
});

test('refuses other methods, bodies and what is no request', async () => {
  const post = await request('/', { method: 'POST', body: 'x'.repeat(1 << 20) });
  assert.equal(post.status, 405);
  assert.equal(post.headers.allow, 'GET, HEAD');
  assert.equal((await request('/', { headers: { 'content-length': 5 }, body: 'hello' })).status, 400);
  assert.match(await exchange('hello\r\n\r\n'), /^HTTP\/1\.1 400 /);
  assert.match(await exchange('GET / HTTP/9.9\r\n\r\n'), /^HTTP\/1\.1 400 /);
  assert.match(await exchange(`GET / HTTP/1.1\r\nCookie: ${'x'.repeat(10_000)}\r\n\r\n`), /^HTTP\/1\.1 431 /);
  assert.equal((await request('/play')).status, 426);
});

test('survives random bytes', async () => {
  const random = () => Buffer.concat([crypto.randomBytes(1 + Math.floor(Math.random() * 2000)), Buffer.from('\r\n\r\n')]);
  const tails = ['GET ', 'GET / HTTP/1.1\r\n', 'HEAD /play HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'];
  for (let i = 0; i < 300; ++i) {
    const [, port] = gateway.host.split(':');
    const socket = net.connect({ port, host: '127.0.0.1' });
    socket.on('error', () => {});
    socket.resume();
    socket.end(Buffer.concat([Buffer.from(['', ...tails][i % 4]), random()]));
    await new Promise((resolve) => socket.on('close', resolve));
  }
  assert.equal((await request('/healthz')).status, 200);
});

test('ends requests that take too long, and idle connections', async () => {
  const [, port] = gateway.host.split(':');
  const slow = net.connect({ port, host: '127.0.0.1' });
  const begin = Date.now();
  slow.on('error', () => {});
  slow.write('GET / HTTP/1.1\r\n');
  const dribble = setInterval(() => slow.write('X-Slow: 1\r\n'), 500);
  const isClosed = new Promise((resolve) => slow.on('close', resolve));
  const isIdleClosed = exchange('GET /healthz HTTP/1.1\r\n\r\n', 20_000);
  slow.resume();
  await isClosed;
  clearInterval(dribble);
  const seconds = (Date.now() - begin) / 1000;
  assert.ok(seconds > 3.5 && seconds < 6, `${seconds} s`);
  assert.match(await isIdleClosed, /^HTTP\/1\.1 200 /);
});

test('a second gateway on the same port says so', async () => {
  const [, port] = gateway.host.split(':');
  const second = new Program('wobble', ['gateway', '--http', port, '--server', '127.0.0.1:9', '--page', page]);
  assert.equal(await second.end, 2);
  assert.equal(second.errors.length, 1);
  assert.match(second.errors[0], /^wobble gateway: port \d+ \(TCP\) is in use/);
});

test('one address cannot have all connections', async () => {
  const small = await startGateway('127.0.0.1:9', page, '--max-connections', '4', '--max-per-address', '1');
  const [, port] = small.host.split(':');
  const sockets = Array.from({ length: 12 }, () => net.connect({ port, host: '127.0.0.1' }));
  let closed = 0;
  for (const socket of sockets) {
    socket.on('error', () => {});
    socket.on('close', () => ++closed);
    socket.resume();
  }
  await sleep(1000);
  assert.equal(closed, 4); // the limit per address is eight: a browser's files and its game
  for (const socket of sockets) socket.destroy();
  assert.equal(await small.program.stop(), 0);
  assert.match(small.program.lines.at(-1), /4 connections too many$/);
});

test('on a terminal it also shows where friends find the page, for programs it does not', async () => {
  assert.equal(gateway.program.lines.length, 1);
  const { addresses } = JSON.parse((await request('/worlds')).body);
  const command = [path.join(binFolder, 'wobble'), 'gateway --http 0 --server 127.0.0.1:9 --page', page].join(' ');
  const terminal = spawn('script', ['-qec', `stty cols 60; exec ${command}`, '/dev/null'], { stdio: ['pipe', 'pipe', 'inherit'] });
  let text = '';
  terminal.stdout.setEncoding('utf8').on('data', (part) => (text += part));
  await waitFor('the page', () => /open http:.*\r\n/.test(text));
  await sleep(300);
  const [, port] = /localhost:(\d+)/.exec(text);
  terminal.stdin.end('\x03'); // Ctrl-C
  await new Promise((resolve) => terminal.on('close', resolve));
  const shown = addresses.length === 0 ? [] : [`friends in the same network open http://${addresses[0]}:${port}/`];
  assert.deepEqual(text.match(/friends .*(?=\r)/g) ?? [], shown);
  const code = text.match(/\x1b\[38;5;16;48;5;231m[ █▀▄]{33,}\x1b\[0m\r\n/g) ?? [];
  assert.equal(code.length, addresses.length === 0 ? 0 : 17);
});

test('says when only this machine reaches it', async () => {
  const [alone, bad] = [['127.0.0.1'], ['127.0.0.1', '--trusted-proxy', 'proxy']].map(
    (bind) => new Program('wobble', ['gateway', '--http', '0', '--server', '127.0.0.1:9', '--page', page, '--bind', ...bind]),
  );
  await alone.waitForLine(/^open http:\/\/localhost:\d+ in a browser to play .*, on this machine alone$/);
  assert.equal(await alone.stop(), 0);
  assert.equal(await bad.end, 2);
  assert.deepEqual(bad.errors, ["wobble gateway: --trusted-proxy: 'proxy' is no IP address"]);
});
