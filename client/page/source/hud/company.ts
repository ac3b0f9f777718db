// A line while there are too few players, with the way to invite others.
import type { Welcome } from 'wobble-client';
import type { Players } from '../players';
import { MakeButton, MakeElement, SetText } from './element';
import { kFilm } from './film_panel';

const kPlayersOfRound = 2; // a game's time stands still with fewer
const kQuietFor = 4; // s after joining

export enum Company {
  Enough,
  GameWaits, // a round begins with another player
  NobodyPlays, // of who watches
  Alone, // in a world without a game
}

export function FindCompany(game: string, bodies: number, hasBody: boolean): Company {
  if (game === kFilm) return Company.Enough;
  if (bodies === 0) return Company.NobodyPlays;
  if (game !== '' && bodies < kPlayersOfRound) return Company.GameWaits;
  return hasBody && bodies === 1 ? Company.Alone : Company.Enough;
}

const kTexts: Record<Company, string> = {
  [Company.Enough]: '',
  [Company.GameWaits]: 'Waiting for players: a round needs two',
  [Company.NobodyPlays]: 'Nobody plays here yet',
  [Company.Alone]: 'You are alone here',
};

export class CompanyLine {
  readonly element = MakeElement('div', 'line company');
  private readonly m_text = MakeElement('span');
  private m_isClosed = false; // by the player, until the page is loaded anew
  private m_since = 0;

  constructor(onInvite: () => void) {
    this.m_text.setAttribute('role', 'status');
    const close = MakeButton('×', 'Close this line', '', () => {
      this.m_isClosed = true;
      this.element.hidden = true;
    });
    this.element.append(this.m_text, MakeButton('Invite', 'Invite others', '', onInvite), close);
    this.element.hidden = true;
  }

  // now: s.
  Begin(now: number): void {
    this.m_since = now;
    this.element.hidden = true;
  }

  Update(welcome: Welcome, players: Players, now: number): void {
    if (now - this.m_since < kQuietFor || this.m_isClosed) return;
    const bodies = [...players.all.values()].filter((player) => player.body !== 0).length;
    const company = FindCompany(welcome.game, bodies, welcome.ownBody !== 0);
    this.element.hidden = company === Company.Enough;
    SetText(this.m_text, kTexts[company]);
  }
}
