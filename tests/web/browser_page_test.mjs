// The page as a whole: its size and the origin of its files, which origins the gateway admits, and the page's message
// at the end.
import assert from 'node:assert';
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { after, before } from 'node:test';
import zlib from 'node:zlib';

import { joinPage, pageFolder, startBrowser, startServerAt, startWorld, waitForPlaying } from './support/browser.mjs';
import { subprotocol } from './support/player.mjs';
import { test, waitFor } from './support/programs.mjs';

const mostCompressed = 1_000_000; // bytes, all files
const mostWebAssembly = 150_000;

let browser;
let world;
let page;
before(async () => {
  browser = await startBrowser();
  world = await startWorld('arena');
  page = await joinPage(browser, world.host);
});
after(async () => {
  await browser?.close();
  await world?.stop();
});

test('the page is small', () => {
  const files = fs.readdirSync(pageFolder, { recursive: true, withFileTypes: true }).filter((file) => file.isFile());
  const read = (file) => fs.readFileSync(path.join(file.path, file.name));
  const compressed = files.map((file) => zlib.gzipSync(read(file)).length).reduce((a, b) => a + b, 0);
  assert.ok(compressed > 10_000 && compressed <= mostCompressed, `${compressed} bytes`);
  const code = files.filter((file) => file.name.endsWith('.wasm')).map((file) => read(file).length);
  assert.equal(code.length, 1);
  assert.ok(code[0] <= mostWebAssembly, `${code[0]} bytes`);
});

test('it plays by itself, without a complaint, and asks nobody but the gateway', async () => {
  await page.tab.waitForTimeout(1000);
  assert.deepEqual(page.complaints, []);
  assert.deepEqual(page.failures, []);
  assert.ok(page.requests.some((url) => url === `ws://${world.host}/play`));
  assert.ok(page.requests.some((url) => url.endsWith('.wasm')));
  assert.deepEqual([...new Set(page.requests.map((url) => new URL(url).host))], [world.host]);
  const { scene, players } = await page.tab.evaluate(() => window.wobble.state());
  assert.equal(scene, 'arena');
  assert.deepEqual(players, ['mira']);
});

// Runs in the tab's own page: whether a socket to the gateway opened, and how it closed after so many bytes were sent.
const trySocket = (tab, bytes) =>
  tab.evaluate(
    ([url, subprotocol, bytes]) =>
      new Promise((resolve) => {
        const socket = new WebSocket(url, subprotocol);
        let opened = false;
        socket.onopen = () => {
          opened = true;
          if (bytes > 0) socket.send(new Uint8Array(bytes));
          else socket.close(1000);
        };
        socket.onclose = ({ code }) => resolve({ opened, code });
      }),
    [`ws://${world.host}/play`, subprotocol, bytes],
  );

test('a page of another origin is not let in', async () => {
  const stranger = http.createServer((_, answer) => answer.end('<!doctype html><title>stranger</title>'));
  await new Promise((resolve) => stranger.listen(0, '127.0.0.1', resolve));
  const tab = await browser.newPage();
  await tab.goto(`http://localhost:${stranger.address().port}/`);
  assert.deepEqual(await trySocket(tab, 0), { opened: false, code: 1006 });
  await tab.close();
  stranger.close();
  stranger.closeAllConnections();
  assert.deepEqual(await trySocket(page.tab, 0), { opened: true, code: 1000 });
});

test('who sends too much at once is cut off', async () => {
  assert.deepEqual(await trySocket(page.tab, 10_000), { opened: true, code: 1009 });
});

test('when the server has gone the page says so, and joins again when it is back', async () => {
  const card = page.tab.getByRole('heading', { name: 'The server has closed' });
  assert.equal(await card.isVisible(), false);
  await world.server.stop();
  await card.waitFor();
  await page.tab.getByText('This page tries again by itself.').waitFor();
  await page.tab.getByRole('button', { name: 'Join again' }).waitFor();
  assert.notEqual(await page.tab.evaluate(() => window.wobble.state().endReason), '');

  world.server = await startServerAt(world.address, 'arena');
  await waitForPlaying(page.tab);
  await waitFor('the card to go', async () => !(await page.tab.locator('.veil').first().isVisible()));
});

test('when the server was killed and is started again, the page is back within five seconds', async () => {
  await world.server.stop('SIGKILL');
  await page.tab.waitForTimeout(1200);
  const begin = performance.now();
  world.server = await startServerAt(world.address, 'pair');
  await waitFor('the new world', async () => (await page.tab.evaluate(() => window.wobble.state().scene)) === 'pair');
  await waitForPlaying(page.tab);
  const seconds = (performance.now() - begin) / 1000;
  assert.ok(seconds < 5, `${seconds} s`);
  console.log(`the page plays ${seconds.toFixed(2)} s after the start`);
});
