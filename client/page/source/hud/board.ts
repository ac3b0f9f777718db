// The state of a game: its phase and time, the points of sides and players, who is ready, the winner, the final board.
import type { Players } from '../players';
import { kSideNames, MakeBodyColour, MakeSideColour } from '../scene/colours';
import { GamePhase, type Client, type Score, type Scoreboard } from 'wobble-client';
import { MakeButton, MakeElement, SetText } from './element';

const kMostShown = 8;
const kMostStars = 5;
const kEvery = 0.2; // s
const kReadyKey = 'Y';

export class Board {
  readonly element = MakeElement('section', 'panel board');
  readonly banner = MakeElement('div', 'banner');
  private readonly m_round = MakeElement('small');
  private readonly m_left = MakeElement('span');
  private readonly m_goal = MakeElement('small');
  private readonly m_sides = MakeElement('div', 'sides');
  private readonly m_list = MakeElement('ol');
  private readonly m_ready = MakeButton('Ready', 'Say that you are ready', kReadyKey, () => this.SayReady());
  // Called as a kick-off begins, with the own side; 0: the game has none.
  onKickOff: (side: number) => void = () => {};
  private m_phase = GamePhase.Playing;
  private m_shown = '';
  private m_next = 0;
  private m_client: Client | null = null; // that may say that it is ready

  constructor() {
    this.element.setAttribute('aria-label', 'Score');
    this.banner.setAttribute('role', 'status');
    const clock = MakeElement('div', 'clock');
    clock.append(this.m_round, this.m_left, this.m_goal);
    this.m_ready.classList.add('main', 'ready');
    this.element.append(this.m_sides, clock, this.m_list, this.m_ready);
    window.addEventListener('keydown', (event) => {
      const isWriting = event.target instanceof HTMLInputElement;
      if (event.code === `Key${kReadyKey}` && !event.repeat && !event.ctrlKey && !isWriting) this.SayReady();
    });
    this.Hide();
  }

  Hide(): void {
    this.element.hidden = this.banner.hidden = true;
    this.m_client = null;
  }

  Update(client: Client, game: string, players: Players, now: number): void {
    if (now < this.m_next) return;
    this.m_next = now + kEvery;
    this.element.hidden = false;
    const board = client.readScoreboard();
    players.NoteBoard(game, board);
    const isOver = board.phase === GamePhase.Over;
    this.element.classList.toggle('final', isOver);
    SetText(this.m_round, DescribeRound(board));
    SetText(this.m_left, isOver ? 'final' : FormatClock(board));
    SetText(this.m_goal, isOver || board.pointsToWin === 0 ? '' : `first to ${board.pointsToWin}`);
    this.ShowScores(board, players);
    const text = DescribePhase(board, players);
    this.banner.hidden = text === '';
    SetText(this.banner, text);
    const own = board.scores.find((score) => score.clientId === players.ownClient);
    const kicksOff = board.phase === GamePhase.KickOff && this.m_phase !== GamePhase.KickOff;
    if (kicksOff && own !== undefined) this.onKickOff(own.side);
    this.m_phase = board.phase;
    const mayBeReady = board.phase === GamePhase.Lobby && own !== undefined && !own.isReady;
    this.m_ready.hidden = !mayBeReady;
    this.m_client = mayBeReady ? client : null;
  }

  private SayReady(): void {
    this.m_client?.order('ready');
  }

  private ShowScores(board: Scoreboard, players: Players): void {
    const shown = `${players.revision} ${board.phase} ${board.bearer} ${JSON.stringify([board.scores, board.sides])}`;
    if (shown === this.m_shown) return;
    this.m_shown = shown;
    this.m_sides.hidden = board.sides.length === 0;
    this.m_sides.replaceChildren();
    board.sides.forEach(({ points, rounds }, index) => {
      const name = kSideNames[index + 1];
      const side = MakeElement('span', 'side', `${name} ${FormatStars(rounds)}`);
      side.style.setProperty('--player', `#${MakeSideColour(index + 1).getHexString()}`);
      const count = MakeElement('b', '', String(points));
      if (index === 0) this.m_sides.append(side, count, ':');
      else this.m_sides.append(count, side);
    });
    const scores = [...board.scores].sort(board.phase === GamePhase.Over ? CompareAtEnd : ComparePoints);
    this.m_list.replaceChildren(...scores.slice(0, kMostShown).map((score) => this.MakeLine(score, board, players)));
    const more = scores.length - kMostShown;
    if (more > 0) this.m_list.append(MakeElement('li', 'note', `and ${more} more`));
  }

  private MakeLine(score: Score, board: Scoreboard, players: Players): HTMLElement {
    const isOwn = score.clientId === players.ownClient;
    const dot = MakeElement('span', 'dot');
    const body = players.all.get(score.clientId)?.body ?? 0;
    dot.style.setProperty('--player', `#${MakeBodyColour(players, body).getHexString()}`);
    const crown = score.clientId === board.bearer && board.bearer !== 0 ? ' ♛' : '';
    const name = (isOwn ? 'you' : players.FindName(score.clientId)) + crown;
    const state =
      board.phase === GamePhase.Lobby ? (score.isReady ? '✓' : '…') : `${score.points}${FormatStars(score.rounds, ' ')}`;
    const item = MakeElement('li');
    item.append(dot, name, MakeElement('b', '', state));
    return item;
  }
}

function ComparePoints(a: Score, b: Score): number {
  return b.points - a.points || b.rounds - a.rounds;
}

function CompareAtEnd(a: Score, b: Score): number {
  return b.rounds - a.rounds || b.points - a.points;
}

function FormatStars(rounds: number, before = ''): string {
  return rounds > 0 ? before + '★'.repeat(Math.min(rounds, kMostStars)) : '';
}

function FormatClock(board: Scoreboard): string {
  const seconds = board.secondsLeft;
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, '0')}`;
}

function DescribeRound(board: Scoreboard): string {
  if (board.phase === GamePhase.Lobby) return 'practice';
  if (board.phase === GamePhase.Over) return board.rounds === 1 ? '' : `${board.rounds} rounds`;
  return board.rounds > 0 ? `round ${board.round} of ${board.rounds}` : `round ${board.round}`;
}

// What the banner says; empty: nothing.
function DescribePhase(board: Scoreboard, players: Players): string {
  switch (board.phase) {
    case GamePhase.Lobby:
      return board.scores.length < 2 ? 'Waiting for others to play with' : `The match begins within ${board.secondsLeft} s`;
    case GamePhase.KickOff:
      return `${DescribeOwnSide(board, players)}${board.secondsLeft + 1}`;
    case GamePhase.Golden:
      return 'The next point wins';
    case GamePhase.Won:
      return DescribeWinner(board, players, 'this round');
    case GamePhase.Over:
      return DescribeWinner(board, players, board.rounds === 1 ? 'this round' : 'the match');
    case GamePhase.Playing:
      return '';
  }
}

function DescribeOwnSide(board: Scoreboard, players: Players): string {
  const side = board.scores.find((score) => score.clientId === players.ownClient)?.side ?? 0;
  return side === 0 ? 'Get ready: ' : `You are ${kSideNames[side]}: score in the ${kSideNames[3 - side]} goal. `;
}

function DescribeWinner(board: Scoreboard, players: Players, what: string): string {
  if (board.winningSide !== 0) return `${kSideNames[board.winningSide]} wins ${what}`;
  if (board.winner === 0) return `Nobody wins ${what}`;
  const isRound = what === 'this round';
  if (board.winner === players.ownClient) return isRound ? 'You win!' : `You win ${what}!`;
  return `${players.FindName(board.winner)} wins${isRound ? '' : ` ${what}`}`;
}
