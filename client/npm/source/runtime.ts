// What a connection needs of the place where it runs: the WebAssembly, and WebSockets. browser.ts and node.ts make it.
import type { WobbleModule } from './wobble.mjs';

export interface Runtime {
  readonly module: WobbleModule;
  /** Receives binary messages as ArrayBuffer. */
  openSocket(address: string, protocols: string[]): Socket;
}

/** The part of a browser's WebSocket that is used; that of the package ws has it, too. */
export interface Socket {
  readonly url: string;
  readonly protocol: string;
  readonly readyState: number;
  onopen: ((event: any) => void) | null;
  onmessage: ((event: any) => void) | null;
  onclose: ((event: any) => void) | null;
  onerror: ((event: any) => void) | null;
  send(message: Uint8Array): void;
  close(code: number): void;
}

export const kOpen = 1; // of readyState
