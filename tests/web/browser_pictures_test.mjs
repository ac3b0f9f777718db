// Pictures of the page during play, stored in build/*/tests/web for people to look at. This test only checks that the
// pictures are not empty and that there are no complaints.
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';
import { after, before } from 'node:test';

import { joinPage, outputFolder, probe, startBots, startBrowser, startWorld } from './support/browser.mjs';
import { test, waitFor } from './support/programs.mjs';

const screen = { width: 1280, height: 720 };
const smallScreen = { width: 320, height: 180 }; // small, because the browser renders in software
const botCount = 4;
const playFor = 2500; // ms
const settleFor = 700;

let browser;
before(async () => {
  browser = await startBrowser();
  fs.mkdirSync(outputFolder, { recursive: true });
});
after(() => browser?.close());

for (const scene of ['arena', 'sumo', 'curtain', 'sandbox']) {
  test(`a picture of ${scene}`, async () => {
    const world = await startWorld(scene);
    // The first player to join gets the place with the best view.
    const page = await joinPage(browser, world.host, { viewport: smallScreen, query: 'name=mira&quality=3' });
    const bots = startBots(world, botCount);
    await waitFor('all players', async () => (await probe(page, 'state')).players.length === botCount + 1);
    await page.tab.waitForTimeout(playFor);
    await page.tab.setViewportSize(screen);
    await page.tab.waitForTimeout(settleFor);
    const picture = await page.tab.screenshot({ path: path.join(outputFolder, `${scene}.png`) });
    // A picture of one colour would have a few kilobytes.
    assert.ok(picture.length > 100_000, `${picture.length} bytes`);
    assert.deepEqual(page.complaints, []);
    await page.leave();
    await bots.stop();
    await world.stop();
  });
}
