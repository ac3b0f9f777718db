// Blueprints that the browser keeps from one visit to the next. In a file of its own: another tab that draws would make
// each load of the page slow.
import assert from 'node:assert';

import { joinPage, startBrowser, startWorld, waitForPlaying } from './support/browser.mjs';
import { channels } from './support/player.mjs';
import { test } from './support/programs.mjs';

test('a second visit downloads no blueprint, and one with a damaged storage downloads them again', async (context) => {
  const browser = await startBrowser();
  context.after(() => browser.close());
  const trained = await startWorld('arena', []);
  const received = { control: 0 }; // bytes since the last visit
  const onTab = (tab) =>
    tab.on('websocket', (socket) =>
      socket.on('framereceived', ({ payload }) => {
        if (payload[0] === channels.control) received.control += payload.length;
      }),
    );
  const visitor = await joinPage(browser, trained.host, { onTab });
  const visit = async () => {
    await waitForPlaying(visitor.tab);
    await visitor.tab.waitForTimeout(500); // for blueprints that come while it plays
    const bytes = received.control;
    received.control = 0;
    return bytes;
  };
  // Damages what is kept; says how many blueprints there are.
  const damage = () =>
    visitor.tab.evaluate(
      () =>
        new Promise((resolve) => {
          indexedDB.open('wobble').onsuccess = ({ target: { result: database } }) => {
            const store = database.transaction('blueprints', 'readwrite').objectStore('blueprints');
            store.getAll().onsuccess = ({ target: { result: entries } }) => {
              for (const entry of entries) store.put({ ...entry, bytes: entry.bytes.map((byte) => byte ^ 1) });
              store.transaction.oncomplete = () => resolve(entries.length);
            };
          };
        }),
    );
  const first = await visit();
  await visitor.tab.reload();
  const second = await visit();
  const count = await damage();
  await visitor.tab.reload();
  const third = await visit();
  console.log(`${count} blueprints kept; ${first} bytes of control at the first visit, ${second} at the second`);
  assert.ok(count > 0);
  assert.ok(first > 50_000 && second < 10_000, `${first}, ${second}`);
  assert.ok(third > 50_000, `${third}`);
  assert.deepEqual(visitor.complaints, []);
  await visitor.leave();
  await trained.stop();
});
