// Many rods and dots in two draw calls: springs and particles of bodies that have no faces, or whose surface is hidden.
// The colour of a spring shows its strain: blue when compressed, red when stretched.
import {
  CylinderGeometry,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedMesh,
  MeshStandardMaterial,
  SphereGeometry,
  type Object3D,
} from 'three';

const kFirstCapacity = 256;
const kFullStrain = 0.25; // strain at which the colour saturates

export class Springs {
  private m_rods: InstancedMesh;
  private m_dots: InstancedMesh;
  private m_rodCount = 0;
  private m_dotCount = 0;
  private readonly m_parent: Object3D;

  constructor(parent: Object3D) {
    this.m_parent = parent;
    this.m_rods = MakeInstances(MakeRodGeometry(), kFirstCapacity);
    this.m_dots = MakeInstances(new SphereGeometry(1, 12, 8), kFirstCapacity);
    parent.add(this.m_rods, this.m_dots);
  }

  // Begins a new frame.
  Clear(): void {
    this.m_rodCount = this.m_dotCount = 0;
  }

  // from, to: indices into floats. strain: relative to the rest length.
  AddRod(floats: Float32Array, from: number, to: number, radius: number, strain: number): void {
    if (this.m_rodCount === this.m_rods.instanceMatrix.count) this.m_rods = Grow(this.m_rods, this.m_parent);
    const at = this.m_rodCount++;
    WriteRod(this.m_rods.instanceMatrix.array as Float32Array, 16 * at, floats, from, to, radius);
    const colours = this.m_rods.instanceColor!.array as Float32Array;
    const share = Math.max(-1, Math.min(1, strain / kFullStrain));
    const grey = 1 - Math.abs(share);
    colours[3 * at] = 0.42 * grey + (share > 0 ? 0.95 * share : 0);
    colours[3 * at + 1] = 0.47 * grey + 0.14 * Math.abs(share);
    colours[3 * at + 2] = 0.55 * grey + (share < 0 ? -0.95 * share : 0.05 * share);
  }

  AddDot(floats: Float32Array, at: number, radius: number, red: number, green: number, blue: number): void {
    if (this.m_dotCount === this.m_dots.instanceMatrix.count) this.m_dots = Grow(this.m_dots, this.m_parent);
    const matrix = this.m_dots.instanceMatrix.array as Float32Array;
    const to = 16 * this.m_dotCount;
    matrix[to] = matrix[to + 5] = matrix[to + 10] = radius;
    matrix[to + 12] = floats[at];
    matrix[to + 13] = floats[at + 1];
    matrix[to + 14] = floats[at + 2];
    matrix[to + 15] = 1;
    const colours = this.m_dots.instanceColor!.array as Float32Array;
    colours[3 * this.m_dotCount] = red;
    colours[3 * this.m_dotCount + 1] = green;
    colours[3 * this.m_dotCount + 2] = blue;
    this.m_dotCount += 1;
  }

  // Ends the frame.
  Show(): void {
    ShowInstances(this.m_rods, this.m_rodCount);
    ShowInstances(this.m_dots, this.m_dotCount);
  }
}

// Length 1 along z from the origin.
function MakeRodGeometry(): CylinderGeometry {
  const geometry = new CylinderGeometry(1, 1, 1, 6, 1, true);
  geometry.rotateX(Math.PI / 2);
  geometry.translate(0, 0, 0.5);
  return geometry;
}

function MakeInstances(geometry: CylinderGeometry | SphereGeometry, capacity: number): InstancedMesh {
  const mesh = new InstancedMesh(geometry, new MeshStandardMaterial({ roughness: 0.45 }), capacity);
  mesh.instanceMatrix.array.fill(0);
  mesh.instanceMatrix.setUsage(DynamicDrawUsage);
  mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * capacity), 3).setUsage(DynamicDrawUsage);
  mesh.castShadow = mesh.receiveShadow = true;
  mesh.frustumCulled = false;
  mesh.count = 0;
  return mesh;
}

function Grow(mesh: InstancedMesh, parent: Object3D): InstancedMesh {
  const larger = MakeInstances(mesh.geometry as SphereGeometry, 2 * mesh.instanceMatrix.count);
  larger.instanceMatrix.array.set(mesh.instanceMatrix.array);
  larger.instanceColor!.array.set(mesh.instanceColor!.array);
  parent.remove(mesh);
  mesh.dispose();
  parent.add(larger);
  return larger;
}

function ShowInstances(mesh: InstancedMesh, count: number): void {
  mesh.count = count;
  mesh.visible = count > 0;
  mesh.instanceMatrix.clearUpdateRanges();
  mesh.instanceMatrix.addUpdateRange(0, 16 * count);
  mesh.instanceMatrix.needsUpdate = true;
  mesh.instanceColor!.clearUpdateRanges();
  mesh.instanceColor!.addUpdateRange(0, 3 * count);
  mesh.instanceColor!.needsUpdate = true;
}

// Writes the matrix that maps the unit rod to the segment between two points: z along it, x and y across.
export function WriteRod(
  matrix: Float32Array,
  at: number,
  floats: Float32Array,
  from: number,
  to: number,
  radius: number,
): void {
  const x = floats[to] - floats[from];
  const y = floats[to + 1] - floats[from + 1];
  const z = floats[to + 2] - floats[from + 2];
  const length = Math.hypot(x, y, z) || 1e-6;
  // Across: the axis least parallel to the rod, orthogonalised.
  const isUpright = Math.abs(z) > 0.9 * length;
  let ax = isUpright ? 0 : -y;
  let ay = isUpright ? z : x;
  let az = isUpright ? -y : 0;
  const across = radius / (Math.hypot(ax, ay, az) || 1e-6);
  ax *= across;
  ay *= across;
  az *= across;
  matrix[at] = ax;
  matrix[at + 1] = ay;
  matrix[at + 2] = az;
  matrix[at + 3] = 0;
  matrix[at + 4] = (y * az - z * ay) / length;
  matrix[at + 5] = (z * ax - x * az) / length;
  matrix[at + 6] = (x * ay - y * ax) / length;
  matrix[at + 7] = 0;
  matrix[at + 8] = x;
  matrix[at + 9] = y;
  matrix[at + 10] = z;
  matrix[at + 11] = 0;
  matrix[at + 12] = floats[from];
  matrix[at + 13] = floats[from + 1];
  matrix[at + 14] = floats[from + 2];
  matrix[at + 15] = 1;
}
