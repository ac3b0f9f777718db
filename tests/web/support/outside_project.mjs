// A JavaScript project outside this repository, which knows of wobble nothing but the packed wobble-client.
import assert from 'node:assert';
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const root = new URL('../../../', import.meta.url).pathname;
const npmFolder = process.env.WOBBLE_NPM_DIR ?? path.resolve('build/release/npm');
export const pageModules = path.join(root, 'client/page/node_modules');
export const version = /project\(wobble VERSION ([\d.]+)/.exec(fs.readFileSync(path.join(root, 'CMakeLists.txt')))[1];
export const tarball = path.join(npmFolder, `wobble-client-${version}.tgz`);

// In a folder of its own, with the package installed by npm, without a network and without what npm has kept.
export async function makeProject() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-outside-'));
  const project = {
    folder,
    installed: path.join(folder, 'node_modules/wobble-client'),
    write: (name, text) => fs.writeFileSync(path.join(folder, name), text),
    // Others' packages come from the page's: they stand for what a project has from the registry.
    link: (name) => fs.symlinkSync(path.join(pageModules, name), path.join(folder, 'node_modules', name)),
    run: (program, ...words) => run(folder, program, words),
    remove: () => fs.rmSync(folder, { recursive: true, force: true }),
  };
  project.write('package.json', JSON.stringify({ name: 'outside', private: true, type: 'module' }));
  const cache = ['--cache', path.join(folder, '.npm')];
  const install = await project.run('npm', 'install', '--offline', '--no-audit', '--no-fund', ...cache, tarball);
  assert.equal(install.code, 0, install.errors);
  return project;
}

// Runs a program to its end: { code, lines, errors }.
async function run(folder, program, words) {
  const child = spawn(program, words, { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
  let output = '';
  let errors = '';
  child.stdout.on('data', (bytes) => (output += bytes));
  child.stderr.on('data', (bytes) => (errors += bytes));
  const code = await new Promise((resolve) => child.on('close', resolve));
  return { code, lines: output.split('\n').slice(0, -1), errors };
}
