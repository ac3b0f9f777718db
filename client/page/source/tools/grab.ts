// The grab tool: holds the vertex under the pointer and drags it. The target moves in the plane through the vertex that
// faces the camera; the wheel moves it nearer or farther.
import { Vector3 } from 'three';
import { Device } from '../input/device';
import { MakePoint } from '../input/picking';
import type { Place } from '../input/pointer';
import { Hands, type Vector } from 'wobble-client';
import { PickOther, Project, type Bench, type Tool } from './tool';

const kWheelStep = 0.08; // share of the distance per notch
const kLeastDistance = 1; // m

export class Grab implements Tool {
  readonly name = 'Grab';
  readonly hand = Hands.Grab;
  readonly hints = {
    [Device.Desk]: 'Drag a body with the left button; the wheel moves it nearer or farther',
    [Device.Touch]: 'Drag a body with a finger',
    [Device.Pad]: 'Hold RT with a body in the ring, and look where it shall go',
  };
  readonly icon =
    'M8 13V5.5a1.5 1.5 0 0 1 3 0V11V4a1.5 1.5 0 0 1 3 0v7V5.5a1.5 1.5 0 0 1 3 0V14c0 4-2.5 7-6 7-3 0-4.6-1.6-6-4.5L3.4 13a1.5 1.5 0 0 1 2.6-1.4L8 14';
  private readonly m_bench: Bench;
  private m_held: { body: number; vertex: number } | null = null;
  private m_depth: Vector = { x: 0, y: 0, z: 0 }; // a point of the plane in which the target moves
  private m_place: Place = { x: 0, y: 0 };
  private readonly m_target = new Vector3();

  constructor(bench: Bench) {
    this.m_bench = bench;
  }

  Begin(place: Place): boolean {
    const found = PickOther(this.m_bench, place);
    if (found === null) return false;
    this.m_held = { body: found.pick.body, vertex: found.pick.vertex };
    this.m_depth = found.pick.point;
    this.m_place = place;
    return true;
  }

  Move(place: Place): void {
    this.m_place = place;
  }

  End(): void {
    this.Drop();
  }

  Wheel(notches: number): boolean {
    if (this.m_held === null) return false;
    const eye = this.m_bench.camera.position;
    const away = new Vector3(this.m_depth.x, this.m_depth.y, this.m_depth.z).sub(eye);
    const distance = away.length();
    away.setLength(Math.max(kLeastDistance, distance * Math.exp(-kWheelStep * notches))).add(eye);
    this.m_depth = { x: away.x, y: away.y, z: away.z };
    return true;
  }

  // Called in each frame, because the camera moves as well.
  Update(): void {
    const client = this.m_bench.FindClient();
    if (this.m_held === null || client === null) return;
    const body = client.findBody(this.m_held.body);
    if (body === null || this.m_held.vertex >= body.vertexCount) {
      this.Drop();
      return;
    }
    this.m_bench.picking.AimAt(this.m_place.x, this.m_place.y);
    if (this.m_bench.picking.FindFacing(this.m_depth, this.m_target) === null) return;
    client.setHand({ ...this.m_held, target: this.m_target });
    const vertex = MakePoint(client.readFloats(), body.vertices + 3 * this.m_held.vertex);
    const from = Project(vertex, this.m_bench.camera);
    this.m_bench.marks.AddLine(from.x, from.y, this.m_place.x, this.m_place.y, '#fff3c4');
  }

  Drop(): void {
    if (this.m_held !== null) this.m_bench.FindClient()?.setHand(null);
    this.m_held = null;
  }
}
