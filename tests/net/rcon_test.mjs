// Orders by RCON, with a client that is not ours, and by bytes.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { Program, sleep, startServer, test, waitFor } from '../web/support/programs.mjs';

const root = new URL('../../', import.meta.url).pathname;
const { Rcon } = createRequire(path.join(root, 'client/page/'))('rcon-client');

let folder, password;
before(() => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-rcon-'));
  password = path.join(folder, 'password');
  fs.writeFileSync(password, 'tulip\n', { mode: 0o600 });
});
after(() => fs.rmSync(folder, { recursive: true, force: true }));

// { program, port }
async function startWithRcon(...options) {
  const { program } = await startServer('--rcon', '0', '--rcon-password-file', password, ...options);
  return { program, port: Number(/^RCON on TCP port (\d+) of 127\.0\.0\.1$/m.exec(program.lines.join('\n'))[1]) };
}
const connect = (port, word = 'tulip') => Rcon.connect({ host: '127.0.0.1', port, password: word });

test('rcon-client changes the scene, and the players come along', async () => {
  const { program, port } = await startWithRcon('--rotation', 'sumo,arena');
  const rcon = await connect(port);
  assert.equal(await rcon.send('scene'), 'sumo of sumo, arena\n');
  assert.equal(await rcon.send('scene arena'), 'scene arena begins, and everybody comes along\n');
  const goesTo = (name) =>
    waitFor(name, async () => (await rcon.send('scene')).startsWith(`${name} of`) || sleep(50));
  await goesTo('arena');
  assert.equal(await rcon.send('next'), 'the next scene begins, and everybody comes along\n');
  await goesTo('sumo');
  assert.match(await rcon.send('scene curtain'), /curtain/);
  assert.match(await rcon.send('dance'), /there is no order "dance"/);
  await rcon.end();
  assert.match(program.errors.join('\n'), /order of RCON: scene arena \(done\)/);
  assert.equal(await program.stop(), 0);
});

test('after three wrong passwords the right one is refused as well', async () => {
  const { program, port } = await startWithRcon();
  for (let i = 0; i < 3; ++i) await assert.rejects(connect(port, 'rose'), /Authentication failed/);
  await assert.rejects(connect(port), /Authentication failed/);
  await program.waitForLine(/RCON: a wrong password from 127\.0\.0\.1/);
});

test('an empty value behind an order ends its answer', async () => {
  const { port } = await startWithRcon();
  const packet = (id, type, text) => {
    const bytes = Buffer.alloc(14 + Buffer.byteLength(text));
    [bytes.length - 4, id, type].forEach((number, i) => bytes.writeInt32LE(number, 4 * i));
    bytes.write(text, 12);
    return bytes;
  };
  const socket = net.connect(port, '127.0.0.1');
  let received = Buffer.alloc(0);
  socket.on('data', (bytes) => (received = Buffer.concat([received, bytes])));
  socket.write(Buffer.concat([packet(1, 3, 'tulip'), packet(2, 2, 'help'), packet(3, 0, '')]));
  const answers = await waitFor('the empty value', () => {
    const packets = [];
    for (let rest = received; rest.length >= 4 && rest.length >= 4 + rest.readInt32LE(0); ) {
      const end = 4 + rest.readInt32LE(0);
      packets.push({ id: rest.readInt32LE(4), type: rest.readInt32LE(8), text: rest.toString('utf8', 12, end - 2) });
      rest = rest.subarray(end);
    }
    return packets.some(({ id }) => id === 3) && packets;
  });
  socket.destroy();
  assert.deepEqual(answers[0], { id: 1, type: 0, text: '' });
  assert.deepEqual(answers[1], { id: 1, type: 2, text: '' });
  assert.match(answers[2].text, /^help: these lines\n/);
  assert.deepEqual(answers.at(-1), { id: 3, type: 0, text: '' });
});

test('RCON without a password does not start, and other machines are warned of', async () => {
  const cases = [
    [['--rcon', '0'], /--rcon 0: there is no password/],
    [['--rcon-password-file', password], /--rcon must be given/],
    [['--rcon', '0', '--rcon-password-file', path.join(folder, 'none')], /--rcon-password-file: .*none/],
    [['--rcon', 'x:y', '--rcon-password-file', password], /--rcon 'x:y': must be HOST:PORT or PORT/],
  ];
  for (const [options, reason] of cases) {
    const program = new Program('wobbled', ['--port', '0', ...options]);
    assert.equal(await program.end, 2);
    assert.match(program.errors.join('\n'), reason);
  }
  const { program } = await startServer('--rcon', '0.0.0.0:0', '--rcon-password-file', password);
  assert.match(program.errors.join('\n'), /other machines reach it, and what is sent, the password too, is not encrypted/);
});
