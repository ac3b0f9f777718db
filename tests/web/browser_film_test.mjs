// A recording in the page: it is shown to all who come in, and anybody winds it with the line of time.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { openPage, outputFolder, pageFolder, startBrowser, waitForPlaying } from './support/browser.mjs';
import { startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

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
