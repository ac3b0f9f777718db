// More WebSockets of the same player, beside the first.
//
// TCP delivers in order: a lost segment holds back everything behind it. Over several connections it holds back its own
// alone, and snapshots and inputs, of which each newer one replaces the older, go on over the others. Where a proxy
// allows no more than one connection, all goes over the first.
import { kOpen, type Runtime, type Socket } from './runtime.js';

const kInputChannel = 1;
const kLanes = 3;

export class Lanes {
  private readonly m_sockets: Socket[]; // the first socket in front
  private m_turn = 0;

  // subprotocol: by which the gateway knows whose they are. receive: for each message that comes.
  constructor(runtime: Runtime, first: Socket, subprotocol: string, receive: (message: Uint8Array) => void) {
    const more = Array.from({ length: kLanes }, () => {
      const socket = runtime.openSocket(first.url, [first.protocol, subprotocol]);
      socket.onerror = () => {}; // the first goes on
      socket.onmessage = (event) => {
        if (event.data instanceof ArrayBuffer) receive(new Uint8Array(event.data));
      };
      return socket;
    });
    this.m_sockets = [first, ...more];
  }

  // The socket for a message: inputs go over all that are open in turn, everything else over the first.
  choose(message: Uint8Array): Socket {
    if (message[0] !== kInputChannel) return this.m_sockets[0];
    const open = this.m_sockets.filter((socket) => socket.readyState === kOpen);
    this.m_turn += 1;
    return open[this.m_turn % open.length] ?? this.m_sockets[0];
  }

  close(): void {
    for (const socket of this.m_sockets.slice(1)) socket.close(1000);
  }
}
