// What the page shows to be let in: a secret from the address's fragment, a password that was typed, or the ticket of an
// earlier connection in this tab. Each is for one world and is shown to that world's server alone.
const kTicketKey = 'wobble-ticket:';
const kHexDigits = /^[0-9a-f]{64}$/i;

// base64url, as subprotocols have it.
export function Encode(bytes: Iterable<number>): string {
  const text = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  return btoa(text).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

// An owner's key as its file has it, in hexadecimal digits, as the bytes that they stand for.
function EncodeKey(digits: string): string {
  return Encode(digits.match(/../g)!.map((pair) => parseInt(pair, 16)));
}

// Takes the secret out of the address, so that it is not passed on with it or kept in the history. As a subprotocol;
// null: none.
export function TakeFragment(): string | null {
  const [, kind, secret] = /^#(invite|token|owner)=([\w-]+)$/.exec(location.hash) ?? [];
  if (kind === undefined || secret === undefined) return null;
  history.replaceState(null, '', location.pathname + location.search);
  return `${kind}.${kind === 'owner' && kHexDigits.test(secret) ? EncodeKey(secret) : secret}`;
}

export class Access {
  private readonly m_own = new Map<string, string>(); // by world, as a subprotocol
  private m_shown: 'nothing' | 'own' | 'ticket' = 'nothing';

  // Of these functions `world` is the name at the gateway; empty: its first.
  //
  // The WebSocket's subprotocol that says it; null: none.
  Choose(world: string): string | null {
    const ticket = ReadTicket(world);
    const own = this.m_own.get(world) ?? null;
    this.m_shown = ticket !== null ? 'ticket' : own !== null ? 'own' : 'nothing';
    return ticket !== null ? `token.${ticket}` : own;
  }

  // Shows this from now on instead of what was shown before.
  Use(world: string, subprotocol: string): void {
    WriteTicket(world, null);
    this.m_own.set(world, subprotocol);
  }

  UsePassword(world: string, password: string): void {
    this.Use(world, `password.${Encode(new TextEncoder().encode(password))}`);
  }

  // What was shown does not hold. The kind of it, such as "password"; empty: nothing was shown; null: it was a ticket,
  // and the next Choose says something else.
  NoteRefused(world: string): string | null {
    if (this.m_shown === 'ticket') {
      WriteTicket(world, null);
      return null;
    }
    const [kind] = (this.m_own.get(world) ?? '').split('.');
    this.m_own.delete(world);
    return kind;
  }

  NoteTicket(world: string, ticket: Uint8Array): void {
    WriteTicket(world, Encode(ticket));
  }
}

function ReadTicket(world: string): string | null {
  try {
    return sessionStorage.getItem(kTicketKey + world);
  } catch {
    return null; // without storage there are no tickets
  }
}

function WriteTicket(world: string, ticket: string | null): void {
  try {
    if (ticket === null) sessionStorage.removeItem(kTicketKey + world);
    else sessionStorage.setItem(kTicketKey + world, ticket);
  } catch {
    // Without storage the page comes back with what it was given.
  }
}
