// A real Chromium on the built page, with a real server and gateway of its own.
//
// Rendering is in software, so that a machine without a graphics card gives the same pictures. Tests compare
// screenshots with each other, never with a stored picture.
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';
import { createRequire } from 'node:module';

import { Program, startGateway, startRelay, startServerOn, waitFor } from './programs.mjs';

const root = new URL('../../../', import.meta.url);
const { chromium } = createRequire(new URL('client/page/package.json', root))('playwright-core');

const binFolder = process.env.WOBBLE_BIN_DIR ?? path.resolve('build/release/bin');
export const pageFolder = path.join(binFolder, 'page');
// Folder for files that people may want to look at.
export const outputFolder = process.env.WOBBLE_OUTPUT ?? path.resolve('build/release/tests/web');
const smallScreen = { width: 640, height: 400 }; // people and menu are folded
export const roomyScreen = { width: 800, height: 500 }; // nothing is

export const startBrowser = () =>
  chromium.launch({
    executablePath: process.env.WOBBLE_CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--no-sandbox', // only our own page is opened, and containers have no sandbox
      '--use-gl=angle',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--disable-quic',
      '--no-first-run',
      '--host-resolver-rules=MAP play.example.org 127.0.0.1',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });

// Starts a server with this scene and a gateway to it: { address, server, host, stop }. Untrained by default, since
// shapes seldom matter here and training takes a second. link: conditions of a relay between them; empty: none.
export async function startWorld(scene, options = ['--untrained'], link = '') {
  const { program: server, address } = await startServerOn(0, '--scene', scene, ...options);
  const relay = link === '' ? null : await startRelay(address, link);
  const { program, host } = await startGateway(relay?.address ?? address, pageFolder);
  const world = { address, server, host };
  world.stop = () => Promise.all([program.stop(), relay?.program.stop(), world.server.stop()]);
  return world;
}

// A shipped scene in the folder, with other numbers where the fields first stand. Returns the file.
export function varyScene(folder, scene, fields) {
  const scenes = path.join(binFolder, 'scenes');
  let text = fs.readFileSync(path.join(scenes, `${scene}.toml`), 'utf8').replaceAll('meshes/', `${scenes}/meshes/`);
  for (const [field, value] of Object.entries(fields)) {
    assert.match(text, new RegExp(`^${field} = `, 'm'));
    text = text.replace(new RegExp(`^${field} = .*$`, 'm'), `${field} = ${value}`);
  }
  const file = path.join(folder, `${scene}.toml`);
  fs.writeFileSync(file, text);
  return file;
}

// Starts another untrained server at the address of an ended one.
export async function startServerAt(address, scene) {
  const [, port] = address.split(':');
  return (await startServerOn(port, '--scene', scene, '--untrained')).program;
}

export function startBots(world, count, script = 'wander.lua') {
  return new Program('wobble', ['bots', world.address, '--script', script, '--count', `${count}`]);
}

// Opens the page in a tab without stored state: { tab, complaints, requests, failures, leave }. The lists hold its
// console messages, requests and network errors. onTab: called with the tab before the first request. query: sets a
// fixed quality, because the picture would otherwise change by itself. wait: before each frame, ms; to render all that
// software can takes a core. options: of the tab.
export async function openPage(
  browser,
  host,
  { query = 'name=mira&quality=5', onTab = () => {}, scheme = 'http', wait = 150, ...options } = {},
) {
  const context = await browser.newContext({ viewport: smallScreen, reducedMotion: 'reduce', ...options });
  await context.addInitScript((wait) => {
    const request = window.requestAnimationFrame.bind(window);
    if (wait > 0) window.requestAnimationFrame = (run) => setTimeout(request, wait, run);
  }, wait);
  const tab = await context.newPage();
  const page = { tab, complaints: [], requests: [], failures: [], leave: () => context.close() };
  tab.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
  });
  tab.on('pageerror', (error) => page.complaints.push(error.stack ?? error.message));
  tab.on('request', (request) => page.requests.push(request.url()));
  tab.on('requestfailed', (request) => page.failures.push(`${request.url()} ${request.failure()?.errorText}`));
  tab.on('response', (response) => {
    if (response.status() >= 400) page.failures.push(`${response.url()} ${response.status()}`);
  });
  tab.on('websocket', (socket) => page.requests.push(socket.url()));
  await onTab(tab);
  await tab.goto(`${scheme}://${host}/?${query}`);
  return page;
}

// Opens the page and waits until it plays and its own body, if it has one, is there.
export async function joinPage(browser, host, options) {
  const page = await openPage(browser, host, options);
  await waitForPlaying(page.tab);
  return page;
}

export async function waitForPlaying(tab) {
  await waitFor('a world in the page', () =>
    tab.evaluate(() => {
      const { connection, ownBody, bodies } = window.wobble?.state() ?? {};
      return connection === 'Playing' && bodies > 0 && (ownBody === 0 || window.wobble.position(ownBody) !== null);
    }),
  );
}

// Calls window.wobble's function of this name.
export const probe = (page, name, ...values) =>
  page.tab.evaluate(([name, values]) => window.wobble[name](...values), [name, values]);

export async function findBody(page, name) {
  const body = (await probe(page, 'bodies')).find((each) => each.name === name);
  assert.ok(body, `no body ${name}`);
  return body;
}

export async function findOwn(page) {
  const { ownBody } = await probe(page, 'state');
  return { body: ownBody, at: await probe(page, 'position', ownBody) };
}

// Share of the pixels that differ clearly between two screenshots of the same size. One tab of a browser compares all of
// them: to open one takes half a second.
const comparers = new WeakMap();
export async function compareScreenshots(browser, before, after) {
  if (!comparers.has(browser)) comparers.set(browser, browser.newPage());
  const tab = await comparers.get(browser);
  return await tab.evaluate(
    async (pictures) => {
      const [a, b] = await Promise.all(
        pictures.map(async (picture) => {
          const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${picture}`)).blob());
          const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
          context.drawImage(bitmap, 0, 0);
          return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
        }),
      );
      let count = 0;
      for (let i = 0; i < a.length; i += 4) {
        const away = Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]);
        if (away > 60) ++count;
      }
      return count / (a.length / 4);
    },
    [before, after].map((picture) => picture.toString('base64')),
  );
}
