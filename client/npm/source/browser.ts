// The package in a browser. Bundlers find wobble.wasm by the `new URL` in wobble.mjs.
import { join, type ConnectOptions } from './connect.js';
import type { Connection } from './connection.js';
import type { Runtime } from './runtime.js';
import createModule from './wobble.mjs';

export * from './api.js';

/** For a Connection that is not made by `connect`. Rejects where there is no WebAssembly. */
export async function loadRuntime(): Promise<Runtime> {
  const module = await createModule();
  return {
    module,
    openSocket: (address, protocols) => {
      const socket = new WebSocket(address, protocols);
      socket.binaryType = 'arraybuffer';
      return socket;
    },
  };
}

/** Joins a world. Resolves when the player plays; rejects with the reason when the first try fails. */
export async function connect(options: ConnectOptions): Promise<Connection> {
  return await join(await loadRuntime(), options);
}
