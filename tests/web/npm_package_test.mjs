// The npm package as strangers meet it: packed, installed without a network in an empty folder, and played with.
//
//   node npm_package_test.mjs [SECONDS]     of play; 2.5 by default
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, describe } from 'node:test';

import { makeProject, pageModules, version } from './support/outside_project.mjs';
import { makePage, Program, removePage, startGateway, startServer, test } from './support/programs.mjs';

const seconds = Number(process.argv[2] ?? 4);
const root = new URL('../../', import.meta.url).pathname;
const mostWebAssembly = 150_000; // bytes
const [major] = process.versions.node.split('.').map(Number);

let page;
let bare; // has the package alone
let project; // has ws beside it
before(async () => {
  page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' });
  [bare, project] = await Promise.all([makeProject(), makeProject()]);
  project.link('ws');
  for (const { folder, installed } of [bare, project]) {
    fs.copyFileSync(path.join(installed, 'examples/player.mjs'), path.join(folder, 'player.mjs'));
  }
});
after(() => {
  removePage(page);
  bare?.remove();
  project?.remove();
});

// Where the example printed that its body was.
function readPlaces({ code, lines, errors }) {
  assert.equal(code, 0, errors);
  return lines.map((line) => {
    const numbers = /^x (-?\d+\.\d\d)  y (-?\d+\.\d\d)  z (-?\d+\.\d\d)$/.exec(line);
    assert.ok(numbers, line);
    return numbers.slice(1).map(Number);
  });
}

describe('the package', { concurrency: true }, () => {
  test('the example plays in Node, by the package ws and by its own WebSocket, and its body moves', async (context) => {
    const { program: server, address } = await startServer('--scene', 'arena');
    const { program: gateway, host } = await startGateway(address, page);
    const play = (from, ...options) => from.run('node', ...options, 'player.mjs', `http://${host}`, `${seconds}`);
    const runs = [play(project)];
    if (major >= 22) runs.push(play(bare));
    else if (major >= 20) runs.push(play(bare, '--experimental-websocket'));
    else context.diagnostic('this Node has no WebSocket of its own');
    for (const run of await Promise.all(runs)) {
      const places = readPlaces(run);
      console.log(run.lines.join('\n'));
      assert.ok(places.length >= 2, `${places.length} lines`); // two a second where the machine has time
      const ways = places.slice(1).map(([x, y], i) => Math.hypot(x - places[i][0], y - places[i][1]));
      assert.ok(Math.max(...ways) > 0.1, `${ways}`);
    }
    assert.equal(await gateway.stop(), 0);
    // Each said goodbye, and then it, or the server that heard it, was the first to close.
    const ended = gateway.errors.filter((line) => /: (left|the server has ended the connection); /.test(line));
    assert.equal(ended.length, runs.length, gateway.errors.join('\n'));
    await server.stop();
  });

  test('who does not get in is told why', async () => {
    const passwordFile = path.join(project.folder, 'password');
    fs.writeFileSync(passwordFile, 'tulip\n', { mode: 0o600 });
    const { program: server, address } = await startServer('--password-file', passwordFile);
    const { program: gateway, host } = await startGateway(`garden=${address}`, page);
    const url = `ws://${host}`;
    const cases = [
      [{ url: 'localhost' }, /^TypeError: .*url: 'localhost' is no address/],
      [{ url: 'ftp://localhost' }, /^TypeError: .*url: 'ftp:\/\/localhost' is not of ws, wss, http or https$/],
      [{ url, password: 'rose', token: 'AAAA' }, /^TypeError: .*token and password: only one can be shown$/],
      [{ url, password: '' }, /^TypeError: .*password is empty$/],
      [{ url, invite: 'a b' }, /^TypeError: .*invite: only letters, digits, - and _$/],
      [{ url: 'ws://127.0.0.1:1' }, /^Error: ws:\/\/127\.0\.0\.1:1\/play: .*ECONNREFUSED/],
      [{ url, world: 'desert' }, /^Error: ws:\/\/localhost:\d+\/play\/desert: .*404/],
      [{ url }, /^Error: .*: the password, invite or token is missing or not valid/],
      [{ url, password: 'rose' }, /^Error: .*: the password, invite or token is missing or not valid/],
      [{ url, world: 'garden', password: 'tulip' }, /^plays$/],
    ];
    project.write('refusals.mjs', `import { connect } from 'wobble-client';
      for (const options of ${JSON.stringify(cases.map(([options]) => options))}) {
        const player = await connect(options).catch((error) => console.log(String(error)));
        if (player) console.log('plays');
        player?.leave();
      }`);
    const { code, lines, errors } = await project.run('node', 'refusals.mjs');
    assert.equal(code, 0, errors);
    assert.equal(lines.length, cases.length, lines.join('\n'));
    cases.forEach(([, expected], i) => assert.match(lines[i], expected));
    if (major < 22) {
      const without = await bare.run('node', 'player.mjs', url);
      assert.equal(without.code, 1);
      assert.match(without.errors, /no WebSocket: use version 22 or later, or `npm install ws`/);
    }
    await gateway.stop();
    await server.stop();
  });

  test('a player who was let in once comes back by a ticket, and a client that has ended says so', async () => {
    const socket = path.join(project.folder, 'admin.sock');
    const options = ['--invites', path.join(project.folder, 'invites'), '--admin-socket', socket];
    const { program: server, address } = await startServer(...options);
    const { program: gateway, host } = await startGateway(address, page);
    const admin = new Program('wobble', ['admin', '--socket', socket, 'invite', 'uses', '1']);
    assert.equal(await admin.end, 0, admin.errors.join('\n'));
    const [, invite] = /#invite=([\w-]+)/.exec(admin.lines.join('\n'));
    project.write('return.mjs', `import { connect } from 'wobble-client';
      const player = await connect({ url: 'ws://${host}', invite: '${invite}' });
      const before = player.playing;
      await new Promise((resolve) => setTimeout(resolve, 300)); // the ticket comes behind the welcome
      player.onPlay = () => {
        try { before.sample(); } catch (error) { console.log(error.message); }
        console.log(player.playing !== null, player.playing !== before);
        player.leave();
        console.log(player.playing, player.end.retryAt);
      };
      player.onEnd = console.log;
      player.joinAgain();`);
    const { code, lines, errors } = await project.run('node', 'return.mjs');
    assert.equal(code, 0, errors);
    const ended = 'wobble-client: this client has ended; take Connection.client';
    assert.deepEqual(lines, [ended, 'true true', 'null null'], errors);
    await gateway.stop();
    await server.stop();
  });

  test('the compiler accepts a strict project, for Node and for a bundler, and finds what is wrong in it', async () => {
    project.write('player.ts', `
      import { connect, EventKind, type Body, type Client, type Connection } from 'wobble-client';
      const player: Connection = await connect({ url: 'ws://localhost:8080', name: 'mira', world: 'arena' });
      const world: Client | null = player.playing;
      world?.setInput({ moveX: 1 });
      world?.setHand({ body: 1, vertex: 2, target: { x: 0, y: 0, z: 1 } });
      const body: Body | null | undefined = world?.findBody(world.readWelcome()?.ownBody ?? 0);
      if (world && body) {
        const positions: Float32Array = world.readPositions(body);
        const indices: Uint16Array = world.readIndices(body);
        note(positions.length + world.readNormals(body).length + indices.length + world.readStatistics().delay);
        if (world.takeEvent()?.kind === EventKind.Join) player.leave();
      }
      function note(figure: number): number {
        return figure;
      }
      // @ts-expect-error
      await connect({ address: 'ws://localhost:8080' });
      // @ts-expect-error
      world?.setInput({ moveX: '1' });\n`);
    const kinds = {
      node: { module: 'node16', lib: ['ES2022'] },
      bundler: { module: 'esnext', moduleResolution: 'bundler', lib: ['ES2022', 'DOM'] },
    };
    const checks = Object.entries(kinds).map(([name, kind]) => {
      const compilerOptions = { target: 'ES2022', strict: true, skipLibCheck: false, noEmit: true, types: [], ...kind };
      project.write(`${name}.json`, JSON.stringify({ compilerOptions, files: ['player.ts'] }));
      return project.run('node', path.join(pageModules, 'typescript/bin/tsc'), '--project', `${name}.json`);
    });
    for (const { code, lines } of await Promise.all(checks)) assert.equal(code, 0, lines.join('\n'));
  });

  test('the package has its version, licence, README, types, and nothing of the machine that packed it', () => {
    const read = (name) => fs.readFileSync(path.join(bare.installed, name));
    const described = JSON.parse(read('package.json'));
    assert.equal(described.version, version);
    assert.equal(described.license, 'MIT');
    assert.deepEqual(read('LICENSE'), fs.readFileSync(path.join(root, 'LICENSE')));
    assert.ok(read('README.md').length > 1000);
    const all = fs.readdirSync(bare.installed, { recursive: true, withFileTypes: true });
    const files = all.filter((file) => file.isFile());
    assert.ok(files.length > 20, `${files.length} files`);
    for (const file of files) {
      const name = path.relative(bare.installed, path.join(file.path, file.name));
      assert.ok(!read(name).includes(root), name);
    }
    const size = read('dist/wobble.wasm').length;
    assert.ok(size > 10_000 && size <= mostWebAssembly, `${size} bytes`);
  });
});
