// Parts of the page that need no browser: what the camera sees, what the page says of an end, and what it keeps.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { before, test } from 'node:test';

const root = new URL('../../', import.meta.url).pathname;
const { buildSync } = createRequire(path.join(root, 'client/page/package.json'))('esbuild');

// The page's modules as one; of wobble-client the plain objects and enums alone.
let page;
before(async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-units-'));
  const outfile = path.join(folder, 'page.mjs');
  const modules = ['scene/camera', 'scene/sight', 'scene/veil', 'stay', 'settings', 'hud/company', 'hud/link_line', 'input/held'];
  buildSync({
    stdin: {
      contents: modules.map((name) => `export * from './source/${name}';`).join('\n'),
      resolveDir: path.join(root, 'client/page'),
    },
    alias: { 'wobble-client': path.join(root, 'client/npm/source/views.ts') },
    bundle: true,
    format: 'esm',
    outfile,
    logLevel: 'error',
  });
  page = await import(outfile);
  fs.rmSync(folder, { recursive: true });
});

// Seeded, and so the same in each run (Steele and Vigna 2014, splitmix32).
function makeRandom(seed) {
  return () => {
    seed = (seed + 0x9e3779b9) | 0;
    let t = seed ^ (seed >>> 16);
    t = Math.imul(t, 0x21f0aaad);
    t ^= t >>> 15;
    t = Math.imul(t, 0x735a2d97);
    return ((t ^ (t >>> 15)) >>> 0) / 2 ** 32;
  };
}

const plane = { kind: 0, a: { x: 0, y: 0, z: 1 }, b: { x: 0, y: 0, z: 0 }, radius: 0 };
const crowd = { middle: { x: 0, y: 0, z: 1 }, spread: 8, largest: 0.5 };

function makeObstacle(random) {
  const within = (least, most) => least + (most - least) * random();
  const a = { x: within(-5, 5), y: within(-5, 5), z: within(0, 3) };
  const kind = 1 + Math.floor(3 * random());
  const b =
    kind === 1
      ? { x: within(0.2, 2), y: within(0.2, 2), z: within(0.2, 3) }
      : { x: a.x + within(-2, 2), y: a.y + within(-2, 2), z: a.z + within(0, 3) };
  return { kind, a, b, radius: within(0.2, 1.5) };
}

// Whether the point is in the obstacle: by its definition, not by the page's distances.
function contains({ kind, a, b, radius }, p) {
  if (kind === 0) return p.z < 0;
  const [x, y, z] = [p.x - a.x, p.y - a.y, p.z - a.z];
  if (kind === 1) return Math.abs(x) < b.x && Math.abs(y) < b.y && Math.abs(z) < b.z;
  if (kind === 2) return x * x + y * y + z * z < radius * radius;
  for (let share = 0; share <= 1; share += 0.01) {
    const away = [x - share * (b.x - a.x), y - share * (b.y - a.y), z - share * (b.z - a.z)];
    if (Math.hypot(...away) < radius) return true;
  }
  return false;
}

test('no solid comes between the camera and the followed body, and it keeps a distance', () => {
  const random = makeRandom(27);
  let near = 0;
  let scenes = 0;
  while (scenes < 80) {
    const obstacles = [plane, ...Array.from({ length: 4 }, () => makeObstacle(random))];
    const solids = { obstacles, grounds: [] };
    const own = { x: 0, y: 0, z: 0.5, size: 0.5 };
    // A body is beside solids, not in them.
    if (page.FindDistance(solids, { ...own, z: 0.95 }) < 0.5 || page.FindDistance(solids, own) < 0.45) continue;
    ++scenes;
    const camera = new page.OrbitCamera();
    camera.isCalm = true;
    camera.solids = solids;
    for (let frame = 0; frame < 240; ++frame) {
      camera.Turn(0.02, 0); // all around in four seconds
      camera.Update(1 / 60, own, crowd);
      const eye = camera.FindEye();
      const { focus } = camera;
      assert.ok(camera.distance <= 5.6 + 1e-9, `${camera.distance} m`);
      if (camera.distance < 1.2) ++near;
      for (let step = frame % 3; step < 60; step += 3) {
        const share = step / 60;
        const mix = (name) => focus[name] + share * (eye[name] - focus[name]);
        const point = { x: mix('x'), y: mix('y'), z: mix('z') };
        const hidden = obstacles.find((obstacle) => contains(obstacle, point));
        assert.equal(hidden, undefined, `scene ${scenes}, frame ${frame}: ${JSON.stringify({ hidden, point })}`);
      }
    }
  }
  const share = near / (240 * scenes);
  console.log(`nearer than 1.2 m in ${(100 * share).toFixed(2)} % of the frames`);
  assert.ok(share < 0.02, `${share}`);
});

test('without solids the camera stays where it was asked to be', () => {
  const camera = new page.OrbitCamera();
  camera.isCalm = true;
  for (let frame = 0; frame < 120; ++frame) camera.Update(1 / 60, { x: 3, y: 4, z: 0.5, size: 0.5 }, crowd);
  const { x, y, z } = camera.FindEye();
  assert.ok(Math.abs(Math.hypot(x - 3, y - 4, z - 0.95) - 5.6) < 1e-3);
  assert.ok(Math.abs(camera.FindEye().x - 3) < 1e-3 && y < 4, 'behind the body, which looks along y');
});

test('no body fills the screen, however near one zooms', () => {
  for (const size of [0.2, 0.5, 1, 3, 8]) {
    for (const mode of [page.CameraMode.Follow, page.CameraMode.Orbit]) {
      const camera = new page.OrbitCamera();
      camera.Zoom(1e-3);
      camera.Reset(mode);
      const own = mode === page.CameraMode.Follow ? { x: 0, y: 0, z: size, size } : null;
      for (let frame = 0; frame < 60; ++frame) {
        camera.Update(1 / 60, own, { middle: { x: 0, y: 0, z: size }, spread: 3, largest: size });
      }
      // A skin's size is its radius. The lens has 55 degrees.
      const degrees = (2 * Math.asin(Math.min(1, size / camera.distance)) * 180) / Math.PI;
      assert.ok(degrees < 40, `${mode}, size ${size}: ${degrees} degrees`);
    }
  }
});

// A client with balls, as far as the veil needs it. Each is a sphere of 16 by 8 faces.
function makeBalls(balls) {
  const columns = 16;
  const rows = 8;
  const points = [];
  for (let row = 0; row <= rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const [tilt, turn] = [(Math.PI * row) / rows, (2 * Math.PI * column) / columns];
      points.push([Math.sin(tilt) * Math.cos(turn), Math.sin(tilt) * Math.sin(turn), Math.cos(tilt)]);
    }
  }
  const faces = [];
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const next = (column + 1) % columns;
      const at = (r, c) => r * columns + c;
      faces.push(at(row, column), at(row, next), at(row + 1, column));
      faces.push(at(row, next), at(row + 1, next), at(row + 1, column));
    }
  }
  const floats = [];
  const bodies = balls.map(({ x, y, z, radius }, i) => {
    const vertices = floats.length;
    for (const point of points) floats.push(x + radius * point[0], y + radius * point[1], z + radius * point[2]);
    return { body: i + 1, blueprint: i, vertices, vertexCount: points.length, x, y, z };
  });
  return {
    bodies,
    bodyCount: bodies.length,
    readFloats: () => Float32Array.from(floats),
    findBlueprint: (number) => ({ faces: Uint16Array.from(faces), size: balls[number].radius }),
  };
}

test('what hides the own body is see-through, and nothing else is', () => {
  const eye = { x: 0, y: -6, z: 2 };
  const own = { x: 0, y: 0, z: 0.5, radius: 0.5 };
  const hide = (ball) => {
    const client = makeBalls([own, ball]);
    return page.FindHiding(client, eye, client.bodies[0]).length > 0;
  };
  assert.equal(hide({ x: 0, y: -3, z: 1.2, radius: 1 }), true, 'between');
  assert.equal(hide({ x: 0, y: -5.5, z: 1.9, radius: 1.5 }), true, 'around the eye');
  assert.equal(hide({ x: 3, y: -3, z: 1.2, radius: 1 }), false, 'beside');
  assert.equal(hide({ x: 0, y: 3, z: 0.5, radius: 1 }), false, 'behind');
  assert.equal(hide({ x: 0, y: 1.02, z: 0.5, radius: 1 }), false, 'close behind');
  assert.equal(hide({ x: 0, y: -9, z: 3, radius: 1 }), false, 'at the back of the eye');
  assert.equal(hide({ x: 0.6, y: -0.6, z: 0.3, radius: 0.3 }), false, 'a small one at the rim');
  const client = makeBalls([{ x: 0, y: -6, z: 2, radius: 1 }, { x: 0, y: 3, z: 1, radius: 1 }]);
  assert.deepEqual(page.FindHiding(client, eye, null), [1], 'who watches nobody sees out of a ball');
});

test('every goodbye of the server has a card of its own', () => {
  const text = fs.readFileSync(path.join(root, 'protocol/messages.cpp'), 'utf8');
  const body = /const char\* Name\(wire::GoodbyeReason reason\) \{(.*?)\n\}/s.exec(text)[1];
  const reasons = [...body.matchAll(/case wire::GoodbyeReason::(\w+):\s+return "([^"]*)"/g)];
  assert.equal(reasons.length, 14);
  for (const [, name, reason] of reasons) {
    if (name === 'Left') continue; // what the player does himself
    assert.notEqual(page.FindStayOf(reason), page.Stay.Refused, name);
  }
  const locked = /kLockedDetail = "([^"]*)"/.exec(fs.readFileSync(path.join(root, 'protocol/messages.h'), 'utf8'))[1];
  assert.equal(page.FindStayOf(locked), page.Stay.Locked);
  assert.equal(page.FindStayOf('server silent for 8 s'), page.Stay.Silent);
  assert.equal(page.FindStayOf('all places are taken'), page.Stay.Full);
  // What the transport tells of its own.
  const transport = fs.readFileSync(path.join(root, 'protocol/transport/enet_transport.cpp'), 'utf8');
  for (const [, reason] of transport.matchAll(/return "(\w+ [^"]*)";/g)) {
    assert.notEqual(page.FindStayOf(reason), page.Stay.Refused, reason);
  }
  assert.equal(page.FindDetail('removed by a moderator: be nice: really'), 'be nice: really');
  assert.equal(page.FindDetail('removed by a moderator'), '');
});

test('the state of the stay follows from the connection', () => {
  const { FindStay, Stay } = page;
  const out = { isPlaying: false, isEntering: false, hasPlayed: true, lostReason: '', refused: null };
  assert.equal(FindStay(out, '', false), Stay.Connecting);
  assert.equal(FindStay({ ...out, isEntering: true }, '', false), Stay.Entering);
  assert.equal(FindStay({ ...out, isPlaying: true }, '', false), Stay.Playing);
  assert.equal(FindStay({ ...out, isPlaying: true }, 'moon', false), Stay.NoSuchWorld);
  assert.equal(FindStay({ ...out, lostReason: 'any', refused: 'password' }, '', false), Stay.Password);
  assert.equal(FindStay({ ...out, lostReason: 'the connection was lost' }, '', false), Stay.Lost);
  assert.equal(FindStay({ ...out, lostReason: 'the connection was lost' }, '', true), Stay.OtherVersion);
  assert.equal(FindStay({ ...out, hasPlayed: false, lostReason: 'server silent for 8 s' }, '', false), Stay.NotAnswering);
  assert.equal(FindStay({ ...out, lostReason: 'banned from this server' }, '', true), Stay.Banned);
  assert.equal(FindStay({ ...out, lostReason: 'something new' }, '', false), Stay.Refused);
});

test('what is kept and not understood has its default', () => {
  const defaults = page.TakeSettings(null);
  assert.deepEqual(defaults, { quality: null, camera: 'follow', zoom: 1, isCalm: false });
  for (const text of ['', '{', '[]', 'null', '7', '"x"', '{"quality":9,"camera":"sideways","zoom":0,"isCalm":"yes"}',
    '{"quality":-1,"zoom":1e9}', '{"quality":1.5,"zoom":"2"}']) {
    assert.deepEqual(page.TakeSettings(text), defaults, text);
  }
  const kept = { quality: 3, camera: 'orbit', zoom: 2, isCalm: true };
  assert.deepEqual(page.TakeSettings(JSON.stringify({ ...kept, more: 1 })), kept);
});

test('a game waits for a second player; who is alone, or watches nobody, is told', () => {
  const { Company, FindCompany } = page;
  assert.equal(FindCompany('sumo', 1, true), Company.GameWaits);
  assert.equal(FindCompany('sumo', 1, false), Company.GameWaits);
  assert.equal(FindCompany('sumo', 2, true), Company.Enough);
  assert.equal(FindCompany('', 1, true), Company.Alone);
  assert.equal(FindCompany('', 1, false), Company.Enough);
  assert.equal(FindCompany('', 0, false), Company.NobodyPlays);
  assert.equal(FindCompany('film', 0, false), Company.Enough);
});

test('silence is told after 1.5 s, and before overload', () => {
  const { Link, FindLink } = page;
  assert.equal(FindLink(1.5, 1), Link.Good);
  assert.equal(FindLink(1.51, 1), Link.Silent);
  assert.equal(FindLink(1.51, 0.5), Link.Silent);
  assert.equal(FindLink(0.1, 0.5), Link.Overloaded);
});

test('a tap that is shorter than a frame counts for one frame', () => {
  const held = new page.Held();
  held.Press('Space');
  held.Release('Space');
  assert.ok(held.Has('Space'));
  held.EndFrame();
  assert.ok(!held.Has('Space'));
  held.Press('KeyW');
  held.EndFrame();
  assert.ok(held.Has('KeyW'), 'it is still held');
  held.Release('KeyW');
  assert.ok(!held.Has('KeyW'));
});
