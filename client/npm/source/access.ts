// What a player shows to be let in: a secret of its own, or the ticket of an earlier connection. Each is for one world,
// named here by the address at which it is joined, and is shown to that world's server alone. A browser's tab keeps its
// tickets when the page is loaded anew.
const kTicketKey = 'wobble-ticket:';
const kKinds = ['token', 'invite', 'password', 'ownerKey'] as const;

/** One of them, or none. */
export interface Credential {
  /** as `wobble token` prints it */
  token?: string;
  /** as the server's administration prints it */
  invite?: string;
  password?: string;
  /** as its file has it: 64 hexadecimal digits, or base64url */
  ownerKey?: string;
}

/** base64url, as subprotocols have it. */
export function encode(bytes: Iterable<number>): string {
  const text = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  return btoa(text).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

/** The WebSocket's subprotocol that shows it; null: none is given. Throws TypeError. */
export function makeSubprotocol(credential: Credential): string | null {
  const [kind, ...others] = kKinds.filter((each) => credential[each] !== undefined);
  if (kind === undefined) return null;
  if (others.length > 0) throw new TypeError(`wobble-client: ${kind} and ${others[0]}: only one can be shown`);
  const secret = credential[kind]!;
  if (secret === '') throw new TypeError(`wobble-client: ${kind} is empty`);
  if (kind === 'password') return `password.${encode(new TextEncoder().encode(secret))}`;
  if (!/^[\w-]+$/.test(secret)) throw new TypeError(`wobble-client: ${kind}: only letters, digits, - and _`);
  if (kind !== 'ownerKey') return `${kind}.${secret}`;
  const isHex = /^[0-9a-f]{64}$/i.test(secret);
  return `owner.${isHex ? encode(secret.match(/../g)!.map((digits) => parseInt(digits, 16))) : secret}`;
}

export class Access {
  private readonly m_own = new Map<string, string>(); // by address, as a subprotocol
  private readonly m_tickets = new Map<string, string>(); // by address
  private m_shown: 'nothing' | 'own' | 'ticket' = 'nothing';

  /** The subprotocol that says it; null: none. */
  choose(address: string): string | null {
    const ticket = this.readTicket(address);
    const own = this.m_own.get(address) ?? null;
    this.m_shown = ticket !== null ? 'ticket' : own !== null ? 'own' : 'nothing';
    return ticket !== null ? `token.${ticket}` : own;
  }

  /** Shows this from now on instead of what was shown before. */
  use(address: string, subprotocol: string): void {
    this.writeTicket(address, null);
    this.m_own.set(address, subprotocol);
  }

  /**
   * What was shown does not hold. The kind of it, such as "password"; empty: nothing was shown; null: it was a ticket,
   * and the next choose says something else.
   */
  noteRefused(address: string): string | null {
    if (this.m_shown === 'ticket') {
      this.writeTicket(address, null);
      return null;
    }
    const [kind] = (this.m_own.get(address) ?? '').split('.');
    this.m_own.delete(address);
    return kind;
  }

  noteTicket(address: string, ticket: Uint8Array): void {
    this.writeTicket(address, encode(ticket));
  }

  private readTicket(address: string): string | null {
    const known = this.m_tickets.get(address);
    if (known !== undefined) return known;
    try {
      return sessionStorage.getItem(kTicketKey + address);
    } catch {
      return null; // there is no storage
    }
  }

  private writeTicket(address: string, ticket: string | null): void {
    if (ticket === null) this.m_tickets.delete(address);
    else this.m_tickets.set(address, ticket);
    try {
      if (ticket === null) sessionStorage.removeItem(kTicketKey + address);
      else sessionStorage.setItem(kTicketKey + address, ticket);
    } catch {
      // There is no storage.
    }
  }
}
