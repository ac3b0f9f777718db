// The interface of a tool, and the objects that all tools use.
import { Vector3, type Mesh, type PerspectiveCamera } from 'three';
import type { Device } from '../input/device';
import type { Place } from '../input/pointer';
import type { Pick, Picking } from '../input/picking';
import type { Client, Vector, Welcome } from 'wobble-client';
import type { Marks } from './marks';

export interface Bench {
  readonly camera: PerspectiveCamera;
  readonly picking: Picking;
  readonly marks: Marks;
  readonly solids: Mesh[];
  // null while there is no world.
  FindClient(): Client | null;
  FindWelcome(): Welcome | null;
}

export interface Tool {
  readonly name: string;
  readonly hand: number; // bit of Welcome.hands that allows the tool
  readonly hints: Record<Device, string>;
  readonly icon: string; // SVG paths in a square of 24 by 24
  // Returns false when there is nothing here for this tool.
  Begin(place: Place): boolean;
  Move(place: Place): void;
  End(place: Place): void;
  // notches: away from the player when negative. Returns false when the tool does not use the wheel.
  Wheel(notches: number): boolean;
  // Called once a frame, after the sample.
  Update(): void;
  // Called when another tool or another world is chosen.
  Drop(): void;
}

// Finds the body under a point, except the player's own; aims the bench's picking at the point. null: no body, or no
// world.
export function PickOther(bench: Bench, place: Place): { client: Client; pick: Pick } | null {
  const client = bench.FindClient();
  if (client === null) return null;
  bench.picking.AimAt(place.x, place.y);
  const pick = bench.picking.FindBody(client, bench.FindWelcome()?.ownBody ?? 0);
  return pick === null ? null : { client, pick };
}

const kScratch = new Vector3();

// Screen position, pixels of the window.
export function Project(point: Vector, camera: PerspectiveCamera): Place {
  const place = kScratch.set(point.x, point.y, point.z).project(camera);
  return { x: (0.5 + 0.5 * place.x) * window.innerWidth, y: (0.5 - 0.5 * place.y) * window.innerHeight };
}
