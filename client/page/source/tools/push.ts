// The push tool: pushes the vertices under the pointer away from the eye.
import { Device } from '../input/device';
import type { Place } from '../input/pointer';
import { Hands, readNow } from 'wobble-client';
import { PickOther, type Bench, type Tool } from './tool';

export class Push implements Tool {
  readonly name = 'Push';
  readonly hand = Hands.Push;
  readonly hints = {
    [Device.Desk]: 'Click a body to push it away from you',
    [Device.Touch]: 'Tap a body to push it away from you',
    [Device.Pad]: 'Press RT with a body in the ring to push it away',
  };
  readonly icon = 'M3 12h11M10 7l5 5-5 5M19 5v14';
  private readonly m_bench: Bench;

  constructor(bench: Bench) {
    this.m_bench = bench;
  }

  Begin(place: Place): boolean {
    const found = PickOther(this.m_bench, place);
    if (found === null) return false;
    found.client.push(found.pick.body, found.pick.vertex, this.m_bench.picking.ray.direction);
    this.m_bench.marks.AddRing(place.x, place.y, readNow());
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
