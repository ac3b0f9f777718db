// Finds what lies under a point of the screen: bodies as they are shown, by their faces or springs; otherwise the
// static scene.
import { Raycaster, Vector2, Vector3, type Mesh, type PerspectiveCamera } from 'three';
import type { Blueprint, Body, Client, Vector } from 'wobble-client';

const kRodReach = 14; // pixels; a spring or a particle is hit within this distance

export interface Pick {
  body: number;
  vertex: number; // the vertex nearest to the point
  edge: number; // for bodies without faces, else -1
  distance: number; // m from the eye
  point: Vector;
}

export interface Ray {
  origin: Vector3;
  direction: Vector3; // unit vector
}

export class Picking {
  readonly ray: Ray = { origin: new Vector3(), direction: new Vector3() };
  private readonly m_camera: PerspectiveCamera;
  private readonly m_caster = new Raycaster();
  private readonly m_place = new Vector2();
  private m_pixel = 0; // m per pixel at 1 m from the eye

  constructor(camera: PerspectiveCamera) {
    this.m_camera = camera;
  }

  // x, y: pixels of the window.
  AimAt(x: number, y: number): Ray {
    this.m_place.set((2 * x) / window.innerWidth - 1, 1 - (2 * y) / window.innerHeight);
    this.m_caster.setFromCamera(this.m_place, this.m_camera);
    this.ray.origin.copy(this.m_caster.ray.origin);
    this.ray.direction.copy(this.m_caster.ray.direction);
    this.m_pixel = (2 * Math.tan((this.m_camera.fov * Math.PI) / 360)) / window.innerHeight;
    return this.ray;
  }

  // The nearest body on the ray, or null. except: a body to ignore; 0: none.
  FindBody(client: Client, except = 0): Pick | null {
    let best: Pick | null = null;
    const floats = client.readFloats();
    for (let i = 0; i < client.bodyCount; ++i) {
      const body = client.bodies[i];
      if (body.body === except) continue;
      const blueprint = client.findBlueprint(body.blueprint);
      if (!this.IsNear(body, floats)) continue;
      const pick =
        blueprint.faces.length > 0 ? this.HitFaces(body, blueprint, floats) : this.HitSprings(body, blueprint, floats);
      if (pick !== null && (best === null || pick.distance < best.distance)) best = pick;
    }
    return best;
  }

  // The point where the ray meets the static scene; null: nowhere within 200 m.
  FindSolid(solids: Mesh[]): Vector3 | null {
    this.m_caster.far = 200;
    const hits = this.m_caster.intersectObjects(solids, false);
    return hits.length > 0 ? hits[0].point : null;
  }

  // The point where the ray meets the plane through `point` that faces the camera; null: behind the camera.
  FindFacing(point: Vector, out: Vector3): Vector3 | null {
    const forward = this.m_camera.getWorldDirection(new Vector3());
    const { origin, direction } = this.ray;
    const away = (point.x - origin.x) * forward.x + (point.y - origin.y) * forward.y + (point.z - origin.z) * forward.z;
    const along = direction.dot(forward);
    if (along <= 1e-6 || away <= 0) return null;
    return out.copy(origin).addScaledVector(direction, away / along);
  }

  // Whether the ray comes near the vertices' bounding box; every fifth vertex is enough for this test.
  private IsNear(body: Body, floats: Float32Array): boolean {
    let square = 0.01;
    const step = 3 * Math.max(1, Math.floor(body.vertexCount / 200));
    const end = body.vertices + 3 * body.vertexCount;
    for (let at = body.vertices; at < end; at += step) {
      const x = floats[at] - body.x;
      const y = floats[at + 1] - body.y;
      const z = floats[at + 2] - body.z;
      square = Math.max(square, x * x + y * y + z * z);
    }
    const { origin, direction } = this.ray;
    const x = body.x - origin.x;
    const y = body.y - origin.y;
    const z = body.z - origin.z;
    const along = x * direction.x + y * direction.y + z * direction.z;
    const reach = 1.3 * Math.sqrt(square) + 0.1 + kRodReach * this.m_pixel * Math.max(0, along);
    return x * x + y * y + z * z - along * along < reach * reach && along > -reach;
  }

  private HitFaces(body: Body, blueprint: Blueprint, floats: Float32Array): Pick | null {
    const { faces } = blueprint;
    let distance = Infinity;
    let face = -1;
    for (let i = 0; i < faces.length; i += 3) {
      const hit = HitTriangle(this.ray, floats, body.vertices, faces[i], faces[i + 1], faces[i + 2]);
      if (hit < distance) {
        distance = hit;
        face = i;
      }
    }
    if (face < 0) return null;
    const point = this.FindPoint(distance);
    let vertex = faces[face];
    let nearest = Infinity;
    for (let i = face; i < face + 3; ++i) {
      const away = FindAway(floats, body.vertices + 3 * faces[i], point);
      if (away < nearest) {
        nearest = away;
        vertex = faces[i];
      }
    }
    return { body: body.body, vertex, edge: -1, distance, point };
  }

  // A near particle has priority over a spring; otherwise the ends of a spring could not be picked.
  private HitSprings(body: Body, blueprint: Blueprint, floats: Float32Array): Pick | null {
    let best: Pick | null = null;
    let bestAway = kRodReach * this.m_pixel;
    const { origin, direction } = this.ray;
    for (let i = 0; i < body.vertexCount; ++i) {
      const at = body.vertices + 3 * i;
      const x = floats[at] - origin.x;
      const y = floats[at + 1] - origin.y;
      const z = floats[at + 2] - origin.z;
      const along = x * direction.x + y * direction.y + z * direction.z;
      if (along <= 0) continue;
      const away = Math.sqrt(Math.max(0, x * x + y * y + z * z - along * along)) / along;
      if (away >= bestAway) continue;
      bestAway = away;
      best = { body: body.body, vertex: i, edge: -1, distance: along, point: MakePoint(floats, at) };
    }
    if (best !== null) return best;
    for (let i = 0; i < blueprint.edges.length; i += 2) {
      const from = body.vertices + 3 * blueprint.edges[i];
      const to = body.vertices + 3 * blueprint.edges[i + 1];
      const hit = HitRod(this.ray, floats, from, to);
      if (hit.distance <= 0 || hit.away / hit.distance >= bestAway) continue;
      bestAway = hit.away / hit.distance;
      const vertex = blueprint.edges[hit.share < 0.5 ? i : i + 1];
      const point = this.FindPoint(hit.distance);
      best = { body: body.body, vertex, edge: i / 2, distance: hit.distance, point };
    }
    return best;
  }

  private FindPoint(distance: number): Vector {
    const { origin, direction } = this.ray;
    return {
      x: origin.x + direction.x * distance,
      y: origin.y + direction.y * distance,
      z: origin.z + direction.z * distance,
    };
  }
}

export function MakePoint(floats: Float32Array, at: number): Vector {
  return { x: floats[at], y: floats[at + 1], z: floats[at + 2] };
}

function FindAway(floats: Float32Array, at: number, point: Vector): number {
  return Math.hypot(floats[at] - point.x, floats[at + 1] - point.y, floats[at + 2] - point.z);
}

// Möller and Trumbore 1997: distance along the ray to the triangle, from either side; Infinity: no hit.
export function HitTriangle(ray: Ray, floats: Float32Array, first: number, a: number, b: number, c: number): number {
  const { origin: o, direction: d } = ray;
  const at = first + 3 * a;
  const bt = first + 3 * b;
  const ct = first + 3 * c;
  const e1x = floats[bt] - floats[at];
  const e1y = floats[bt + 1] - floats[at + 1];
  const e1z = floats[bt + 2] - floats[at + 2];
  const e2x = floats[ct] - floats[at];
  const e2y = floats[ct + 1] - floats[at + 1];
  const e2z = floats[ct + 2] - floats[at + 2];
  const px = d.y * e2z - d.z * e2y;
  const py = d.z * e2x - d.x * e2z;
  const pz = d.x * e2y - d.y * e2x;
  const determinant = e1x * px + e1y * py + e1z * pz;
  if (Math.abs(determinant) < 1e-12) return Infinity;
  const tx = o.x - floats[at];
  const ty = o.y - floats[at + 1];
  const tz = o.z - floats[at + 2];
  const u = (tx * px + ty * py + tz * pz) / determinant;
  if (u < 0 || u > 1) return Infinity;
  const qx = ty * e1z - tz * e1y;
  const qy = tz * e1x - tx * e1z;
  const qz = tx * e1y - ty * e1x;
  const v = (d.x * qx + d.y * qy + d.z * qz) / determinant;
  if (v < 0 || u + v > 1) return Infinity;
  const distance = (e2x * qx + e2y * qy + e2z * qz) / determinant;
  return distance > 0.01 ? distance : Infinity;
}

// Nearest approach of the ray to the rod.
function HitRod(ray: Ray, floats: Float32Array, from: number, to: number) {
  const { origin: o, direction: d } = ray;
  const rx = floats[to] - floats[from];
  const ry = floats[to + 1] - floats[from + 1];
  const rz = floats[to + 2] - floats[from + 2];
  const wx = floats[from] - o.x;
  const wy = floats[from + 1] - o.y;
  const wz = floats[from + 2] - o.z;
  const rr = rx * rx + ry * ry + rz * rz;
  const rd = rx * d.x + ry * d.y + rz * d.z;
  const wr = wx * rx + wy * ry + wz * rz;
  const wd = wx * d.x + wy * d.y + wz * d.z;
  const across = rr - rd * rd;
  const share = across > 1e-9 ? Math.max(0, Math.min(1, (rd * wd - wr) / across)) : 0;
  const distance = wd + share * rd;
  const away = Math.hypot(
    wx + share * rx - distance * d.x,
    wy + share * ry - distance * d.y,
    wz + share * rz - distance * d.z,
  );
  return { share, distance, away };
}
