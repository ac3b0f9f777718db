// The package in Node: the WebAssembly comes from its file, which Node's fetch does not read, and the WebSocket is
// Node's own, from version 22 on, or that of the package ws.
import { readFile } from 'node:fs/promises';
import { join, type ConnectOptions } from './connect.js';
import type { Connection } from './connection.js';
import type { Runtime, Socket } from './runtime.js';
import createModule from './wobble.mjs';

export * from './api.js';

type OpenSocket = Runtime['openSocket'];

/** For a Connection that is not made by `connect`. Rejects where there is no WebAssembly, and without a WebSocket. */
export async function loadRuntime(): Promise<Runtime> {
  const openSocket = await findSockets();
  const module = await createModule({ wasmBinary: await readFile(new URL('./wobble.wasm', import.meta.url)) });
  return { module, openSocket };
}

/** Joins a world. Resolves when the player plays; rejects with the reason when the first try fails. */
export async function connect(options: ConnectOptions): Promise<Connection> {
  return await join(await loadRuntime(), options);
}

async function findSockets(): Promise<OpenSocket> {
  if (typeof WebSocket === 'function') return (...options) => receiveBuffers(new WebSocket(...options));
  let ws: typeof import('ws');
  try {
    ws = await import('ws');
  } catch {
    throw new Error('wobble-client: this Node has no WebSocket: use version 22 or later, or `npm install ws`');
  }
  return (address, protocols) => receiveBuffers(new ws.WebSocket(address, protocols, { perMessageDeflate: false }));
}

function receiveBuffers<Made extends Socket & { binaryType: string }>(socket: Made): Made {
  socket.binaryType = 'arraybuffer';
  return socket;
}
