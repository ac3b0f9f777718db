// Lanes: the further WebSockets of a player, over which snapshots and inputs go.
import assert from 'node:assert';
import { after, before } from 'node:test';

import { channels, join, Player, subprotocol } from './support/player.mjs';
import { makePage, removePage, sleep, startGateway, startServer, test, waitFor } from './support/programs.mjs';

let page;
let server;
let gateway;

before(async () => {
  page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' });
  server = await startServer('--scene', 'arena');
  gateway = await startGateway(server.address, page);
});
after(async () => {
  await gateway?.program.stop();
  await server?.program.stop();
  removePage(page);
});

const open = (key) => new Player(gateway.host, { protocols: [subprotocol, `more.${key}`] });
const findSnapshots = (player) => player.messages.filter((bytes) => bytes[0] === channels.snapshot);

// A player, the key of its lanes, and so many of them.
async function joinWithLanes(count) {
  const player = await join(gateway.host);
  const message = await waitFor('a key', () => player.messages.find((bytes) => bytes[0] === channels.lane));
  assert.equal(message.length, 17);
  const key = message.subarray(1).toString('base64url');
  const lanes = Array.from({ length: count }, () => open(key));
  for (const lane of lanes) assert.equal(await lane.opened, true);
  return { player, key, lanes };
}

test('snapshots come over all of them, all else over the first', async () => {
  const { player, lanes } = await joinWithLanes(3);
  for (const each of [player, ...lanes]) {
    const before = each.count(channels.snapshot);
    await waitFor('snapshots', () => each.count(channels.snapshot) > before + 5);
  }
  for (const lane of lanes) assert.equal(lane.count(channels.snapshot), lane.messages.length);
  const sequences = [player, ...lanes].flatMap((each) => findSnapshots(each).map((bytes) => bytes.readUInt32LE(3)));
  assert.equal(new Set(sequences).size, sequences.length, 'each snapshot comes once');
  await player.leave();
  for (const lane of lanes) await lane.closed;
});

test('one that ends takes nothing with it', async () => {
  const { player, key, lanes } = await joinWithLanes(3);
  await lanes[1].leave();
  for (const each of [player, lanes[0], lanes[2]]) {
    const before = each.count(channels.snapshot);
    await waitFor('snapshots', () => each.count(channels.snapshot) > before + 5);
  }
  const another = open(key);
  assert.equal(await another.opened, true);
  await player.leave();
  await another.closed;
});

test('a player has three', async () => {
  const { player, key } = await joinWithLanes(3);
  assert.equal(await open(key).opened, 404);
  await player.leave();
});

test('a key that nobody has, or had, opens none', async () => {
  assert.equal(await open('AAAAAAAAAAAAAAAAAAAAAA').opened, 404);
  assert.equal(await new Player(gateway.host, { protocols: [`more.AAAA`] }).opened, 400);
  const { player, key } = await joinWithLanes(0);
  await player.leave();
  await sleep(100);
  assert.equal(await open(key).opened, 404);
});

test('the key is good at the address of the player alone', async () => {
  const { player, key } = await joinWithLanes(0);
  const other = new Player(gateway.host, { protocols: [subprotocol, `more.${key}`], localAddress: '127.0.0.5' });
  assert.equal(await other.opened, 404);
  await player.leave();
});

test('what does not belong there ends the player with a reason', async () => {
  const offences = [
    ['a message that is not understood', (lane) => lane.send(channels.control, Buffer.alloc(10))],
    ['a message that is not understood', (lane) => lane.send(channels.ping, Buffer.alloc(4))],
    ['a message that is not understood', (lane) => lane.socket.send(Buffer.alloc(0))],
    ['too many messages', (lane) => {
      for (let i = 0; i < 1200; ++i) lane.socket.ping();
    }],
  ];
  for (const [reason, offend] of offences) {
    const { player, lanes } = await joinWithLanes(1);
    offend(lanes[0]);
    assert.deepEqual(await player.closed, { code: 1008, reason });
    await lanes[0].closed;
  }
});
