// The module that Emscripten makes of client/wasm. Addresses are bytes into linear memory; 0 is null.
declare module 'wobble-wasm' {
  export interface WobbleModule {
    HEAPU8: Uint8Array;
    HEAPU16: Uint16Array;
    HEAPU32: Uint32Array;
    HEAPF32: Float32Array;
    _malloc(size: number): number;
    _free(address: number): void;
    _ReadProtocolVersion(): number;
    _CreateKept(): number;
    _AddKept(kept: number, size: number): number;
    _CreateSession(name: number, size: number, isSpectator: boolean, kept: number, now: number): number;
    _DestroySession(session: number): void;
    _PrepareInput(session: number, size: number): number;
    _OpenSocket(session: number): void;
    _CloseSocket(session: number): void;
    _ReceiveMessage(session: number, size: number): void;
    _FindOutgoing(session: number): number;
    _FindOutgoingSize(session: number): number;
    _TakeOutgoing(session: number): void;
    _IsCloseAsked(session: number): number;
    _SetRoundTrip(session: number, seconds: number): void;
    _Update(session: number, now: number): void;
    _Leave(session: number, now: number): void;
    _ReadState(session: number): number;
    _ReadEndReason(session: number): number;
    _IsCompleting(session: number): number;
    _MayRejoin(session: number): number;
    _ReadWelcome(session: number): number;
    _CountNextScenes(session: number): number;
    _ReadStatistics(session: number, now: number): number;
    _TakeEvent(session: number): number;
    _Sample(session: number, now: number): void;
    _ReadBodies(session: number): number;
    _ReadBodyCount(session: number): number;
    _FindBlueprint(session: number, number: number): number;
    _TakeDownload(session: number): number;
    _TakeNotice(session: number): number;
    _ReadTuning(session: number): number;
    _ReadScoreboard(session: number): number;
    _ReadForces(session: number): number;
    _SetHand(session: number, body: number, vertex: number, x: number, y: number, z: number): void;
    _OpenHand(session: number): void;
    _Push(session: number, body: number, vertex: number, x: number, y: number, z: number): void;
    _Cut(session: number, body: number): void;
    _Order(session: number, size: number): void;
    _Inspect(session: number, body: number): void;
    _Tune(session: number, kind: number, x: number, y: number, z: number): void;
    _Build(session: number): void;
    _RestartDecodedHash(session: number): void;
    _ReadDecodedHash(session: number, upper: boolean): number;
    _SetInput(session: number, moveX: number, moveY: number, buttons: number): void;
  }
  export default function createModule(options?: { locateFile?: (path: string) => string }): Promise<WobbleModule>;
}
