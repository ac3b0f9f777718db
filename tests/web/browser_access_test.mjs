// How people come into a world that does not let in everybody: a password that the page asks for, links, and tickets.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { openPage, outputFolder, pageFolder, roomyScreen, startBrowser, waitForPlaying } from './support/browser.mjs';
import { Program, startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-access-'));
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

const startPair = (port, ...options) => startServerOn(port, '--scene', 'pair', '--untrained', ...options);

// The lines that the server answers to an order.
async function order(socket, ...words) {
  const admin = new Program('wobble', ['admin', '--socket', socket, ...words]);
  assert.equal(await admin.end, 0, admin.errors.join('\n'));
  return admin.lines;
}
const invite = async (socket) => /#invite=[\w-]+/.exec((await order(socket, 'invite', 'uses', '1')).join('\n'))[0];

// The page behind `#...`; it lists in window.offered what its first WebSockets offer beside wobble's own subprotocol.
const openWith = (host, fragment) =>
  openPage(browser, host, {
    query: `name=mira&quality=5${fragment}`,
    viewport: roomyScreen,
    onTab: (tab) =>
      tab.addInitScript(() => {
        window.offered = [];
        window.WebSocket = class extends WebSocket {
          constructor(url, protocols) {
            super(url, protocols);
            if (protocols[1]?.startsWith('more.')) return; // a lane shows no credential
            window.offered.push([new URL(url).pathname, ...protocols.slice(1)].join(' '));
          }
        };
      }),
  });
const readOffered = (page) => page.tab.evaluate(() => window.offered);
const findForm = (page) => page.tab.getByLabel('Password');

async function enter(page, password) {
  await findForm(page).fill(password);
  await findForm(page).press('Enter');
}

test('the page asks for a password, again after a wrong one, and not after a lost connection', async () => {
  const file = path.join(folder, 'password');
  fs.writeFileSync(file, 'tulip é\n', { mode: 0o600 });
  const { program: server, address } = await startPair(0, '--password-file', file);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const page = await openWith(host, '');
  await findForm(page).waitFor();
  await page.tab.screenshot({ path: path.join(outputFolder, 'password.png') });
  await enter(page, 'rose');
  await waitFor('a second try', async () => (await readOffered(page)).length === 2);
  await page.tab.getByText('That password does not hold').waitFor();
  await enter(page, 'tulip é');
  await waitForPlaying(page.tab);
  assert.equal(await findForm(page).isVisible(), false);
  const right = `/play password.${Buffer.from('tulip é').toString('base64url')}`;
  assert.deepEqual(await readOffered(page), ['/play', `/play password.${Buffer.from('rose').toString('base64url')}`, right]);

  await server.stop('SIGKILL');
  const again = await startPair(address.split(':')[1], '--password-file', file);
  await waitFor('a new try', async () => (await readOffered(page)).length > 3);
  await waitForPlaying(page.tab);
  assert.equal((await readOffered(page)).at(-1), right);
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await gateway.stop();
  await again.program.stop();
});

test('an invite lets in, leaves the address, and its ticket lets the tab back in; who is kicked stays out', async () => {
  const socket = path.join(folder, 'admin.sock');
  const options = ['--invites', path.join(folder, 'invites'), '--admin-socket', socket];
  const { program: server, address } = await startPair(0, ...options);
  const { program: other, address: otherAddress } = await startPair(0);
  const { program: gateway, host } = await startGateway(`here=${address}`, pageFolder, '--server', `there=${otherAddress}`);
  const link = await invite(socket);
  const page = await openWith(host, link);
  await waitForPlaying(page.tab);
  assert.equal(new URL(page.tab.url()).hash, '');
  assert.deepEqual(await readOffered(page), [`/play/here ${link.slice(1).replace('=', '.')}`]);
  await page.tab.reload();
  await waitForPlaying(page.tab);
  assert.match((await readOffered(page))[0], /^\/play\/here token\.[\w-]{100,}$/);

  // Another world's server hears nothing of it.
  await page.tab.getByRole('button', { name: 'Play there' }).click();
  await waitFor('the other world', async () => (await readOffered(page)).includes('/play/there'));
  assert.deepEqual(page.complaints, []);
  await page.leave();

  const late = await openWith(host, link);
  await findForm(late).waitFor();
  const second = await invite(socket);
  await late.tab.evaluate((hash) => (location.hash = hash), second); // as a link that is opened in this tab
  await waitForPlaying(late.tab);
  assert.equal(new URL(late.tab.url()).hash, '');

  const client = await waitFor('nobody else of this name', async () => {
    const found = [...(await order(socket, 'players')).join('\n').matchAll(/^ *(\d+) mira/gm)];
    return found.length === 1 && found[0][1];
  });
  await order(socket, 'kick', client, 'be', 'nice');
  const card = late.tab.getByRole('status').filter({ hasText: 'You were sent away' });
  await card.waitFor();
  assert.match(await card.innerText(), /be nice/);
  await late.tab.waitForTimeout(1000);
  assert.equal((await readOffered(late)).length, 2);
  await late.leave();
  await gateway.stop();
  await Promise.all([server.stop(), other.stop()]);
});

test('an owner comes by a link; who is one too many from an address, or banned, does not try by itself', async () => {
  const socket = path.join(folder, 'bans.sock');
  const key = path.join(folder, 'owner.key');
  const options = ['--max-per-address', '1', '--admin-socket', socket, '--owner-key', key];
  const { program: server, address } = await startPair(0, ...options);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const first = await openWith(host, `#owner=${fs.readFileSync(key, 'latin1').trim()}`); // as the key's file has it
  await waitForPlaying(first.tab);
  assert.equal(new URL(first.tab.url()).hash, '');
  assert.match((await order(socket, 'players')).join('\n'), /mira +owner /);
  const second = await openWith(host, '');
  await second.tab.getByText('Too many from your address').waitFor();
  await order(socket, 'ban', '127.0.0.1');
  await first.tab.getByText('You are banned here').waitFor();
  await first.leave();
  await second.tab.getByRole('button', { name: 'Join again' }).click();
  await second.tab.getByText('You are banned here').waitFor();
  await second.tab.waitForTimeout(1000);
  assert.equal((await readOffered(second)).length, 2);
  await second.leave();
  await gateway.stop();
  await server.stop();
});
