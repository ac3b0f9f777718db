// Worlds of another kind in the page: recordings, which are chosen from the menu of worlds, shown to all who choose them,
// and wound by anybody with the line of time, while the camera follows a player and forces are shown as in play; and a
// server that goes from scene to scene.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { openPage, outputFolder, pageFolder, probe, roomyScreen, startBrowser, waitForPlaying } from './support/browser.mjs';
import { Program, startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

const kRecordings = new URL('../determinism/recordings/', import.meta.url).pathname;

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-film-'));
  const bytes = fs.readFileSync(path.join(kRecordings, 'sumo.wobrec'));
  fs.writeFileSync(path.join(folder, 'sumo.wobrec'), bytes); // its index comes beside it
  fs.copyFileSync(path.join(kRecordings, 'arena.wobrec'), path.join(folder, 'the match.wobrec'));
  bytes.fill(0, 12, 64); // the head's block
  fs.writeFileSync(path.join(folder, 'damaged.wobrec'), bytes);
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

const press = (place, name) => place.getByRole('button', { name, exact: true }).click();

// Of who could not join.
async function readCard(page) {
  const card = page.tab.locator('.veil .card');
  await waitFor('the card', async () => /Could not join/.test((await card.textContent()) ?? ''));
  return await card.textContent();
}

test('recordings are chosen, watched and wound in the page', async () => {
  const { program: server, address } = await startServerOn(0, '--scene', 'pair', '--untrained');
  const { program: gateway, host } = await startGateway(address, pageFolder, '--recordings', folder);
  const page = await openPage(browser, host, { query: 'name=mira&quality=5', viewport: roomyScreen });
  await waitForPlaying(page.tab);
  const menu = page.tab.getByRole('navigation', { name: 'Worlds' });
  await menu.getByText('Recordings', { exact: true }).click();
  const damaged = menu.getByRole('button', { name: 'Watch damaged.wobrec' });
  assert.ok(await damaged.isDisabled());
  await page.tab.screenshot({ path: path.join(outputFolder, 'recordings.png') });
  await press(menu, 'Watch sumo.wobrec');
  const panel = page.tab.getByLabel('Recording', { exact: true });
  const place = async () => (await panel.locator('output').textContent()) ?? '';
  await waitFor('the line of time', async () => (await place()).endsWith(' of 0:02'));
  await press(panel, 'Five seconds back');
  await press(panel, 'Speed 0.25');
  await waitFor('the speed', async () =>
    (await panel.getByRole('button', { name: 'Speed 0.25' }).getAttribute('aria-pressed')) === 'true');
  await press(panel, 'Five seconds on');
  await waitFor('the end', async () => (await place()).startsWith('0:02'));
  // Only then does the button mean "play": what it means is what the page was told last.
  const toggle = panel.getByRole('button', { name: 'Play or pause', exact: true });
  await waitFor('the pause at the end', async () => (await toggle.textContent()) === 'play');
  await press(panel, 'Speed -1');
  await press(panel, 'Play or pause');
  await waitFor('the beginning', async () => (await place()).startsWith('0:00'));

  await press(menu, 'Watch the match.wobrec');
  await waitFor('the other recording', async () => (await probe(page, 'state')).scene === 'arena');
  await press(panel, 'Five seconds on');
  await press(page.tab.getByLabel('Scene and players'), 'Follow Ada');
  await waitFor('the camera at the player', async () => {
    const { focus, watched } = await probe(page, 'state');
    const at = watched === 0 ? null : await probe(page, 'position', watched);
    return at !== null && Math.hypot(focus.x - at.x, focus.y - at.y) < 0.2;
  });
  await press(page.tab, 'View: forces and springs');
  await press(page.tab, 'Show forces as arrows');
  const { watched } = await probe(page, 'state');
  await waitFor('forces', async () => (await probe(page, 'forces')).body === watched);
  assert.ok((await probe(page, 'forces')).kinds.includes('Weight'));
  await page.tab.screenshot({ path: path.join(outputFolder, 'film.png') });

  await press(menu, 'Play the world');
  await waitFor('the world', async () => (await probe(page, 'state')).scene === 'pair');
  assert.deepEqual(page.complaints, []);

  for (const [file, reason] of [
    ['gone', /There is no such recording here\./],
    ['damaged', /The recording has no head that can be read/],
  ]) {
    await page.tab.goto(`http://${host}/?world=${file}.wobrec`);
    assert.match(await readCard(page), reason);
  }
  await page.leave();
  await gateway.stop();
  await server.stop();
});

test('the page goes along into the next scene and back', async () => {
  const socket = path.join(folder, 'admin.sock');
  const options = ['--untrained', '--rotation', 'curtain,pair', '--admin-socket', socket];
  const { program: server, address } = await startServerOn(0, ...options);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const page = await openPage(browser, host, { query: 'name=mira&quality=5', viewport: roomyScreen });
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
