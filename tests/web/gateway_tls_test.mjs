// The gateway with a certificate of its own: the page and the game through TLS, handshakes that are slow or none, files
// that change.
import assert from 'node:assert';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import https from 'node:https';
import net from 'node:net';
import path from 'node:path';
import { after, before } from 'node:test';
import tls from 'node:tls';

import { channels, join, Player, subprotocol } from './support/player.mjs';
import { makePage, Program, removePage, sleep, startGateway, startServer, test, waitFor } from './support/programs.mjs';

const index = '<!doctype html><title>wobble</title>';
const list = { version: 1, worlds: [{ name: 'plain', address: 'play.example.org:7777' }] };
let folder; // the page's; hidden files of it are not served
let server;
let gateway;
let ca;

const pathOf = (name) => path.join(folder, `.${name}`);

function makeCertificate(name) {
  const files = ['-keyout', pathOf(`${name}.key`), '-out', pathOf(`${name}.pem`)];
  const names = ['-subj', '/CN=wobble', '-addext', 'subjectAltName=DNS:localhost,IP:127.0.0.1'];
  const curve = ['-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes'];
  execFileSync('openssl', ['req', '-x509', ...curve, '-days', '2', ...files, ...names], { stdio: 'ignore' });
  return fs.readFileSync(pathOf(`${name}.pem`));
}

const tlsOptions = () => ['--tls-cert', pathOf('used.pem'), '--tls-key', pathOf('used.key')];
const portOf = (each) => Number(each.host.split(':')[1]);

before(async () => {
  folder = makePage({ 'index.html': index });
  ca = makeCertificate('used');
  fs.writeFileSync(pathOf('list'), JSON.stringify(list));
  server = await startServer('--scene', 'arena');
  gateway = await startGateway(server.address, folder, ...tlsOptions(), '--list', pathOf('list'));
});
after(async () => {
  await gateway?.program.stop();
  await server?.program.stop();
  removePage(folder);
});

// { status, headers, body }
function request(module, target, options = {}) {
  return new Promise((resolve, reject) => {
    const sent = module.get({ host: '127.0.0.1', port: portOf(gateway), path: target, agent: false, ...options });
    sent.on('error', reject).on('response', async (response) => {
      let body = '';
      for await (const part of response) body += part;
      resolve({ status: response.statusCode, headers: response.headers, body });
    });
  });
}

test('the page comes through TLS 1.2 and 1.3, not through older ones, and several files over one connection', async () => {
  for (const version of ['TLSv1.2', 'TLSv1.3']) {
    const answer = await request(https, '/', { ca, minVersion: version, maxVersion: version });
    assert.equal(answer.body, index);
  }
  const old = { ca, minVersion: 'TLSv1', maxVersion: 'TLSv1.1', ciphers: 'DEFAULT@SECLEVEL=0' };
  await assert.rejects(request(https, '/', old), /alert protocol version/);
  const agent = new https.Agent({ keepAlive: true, maxSockets: 1, ca });
  const ports = new Set();
  for (let i = 0; i < 3; ++i) {
    const sent = https.get({ host: '127.0.0.1', port: portOf(gateway), path: '/healthz', agent });
    const answer = await new Promise((resolve) => sent.on('response', resolve));
    ports.add(answer.socket.localPort);
    await new Promise((resolve) => answer.resume().on('end', resolve));
  }
  agent.destroy();
  assert.equal(ports.size, 1);
  const curl = execFileSync('curl', ['-sS', '--cacert', pathOf('used.pem'), `https://localhost:${portOf(gateway)}/`]);
  assert.equal(curl.toString(), index);
});

test('plain HTTP is sent to https, whatever else is plain gets a short answer', async () => {
  const sent = await request(http, '/assets/a?b', { headers: { host: `play.example.org:${portOf(gateway)}` } });
  assert.equal(sent.status, 307);
  assert.equal(sent.headers.location, `https://play.example.org:${portOf(gateway)}/assets/a?b`);
  assert.equal(sent.body, 'this port speaks https\n');
  assert.equal((await request(http, '/play')).status, 307);
  assert.equal((await request(http, '/healthz')).body, 'ok\n');
  const socket = net.connect(portOf(gateway), '127.0.0.1');
  socket.end('hello\r\n\r\n');
  let text = '';
  for await (const part of socket) text += part;
  assert.match(text, /^HTTP\/1\.1 400 /);
});

test('the list of worlds is for everybody, and read again when it changes', async () => {
  const answer = await request(https, '/worlds.json', { ca });
  assert.equal(answer.headers['access-control-allow-origin'], '*');
  assert.deepEqual(JSON.parse(answer.body), list);
  const changed = { version: 1, worlds: [{ name: 'Ada', page: 'https://play.example.org/', mood: 1 }] };
  fs.writeFileSync(pathOf('list'), JSON.stringify(changed));
  await gateway.program.waitForLine(/the list was read again/);
  const { worlds } = JSON.parse((await request(https, '/worlds.json', { ca })).body);
  assert.deepEqual(worlds, [{ name: 'Ada', page: 'https://play.example.org/' }]);
  const { elsewhere } = JSON.parse((await request(https, '/worlds', { ca })).body);
  assert.deepEqual(elsewhere, [{ name: 'Ada', page: 'https://play.example.org/', scene: '' }]);
  fs.writeFileSync(pathOf('list'), '{"version": 1, "worlds": [{"name": "Eve", "page": "javascript:alert(1)"}]}');
  await gateway.program.waitForLine(/worlds\[0\]\.page: .*; the one before still holds$/);
  assert.match((await request(https, '/worlds.json', { ca })).body, /Ada/);
});

test('addresses of the network are told to this machine alone', async () => {
  const read = async (headers) =>
    'addresses' in JSON.parse((await request(https, '/worlds', { ca, headers, servername: 'localhost' })).body);
  assert.equal(await read({}), true);
  assert.equal(await read({ host: 'play.example.org' }), false);
  assert.equal(await read({ 'x-forwarded-for': '127.0.0.1' }), false);
  assert.equal(await read({ forwarded: 'for=127.0.0.1' }), false);
});

test('a player plays over wss with its lanes, on through a change of the certificate', async () => {
  const player = await join(gateway.host, { ca });
  const key = await waitFor('a key', () => player.messages.find((bytes) => bytes[0] === channels.lane));
  const more = { ca, protocols: [subprotocol, `more.${key.subarray(1).toString('base64url')}`] };
  const lanes = [1, 2, 3].map(() => new Player(gateway.host, more));
  for (const lane of lanes) assert.equal(await lane.opened, true);
  const all = [player, ...lanes];
  const waitForMore = async () => {
    const counts = all.map((each) => each.count(channels.snapshot));
    await waitFor('snapshots', () => all.every((each, i) => each.count(channels.snapshot) > counts[i] + 10));
  };
  await waitForMore();

  // One file after the other, as people copy them.
  const before = ca;
  ca = makeCertificate('next');
  fs.copyFileSync(pathOf('next.pem'), pathOf('used.pem'));
  await gateway.program.waitForLine(/is not the key of the certificate .*; the one before still holds$/);
  assert.equal((await request(https, '/', { ca: before })).body, index);
  fs.copyFileSync(pathOf('next.key'), pathOf('used.key'));
  await gateway.program.waitForLine(/the certificate was read again/);
  assert.equal((await request(https, '/', { ca })).body, index);
  await assert.rejects(request(https, '/', { ca: before }), /self.signed/);
  await waitForMore();
  await player.leave();
  for (const lane of lanes) await lane.closed;
});

test('a handshake that stalls has the time of a request', async () => {
  const hello = await recordHello();
  const sockets = [
    net.connect(portOf(gateway), '127.0.0.1'), // silent
    net.connect(portOf(gateway), '127.0.0.1'), // a part of a hello
    net.connect(portOf(gateway), '127.0.0.1'), // all of it, and no answer to the server's
    tls.connect({ port: portOf(gateway), host: '127.0.0.1', ca }), // no request behind it
  ];
  sockets[1].write(hello.subarray(0, 100));
  sockets[2].write(hello);
  const begin = Date.now();
  const times = await Promise.all(
    sockets.map(
      (socket) =>
        new Promise((resolve) => {
          socket.resume();
          socket.on('error', () => {});
          socket.on('close', () => resolve((Date.now() - begin) / 1000));
        }),
    ),
  );
  console.log(`closed after ${times.map((time) => time.toFixed(2)).join(', ')} s`);
  assert.ok(times.every((time) => time > 3.5 && time < 5.5), `${times}`);
});

test('one address cannot have all connections by handshakes', async () => {
  const limits = ['--max-connections', '4', '--max-per-address', '1'];
  const small = await startGateway('127.0.0.1:9', folder, ...tlsOptions(), ...limits);
  const hello = await recordHello();
  let closed = 0;
  const sockets = Array.from({ length: 12 }, (_, i) => {
    const socket = net.connect(portOf(small), '127.0.0.1');
    socket.on('error', () => {}).on('close', () => ++closed);
    socket.resume();
    socket.write(hello.subarray(0, i % 2 === 0 ? 200 : hello.length));
    return socket;
  });
  await sleep(1000);
  assert.equal(closed, 4); // as without TLS
  for (const socket of sockets) socket.destroy();
  assert.equal(await small.program.stop(), 0);
});

test('files that cannot be used are named before anything starts', async () => {
  const refuse = async (...options) => {
    const program = new Program('wobble', ['gateway', '--http', '0', '--server', '127.0.0.1:9', '--page', folder, ...options]);
    assert.equal(await program.end, 2);
    assert.deepEqual(program.lines, []);
    return program.errors.join('\n');
  };
  assert.equal(await refuse('--tls-cert', 'a.pem'), 'wobble gateway: --tls-cert and --tls-key go together');
  assert.equal(await refuse('--tls-cert', 'a.pem', '--tls-key', 'a.key'), "wobble gateway: --tls-cert: 'a.pem' is not there");
  assert.match(await refuse('--list', pathOf('used.pem')), /^wobble gateway: --list: '.*used\.pem': is no JSON$/);
});

// What a client says first, bytes.
async function recordHello() {
  const ear = net.createServer();
  await new Promise((resolve) => ear.listen(0, '127.0.0.1', resolve));
  const heard = new Promise((resolve) => ear.on('connection', (socket) => socket.once('data', resolve)));
  const client = tls.connect({ port: ear.address().port, host: '127.0.0.1' }).on('error', () => {});
  const bytes = await heard;
  client.destroy();
  ear.close();
  return bytes;
}
