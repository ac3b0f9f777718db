// A player without a browser: a WebSocket to the gateway, and the few messages of the protocol that a test must write.
//
// The messages are built by hand from STANDARD.md and messages.fbs rather than by the client library, so that a test of
// the gateway needs neither Emscripten nor a built page.
import assert from 'node:assert';
import crypto from 'node:crypto';
import fs from 'node:fs';
import { createRequire } from 'node:module';

import { waitFor } from './programs.mjs';

const root = new URL('../../../', import.meta.url);
const { WebSocket } = createRequire(new URL('client/page/package.json', root))('ws');

export const channels = { control: 0, input: 1, snapshot: 2, ping: 3, ticket: 4, lane: 5 };
const limits = fs.readFileSync(new URL('protocol/limits.h', root), 'utf8');
export const protocolVersion = Number(/kProtocolVersion = (\d+);/.exec(limits)[1]);
export const subprotocol = `wobble.${protocolVersion}`;

// Message types as the unions of messages.fbs number them.
export const serverMessages = { welcome: 1, blueprintChunk: 2, event: 3, goodbye: 4 };

export class Player {
  constructor(host, options = {}) {
    this.messages = []; // [channel, bytes...] each
    const scheme = options.ca === undefined ? 'ws' : 'wss'; // ca: the certificate that is trusted
    this.socket = new WebSocket(`${scheme}://${host}${options.path ?? '/play'}`, options.protocols ?? [subprotocol], {
      ca: options.ca,
      origin: options.origin,
      headers: options.headers,
      perMessageDeflate: false,
      localAddress: options.localAddress,
      family: 4,
    });
    this.socket.binaryType = 'nodebuffer';
    this.socket.on('message', (bytes) => this.messages.push(bytes));
    // true once the socket is open, else the HTTP status of the refusal.
    this.opened = new Promise((resolve) => {
      this.socket.on('open', () => resolve(true));
      this.socket.on('unexpected-response', (request, response) => {
        resolve(response.statusCode);
        request.destroy();
      });
      this.socket.on('error', (error) => resolve(error.message));
    });
    // { code, reason }; code 1006 when no close frame came.
    this.closed = new Promise((resolve) =>
      this.socket.on('close', (code, reason) => resolve({ code, reason: reason.toString() })),
    );
  }

  send(channel, bytes) {
    this.socket.send(Buffer.concat([Buffer.from([channel]), bytes]));
  }

  sayHello(name) {
    this.send(channels.control, makeHello(name));
  }

  has(type) {
    return this.messages.some((bytes) => bytes[0] === channels.control && readType(bytes.subarray(1)) === type);
  }

  count(channel) {
    return this.messages.filter((bytes) => bytes[0] === channel).length;
  }

  async leave() {
    this.socket.close();
    return await this.closed;
  }
}

// Joins and waits for the welcome.
export async function join(host, options) {
  const player = new Player(host, options);
  assert.equal(await player.opened, true);
  player.sayHello('mira');
  await waitFor('a welcome', () => player.has(serverMessages.welcome));
  return player;
}

// ClientMessage { body: Hello } of a player, as FlatBuffers lays it out: each table behind its vtable, then the name.
export function makeHello(name) {
  const text = Buffer.from(name);
  const bytes = Buffer.alloc(64 + Math.ceil((text.length + 1) / 4) * 4);
  const put16 = (at, ...values) => values.forEach((value, i) => bytes.writeUInt16LE(value, at + 2 * i));
  bytes.writeUInt32LE(12, 0); // the message
  put16(4, 8, 12, 8, 4); // its vtable: sizes, body_type, body
  bytes.writeInt32LE(12 - 4, 12);
  bytes.writeUInt32LE(40 - 16, 16);
  bytes.writeUInt8(1, 20); // Hello
  put16(24, 12, 20, 16, 8, 4, 18); // vtable: sizes, protocol_version, schema_hash, name, role
  bytes.writeInt32LE(40 - 24, 40);
  bytes.writeUInt32LE(60 - 44, 44);
  bytes.writeBigUInt64LE(readSchemaHash(), 48);
  bytes.writeUInt16LE(protocolVersion, 56);
  bytes.writeUInt8(0, 58); // Player
  bytes.writeUInt32LE(text.length, 60);
  text.copy(bytes, 64);
  return bytes;
}

function readSchemaHash() {
  const text = fs.readFileSync(new URL('protocol/messages.fbs', root));
  return crypto.createHash('sha256').update(text).digest().readBigUInt64BE(0);
}

// The type of the body of a ServerMessage.
function readType(bytes) {
  const table = bytes.readUInt32LE(0);
  const vtable = table - bytes.readInt32LE(table);
  const field = bytes.readUInt16LE(vtable + 4);
  return field === 0 ? 0 : bytes.readUInt8(table + field);
}
