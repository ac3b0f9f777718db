// Shoves the vertices under the pointer away from the eye.
import type { Place } from '../input/pointer';
import { Hands } from '../wire/views';
import { ReadNow } from '../wire/client';
import type { Bench, Tool } from './tool';

export class Push implements Tool {
  readonly name = 'Push';
  readonly hand = Hands.Push;
  readonly hint = 'Click a body to push it away from you';
  readonly icon = 'M3 12h11M10 7l5 5-5 5M19 5v14';
  private readonly m_bench: Bench;

  constructor(bench: Bench) {
    this.m_bench = bench;
  }

  Begin(place: Place): boolean {
    const client = this.m_bench.FindClient();
    const own = this.m_bench.FindWelcome()?.ownBody ?? 0;
    if (client === null) return false;
    const { direction } = this.m_bench.picking.AimAt(place.x, place.y);
    const pick = this.m_bench.picking.FindBody(client, own);
    if (pick === null) return false;
    client.Push(pick.body, pick.vertex, direction);
    this.m_bench.marks.AddRing(place.x, place.y, ReadNow());
    return true;
  }

  Move(): void {}
  End(): void {}
  Wheel(): boolean {
    return false;
  }
  Update(): void {}
  Drop(): void {}
}
