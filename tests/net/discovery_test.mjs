// How a world is found, by programs that are not ours: gamedig asks what is played.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { Program, sleep, startServer, test, waitFor } from '../web/support/programs.mjs';

const root = new URL('../../', import.meta.url).pathname;
const load = createRequire(path.join(root, 'client/page/'));
const { GameDig } = load('gamedig');

let folder;
before(() => (folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-found-'))));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

const portOf = (address) => Number(address.split(':').at(-1));
const query = (address, options = {}) =>
  GameDig.query({ type: 'protocol-valve', host: '127.0.0.1', port: portOf(address), requestRules: true, ...options });

function write(name, text) {
  const file = path.join(folder, name);
  fs.writeFileSync(file, text, { mode: 0o600 });
  return file;
}

// Bots that play until the end of the test.
async function startPlayers(address, count, ...options) {
  const script = path.join(root, 'client/bots/scripts/wander.lua');
  new Program('wobble', ['bots', address, '--script', script, '--count', `${count}`, '--for', '40', ...options]);
  return await waitFor(`${count} players`, async () => {
    const found = await query(address);
    return found.numplayers === count ? found : sleep(200);
  });
}

test('gamedig reads what is played, by whom, and the rules', async () => {
  const { program, address } = await startServer('--name', 'Zoë’s world', '--ops', '0', '--max-clients', '12');
  const found = await startPlayers(address, 3);
  assert.equal(found.name, 'Zoë’s world');
  assert.equal(found.map, 'arena');
  assert.equal(found.maxplayers, 12);
  assert.equal(found.password, false);
  assert.match(found.version, /^\d+\.\d+\.\d+$/);
  assert.equal(found.raw.gamePort ?? found.queryPort, portOf(address));
  assert.ok(found.ping < 100, `${found.ping} ms`);
  assert.equal(found.players.length, 3);
  for (const player of found.players) {
    assert.match(player.name, /\w/);
    assert.ok(player.raw.time >= 0 && player.raw.time < 60, `${player.raw.time} s`);
  }
  assert.match(found.raw.rules.key, /^[0-9a-f]{64}$/);
  const ops = /port (\d+)/.exec(program.lines.find((line) => line.startsWith('metrics')))[1];
  const metrics = await (await fetch(`http://127.0.0.1:${ops}/metrics`)).text();
  for (const kind of ['challenge', 'info', 'players', 'rules']) {
    assert.match(metrics, new RegExp(`wobble_queries_total\\{kind="${kind}"\\} [1-9]`), kind);
  }
});

test("gamedig's own command finds the world by its scene's name", async () => {
  const { address } = await startServer('--scene', 'sumo');
  const { execFileSync } = await import('node:child_process');
  const script = path.join(root, 'client/page/node_modules/gamedig/bin/gamedig.js');
  const said = await waitFor('an answer', () => {
    const result = JSON.parse(execFileSync(process.execPath, [script, '--type', 'protocol-valve', address]));
    return result.error === undefined && result;
  });
  assert.equal(said.name, 'sumo');
  assert.equal(said.map, 'sumo');
});

test('where a game is played, the points of the players are told', async () => {
  const { address } = await startServer('--scene', 'crown');
  new Program('wobble', ['bots', address, '--script', path.join(root, 'client/bots/scripts/crown.lua'), '--count', '3']);
  const player = await waitFor('a point', async () => {
    const { players } = await query(address);
    return players.find(({ raw }) => raw.score > 0) ?? sleep(200);
  });
  assert.ok(player.raw.score < 1000, `${player.raw.score} points`);
});

test('where a password is asked for, players are counted and not named', async () => {
  const password = write('password', 'tulip\n');
  const { address } = await startServer('--password-file', password);
  const found = await startPlayers(address, 2, '--password-file', password);
  assert.equal(found.password, true);
  assert.deepEqual(found.players, []);
  assert.equal(found.numplayers, 2);
});

test('a hidden world tells nothing', async () => {
  const { address } = await startServer('--hidden');
  await assert.rejects(query(address, { socketTimeout: 500, maxRetries: 1 }), /Failed/);
});

test('a name that cannot be shown is refused in one line', async () => {
  for (const name of ['x'.repeat(64), 'two\nlines']) {
    const program = new Program('wobbled', ['--name', name, '--port', '0']);
    assert.equal(await program.end, 2);
    assert.match(program.errors.join(' '), /--name .*: must have at most 63 bytes/);
  }
});
