// The link by which others come into this world, as text and as a code to scan. Browsers share and copy for pages of
// https and localhost alone; elsewhere the text is selected, to be copied by hand.
//
// The link of an ordinary player holds no secret. Who may make invites can put one into it: it lets in as a player, for
// a day, where the world does not let in everybody.
import { encode } from 'uqr';
import { Rank, type Welcome } from 'wobble-client';
import type { Offer } from '../worlds';
import { MakeButton, MakeElement, SetText } from './element';

const kOrder = 'invite player for 1d';
const kInvite = /^#invite=[\w-]+$/; // the line of the server's answer that goes into a link
const kMostLines = 2; // of the answer, up to the invite; a refusal has one
const kQuietModules = 4;
const kModulePixels = 6;

export class InvitePanel {
  readonly button: HTMLButtonElement;
  readonly element = MakeElement('dialog', 'card invite');
  onOrder: (line: string) => void = () => {};
  private readonly m_offer: Offer;
  private readonly m_code = MakeElement('canvas');
  private readonly m_link = MakeElement('input');
  private readonly m_note = MakeElement('p');
  private readonly m_share: HTMLButtonElement;
  private readonly m_copy: HTMLButtonElement;
  private readonly m_invite: HTMLButtonElement;
  private m_world = '';
  private m_secret = ''; // a fragment; empty: none
  private m_awaited = 0; // lines of the answer to the order

  constructor(offer: Offer) {
    this.m_offer = offer;
    this.button = MakeButton('Invite friends', 'Invite friends', '', () => this.Open());
    this.button.classList.add('invite-button');
    this.m_share = MakeButton('Share', 'Share the link', '', () => void this.Share());
    this.m_copy = MakeButton('Copy', 'Copy the link', '', () => void this.Copy());
    this.m_invite = MakeButton('Add an invite', 'Add an invite that lets in for a day', '', () => this.AskForInvite());
    this.Build();
  }

  // At the start of each connection.
  Clear(): void {
    this.m_secret = '';
    this.m_awaited = 0;
    this.m_invite.hidden = true;
    this.Show('');
  }

  Close(): void {
    this.element.close();
  }

  // world: its name at the gateway.
  Update(world: string, welcome: Welcome): void {
    this.m_world = world;
    this.m_invite.hidden = welcome.rank < Rank.Moderator;
  }

  // Whether it is part of an answer that this panel waits for.
  TakeNotice(text: string): boolean {
    if (this.m_awaited === 0) return false;
    this.m_awaited -= 1;
    if (!kInvite.test(text)) {
      this.Show(text);
      return true;
    }
    this.m_awaited = 0;
    this.m_secret = text;
    this.m_invite.hidden = true;
    this.Show('Whoever has this link comes in as a player, for a day.');
    return true;
  }

  private Build(): void {
    this.element.setAttribute('aria-label', 'Invite friends');
    this.m_code.setAttribute('role', 'img');
    this.m_code.setAttribute('aria-label', 'The link as a QR code');
    this.m_link.readOnly = true;
    this.m_link.setAttribute('aria-label', 'Link to this world');
    // Backwards, so that the field shows where the link begins.
    this.m_link.addEventListener('focus', () => this.m_link.setSelectionRange(0, this.m_link.value.length, 'backward'));
    this.m_note.setAttribute('role', 'status');
    this.m_share.hidden = typeof navigator.share !== 'function';
    this.m_copy.hidden = !window.isSecureContext || navigator.clipboard === undefined;
    const close = MakeButton('Close', 'Close', '', () => this.element.close());
    close.classList.add('main');
    const row = MakeElement('div', 'row');
    row.append(this.m_share, this.m_copy, this.m_invite, close);
    const words = MakeElement('div', 'rows');
    words.append(MakeElement('h1', '', 'Invite friends'), this.m_link, this.m_note, row);
    this.element.append(this.m_code, words);
    // The keys of the world do not act while it is open.
    this.element.addEventListener('keydown', (event) => event.stopPropagation());
  }

  Open(): void {
    this.Show(this.m_secret === '' ? Describe(this.m_offer) : '');
    this.element.showModal();
    this.m_link.focus();
  }

  private Show(note: string): void {
    const link = MakeLink(this.m_offer, this.m_world, this.m_secret);
    if (this.m_link.value !== link) {
      this.m_link.value = link;
      DrawCode(this.m_code, link);
    }
    SetText(this.m_note, note);
  }

  private AskForInvite(): void {
    this.m_awaited = kMostLines;
    this.onOrder(kOrder);
  }

  private async Share(): Promise<void> {
    try {
      await navigator.share({ title: document.title, url: this.m_link.value });
    } catch {
      this.m_link.focus(); // the player has thought better of it, or nothing takes links
    }
  }

  private async Copy(): Promise<void> {
    try {
      await navigator.clipboard.writeText(this.m_link.value);
      SetText(this.m_note, 'Copied.');
    } catch {
      this.m_link.focus();
      SetText(this.m_note, 'The browser does not let this page copy: copy the marked text.');
    }
  }
}

function IsOwnMachine(): boolean {
  return /^(localhost|127\..*|\[::1\])$/.test(location.hostname);
}

function Describe(offer: Offer): string {
  if (IsOwnMachine() && offer.addresses.length === 0) return 'This link works on this machine alone.';
  return 'Open it or scan the code to come into this world.';
}

// To others "localhost" is their own machine, so there the link has this machine's address in its network.
function MakeLink(offer: Offer, world: string, secret: string): string {
  const link = new URL(location.origin + location.pathname);
  const [address] = offer.addresses;
  if (IsOwnMachine() && address !== undefined) link.hostname = address.includes(':') ? `[${address}]` : address;
  if (world !== '' && (offer.worlds.length > 1 || offer.recordings !== null)) link.searchParams.set('world', world);
  link.hash = secret;
  return link.href;
}

function DrawCode(canvas: HTMLCanvasElement, text: string): void {
  const { size, data } = encode(text, { ecc: 'L', border: kQuietModules });
  canvas.width = canvas.height = size * kModulePixels;
  const context = canvas.getContext('2d')!;
  context.fillStyle = '#fff';
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = '#000';
  data.forEach((row, y) =>
    row.forEach((isDark, x) => {
      if (isDark) context.fillRect(x * kModulePixels, y * kModulePixels, kModulePixels, kModulePixels);
    }),
  );
}
