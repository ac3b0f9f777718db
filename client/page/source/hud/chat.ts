// What players say: the newest lines, which fade, and a field to say one. All text is shown as text, never as markup.
import { MakeOwnColour, MakePlayerColour } from '../scene/colours';
import type { Players } from '../players';
import { MakeElement } from './element';

const kMostKept = 40;
const kShownFor = 12; // s; all lines are shown again while one is written
const kMostBytes = 200;

export class Chat {
  readonly lines = MakeElement('ol', 'lines');
  readonly field = MakeElement('form', 'say');
  onSay: (text: string) => void = () => {};
  // With whether the field is open now.
  onOpen: (isOpen: boolean) => void = () => {};
  private readonly m_input = MakeElement('input', 'name-field');

  constructor() {
    this.lines.setAttribute('role', 'log');
    this.lines.setAttribute('aria-label', 'What players say');
    this.m_input.setAttribute('aria-label', 'Say a line to all');
    this.m_input.placeholder = 'Say a line to all';
    this.m_input.maxLength = kMostBytes;
    this.m_input.autocomplete = 'off';
    this.m_input.enterKeyHint = 'send';
    const send = MakeElement('button', '', 'Send');
    this.field.append(this.m_input, send);
    this.field.addEventListener('submit', (event) => {
      event.preventDefault();
      const text = CutText(this.m_input.value);
      if (text !== '') this.onSay(text);
      this.Close();
    });
    this.m_input.addEventListener('keydown', (event) => {
      event.stopPropagation();
      if (event.key === 'Escape') this.Close();
    });
    this.field.hidden = true;
  }

  get isOpen(): boolean {
    return !this.field.hidden;
  }

  Open(): void {
    this.field.hidden = false;
    this.lines.classList.add('all');
    this.lines.scrollTop = this.lines.scrollHeight;
    this.m_input.focus();
    this.onOpen(true);
  }

  Close(): void {
    this.m_input.value = '';
    this.m_input.blur();
    this.field.hidden = true;
    this.lines.classList.remove('all');
    this.onOpen(false);
  }

  Add(clientId: number, text: string, players: Players): void {
    const body = players.all.get(clientId)?.body ?? 0;
    const colour = clientId === players.ownClient ? MakeOwnColour() : MakePlayerColour(body);
    const name = MakeElement('b', '', players.FindName(clientId));
    name.style.setProperty('--player', `#${colour.getHexString()}`);
    this.Append(name, ' ', MakeElement('span', '', text));
  }

  // A line of the server.
  AddNote(text: string): void {
    this.Append(MakeElement('i', '', text));
  }

  private Append(...parts: (Node | string)[]): void {
    const line = MakeElement('li');
    line.append(...parts);
    this.lines.append(line);
    while (this.lines.childElementCount > kMostKept) this.lines.firstElementChild!.remove();
    setTimeout(() => line.classList.add('old'), 1000 * kShownFor);
    this.lines.scrollTop = this.lines.scrollHeight;
  }

  Clear(): void {
    this.lines.replaceChildren();
  }
}

// Cut to what the protocol carries, at a whole character.
export function CutText(text: string): string {
  const encoder = new TextEncoder();
  let left = kMostBytes;
  let cut = '';
  for (const character of text.trim()) {
    left -= encoder.encode(character).length;
    if (left < 0) break;
    cut += character;
  }
  return cut;
}
