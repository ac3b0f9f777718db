// Slow and many connections to the gateway. 57 a second once took all that it had, so that its page was refused.
import assert from 'node:assert';
import crypto from 'node:crypto';

import { channels, join, Player, subprotocol } from '../web/support/player.mjs';
import { makePage, removePage, startGateway, startServer, test, waitFor } from '../web/support/programs.mjs';
import { askHealth, countDescriptors, giveUp, measurePatience, SlowCrowd, visit } from './slow_crowd.mjs';

const script = crypto.randomBytes(300_000);
const play = 'GET /play HTTP/1.1\r\nHost: a\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n' +
  `Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Protocol: ${subprotocol}\r\n\r\n`;
const openings = ['GET / HTTP/1.1\r\nX: ', '', 'GET /play HTTP/1.1\r\nX: '];
const deadlineMs = 4000;
const helloMs = 5000;

test('who is slow, and who opens many, keeps nobody from the page and from playing', async (context) => {
  const page = makePage({ 'index.html': '<!doctype html><title>wobble</title>', 'assets/main-1a2B_c-d.js': script });
  context.after(() => removePage(page));
  const server = await startServer('--scene', 'pair', '--status', '0.2', '--max-clients', '100');
  const gateway = await startGateway(server.address, page);
  const port = Number(gateway.host.split(':')[1]);
  await visit(port, '/healthz');
  const before = countDescriptors(gateway.program);

  const slow = measurePatience(port, '127.0.0.3', 'GET / HTTP/1.1\r\nX: ');
  const mute = new Player(gateway.host, { localAddress: '127.0.0.4' });
  const begin = Date.now();
  const muteMs = mute.closed.then(() => Date.now() - begin);

  const one = new SlowCrowd(port, ['127.0.0.2'], openings);
  const mutes = new SlowCrowd(port, ['127.0.0.2'], [play]);
  // Each has less than an address may have, and all together more than there is room for.
  const others = new SlowCrowd(port, Array.from({ length: 60 }, (_, i) => `127.0.1.${i + 1}`), openings);
  const crowds = [one, mutes, others];
  context.after(() => crowds.forEach((crowd) => crowd.end()));
  await one.openAtOnce(600);
  one.openOften(57);
  mutes.openOften(57);

  const health = await askHealth(port, 100);
  const loaded = [await visit(port, '/'), await visit(port, '/assets/main-1a2B_c-d.js')];
  const joinBegin = Date.now();
  const player = new Player(gateway.host, { localAddress: '127.0.0.1' });
  const opened = await player.opened;
  if (opened === true) {
    player.sayHello('mira');
    await waitFor('snapshots', () => player.count(channels.snapshot) > 10 || Date.now() > joinBegin + 2000);
  }
  const joinMs = Date.now() - joinBegin;
  const held = countDescriptors(gateway.program) - before;
  console.log(`p99 ${health.p99.toFixed(1)} ms of ${health.asked}, ${health.failed} failed; page ` +
    `${loaded.map((answer) => `${answer.status} in ${answer.ms.toFixed(0)} ms`).join(', ')}; joining ${opened}, ` +
    `${player.count(channels.snapshot)} snapshots after ${joinMs} ms; ${held} descriptors for ` +
    `${one.opened + mutes.opened} connections`);

  assert.equal(health.asked, 100);
  assert.equal(health.failed, 0);
  assert.ok(health.p99 < 100);
  assert.deepEqual(loaded.map((answer) => answer.status), [200, 200]);
  assert.ok(loaded.every((answer) => answer.ms < 500));
  assert.equal(Buffer.compare(loaded[1].body, script), 0);
  assert.ok(player.count(channels.snapshot) > 10 && joinMs < 1500);

  const times = await Promise.all([slow, muteMs].map((time) => Promise.race([time, giveUp(3000)])));
  console.log(`put out: a dripping request after ${times[0]} ms, a mute WebSocket after ${times[1]} ms`);
  assert.ok(times[0] > 0.8 * deadlineMs && times[0] < 1.25 * deadlineMs);
  assert.ok(times[1] < 1.25 * helloMs);

  await others.openAtOnce(600);
  others.openOften(57);
  const among = await askHealth(port, 100, 2);
  console.log(`60 more addresses: p99 ${among.p99.toFixed(1)} ms of ${among.asked}, ${among.failed} failed`);
  assert.equal(among.asked, 100);
  assert.equal(among.failed, 0);
  assert.ok(among.p99 < 100);
  assert.equal(player.socket.readyState, 1, 'the honest one plays on');

  crowds.forEach((crowd) => crowd.end());
  await player.leave();
  await waitFor('closed descriptors', () => countDescriptors(gateway.program) <= before);
  assert.equal(await gateway.program.stop(), 0);
});
