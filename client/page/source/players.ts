// The players: names and bodies, from the server's events.
import { EventKind, type Scoreboard, type WorldEvent } from 'wobble-client';

export interface Player {
  clientId: number;
  name: string;
  body: number; // 0: a spectator
}

export class Players {
  ownBody = 0;
  ownClient = 0;
  game = ''; // its name; empty: none
  object = 0; // the ball or the crown of the game, a body; 0: none
  followed = 0; // client whose body is watched by who has none; 0: nobody's
  revision = 0; // changes whenever the list of players, or who is followed, changes
  readonly all = new Map<number, Player>();
  private readonly m_bodies = new Map<number, Player>();
  private readonly m_sides = new Map<number, number>(); // in the game, by client

  Clear(): void {
    this.ownBody = this.ownClient = this.followed = this.object = 0;
    this.game = '';
    this.all.clear();
    this.m_sides.clear();
    this.m_bodies.clear();
    this.revision += 1;
  }

  NoteOwn(clientId: number, body: number, name: string): void {
    this.ownClient = clientId;
    this.ownBody = body;
    this.Add({ clientId, name, body });
  }

  NoteEvent(event: WorldEvent): void {
    if (event.kind === EventKind.Join) this.Add({ clientId: event.clientId, name: event.name, body: event.body });
    if (event.kind === EventKind.Leave) this.Remove(event.clientId);
    if (event.kind === EventKind.Rename) this.Rename(event.clientId, event.name);
  }

  // What the game says of sides and of its ball or crown.
  NoteBoard(game: string, board: Scoreboard): void {
    const isSame =
      game === this.game &&
      board.object === this.object &&
      board.scores.every((score) => this.m_sides.get(score.clientId) === score.side);
    if (isSame) return;
    this.game = game;
    this.object = board.object;
    for (const score of board.scores) this.m_sides.set(score.clientId, score.side);
    this.revision += 1;
  }

  // The side of a player's body; 0: none.
  FindSide(body: number): number {
    const player = this.m_bodies.get(body);
    return player === undefined ? 0 : (this.m_sides.get(player.clientId) ?? 0);
  }

  // Follows this client's body, or nobody's if it already does.
  Follow(clientId: number): void {
    this.followed = this.followed === clientId ? 0 : clientId;
    this.revision += 1;
  }

  // The body that the camera follows: the own one, or that of the followed player; 0: none, or it is not there now.
  FindWatchedBody(): number {
    return this.ownBody || (this.all.get(this.followed)?.body ?? 0);
  }

  IsPlayer(body: number): boolean {
    return this.m_bodies.has(body);
  }

  FindByBody(body: number): Player | null {
    return this.m_bodies.get(body) ?? null;
  }

  FindName(clientId: number): string {
    return this.all.get(clientId)?.name ?? 'somebody';
  }

  private Rename(clientId: number, name: string): void {
    const player = this.all.get(clientId);
    if (player !== undefined) player.name = name;
    this.revision += 1;
  }

  private Add(player: Player): void {
    this.Remove(player.clientId);
    this.all.set(player.clientId, player);
    if (player.body !== 0) this.m_bodies.set(player.body, player);
    this.revision += 1;
  }

  private Remove(clientId: number): void {
    const player = this.all.get(clientId);
    if (player === undefined) return;
    this.all.delete(clientId);
    this.m_bodies.delete(player.body);
    this.revision += 1;
  }
}
