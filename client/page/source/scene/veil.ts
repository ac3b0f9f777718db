// The bodies that hide the watched one from the camera, or that the camera is in; they are drawn see-through.
//
// Rays from the eye to the body's middle and around it are tried against the faces as they are, because soft bodies
// stretch, and a cloth fills no sphere.
import { Vector3 } from 'three';
import type { Body, Client, Vector } from 'wobble-client';
import { HitTriangle, type Ray } from '../input/picking';

const kEvery = 0.05; // s
const kAround = 0.6; // rays around the middle, in sizes of the body
const kHidden = 2; // rays of the five that a body must stop
const kKeepFor = 0.25; // s, so that nothing flickers

export class Veil {
  // Numbers of the bodies.
  readonly bodies = new Set<number>();
  private readonly m_until = new Map<number, number>();
  private m_next = 0;

  Clear(): void {
    this.bodies.clear();
    this.m_until.clear();
    this.m_next = 0;
  }

  // watched: null when no body is.
  Update(client: Client, eye: Vector, watched: Body | null, now: number): void {
    if (now < this.m_next) return;
    this.m_next = now + kEvery;
    for (const body of FindHiding(client, eye, watched)) this.m_until.set(body, now + kKeepFor);
    this.bodies.clear();
    for (const [body, until] of this.m_until) {
      if (until >= now) this.bodies.add(body);
      else this.m_until.delete(body);
    }
  }
}

// Exported for the tests.
export function FindHiding(client: Client, eye: Vector, watched: Body | null): number[] {
  const floats = client.readFloats();
  const rays = watched === null ? [] : MakeRays(eye, watched, client.findBlueprint(watched.blueprint).size);
  const hiding: number[] = [];
  for (let i = 0; i < client.bodyCount; ++i) {
    const body = client.bodies[i];
    const { faces } = client.findBlueprint(body.blueprint);
    if (faces.length === 0 || body.body === watched?.body) continue;
    const radius = FindRadius(body, floats);
    const isIn = Math.hypot(body.x - eye.x, body.y - eye.y, body.z - eye.z) < radius;
    if (isIn && watched === null) hiding.push(body.body);
    if (watched === null) continue;
    const stopped = rays.filter((ray) => IsNear(ray, body, radius) && Stops(ray, body, floats, faces));
    if (stopped.length >= kHidden) hiding.push(body.body);
  }
  return hiding;
}

interface Sight extends Ray {
  length: number; // m
}

function MakeRays(eye: Vector, to: Vector, size: number): Sight[] {
  const origin = new Vector3(eye.x, eye.y, eye.z);
  const middle = new Vector3(to.x, to.y, to.z);
  const ahead = middle.clone().sub(origin).normalize();
  const right = new Vector3(ahead.y, -ahead.x, 0).normalize().multiplyScalar(kAround * size);
  const up = new Vector3().crossVectors(right, ahead);
  const targets = [middle, ...[right, up].flatMap((way) => [middle.clone().add(way), middle.clone().sub(way)])];
  return targets.map((target) => {
    const direction = target.clone().sub(origin);
    const length = direction.length();
    return { origin, direction: direction.divideScalar(Math.max(1e-6, length)), length };
  });
}

// A sphere around its centre with every vertex; every fifth is enough for large ones.
function FindRadius(body: Body, floats: Float32Array): number {
  let square = 0;
  const step = 3 * Math.max(1, Math.floor(body.vertexCount / 200));
  for (let at = body.vertices; at < body.vertices + 3 * body.vertexCount; at += step) {
    const x = floats[at] - body.x;
    const y = floats[at + 1] - body.y;
    const z = floats[at + 2] - body.z;
    square = Math.max(square, x * x + y * y + z * z);
  }
  return 1.05 * Math.sqrt(square);
}

function IsNear({ origin, direction, length }: Sight, body: Body, radius: number): boolean {
  const x = body.x - origin.x;
  const y = body.y - origin.y;
  const z = body.z - origin.z;
  const along = Math.max(0, Math.min(length, x * direction.x + y * direction.y + z * direction.z));
  return Math.hypot(x - along * direction.x, y - along * direction.y, z - along * direction.z) < radius;
}

function Stops(ray: Sight, body: Body, floats: Float32Array, faces: Uint16Array): boolean {
  for (let i = 0; i < faces.length; i += 3) {
    if (HitTriangle(ray, floats, body.vertices, faces[i], faces[i + 1], faces[i + 2]) < ray.length) return true;
  }
  return false;
}
