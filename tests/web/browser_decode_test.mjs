// WebAssembly against native code: the page's client and a native one decode the same messages and must produce the
// same bits.
import assert from 'node:assert';
import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { after, before } from 'node:test';

import { joinPage, probe, startBots, startBrowser, startWorld } from './support/browser.mjs';
import { sleep, test, waitFor } from './support/programs.mjs';

const replayProgram = process.env.WOBBLE_REPLAY ?? path.resolve('build/release/tests/replay');
const recordsEnough = 1000;

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser?.close());

// The bases of shapes are trained here, as in play: they are the part most sensitive to differences of arithmetic.
for (const [scene, options] of [['arena', []], ['curtain', undefined]]) {
  test(`what the page decodes of ${scene} is what a native client decodes`, async () => {
    const world = await startWorld(scene, options);
    const bots = startBots(world, 3);
    const { messages, begin, records, hash } = await record(world.host);
    await bots.stop();
    await world.stop();

    const native = replay(messages, begin);
    assert.equal(findHash(native, records), hash, `after ${records} records`);
    const decoded = native.filter(
      ({ hash, records: sofar }, i) => sofar > begin && sofar <= records && hash !== native[i - 1]?.hash,
    );
    assert.ok(decoded.length > 20);
    // One message in two hundred has something else than poses in its middle.
    const spoiled = Array.from({ length: 10 }, (_, i) => decoded[Math.floor((0.05 + 0.1 * i) * decoded.length)].place);
    const unnoticed = spoiled.filter((place) => findHash(replay(spoil(messages, place), begin), records) === hash);
    assert.ok(unnoticed.length <= 2, `the middles of messages ${unnoticed} are others, the hash is not`);
  });
}

// Plays until enough records have arrived. Returns all messages received, and the hash of what was decoded from the
// records behind the first `begin` up to `records`. Before, blueprints come, and what the page skips meanwhile depends on
// how fast it completes them.
async function record(host) {
  const messages = [];
  const onTab = (tab) =>
    tab.on('websocket', (socket) => socket.on('framereceived', ({ payload }) => messages.push(Buffer.from(payload))));
  const page = await joinPage(browser, host, { onTab });
  await page.tab.keyboard.down('KeyW');
  await sleep(2000); // a slow page may take a while to receive all blueprints
  const begin = await waitFor('all blueprints', () =>
    page.tab.evaluate(() => window.wobble.restartDecodedHash() && window.wobble.statistics().records),
  );
  const found = await waitFor('enough records', async () => {
    const { records, hash } = await page.tab.evaluate(() => ({
      records: window.wobble.statistics().records,
      hash: window.wobble.decodedHash(),
    }));
    return records - begin >= recordsEnough && { records, hash };
  });
  assert.equal((await probe(page, 'statistics')).badMessages, 0);
  await page.leave();
  return { messages, begin, ...found };
}

// For each message that contained records: its position, the number of records so far, and the hash of those behind the
// first `begin`.
function replay(messages, begin) {
  const input = Buffer.concat(
    messages.flatMap((message) => {
      const head = Buffer.alloc(4);
      head.writeUInt32LE(message.length);
      return [head, message];
    }),
  );
  const result = spawnSync(replayProgram, ['--from', `${begin}`], { input, maxBuffer: 1 << 28 });
  assert.equal(result.status, 0, String(result.stderr));
  const lines = result.stdout.toString().trim().split('\n');
  return lines
    .map((line) => line.split(' '))
    .map(([place, records, hash]) => ({ place: Number(place), records: Number(records), hash }));
}

function findHash(replayed, records) {
  return replayed.find((message) => message.records === records)?.hash;
}

// A copy in which every byte of that message's middle third is changed: single ones may belong to what is no part of a
// pose.
function spoil(messages, place) {
  const changed = Buffer.from(messages[place]);
  for (let i = Math.floor(changed.length / 3); i < (2 * changed.length) / 3; ++i) changed[i] ^= 1;
  return messages.with(place, changed);
}
