// Forces on one body: asks the server for those of the body last clicked, or of the player's own body or the followed
// one, while they are displayed, and shows them.
import type { ViewPanel } from './hud/view_panel';
import type { Players } from './players';
import type { Arrows } from './scene/arrows';
import { readNow, type Client, type Forces } from 'wobble-client';

const kReadEvery = 0.08; // s; the server sends ten times a second

export class Inspector {
  private readonly m_panel: ViewPanel;
  private readonly m_arrows: Arrows;
  private readonly m_players: Players;
  private m_clicked = 0;
  private m_asked = 0;
  private m_forces: Forces | null = null;
  private m_nextRead = 0;

  constructor(panel: ViewPanel, arrows: Arrows, players: Players) {
    this.m_panel = panel;
    this.m_arrows = arrows;
    this.m_players = players;
  }

  Choose(body: number): void {
    this.m_clicked = body;
  }

  // Clears the selection for another world.
  Clear(): void {
    this.m_clicked = this.m_asked = 0;
    this.m_forces = null;
    this.m_arrows.Hide();
  }

  Update(client: Client): void {
    if (this.m_clicked !== 0 && client.findBody(this.m_clicked) === null) this.m_clicked = 0;
    const wanted = this.m_panel.shown.size === 0 ? 0 : this.m_clicked || this.m_players.FindWatchedBody();
    if (wanted !== this.m_asked) {
      this.m_asked = wanted;
      client.inspect(wanted);
    }
    this.m_panel.Describe(this.Describe(client, wanted));
    const body = wanted === 0 ? null : client.findBody(wanted);
    if (body === null) {
      this.m_arrows.Hide();
      return;
    }
    const forces = this.ReadForces(client);
    if (forces.body === wanted) this.m_arrows.Update(forces, body, client.readFloats(), this.m_panel.shown);
    else this.m_arrows.Hide();
  }

  private ReadForces(client: Client): Forces {
    const now = readNow();
    if (this.m_forces !== null && now < this.m_nextRead) return this.m_forces;
    this.m_nextRead = now + kReadEvery;
    this.m_forces = client.readForces();
    return this.m_forces;
  }

  private Describe(client: Client, body: number): string {
    if (body === 0) return 'Press a body to see its forces';
    if (body === this.m_players.ownBody) return 'On your body. Press another one to see its forces';
    const found = client.findBody(body);
    const player = this.m_players.FindByBody(body);
    const name = player?.name ?? (found === null ? '' : client.findBlueprint(found.blueprint).name);
    return `On ${name}`;
  }
}
