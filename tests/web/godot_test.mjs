// The client in GDScript (client/engines/godot), played without a screen by Debian's Godot 3 as a person starts it.
import assert from 'node:assert';
import crypto from 'node:crypto';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { createRequire } from 'node:module';
import { after, describe } from 'node:test';

import { channels, protocolVersion, subprotocol } from './support/player.mjs';
import { binFolder, makePage, Program, removePage, sleep, startGateway, startServer, startServerOn, test, waitFor } from './support/programs.mjs';

const root = new URL('../../', import.meta.url);
const { WebSocket, WebSocketServer } = createRequire(new URL('client/page/package.json', root))('ws');
globalThis.WebSocket ??= WebSocket; // for the npm package, which Node before 22 gives none
const npmFolder = process.env.WOBBLE_NPM_DIR ?? path.resolve('build/release/npm');
const { connect } = await import(path.join(npmFolder, 'package/dist/node.js'));
const project = new URL('client/engines/godot', root).pathname;
const page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' });
const home = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-godot-'));
for (const name of ['HOME', 'XDG_DATA_HOME', 'XDG_CONFIG_HOME', 'XDG_CACHE_HOME']) process.env[name] = home;
process.env.LANG = 'en';
after(() => {
  removePage(page);
  fs.rmSync(home, { recursive: true, force: true });
});

// Plays for so many seconds; the end must be of this exit code, and no line of the scripts may have failed.
function startGodot(url, seconds, ...options) {
  const words = ['--path', project, `--url=${url}`, `--for=${seconds}`, ...options];
  const program = new Program(process.env.WOBBLE_GODOT ?? '/usr/bin/godot3-server', words);
  program.expectEnd = async (code, reason = /^/) => {
    assert.equal(await program.end, code, [...program.lines, ...program.errors].join('\n'));
    // core/io: the engine was asked to read what is not there.
    const isFault = (line) => /SCRIPT ERROR|Parse Error|core\/io/.test(line);
    assert.ok(!program.errors.some(isFault), program.errors.slice(-40).join('\n'));
    assert.match(program.errors.find((line) => line.startsWith('wobble: ')) ?? '', reason);
  };
  program.readRefused = () => Number(/; (\d+) messages refused$/.exec(program.lines.at(-1))[1]);
  return program;
}

const readVersion = (script) => Number(/^const VERSION = (\d+)$/m.exec(script)[1]);
const placeLine = /^x (-?\d+\.\d{3})  y (-?\d+\.\d{3})  z (-?\d+\.\d{3})  bodies (\d+)$/;
const readPlaces = (program) =>
  program.lines.map((line) => placeLine.exec(line)?.slice(1).map(Number)).filter((place) => place !== undefined);

// How far a place is from a path of places.
function findDistance(place, way) {
  const minus = (a, b) => [0, 1, 2].map((i) => a[i] - b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const distances = way.slice(1).map((end, i) => {
    const along = minus(end, way[i]);
    const share = Math.min(Math.max(dot(minus(place, way[i]), along) / (dot(along, along) || 1), 0), 1);
    return Math.hypot(...minus(minus(place, way[i]), along.map((each) => each * share)));
  });
  return Math.min(...distances);
}

// The only recording of a folder: body -> its centres of mass, tick by tick.
async function readWays(folder) {
  const [recording] = fs.readdirSync(folder);
  const table = path.join(home, 'ways.csv');
  const words = ['export', path.join(folder, recording), '--output', table, '--fps', '60'];
  assert.equal(await new Program('wobble', words).end, 0);
  const rows = fs.readFileSync(table, 'utf8').split('\n').filter((line) => /^\d/.test(line));
  const ways = new Map();
  for (const row of rows) {
    const [, , body, , , x, y, z] = row.split(',').map(Number);
    if (!ways.has(body)) ways.set(body, []);
    ways.get(body).push([x, y, z]);
  }
  return ways;
}

// A gateway that sends what a test wants, and does not relay: { url, heard, stop }. play(send): once, after the hello.
async function startFakeGateway(play) {
  const server = new WebSocketServer({ port: 0, host: '127.0.0.1', handleProtocols: () => subprotocol });
  const fake = { heard: [], stop: () => (server.clients.forEach((each) => each.terminate()), server.close()) };
  server.on('connection', (socket) => {
    socket.on('message', (bytes) => {
      fake.heard.push(bytes);
      const send = (channel, message) => socket.send(Buffer.concat([Buffer.from([channel]), message]));
      if (fake.heard.length === 1) play(send);
    });
  });
  await new Promise((resolve) => server.on('listening', resolve));
  fake.url = `ws://127.0.0.1:${server.address().port}/play`;
  return fake;
}

const standard = fs.readFileSync(new URL('protocol/STANDARD.md', root), 'utf8');
function readVector(name) {
  const [, text] = new RegExp(`^\`\`\`text vector-${name}\\n([^\`]*)\`\`\`$`, 'm').exec(standard);
  return Buffer.from(text.replace(/\s/g, ''), 'hex');
}
// The standard's welcome, of a player whose body is the packet's. Its number lies where the client's is.
function makeWelcome() {
  const welcome = readVector('welcome');
  welcome.writeUInt16LE(welcome.readUInt16LE(30), 32);
  welcome.writeUInt32LE(7, 72);
  return welcome;
}
function makePacket(packet, number) {
  if (packet.length < 10) return packet;
  packet.writeUInt32LE(number, 2); // sequence
  packet.writeUInt32LE(120 + number, 6); // tick
  return packet;
}
// With the hash of what it holds now.
function signBlueprint(chunk) {
  let hash = 0xcbf29ce484222325n;
  for (const byte of chunk.subarray(68, 68 + 220)) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  if (chunk.length >= 64) chunk.writeBigUInt64LE(hash, 56);
  return chunk;
}
const nextScene = Buffer.from(
  '0c00000008000c000800040008000000100000000a00000006000800040000000800000004000000' + '00'.repeat(8),
  'hex',
);

describe('the client in GDScript', { concurrency: true }, () => {
  test('has the version and the hash of this schema', () => {
    const schema = fs.readFileSync(new URL('protocol/messages.fbs', root));
    const [high, low] = crypto.createHash('sha256').update(schema).digest('hex').match(/^(.{8})(.{8})/).slice(1);
    const script = fs.readFileSync(path.join(project, 'client.gd'), 'utf8');
    const wanted = `SCHEMA_HASH = 0x${high} << 32 | 0x${low}\n`;
    assert.ok(script.includes(wanted), `client.gd must have ${wanted}`);
    assert.equal(readVersion(fs.readFileSync(path.join(project, 'snapshots.gd'), 'utf8')), protocolVersion);
  });

  // The server's recording is the truth. Another client's samples are not: where that client did not get to run, they
  // cut the corners of the way, by 5 to 15 cm beside other tests.
  test('plays: its body moves, and is where the server has it', async () => {
    const recordings = path.join(home, 'recordings');
    const { program: server, address } = await startServer('--scene', 'arena', '--record', recordings);
    const { program: gateway, host } = await startGateway(address, page);
    const godot = startGodot(`ws://${host}/play`, 2.5);
    await godot.expectEnd(0);
    assert.equal(await gateway.stop(), 0);
    assert.ok(gateway.errors.some((line) => /: (left|the server has ended the connection); /.test(line)));
    await server.stop();
    assert.equal(godot.readRefused(), 0);
    const places = readPlaces(godot);
    assert.ok(places.length >= 4, godot.lines.join('\n'));
    const gone = Math.hypot(places.at(-1)[0] - places[0][0], places.at(-1)[1] - places[0][1]);
    assert.ok(gone > 0.5, `it went ${gone} m`);

    const ways = await readWays(recordings);
    assert.equal(places.at(-1)[3], ways.size);
    const farthest = (way) => Math.max(...places.map((place) => findDistance(place, way)));
    const distances = [...ways.values()].map(farthest).sort((a, b) => a - b);
    console.log(`it went ${gone.toFixed(2)} m; ${distances[0].toFixed(3)} m beside its way`);
    assert.ok(distances[0] < 0.05, `${distances[0]} m`); // its own body's way; no other body's is near
    assert.ok(distances[1] > 0.5, `${distances[1]} m`);
  });

  test('says why it does not get in', async () => {
    const passwordFile = path.join(home, 'password');
    fs.writeFileSync(passwordFile, 'tulip >\n', { mode: 0o600 });
    const { program: server, address } = await startServer('--password-file', passwordFile);
    const { program: gateway, host } = await startGateway(`garden=${address}`, page);
    const wrong = startGodot(`ws://${host}/play`, 1, '--password=rose');
    await wrong.expectEnd(2, /^wobble: .*password, invite or token is missing or not valid/);
    await startGodot(`ws://${host}/play/garden`, 0.5, '--password=tulip >').expectEnd(0);
    await startGodot(`ws://${host}/play/desert`, 1).expectEnd(2, /desert: nobody answers, or the gateway refuses/);
    await startGodot('ws://127.0.0.1:1/play', 1).expectEnd(2, /ws:\/\/127\.0\.0\.1:1\/play: nobody answers/);
    await startGodot('nowhere', 1).expectEnd(2, /nowhere: nobody answers/);
    await gateway.stop();
    await server.stop();
  });

  test('notices that the server goes away', async () => {
    const worlds = [];
    for (const signal of ['SIGINT', 'SIGKILL']) {
      const { program: server, address } = await startServer();
      const { program: gateway, host } = await startGateway(address, page);
      const godot = startGodot(`ws://${host}/play`, 60, '--rejoin=0');
      worlds.push({ signal, server, gateway, godot });
    }
    for (const { godot } of worlds) await godot.waitForLine(placeLine);
    for (const { server, signal } of worlds) server.process.kill(signal);
    await worlds[0].godot.expectEnd(2, /^wobble: the server is closing/);
    await worlds[1].godot.expectEnd(2, /^wobble: the server has been silent for 8 s|^wobble: .*(silent|lost)/);
    for (const { gateway } of worlds) await gateway.stop();

    const { program: gateway, host } = await startGateway('127.0.0.1:1', page);
    const godot = startGodot(`ws://${host}/play`, 60);
    await sleep(1000);
    gateway.process.kill('SIGKILL');
    await godot.expectEnd(2, /^wobble: the connection to ws:.* was lost/);
  });

  test('holds a body, and comes back to a server that was restarted', async () => {
    const scene = path.join(home, 'hill.toml');
    const hill = '[[obstacle]]\nkind = "height_field"\nposition = [50, 50, 1]\nheights = [[0, 1, 2], [3, 4, 5]]\n';
    fs.writeFileSync(scene, fs.readFileSync(path.join(binFolder, 'scenes/ball_drop.toml'), 'utf8') + hill);
    const options = ['--untrained', '--scene', scene];
    const { program: server, address } = await startServerOn(0, ...options);
    const { program: gateway, host } = await startGateway(address, page);
    const watcher = await connect({ url: `http://${host}`, spectate: true });
    const godot = startGodot(`ws://${host}/play`, 8, '--hold=1');
    const readHeld = () => /^holds (\d+)  z (.*)$/.exec(godot.lines.findLast((line) => line.startsWith('holds ')));
    await waitFor('a ball overhead', () => Number(readHeld()?.[2]) > 1.2);
    watcher.update();
    watcher.playing.sample();
    const seen = watcher.playing.bodies.find(({ body }) => body === Number(readHeld()[1]));
    assert.ok(seen.z > 1, `another client sees it at ${seen.z} m`);
    watcher.leave();
    server.process.kill('SIGINT');
    await godot.waitForLine(/^cut off: the server is closing/);
    await server.end;
    const { program: again } = await startServerOn(/\d+$/.exec(address)[0], ...options);
    await godot.waitForLine(/^plays again/);
    const before = readPlaces(godot).length;
    await waitFor('places', () => readPlaces(godot).length > before + 1);
    await godot.expectEnd(0);
    await gateway.stop();
    await again.stop();
  });

  test('reads the vectors of the standard, and drops what is not whole', async () => {
    let random = 26; // a linear congruential generator
    const draw = (below) => {
      random = (Math.imul(random, 1664525) + 1013904223) >>> 0;
      return Math.floor((random / 2 ** 32) * below);
    };
    const spoil = (bytes) => {
      const copy = Buffer.from(bytes);
      for (let i = draw(3); i >= 0; --i) copy[draw(copy.length)] = draw(4) === 0 ? 255 : draw(256);
      return draw(4) === 0 ? copy.subarray(0, draw(copy.length)) : copy;
    };
    const [welcome, blueprint, packet] = [makeWelcome(), readVector('blueprint'), readVector('packet')];
    const fake = await startFakeGateway(async (send) => {
      const sendWorld = (number) => {
        send(channels.control, welcome);
        send(channels.control, blueprint);
        send(channels.snapshot, makePacket(packet, number));
      };
      sendWorld(1);
      await waitFor('a place', () => readPlaces(godot).length > 0);
      for (let round = 1; round <= 500; ++round) {
        send(channels.control, nextScene);
        send(channels.control, draw(2) === 0 ? spoil(welcome) : welcome);
        send(channels.control, signBlueprint(spoil(blueprint)));
        send(channels.control, draw(2) === 0 ? spoil(blueprint) : blueprint);
        for (let i = 0; i < 4; ++i) send(channels.snapshot, makePacket(spoil(packet), 4 * round + i));
        if (round % 50 === 0) await sleep(20);
      }
      send(channels.control, nextScene);
      sendWorld(3000);
    });
    const godot = startGodot(fake.url, 3);
    await godot.end;
    fake.stop();
    await godot.expectEnd(0);
    const places = readPlaces(godot);
    assert.deepEqual(places[0], [1.5, -2.25, 2.75, 1]);
    assert.deepEqual(places.at(-1), [1.5, -2.25, 2.75, 1], 'after 500 rounds of bad bytes');
    console.log(`${godot.readRefused()} bad messages refused`);
    assert.ok(godot.readRefused() > 1000);
    const hellos = fake.heard.filter((bytes) => bytes[0] === channels.control && bytes[21] === 1).length;
    assert.ok(hellos > 250, `${hellos} hellos`);
  });
});
