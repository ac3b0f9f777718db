// The players: names and bodies, from the server's events.
import { EventKind, type WorldEvent } from 'wobble-client';

export interface Player {
  clientId: number;
  name: string;
  body: number; // 0: a spectator
}

export class Players {
  ownBody = 0;
  ownClient = 0;
  followed = 0; // client whose body is watched by who has none; 0: nobody's
  revision = 0; // changes whenever the list of players, or who is followed, changes
  readonly all = new Map<number, Player>();
  private readonly m_bodies = new Map<number, Player>();

  Clear(): void {
    this.ownBody = this.ownClient = this.followed = 0;
    this.all.clear();
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
