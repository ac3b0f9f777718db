// The connection to the world: a WebSocket to the gateway that served the page, with a client; it reconnects when lost.
//
// A page in the background gets no frames and hardly any timers, but messages on its socket still wake it. The client
// is therefore updated with every message, and the connection stays alive while the server sends.
import type { WobbleModule } from 'wobble-wasm';
import { Access, Encode } from './access';
import { Client, ReadNow } from './client';
import { KeptBlueprints } from './kept_blueprints';
import { Lanes } from './lanes';
import { State } from './views';

const kPingChannel = 3;
const kPingEvery = 1; // s
const kPingBytes = 7;
const kTicketChannel = 4;
const kLaneChannel = 5;
// Close codes of the gateway: another try is in vain; what was shown to be let in does not hold.
const kRefusedForGood = 4000;
const kCredentialRefused = 4001;
// As client/rejoin.h has them, but a first join that fails is tried again, too: nobody has to press a button.
const kFirstWait = 0.25; // s; doubled with each try that fails, and shortened by chance to half of it at most
const kLongestWait = 4; // s
const kPatience = 60; // s without play, after which it gives up
const kGoodFor = 10; // s of play after which waits and patience begin anew
const kTimer = 250; // ms
const kWorkTime = 0.004; // s of a frame or message, for blueprints that have come

export interface ConnectionEnd {
  retryAt: number | null; // page's clock, s; null: no automatic retry
}

export class Connection {
  client: Client | null = null;
  end: ConnectionEnd | null = null;
  // Not null: the server asks for a password or an invite. What it has refused, such as "password"; empty: it was shown
  // nothing.
  refused: string | null = null;
  lostReason = ''; // why the connection before ended, until the next one plays; empty: there was none
  ping = 0; // s, round trip to the server
  name: string;
  world = ''; // its name at the gateway; empty: the gateway's first
  missing = ''; // name that the address asks for and the gateway does not have; nothing is joined then
  hasPlayed = false; // since the page, or the player, began to join
  // Called with a new client; the previous one must no longer be used.
  onClient: (client: Client) => void = () => {};

  private readonly m_module: WobbleModule;
  private readonly m_isSpectator: boolean;
  private readonly m_access = new Access();
  private readonly m_kept = new KeptBlueprints();
  private m_joins = 0;
  private m_socket: WebSocket | null = null;
  private m_lanes: Lanes | null = null;
  private m_tries = 0;
  private m_lostAt: number | null = null; // of the first loss that kGoodFor has not made good
  private m_playingSince: number | null = null;
  private m_nextPing = 0;
  private m_heardAt = 0; // the page's clock, s
  private readonly m_pingMessage = new Uint8Array([kPingChannel, 0, 0, 0, 0]);
  private m_pingNumber = 0;
  private m_pingSent = 0;
  private m_closeReason = '';
  private m_closeCode = 0;

  constructor(module: WobbleModule, name: string, isSpectator: boolean) {
    this.m_module = module;
    this.name = name;
    this.m_isSpectator = isSpectator;
    setInterval(() => this.Update(), kTimer);
  }

  // Leaves the present connection first.
  Join(): void {
    this.Drop();
    this.end = null;
    this.m_closeReason = '';
    this.m_closeCode = 0;
    this.refused = null;
    this.m_playingSince = null;
    const join = ++this.m_joins;
    void this.m_kept.Load(this.world).then((kept) => {
      if (join === this.m_joins) this.Begin(kept);
    });
  }

  JoinAgain(): void {
    this.ForgetLosses();
    this.lostReason = '';
    this.hasPlayed = false;
    this.Join();
  }

  JoinWithPassword(password: string): void {
    this.m_access.UsePassword(this.world, password);
    this.JoinAgain();
  }

  // From the next join to this world on; see access.ts.
  Show(subprotocol: string): void {
    this.m_access.Use(this.world, subprotocol);
  }

  // Seconds since the server was last heard. The gateway answers pings by itself.
  FindSilence(): number {
    return ReadNow() - this.m_heardAt;
  }

  // Says goodbye at once; for the closing of the page.
  Leave(): void {
    if (this.client === null) return;
    this.client.Leave();
    this.SendOutgoing();
    this.CloseSockets();
  }

  Update(): void {
    const client = this.client;
    if (client === null) return;
    const now = ReadNow();
    if (this.end !== null) {
      if (this.end.retryAt !== null && now >= this.end.retryAt) this.Join();
      return;
    }
    client.Update();
    for (const until = now + kWorkTime; client.IsCompleting() && ReadNow() < until;) client.Update();
    for (let each = client.TakeDownload(); each !== null; each = client.TakeDownload()) {
      this.m_kept.Keep(this.world, each);
    }
    this.SendOutgoing();
    if (client.IsCloseAsked()) this.CloseSockets();
    const state = client.ReadState();
    if (state === State.Playing) this.NotePlaying(now);
    if (state === State.Ended) this.NoteEnd(client, now);
  }

  private Begin(kept: readonly Uint8Array[]): void {
    const client = new Client(this.m_module, this.name, this.m_isSpectator, kept);
    this.client = client;
    this.OpenSocket(client);
    this.onClient(client);
  }

  private OpenSocket(client: Client): void {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const path = this.world === '' ? '/play' : `/play/${encodeURIComponent(this.world)}`;
    const protocol = `wobble.${this.m_module._ReadProtocolVersion()}`;
    const credential = this.m_access.Choose(this.world);
    const protocols = credential === null ? [protocol] : [protocol, credential];
    const socket = new WebSocket(`${scheme}://${location.host}${path}`, protocols);
    socket.binaryType = 'arraybuffer';
    this.m_socket = socket;
    const isCurrent = () => this.client === client && this.end === null;
    socket.onopen = () => {
      if (!isCurrent()) return;
      client.OpenSocket();
      this.Update();
    };
    socket.onmessage = (event) => {
      if (!isCurrent() || !(event.data instanceof ArrayBuffer)) return;
      this.Receive(client, new Uint8Array(event.data));
      this.Update();
    };
    socket.onclose = (event) => {
      if (!isCurrent()) return;
      this.m_closeReason = event.reason;
      this.m_closeCode = event.code;
      client.CloseSocket();
      this.Update();
    };
  }

  private Receive(client: Client, message: Uint8Array): void {
    if (message[0] === kTicketChannel) {
      this.m_access.NoteTicket(this.world, message.subarray(1));
      return;
    }
    if (message[0] === kLaneChannel) {
      this.OpenLanes(client, Encode(message.subarray(1)));
      return;
    }
    if (message[0] !== kPingChannel) {
      this.m_heardAt = ReadNow();
      client.ReceiveMessage(message);
      return;
    }
    if (message.length !== kPingBytes || message[1] !== this.m_pingNumber) return;
    this.ping = ReadNow() - this.m_pingSent + (message[5] + 256 * message[6]) / 1000;
    client.SetRoundTrip(this.ping);
  }

  private OpenLanes(client: Client, key: string): void {
    const first = this.m_socket;
    if (first === null || this.m_lanes !== null) return;
    this.m_lanes = new Lanes(first, `more.${key}`, (message) => {
      if (this.client !== client || this.end !== null) return;
      this.m_heardAt = ReadNow();
      client.ReceiveMessage(message);
      this.Update();
    });
  }

  private SendOutgoing(): void {
    const socket = this.m_socket;
    this.client?.SendOutgoing((message) => {
      const chosen = this.m_lanes?.Choose(message) ?? socket;
      if (chosen?.readyState === WebSocket.OPEN) chosen.send(message as Uint8Array<ArrayBuffer>);
    });
  }

  private NotePlaying(now: number): void {
    this.m_playingSince ??= now;
    this.hasPlayed = true;
    this.lostReason = '';
    if (now - this.m_playingSince > kGoodFor) this.ForgetLosses();
    if (now < this.m_nextPing || this.m_socket?.readyState !== WebSocket.OPEN) return;
    this.m_nextPing = now + kPingEvery;
    this.m_pingNumber = (this.m_pingNumber + 1) % 256;
    this.m_pingMessage[1] = this.m_pingNumber;
    this.m_pingSent = now;
    this.m_socket.send(this.m_pingMessage);
  }

  private NoteEnd(client: Client, now: number): void {
    const reason = this.m_closeReason !== '' ? this.m_closeReason : client.ReadEndReason();
    this.lostReason = reason !== '' ? reason : 'the connection was lost';
    this.m_lostAt ??= now;
    const wait = Math.min(kFirstWait * 2 ** this.m_tries, kLongestWait) * (1 - Math.random() / 2);
    this.m_tries += 1;
    if (this.m_closeCode === kCredentialRefused) {
      this.refused = this.m_access.NoteRefused(this.world);
      this.end = { retryAt: this.refused === null ? now : null };
    } else {
      const isFinal = this.m_closeCode === kRefusedForGood || !client.MayRejoin();
      this.end = { retryAt: isFinal || now >= this.m_lostAt + kPatience ? null : now + wait };
    }
    this.CloseSockets();
  }

  private CloseSockets(): void {
    this.m_socket?.close(1000);
    this.m_lanes?.Close();
    this.m_lanes = null;
  }

  private ForgetLosses(): void {
    this.m_tries = 0;
    this.m_lostAt = null;
  }

  private Drop(): void {
    if (this.client === null) return;
    if (this.end === null) this.Leave();
    this.client.Destroy();
    this.client = null;
  }
}
