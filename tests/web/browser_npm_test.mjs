// The package's example with three.js as an outside project: bundled by vite, served by a gateway, played in a browser.
// Its picture is build/*/tests/web/npm_example.png.
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';

import { compareScreenshots, openPage, outputFolder, startBots, startBrowser } from './support/browser.mjs';
import { makeProject, pageModules } from './support/outside_project.mjs';
import { startGateway, startServer, test, waitFor } from './support/programs.mjs';

test('the example shows the world, and plays in it', async (context) => {
  const project = await makeProject();
  context.after(() => project.remove());
  project.link('three');
  for (const name of ['index.html', 'world.js']) {
    fs.copyFileSync(path.join(project.installed, 'examples', name), path.join(project.folder, name));
  }
  const vite = path.join(pageModules, 'vite/bin/vite.js');
  const [bundled, browser, server] = await Promise.all([
    project.run('node', vite, 'build', '--target', 'es2022', '--logLevel', 'warn'),
    startBrowser(),
    startServer('--scene', 'arena', '--status', '0.2'),
  ]);
  context.after(() => browser.close());
  assert.equal(bundled.code, 0, bundled.errors);
  const { program: gateway, host } = await startGateway(server.address, path.join(project.folder, 'dist'));
  const page = await openPage(browser, host, { query: '' });
  await waitFor('a player', () => server.countClients() === 1);
  const bots = startBots({ address: server.address }, 3);
  await waitFor('the bots', () => server.countClients() === 4);
  await page.tab.keyboard.down('KeyD');
  await page.tab.waitForTimeout(500);
  const before = await page.tab.screenshot();
  await page.tab.waitForTimeout(1000);
  const after = await page.tab.screenshot({ path: path.join(outputFolder, 'npm_example.png') });
  // A picture of one colour would have two kilobytes.
  assert.ok(after.length > 10_000, `${after.length} bytes`);
  const share = await compareScreenshots(browser, before, after);
  console.log(`${after.length} bytes, ${(100 * share).toFixed(1)} % of the pixels differ after a second`);
  assert.ok(share > 0.01, `${share}`);
  assert.deepEqual(page.complaints, []);
  assert.deepEqual(page.failures, []);
  await page.leave();
  await bots.stop();
  await gateway.stop();
  await server.program.stop();
});
