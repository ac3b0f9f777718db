// One body on the graphics card: buffers that are kept while the number of vertices stays the same, and filled from
// linear memory when the vertices have changed.
import {
  BufferAttribute,
  BufferGeometry,
  type Color,
  DynamicDrawUsage,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  Sphere,
} from 'three';
import type { Blueprint, Body } from 'wobble-client';
import { BodyMaterial } from './body_material';
import { ExtendRest, FillMiddles, MakeFiner } from './finer';

const kMostFiner = 1500; // vertices of a body up to which its surface is refined
const kNoEdges = new Uint16Array();
const kVeiled = 0.3; // share of the pixels of a see-through body
const kVeilLag = 0.12; // s
const kWireShade = 0.45; // brightness relative to the body's colour

export class BodyShape {
  readonly mesh: Mesh;
  readonly wires: LineSegments<BufferGeometry, LineBasicMaterial>;
  blueprint: Blueprint;
  round = 0; // number of the last frame that had the body

  private readonly m_material = new BodyMaterial();
  private readonly m_geometry = new BufferGeometry();
  private readonly m_wireGeometry = new BufferGeometry();
  private m_positions = new Float32Array();
  private m_normals = new Float32Array();
  private m_revision = 0;
  private m_shown = 1;
  private m_middles: Uint16Array = kNoEdges; // edges with a vertex in their middle
  private readonly m_isFine: boolean;

  // isFine: refine the surface.
  constructor(blueprint: Blueprint, isFine: boolean) {
    this.blueprint = blueprint;
    this.m_isFine = isFine;
    this.m_geometry.boundingSphere = new Sphere();
    this.m_wireGeometry.boundingSphere = this.m_geometry.boundingSphere;
    this.mesh = new Mesh(this.m_geometry, this.m_material.material);
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.matrixAutoUpdate = false;
    this.wires = new LineSegments(this.m_wireGeometry, new LineBasicMaterial());
    this.wires.matrixAutoUpdate = false;
    this.TakeBlueprint(blueprint);
  }

  get positions(): Float32Array {
    return this.m_positions;
  }

  // A torn cloth keeps its vertices and loses faces.
  TakeBlueprint(blueprint: Blueprint): void {
    this.blueprint = blueprint;
    this.m_revision = 0;
    const vertexCount = blueprint.rest.length / 3;
    const finer = this.m_isFine && vertexCount <= kMostFiner ? MakeFiner(vertexCount, blueprint.faces) : null;
    this.m_middles = finer?.edges ?? kNoEdges;
    const size = 3 * (vertexCount + this.m_middles.length / 2);
    if (this.m_positions.length !== size) this.MakeBuffers(size);
    this.m_geometry.setAttribute('rest', new BufferAttribute(ExtendRest(blueprint.rest, this.m_middles), 3));
    this.m_geometry.setIndex(new BufferAttribute(finer?.faces ?? blueprint.faces, 1));
    this.m_wireGeometry.setIndex(new BufferAttribute(FindFaceEdges(blueprint.faces), 1));
  }

  private MakeBuffers(size: number): void {
    this.m_geometry.dispose();
    this.m_wireGeometry.dispose();
    this.m_positions = new Float32Array(size);
    this.m_normals = new Float32Array(size);
    const positions = new BufferAttribute(this.m_positions, 3).setUsage(DynamicDrawUsage);
    this.m_geometry.setAttribute('position', positions);
    this.m_geometry.setAttribute('normal', new BufferAttribute(this.m_normals, 3).setUsage(DynamicDrawUsage));
    this.m_wireGeometry.setAttribute('position', positions);
  }

  Dress(isPlayer: boolean, colour: Color): void {
    this.m_material.Dress(this.blueprint, isPlayer, colour);
    this.wires.material.color.copy(colour).multiplyScalar(kWireShade);
  }

  // Makes it see-through, or solid again, in a short time. seconds: since the last call.
  Veil(isVeiled: boolean, seconds: number): void {
    const wished = isVeiled ? kVeiled : 1;
    if (this.m_shown === wished) return;
    const next = wished + (this.m_shown - wished) * Math.exp(-seconds / kVeilLag);
    this.m_shown = Math.abs(next - wished) < 0.02 ? wished : next;
    this.m_material.shown = this.m_shown;
  }

  // floats: linear memory.
  Update(body: Body, floats: Float32Array): void {
    if (body.revision === this.m_revision || 3 * body.vertexCount !== this.blueprint.rest.length) return;
    this.m_revision = body.revision;
    const count = 3 * body.vertexCount;
    for (let i = 0; i < count; ++i) {
      this.m_positions[i] = floats[body.vertices + i];
      this.m_normals[i] = floats[body.normals + i];
    }
    FillMiddles(this.m_middles, body.vertexCount, this.m_positions, this.m_normals);
    this.m_geometry.attributes.position.needsUpdate = true;
    this.m_geometry.attributes.normal.needsUpdate = true;
    this.BoundSphere(body);
  }

  // three.js would compute the sphere in another pass, with allocations.
  private BoundSphere(body: Body): void {
    const sphere = this.m_geometry.boundingSphere!;
    let square = 0;
    for (let i = 0; i < this.m_positions.length; i += 3) {
      const x = this.m_positions[i] - body.x;
      const y = this.m_positions[i + 1] - body.y;
      const z = this.m_positions[i + 2] - body.z;
      square = Math.max(square, x * x + y * y + z * z);
    }
    sphere.center.set(body.x, body.y, body.z);
    sphere.radius = Math.sqrt(square);
  }

  Dispose(): void {
    this.m_geometry.dispose();
    this.m_wireGeometry.dispose();
    this.m_material.material.dispose();
    this.wires.material.dispose();
  }
}

// Each edge once.
export function FindFaceEdges(faces: Uint16Array): Uint16Array {
  const seen = new Set<number>();
  const edges: number[] = [];
  for (let i = 0; i < faces.length; ++i) {
    const from = faces[i];
    const to = faces[i % 3 === 2 ? i - 2 : i + 1];
    const key = from < to ? from * 65536 + to : to * 65536 + from;
    if (seen.has(key)) continue;
    seen.add(key);
    edges.push(from, to);
  }
  return new Uint16Array(edges);
}
