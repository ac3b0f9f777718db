// The cut tool: each piece of a stroke is a blade, the triangle of the eye and the piece's ends, extended beyond the
// bodies it meets.
//
// The server limits the number of commands per second, so a piece is the pointer's path in a twentieth of a second, and
// a command is sent only for bodies that the piece meets.
import type { Vector3 } from 'three';
import { Device } from '../input/device';
import type { Place } from '../input/pointer';
import { Hands, readNow, type Client, type Vector } from 'wobble-client';
import type { Bench, Tool } from './tool';

const kEvery = 0.05; // s
const kLeastPiece = 6; // pixels
const kProbes = 6; // rays per piece that find the bodies it meets
const kBehind = 1.5; // m by which the blade extends beyond what it meets

export class Cut implements Tool {
  readonly name = 'Cut';
  readonly hand = Hands.Cut;
  readonly hints = {
    [Device.Desk]: 'Draw a line across a cloth or springs to cut them',
    [Device.Touch]: 'Draw a line across a cloth or springs to cut them',
    [Device.Pad]: 'Hold RT and look across a cloth or springs to cut them',
  };
  readonly icon =
    'M6 8.5a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM6 20.5a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM8 7.5L20 18M8 16.5L20 6';
  private readonly m_bench: Bench;
  private m_from: Place | null = null;
  private m_to: Place = { x: 0, y: 0 };
  private m_next = 0;

  constructor(bench: Bench) {
    this.m_bench = bench;
  }

  // Always takes the press, because a stroke may begin beside the body it cuts.
  Begin(place: Place): boolean {
    this.m_from = this.m_to = place;
    this.m_bench.marks.AddStroke(place.x, place.y, readNow());
    return true;
  }

  Move(place: Place): void {
    this.m_to = place;
    this.m_bench.marks.AddStroke(place.x, place.y, readNow());
  }

  End(place: Place): void {
    this.m_to = place;
    this.CutPiece();
    this.m_from = null;
  }

  Wheel(): boolean {
    return false;
  }

  Update(): void {
    const now = readNow();
    if (this.m_from === null || now < this.m_next) return;
    if (Math.hypot(this.m_to.x - this.m_from.x, this.m_to.y - this.m_from.y) < kLeastPiece) return;
    this.m_next = now + kEvery;
    this.CutPiece();
    this.m_from = this.m_to;
  }

  Drop(): void {
    this.m_from = null;
  }

  private CutPiece(): void {
    const client = this.m_bench.FindClient();
    const from = this.m_from;
    if (client === null || from === null || (from.x === this.m_to.x && from.y === this.m_to.y)) return;
    for (const [body, distance] of this.FindMet(client, from, this.m_to)) {
      const eye = this.m_bench.camera.position;
      const reach = distance + kBehind;
      client.cut(body, Copy(eye), this.FindEnd(from, reach), this.FindEnd(this.m_to, reach));
    }
  }

  // The bodies that the piece meets, with the distance to the farthest point of contact, m.
  private FindMet(client: Client, from: Place, to: Place): Map<number, number> {
    const met = new Map<number, number>();
    const own = this.m_bench.FindWelcome()?.ownBody ?? 0;
    for (let i = 0; i <= kProbes; ++i) {
      const share = i / kProbes;
      this.m_bench.picking.AimAt(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y));
      const pick = this.m_bench.picking.FindBody(client, own);
      if (pick !== null) met.set(pick.body, Math.max(pick.distance, met.get(pick.body) ?? 0));
    }
    return met;
  }

  private FindEnd(place: Place, reach: number): Vector {
    const { origin, direction } = this.m_bench.picking.AimAt(place.x, place.y);
    return Copy(origin.clone().addScaledVector(direction, reach));
  }
}

function Copy(from: Vector3): Vector {
  return { x: from.x, y: from.y, z: from.z };
}
