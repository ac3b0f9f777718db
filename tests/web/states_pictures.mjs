// Pictures of every state of the page at three sizes, for people to look at: build/*/tests/web/states/STATE_SIZE.png.
// Not a test: by `make nightly`, or by hand, `node tests/web/states_pictures.mjs [PATTERN]`. It fails when a state is not
// reached or the page complains.
import assert from 'node:assert';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

import { openPage, outputFolder, pageFolder, probe, startBots, startBrowser, startWorld, waitForPlaying }
  from './support/browser.mjs';
import { addPad, hold } from './support/pad.mjs';
import { Program, sleep, startGateway, startServerOn, waitFor } from './support/programs.mjs';

const screens = { desk: [1280, 720], landscape: [844, 390], portrait: [390, 844] };
const root = new URL('../../', import.meta.url).pathname;
const pattern = new RegExp(process.argv[2] ?? '.');
const folder = path.join(outputFolder, 'states');
fs.mkdirSync(folder, { recursive: true });
const temporary = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-states-'));
const browser = await startBrowser();
let count = 0;

// A tab on a desk and one of a phone, each brought into the state, and their pictures.
async function show(state, host, { query = 'name=mira', onTab, reach = async () => {}, only } = {}) {
  if (!pattern.test(state)) return;
  for (const kind of only ?? ['desk', 'phone']) {
    const options = kind === 'desk' ? {} : { hasTouch: true, isMobile: true };
    // Small until the picture is taken: the browser renders in software.
    const viewport = kind === 'desk' ? { width: 900, height: 506 } : { width: 844, height: 390 };
    const page = await openPage(browser, host, { query: `${query}&quality=5`, onTab, viewport, ...options });
    page.isPhone = kind === 'phone';
    await reach(page, kind);
    for (const [size, [width, height]] of Object.entries(screens)) {
      if ((size === 'desk') !== (kind === 'desk')) continue;
      await page.tab.setViewportSize({ width, height });
      await page.tab.waitForTimeout(900);
      await page.tab.screenshot({ path: path.join(folder, `${state}_${size}.png`) });
      ++count;
    }
    assert.deepEqual(page.complaints.filter((line) => !/WebSocket connection|ERR_/.test(line)), [], state);
    await page.leave();
  }
}

const waitForTitle = (title) => (page) => page.tab.getByRole('heading', { name: title }).waitFor();
const play = async (page) => {
  await waitForPlaying(page.tab);
  await page.tab.waitForTimeout(1500); // until what falls has fallen
};
// As the device does it: help and buttons follow what was pressed last.
const press = async (page, name) => {
  const button = page.tab.getByRole('button', { name }).first();
  await (page.isPhone ? button.tap() : button.click());
};
// What short screens fold is opened first.
const openMenu = async (page, kind) => kind === 'phone' && (await press(page, /menu$/));

async function showCards() {
  const socket = path.join(temporary, 'admin.sock');
  const options = ['--scene', 'pair', '--untrained', '--max-clients', '1', '--admin-socket', socket];
  const { program: server, address } = await startServerOn(0, ...options);
  const gone = '127.0.0.1:9';
  const { program: gateway, host } = await startGateway(`arena=${address}`, pageFolder, '--server', `sumo=${gone}`,
    '--server', `sandbox=${gone}`);
  const order = async (...words) => {
    const admin = new Program('wobble', ['admin', '--socket', socket, ...words]);
    assert.equal(await admin.end, 0, admin.errors.join('\n'));
    return admin.lines.join('\n');
  };
  const kick = async (page, kind, ...words) => {
    await waitForPlaying(page.tab);
    const [, client] = /^ *(\d+) mira/m.exec(await order('players'));
    await order('kick', client, 'be', 'nice', 'to', 'the', 'small', 'ones');
    await waitForTitle('You were sent away')(page);
  };
  await show('no_such_world', host, { query: 'name=mira&world=moon', reach: waitForTitle('No such world') });
  await show('not_answering', host, { query: 'name=mira&world=sumo', reach: waitForTitle('does not answer') });
  await show('sent_away', host, { reach: kick });
  const outdated = async (page) => {
    await page.tab.route('**/', async (route) => {
      const response = await route.fetch();
      await route.fulfill({ response, body: (await response.text()).replace(/index-[\w-]+\.js/, 'index-newer.js') });
    });
    await press(page, 'Go to sumo').catch(() => {});
    await waitForTitle('out of date')(page);
  };
  await show('out_of_date', host, { query: 'name=mira&world=moon', reach: outdated });
  const bots = startBots({ address }, 1, 'idle.lua');
  await waitFor('a bot', async () => /bot/.test(await order('players')));
  await show('full', host, { reach: waitForTitle('full') });
  await bots.stop();
  await order('ban', '127.0.0.1');
  await show('banned', host, { reach: waitForTitle('banned') });
  await order('unban', '127.0.0.1');
  server.process.kill('SIGSTOP');
  await show('joining', host, { reach: waitForTitle('Joining') });
  server.process.kill('SIGCONT');
  await gateway.stop();
  await server.stop();

  const file = path.join(temporary, 'password');
  fs.writeFileSync(file, 'tulip\n', { mode: 0o600 });
  const closed = await startWorld('pair', ['--untrained', '--password-file', file]);
  await show('password', closed.host, { reach: (page) => page.tab.getByLabel('Password').waitFor() });
  await show('password_wrong', closed.host, {
    reach: async (page) => {
      await page.tab.getByLabel('Password').fill('rose');
      await page.tab.getByLabel('Password').press('Enter');
      await page.tab.getByText('does not hold').waitFor();
    },
  });
  await closed.stop();
}

async function showPlay() {
  const arena = await startWorld('arena');
  const { address } = arena;
  const sumo = await startServerOn(0, '--scene', 'sumo', '--untrained');
  const sandbox = await startServerOn(0, '--scene', 'sandbox', '--untrained');
  const curtain = await startServerOn(0, '--scene', 'curtain', '--untrained');
  const { program: gateway, host } = await startGateway(`arena=${address}`, pageFolder, '--server',
    `sumo=${sumo.address}`, '--server', `curtain=${curtain.address}`, '--server', `sandbox=${sandbox.address}`);
  await show('alone', host, { reach: async (page) => {
    await play(page);
    await page.tab.getByText('You are alone here').waitFor();
  } });
  await show('nobody_plays', host, { query: 'name=mira&spectate', reach: async (page) => {
    await play(page);
    await page.tab.getByText('Nobody plays here yet').waitFor();
  } });
  await show('sumo_start', host, { query: 'name=mira&world=sumo', reach: async (page) => {
    await play(page);
    await page.tab.getByText('Waiting for players').waitFor();
  } });
  const bots = [startBots(arena, 5), startBots(sumo, 5, 'chase.lua')];
  await show('play', host, { reach: play });
  await show('spectating', host, { query: 'name=mira&spectate', reach: play });
  await show('sumo_play', host, { query: 'name=mira&world=sumo', reach: async (page) => {
    await play(page);
    await page.tab.waitForTimeout(4000);
  } });
  for (const [tool, scene] of [['grab', 'arena'], ['push', 'arena'], ['cut', 'curtain'], ['build', 'sandbox']]) {
    await show(`tool_${tool}`, host, { query: `name=mira&world=${scene}`, reach: async (page) => {
      await play(page);
      await press(page, new RegExp(`^${tool}`, 'i'));
    } });
  }
  await show('people', host, { query: 'name=mira', only: ['phone'], reach: async (page) => {
    await play(page);
    await press(page, /players and worlds$/);
  } });
  await show('menu', host, { query: 'name=mira', only: ['phone'], reach: async (page, kind) => {
    await play(page);
    await openMenu(page, kind);
  } });
  for (const [panel, name] of [['settings', 'Settings'], ['view', /^View/], ['world', /^World/]]) {
    await show(panel, host, { query: 'name=mira&world=sandbox', reach: async (page, kind) => {
      await play(page);
      await openMenu(page, kind);
      await press(page, name);
      if (panel === 'view') await press(page, 'Show forces as arrows');
    } });
  }
  await show('help', host, { reach: async (page, kind) => {
    await play(page);
    await openMenu(page, kind);
    await press(page, /^Help/);
  } });
  await show('help_pad', host, { only: ['desk'], onTab: addPad, reach: async (page) => {
    await play(page);
    await hold(page.tab, [0, 0, 0, 0], 9);
    await page.tab.getByRole('heading', { name: 'Gamepad' }).waitFor();
    await hold(page.tab, [0, 0, 0, 0]);
  } });
  await show('pad', host, { only: ['desk'], onTab: addPad, reach: async (page) => {
    await play(page);
    await hold(page.tab, [0.3, -1, 0, 0]);
    await page.tab.waitForTimeout(300);
    await hold(page.tab, [0, 0, 0, 0]);
  } });
  await show('invite', host, { reach: async (page, kind) => {
    await play(page);
    if (kind === 'phone') await press(page, /players and worlds$/);
    await press(page, 'Invite friends');
  } });
  await show('silent', host, { reach: async (page) => {
    await play(page);
    arena.server.process.kill('SIGSTOP');
    setTimeout(() => arena.server.process.kill('SIGCONT'), 6500);
    await page.tab.getByText(/silent for/).waitFor();
  } });
  await sleep(pattern.test('silent') ? 4000 : 0);
  for (const each of bots) await each.stop();
  await gateway.stop();
  await Promise.all([arena.stop(), sumo.program.stop(), sandbox.program.stop(), curtain.program.stop()]);
}

// A round of ten seconds.
async function showEnd() {
  if (!pattern.test('sumo_end')) return;
  const scene = path.join(temporary, 'short.toml');
  const sumo = fs.readFileSync(path.join(root, 'server/scenes/sumo.toml'), 'utf8');
  fs.writeFileSync(scene, sumo.replace('round = 120', 'round = 10'));
  const world = await startWorld(scene);
  const bots = startBots(world, 3, 'chase.lua');
  await show('sumo_end', world.host, { reach: async (page) => {
    await waitForPlaying(page.tab);
    await page.tab.locator('.banner:visible').waitFor();
  } });
  await bots.stop();
  await world.stop();
}

try {
  await showCards();
  await showPlay();
  await showEnd();
  console.log(`${count} pictures in ${folder}`);
} finally {
  await browser.close();
  fs.rmSync(temporary, { recursive: true, force: true });
}
