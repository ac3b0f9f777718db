// A player's connection to a world: a WebSocket to a gateway, with a client; it reconnects when lost.
//
// A page in the background gets no frames and hardly any timers, but messages on its socket still wake it. The client
// is therefore updated with every message, and the connection stays alive while the server sends.
import { Access, encode, makeSubprotocol, type Credential } from './access.js';
import { Client, readNow } from './client.js';
import { KeptBlueprints } from './kept_blueprints.js';
import { Lanes } from './lanes.js';
import { kOpen, type Runtime, type Socket } from './runtime.js';
import { State } from './views.js';

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

export interface ConnectionOptions {
  /** the gateway's address, such as ws://localhost:8080, or that of its page */
  url: string;
  /** its name at the gateway; default: the gateway's first */
  world?: string;
  /** cut to 32 bytes */
  name?: string;
  /** watches without a body */
  spectate?: boolean;
}

export interface ConnectionEnd {
  /** by readNow, s; null: no automatic retry */
  retryAt: number | null;
}

export class Connection {
  /** The newest client, of which nothing but the last world is to be had after its end; null before the first. */
  client: Client | null = null;
  /** not null: there is no connection now */
  end: ConnectionEnd | null = null;
  /**
   * Not null: the server asks for a password or an invite. What it has refused, such as "password"; empty: it was shown
   * nothing.
   */
  refused: string | null = null;
  /** why the connection before ended, until the next one plays; empty: there was none */
  lostReason = '';
  /** s, round trip to the server */
  ping = 0;
  /** this and world: from the next join on; see rename */
  name: string;
  world: string;
  /** since the player began to join */
  hasPlayed = false;
  /** Called with a new client; the previous one must no longer be used. */
  onClient: (client: Client) => void = () => {};
  /** Called when the player plays, after each join. */
  onPlay: () => void = () => {};
  /** Called when a connection or a try to join has ended, except for a ticket that did not hold. */
  onEnd: (reason: string) => void = () => {};

  private readonly m_runtime: Runtime;
  private readonly m_base: URL;
  private readonly m_isSpectator: boolean;
  private readonly m_access = new Access();
  private readonly m_kept = new KeptBlueprints();
  private m_timer: ReturnType<typeof setInterval> | null = null;
  private m_joins = 0;
  private m_joined = ''; // address of the present join
  private m_socket: Socket | null = null;
  private m_lanes: Lanes | null = null;
  private m_tries = 0;
  private m_lostAt: number | null = null; // of the first loss that kGoodFor has not made good
  private m_playingSince: number | null = null;
  private m_nextPing = 0;
  private m_heardAt = 0; // by readNow, s
  private readonly m_pingMessage = new Uint8Array([kPingChannel, 0, 0, 0, 0]);
  private m_pingNumber = 0;
  private m_pingSent = 0;
  private m_closeReason = '';
  private m_closeCode = 0;

  /** Throws TypeError for a wrong url. */
  constructor(runtime: Runtime, options: ConnectionOptions) {
    this.m_runtime = runtime;
    this.m_base = parseGateway(options.url);
    this.world = options.world ?? '';
    this.name = options.name ?? '';
    this.m_isSpectator = options.spectate ?? false;
  }

  /** Where the present world is joined. */
  get address(): string {
    return new URL(this.world === '' ? 'play' : `play/${encodeURIComponent(this.world)}`, this.m_base).href;
  }

  /** The client while it plays, else null. */
  get playing(): Client | null {
    return this.end === null && this.client?.readState() === State.Playing ? this.client : null;
  }

  /** Leaves the present connection first. */
  join(): void {
    this.drop();
    this.m_timer ??= setInterval(() => this.update(), kTimer);
    this.end = null;
    this.m_closeReason = '';
    this.m_closeCode = 0;
    this.refused = null;
    this.m_playingSince = null;
    this.m_joined = this.address;
    const join = ++this.m_joins;
    void this.m_kept.load(this.m_joined).then((kept) => {
      if (join === this.m_joins) this.begin(kept);
    });
  }

  joinAgain(): void {
    this.forgetLosses();
    this.lostReason = '';
    this.hasPlayed = false;
    this.join();
  }

  /** Another name of the player, now and from now on. */
  rename(name: string): void {
    this.name = name;
    this.playing?.rename(name);
  }

  /** From the next join to the present world on. Throws TypeError. */
  show(credential: Credential): void {
    const subprotocol = makeSubprotocol(credential);
    if (subprotocol !== null) this.m_access.use(this.address, subprotocol);
  }

  /** Seconds since the server was last heard. The gateway answers pings by itself. */
  findSilence(): number {
    return readNow() - this.m_heardAt;
  }

  /** Says goodbye at once and stays away, until the next join. What wakes the connection by itself ends, too. */
  leave(): void {
    this.m_joins += 1; // one that has not begun yet does not begin
    if (this.m_timer !== null) clearInterval(this.m_timer);
    this.m_timer = null;
    if (this.end === null) {
      this.sayGoodbye();
      this.lostReason = 'left';
    }
    this.end = { retryAt: null };
  }

  /** Receives, answers and sends. A game calls it in each frame. */
  update(): void {
    const client = this.client;
    if (client === null) return;
    const now = readNow();
    if (this.end !== null) {
      if (this.end.retryAt !== null && now >= this.end.retryAt) this.join();
      return;
    }
    client.update();
    for (const until = now + kWorkTime; client.isCompleting() && readNow() < until;) client.update();
    for (let each = client.takeDownload(); each !== null; each = client.takeDownload()) {
      this.m_kept.keep(this.m_joined, each);
    }
    this.sendOutgoing();
    if (client.isCloseAsked()) this.closeSockets();
    const state = client.readState();
    if (state === State.Playing) this.notePlaying(now);
    if (state === State.Ended) this.noteEnd(client, now);
  }

  private begin(kept: readonly Uint8Array[]): void {
    const client = new Client(this.m_runtime.module, this.name, this.m_isSpectator, kept);
    this.client = client;
    this.openSocket(client);
    this.onClient(client);
  }

  private openSocket(client: Client): void {
    const protocol = `wobble.${this.m_runtime.module._ReadProtocolVersion()}`;
    const credential = this.m_access.choose(this.m_joined);
    const protocols = credential === null ? [protocol] : [protocol, credential];
    const socket = this.m_runtime.openSocket(this.m_joined, protocols);
    this.m_socket = socket;
    const isCurrent = () => this.client === client && this.end === null;
    socket.onopen = () => {
      if (!isCurrent()) return;
      client.openSocket();
      this.update();
    };
    socket.onmessage = (event) => {
      if (!isCurrent() || !(event.data instanceof ArrayBuffer)) return;
      this.receive(client, new Uint8Array(event.data));
      this.update();
    };
    // Node says here why; browsers say it to nobody. A close follows.
    socket.onerror = (event) => {
      if (isCurrent()) this.m_closeReason = event.message || event.error?.code || '';
    };
    socket.onclose = (event) => {
      if (!isCurrent()) return;
      if (event.reason !== '') this.m_closeReason = event.reason;
      this.m_closeCode = event.code;
      client.closeSocket();
      this.update();
    };
  }

  private receive(client: Client, message: Uint8Array): void {
    if (message[0] === kTicketChannel) {
      this.m_access.noteTicket(this.m_joined, message.subarray(1));
      return;
    }
    if (message[0] === kLaneChannel) {
      this.openLanes(client, encode(message.subarray(1)));
      return;
    }
    if (message[0] !== kPingChannel) {
      this.m_heardAt = readNow();
      client.receiveMessage(message);
      return;
    }
    if (message.length !== kPingBytes || message[1] !== this.m_pingNumber) return;
    this.ping = readNow() - this.m_pingSent + (message[5] + 256 * message[6]) / 1000;
    client.setRoundTrip(this.ping);
  }

  private openLanes(client: Client, key: string): void {
    const first = this.m_socket;
    if (first === null || this.m_lanes !== null) return;
    this.m_lanes = new Lanes(this.m_runtime, first, `more.${key}`, (message) => {
      if (this.client !== client || this.end !== null) return;
      this.m_heardAt = readNow();
      client.receiveMessage(message);
      this.update();
    });
  }

  private sendOutgoing(): void {
    const socket = this.m_socket;
    this.client?.sendOutgoing((message) => {
      const chosen = this.m_lanes?.choose(message) ?? socket;
      if (chosen?.readyState === kOpen) chosen.send(message);
    });
  }

  private notePlaying(now: number): void {
    const isFirst = this.m_playingSince === null;
    this.m_playingSince ??= now;
    this.hasPlayed = true;
    this.lostReason = '';
    if (isFirst) this.onPlay();
    if (now - this.m_playingSince > kGoodFor) this.forgetLosses();
    if (now < this.m_nextPing || this.m_socket?.readyState !== kOpen) return;
    this.m_nextPing = now + kPingEvery;
    this.m_pingNumber = (this.m_pingNumber + 1) % 256;
    this.m_pingMessage[1] = this.m_pingNumber;
    this.m_pingSent = now;
    this.m_socket.send(this.m_pingMessage);
  }

  private noteEnd(client: Client, now: number): void {
    const reason = this.m_closeReason !== '' ? this.m_closeReason : client.readEndReason();
    this.lostReason = reason !== '' ? reason : 'the connection was lost';
    this.m_lostAt ??= now;
    const wait = Math.min(kFirstWait * 2 ** this.m_tries, kLongestWait) * (1 - Math.random() / 2);
    this.m_tries += 1;
    if (this.m_closeCode === kCredentialRefused) {
      this.refused = this.m_access.noteRefused(this.m_joined);
      this.end = { retryAt: this.refused === null ? now : null };
    } else {
      const isFinal = this.m_closeCode === kRefusedForGood || !client.mayRejoin();
      this.end = { retryAt: isFinal || now >= this.m_lostAt + kPatience ? null : now + wait };
    }
    this.closeSockets();
    if (this.m_closeCode !== kCredentialRefused || this.refused !== null) this.onEnd(this.lostReason);
  }

  private closeSockets(): void {
    this.m_socket?.close(1000);
    this.m_lanes?.close();
    this.m_lanes = null;
  }

  private forgetLosses(): void {
    this.m_tries = 0;
    this.m_lostAt = null;
  }

  private drop(): void {
    if (this.end === null) this.sayGoodbye();
    this.client?.destroy();
    this.client = null;
  }

  private sayGoodbye(): void {
    if (this.client === null) return;
    this.client.leave();
    this.sendOutgoing();
    this.closeSockets();
  }
}

// The address below which the gateway's worlds are. Throws TypeError.
function parseGateway(address: string): URL {
  const schemes: Record<string, string> = { 'http:': 'ws:', 'https:': 'wss:', 'ws:': 'ws:', 'wss:': 'wss:' };
  let url: URL;
  try {
    url = new URL(address);
  } catch {
    throw new TypeError(`wobble-client: url: '${address}' is no address, such as ws://localhost:8080`);
  }
  const scheme = schemes[url.protocol];
  if (scheme === undefined) {
    throw new TypeError(`wobble-client: url: '${address}' is not of ws, wss, http or https`);
  }
  url.protocol = scheme;
  url.search = url.hash = '';
  url.pathname = url.pathname.replace(/\/*$/, '/');
  return url;
}
