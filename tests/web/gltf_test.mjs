// Recordings as glTF, judged by Khronos' validator.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';

import { Program, test } from './support/programs.mjs';

const root = new URL('../../', import.meta.url).pathname;
const { validateBytes } = createRequire(path.join(root, 'client/page/'))('gltf-validator');

let folder;
before(() => (folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-gltf-'))));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

// As people call it: { report, file }.
async function exportAndJudge(scene, ...options) {
  const file = path.join(folder, `${scene}.glb`);
  const recording = path.join(root, 'tests/determinism/recordings', `${scene}.wobrec`);
  const program = new Program('wobble', ['export', recording, '--format', 'gltf', '--output', file, ...options]);
  assert.equal(await program.end, 0, program.errors.join('\n'));
  const report = await validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 50 });
  return { report, file };
}

// Balls; a cloth that is cut; springs without faces; a body that is built; a plane body; bodies at rest.
for (const scene of ['arena', 'curtain', 'pair', 'sandbox', 'drop2d', 'solids']) {
  test(`the validator finds nothing wrong with ${scene}`, async () => {
    const { report } = await exportAndJudge(scene);
    assert.deepEqual(report.issues.messages.filter(({ severity }) => severity <= 2), []);
    assert.ok(report.info.animationCount === 1 && report.info.drawCallCount > 0, JSON.stringify(report.info));
  });
}

test('a single frame of one body has no animation', async () => {
  const { report } = await exportAndJudge('arena', '--force', '--to', '0.001', '--bodies', '1');
  assert.deepEqual(report.issues.messages.filter(({ severity }) => severity <= 2), []);
  assert.equal(report.info.animationCount, 0);
});
