// The state of the world as plain objects. Metres, seconds, radians; z is up.

export interface Vector {
  x: number;
  y: number;
  z: number;
}

/** A body at the last sample. revision changes with the vertices. */
export interface Body {
  /** its number, by which events, hands and Welcome.ownBody name it */
  body: number;
  blueprint: number;
  revision: number;
  vertexCount: number;
  /** index into Client.readFloats, three numbers a vertex */
  vertices: number;
  /** likewise; 0: none */
  normals: number;
  /** of the centroid of its vertices */
  x: number;
  y: number;
  z: number;
  rotationW: number;
  rotationX: number;
  rotationY: number;
  rotationZ: number;
  /** recent data is missing */
  held: boolean;
}

/** Copies of the wire's data, valid without limit. */
export interface Blueprint {
  number: number;
  name: string;
  size: number;
  isOpen: boolean;
  rest: Float32Array;
  faces: Uint16Array;
  edges: Uint16Array;
  /** workshop only, one per vertex; otherwise empty */
  particles: ParticleTag[];
  /** workshop only, one per edge */
  springs: SpringTag[];
}

/** Units: kg, N/m, N s/m, m. owner: the client that made it; 0: part of the scene. */
export interface ParticleTag {
  number: number;
  owner: number;
  mass: number;
  fixed: boolean;
}

export interface SpringTag {
  number: number;
  owner: number;
  stiffness: number;
  damping: number;
  restLength: number;
}

export enum ObstacleKind {
  Plane = 0,
  Box = 1,
  Sphere = 2,
  Capsule = 3,
}

/** Plane: a is the outward normal, b.x the offset. Box: centre and half extents. Sphere: centre. Capsule: ends. */
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
  /** 0: none */
  ownBody: number;
  tickHz: number;
  snapshotHz: number;
  scene: string;
  obstacles: Obstacle[];
  grounds: Ground[];
  /** bits of the enum Hands */
  hands: number;
  /** m from the centre of the player's body; 0: any distance */
  reach: number;
  /** empty: none */
  game: string;
  /** the body that Build changes; 0: none */
  workshop: number;
  /** when the player came in */
  rank: Rank;
  /** of the scene, a line for people; empty: none */
  description: string;
  /** bits of the enum Talk: what the player may tell the others */
  talk: number;
}

/** Bits of Welcome.talk. */
export enum Talk {
  Say = 1,
  Emote = 2,
}

/** What a player shows over their body for some seconds. */
export enum EmoteKind {
  Wave = 0,
  Laugh = 1,
  Love = 2,
  Wow = 3,
  Sad = 4,
  Cheer = 5,
}

export enum Rank {
  Watcher,
  Player,
  Moderator,
  Owner,
}

/** Bits of Welcome.hands. */
export enum Hands {
  Grab = 1,
  Cut = 2,
  Push = 4,
  Build = 8,
}

export enum TuneKind {
  Gravity = 0,
  Stiffness = 1,
  TimeRate = 2,
  Jump = 3,
}

/** Bits of Tuning.may. */
export enum MayTune {
  Gravity = 1,
  Stiffness = 2,
  Time = 4,
}

export interface Tuning {
  /** m/s² */
  gravity: Vector;
  /** factor on every spring's stiffness */
  stiffness: number;
  /** seconds of the world per second */
  timeRate: number;
  may: number;
}

export enum GamePhase {
  Playing = 0,
  Won = 1,
  /** the match begins when all are ready, or the time has run out */
  Lobby = 2,
  /** all are at their places and may not move */
  KickOff = 3,
  /** the next point wins */
  Golden = 4,
  /** the match is over */
  Over = 5,
}

export interface Score {
  clientId: number;
  points: number;
  rounds: number;
  /** 1 or 2; 0: the game has no sides */
  side: number;
  isReady: boolean;
  isBot: boolean;
}

export interface SideScore {
  points: number;
  rounds: number;
}

export interface Scoreboard {
  phase: GamePhase;
  round: number;
  secondsLeft: number;
  pointsToWin: number;
  /** client, of the last round, and in Over of the match; 0: none */
  winner: number;
  scores: Score[];
  /** that make a match; 0: it never ends */
  rounds: number;
  /** as winner; 0: none */
  winningSide: number;
  /** the ball or the crown, a body; 0: none */
  object: number;
  /** client who wears the crown; 0: nobody */
  bearer: number;
  /** of sides 1 and 2; empty: the game has no sides */
  sides: SideScore[];
}

export enum ForceKind {
  Elastic = 0,
  Damping = 1,
  Gas = 2,
  Weight = 3,
  Contact = 4,
  Other = 5,
  Acceleration = 6,
}

/** For every stride-th vertex of the body, N (Acceleration: m/s²), three numbers each. */
export interface Forces {
  /** 0: none received yet */
  body: number;
  tick: number;
  stride: number;
  fields: { kind: ForceKind; values: Float32Array }[];
}

export enum BuildKind {
  AddParticle = 0,
  AddSpring = 1,
  SetParticle = 2,
  SetSpring = 3,
  RemoveParticle = 4,
  RemoveSpring = 5,
}

/** messages.fbs documents which fields each kind uses. */
export interface BuildRequest {
  kind: BuildKind;
  a?: number;
  b?: number;
  at?: Vector;
  mass?: number;
  fixed?: boolean;
  stiffness?: number;
  damping?: number;
  restLength?: number;
}

export enum EventKind {
  Join = 0,
  Leave = 1,
  Respawn = 2,
  BodyRemoved = 3,
  /** body fell; clientId, if not 0, pushed it */
  Fall = 4,
  /** clientId says name */
  Said = 5,
  /** clientId shows emote */
  Emote = 6,
  /** name is clientId's from now on */
  Rename = 7,
  /** body, the ball, is in a goal; clientId, if not 0, has scored it */
  Goal = 8,
  /** clientId wears the crown, body, from now on */
  Crown = 9,
}

export interface WorldEvent {
  kind: EventKind;
  clientId: number;
  body: number;
  /** of Said: the line */
  name: string;
  /** of Emote */
  emote: EmoteKind;
}

/** As client/statistics.h has them; times in seconds. */
export interface Statistics {
  snapshots: number;
  /** of bodies in them */
  records: number;
  badMessages: number;
  bytesReceived: number;
  /** times that data of a body did not come in time */
  stalls: number;
  /** how far behind the server bodies are shown */
  delay: number;
  /** from sending an input to a snapshot that shows it */
  inputToSnapshot: number;
  snapshotAge: number;
  timeRatio: number;
  lossShare: number;
  serverTime: number;
  joinSeconds: number;
  /** world time per real time; 1: the server keeps up */
  pace: number;
}

export enum State {
  Connecting = 0,
  Joining = 1,
  Playing = 2,
  Ended = 3,
}

/** What the player asks of its body; what is left out is 0 or false. */
export interface Input {
  /** along the world's axes, -1 to 1 */
  moveX?: number;
  moveY?: number;
  jump?: boolean;
  puff?: boolean;
  stiffen?: boolean;
}

/** A blueprint that was downloaded; its hash in hexadecimal digits. */
export interface Download {
  hash: string;
  bytes: Uint8Array;
}
