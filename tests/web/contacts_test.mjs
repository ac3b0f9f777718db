// Where the page hears a contact, by motions that are known: client/page/source/sound/contacts.ts alone, without a
// browser. Bodies are shown 60 times a second, or less often, at places rounded as the codec rounds them.
import assert from 'node:assert';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import { test } from 'node:test';

const root = new URL('../../', import.meta.url);
const typescript = createRequire(new URL('client/page/package.json', root))('typescript');
const source = fs.readFileSync(new URL('client/page/source/sound/contacts.ts', root), 'utf8');
const { outputText } = typescript.transpileModule(source, { compilerOptions: { module: 'ESNext', target: 'ES2022' } });
const { ContactFinder } = await import(`data:text/javascript,${encodeURIComponent(outputText)}`);

const kGravity = -9.81;
const round = (metres) => Math.round(metres * 512) / 512;

// What is heard of the bodies that move(t) returns, until `seconds`. A body: [x, y, z] and what differs from a ball.
function listen(move, { seconds = 3, hz = 60, finder = new ContactFinder(), gravity = kGravity } = {}) {
  const heard = [];
  for (let frame = 0; frame <= seconds * hz; ++frame) {
    const time = frame / hz;
    const bodies = move(time).map(([x, y, z, more = {}], i) => ({
      body: i + 1, x: round(x), y: round(y), z: round(z), size: 1, isPlayer: false, isHeld: false, ...more,
    }));
    for (const thud of finder.Update(bodies, time, gravity)) heard.push({ time, ...thud });
  }
  return heard;
}

// Falls from `height` above its ground at 0, and is in contact for `contact` seconds at each bounce, which gives back
// `share` of its speed: computed in small steps, with a push that grows and falls as a half sine.
function makeBounces(height, contact, share, seconds = 3) {
  const step = 0.001;
  const places = [];
  let [z, speed, left, from] = [height, 0, 0, 0];
  for (let time = 0; time <= seconds + step; time += step) {
    places.push(z);
    if (left <= 0 && z <= 0 && speed < -0.15) [left, from] = [contact, speed];
    const peak = (Math.PI / 2) * (((1 + share) * -from) / contact - kGravity);
    const push = left > 0 ? peak * Math.sin((Math.PI * (contact - left)) / contact) : 0;
    if (left <= 0 && z <= 0 && speed >= -0.15 && speed <= 0) speed = 0;
    else speed += (kGravity + push) * step;
    z += speed * step;
    left -= step;
  }
  return (time) => places[Math.round(time / step)];
}

test('a bounce is one thud, at its time and with its speed, soft or hard, at any frame rate', () => {
  for (const contact of [0.02, 0.08, 0.16]) {
    for (const hz of [20, 30, 60, 144]) {
      const z = makeBounces(1.5, contact, 0.7, 1.2); // lands after 0.55 s, and again after another 0.8
      const heard = listen((time) => [[0, 0, z(time)]], { seconds: 1.2, hz });
      const name = `contact of ${contact} s at ${hz} Hz: ${JSON.stringify(heard)}`;
      assert.equal(heard.length, 1, name);
      assert.ok(heard[0].time > 0.55 && heard[0].time < 0.75, name);
      assert.ok(Math.abs(heard[0].speed - 5.4) < 1.6, name);
    }
  }
});

test('a body that stays where it lands is one thud, and many bounces are as many, each softer', () => {
  const z = makeBounces(2, 0.05, 0, 3);
  assert.equal(listen((time) => [[0, 0, z(time)]]).length, 1);
  const bounces = makeBounces(2, 0.06, 0.6, 3);
  const speeds = listen((time) => [[0, 0, bounces(time)]]).map(({ speed }) => speed);
  assert.ok(speeds.length >= 3 && speeds.length <= 6, `${speeds}`);
  assert.ok(speeds.every((speed, i) => i === 0 || speed < speeds[i - 1] + 0.2), `${speeds}`);
});

test('rest, fall, rolling, walking, a jump and a heap that breathes are silent', () => {
  const wave = (time, height, hz) => height * Math.sin(2 * Math.PI * hz * time);
  const cases = {
    rest: () => [[1, 2, 0.5]],
    fall: (time) => [[0, 0, 60 - (9.81 / 2) * time ** 2]],
    roll: (time) => [[3 * time, 0, 0.5 + wave(time, 0.004, 2)]],
    'a jump off the ground': (time) => [[0, 0, time < 1 ? 0 : 6 * (time - 1) - (9.81 / 2) * (time - 1) ** 2]],
    heap: (time) => Array.from({ length: 30 }, (_, i) => [i % 3, i % 2, i / 6 + wave(time + i / 7, 0.006, 3)]),
    'a hand that drags it': (time) => [[2 * Math.sin(3 * time), 0, 1 + Math.sin(2 * time)]],
  };
  for (const [name, move] of Object.entries(cases)) {
    const seconds = name === 'a jump off the ground' ? 2 : 3;
    assert.deepEqual(listen(move, { seconds }), [], name);
  }
  // Walking to and fro at 6 m/s; each turn takes 25 m/s² for half a second.
  const turning = (time) => {
    const phase = time % 1;
    const side = Math.floor(time) % 2 === 0 ? 1 : -1;
    return phase < 0.48 ? side * (-6 * phase + 12.5 * phase ** 2) : side * 6 * (phase - 0.48);
  };
  const player = (time) => [[turning(time), 0, 0.5, { isPlayer: true }]];
  assert.deepEqual(listen(player, { seconds: 0.99 }), [], 'walking');
});

test('a wall is heard, by players as well, and who is struck at rest is silent', () => {
  const speed = 6;
  const wall = (time) => (time < 1 ? speed * time : speed - 0.6 * speed * (time - 1));
  for (const isPlayer of [false, true]) {
    const heard = listen((time) => [[wall(time), 0, 0.5, { isPlayer }]], { seconds: 2 });
    assert.equal(heard.length, 1, `${isPlayer}`);
    assert.ok(Math.abs(heard[0].speed - speed) < 0.5);
  }
  const pair = (time) => [
    [time < 1 ? 4 * time : 4 + 0.4 * (time - 1), 0, 0.5],
    [time < 1 ? 6 : 6 + 3.6 * (time - 1), 0, 0.5],
  ];
  assert.deepEqual(listen(pair, { seconds: 2 }).map(({ body }) => body), [1]);
});

test('what is put elsewhere, missing for a while, or new is silent', () => {
  const finder = new ContactFinder();
  assert.deepEqual(listen((time) => [[time < 1 ? 0 : 30, 0, time < 1 ? 5 : 1]], { seconds: 2, finder }), []);
  const stalled = (time) => [[4 * (time < 1 ? time : time < 1.3 ? 1 : time), 0, 1, { isHeld: time >= 1 && time < 1.3 }]];
  assert.deepEqual(listen(stalled, { seconds: 2 }), []);
  assert.deepEqual(listen((time) => (time < 1 ? [] : [[0, 0, 3 - 4 * (time - 1)]]), { seconds: 1.5 }), []);
  // A respawn that moves it by less than a fast body may go.
  const near = new ContactFinder();
  const before = listen((time) => [[3 * time, 0, 1]], { seconds: 1, finder: near });
  near.Forget(1);
  const behind = listen((time) => [[3 - 2 * time, 0, 1]], { seconds: 1, finder: near });
  assert.deepEqual([...before, ...behind], []);
});

test('a thousand bodies take less than 2 ms a frame', () => {
  const finder = new ContactFinder();
  const bodies = Array.from({ length: 1000 }, (_, i) => ({
    body: i, x: i, y: 0, z: 1, size: 1, isPlayer: false, isHeld: false,
  }));
  // The least of many: other tests run beside this one.
  let each = Infinity;
  for (let frame = 0; frame < 100; ++frame) {
    const begin = performance.now();
    finder.Update(bodies, frame / 60, kGravity);
    each = Math.min(each, performance.now() - begin);
  }
  console.log(`${each.toFixed(3)} ms a frame`);
  assert.ok(each < 2, `${each} ms`);
});
