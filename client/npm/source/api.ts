// What a game uses in a browser and in Node, beside `connect` and `loadRuntime`, which browser.ts and node.ts have.
export type { Credential } from './access.js';
export { readNow, type Client } from './client.js';
export type { ConnectOptions } from './connect.js';
export { Connection, type ConnectionEnd, type ConnectionOptions } from './connection.js';
export type { Runtime } from './runtime.js';
export * from './views.js';
