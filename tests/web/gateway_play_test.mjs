// The gateway as a relay: players who reach a real server through it, and players who misbehave.
import assert from 'node:assert';
import crypto from 'node:crypto';
import net from 'node:net';
import { after, before } from 'node:test';

import { channels, join, makeHello, Player, serverMessages, subprotocol } from './support/player.mjs';
import { makePage, removePage, sleep, startGateway, startServer, test, waitFor } from './support/programs.mjs';

let page;
let server;
let gateway;

before(async () => {
  page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' });
  server = await startServer('--scene', 'arena', '--status', '0.2');
  gateway = await startGateway(server.address, page);
});
after(async () => {
  await gateway?.program.stop();
  await server?.program.stop();
  removePage(page);
});

test('relays both ways, and the server hears when a browser leaves', async () => {
  const player = await join(gateway.host);
  await waitFor('snapshots', () => player.count(channels.snapshot) > 10);
  assert.ok(player.has(serverMessages.blueprintChunk));
  assert.equal(player.socket.protocol, subprotocol);
  assert.equal(server.countClients(), 1);
  const begin = Date.now();
  await player.leave();
  await waitFor('no clients', () => server.countClients() === 0);
  const seconds = (Date.now() - begin) / 1000;
  assert.ok(seconds < 4, `${seconds} s`); // for a player who is merely silent, a server holds the body for 8 s
  await gateway.program.waitForLine(/^browser 1: ended after \d+ s: left; 0 snapshots dropped$/);
});

test('leads to several worlds by their names', async () => {
  const sumo = await startServer('--scene', 'sumo', '--status', '0.2');
  const worlds = await startGateway(`arena=${server.address}`, page, '--server', `sumo=${sumo.address}`);
  const listed = await fetch(`http://${worlds.host}/worlds`);
  assert.match(listed.headers.get('content-type'), /^application\/json/);
  assert.deepEqual((await listed.json()).worlds, ['arena', 'sumo']);
  const names = (player) => Buffer.concat(player.messages).toString('latin1');
  for (const [path, scene] of [['/play', 'arena'], ['/play/arena', 'arena'], ['/play/sumo', 'sumo']]) {
    const player = await join(worlds.host, { path });
    assert.ok(names(player).includes(scene), path);
    await player.leave();
  }
  assert.equal(await new Player(worlds.host, { path: '/play/curtain' }).opened, 404);
  const nameless = await fetch(`http://${gateway.host}/worlds`);
  assert.deepEqual((await nameless.json()).worlds, []);
  await worlds.program.stop();
  await sumo.program.stop();
});

test('answers pings with the round trip to the server', async () => {
  const player = await join(gateway.host);
  player.send(channels.ping, Buffer.from([1, 2, 3, 250]));
  const answer = await waitFor('an answer', () => player.messages.find((bytes) => bytes[0] === channels.ping));
  assert.deepEqual([...answer.subarray(0, 5)], [channels.ping, 1, 2, 3, 250]);
  assert.equal(answer.length, 7);
  assert.ok(answer.readUInt16LE(5) < 1000);
  await player.leave();
});

test('what the server says last is delivered, and then a reason', async () => {
  const player = new Player(gateway.host);
  assert.equal(await player.opened, true);
  assert.deepEqual(await player.closed, { code: 1000, reason: 'the server has ended the connection' });
  assert.ok(player.has(serverMessages.goodbye)); // no hello within 3 s
});

test('pages of other origins may not play, unless they are named', async () => {
  for (const origin of ['http://example.org', `https://${gateway.host}1`, 'null', `http://x@${gateway.host}`]) {
    assert.equal(await new Player(gateway.host, { origin }).opened, 403, origin);
  }
  for (const origin of [`http://${gateway.host}`, `https://${gateway.host.toUpperCase()}`, undefined]) {
    const player = new Player(gateway.host, { origin });
    assert.equal(await player.opened, true, origin);
    await player.leave();
  }
  const friends = ['--origin', 'https://friends.example.org', '--origin', 'http://example.org:81'];
  const open = await startGateway(server.address, page, ...friends);
  for (const [origin, result] of [['https://friends.example.org', true], ['http://example.org:81', true],
    ['http://friends.example.org', 403]]) {
    const player = new Player(open.host, { origin });
    assert.equal(await player.opened, result, origin);
    if (result === true) await player.leave();
  }
  await open.program.stop();
});

test('the subprotocol must be offered', async () => {
  assert.equal(await new Player(gateway.host, { protocols: ['wobble.1'] }).opened, 400);
  assert.equal(await new Player(gateway.host, { protocols: [] }).opened, 400);
  const player = new Player(gateway.host, { protocols: ['chat', subprotocol] });
  assert.equal(await player.opened, true);
  assert.equal(player.socket.protocol, subprotocol);
  await player.leave();
});

test('what is too large, too much or not understood ends a connection with a reason', async () => {
  const offences = [
    [1009, '', (player) => player.send(channels.control, Buffer.alloc(70_000))],
    [1009, 'too large a message for its channel', (player) => player.send(channels.control, Buffer.alloc(4097))],
    [1009, 'too large a message for its channel', (player) => player.send(channels.input, Buffer.alloc(1201))],
    [1003, 'text is not understood', (player) => player.socket.send('hello')],
    [1008, 'a message that is not understood', (player) => player.send(channels.snapshot, Buffer.alloc(10))],
    [1008, 'a message that is not understood', (player) => player.send(200, Buffer.alloc(10))],
    [1008, 'a message that is not understood', (player) => player.send(channels.ping, Buffer.alloc(5))],
    [1008, 'a message that is not understood', (player) => player.socket.send(Buffer.alloc(0))],
    [1008, 'too many messages', (player) => {
      for (let i = 0; i < 1200; ++i) player.send(channels.ping, Buffer.alloc(4));
    }],
    [1008, 'too many messages', (player) => {
      for (let i = 0; i < 1200; ++i) player.socket.ping();
    }],
  ];
  for (const [code, reason, offend] of offences) {
    const player = await join(gateway.host);
    offend(player);
    assert.deepEqual(await player.closed, { code, reason });
  }
});

test('what an honest page sends is not too much', async () => {
  const player = await join(gateway.host);
  // follows a link that was interrupted for 8 s
  for (let i = 0; i < 480; ++i) player.send(channels.ping, Buffer.alloc(4));
  await waitFor('all answers', () => player.count(channels.ping) === 480);
  for (let i = 0; i < 120; ++i) {
    player.send(channels.ping, Buffer.alloc(4));
    await sleep(1000 / 60);
  }
  await waitFor('all answers', () => player.count(channels.ping) === 600);
  await player.leave();
});

test('there are so many places, and so many for one address', async () => {
  const small = await startGateway(server.address, page, '--max-connections', '3', '--max-per-address', '2');
  const players = [await join(small.host), await join(small.host)];
  const refused = { code: 1013, reason: 'all places are taken' };
  assert.deepEqual(await new Player(small.host).closed, refused);
  players.push(await join(small.host, { localAddress: '127.0.0.2' }));
  assert.deepEqual(await new Player(small.host, { localAddress: '127.0.0.3' }).closed, refused);
  await players[0].leave();
  players.push(await join(small.host, { localAddress: '127.0.0.3' })); // the place of a player who left is free again
  for (const player of players) await player.leave();
  assert.equal(await small.program.stop(), 0);
  assert.match(small.program.lines.at(-1), / 6 browsers, 2 without a place, 0 cut off/);
});

test('a browser that does not read misses snapshots, and nothing else', async () => {
  const busy = await startServer('--scene', 'arena', '--client-kbit', '20000', '--status', '0.5');
  const through = await startGateway(busy.address, page);
  const slow = await join(through.host);
  await waitFor('snapshots', () => slow.count(channels.snapshot) > 10);
  slow.socket.pause();
  // Twice the amount that the system and the gateway buffer, however long a slow machine takes for it.
  const first = busy.program.lines.length;
  const readKilobits = (line) => 0.5 * Number(/(\d+) kbit\/s out/.exec(line)?.[1] ?? 0);
  const countSent = () => busy.program.lines.slice(first).reduce((sum, line) => sum + readKilobits(line), 0) / 8;
  while (countSent() < 600) {
    slow.send(channels.input, Buffer.alloc(1)); // the server ignores it, but drops silent players
    await sleep(500);
  }
  slow.socket.resume();
  slow.send(channels.ping, Buffer.from([9, 9, 9, 9]));
  await waitFor('an answer', () => slow.count(channels.ping) === 1);
  await slow.leave();
  const line = await through.program.waitForLine(/ended after/);
  assert.ok(Number(/(\d+) snapshots dropped/.exec(line)[1]) > 10, line);
  await through.program.stop();
  await busy.program.stop();
});

test('random frames harm nobody', async () => {
  const [, port] = gateway.host.split(':');
  const witness = await join(gateway.host);
  const head =
    `GET /play HTTP/1.1\r\nHost: ${gateway.host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n` +
    `Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: ${Buffer.alloc(16).toString('base64')}\r\n` +
    `Sec-WebSocket-Protocol: ${subprotocol}\r\n\r\n`;
  const hello = Buffer.concat([Buffer.from([0]), makeHello('x')]);
  for (let i = 0; i < 200; ++i) {
    const socket = net.connect({ port, host: '127.0.0.1' });
    socket.on('error', () => {});
    socket.write(head);
    await new Promise((resolve) => socket.once('data', resolve));
    if (i % 2 === 0) socket.write(makeFrame(0x82, hello));
    const operation = [0x82, 0x02, 0x80, 0x88, 0x89, 0x81, crypto.randomInt(256)][i % 7];
    const payload = crypto.randomBytes(crypto.randomInt(5000));
    if (i % 3 === 0) payload[0] = i % 4;
    socket.write(i % 5 === 0 ? payload : makeFrame(operation, payload));
    if (i % 11 === 0) socket.destroy();
    socket.end();
    socket.resume();
    await new Promise((resolve) => socket.on('close', resolve));
    // The server ignores it, but drops players that are silent for 8 s, and a slow machine needs longer for the whole
    // test.
    if (i % 20 === 0) witness.send(channels.input, Buffer.alloc(1));
  }
  witness.send(channels.ping, Buffer.alloc(4));
  await waitFor('an answer', () => witness.count(channels.ping) === 1);
  await witness.leave();
});

// A WebSocket frame of a client, with a mask of zeros.
function makeFrame(operation, payload) {
  const head = Buffer.alloc(8);
  head[0] = operation;
  head[1] = 0x80 | 126;
  head.writeUInt16BE(payload.length, 2);
  return Buffer.concat([head, payload]);
}

test('counts browsers behind a trusted proxy by their own addresses', async () => {
  const options = ['--max-connections', '4', '--max-per-address', '1'];
  const behind = await startGateway(server.address, page, ...options, '--trusted-proxy', '::ffff:127.0.0.1');
  const visit = (forwarded) => new Player(behind.host, { headers: { 'X-Forwarded-For': forwarded } });
  // What stands before the proxy's own word is what a browser says of itself.
  const players = [visit('192.0.2.1'), visit('192.0.2.1, 192.0.2.2'), visit('2001:db8::1')];
  for (const player of players) assert.equal(await player.opened, true);
  // They came at once, so their numbers may be in any order.
  await behind.program.waitForLine(/^browser \d: 192\.0\.2\.1 plays, /);
  await behind.program.waitForLine(/^browser \d: 192\.0\.2\.2 plays, /);
  await behind.program.waitForLine(/^browser \d: 2001:db8::\/64 plays, /);
  const again = visit('192.0.2.9, 192.0.2.1');
  assert.equal(await again.opened, true);
  assert.deepEqual(await again.closed, { code: 1013, reason: 'all places are taken' });
  await behind.program.stop();

  const plain = await startGateway(server.address, page, ...options);
  const first = new Player(plain.host, { headers: { 'X-Forwarded-For': '192.0.2.1' } });
  assert.equal(await first.opened, true);
  await plain.program.waitForLine(/^browser 1: 127\.0\.0\.1 plays, /);
  const second = new Player(plain.host, { headers: { 'X-Forwarded-For': '192.0.2.2' } });
  assert.equal((await second.closed).reason, 'all places are taken');
  await plain.program.stop();
});

test('a WebSocket that says no hello ends, and an address opens only so many a second', async () => {
  const begin = Date.now();
  const mute = new Player(gateway.host, { localAddress: '127.0.0.2' });
  assert.equal(await mute.opened, true);
  const tries = Array.from({ length: 60 }, () => new Player(gateway.host, { localAddress: '127.0.0.3' }).opened);
  const results = await Promise.all(tries);
  assert.ok(results.filter((result) => result === 429).length >= 15, `${results}`);
  const other = await join(gateway.host); // meanwhile others come in
  await other.leave();
  await mute.closed;
  assert.ok(Date.now() - begin < 6000);
});
