// Names above players: plain elements above the canvas, moved to the body's position on the screen.
import { Vector3, type PerspectiveCamera } from 'three';
import type { Client } from 'wobble-client';
import type { Players } from '../players';
import { MakeBodyColour } from './colours';

const kFarAway = 45; // m; names farther away are hidden
const kAbove = 1.75; // height of the name above the body, in body sizes

interface Label {
  element: HTMLElement;
  round: number;
}

export class Labels {
  private readonly m_parent: HTMLElement;
  private readonly m_labels = new Map<number, Label>();
  private readonly m_place = new Vector3();
  private m_revision = -1;
  private m_round = 0;

  constructor(parent: HTMLElement) {
    this.m_parent = parent;
  }

  Update(client: Client, players: Players, camera: PerspectiveCamera, width: number, height: number): void {
    if (this.m_revision !== players.revision) this.Clear();
    this.m_revision = players.revision;
    this.m_round += 1;
    for (const player of players.all.values()) {
      if (player.body === 0 || player.body === players.ownBody) continue;
      const body = client.findBody(player.body);
      if (body === null) continue;
      const size = client.findBlueprint(body.blueprint).size;
      const place = this.m_place.set(body.x, body.y, body.z + kAbove * size);
      const distance = place.distanceTo(camera.position);
      place.project(camera);
      if (place.z > 1 || Math.abs(place.x) > 1.1 || Math.abs(place.y) > 1.1 || distance > kFarAway) continue;
      const label = this.FindLabel(player.body, player.name, players);
      label.round = this.m_round;
      const x = (0.5 + 0.5 * place.x) * width;
      const y = (0.5 - 0.5 * place.y) * height;
      const scale = Math.max(0.7, Math.min(1.1, 9 / distance));
      label.element.style.transform = `translate(-50%, -100%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) scale(${scale.toFixed(2)})`;
    }
    for (const label of this.m_labels.values()) {
      const display = label.round === this.m_round ? '' : 'none';
      if (label.element.style.display !== display) label.element.style.display = display;
    }
  }

  private Clear(): void {
    for (const label of this.m_labels.values()) label.element.remove();
    this.m_labels.clear();
  }

  private FindLabel(body: number, name: string, players: Players): Label {
    let label = this.m_labels.get(body);
    if (label === undefined) {
      const element = document.createElement('div');
      element.className = 'name-label';
      element.textContent = name;
      element.style.setProperty('--player', `#${MakeBodyColour(players, body).getHexString()}`);
      this.m_parent.append(element);
      label = { element, round: 0 };
      this.m_labels.set(body, label);
    }
    return label;
  }
}
