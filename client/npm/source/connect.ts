// The first join as one promise, for a game that shows nothing meanwhile.
import type { Credential } from './access.js';
import { Connection, type ConnectionOptions } from './connection.js';
import type { Runtime } from './runtime.js';

/** Besides the options of a connection one of: token, invite, password, ownerKey. */
export interface ConnectOptions extends ConnectionOptions, Credential {}

// What `connect` of browser.ts and node.ts does. A wrong address should be said at once, so the first try is the only
// one; once it plays, the connection comes back by itself. Throws TypeError for a wrong option.
export async function join(runtime: Runtime, options: ConnectOptions): Promise<Connection> {
  const connection = new Connection(runtime, options);
  connection.show(options);
  await new Promise<void>((resolve, reject) => {
    connection.onPlay = resolve;
    connection.onEnd = (reason) => {
      connection.leave();
      reject(new Error(`${connection.address}: ${reason}`));
    };
    connection.join();
  });
  connection.onPlay = connection.onEnd = () => {};
  return connection;
}
