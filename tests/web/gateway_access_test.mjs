// Who may come in through the gateway: what a browser shows, what the server says to it, and whose address counts.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { channels, join, Player, serverMessages, subprotocol } from './support/player.mjs';
import { makePage, Program, removePage, startGateway, startServer, test, waitFor } from './support/programs.mjs';

const refused = {
  code: 4001,
  reason: 'the password, invite or token is missing or not valid, or too many were tried from your address: wait 5 s',
};
const encode = (text) => Buffer.from(text).toString('base64url');
const showing = (credential) => ({ protocols: [subprotocol, credential] });
const at = (address, credential) => ({ ...showing(credential), headers: { 'X-Forwarded-For': address } });

let page;
let folder;
before(() => {
  page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' });
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-access-'));
});
after(() => {
  removePage(page);
  fs.rmSync(folder, { recursive: true, force: true });
});

function write(name, text) {
  const file = path.join(folder, name);
  fs.writeFileSync(file, text, { mode: 0o600 });
  return file;
}

// The lines that the server answers to an order.
async function order(socket, ...words) {
  const admin = new Program('wobble', ['admin', '--socket', socket, ...words]);
  assert.equal(await admin.end, 0, admin.errors.join('\n'));
  return admin.lines;
}

async function isLetIn(host, options) {
  const player = await join(host, options);
  const ticket = player.messages.find((bytes) => bytes[0] === channels.ticket)?.subarray(1);
  await player.leave();
  return { ticket };
}

test('a password lets in, and no other; refused browsers keep no place', async () => {
  const { program: server, address } = await startServer('--password-file', write('password', 'tulip é\n'));
  const { program: gateway, host } = await startGateway(address, page, '--max-connections', '1');
  for (const protocols of [[subprotocol], [subprotocol, `password.${encode('rose')}`], [subprotocol, 'token.AAAA']]) {
    const player = new Player(host, { protocols });
    assert.equal(await player.opened, true);
    assert.equal(player.socket.protocol, subprotocol);
    assert.deepEqual(await player.closed, refused);
    assert.deepEqual(player.messages, []);
  }
  const mallory = new Player(host, showing(`password.${encode('rose')}`));
  const { ticket } = await isLetIn(host, showing(`password.${encode('tulip é')}`));
  assert.equal(ticket, undefined); // a password is good again
  assert.deepEqual(await mallory.closed, refused);

  const malformed = ['password.', 'password.a', 'password.dHVsaXB', `token.${encode('x'.repeat(301))}`];
  for (const word of malformed) assert.equal(await new Player(host, showing(word)).opened, 400, word);
  const two = [subprotocol, `password.${encode('tulip é')}`, `invite.${encode('x')}`];
  assert.equal(await new Player(host, { protocols: two }).opened, 400);
  assert.equal(await gateway.stop(), 0);
  const written = [...gateway.lines, ...gateway.errors, ...server.lines, ...server.errors].join('\n');
  for (const secret of ['tulip', 'rose', encode('tulip é'), encode('rose')]) assert.ok(!written.includes(secret), secret);
  assert.match(gateway.lines.at(-1), / 5 browsers, 0 without a place, 0 cut off/);
  await server.stop();
});

test('an invite lets in as often as it says, and its ticket again', async () => {
  const socket = path.join(folder, 'invites.sock');
  const options = ['--invites', path.join(folder, 'invites'), '--admin-socket', socket];
  const { program: server, address } = await startServer(...options, '--owner-key', path.join(folder, 'owner.key'));
  const { program: gateway, host } = await startGateway(address, page);
  const lines = await order(socket, 'invite', 'uses', '1');
  const invite = /#invite=([\w-]+)/.exec(lines.join('\n'))[1];
  const { ticket } = await isLetIn(host, showing(`invite.${invite}`));
  assert.ok(ticket.length > 100);
  assert.deepEqual(await new Player(host, showing(`invite.${invite}`)).closed, refused);
  for (let i = 0; i < 2; ++i) await isLetIn(host, showing(`token.${ticket.toString('base64url')}`));
  ticket[50] ^= 1;
  assert.deepEqual(await new Player(host, showing(`token.${ticket.toString('base64url')}`)).closed, refused);

  const owner = Buffer.from(fs.readFileSync(path.join(folder, 'owner.key'), 'latin1').trim(), 'hex');
  const player = await join(host, showing(`owner.${owner.toString('base64url')}`));
  assert.match((await order(socket, 'players')).join('\n'), / owner /);
  await player.leave();
  await gateway.stop();
  await server.stop();
});

test('servers with the gateway\'s key count and ban the addresses of browsers', async () => {
  const socket = path.join(folder, 'bans.sock');
  const key = path.join(folder, 'gateway.key');
  const options = ['--gateway-key', key, '--password-file', write('password2', 'tulip'), '--admin-socket', socket];
  const { program: server, address } = await startServer(...options, '--max-per-address', '1');
  const { program: gateway, host } = await startGateway(address, page, '--gateway-key', key, '--trusted-proxy', '127.0.0.1');
  const password = `password.${encode('tulip')}`;
  const first = await join(host, at('198.51.100.7', password));
  const second = await join(host, at('198.51.100.8', password));
  const many = { code: 4000, reason: 'too many connections from this address' };
  assert.deepEqual(await new Player(host, at('198.51.100.7', password)).closed, many);
  assert.deepEqual(await new Player(host, at('198.51.100.9', `password.${encode('rose')}`)).closed, refused);
  const players = (await order(socket, 'players')).join('\n');
  assert.match(players, /198\.51\.100\.7/);
  assert.match(players, /198\.51\.100\.8/);

  assert.match((await order(socket, 'ban', '198.51.100.7')).join('\n'), /1 sent away/);
  assert.deepEqual(await first.closed, { code: 1000, reason: 'the server has ended the connection' });
  assert.ok(first.has(serverMessages.goodbye));
  const banned = { code: 4000, reason: 'banned from this server' };
  assert.deepEqual(await new Player(host, at('198.51.100.7', password)).closed, banned);
  const before = second.count(channels.snapshot);
  await waitFor('more snapshots for the other', () => second.count(channels.snapshot) > before + 10);
  await second.leave();
  await isLetIn(host, at('198.51.100.9', password)); // a wrong password bans nobody
  assert.equal(await gateway.stop(), 0);

  const wrong = await startGateway(address, page, '--gateway-key', write('other.key', `${'ab'.repeat(32)}\n`));
  assert.deepEqual(await new Player(wrong.host, showing(password)).closed, refused);
  assert.match(wrong.program.errors.join('\n'), /has refused a browser, and has let in none: .*another --gateway-key/);
  await wrong.program.stop();
  await server.stop();
});

test('a gateway that an open server does not know says so to its host and to browsers', async () => {
  const { program: server, address } = await startServer('--gateway-key', path.join(folder, 'open.key'));
  const options = ['--gateway-key', write('strange.key', `${'cd'.repeat(32)}\n`)];
  const { program: gateway, host } = await startGateway(address, page, ...options);
  const unknown = { code: 4000, reason: 'the server does not know this gateway' };
  assert.deepEqual(await new Player(host).closed, unknown);
  assert.match(gateway.errors.join('\n'), /^wobble gateway: the server does not know this gateway: its --gateway-key is/m);
  await waitFor('a line of the server', () => /a gateway at 127\.0\.0\.1 was refused/.test(server.errors.join('\n')));
  await gateway.stop();
  await server.stop();
});

test('a gateway without the key that it was told to have does not start', async () => {
  const file = path.join(folder, 'none.key');
  const program = new Program('wobble', ['gateway', '--server', '127.0.0.1:9', '--page', page, '--gateway-key', file]);
  assert.equal(await program.end, 2);
  assert.match(program.errors.join('\n'), /^wobble gateway: --gateway-key: .*none\.key/);
});
