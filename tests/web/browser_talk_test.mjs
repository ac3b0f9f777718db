// Two players in two pages tell one another something: lines, emotes, a new name; one is muted; contacts are heard.
// Pictures: talk.png, talk_phone.png.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { joinPage, outputFolder, pageFolder, probe, roomyScreen, startBrowser } from './support/browser.mjs';
import { Program, sleep, startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-talk-'));
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

const readLines = (page) => page.tab.getByRole('log', { name: 'What players say' }).locator('li').allTextContents();
const hears = (page, line) => waitFor(`the line "${line}"`, async () => (await readLines(page)).includes(line));

async function say(page, text) {
  await page.tab.keyboard.press('Enter');
  await page.tab.keyboard.type(text);
  await page.tab.keyboard.press('Enter');
}

async function picture(page, name, width, height) {
  const before = page.tab.viewportSize();
  await page.tab.setViewportSize({ width, height });
  await sleep(300);
  await page.tab.screenshot({ path: path.join(outputFolder, name) });
  await page.tab.setViewportSize(before);
}

test('lines, emotes, names, a mute and thuds in two pages', async () => {
  const socket = path.join(folder, 'admin.sock');
  const { program: server, address } = await startServerOn(0, '--scene', 'pair', '--untrained', '--admin-socket', socket);
  const { program: gateway, host } = await startGateway(address, pageFolder);
  const order = async (...words) => {
    const program = new Program('wobble', ['admin', '--socket', socket, ...words]);
    assert.equal(await program.end, 0, program.errors.join('\n'));
    return program.lines;
  };
  const query = 'name=mira&quality=5';
  const mira = await joinPage(browser, host, { query, viewport: roomyScreen, wait: 0 });
  const other = await joinPage(browser, host, { query, viewport: roomyScreen });
  const { ownBody } = await probe(mira, 'state');

  const people = other.tab.getByLabel('Scene and players');
  await waitFor('a name of its own', async () => (await people.getByLabel('Your name').inputValue()) === 'mira 2');
  assert.match((await people.textContent()) ?? '', /masses on springs/, 'the description of the scene');

  await say(mira, 'hello <b>you</b>, wasd');
  await hears(other, 'mira hello <b>you</b>, wasd');
  await hears(mira, 'mira hello <b>you</b>, wasd');
  const field = other.tab.getByLabel('Say a line to all', { exact: true }).and(other.tab.locator('input'));
  await other.tab.getByRole('button', { name: 'Say a line to all' }).click();
  await field.fill('hi');
  await field.press('Escape');
  assert.equal(await field.isVisible(), false);
  assert.equal((await readLines(other)).length, 1, 'given up');

  await mira.tab.keyboard.press('q');
  await mira.tab.getByRole('group', { name: 'Emotes' }).waitFor();
  await mira.tab.keyboard.press('2');
  await other.tab.locator('[data-emote=Laugh]').waitFor();
  await mira.tab.locator('[data-emote=Laugh]').waitFor();
  await other.tab.getByRole('button', { name: 'Show an emote' }).click();
  await other.tab.getByRole('button', { name: 'Love' }).click();
  await mira.tab.locator('[data-emote=Love]').waitFor();
  await say(other, 'who plays sumo with me afterwards?');
  await hears(mira, 'mira 2 who plays sumo with me afterwards?');
  await picture(mira, 'talk.png', 1280, 720);
  await picture(other, 'talk_phone.png', 390, 844);

  const name = mira.tab.getByLabel('Your name');
  await name.fill('nora');
  await name.press('Enter');
  await waitFor('the new name', async () => (await probe(other, 'state')).players.includes('nora'));
  assert.equal((await probe(mira, 'state')).ownBody, ownBody, 'without leaving');
  assert.match((await people.textContent()) ?? '', /nora/);

  await order('mute', '1', 'for', '1h');
  await mira.tab.getByText('you may only move: a moderator has muted you').waitFor();
  await say(mira, 'not heard');
  await order('rank', '2', 'moderator');
  await say(other, '/players');
  await waitFor('the answer', async () => (await readLines(other)).some((line) => /nora.*muted for 3\d+ s/.test(line)));
  await order('unmute', '1');
  await say(mira, 'back again');
  await hears(other, 'nora back again');
  assert.ok(!(await readLines(other)).some((line) => line.includes('not heard')));

  // A contact is found in motion of which there is news five times a second: one page alone is drawn as often.
  assert.deepEqual(other.complaints, []);
  await other.leave();
  await mira.tab.setViewportSize({ width: 480, height: 300 });
  // Again and again: who is thrown about by others has nothing to jump from.
  await waitFor('a thud', async () => {
    await mira.tab.keyboard.press('Space', { delay: 100 });
    return (await probe(mira, 'thuds')).some(({ body }) => body === ownBody);
  });
  await mira.tab.setViewportSize(roomyScreen);
  await mira.tab.getByRole('button', { name: 'Sound' }).click();
  assert.equal(await mira.tab.evaluate(() => localStorage.getItem('wobble.volume')), '0');
  assert.equal(await mira.tab.getByLabel('Volume').isVisible(), false);
  assert.deepEqual(mira.complaints, []);
  await mira.leave();
  await gateway.stop();
  await server.stop();
});
