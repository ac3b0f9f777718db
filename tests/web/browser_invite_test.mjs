// How friends are brought in: the link that the page makes, worlds elsewhere, https, and what the page says of a world
// that is not there, full, or silent.
import assert from 'node:assert';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { joinPage, openPage, outputFolder, pageFolder, roomyScreen, startBrowser, waitForPlaying }
  from './support/browser.mjs';
import { startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

const desktop = { width: 1280, height: 720 };
const phone = { width: 390, height: 844 };
const lyingPhone = { width: 844, height: 390 };

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-invite-'));
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

const startPair = (...options) => startServerOn(0, '--scene', 'pair', '--untrained', ...options);
const findButton = (page) => page.tab.getByRole('button', { name: 'Invite friends' });
const findDialog = (page) => page.tab.getByRole('dialog', { name: 'Invite friends' });
const findLink = (page) => page.tab.getByLabel('Link to this world');
const readMarked = (page) => page.tab.evaluate(() => document.activeElement.value?.slice(
  document.activeElement.selectionStart, document.activeElement.selectionEnd));

// Whether a finder pattern, dark, light, dark, stands with its middle in this module of the code.
const hasFinder = (page, column, row) =>
  page.tab.getByLabel('The link as a QR code').evaluate(
    (canvas, [column, row]) => {
      const scale = 6; // pixels of a module
      const line = canvas.getContext('2d').getImageData(0, row * scale + 3, canvas.width, 1).data;
      const isDark = (x) => line[4 * (x * scale + 3)] < 128;
      return [0, 1, 2, 3, 4].map((away) => isDark(column + away)).join() === 'true,true,false,true,false';
    },
    [column, row],
  );

test('the link of a page on localhost has an address that others reach, and no secret', async () => {
  const { program: server, address } = await startPair();
  const { program: gateway, host } = await startGateway(`one=${address}`, pageFolder, '--server', `two=${address}`);
  const { addresses } = await (await fetch(`http://${host}/worlds`)).json();
  const [, port] = host.split(':');
  for (const [screens, isPhone] of [[[desktop], false], [[phone, lyingPhone], true]]) {
    const options = { viewport: screens[0], hasTouch: isPhone, isMobile: isPhone };
    const page = await joinPage(browser, host, { ...options, query: 'name=mira&quality=5&world=two' });
    if (isPhone) await page.tab.getByRole('button', { name: /players and worlds$/ }).tap();
    await findButton(page).click();
    for (const screen of screens) {
      await page.tab.setViewportSize(screen);
      await findDialog(page).waitFor();
      const name = `${screen.width}x${screen.height}`;
      await page.tab.screenshot({ path: path.join(outputFolder, `invite_${name}.png`) });
      const box = await findDialog(page).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= screen.width, name);
      assert.ok(box.y >= 0 && box.y + box.height <= screen.height, name);
      assert.equal(await findDialog(page).evaluate((dialog) => dialog.scrollHeight > dialog.clientHeight), false, name);
    }
    assert.equal(await findLink(page).inputValue(), `http://${addresses[0] ?? 'localhost'}:${port}/?world=two`);
    assert.ok(await hasFinder(page, 7, 7));
    assert.equal(await page.tab.getByRole('button', { name: /^Add an invite/ }).isVisible(), false);
    assert.deepEqual(page.complaints, []);
    await page.leave();
  }
  await gateway.stop();
  await server.stop();
});

test('by the keyboard: it opens, copies where the browser allows it, else marks the text, and closes', async () => {
  const { program: server, address } = await startPair();
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const page = await joinPage(browser, host, { viewport: roomyScreen, permissions: ['clipboard-read', 'clipboard-write'] });
  await findButton(page).focus();
  await page.tab.keyboard.press('Enter');
  await findDialog(page).waitFor();
  const link = await findLink(page).inputValue();
  assert.equal(await readMarked(page), link);
  await page.tab.keyboard.press('w'); // would move
  await page.tab.keyboard.press('Tab');
  await page.tab.keyboard.press('Enter');
  await page.tab.getByText('Copied.').waitFor();
  assert.equal(await page.tab.evaluate(() => navigator.clipboard.readText()), link);
  await page.tab.keyboard.press('Escape');
  assert.equal(await findDialog(page).isVisible(), false);
  assert.match(await page.tab.evaluate(() => document.activeElement.textContent), /Invite friends/);
  await page.leave();

  const [, port] = host.split(':');
  const plain = await joinPage(browser, `play.example.org:${port}`, { viewport: roomyScreen });
  await findButton(plain).click();
  assert.equal(await plain.tab.getByRole('button', { name: 'Copy the link' }).isVisible(), false);
  assert.equal(await readMarked(plain), `http://play.example.org:${port}/`);
  assert.deepEqual(plain.complaints, []);
  await plain.leave();
  await gateway.stop();
  await server.stop();
});

test('an owner puts an invite into the link, which lets in where nobody comes in without', async () => {
  const key = path.join(folder, 'owner.key');
  const { program: server, address } = await startPair('--invites', path.join(folder, 'invites'), '--owner-key', key);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const [, port] = host.split(':');
  const owner = `name=mira&quality=5#owner=${fs.readFileSync(key, 'latin1').trim()}`;
  const page = await joinPage(browser, `play.example.org:${port}`, { query: owner, viewport: roomyScreen });
  await findButton(page).click();
  assert.doesNotMatch(await findLink(page).inputValue(), /#/);
  await page.tab.getByRole('button', { name: /^Add an invite/ }).click();
  await page.tab.getByText('Whoever has this link comes in as a player, for a day.').waitFor();
  await page.tab.screenshot({ path: path.join(outputFolder, 'invite_owner.png') });
  const link = await findLink(page).inputValue();
  assert.match(link, /\/#invite=[\w-]+$/);
  const guest = await browser.newPage();
  await guest.goto(link);
  await waitForPlaying(guest);
  const first = page.tab.getByRole('dialog').getByRole('button', { name: 'Close' });
  await first.click();
  assert.equal(await page.tab.locator('.toast').filter({ hasText: '#invite' }).count(), 0);
  await guest.close();
  await page.leave();
  await gateway.stop();
  await server.stop();
});

test('worlds elsewhere are links, and an https page plays over wss', async () => {
  const files = ['cert.pem', 'key.pem'].map((name) => path.join(folder, name));
  const names = ['-subj', '/CN=wobble', '-addext', 'subjectAltName=DNS:localhost'];
  execFileSync('openssl', ['req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '2', '-out', files[0], '-keyout',
    files[1], ...names], { stdio: 'ignore' });
  const list = path.join(folder, 'list.json');
  fs.writeFileSync(list, JSON.stringify({ version: 1, worlds: [
    { name: '<b>Ada</b>', page: 'https://play.example.org/?world=sumo', scene: 'sumo' }, { name: 'plain', address: 'h:1' },
  ] }));
  const { program: server, address } = await startPair();
  const options = ['--tls-cert', files[0], '--tls-key', files[1], '--list', list];
  const { program: gateway, host } = await startGateway(address, pageFolder, ...options);
  const page = await joinPage(browser, host, { scheme: 'https', ignoreHTTPSErrors: true, viewport: roomyScreen });
  await waitFor('its lanes', () => page.requests.filter((url) => url === `wss://${host}/play`).length === 4);
  await page.tab.getByText('Elsewhere', { exact: true }).click();
  const link = page.tab.getByRole('link');
  assert.equal(await link.count(), 1);
  assert.equal(await link.getAttribute('href'), 'https://play.example.org/?world=sumo');
  assert.match(await link.innerText(), /^<b>Ada<\/b>/);
  await page.tab.screenshot({ path: path.join(outputFolder, 'elsewhere.png') });
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await gateway.stop();
  await server.stop();
});

test('a world that is not there is not another one, and an invite to it is shown to none', async () => {
  const { program: server, address } = await startPair();
  const { program: gateway, host } = await startGateway(`one=${address}`, pageFolder, '--server', `two=${address}`);
  const page = await openPage(browser, host, { query: 'name=mira&quality=5&world=three#invite=abc' });
  await page.tab.getByText('“three” is not among the worlds of this page.').waitFor();
  await page.tab.waitForTimeout(500);
  assert.deepEqual(page.requests.filter((url) => url.startsWith('ws')), []);
  assert.equal(new URL(page.tab.url()).hash, '');
  await page.tab.screenshot({ path: path.join(outputFolder, 'no_such_world.png') });
  await page.tab.getByRole('button', { name: 'Go to one' }).click();
  await waitForPlaying(page.tab);
  assert.equal(new URL(page.tab.url()).searchParams.get('world'), 'one');
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await gateway.stop();
  await server.stop();
});
