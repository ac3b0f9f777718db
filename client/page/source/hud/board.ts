// The state of a game: round, time, points, and the winner.
import type { Players } from '../players';
import { MakeOwnColour, MakePlayerColour } from '../scene/colours';
import { GamePhase, type Client, type Scoreboard } from 'wobble-client';
import { MakeElement, SetText } from './element';

const kMostShown = 8;
const kEvery = 0.2; // s

export class Board {
  readonly element = MakeElement('section', 'panel board');
  readonly banner = MakeElement('div', 'banner');
  private readonly m_round = MakeElement('small');
  private readonly m_left = MakeElement('span');
  private readonly m_goal = MakeElement('small');
  private readonly m_list = MakeElement('ol');
  private m_shown = '';
  private m_next = 0;

  constructor() {
    this.element.setAttribute('aria-label', 'Score');
    this.banner.setAttribute('role', 'status');
    const clock = MakeElement('div', 'clock');
    clock.append(this.m_round, this.m_left, this.m_goal);
    this.element.append(clock, this.m_list);
    this.Hide();
  }

  Hide(): void {
    this.element.hidden = this.banner.hidden = true;
  }

  Update(client: Client, players: Players, now: number): void {
    if (now < this.m_next) return;
    this.m_next = now + kEvery;
    this.element.hidden = false;
    const board = client.readScoreboard();
    const minutes = Math.floor(board.secondsLeft / 60);
    SetText(this.m_round, `round ${board.round}`);
    SetText(this.m_left, `${minutes}:${String(board.secondsLeft % 60).padStart(2, '0')}`);
    SetText(this.m_goal, board.pointsToWin > 0 ? `first to ${board.pointsToWin}` : '');
    this.ShowScores(board, players);
    const isWon = board.phase === GamePhase.Won;
    this.banner.hidden = !isWon;
    if (!isWon) return;
    const isOwn = board.winner !== 0 && board.winner === players.ownClient;
    const text = board.winner === 0 ? 'Nobody wins this round' : `${players.FindName(board.winner)} wins`;
    SetText(this.banner, isOwn ? 'You win!' : text);
  }

  private ShowScores(board: Scoreboard, players: Players): void {
    const shown = `${players.revision} ${JSON.stringify(board.scores)}`;
    if (shown === this.m_shown) return;
    this.m_shown = shown;
    const scores = [...board.scores].sort((a, b) => b.points - a.points || b.rounds - a.rounds);
    this.m_list.replaceChildren();
    for (const score of scores.slice(0, kMostShown)) {
      const isOwn = score.clientId === players.ownClient;
      const body = players.all.get(score.clientId)?.body ?? 0;
      const dot = MakeElement('span', 'dot');
      const colour = isOwn ? MakeOwnColour() : MakePlayerColour(body);
      dot.style.setProperty('--player', `#${colour.getHexString()}`);
      const won = score.rounds > 0 ? ` ${'★'.repeat(Math.min(score.rounds, 5))}` : '';
      const item = MakeElement('li');
      item.append(dot, isOwn ? 'you' : players.FindName(score.clientId), MakeElement('b', '', `${score.points}${won}`));
      this.m_list.append(item);
    }
  }
}
