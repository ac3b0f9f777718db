// What the page looks like while people play, as pictures in build/*/tests/web. A person looks at them; asked here is
// only that there is something to be seen, and that nothing complained.
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';
import { after, before } from 'node:test';

import { joinPage, outputFolder, probe, startBots, startBrowser, startWorld } from './support/browser.mjs';
import { test, waitFor } from './support/programs.mjs';

const screen = { width: 1280, height: 720 };
const smallScreen = { width: 320, height: 180 }; // while they play, since the processor draws
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
    // The first to come is put where one sees most.
    const page = await joinPage(browser, world.host, { viewport: smallScreen, query: 'name=mira&quality=3' });
    const bots = startBots(world, botCount);
    await waitFor('all players', async () => (await probe(page, 'state')).players.length === botCount + 1);
    await page.tab.waitForTimeout(playFor);
    await page.tab.setViewportSize(screen);
    await page.tab.waitForTimeout(settleFor);
    const picture = await page.tab.screenshot({ path: path.join(outputFolder, `${scene}.png`) });
    // Of one colour it would be a few kilobytes.
    assert.ok(picture.length > 100_000, `${picture.length} bytes`);
    assert.deepEqual(page.complaints, []);
    await page.leave();
    await bots.stop();
    await world.stop();
  });
}
