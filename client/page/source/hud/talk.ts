// What players tell one another, at the left: lines, the field to say one, emotes, and the switch of the sound.
import type { PerspectiveCamera } from 'three';
import { EventKind, Rank, readNow, Talk, type Client, type Welcome, type WorldEvent } from 'wobble-client';
import type { Players } from '../players';
import { Chat } from './chat';
import { MakeButton, MakeElement } from './element';
import { Emotes } from './emotes';

const kAnswerTime = 1.5; // s behind an order in which notices are its answer

export class TalkPanel {
  readonly element = MakeElement('section', 'talk');
  readonly chat = new Chat();
  private readonly m_emotes: Emotes;
  private readonly m_say: HTMLButtonElement;
  private readonly m_order: HTMLButtonElement; // in place of the other, where nobody says lines
  private readonly m_emote: HTMLButtonElement;
  private m_may = 0; // bits of Talk
  private m_mayOrder = false;
  private m_answersUntil = 0; // s

  // labels: the element over the world. sound: its switch. find: the client while it plays.
  constructor(labels: HTMLElement, sound: HTMLElement, find: () => Client | null) {
    this.element.setAttribute('aria-label', 'Talk');
    this.m_emotes = new Emotes(labels);
    this.chat.onSay = (text) => this.Send(text, find());
    this.m_emotes.onChoose = (kind) => find()?.emote(kind);
    this.m_say = MakeButton('Say', 'Say a line to all', 'T', () => this.Say());
    this.m_order = MakeButton('Order', 'Give an order, such as /help', 'T', () => this.Say());
    this.m_emote = MakeButton('Emote', 'Show an emote', 'Q', () => this.ShowEmotes());
    const bar = MakeElement('div', 'bar');
    bar.append(this.m_say, this.m_order, this.m_emote, sound);
    this.chat.onOpen = (isOpen) => (bar.hidden = isOpen);
    this.element.append(this.chat.lines, this.m_emotes.row, this.chat.field, bar);
    this.Begin(null);
  }

  // welcome: of another world; null: there is none.
  Begin(welcome: Welcome | null): void {
    this.m_may = welcome?.talk ?? 0;
    // Who plays may show emotes.
    this.m_mayOrder = (this.m_may & Talk.Emote) !== 0 || (welcome?.rank ?? Rank.Watcher) >= Rank.Moderator;
    this.m_say.hidden = !this.MaySay();
    this.m_order.hidden = this.MaySay() || !this.m_mayOrder;
    this.m_emote.hidden = (this.m_may & Talk.Emote) === 0;
    this.m_emotes.row.hidden = true;
    this.m_emotes.Clear();
    if (!this.HasField()) this.chat.Close();
  }

  Say(): void {
    if (this.HasField()) this.chat.Open();
  }

  // A notice that answers an order is shown among the lines.
  TakeNotice(text: string): boolean {
    if (readNow() > this.m_answersUntil) return false;
    this.chat.AddNote(text);
    return true;
  }

  ShowEmotes(): void {
    if ((this.m_may & Talk.Emote) !== 0) this.m_emotes.row.hidden = !this.m_emotes.row.hidden;
  }

  Close(): void {
    this.m_emotes.row.hidden = true;
  }

  // Whether the number key, from 0, is of an emote now.
  TakeNumber(number: number): boolean {
    return !this.m_emotes.row.hidden && this.m_emotes.Choose(number);
  }

  private MaySay(): boolean {
    return (this.m_may & Talk.Say) !== 0;
  }

  private HasField(): boolean {
    return this.m_mayOrder || this.MaySay();
  }

  // A line that begins with / is an order to the server.
  private Send(text: string, client: Client | null): void {
    if (!text.startsWith('/')) {
      if (this.MaySay()) client?.say(text);
      else this.chat.AddNote('Nobody says lines here. What begins with / is an order: /help');
      return;
    }
    this.m_answersUntil = readNow() + kAnswerTime;
    client?.order(text.slice(1));
  }

  NoteEvent(event: WorldEvent, players: Players, now: number): void {
    if (event.kind === EventKind.Said) this.chat.Add(event.clientId, event.name, players);
    if (event.kind === EventKind.Emote) this.m_emotes.Show(event.body, event.emote, now);
  }

  Update(client: Client, players: Players, camera: PerspectiveCamera, now: number): void {
    this.m_emotes.Update(client, players, camera, now);
  }
}
