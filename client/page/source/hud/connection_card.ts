// The card in the middle while there is no world: what has happened, and what the player can do next.
import { State, type Connection, type ConnectionEnd } from 'wobble-client';
import { FindIsOld } from '../page_age';
import { FindDetail, FindStay, Stay } from '../stay';
import { MakeButton, MakeElement, SetText } from './element';

const kMostShown = 40; // characters of a name that the address invents
const kMostOthers = 6; // worlds

interface Words {
  title: string;
  happened: string;
  next: string; // what to do; empty: nothing but to wait
}

export interface CardActions {
  onJoin: () => void;
  onWorld: (world: string) => void;
  onPassword: (password: string) => void;
}

export class ConnectionCard {
  readonly element = MakeElement('div', 'veil');
  private readonly m_ball = MakeElement('div', 'ball');
  private readonly m_title = MakeElement('h1');
  private readonly m_happened = MakeElement('p');
  private readonly m_next = MakeElement('p');
  private readonly m_join: HTMLButtonElement;
  private readonly m_reload: HTMLButtonElement;
  private readonly m_others = MakeElement('div', 'row others');
  private readonly m_form = MakeElement('form', 'password');
  private readonly m_worlds: string[];
  private readonly m_onWorld: (world: string) => void;
  private m_listedFor: string | null = null;
  private m_asked: ConnectionEnd | null = null; // end after which the page's age was asked
  private m_isOld = false;
  stay = Stay.Connecting;

  // worlds: those of this gateway.
  constructor(worlds: string[], { onJoin, onWorld, onPassword }: CardActions) {
    this.m_worlds = worlds;
    this.m_onWorld = onWorld;
    const card = MakeElement('div', 'card');
    const words = MakeElement('div');
    words.setAttribute('role', 'status');
    words.append(this.m_title, this.m_happened, this.m_next);
    this.m_join = MakeButton('Join again', 'Join again', '', onJoin);
    this.m_reload = MakeButton('Load the page again', 'Load the page again', '', () => location.reload());
    for (const button of [this.m_join, this.m_reload]) button.classList.add('main');
    this.BuildForm(onPassword);
    card.append(this.m_ball, words, this.m_form, this.m_join, this.m_reload, this.m_others);
    // Until the first frame, which may be a second away.
    this.m_form.hidden = this.m_join.hidden = this.m_reload.hidden = this.m_others.hidden = true;
    this.element.append(card);
  }

  // missing: name of a world that is not here; empty: it is.
  Update(connection: Connection, missing: string): void {
    const { client, end, lostReason, refused } = connection;
    const isEntering = client?.readState() === State.Joining;
    const isPlaying = connection.playing !== null;
    const standing = { isPlaying, isEntering, hasPlayed: connection.hasPlayed, lostReason, refused };
    this.AskAge(end, isPlaying);
    this.stay = FindStay(standing, missing, this.m_isOld);
    this.element.hidden = this.stay === Stay.Playing;
    if (this.element.hidden) return;
    const isIn = this.stay === Stay.Connecting || this.stay === Stay.Entering;
    const isOld = this.stay === Stay.OtherVersion; // another try does not help
    const isOut = !isIn && !isOld && this.stay !== Stay.NoSuchWorld && this.stay !== Stay.Password;
    const tries = isIn || (isOut && (end === null || end.retryAt !== null));
    this.m_ball.hidden = !tries;
    this.m_form.hidden = this.stay !== Stay.Password;
    this.m_join.hidden = !isOut;
    this.m_reload.hidden = !isOld;
    this.ListOthers(isIn ? null : missing !== '' ? missing : connection.world);
    const { title, happened, next } = this.Describe(connection, missing);
    SetText(this.m_title, title);
    SetText(this.m_happened, happened);
    SetText(this.m_next, isOut && tries ? `${next} This page tries again by itself.`.trim() : next);
    this.m_next.hidden = this.m_next.textContent === '';
  }

  // After each try that fails: a gateway that is renewed answers nobody for a while.
  private AskAge(end: ConnectionEnd | null, isPlaying: boolean): void {
    if (isPlaying) this.m_isOld = false;
    if (end === null || end === this.m_asked) return;
    this.m_asked = end;
    void FindIsOld().then((isOld) => (this.m_isOld = isOld ?? this.m_isOld));
  }

  private Describe({ lostReason, refused, hasPlayed }: Connection, missing: string): Words {
    const detail = FindDetail(lostReason);
    switch (this.stay) {
      case Stay.Playing:
      case Stay.Connecting:
        return { title: 'Joining…', happened: 'Connecting', next: '' };
      case Stay.Entering:
        return { title: 'Joining…', happened: 'Waiting for the server', next: '' };
      case Stay.NoSuchWorld: {
        const happened = `“${missing.slice(0, kMostShown)}” is not among the worlds of this page.`;
        return { title: 'No such world', happened, next: 'Choose one that is here.' };
      }
      case Stay.Password: {
        const hasShown = refused !== null && refused !== '';
        const happened = hasShown ? `That ${refused} does not hold, or too many were tried from your address.` : '';
        const what = hasShown ? 'Wait 5 s and enter another one' : 'Enter it';
        const next = `${what}, or open the invite that you were sent.`;
        return { title: 'This world asks for a password', happened, next };
      }
      case Stay.Full:
        return {
          title: 'The world is full',
          happened: MakeSentence(detail !== '' ? detail : lostReason),
          next: 'You come in when somebody leaves.',
        };
      case Stay.Locked:
        return { title: 'The world is locked', happened: 'Its host lets nobody in at present.', next: '' };
      case Stay.Busy:
        return { title: 'The server is busy', happened: 'Its machine has no time for more players.', next: '' };
      case Stay.NotAnswering:
        return {
          title: 'The server does not answer',
          happened: navigator.onLine ? 'It may be off, or just about to start.' : 'This device has no network.',
          next: '',
        };
      case Stay.Closing:
        return { title: 'The server has closed', happened: 'It said goodbye; it may come back.', next: '' };
      case Stay.Silent:
      case Stay.Lost: {
        const happened = navigator.onLine ? MakeSentence(lostReason) : 'This device has no network.';
        return { title: 'The connection is lost', happened, next: '' };
      }
      case Stay.Kicked:
        return {
          title: 'You were sent away',
          happened: detail === '' ? 'A moderator removed you.' : `A moderator removed you: “${detail}”.`,
          next: 'You may come back.',
        };
      case Stay.Banned:
        return {
          title: 'You are banned here',
          happened: `This world lets you in no more${detail === '' ? '' : `: “${detail}”`}.`,
          next: 'Only its host can change that.',
        };
      case Stay.TooManyFromAddress:
        return {
          title: 'Too many from your address',
          happened: 'The server lets in only so many players from one network.',
          next: 'Come in when one of them has left.',
        };
      case Stay.OtherVersion:
        return {
          title: 'This page is out of date',
          happened: 'The server speaks another version.',
          next: 'Load the page again. If that does not help, its host has to update it.',
        };
      case Stay.GatewayRefused:
        return {
          title: 'The server refuses this page',
          happened: MakeSentence(lostReason),
          next: 'Its host can read in the log of the gateway how to mend that.',
        };
      case Stay.PoorLine:
        return {
          title: 'Your connection is too poor',
          happened: MakeSentence(lostReason),
          next: 'Come nearer to your router, or use another network.',
        };
      case Stay.CutOff:
        return { title: 'The server hung up', happened: MakeSentence(lostReason), next: '' };
      case Stay.Refused:
        return {
          title: hasPlayed ? 'The visit has ended' : 'Could not join',
          happened: MakeSentence(lostReason),
          next: '',
        };
    }
  }

  private BuildForm(onPassword: (password: string) => void): void {
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
  }

  // Buttons to the other worlds. except: the present one; null: no buttons.
  private ListOthers(except: string | null): void {
    if (except === this.m_listedFor) return;
    this.m_listedFor = except;
    const others = except === null ? [] : this.m_worlds.filter((world) => world !== except).slice(0, kMostOthers);
    const make = (world: string) => MakeButton(`Go to ${world}`, `Go to ${world}`, '', () => this.m_onWorld(world));
    this.m_others.replaceChildren(...others.map(make));
    this.m_others.hidden = others.length === 0;
  }
}

function MakeSentence(text: string): string {
  const end = /[.!?]$/.test(text) ? '' : '.';
  return text.charAt(0).toUpperCase() + text.slice(1) + end;
}
