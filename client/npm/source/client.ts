// The client library, compiled to WebAssembly, as an object: one stay in a world. It receives and sends messages only
// through these functions. Connection makes it and ends it.
import type { WobbleModule } from './wobble.mjs';
import {
  makeStatistics,
  readBlueprint,
  readBodies,
  readDownload,
  readEvent,
  readForces,
  readNotice,
  readScoreboard,
  readStatistics,
  readTuning,
  readWelcome,
  readZeroText,
} from './memory.js';
import {
  State,
  type Blueprint,
  type Body,
  type BuildRequest,
  type Download,
  type EmoteKind,
  type Forces,
  type Input,
  type Scoreboard,
  type Statistics,
  type TuneKind,
  type Tuning,
  type Vector,
  type Welcome,
  type WorldEvent,
} from './views.js';

const kEncoder = new TextEncoder();

/** The clock of all that is given as a time here, s. */
export function readNow(): number {
  return performance.now() / 1000;
}

// Longest step of the client's clock, s. Where the machine slept or a frame took long, nobody knows what happened in
// between; with a longer step the client would take messages waiting in the socket for silence.
const kLongestGap = 1;

export class Client {
  /** The first bodyCount entries are the bodies of the last sample, by ascending number. */
  readonly bodies: Body[] = [];
  bodyCount = 0;

  private readonly m_module: WobbleModule;
  private readonly m_statistics: Statistics = makeStatistics();
  private m_address: number; // of the session in linear memory; 0: destroyed
  private readonly m_blueprints = new Map<number, Blueprint>();
  private m_welcome: Welcome | null = null;
  private m_scenes = 0; // of the connection, that ended before m_welcome
  private m_read = readNow();
  private m_now = 0; // s since this object was made

  /** kept: blueprints that the server need not send again. */
  constructor(module: WobbleModule, name: string, isSpectator: boolean, kept: readonly Uint8Array[]) {
    this.m_module = module;
    const bytes = kEncoder.encode(name);
    const keptAddress = module._CreateKept();
    for (const blueprint of kept) {
      const address = module._AddKept(keptAddress, blueprint.length); // may move the memory that HEAPU8 shows
      module.HEAPU8.set(blueprint, address);
    }
    const address = module._malloc(bytes.length + 1);
    module.HEAPU8.set(bytes, address);
    this.m_address = module._CreateSession(address, bytes.length, isSpectator, keptAddress, this.m_now);
    module._free(address);
  }

  /** All other functions throw afterwards. */
  destroy(): void {
    this.m_module._DestroySession(this.m_session);
    this.m_address = 0;
  }

  openSocket(): void {
    this.m_module._OpenSocket(this.m_session);
  }

  closeSocket(): void {
    this.m_module._CloseSocket(this.m_session);
  }

  receiveMessage(message: Uint8Array): void {
    const address = this.m_module._PrepareInput(this.m_session, message.length);
    this.m_module.HEAPU8.set(message, address);
    this.m_module._ReceiveMessage(this.m_session, message.length);
  }

  /** Passes every outgoing message to `send`, which must not keep it. */
  sendOutgoing(send: (message: Uint8Array) => void): void {
    const module = this.m_module;
    for (;;) {
      const size = module._FindOutgoingSize(this.m_session);
      if (size === 0) return;
      const address = module._FindOutgoing(this.m_session);
      send(module.HEAPU8.subarray(address, address + size));
      module._TakeOutgoing(this.m_session);
    }
  }

  isCloseAsked(): boolean {
    return this.m_module._IsCloseAsked(this.m_session) !== 0;
  }

  setRoundTrip(seconds: number): void {
    this.m_module._SetRoundTrip(this.m_session, seconds);
  }

  update(): void {
    this.m_module._Update(this.m_session, this.advance());
  }

  leave(): void {
    this.m_module._Leave(this.m_session, this.advance());
  }

  readState(): State {
    return this.m_module._ReadState(this.m_session);
  }

  /** Whether another update goes on with blueprints that have come. */
  isCompleting(): boolean {
    return this.m_module._IsCompleting(this.m_session) !== 0;
  }

  /** Whether a new connection may fare better than the one that has ended. */
  mayRejoin(): boolean {
    return this.m_module._MayRejoin(this.m_session) !== 0;
  }

  readEndReason(): string {
    return readZeroText(this.m_module, this.m_module._ReadEndReason(this.m_session));
  }

  /** null before play. Another object when another scene has begun. */
  readWelcome(): Welcome | null {
    const scenes = this.m_module._CountNextScenes(this.m_session);
    if (scenes !== this.m_scenes) this.m_welcome = null;
    this.m_scenes = scenes;
    if (this.m_welcome === null && this.readState() === State.Playing) {
      this.m_welcome = readWelcome(this.m_module, this.m_module._ReadWelcome(this.m_session));
    }
    return this.m_welcome;
  }

  /** The oldest event that was not taken yet, and so the two below; null: there is none. */
  takeEvent(): WorldEvent | null {
    const address = this.m_module._TakeEvent(this.m_session);
    return address === 0 ? null : readEvent(this.m_module, address);
  }

  /** A blueprint that is worth keeping for later connections. */
  takeDownload(): Download | null {
    const address = this.m_module._TakeDownload(this.m_session);
    return address === 0 ? null : readDownload(this.m_module, address);
  }

  /** What the server says to the player, in a line. */
  takeNotice(): string | null {
    const address = this.m_module._TakeNotice(this.m_session);
    return address === 0 ? null : readNotice(this.m_module, address);
  }

  readTuning(): Tuning {
    return readTuning(this.m_module, this.m_module._ReadTuning(this.m_session));
  }

  readScoreboard(): Scoreboard {
    return readScoreboard(this.m_module, this.m_module._ReadScoreboard(this.m_session));
  }

  restartDecodedHash(): void {
    this.m_module._RestartDecodedHash(this.m_session);
  }

  readForces(): Forces {
    return readForces(this.m_module, this.m_module._ReadForces(this.m_session));
  }

  /** Hash of everything decoded since the last restart, or so far: 64 bits in hexadecimal digits. */
  readDecodedHash(): string {
    const half = (upper: boolean) => this.m_module._ReadDecodedHash(this.m_session, upper) >>> 0;
    return half(true).toString(16).padStart(8, '0') + half(false).toString(16).padStart(8, '0');
  }

  /** The same object each time. */
  readStatistics(): Statistics {
    readStatistics(this.m_module, this.m_module._ReadStatistics(this.m_session, this.advance()), this.m_statistics);
    return this.m_statistics;
  }

  /** Fills in `bodies` as they are to be shown now. */
  sample(): void {
    this.m_module._Sample(this.m_session, this.advance());
    this.bodyCount = this.m_module._ReadBodyCount(this.m_session);
    readBodies(this.m_module, this.m_module._ReadBodies(this.m_session), this.bodyCount, this.bodies);
    this.dropUnusedBlueprints();
  }

  /** A body of the last sample; null: it is not there. */
  findBody(body: number): Body | null {
    let low = 0;
    let high = this.bodyCount;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.bodies[middle].body < body) low = middle + 1;
      else high = middle;
    }
    return low < this.bodyCount && this.bodies[low].body === body ? this.bodies[low] : null;
  }

  /** number: Body.blueprint, of a body of the last sample. */
  findBlueprint(number: number): Blueprint {
    let blueprint = this.m_blueprints.get(number);
    if (blueprint === undefined) {
      const address = this.m_module._FindBlueprint(this.m_session, number);
      blueprint = readBlueprint(this.m_module, address, number);
      this.m_blueprints.set(number, blueprint);
    }
    return blueprint;
  }

  /**
   * The vertices of a body of the last sample in the world, m, and their normals, of unit length: three numbers each.
   * Views of linear memory, valid until the next sample or update, which messages between frames cause, too. Bodies
   * without faces have no normals.
   */
  readPositions(body: Body): Float32Array {
    return this.m_module.HEAPF32.subarray(body.vertices, body.vertices + 3 * body.vertexCount);
  }

  readNormals(body: Body): Float32Array {
    const count = body.normals === 0 ? 0 : body.vertexCount;
    return this.m_module.HEAPF32.subarray(body.normals, body.normals + 3 * count);
  }

  /**
   * The triangles of a body of the last sample: three of its vertices each. They change with Body.blueprint, as when a
   * cloth is cut.
   */
  readIndices(body: Body): Uint16Array {
    return this.findBlueprint(body.blueprint).faces;
  }

  /**
   * All of linear memory, for Body.vertices and Body.normals; valid as long as readPositions. For loops over many
   * bodies, which then make no object for each.
   */
  readFloats(): Float32Array {
    return this.m_module.HEAPF32;
  }

  /** Holds until the next call. */
  setInput({ moveX = 0, moveY = 0, jump = false, puff = false, stiffen = false }: Input): void {
    const buttons = (jump ? 1 : 0) | (puff ? 2 : 0) | (stiffen ? 4 : 0);
    this.m_module._SetInput(this.m_session, moveX, moveY, buttons);
  }

  /**
   * Whether the own body is shown ahead of the others by what the input will do to it; so it is from the start. False:
   * it waits for the server, as the others do.
   */
  setPredicts(predicts: boolean): void {
    this.m_module._SetPredicts(this.m_session, predicts);
  }

  /** The hand holds this vertex of the body and pulls it to `target`, until the next call; null opens it. */
  setHand(hand: { body: number; vertex: number; target: Vector } | null): void {
    if (hand === null) {
      this.m_module._OpenHand(this.m_session);
      return;
    }
    const { x, y, z } = hand.target;
    this.m_module._SetHand(this.m_session, hand.body, hand.vertex, x, y, z);
  }

  push(body: number, vertex: number, direction: Vector): void {
    this.m_module._Push(this.m_session, body, vertex, direction.x, direction.y, direction.z);
  }

  /** The blade is the triangle of the three points. */
  cut(body: number, eye: Vector, from: Vector, to: Vector): void {
    this.writeWords(9, (floats, at) => {
      [eye, from, to].forEach((point, i) => floats.set([point.x, point.y, point.z], at + 3 * i));
    });
    this.m_module._Cut(this.m_session, body);
  }

  /** A line to the server's administration; the answer comes as notices. */
  order(line: string): void {
    this.m_module._Order(this.m_session, this.writeText(line));
  }

  /** A line to everybody, 200 bytes at most; one a second, four at once. A notice tells when it was not sent. */
  say(text: string): void {
    this.m_module._Say(this.m_session, this.writeText(text));
  }

  /** Shows a sign over the player's body; counts as a line. */
  emote(kind: EmoteKind): void {
    this.m_module._Emote(this.m_session, kind);
  }

  /** Another name for this stay; Connection.rename keeps it for those to come. An event tells when it is in force. */
  rename(name: string): void {
    this.m_module._Rename(this.m_session, this.writeText(name));
  }

  /** Asks for the forces on a body, ten times a second; 0: for none. readForces has them. */
  inspect(body: number): void {
    this.m_module._Inspect(this.m_session, body);
  }

  /** A parameter with a single value uses x. */
  tune(kind: TuneKind, value: Vector): void {
    this.m_module._Tune(this.m_session, kind, value.x, value.y, value.z);
  }

  build(request: BuildRequest): void {
    this.writeWords(11, (floats, at) => {
      const at3 = request.at ?? { x: 0, y: 0, z: 0 };
      this.m_module.HEAPU32.set([request.kind, request.a ?? 0, request.b ?? 0], at);
      floats.set([at3.x, at3.y, at3.z, request.mass ?? 1], at + 3);
      this.m_module.HEAPU32[at + 7] = request.fixed === true ? 1 : 0;
      floats.set([request.stiffness ?? 100, request.damping ?? 1, request.restLength ?? 0], at + 8);
    });
    this.m_module._Build(this.m_session);
  }

  private get m_session(): number {
    if (this.m_address === 0) throw new Error('wobble-client: this client has ended; take Connection.client');
    return this.m_address;
  }

  private advance(): number {
    const now = readNow();
    this.m_now += Math.max(0, Math.min(kLongestGap, now - this.m_read));
    this.m_read = now;
    return this.m_now;
  }

  // Returns the length in bytes.
  private writeText(text: string): number {
    const bytes = kEncoder.encode(text);
    const address = this.m_module._PrepareInput(this.m_session, bytes.length);
    this.m_module.HEAPU8.set(bytes, address);
    return bytes.length;
  }

  private writeWords(count: number, write: (floats: Float32Array, at: number) => void): void {
    const address = this.m_module._PrepareInput(this.m_session, 4 * count);
    write(this.m_module.HEAPF32, address >> 2);
  }

  // A tearing cloth goes through many blueprints.
  private dropUnusedBlueprints(): void {
    if (this.m_blueprints.size <= 64) return;
    const used = new Set<number>();
    for (let i = 0; i < this.bodyCount; ++i) used.add(this.bodies[i].blueprint);
    for (const number of this.m_blueprints.keys()) if (!used.has(number)) this.m_blueprints.delete(number);
  }
}
