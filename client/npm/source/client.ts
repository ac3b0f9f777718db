// The client library, compiled to WebAssembly, as an object. It receives and sends messages only through these
// functions.
import type { WobbleModule } from 'wobble-wasm';
import {
  MakeStatistics,
  ReadBlueprint,
  ReadBodies,
  ReadDownload,
  ReadEvent,
  ReadForces,
  ReadNotice,
  ReadScoreboard,
  ReadStatistics,
  ReadTuning,
  ReadWelcome,
  ReadZeroText,
} from './memory';
import {
  State,
  type Blueprint,
  type Body,
  type BuildRequest,
  type Download,
  type Forces,
  type Input,
  type Scoreboard,
  type Statistics,
  type TuneKind,
  type Tuning,
  type Vector,
  type Welcome,
  type WorldEvent,
} from './views';

const kEncoder = new TextEncoder();

// The page's clock, seconds.
export function ReadNow(): number {
  return performance.now() / 1000;
}

// Longest step of the client's clock, s. A page whose machine slept or whose frame took long cannot know what happened
// in between; with a longer step the client would take messages waiting in the socket for silence.
const kLongestGap = 1;

export class Client {
  // The first bodyCount entries are the bodies of the last Sample.
  readonly bodies: Body[] = [];
  bodyCount = 0;
  readonly statistics: Statistics = MakeStatistics();

  private readonly m_module: WobbleModule;
  private readonly m_session: number;
  private readonly m_blueprints = new Map<number, Blueprint>();
  private m_welcome: Welcome | null = null;
  private m_scenes = 0; // of the connection, that ended before m_welcome
  private m_read = ReadNow();
  private m_now = 0; // s since this object was made

  // kept: blueprints that the server need not send again.
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
    this.m_session = module._CreateSession(address, bytes.length, isSpectator, keptAddress, this.m_now);
    module._free(address);
  }

  // No other function may be called afterwards.
  Destroy(): void {
    this.m_module._DestroySession(this.m_session);
  }

  OpenSocket(): void {
    this.m_module._OpenSocket(this.m_session);
  }

  CloseSocket(): void {
    this.m_module._CloseSocket(this.m_session);
  }

  ReceiveMessage(message: Uint8Array): void {
    const address = this.m_module._PrepareInput(this.m_session, message.length);
    this.m_module.HEAPU8.set(message, address);
    this.m_module._ReceiveMessage(this.m_session, message.length);
  }

  // Passes every outgoing message to `send`, which must not keep it.
  SendOutgoing(send: (message: Uint8Array) => void): void {
    const module = this.m_module;
    for (;;) {
      const size = module._FindOutgoingSize(this.m_session);
      if (size === 0) return;
      const address = module._FindOutgoing(this.m_session);
      send(module.HEAPU8.subarray(address, address + size));
      module._TakeOutgoing(this.m_session);
    }
  }

  IsCloseAsked(): boolean {
    return this.m_module._IsCloseAsked(this.m_session) !== 0;
  }

  SetRoundTrip(seconds: number): void {
    this.m_module._SetRoundTrip(this.m_session, seconds);
  }

  Update(): void {
    this.m_module._Update(this.m_session, this.Advance());
  }

  Leave(): void {
    this.m_module._Leave(this.m_session, this.Advance());
  }

  ReadState(): State {
    return this.m_module._ReadState(this.m_session);
  }

  // Whether a new connection may fare better than the one that has ended.
  // Whether another Update goes on with blueprints that have come.
  IsCompleting(): boolean {
    return this.m_module._IsCompleting(this.m_session) !== 0;
  }

  MayRejoin(): boolean {
    return this.m_module._MayRejoin(this.m_session) !== 0;
  }

  ReadEndReason(): string {
    return ReadZeroText(this.m_module, this.m_module._ReadEndReason(this.m_session));
  }

  // null before play. Another object when another scene has begun.
  ReadWelcome(): Welcome | null {
    const scenes = this.m_module._CountNextScenes(this.m_session);
    if (scenes !== this.m_scenes) this.m_welcome = null;
    this.m_scenes = scenes;
    if (this.m_welcome === null && this.ReadState() === State.Playing) {
      this.m_welcome = ReadWelcome(this.m_module, this.m_module._ReadWelcome(this.m_session));
    }
    return this.m_welcome;
  }

  TakeEvent(): WorldEvent | null {
    const address = this.m_module._TakeEvent(this.m_session);
    return address === 0 ? null : ReadEvent(this.m_module, address);
  }

  // A blueprint that is worth keeping for later connections.
  TakeDownload(): Download | null {
    const address = this.m_module._TakeDownload(this.m_session);
    return address === 0 ? null : ReadDownload(this.m_module, address);
  }

  TakeNotice(): string | null {
    const address = this.m_module._TakeNotice(this.m_session);
    return address === 0 ? null : ReadNotice(this.m_module, address);
  }

  ReadTuning(): Tuning {
    return ReadTuning(this.m_module, this.m_module._ReadTuning(this.m_session));
  }

  ReadScoreboard(): Scoreboard {
    return ReadScoreboard(this.m_module, this.m_module._ReadScoreboard(this.m_session));
  }

  RestartDecodedHash(): void {
    this.m_module._RestartDecodedHash(this.m_session);
  }

  ReadForces(): Forces {
    return ReadForces(this.m_module, this.m_module._ReadForces(this.m_session));
  }

  // Hash of everything decoded since the last restart, or so far: 64 bits in hexadecimal digits.
  ReadDecodedHash(): string {
    const half = (upper: boolean) => this.m_module._ReadDecodedHash(this.m_session, upper) >>> 0;
    return half(true).toString(16).padStart(8, '0') + half(false).toString(16).padStart(8, '0');
  }

  UpdateStatistics(): void {
    ReadStatistics(this.m_module, this.m_module._ReadStatistics(this.m_session, this.Advance()), this.statistics);
  }

  Sample(): void {
    this.m_module._Sample(this.m_session, this.Advance());
    this.bodyCount = this.m_module._ReadBodyCount(this.m_session);
    ReadBodies(this.m_module, this.m_module._ReadBodies(this.m_session), this.bodyCount, this.bodies);
    this.DropUnusedBlueprints();
  }

  FindBody(body: number): Body | null {
    let low = 0;
    let high = this.bodyCount;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.bodies[middle].body < body) low = middle + 1;
      else high = middle;
    }
    return low < this.bodyCount && this.bodies[low].body === body ? this.bodies[low] : null;
  }

  // number: of a body of the last Sample.
  FindBlueprint(number: number): Blueprint {
    let blueprint = this.m_blueprints.get(number);
    if (blueprint === undefined) {
      const address = this.m_module._FindBlueprint(this.m_session, number);
      blueprint = ReadBlueprint(this.m_module, address, number);
      this.m_blueprints.set(number, blueprint);
    }
    return blueprint;
  }

  // All of linear memory, for the indices in bodies; valid until the next Sample.
  ReadFloats(): Float32Array {
    return this.m_module.HEAPF32;
  }

  SetInput(input: Input): void {
    const buttons = (input.jump ? 1 : 0) | (input.puff ? 2 : 0) | (input.stiffen ? 4 : 0);
    this.m_module._SetInput(this.m_session, input.moveX, input.moveY, buttons);
  }

  // Sets what the hand holds until the next call; null opens it.
  SetHand(hand: { body: number; vertex: number; target: Vector } | null): void {
    if (hand === null) {
      this.m_module._OpenHand(this.m_session);
      return;
    }
    const { x, y, z } = hand.target;
    this.m_module._SetHand(this.m_session, hand.body, hand.vertex, x, y, z);
  }

  Push(body: number, vertex: number, direction: Vector): void {
    this.m_module._Push(this.m_session, body, vertex, direction.x, direction.y, direction.z);
  }

  // The blade is the triangle of the three points.
  Cut(body: number, eye: Vector, from: Vector, to: Vector): void {
    this.WriteWords(9, (floats, at) => {
      [eye, from, to].forEach((point, i) => floats.set([point.x, point.y, point.z], at + 3 * i));
    });
    this.m_module._Cut(this.m_session, body);
  }

  // A line to the server's administration; the answer comes as notices.
  Order(line: string): void {
    const bytes = new TextEncoder().encode(line);
    const address = this.m_module._PrepareInput(this.m_session, bytes.length);
    this.m_module.HEAPU8.set(bytes, address);
    this.m_module._Order(this.m_session, bytes.length);
  }

  Inspect(body: number): void {
    this.m_module._Inspect(this.m_session, body);
  }

  // A parameter with a single value uses x.
  Tune(kind: TuneKind, value: Vector): void {
    this.m_module._Tune(this.m_session, kind, value.x, value.y, value.z);
  }

  Build(request: BuildRequest): void {
    this.WriteWords(11, (floats, at) => {
      const at3 = request.at ?? { x: 0, y: 0, z: 0 };
      this.m_module.HEAPU32.set([request.kind, request.a ?? 0, request.b ?? 0], at);
      floats.set([at3.x, at3.y, at3.z, request.mass ?? 1], at + 3);
      this.m_module.HEAPU32[at + 7] = request.fixed === true ? 1 : 0;
      floats.set([request.stiffness ?? 100, request.damping ?? 1, request.restLength ?? 0], at + 8);
    });
    this.m_module._Build(this.m_session);
  }

  private Advance(): number {
    const now = ReadNow();
    this.m_now += Math.max(0, Math.min(kLongestGap, now - this.m_read));
    this.m_read = now;
    return this.m_now;
  }

  private WriteWords(count: number, write: (floats: Float32Array, at: number) => void): void {
    const address = this.m_module._PrepareInput(this.m_session, 4 * count);
    write(this.m_module.HEAPF32, address >> 2);
  }

  // A tearing cloth goes through many blueprints.
  private DropUnusedBlueprints(): void {
    if (this.m_blueprints.size <= 64) return;
    const used = new Set<number>();
    for (let i = 0; i < this.bodyCount; ++i) used.add(this.bodies[i].blueprint);
    for (const number of this.m_blueprints.keys()) if (!used.has(number)) this.m_blueprints.delete(number);
  }
}
