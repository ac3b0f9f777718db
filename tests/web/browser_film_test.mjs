// Worlds of another kind in the page: a recording, which is shown to all who come in and which anybody winds with the
// line of time; and a server that goes from scene to scene.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { openPage, outputFolder, pageFolder, startBrowser, waitForPlaying } from './support/browser.mjs';
import { Program, startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

const kRecording = new URL('../determinism/recordings/crowd.wobrec', import.meta.url).pathname;

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-film-'));
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

test('a recording is watched and wound in the page', async () => {
  const file = path.join(folder, 'crowd.wobrec'); // its index comes beside it
  fs.copyFileSync(kRecording, file);
  const { program: server, address } = await startServerOn(0, '--untrained', '--replay', file);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const page = await openPage(browser, host, { query: 'name=mira&quality=4' });
  await waitForPlaying(page.tab);
  const panel = page.tab.getByLabel('Recording', { exact: true });
  const place = async () => (await panel.locator('output').textContent()) ?? '';
  const press = (label) => panel.getByRole('button', { name: label, exact: true }).click();
  await waitFor('the line of time', async () => (await place()).endsWith(' of 0:02'));
  await press('Five seconds back');
  await press('Speed 0.25');
  await waitFor('the speed', async () =>
    (await panel.getByRole('button', { name: 'Speed 0.25' }).getAttribute('aria-pressed')) === 'true');
  await press('Five seconds on');
  await waitFor('the end', async () => (await place()).startsWith('0:02'));
  await page.tab.screenshot({ path: path.join(outputFolder, 'film.png') });
  await press('Speed -1');
  await press('Play or pause');
  await waitFor('the beginning', async () => (await place()).startsWith('0:00'));
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await gateway.stop();
  await server.stop();
});

test('the page goes along into the next scene and back', async () => {
  const socket = path.join(folder, 'admin.sock');
  const options = ['--untrained', '--rotation', 'curtain,pair', '--admin-socket', socket];
  const { program: server, address } = await startServerOn(0, ...options);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const page = await openPage(browser, host, { query: 'name=mira&quality=4' });
  await waitForPlaying(page.tab);
  const read = () => page.tab.evaluate(() => ({ ...window.wobble.state(), all: window.wobble.bodies() }));
  const first = await read();
  assert.equal(first.scene, 'curtain');
  for (const scene of ['pair', 'curtain', 'pair']) {
    const order = new Program('wobble', ['admin', '--socket', socket, 'next']);
    assert.equal(await order.end, 0, order.errors.join('\n'));
    await waitFor(`scene ${scene}`, async () => {
      const now = await read();
      return now.connection === 'Playing' && now.scene === scene && now.all.some(({ body }) => body === now.ownBody);
    });
    const now = await read();
    assert.deepEqual(now.players, ['mira']);
    assert.equal(now.all.some(({ name }) => name === 'curtain'), scene === 'curtain');
    assert.equal(await page.tab.title(), `${scene} · wobble`);
    assert.equal(now.endReason, '');
  }
  await page.tab.screenshot({ path: path.join(outputFolder, 'next_scene.png') });
  const statistics = await page.tab.evaluate(() => window.wobble.statistics());
  assert.equal(statistics.badMessages, 0);
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await gateway.stop();
  await server.stop();
});
