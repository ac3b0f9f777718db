// Slow and many connections to --ops. Two that sent a kilobyte a second once kept /healthz from everybody.
import assert from 'node:assert';

import { startServer, test, waitFor } from '../web/support/programs.mjs';
import { askHealth, countDescriptors, giveUp, measurePatience, SlowCrowd, visit } from './slow_crowd.mjs';

const openings = ['GET /metrics HTTP/1.1\r\nX: ', '', 'GET /metr'];
const deadlineMs = 2000;

test('who is slow, and who opens many, keeps nobody from --ops', async (context) => {
  const { program } = await startServer('--scene', 'pair', '--ops', '127.0.0.1:0');
  const port = Number(/port (\d+)/.exec(await program.waitForLine(/^metrics and health on TCP port \d+/))[1]);
  await waitFor('health', async () => (await visit(port, '/healthz')).status === 200);
  const before = countDescriptors(program);

  const patience = measurePatience(port, '127.0.0.3', 'GET /metrics HTTP/1.1\r\nX: ');
  const one = new SlowCrowd(port, ['127.0.0.2'], openings);
  context.after(() => one.end());
  await one.openAtOnce(40);
  one.openOften(57);
  const health = await askHealth(port, 100);
  const held = countDescriptors(program) - before;
  const patient = await Promise.race([patience, giveUp(deadlineMs)]);
  console.log(`one address: p99 ${health.p99.toFixed(1)} ms of ${health.asked}, ${health.failed} failed; ` +
    `${held} descriptors for ${one.opened} connections; a drip is put out after ${patient} ms`);
  one.end();

  // Each has less than an address may have.
  const many = new SlowCrowd(port, Array.from({ length: 60 }, (_, i) => `127.0.1.${i + 1}`), openings);
  context.after(() => many.end());
  await many.openAtOnce(60);
  many.openOften(57);
  const among = await askHealth(port, 20);
  const metrics = await visit(port, '/metrics');
  console.log(`60 addresses: p99 ${among.p99.toFixed(1)} ms of ${among.asked}, ${among.failed} failed`);
  many.end();

  assert.equal(health.asked, 100);
  assert.equal(health.failed + among.failed, 0);
  assert.ok(health.p99 < 100 && among.p99 < 100);
  assert.ok(held <= 8 + 1 + 1, `${held} descriptors`); // of 127.0.0.2, of 127.0.0.3, an answer's
  assert.ok(patient > 0.8 * deadlineMs && patient < 1.25 * deadlineMs, `${patient} ms`);
  assert.match(metrics.body.toString(), /^wobble_clients_limit 64$/m);
  await waitFor('closed descriptors', () => countDescriptors(program) <= before);
  assert.equal(await program.stop(), 0);
});
