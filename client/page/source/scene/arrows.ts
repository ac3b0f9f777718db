// Forces as arrows, one instance each. The length is proportional to the square root of the force, so that the weight
// of a vertex is visible beside an impact. All kinds except accelerations share one scale.
import {
  BufferGeometry,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedMesh,
  MeshBasicMaterial,
  type Object3D,
} from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { ForceKind, type Body, type Forces } from 'wobble-client';
import { WriteRod } from './springs';

const kMost = 4096;
const kLength = 0.5; // m; length of the largest
const kRadius = 0.012; // m
const kScaleLag = 0.85; // share of the old scale that is kept in each update

export const kForceColours: Record<ForceKind, string> = {
  [ForceKind.Elastic]: '#3f8cff',
  [ForceKind.Damping]: '#a25bff',
  [ForceKind.Gas]: '#ffd22e',
  [ForceKind.Weight]: '#39c46d',
  [ForceKind.Contact]: '#ff4d4d',
  [ForceKind.Other]: '#ffffff',
  [ForceKind.Acceleration]: '#ff7ad9',
};

export class Arrows {
  private readonly m_mesh: InstancedMesh;
  private readonly m_ends = new Float32Array(6);
  private readonly m_colours = new Map<ForceKind, Color>();
  private m_largest = 1; // N
  private m_largestAcceleration = 1; // m/s²

  constructor(parent: Object3D) {
    for (const [kind, colour] of Object.entries(kForceColours)) {
      this.m_colours.set(Number(kind), new Color(colour));
    }
    this.m_mesh = new InstancedMesh(
      MakeArrowGeometry(),
      new MeshBasicMaterial({ fog: false, toneMapped: false }),
      kMost,
    );
    this.m_mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.m_mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * kMost), 3).setUsage(DynamicDrawUsage);
    this.m_mesh.frustumCulled = false;
    this.m_mesh.visible = false;
    parent.add(this.m_mesh);
  }

  Hide(): void {
    this.m_mesh.visible = false;
  }

  // shown: the kinds to show. floats: linear memory, with the body's vertices.
  Update(forces: Forces, body: Body, floats: Float32Array, shown: Set<ForceKind>): void {
    this.FindScale(forces, shown);
    let count = 0;
    for (const { kind, values } of forces.fields) {
      if (!shown.has(kind)) continue;
      const largest = kind === ForceKind.Acceleration ? this.m_largestAcceleration : this.m_largest;
      for (let i = 0; 3 * i < values.length && count < kMost; ++i) {
        const vertex = i * forces.stride;
        if (vertex >= body.vertexCount) break;
        if (this.AddArrow(count, floats, body.vertices + 3 * vertex, values, 3 * i, largest, kind)) count += 1;
      }
    }
    this.m_mesh.count = count;
    this.m_mesh.visible = count > 0;
    this.m_mesh.instanceMatrix.needsUpdate = true;
    this.m_mesh.instanceColor!.needsUpdate = true;
  }

  private FindScale(forces: Forces, shown: Set<ForceKind>): void {
    let force = 1e-3;
    let acceleration = 1e-3;
    for (const { kind, values } of forces.fields) {
      if (!shown.has(kind)) continue;
      let largest = 0;
      for (let i = 0; i < values.length; i += 3) {
        largest = Math.max(largest, Math.hypot(values[i], values[i + 1], values[i + 2]));
      }
      if (kind === ForceKind.Acceleration) acceleration = Math.max(acceleration, largest);
      else force = Math.max(force, largest);
    }
    this.m_largest = Math.max(force, kScaleLag * this.m_largest);
    this.m_largestAcceleration = Math.max(acceleration, kScaleLag * this.m_largestAcceleration);
  }

  // False when the arrow would be too short to be visible.
  private AddArrow(
    index: number,
    floats: Float32Array,
    at: number,
    values: Float32Array,
    from: number,
    largest: number,
    kind: ForceKind,
  ): boolean {
    const force = Math.hypot(values[from], values[from + 1], values[from + 2]);
    const length = kLength * Math.sqrt(force / largest);
    if (length < 0.03) return false;
    const ends = this.m_ends;
    for (let i = 0; i < 3; ++i) {
      ends[i] = floats[at + i];
      ends[3 + i] = ends[i] + (values[from + i] / force) * length;
    }
    WriteRod(this.m_mesh.instanceMatrix.array as Float32Array, 16 * index, ends, 0, 3, kRadius);
    const colour = this.m_colours.get(kind)!;
    (this.m_mesh.instanceColor!.array as Float32Array).set([colour.r, colour.g, colour.b], 3 * index);
    return true;
  }
}

// Length 1 along z from the origin, radius 1.
function MakeArrowGeometry(): BufferGeometry {
  const rod = new CylinderGeometry(1, 1, 0.72, 5, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.36);
  const tip = new ConeGeometry(2.6, 0.28, 8).rotateX(Math.PI / 2).translate(0, 0, 0.86);
  return mergeGeometries([rod, tip]);
}
