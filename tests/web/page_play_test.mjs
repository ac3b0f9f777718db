// The page as a player has it: a real browser against a real server and gateway. What is seen is read from the page's
// own state (window.wobble) and from its pixels; pictures are kept as the test's output.
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';
import * as runner from 'node:test';
import zlib from 'node:zlib';

import { PlayingPage, startBrowser } from './support/browser.mjs';
import { findDifference, readPicture } from './support/picture.mjs';
import { startGateway, startServer } from './support/programs.mjs';

const pageFolder = path.join(process.env.WOBBLE_BIN_DIR ?? 'build/release/bin', 'page');
const test = (name, run) => runner.test(name, { timeout: 200_000 }, run);

let browser;
runner.before(async () => (browser = await startBrowser()));
runner.after(async () => await browser?.close());

// `play` with the host of a gateway to a server with this scene.
async function withScene(scene, play) {
  const server = await startServer('--scene', scene);
  const gateway = await startGateway(server.address, pageFolder);
  try {
    await play(gateway.host);
  } finally {
    await gateway.program.stop();
    await server.program.stop();
  }
}

test('the files are few and small', () => {
  const files = fs.readdirSync(pageFolder, { recursive: true }).map((name) => path.join(pageFolder, name));
  const sizes = files
    .filter((name) => fs.statSync(name).isFile())
    .map((name) => {
      const bytes = fs.readFileSync(name);
      if (name.endsWith('.wasm')) assert.ok(bytes.length <= 150_000, `${name}: ${bytes.length} bytes`);
      return zlib.gzipSync(bytes).length;
    });
  assert.ok(sizes.length >= 4, pageFolder);
  const sum = sizes.reduce((a, b) => a + b, 0);
  assert.ok(sum <= 1_000_000, `${sum} bytes`);
});

test('a key moves the own body, in the page and on the screen', async () => {
  await withScene('arena', async (host) => {
    const page = await PlayingPage.open(browser, host, '?name=Ada');
    const own = (await page.read(() => window.wobble.state())).ownBody;
    await page.page.waitForTimeout(1500); // until it has come to lie
    const before = await page.read((body) => window.wobble.position(body), own);
    const picture = await page.takePicture('arena_before');
    await page.page.keyboard.down('KeyW');
    await page.waitFor(
      ([body, from]) => {
        const at = window.wobble.position(body);
        return Math.hypot(at.x - from.x, at.y - from.y) > 1;
      },
      [own, before],
    );
    await page.page.keyboard.up('KeyW');
    const later = await page.takePicture('arena_after');
    const difference = findDifference(readPicture(picture), readPicture(later));
    assert.ok(difference > 0.02, `${difference} of the picture`);
    const statistics = await page.read(() => window.wobble.statistics());
    assert.equal(statistics.badMessages, 0);
    assert.ok(statistics.ping > 0 && statistics.ping < 5, `${statistics.ping} s`);
    await page.close();
  });
});

test('two pages see the same cloth cut', async () => {
  await withScene('curtain', async (host) => {
    const cutter = await PlayingPage.open(browser, host, '?name=Ada');
    const watcher = await PlayingPage.open(browser, host, '?spectate');
    const curtain = await cutter.findBody('curtain');
    const faces = () => cutter.read((body) => window.wobble.faceCount(body), curtain);
    const before = await faces();
    await cutter.page.keyboard.press('Digit2');
    const from = await cutter.findPlace({ x: -1.6, y: 0, z: 2.2 });
    const to = await cutter.findPlace({ x: -1.4, y: 0, z: 0.5 });
    await cutter.drag(from, to);
    await cutter.waitFor(([body, whole]) => window.wobble.faceCount(body) < whole - 5, [curtain, before]);
    // The scene's own ball may still be tearing it: they agree once it hangs still.
    for (let i = 0; i < 30; ++i) {
      await cutter.page.waitForTimeout(500);
      const seen = await watcher.read((body) => window.wobble.faceCount(body), curtain);
      if (seen === (await faces()) && seen < before - 5) break;
      assert.ok(i < 29, `${seen} faces here, ${await faces()} there, ${before} before`);
    }
    await cutter.takePicture('curtain');
    await cutter.close();
    await watcher.close();
  });
});

test('what one builds the other sees', async () => {
  await withScene('sandbox', async (host) => {
    const builder = await PlayingPage.open(browser, host, '?name=Ada');
    const watcher = await PlayingPage.open(browser, host, '?spectate');
    const before = (await watcher.read(() => window.wobble.workshop())).particles.length;
    await builder.page.keyboard.press('Digit4');
    // On the ground at the side, where nothing hangs and no panel lies.
    const place = await builder.findPlace({ x: -3, y: -1.5, z: 0 });
    await builder.page.mouse.click(place.x, place.y);
    await watcher.waitFor((count) => window.wobble.workshop().particles.length > count, before);
    await builder.takePicture('sandbox');
    await builder.close();
    await watcher.close();
  });
});

test('forces come for the own body, and the score of a game', async () => {
  await withScene('sumo', async (host) => {
    const page = await PlayingPage.open(browser, host, '?name=Ada');
    assert.ok(await page.page.locator('.board').isVisible());
    await page.page.keyboard.press('KeyV');
    await page.page.getByRole('button', { name: 'Show forces as arrows' }).click();
    await page.waitFor(() => window.wobble.forces().kinds.includes('Weight'));
    const own = (await page.read(() => window.wobble.state())).ownBody;
    assert.equal((await page.read(() => window.wobble.forces())).body, own);
    await page.takePicture('sumo');
    await page.close();
  });
});
