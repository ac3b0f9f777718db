// A real Chromium without a screen, and pages in it that play. Pictures are kept where WOBBLE_PICTURES says.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';

const require = createRequire(new URL('../../../client/web/page/package.json', import.meta.url));
const { chromium } = require('playwright-core');

const patienceMs = 60_000; // two pages drawn by two cores take their time
const pictures = process.env.WOBBLE_PICTURES ?? path.join(os.tmpdir(), 'wobble-pictures');

export async function startBrowser() {
  return await chromium.launch({
    executablePath: process.env.WOBBLE_CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--no-sandbox',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--ignore-gpu-blocklist',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
}

// A page that plays. Whatever it complains about is an error of the test that closes it.
export class PlayingPage {
  static async open(browser, host, query = '') {
    const page = new PlayingPage();
    page.complaints = [];
    page.context = await browser.newContext({ viewport: { width: 960, height: 540 } });
    page.page = await page.context.newPage();
    page.page.on('console', (line) => line.type() === 'error' && page.complaints.push(line.text()));
    page.page.on('pageerror', (error) => page.complaints.push(error.stack));
    page.page.on('request', (request) => {
      const { protocol, host: asked } = new URL(request.url());
      if (protocol !== 'data:' && asked !== host) page.complaints.push(`fetched ${request.url()}`);
    });
    await page.page.goto(`http://${host}/${query}`);
    await page.waitFor(() => {
      const state = window.wobble?.state();
      return state?.connection === 'Playing' && state.bodies > 0;
    });
    return page;
  }

  // What `find` returns inside of the page, once it is true there.
  async waitFor(find, argument) {
    const handle = await this.page.waitForFunction(find, argument, { timeout: patienceMs, polling: 100 });
    return await handle.jsonValue();
  }

  async read(find, argument) {
    return await this.page.evaluate(find, argument);
  }

  // The number of the first body of this blueprint.
  async findBody(name) {
    return await this.waitFor((wanted) => window.wobble.bodies().find((body) => body.name === wanted)?.body, name);
  }

  // Where a point of the world is, pixels.
  async findPlace(point) {
    return await this.read((wanted) => window.wobble.place(wanted), point);
  }

  // In steps, as a hand does it.
  async drag(from, to) {
    const { mouse } = this.page;
    await mouse.move(from.x, from.y);
    await mouse.down();
    for (let i = 1; i <= 10; ++i) {
      await mouse.move(from.x + ((to.x - from.x) * i) / 10, from.y + ((to.y - from.y) * i) / 10);
      await this.page.waitForTimeout(80);
    }
    await mouse.up();
  }

  async takePicture(name) {
    fs.mkdirSync(pictures, { recursive: true });
    return await this.page.screenshot({ path: path.join(pictures, `${name}.png`), timeout: patienceMs });
  }

  async close() {
    await this.context.close();
    assert.deepEqual(this.complaints, []);
  }
}
