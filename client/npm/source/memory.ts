// Reads the structures that client/wasm/layout.h describes: four-byte fields at addresses in linear memory.
//
// Views of the memory are made for every read, because they become invalid when the memory grows.
import type { WobbleModule } from './wobble.mjs';
import type {
  Blueprint,
  Body,
  Download,
  Forces,
  Ground,
  Obstacle,
  ParticleTag,
  Scoreboard,
  SpringTag,
  Statistics,
  Tuning,
  Vector,
  Welcome,
  WorldEvent,
} from './views.js';

const kBodyWords = 14;
const kObstacleWords = 8;
const kGroundWords = 7;
const kParticleTagBytes = 12;
const kSpringTagBytes = 20;
const kScoreBytes = 8;
const kSeatBytes = 3;
const kForceFieldWords = 3;
const kDecoder = new TextDecoder();

export function readText(module: WobbleModule, address: number, length: number): string {
  return kDecoder.decode(module.HEAPU8.subarray(address, address + length));
}

// Reads a zero-terminated text.
export function readZeroText(module: WobbleModule, address: number): string {
  const end = module.HEAPU8.indexOf(0, address);
  return readText(module, address, end - address);
}

export function makeBody(): Body {
  return {
    body: 0,
    blueprint: 0,
    revision: 0,
    vertexCount: 0,
    vertices: 0,
    normals: 0,
    x: 0,
    y: 0,
    z: 0,
    rotationW: 1,
    rotationX: 0,
    rotationY: 0,
    rotationZ: 0,
    held: false,
  };
}

// Fills the first `count` of `bodies`, which grows as needed and is reused.
export function readBodies(module: WobbleModule, address: number, count: number, bodies: Body[]): void {
  while (bodies.length < count) bodies.push(makeBody());
  const words = module.HEAPU32;
  const floats = module.HEAPF32;
  for (let i = 0, at = address >> 2; i < count; ++i, at += kBodyWords) {
    const body = bodies[i];
    body.body = words[at];
    body.blueprint = words[at + 1];
    body.revision = words[at + 2];
    body.vertexCount = words[at + 3];
    body.vertices = words[at + 4] >> 2;
    body.normals = words[at + 5] >> 2;
    body.x = floats[at + 6];
    body.y = floats[at + 7];
    body.z = floats[at + 8];
    body.rotationW = floats[at + 9];
    body.rotationX = floats[at + 10];
    body.rotationY = floats[at + 11];
    body.rotationZ = floats[at + 12];
    body.held = words[at + 13] !== 0;
  }
}

export function readBlueprint(module: WobbleModule, address: number, number: number): Blueprint {
  const at = address >> 2;
  const words = module.HEAPU32;
  const [vertexCount, rest, faceCount, faces, edgeCount, edges] = words.subarray(at, at + 6);
  const [isOpen, name, nameLength, particles, springs] = words.subarray(at + 7, at + 12);
  return {
    number,
    name: readText(module, name, nameLength),
    size: module.HEAPF32[at + 6],
    isOpen: isOpen !== 0,
    rest: module.HEAPF32.slice(rest >> 2, (rest >> 2) + 3 * vertexCount),
    faces: module.HEAPU16.slice(faces >> 1, (faces >> 1) + 3 * faceCount),
    edges: module.HEAPU16.slice(edges >> 1, (edges >> 1) + 2 * edgeCount),
    particles: particles === 0 ? [] : readParticleTags(module, particles, vertexCount),
    springs: springs === 0 ? [] : readSpringTags(module, springs, edgeCount),
  };
}

// Reads a FlatBuffers structure, as do the functions below: fields are aligned to their size.
function readParticleTags(module: WobbleModule, address: number, count: number): ParticleTag[] {
  const tags: ParticleTag[] = [];
  for (let i = 0, at = address; i < count; ++i, at += kParticleTagBytes) {
    tags.push({
      mass: module.HEAPF32[at >> 2],
      owner: module.HEAPU32[(at + 4) >> 2],
      number: module.HEAPU16[(at + 8) >> 1],
      fixed: module.HEAPU8[at + 10] !== 0,
    });
  }
  return tags;
}

function readSpringTags(module: WobbleModule, address: number, count: number): SpringTag[] {
  const tags: SpringTag[] = [];
  for (let i = 0, at = address; i < count; ++i, at += kSpringTagBytes) {
    tags.push({
      stiffness: module.HEAPF32[at >> 2],
      damping: module.HEAPF32[(at + 4) >> 2],
      restLength: module.HEAPF32[(at + 8) >> 2],
      owner: module.HEAPU32[(at + 12) >> 2],
      number: module.HEAPU16[(at + 16) >> 1],
    });
  }
  return tags;
}

export function readVector(module: WobbleModule, address: number): Vector {
  const at = address >> 2;
  const floats = module.HEAPF32;
  return { x: floats[at], y: floats[at + 1], z: floats[at + 2] };
}

export function readWelcome(module: WobbleModule, address: number): Welcome {
  const at = address >> 2;
  const words = module.HEAPU32;
  const obstacles: Obstacle[] = [];
  for (let i = 0; i < words[at + 6]; ++i) {
    obstacles.push(readObstacle(module, words[at + 7] + 4 * kObstacleWords * i));
  }
  const grounds: Ground[] = [];
  for (let i = 0; i < words[at + 8]; ++i) grounds.push(readGround(module, words[at + 9] + 4 * kGroundWords * i));
  return {
    clientId: words[at],
    ownBody: words[at + 1],
    tickHz: words[at + 2],
    snapshotHz: words[at + 3],
    scene: readText(module, words[at + 4], words[at + 5]),
    obstacles,
    grounds,
    hands: words[at + 10],
    reach: module.HEAPF32[at + 11],
    game: readText(module, words[at + 12], words[at + 13]),
    workshop: words[at + 14],
    rank: words[at + 15],
    description: readText(module, words[at + 16], words[at + 17]),
    talk: words[at + 18],
  };
}

function readObstacle(module: WobbleModule, address: number): Obstacle {
  return {
    kind: module.HEAPU8[address],
    a: readVector(module, address + 4),
    b: readVector(module, address + 16),
    radius: module.HEAPF32[(address + 28) >> 2],
  };
}

function readGround(module: WobbleModule, address: number): Ground {
  const at = address >> 2;
  const [columns, rows, heights] = module.HEAPU32.subarray(at + 4, at + 7);
  return {
    corner: readVector(module, address),
    cellSize: module.HEAPF32[at + 3],
    columns,
    rows,
    heights: module.HEAPF32.slice(heights >> 2, (heights >> 2) + columns * rows),
  };
}

export function readEvent(module: WobbleModule, address: number): WorldEvent {
  const [kind, clientId, body, name, nameLength, emote] = module.HEAPU32.subarray(address >> 2, (address >> 2) + 6);
  return { kind, clientId, body, name: readText(module, name, nameLength), emote };
}

export function readStatistics(module: WobbleModule, address: number, statistics: Statistics): void {
  const at = address >> 2;
  const floats = module.HEAPF32;
  statistics.snapshots = floats[at];
  statistics.records = floats[at + 1];
  statistics.badMessages = floats[at + 2];
  statistics.bytesReceived = floats[at + 3];
  statistics.stalls = floats[at + 4];
  statistics.delay = floats[at + 5];
  statistics.inputToSnapshot = floats[at + 6];
  statistics.snapshotAge = floats[at + 7];
  statistics.timeRatio = floats[at + 8];
  statistics.lossShare = floats[at + 9];
  statistics.serverTime = floats[at + 10];
  statistics.joinSeconds = floats[at + 11];
  statistics.pace = floats[at + 12];
}

export function makeStatistics(): Statistics {
  return {
    snapshots: 0,
    records: 0,
    badMessages: 0,
    bytesReceived: 0,
    stalls: 0,
    delay: 0,
    inputToSnapshot: 0,
    snapshotAge: 0,
    timeRatio: 1,
    lossShare: 0,
    serverTime: 0,
    joinSeconds: 0,
    pace: 1,
  };
}

export function readNotice(module: WobbleModule, address: number): string {
  const at = address >> 2;
  return readText(module, module.HEAPU32[at], module.HEAPU32[at + 1]);
}

// A copy.
export function readDownload(module: WobbleModule, address: number): Download {
  const [low, high, bytes, length] = module.HEAPU32.subarray(address >> 2, (address >> 2) + 4);
  const digits = (half: number) => half.toString(16).padStart(8, '0');
  return { hash: digits(high) + digits(low), bytes: module.HEAPU8.slice(bytes, bytes + length) };
}

export function readTuning(module: WobbleModule, address: number): Tuning {
  const at = address >> 2;
  const floats = module.HEAPF32;
  return {
    gravity: readVector(module, address),
    stiffness: floats[at + 3],
    timeRate: floats[at + 4],
    may: module.HEAPU32[at + 5],
  };
}

export function readScoreboard(module: WobbleModule, address: number): Scoreboard {
  const words = module.HEAPU32.subarray(address >> 2, (address >> 2) + 14);
  const halves = module.HEAPU16;
  const scores = [];
  for (let i = 0, at = words[6], seat = words[7]; i < words[5]; ++i, at += kScoreBytes, seat += kSeatBytes) {
    const [side, isReady, isBot] = module.HEAPU8.subarray(seat, seat + kSeatBytes);
    scores.push({
      clientId: module.HEAPU32[at >> 2],
      points: halves[(at + 4) >> 1],
      rounds: halves[(at + 6) >> 1],
      side,
      isReady: isReady !== 0,
      isBot: isBot !== 0,
    });
  }
  const sides = [];
  for (let i = 0, at = words[13] >> 1; i < words[12]; ++i, at += 2) {
    sides.push({ points: halves[at], rounds: halves[at + 1] });
  }
  return {
    phase: words[0],
    round: words[1],
    secondsLeft: words[2],
    pointsToWin: words[3],
    winner: words[4],
    scores,
    rounds: words[8],
    winningSide: words[9],
    object: words[10],
    bearer: words[11],
    sides,
  };
}

export function readForces(module: WobbleModule, address: number): Forces {
  const [body, tick, stride, count, fieldsAt] = module.HEAPU32.subarray(address >> 2, (address >> 2) + 5);
  const forces: Forces = { body, tick, stride, fields: [] };
  for (let i = 0; i < count; ++i) {
    const at = (fieldsAt >> 2) + kForceFieldWords * i;
    const [kind, vertices, values] = module.HEAPU32.subarray(at, at + kForceFieldWords);
    forces.fields.push({ kind, values: module.HEAPF32.slice(values >> 2, (values >> 2) + 3 * vertices) });
  }
  return forces;
}
