// The client library as WebAssembly decodes what the native one decodes, to the last bit: it plays through a real
// gateway, here in Node, every message that comes is kept, and the native library is fed with the same.
import assert from 'node:assert';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';
import { pathToFileURL } from 'node:url';

import { Player } from './support/player.mjs';
import { makePage, removePage, startGateway, startServer, test, waitFor } from './support/programs.mjs';

// It is made for browsers and would fetch its other half.
const glue = pathToFileURL(process.env.WOBBLE_WASM);
const binary = fs.readFileSync(new URL('wobble.wasm', glue));
const module = await (
  await import(glue)
).default({
  instantiateWasm: (imports, receive) => {
    WebAssembly.instantiate(binary, imports).then(({ instance }) => receive(instance));
    return {};
  },
});
const playing = 2;
const enoughRecords = 600;

let page;
let server;
let gateway;

before(async () => {
  page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' });
  server = await startServer('--scene', 'curtain');
  gateway = await startGateway(server.address, page);
});
after(async () => {
  await gateway?.program.stop();
  await server?.program.stop();
  removePage(page);
});

class WasmClient {
  constructor() {
    const name = module._malloc(4);
    module.HEAPU8.set(Buffer.from('hash'), name);
    this.session = module._CreateSession(name, 4, false, 0);
    module._free(name);
    this.begin = performance.now();
  }

  receive(bytes) {
    module.HEAPU8.set(bytes, module._PrepareInput(this.session, bytes.length));
    module._ReceiveMessage(this.session, bytes.length);
  }

  update(send) {
    module._Update(this.session, (performance.now() - this.begin) / 1000);
    for (let size = 0; (size = module._FindOutgoingSize(this.session)) > 0; module._TakeOutgoing(this.session)) {
      const at = module._FindOutgoing(this.session);
      send(Buffer.from(module.HEAPU8.slice(at, at + size)));
    }
  }

  get records() {
    return module.HEAPF32[(module._ReadStatistics(this.session, (performance.now() - this.begin) / 1000) >> 2) + 1];
  }

  get hash() {
    const half = (upper) => (module._ReadDecodedHash(this.session, upper) >>> 0).toString(16).padStart(8, '0');
    return half(true) + half(false);
  }
}

test('WebAssembly decodes the bits that the native client decodes', async () => {
  const player = new Player(gateway.host);
  assert.equal(await player.opened, true);
  const client = new WasmClient();
  module._OpenSocket(client.session);
  const kept = [];
  await waitFor('records', () => {
    for (const message of player.messages.splice(0)) {
      client.receive(message);
      const size = Buffer.alloc(4);
      size.writeUInt32LE(message.length);
      kept.push(size, message);
    }
    client.update((message) => player.socket.send(message));
    return client.records >= enoughRecords;
  });
  assert.equal(module._ReadState(client.session), playing);
  player.socket.close();

  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wobble-'));
  const file = path.join(folder, 'messages');
  fs.writeFileSync(file, Buffer.concat(kept));
  const [hash, records] = execFileSync(process.env.WOBBLE_REPLAY, [file]).toString().trim().split(' ');
  fs.rmSync(folder, { recursive: true });
  assert.equal(Number(records), client.records);
  assert.equal(client.hash, hash);
  assert.notEqual(hash, 'cbf29ce484222325'); // of nothing at all
});
