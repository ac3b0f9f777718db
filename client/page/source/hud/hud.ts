// All that lies above the world: its parts, where they are, and what they show in each frame.
import type { Client, Connection, Welcome } from 'wobble-client';
import type { Command } from '../input/keys';
import type { Device } from '../input/device';
import type { Players } from '../players';
import type { Settings } from '../settings';
import type { Build } from '../tools/build';
import type { Offer } from '../worlds';
import { Board } from './board';
import { BuildPanel } from './build_panel';
import { CompanyLine } from './company';
import { ConnectionCard, type CardActions } from './connection_card';
import { MakeElement } from './element';
import { FilmPanel, kFilm } from './film_panel';
import { Help } from './help';
import { Hints } from './hints';
import { InvitePanel } from './invite_panel';
import { LinkChart } from './link_chart';
import { FindLink, Link, LinkLine } from './link_line';
import { Menu } from './menu';
import { People } from './people';
import { SettingsPanel } from './settings_panel';
import { TalkPanel } from './talk';
import { Toasts } from './toasts';
import { ViewPanel } from './view_panel';
import { WorldMenu } from './world_menu';
import { WorldPanel } from './world_panel';

export interface HudOptions {
  offer: Offer;
  connection: Connection;
  settings: Settings;
  isQualityFixed: boolean;
  build: Build;
  labels: HTMLElement; // over the world
  sound: HTMLElement; // its switch
  card: CardActions;
  onCommand: (command: Command) => void;
}

export class Hud {
  readonly worlds = new WorldMenu();
  readonly invite: InvitePanel;
  readonly people: People;
  readonly toasts = new Toasts();
  readonly film = new FilmPanel();
  readonly hints = new Hints();
  readonly help = new Help();
  readonly view = new ViewPanel();
  readonly world: WorldPanel;
  readonly settings: SettingsPanel;
  readonly menu: Menu;
  readonly card: ConnectionCard;
  readonly talk: TalkPanel;
  readonly board = new Board();
  private readonly m_connection: Connection;
  private m_parent: HTMLElement = MakeElement('div');
  private readonly m_company: CompanyLine;
  private readonly m_chart = new LinkChart();
  private readonly m_line = new LinkLine();
  private readonly m_buildPanel: BuildPanel;

  constructor({ offer, connection, settings, isQualityFixed, build, labels, sound, card, onCommand }: HudOptions) {
    this.m_connection = connection;
    this.worlds.List(offer);
    this.worlds.Show(connection.world);
    this.invite = new InvitePanel(offer);
    this.m_company = new CompanyLine(() => this.invite.Open());
    this.people = new People(connection.name, this.invite.button, this.worlds.element);
    this.card = new ConnectionCard(offer.worlds, card);
    this.world = new WorldPanel(() => connection.playing);
    this.settings = new SettingsPanel(settings, isQualityFixed);
    const panels = { view: this.view.element, world: this.world.element, settings: this.settings.element };
    this.menu = new Menu(this.m_chart.element, panels, onCommand);
    this.m_buildPanel = new BuildPanel(build);
    this.talk = new TalkPanel(labels, sound, () => connection.playing);
  }

  // Later ones cover earlier ones. touch, tools: elements of the input.
  Append(parent: HTMLElement, touch: HTMLElement[], tools: HTMLElement): void {
    this.m_parent = parent;
    const middle = MakeElement('div', 'middle');
    middle.append(this.board.element, this.board.banner, this.film.element);
    middle.append(this.m_line.element, this.m_company.element, this.toasts.element);
    const below = MakeElement('div', 'below');
    below.append(this.hints.element, this.m_buildPanel.element, tools);
    parent.append(...touch, middle, below, this.talk.element, this.people.drawer.element, this.menu.drawer.element);
    parent.append(this.card.element, this.help.element, this.invite.element);
  }

  // The device that is used from now on.
  Speak(device: Device): void {
    this.help.Speak(device);
    this.hints.Speak(device);
  }

  // At the start of each connection and scene.
  Clear(): void {
    this.m_chart.Clear();
    this.invite.Clear();
    this.board.Hide();
    this.film.Hide();
    this.talk.Begin(null);
  }

  Begin(welcome: Welcome, now: number): void {
    this.invite.Update(this.m_connection.world, welcome);
    this.m_company.Begin(now);
    this.talk.Begin(welcome);
  }

  // While there is no world: the card says why, and nothing may lie over it.
  Wait(): void {
    this.m_parent.classList.add('away');
    this.people.Leave(this.m_connection.world || 'wobble');
    this.invite.Close();
    this.m_line.Hide();
    this.m_company.element.hidden = this.m_buildPanel.element.hidden = true;
  }

  // What the server says to this player.
  Tell(notice: string): void {
    const isTaken = this.film.TakeNotice(notice) || this.invite.TakeNotice(notice) || this.talk.TakeNotice(notice);
    if (!isTaken) this.toasts.Add(notice, true);
  }

  // yaw: of the camera, rad. builds: the build tool is active.
  Update(client: Client, welcome: Welcome, players: Players, yaw: number, builds: boolean, now: number): void {
    this.m_parent.classList.remove('away');
    const silence = this.m_connection.findSilence();
    const { pace } = client.readStatistics();
    const link = FindLink(silence, pace);
    this.m_line.Update(link, silence, pace);
    this.m_chart.Update(client, this.m_connection.ping, link === Link.Silent, now);
    this.people.Update(welcome, players);
    this.m_company.Update(welcome, players, now);
    this.m_buildPanel.Update(builds);
    this.world.Update(yaw);
    this.menu.Update(this.MayTune(players));
    this.hints.Update(now);
    if (welcome.game === kFilm) this.film.Update(client, now);
    else if (welcome.game !== '') this.board.Update(client, welcome.game, players, now);
  }

  // Whether this player may change the world for all. Who only watches may not.
  MayTune(players: Players): boolean {
    return this.world.may !== 0 && players.ownBody !== 0;
  }

  CloseAll(): void {
    this.help.element.close();
    this.talk.Close();
    this.invite.Close();
    this.menu.Close();
    this.people.drawer.Open(false);
  }
}
