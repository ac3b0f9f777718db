// The static scene: floors, walls, boxes, spheres, capsules and hills.
//
// A wall that is a plane has nothing behind it, and the camera often stands there: it is drawn as a pane of light that
// is visible from the inside only.
import {
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CircleGeometry,
  Color,
  FrontSide,
  Group,
  Mesh,
  Quaternion,
  ShaderMaterial,
  SphereGeometry,
  Vector3,
  type Material,
} from 'three';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import { ObstacleKind, type Ground, type Obstacle, type Vector } from 'wobble-client';
import { MakeGroundMaterial } from './ground_material';
import { MakeSideColour } from './colours';
import { Clip, MakeSquare, type HalfSpace } from './polygon';

const kFloorRadius = 320; // m
const kWallHeight = 3.2; // m, of a plane
const kPlaneHalfWidth = 120; // m, of a slope
const kEdge = 0.07; // m, radius of a box's edges

const kPaneVertexShader = `
varying vec3 vPlace;
void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const kPaneFragmentShader = `
uniform vec3 colour;
uniform float floorHeight;
uniform float height;
varying vec3 vPlace;
void main() {
  float h = clamp((vPlace.z - floorHeight) / height, 0.0, 1.0);
  float bands = 0.5 + 0.5 * cos(6.2832 * vPlace.z / 0.4);
  float alpha = (0.34 + 0.10 * bands) * pow(1.0 - h, 2.2) + 0.5 * smoothstep(0.025, 0.0, h);
  gl_FragColor = vec4(colour, alpha);
  #include <colorspace_fragment>
}`;

export class Arena {
  readonly group = new Group();
  // Targets of rays: everything solid.
  readonly solids: Mesh[] = [];
  private readonly m_floor = MakeGroundMaterial('#e9e2d2');
  private readonly m_block = MakeGroundMaterial('#8ccdc4');
  private readonly m_round = MakeGroundMaterial('#e8b68a');
  private readonly m_posts = [1, 2].map((side) => MakeGroundMaterial(`#${MakeSideColour(side).getHexString()}`));
  private readonly m_hill = MakeGroundMaterial('#ffffff', true);

  private m_hasGoals = false;

  // Replaces the previous scene. game: its name; in goals, posts have the colour of the side whose goal it is.
  Build(obstacles: Obstacle[], grounds: Ground[], game: string): void {
    this.Clear();
    this.m_hasGoals = game === 'goals';
    const planes = obstacles.filter((each) => each.kind === ObstacleKind.Plane).map(MakeHalfSpace);
    for (const plane of planes) this.AddPlane(plane, planes);
    for (const obstacle of obstacles) this.AddObstacle(obstacle);
    for (const ground of grounds) this.AddGround(ground);
  }

  private Clear(): void {
    for (const child of this.group.children) (child as Mesh).geometry.dispose();
    this.group.clear();
    this.solids.length = 0;
  }

  private AddObstacle(obstacle: Obstacle): void {
    const { a, b, radius } = obstacle;
    if (obstacle.kind === ObstacleKind.Box) {
      const edge = Math.min(kEdge, 0.4 * Math.min(b.x, b.y, b.z));
      const isFloor = b.x > 3 * b.z && b.y > 3 * b.z;
      const box = new RoundedBoxGeometry(2 * b.x, 2 * b.y, 2 * b.z, 3, edge);
      this.AddSolid(box, isFloor ? this.m_floor : this.m_block).position.set(a.x, a.y, a.z);
    } else if (obstacle.kind === ObstacleKind.Sphere) {
      this.AddSolid(new SphereGeometry(radius, 48, 32), this.m_round).position.set(a.x, a.y, a.z);
    } else if (obstacle.kind === ObstacleKind.Capsule) {
      const from = MakeVector(a);
      const to = MakeVector(b);
      const mesh = this.AddSolid(new CapsuleGeometry(radius, from.distanceTo(to), 12, 32), this.FindPostMaterial(a));
      mesh.position.addVectors(from, to).multiplyScalar(0.5);
      const along = to.sub(from).normalize();
      if (along.lengthSq() > 0) mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along));
    }
  }

  private FindPostMaterial(place: Vector): Material {
    return this.m_hasGoals ? this.m_posts[place.x < 0 ? 0 : 1] : this.m_round;
  }

  private AddPlane(plane: HalfSpace, planes: HalfSpace[]): void {
    if (plane.normal.z > 0.999) {
      const floor = this.AddSolid(new CircleGeometry(kFloorRadius, 64), this.m_floor);
      floor.position.z = plane.offset;
      floor.castShadow = false;
      return;
    }
    let polygon = MakeSquare(plane, new Vector3(), kPlaneHalfWidth);
    for (const other of planes) if (other !== plane && polygon.length > 2) polygon = Clip(polygon, other);
    if (plane.normal.z > 0.3) {
      if (polygon.length > 2) this.AddSolid(MakePolygonGeometry(polygon), this.m_floor).castShadow = false;
      return;
    }
    const floorHeight = FindFloor(planes);
    polygon = Clip(polygon, { normal: new Vector3(0, 0, 1), offset: floorHeight });
    polygon = Clip(polygon, { normal: new Vector3(0, 0, -1), offset: -(floorHeight + kWallHeight) });
    if (polygon.length > 2) this.group.add(new Mesh(MakePolygonGeometry(polygon), MakePaneMaterial(floorHeight)));
  }

  private AddGround(ground: Ground): void {
    const mesh = this.AddSolid(MakeGroundGeometry(ground), this.m_hill);
    mesh.position.set(ground.corner.x, ground.corner.y, 0);
  }

  private AddSolid(geometry: BufferGeometry, material: Material): Mesh {
    const mesh = new Mesh(geometry, material);
    mesh.castShadow = mesh.receiveShadow = true;
    this.group.add(mesh);
    this.solids.push(mesh);
    return mesh;
  }
}

function MakeVector(from: Vector): Vector3 {
  return new Vector3(from.x, from.y, from.z);
}

function MakeHalfSpace(obstacle: Obstacle): HalfSpace {
  return { normal: MakeVector(obstacle.a), offset: obstacle.b.x };
}

// The greatest height of a floor on the vertical through the origin: walls begin there.
function FindFloor(planes: HalfSpace[]): number {
  const floors = planes.filter((plane) => plane.normal.z > 0.3).map((plane) => plane.offset / plane.normal.z);
  return floors.length === 0 ? 0 : Math.max(...floors);
}

function MakePolygonGeometry(polygon: Vector3[]): BufferGeometry {
  const geometry = new BufferGeometry().setFromPoints(polygon);
  const faces: number[] = [];
  for (let i = 2; i < polygon.length; ++i) faces.push(0, i - 1, i);
  geometry.setIndex(faces);
  geometry.computeVertexNormals();
  return geometry;
}

function MakePaneMaterial(floorHeight: number): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: {
      colour: { value: new Color('#6fb3d9') },
      floorHeight: { value: floorHeight },
      height: { value: kWallHeight },
    },
    vertexShader: kPaneVertexShader,
    fragmentShader: kPaneFragmentShader,
    transparent: true,
    depthWrite: false,
    side: FrontSide,
  });
}

// Low ground is green, high ground is like sand.
function MakeGroundGeometry(ground: Ground): BufferGeometry {
  const { columns, rows, cellSize, heights } = ground;
  const places = new Float32Array(3 * columns * rows);
  const colours = new Float32Array(3 * columns * rows);
  const low = new Color('#9ccf8f');
  const high = new Color('#eadfc0');
  const colour = new Color();
  let least = Infinity;
  let most = -Infinity;
  for (const height of heights) {
    least = Math.min(least, height);
    most = Math.max(most, height);
  }
  for (let i = 0; i < columns * rows; ++i) {
    places.set([(i % columns) * cellSize, Math.floor(i / columns) * cellSize, heights[i]], 3 * i);
    colour.lerpColors(low, high, most > least ? (heights[i] - least) / (most - least) : 0);
    colours.set([colour.r, colour.g, colour.b], 3 * i);
  }
  const faces: number[] = [];
  for (let row = 0; row + 1 < rows; ++row) {
    for (let column = 0; column + 1 < columns; ++column) {
      const a = row * columns + column;
      faces.push(a, a + 1, a + columns, a + 1, a + columns + 1, a + columns);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(places, 3));
  geometry.setAttribute('color', new BufferAttribute(colours, 3));
  geometry.setIndex(faces);
  geometry.computeVertexNormals();
  return geometry;
}
