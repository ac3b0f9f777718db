// The name of the scene and of its players. The player's own name comes first and can be edited. Short and narrow
// screens fold all of it behind a button with the scene's name.
import type { Welcome } from 'wobble-client';
import { MakeBodyColour, MakeOwnColour } from '../scene/colours';
import type { Player, Players } from '../players';
import { Drawer } from './drawer';
import { MakeButton, MakeElement, SetPressed, SetText } from './element';

const kMostShown = 12;
const kMaxNameBytes = 32;

export class People {
  readonly drawer: Drawer;
  onRename: (name: string) => void = () => {};
  onFollow: (clientId: number) => void = () => {}; // of who has no body
  private readonly m_scene = MakeElement('span');
  private readonly m_count = MakeElement('span');
  private readonly m_about = MakeElement('div', 'note about');
  private readonly m_list = MakeElement('ul');
  private readonly m_name = MakeElement('input', 'name-field');
  private readonly m_dot = MakeDot(`#${MakeOwnColour().getHexString()}`);
  private m_revision = -1;

  // Both are shown at the top. menu: of the worlds.
  constructor(name: string, invite: HTMLElement, menu: HTMLElement) {
    const element = MakeElement('section', 'panel people');
    element.setAttribute('aria-label', 'Scene and players');
    const title = MakeElement('div', 'scene');
    title.append(this.m_scene, this.m_count);
    this.m_name.value = name;
    this.m_name.spellcheck = false;
    this.m_name.maxLength = kMaxNameBytes;
    this.m_name.setAttribute('aria-label', 'Your name');
    this.m_name.title = 'Your name: click to change it';
    this.m_name.addEventListener('change', () => this.TakeName());
    this.m_name.addEventListener('keydown', (event) => {
      event.stopPropagation();
      if (event.key === 'Enter' || event.key === 'Escape') this.m_name.blur();
    });
    const self = MakeElement('ul');
    const own = MakeElement('li');
    self.append(own);
    own.append(this.m_dot, this.m_name);
    element.append(invite, menu, title, this.m_about, self, this.m_list);
    this.drawer = new Drawer('left', 'players and worlds', 'wobble', element);
  }

  // The name that the server gives the player.
  TakeOwnName(name: string): void {
    if (document.activeElement !== this.m_name) this.m_name.value = name;
  }

  Update({ scene, description }: Welcome, players: Players): void {
    SetText(this.m_scene, scene);
    if (this.m_about.title !== description) this.m_about.title = this.m_about.textContent = description;
    this.drawer.SetText(`${scene} · ${players.all.size}`);
    if (this.m_revision === players.revision) return;
    this.m_revision = players.revision;
    this.m_dot.style.setProperty('--player', `#${MakeBodyColour(players, players.ownBody).getHexString()}`);
    const others = [...players.all.values()].filter((player) => player.clientId !== players.ownClient);
    SetText(this.m_count, Describe(others.length, players.ownBody !== 0));
    this.m_list.replaceChildren();
    for (const player of others.slice(0, kMostShown)) {
      const item = MakeElement('li');
      const colour = player.body === 0 ? 'transparent' : `#${MakeBodyColour(players, player.body).getHexString()}`;
      item.append(MakeDot(colour), this.MakeName(player, players));
      this.m_list.append(item);
    }
    if (others.length > kMostShown) {
      this.m_list.append(MakeElement('li', 'note', `and ${others.length - kMostShown} more`));
    }
  }

  // There is no world. name: of the one that is asked for.
  Leave(name: string): void {
    this.m_revision = -1;
    SetText(this.m_scene, '');
    this.m_about.title = this.m_about.textContent = '';
    SetText(this.m_count, '');
    this.m_list.replaceChildren();
    this.drawer.SetText(name);
  }

  private MakeName(player: Player, players: Players): HTMLElement {
    if (players.ownBody !== 0 || player.body === 0) return MakeElement('span', '', player.name);
    const button = MakeButton(player.name, `Follow ${player.name}`, '', () => this.onFollow(player.clientId));
    SetPressed(button, player.clientId === players.followed);
    return button;
  }

  private TakeName(): void {
    const name = CutName(this.m_name.value);
    this.m_name.value = name;
    if (name !== '') this.onRename(name);
  }
}

function Describe(others: number, hasBody: boolean): string {
  if (!hasBody) return `watching ${others}`;
  return others === 0 ? 'you alone' : `${others + 1} here`;
}

function MakeDot(colour: string): HTMLElement {
  const dot = MakeElement('span', 'dot');
  dot.style.setProperty('--player', colour);
  return dot;
}

// Cuts a name to the length that the protocol allows, at a whole character.
export function CutName(text: string): string {
  let name = '';
  const encoder = new TextEncoder();
  for (const character of text.trim()) {
    if (encoder.encode(name + character).length > kMaxNameBytes) break;
    name += character;
  }
  return name;
}
