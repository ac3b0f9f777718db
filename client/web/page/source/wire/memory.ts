// Reads what client/web/wasm/layout.h describes: structures of four-byte fields, at addresses in linear memory.
//
// The views onto the memory are taken anew for every structure, since they are dead once it has grown.
import type { WobbleModule } from 'wobble-wasm';
import type { Blueprint, Body, Ground, Obstacle, Statistics, Vector, Welcome, WorldEvent } from './views';

const kBodyWords = 14;
const kObstacleWords = 8;
const kGroundWords = 7;
const kDecoder = new TextDecoder();

export function ReadText(module: WobbleModule, address: number, length: number): string {
  return kDecoder.decode(module.HEAPU8.subarray(address, address + length));
}

// Up to its zero.
export function ReadZeroText(module: WobbleModule, address: number): string {
  const end = module.HEAPU8.indexOf(0, address);
  return ReadText(module, address, end - address);
}

export function MakeBody(): Body {
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

// Fills the first `count` of `bodies`, which grows as needed and is kept.
export function ReadBodies(module: WobbleModule, address: number, count: number, bodies: Body[]): void {
  while (bodies.length < count) bodies.push(MakeBody());
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

export function ReadBlueprint(module: WobbleModule, address: number, number: number): Blueprint {
  const at = address >> 2;
  const words = module.HEAPU32;
  const [vertexCount, rest, faceCount, faces, edgeCount, edges] = words.subarray(at, at + 6);
  const [isOpen, name, nameLength, particleTags, springTags] = words.subarray(at + 7, at + 12);
  return {
    number,
    name: ReadText(module, name, nameLength),
    size: module.HEAPF32[at + 6],
    isOpen: isOpen !== 0,
    rest: module.HEAPF32.slice(rest >> 2, (rest >> 2) + 3 * vertexCount),
    faces: module.HEAPU16.slice(faces >> 1, (faces >> 1) + 3 * faceCount),
    edges: module.HEAPU16.slice(edges >> 1, (edges >> 1) + 2 * edgeCount),
    particleTags: particleTags === 0 ? new Uint32Array() : words.slice(particleTags >> 2, (particleTags >> 2) + vertexCount),
    springTags: springTags === 0 ? new Uint32Array() : words.slice(springTags >> 2, (springTags >> 2) + edgeCount),
  };
}

export function ReadVector(module: WobbleModule, address: number): Vector {
  const at = address >> 2;
  const floats = module.HEAPF32;
  return { x: floats[at], y: floats[at + 1], z: floats[at + 2] };
}

export function ReadWelcome(module: WobbleModule, address: number): Welcome {
  const at = address >> 2;
  const words = module.HEAPU32;
  const obstacles: Obstacle[] = [];
  for (let i = 0; i < words[at + 6]; ++i) {
    obstacles.push(ReadObstacle(module, words[at + 7] + 4 * kObstacleWords * i));
  }
  const grounds: Ground[] = [];
  for (let i = 0; i < words[at + 8]; ++i) grounds.push(ReadGround(module, words[at + 9] + 4 * kGroundWords * i));
  return {
    clientId: words[at],
    ownBody: words[at + 1],
    tickHz: words[at + 2],
    snapshotHz: words[at + 3],
    scene: ReadText(module, words[at + 4], words[at + 5]),
    obstacles,
    grounds,
  };
}

// A structure of FlatBuffers: a byte, three of padding, seven floats.
function ReadObstacle(module: WobbleModule, address: number): Obstacle {
  return {
    kind: module.HEAPU8[address],
    a: ReadVector(module, address + 4),
    b: ReadVector(module, address + 16),
    radius: module.HEAPF32[(address + 28) >> 2],
  };
}

function ReadGround(module: WobbleModule, address: number): Ground {
  const at = address >> 2;
  const [columns, rows, heights] = module.HEAPU32.subarray(at + 4, at + 7);
  return {
    corner: ReadVector(module, address),
    cellSize: module.HEAPF32[at + 3],
    columns,
    rows,
    heights: module.HEAPF32.slice(heights >> 2, (heights >> 2) + columns * rows),
  };
}

export function ReadEvent(module: WobbleModule, address: number): WorldEvent {
  const [kind, clientId, body, name, nameLength] = module.HEAPU32.subarray(address >> 2, (address >> 2) + 5);
  return { kind, clientId, body, name: ReadText(module, name, nameLength) };
}

export function ReadStatistics(module: WobbleModule, address: number, statistics: Statistics): void {
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
}

export function MakeStatistics(): Statistics {
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
  };
}
