// What the page knows of the world, as plain objects. Metres, seconds, radians; z is up.

export interface Vector {
  x: number;
  y: number;
  z: number;
}

// A body at the moment of the last sample. vertices and normals are indices into the memory's floats, three a vertex,
// good until the next sample. revision changes with the vertices.
export interface Body {
  body: number;
  blueprint: number;
  revision: number;
  vertexCount: number;
  vertices: number;
  normals: number; // 0: none
  x: number;
  y: number;
  z: number;
  rotationW: number;
  rotationX: number;
  rotationY: number;
  rotationZ: number;
  held: boolean;
}

// Copies, so they stay good.
export interface Blueprint {
  number: number;
  name: string;
  size: number;
  isOpen: boolean;
  rest: Float32Array;
  faces: Uint16Array;
  edges: Uint16Array;
  particleTags: Uint32Array;
  springTags: Uint32Array;
}

export enum ObstacleKind {
  Plane = 0,
  Box = 1,
  Sphere = 2,
  Capsule = 3,
}

// Plane: a is the outward normal, b.x the offset. Box: centre and half extents. Sphere: centre. Capsule: ends.
export interface Obstacle {
  kind: ObstacleKind;
  a: Vector;
  b: Vector;
  radius: number;
}

export interface Ground {
  corner: Vector;
  cellSize: number;
  columns: number;
  rows: number;
  heights: Float32Array;
}

export interface Welcome {
  clientId: number;
  ownBody: number; // 0: none
  tickHz: number;
  snapshotHz: number;
  scene: string;
  obstacles: Obstacle[];
  grounds: Ground[];
}

export enum EventKind {
  Join = 0,
  Leave = 1,
  Respawn = 2,
  BodyRemoved = 3,
}

export interface WorldEvent {
  kind: EventKind;
  clientId: number;
  body: number;
  name: string;
}

export interface Statistics {
  snapshots: number;
  records: number;
  badMessages: number;
  bytesReceived: number;
  stalls: number;
  delay: number;
  inputToSnapshot: number;
  snapshotAge: number;
  timeRatio: number;
  lossShare: number;
  serverTime: number;
  joinSeconds: number;
}

export enum State {
  Connecting = 0,
  Joining = 1,
  Playing = 2,
  Ended = 3,
}

export interface Input {
  moveX: number;
  moveY: number;
  jump: boolean;
  puff: boolean;
  stiffen: boolean;
}
