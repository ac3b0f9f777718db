// What the page shows to be let in: an invite or a token from the address's fragment, a password that was typed, or the
// ticket of an earlier connection in this tab.
const kTicketKey = 'wobble-ticket:';

function Encode(bytes: Uint8Array): string {
  const text = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  return btoa(text).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

// Takes the secret out of the address, so that it is not passed on with it or kept in the history.
function TakeFragment(): string {
  const [, kind, secret] = /^#(invite|token)=([\w-]+)$/.exec(location.hash) ?? [];
  if (kind === undefined || secret === undefined) return '';
  history.replaceState(null, '', location.pathname + location.search);
  return `${kind}.${secret}`;
}

export class Access {
  private m_own = TakeFragment(); // as a subprotocol; empty: nothing to show
  private m_world = '';

  // The WebSocket's subprotocol that says it, for this world; null: none.
  Choose(world: string): string | null {
    this.m_world = world;
    const ticket = this.ReadTicket();
    if (ticket !== null) return `token.${ticket}`;
    return this.m_own === '' ? null : this.m_own;
  }

  UsePassword(password: string): void {
    this.m_own = `password.${Encode(new TextEncoder().encode(password))}`;
  }

  // What was shown does not hold. False: there is nothing else to show.
  NoteRefused(): boolean {
    if (this.ReadTicket() !== null) {
      this.WriteTicket(null);
      return true;
    }
    this.m_own = '';
    return false;
  }

  NoteTicket(ticket: Uint8Array): void {
    this.WriteTicket(Encode(ticket));
  }

  private ReadTicket(): string | null {
    try {
      return sessionStorage.getItem(kTicketKey + this.m_world);
    } catch {
      return null; // without storage there are no tickets
    }
  }

  private WriteTicket(ticket: string | null): void {
    try {
      if (ticket === null) sessionStorage.removeItem(kTicketKey + this.m_world);
      else sessionStorage.setItem(kTicketKey + this.m_world, ticket);
    } catch {
      // Without storage the page comes back with what it was given.
    }
  }
}
