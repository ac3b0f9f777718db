// What the page says and shows in each state: cards, silence, waiting; on small screens; by touch, keyboard and gamepad;
// to who watches; and that it can be read and used by all.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { joinPage, openPage, pageFolder, probe, roomyScreen, startBots, startBrowser, startWorld, waitForPlaying }
  from './support/browser.mjs';
import { findBoxes, findPoorTexts, overlap, tabThrough } from './support/looks.mjs';
import { addPad, hold, press } from './support/pad.mjs';
import { Program, startGateway, startServerOn, test, waitFor } from './support/programs.mjs';

const phones = { landscape: { width: 844, height: 390 }, portrait: { width: 390, height: 844 } };
const cheap = 'name=mira&quality=5';
const { resolve } = createRequire(new URL('../../client/page/package.json', import.meta.url));
const axe = fs.readFileSync(resolve('axe-core/axe.min.js'), 'utf8');

let browser;
let folder;
before(async () => {
  browser = await startBrowser();
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-states-'));
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
});

const findCard = (page) => page.tab.locator('.veil .card');
const waitForCard = (page, title) => page.tab.getByRole('heading', { name: title }).waitFor();
const isSeen = (page, selector) => page.tab.locator(selector).first().isVisible();

// Faults that axe-core finds against WCAG 2.1, A and AA. Contrast above the world is ours to compute.
async function findFaults(page) {
  await page.tab.evaluate(axe);
  const { violations } = await page.tab.evaluate(() =>
    window.axe.run(document, {
      runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'],
      rules: { 'color-contrast': { enabled: false } },
    }),
  );
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 90)).join(' | ')}`);
}

test('cards say what has happened and what one can do', async () => {
  const socket = path.join(folder, 'admin.sock');
  const options = ['--untrained', '--max-clients', '1', '--admin-socket', socket];
  const { program: server, address } = await startServerOn(0, '--scene', 'pair', ...options);
  const dead = '127.0.0.1:9'; // nobody is there
  const { program: gateway, host } = await startGateway(`here=${address}`, pageFolder, '--server', `gone=${dead}`);
  const order = async (...words) => {
    const admin = new Program('wobble', ['admin', '--socket', socket, ...words]);
    assert.equal(await admin.end, 0, admin.errors.join('\n'));
    return admin.lines.join('\n');
  };
  const first = await joinPage(browser, host, { query: cheap });
  const page = await openPage(browser, host, { query: `${cheap}&world=here` });
  const stranger = await openPage(browser, host, { query: `${cheap}&world=gone` }); // it takes 8 s to know
  const card = findCard(page);
  await waitForCard(page, 'The world is full');
  const full = /1 of 1 players are in\.\s+You come in when somebody leaves\. This page tries again/;
  assert.match(await card.innerText(), full);
  assert.deepEqual(await findPoorTexts(page.tab), []);
  assert.deepEqual(await findFaults(page), []);
  await first.leave();
  await waitForPlaying(page.tab);
  assert.equal(await card.isVisible(), false);

  const kick = async (...words) => {
    const [, client] = /^ *(\d+) mira/m.exec(await order('players'));
    await order(...words.map((word) => (word === '#' ? client : word)));
  };
  await kick('kick', '#', 'be', 'nice');
  await waitForCard(page, 'You were sent away');
  assert.match(await card.innerText(), /A moderator removed you: “be nice”\./);
  assert.doesNotMatch(await card.innerText(), /tries again/);
  await page.tab.getByRole('button', { name: 'Join again' }).click();
  await waitForPlaying(page.tab);
  await order('ban', '127.0.0.1');
  await waitForCard(page, 'You are banned here');

  await page.tab.getByRole('button', { name: 'Go to gone' }).waitFor();
  await page.leave();
  await server.stop();

  await waitForCard(stranger, 'The server does not answer');
  const words = await findCard(stranger).innerText();
  assert.match(words, /It may be off, or just about to start\.\s+This page tries again by itself\./);
  // The gateway is renewed meanwhile: who loads the page now gets another one.
  const text = (await (await fetch(`http://${host}/`)).text()).replace(/index-[\w-]+\.js/, 'index-newer.js');
  await gateway.stop();
  await stranger.tab.route('**/', (route) => route.fulfill({ body: text, contentType: 'text/html' }));
  await waitForCard(stranger, 'This page is out of date');
  await stranger.tab.getByRole('button', { name: 'Load the page again' }).waitFor();
  assert.equal(await stranger.tab.getByRole('button', { name: 'Join again' }).isVisible(), false);
  await stranger.leave();
});

test('a game waits for players, and a silent server is told', async () => {
  const world = await startWorld('sumo');
  const page = await joinPage(browser, world.host, { query: cheap });
  const waiting = page.tab.getByText('Waiting for players: a round needs two');
  await waiting.waitFor();
  const bots = startBots(world, 1);
  await waitFor('the line to go', async () => !(await waiting.isVisible()));

  world.server.process.kill('SIGSTOP');
  const line = page.tab.getByText(/^The server has been silent for [23] s$/);
  await line.waitFor();
  await waitFor('no ping', async () => (await page.tab.locator('.figures b').first().textContent()) === '–');
  world.server.process.kill('SIGCONT');
  await waitFor('the line to go', async () => !(await line.isVisible()));
  await waitFor('the ping', async () => / ms$/.test(await page.tab.locator('.figures b').first().textContent()));
  assert.deepEqual(page.complaints, []);

  await page.tab.goto(`http://${world.host}/?${cheap}&spectate`);
  await waitForPlaying(page.tab);
  for (const selector of ['.tools', '.stick', '.round', '.build', '.reticle']) {
    assert.equal(await isSeen(page, selector), false, `who watches sees ${selector}`);
  }
  await page.tab.keyboard.press('KeyH');
  const help = page.tab.getByRole('dialog', { name: 'Help' });
  await help.waitFor();
  assert.doesNotMatch(await help.innerText(), /jump|puff|tool/i);
  await page.tab.keyboard.press('Escape');
  const before = (await probe(page, 'state')).yaw;
  await page.tab.waitForTimeout(700);
  assert.equal((await probe(page, 'state')).yaw, before, 'the camera turns though less motion is asked for');
  assert.equal(await page.tab.locator('.card .ball').evaluate((ball) => getComputedStyle(ball).animationName), 'none');
  await page.tab.emulateMedia({ reducedMotion: 'no-preference' });
  await waitFor('the camera to circle', async () => (await probe(page, 'state')).yaw > before + 0.02);
  await page.leave();
  await bots.stop();
  await world.stop();
});

test('a phone shows all of it, large enough, and nothing on top of another', async () => {
  const world = await startWorld('arena');
  const bots = startBots(world, 5);
  const touch = { query: cheap, hasTouch: true, isMobile: true };
  const page = await joinPage(browser, world.host, { ...touch, viewport: phones.landscape });
  await waitFor('all players', async () => (await probe(page, 'state')).players.length === 6);
  const people = page.tab.getByRole('button', { name: /players and worlds$/ });
  const menu = page.tab.getByRole('button', { name: /menu$/ });
  for (const [name, screen] of Object.entries(phones)) {
    await page.tab.setViewportSize(screen);
    await waitFor('the layout', async () => (await page.tab.evaluate(() => innerWidth)) === screen.width);
    const boxes = await waitFor('all controls', async () => {
      const found = await findBoxes(page.tab, '.drawer-button, .stick, .round button, .tools, .middle, .hint');
      return found.length >= 7 && found;
    });
    for (const box of boxes) {
      const isIn = box.x >= 0 && box.y >= 0 && box.x + box.width <= screen.width && box.y + box.height <= screen.height;
      assert.ok(isIn, `${name}: ${JSON.stringify(box)} is outside`);
      for (const other of boxes) {
        assert.ok(other === box || !overlap(box, other), `${name}: ${box.name} and ${other.name} overlap`);
      }
    }
    for (const drawer of [people, menu]) {
      await drawer.tap();
      assert.equal(await drawer.getAttribute('aria-expanded'), 'true');
      const small = (await findBoxes(page.tab, 'button, select, summary, .name-field')).filter(
        ({ width, height }) => width < 44 || height < 44,
      );
      assert.deepEqual(small, [], `${name}: too small for a finger`);
      const roster = (await findBoxes(page.tab, '.people, .corner'))[0];
      assert.ok(roster.y >= 0 && roster.y + roster.height <= screen.height, `${name}: ${JSON.stringify(roster)}`);
      const isOnTop = await page.tab.evaluate(
        ([x, y]) => document.elementFromPoint(x, y)?.closest('.drawer') !== null,
        [roster.x + 12, roster.y + roster.height - 8],
      );
      assert.ok(isOnTop, `${name}: the stick covers what was opened`);
      assert.deepEqual(await findPoorTexts(page.tab), []);
      await drawer.tap();
    }
  }
  await menu.tap();
  await page.tab.getByRole('button', { name: /^Help/ }).tap();
  const help = page.tab.getByRole('dialog', { name: 'Help' });
  await help.getByRole('heading', { name: 'Touch' }).waitFor();
  assert.doesNotMatch(await help.innerText(), /Space|W A S D|wheel/);
  await page.tab.keyboard.press('Shift');
  await help.getByRole('heading', { name: 'Keyboard and mouse' }).waitFor();
  await waitFor('the stick to go', async () => !(await isSeen(page, '.stick')));
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await bots.stop();
  await world.stop();
});

test('by gamepad one moves, looks, jumps, builds and reads the help', async () => {
  const world = await startWorld('sandbox');
  const page = await joinPage(browser, world.host, { query: cheap, viewport: roomyScreen, onTab: addPad });
  const { ownBody } = await probe(page, 'state');
  const find = () => probe(page, 'position', ownBody);
  await waitFor('rest', async () => (await find()).z < 0.6);
  const begin = await find();
  await hold(page.tab, [0, 0.1, 0, 0]); // a stick that is worn
  await page.tab.waitForTimeout(300);
  assert.equal(await page.tab.evaluate(() => document.documentElement.dataset.device), 'desk');
  await hold(page.tab, [0, 0, 0, 0], 9);
  const help = page.tab.getByRole('dialog', { name: 'Help' });
  await help.getByRole('heading', { name: 'Gamepad' }).waitFor();
  await hold(page.tab, [0, -1, 0, 0]);
  await page.tab.waitForTimeout(500);
  const motion = (await find()).y - begin.y;
  assert.ok(motion < 0.4, `${motion} m while a dialog is open`); // it would be 2 m
  await hold(page.tab, [0, 0, 0, 0], 1);
  await waitFor('the help to go', async () => !(await help.isVisible()));
  const { yaw } = await probe(page, 'state');
  await hold(page.tab, [0, 0, 1, 0]);
  await waitFor('a look to the right, and back', async () => (await probe(page, 'state')).yaw < yaw - 2.5);
  await hold(page.tab, [0, 0, 0, 0]);
  assert.ok(await isSeen(page, '.reticle'));
  for (let i = 0; i < 3; ++i) await press(page.tab, 5); // the next tool
  const build = page.tab.getByRole('button', { name: /^Build/ });
  assert.equal(await build.getAttribute('aria-pressed'), 'true');
  const count = async () => (await probe(page, 'workshop')).particles.length;
  const before = await count();
  await press(page.tab, 7);
  await waitFor('a particle at the ring', async () => (await count()) === before + 1);
  await hold(page.tab, [0, -1, 0, 0]);
  await waitFor('the body to move', async () => (await find()).y < begin.y - 0.7);
  await waitFor('a jump', async () => {
    await press(page.tab, 0); // in the air it does nothing
    return (await find()).z > 0.9;
  });
  await hold(page.tab, [0, 0, 0, 0]);
  assert.deepEqual(page.complaints, []);
  await page.leave();
  await world.stop();
});

test('by the keyboard alone; labels, contrast, and settings that last', async () => {
  const world = await startWorld('sandbox');
  const page = await joinPage(browser, world.host, { query: 'name=mira', viewport: roomyScreen });
  assert.deepEqual(await findFaults(page), []);
  assert.deepEqual(await findPoorTexts(page.tab), []);
  await page.tab.evaluate(() => document.activeElement.blur());
  const names = await tabThrough(page.tab);
  assert.deepEqual(names.filter((name) => /OUTSIDE|UNSEEN/.test(name)), []);
  const all = [/^canvas/, /Invite friends/, /Your name/, /^button View/, /^button World/, /^button Help/, /^button Grab/];
  for (const wanted of all) {
    assert.ok(names.some((name) => wanted.test(name)), `${wanted} of ${names}`);
  }
  await page.tab.keyboard.press('KeyH');
  const help = page.tab.getByRole('dialog', { name: 'Help' });
  await help.getByRole('heading', { name: 'Keyboard and mouse' }).waitFor();
  assert.deepEqual(await findFaults(page), []);
  assert.deepEqual(await findPoorTexts(page.tab), []);
  assert.equal(await help.evaluate((dialog) => dialog.contains(document.activeElement)), true);
  await page.tab.keyboard.press('Escape');
  assert.equal(await help.isVisible(), false);

  await page.tab.keyboard.press('KeyG');
  await page.tab.keyboard.press('KeyV');
  await page.tab.getByRole('button', { name: 'Settings' }).press('Enter');
  await page.tab.getByLabel('drawing').selectOption('5');
  await page.tab.getByLabel('less motion').check();
  assert.deepEqual(await findFaults(page), []);
  assert.deepEqual(await findPoorTexts(page.tab), []);
  await page.tab.keyboard.press('Escape');
  assert.equal(await page.tab.evaluate(() => document.activeElement.id), 'world');
  assert.equal(await page.tab.getByLabel('drawing').isVisible(), false);
  await page.tab.reload();
  await waitForPlaying(page.tab);
  assert.equal((await probe(page, 'state')).quality, 5);
  await page.tab.emulateMedia({ reducedMotion: 'no-preference' });
  assert.equal(await page.tab.evaluate(() => document.documentElement.hasAttribute('data-calm')), true);
  assert.deepEqual(page.complaints, []);
  await page.leave();

  const poor = await openPage(browser, world.host, {
    query: 'quality=5',
    onTab: (tab) =>
      tab.addInitScript(() => {
        for (const name of ['localStorage', 'sessionStorage']) {
          Object.defineProperty(window, name, { get: () => { throw new DOMException('forbidden', 'SecurityError'); } });
        }
      }),
  });
  await waitForPlaying(poor.tab);
  assert.deepEqual(poor.complaints, []);
  await poor.leave();
  await world.stop();
});
