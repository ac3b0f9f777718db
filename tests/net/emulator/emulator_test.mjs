// The emulated line is what it says, and the page plays over it. Skipped where the system permits no namespaces.
import assert from 'node:assert';
import { spawn } from 'node:child_process';
import { test } from 'node:test';

const { WOBBLE_EMULATOR: emulator, WOBBLE_BIN_DIR: bin, WOBBLE_NPM_DIR: npm } = process.env;
const folder = new URL('.', import.meta.url).pathname;
const notPermitted = 77;
const untilHealthy = (address) => `until ${bin}/wobble health ${address}; do sleep 0.1; done`;

// The last line of the client's output as JSON; null: not permitted here.
async function emulate(line, server, client) {
  const child = spawn(emulator, [line, '--limit', '40', '--server', server, '--client', client]);
  const text = { out: '', err: '' };
  child.stdout.on('data', (bytes) => (text.out += bytes));
  child.stderr.on('data', (bytes) => (text.err += bytes));
  const code = await new Promise((resolve) => child.on('close', resolve));
  if (code === notPermitted) {
    console.log(text.err.trim());
    return null;
  }
  assert.equal(code, 0, text.err + text.out);
  return JSON.parse(text.out.trim().split('\n').at(-1));
}

test('a line has the delay and the loss that it is asked for', async (context) => {
  const probe = `node ${folder}udp_probe.mjs`;
  const seen = await emulate('delay=30ms,loss=10%', `${probe} echo 4000`, `${probe} ask 10.77.0.1 4000 1000`);
  if (seen === null) return context.skip('no network namespaces here');
  assert.ok(seen.p50_ms >= 60 && seen.p50_ms < 66, `${seen.p50_ms} ms`);
  // Both ways: 19 %; 0.14 to 0.24 is four standard deviations.
  assert.ok(seen.lost > 0.14 && seen.lost < 0.24, `${seen.lost}`);
});

test('the page is at a short delay soon after its join', async (context) => {
  const seen = await emulate(
    'delay=20ms',
    `${bin}/wobbled --port 4000 --ops 9100 --scene arena --log-level warn & ${untilHealthy('9100')}; ` +
      `${bin}/wobble gateway --http 8080 --server 127.0.0.1:4000 & wait`,
    `${untilHealthy('10.77.0.1:8080')}; node ${folder}page_player.mjs ${npm}/package 10.77.0.1:8080 8`,
  );
  if (seen === null) return context.skip('no network namespaces here');
  console.log(JSON.stringify(seen));
  assert.ok(seen.low_delay_after_ms !== null && seen.low_delay_after_ms <= 2000, 'a delay of 120 ms within 2 s');
  assert.equal(seen.connections_lost, 0);
});
