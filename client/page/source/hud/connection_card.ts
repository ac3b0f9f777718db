// The card in the middle while there is no world: joining, or the reason why the page is not in or no longer in, whether
// it is joining again by itself, and a button to do it; or that the address names a world that is not here.
import { State, type Connection } from 'wobble-client';
import { MakeButton, MakeElement, SetText } from './element';

const kMostShown = 40; // characters of a name that the address invents

export class ConnectionCard {
  readonly element = MakeElement('div', 'veil');
  private readonly m_ball = MakeElement('div', 'ball');
  private readonly m_title = MakeElement('h1');
  private readonly m_text = MakeElement('p');
  private readonly m_button: HTMLButtonElement;
  private readonly m_form = MakeElement('form', 'password');

  private readonly m_first: HTMLButtonElement;

  // first: the world to go to in place of one that is not here.
  constructor(
    first: string,
    onJoin: () => void,
    onFirst: (world: string) => void,
    onPassword: (password: string) => void,
  ) {
    const card = MakeElement('div', 'card');
    card.setAttribute('role', 'status');
    this.m_button = MakeButton('Join again', 'Join again', '', onJoin);
    this.m_button.classList.add('main');
    this.m_first = MakeButton(`Play ${first}`, `Go to ${first}`, '', () => onFirst(first));
    this.m_first.classList.add('main');
    const field = MakeElement('input');
    field.type = 'password';
    field.required = true;
    field.autocomplete = 'current-password';
    field.setAttribute('aria-label', 'Password');
    const enter = MakeElement('button', 'main', 'Enter');
    enter.type = 'submit';
    this.m_form.append(field, enter);
    this.m_form.addEventListener('submit', (event) => {
      event.preventDefault();
      onPassword(field.value);
      field.value = '';
    });
    card.append(this.m_ball, this.m_title, this.m_text, this.m_form, this.m_button, this.m_first);
    this.element.append(card);
  }

  // missing: name of a world that is not here; empty: it is.
  Update(connection: Connection, missing: string): void {
    const { client, end, lostReason, refused } = connection;
    this.element.hidden = connection.playing !== null;
    this.m_form.hidden = refused === null;
    this.m_button.hidden = lostReason === '' || refused !== null;
    this.m_ball.hidden = missing !== '' || (end !== null && end.retryAt === null);
    this.m_first.hidden = missing === '';
    if (missing !== '') {
      SetText(this.m_title, 'No such world');
      SetText(this.m_text, `“${missing.slice(0, kMostShown)}” is not among the worlds of this page.`);
      return;
    }
    if (lostReason === '') {
      SetText(this.m_title, 'Joining…');
      SetText(this.m_text, client?.readState() === State.Joining ? 'Loading the world' : 'Connecting to the server');
      return;
    }
    if (refused !== null) {
      SetText(this.m_title, 'This world asks for a password');
      const first = refused === '' ? 'Enter it' : `That ${refused} does not hold. Enter another one`;
      SetText(this.m_text, `${first}, or open the invite that you were sent.`);
      return;
    }
    SetText(this.m_title, connection.hasPlayed ? 'Connection ended' : 'Could not join');
    const isOver = end !== null && end.retryAt === null;
    SetText(this.m_text, isOver ? MakeSentence(lostReason) : `${MakeSentence(lostReason)} Joining again…`);
  }
}

function MakeSentence(text: string): string {
  const end = /[.!?]$/.test(text) ? '' : '.';
  return text.charAt(0).toUpperCase() + text.slice(1) + end;
}
