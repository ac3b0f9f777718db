// The eyes of players. They sit on the current surface, on the side of the direction of motion, so that a rolling ball
// does not roll them away. They look ahead, blink, and open wide in the air.
import { DynamicDrawUsage, InstancedMesh, MeshStandardMaterial, SphereGeometry, Vector3, type Object3D } from 'three';
import type { Body, Client } from 'wobble-client';
import type { Players } from '../players';

const kMaxPlayers = 128;
const kSpacing = 0.36; // rad to either side
const kLift = 0.38; // rad above the horizon
const kTurnLag = 0.18; // s
const kSharpness = 14; // exponent of the weights that find the surface in a direction
const kEyeShare = 0.25; // size relative to the body
const kBlinkEvery = 3.4; // s
const kBlinkFor = 0.13;

interface Gaze {
  x: number;
  y: number;
  z: number; // previous position
  yaw: number;
  wished: number;
  fall: number; // m/s, vertical, smoothed
}

export class Eyes {
  private readonly m_whites = MakeBalls('#ffffff', 0.15);
  private readonly m_pupils = MakeBalls('#1b1420', 0.1);
  private readonly m_gazes = new Map<number, Gaze>();
  private readonly m_direction = new Vector3();
  private m_count = 0;

  constructor(parent: Object3D) {
    parent.add(this.m_whites, this.m_pupils);
  }

  // seconds: since the last call.
  Update(client: Client, players: Players, now: number, seconds: number, isShown: boolean): void {
    this.m_count = 0;
    const floats = client.readFloats();
    for (const player of players.all.values()) {
      const body = player.body === 0 ? null : client.findBody(player.body);
      if (body === null || body.normals === 0 || this.m_count + 2 > 2 * kMaxPlayers || !isShown) continue;
      this.AddPair(body, floats, client.findBlueprint(body.blueprint).size, this.Turn(body, seconds), now);
    }
    for (const balls of [this.m_whites, this.m_pupils]) {
      balls.count = this.m_count;
      balls.visible = this.m_count > 0;
      balls.instanceMatrix.needsUpdate = true;
    }
    if (this.m_gazes.size > 2 * kMaxPlayers) this.m_gazes.clear();
  }

  private Turn(body: Body, seconds: number): Gaze {
    let gaze = this.m_gazes.get(body.body);
    if (gaze === undefined) {
      gaze = { x: body.x, y: body.y, z: body.z, yaw: -Math.PI / 2, wished: -Math.PI / 2, fall: 0 };
      this.m_gazes.set(body.body, gaze);
    }
    if (seconds > 0) {
      const speed = Math.hypot(body.x - gaze.x, body.y - gaze.y) / seconds;
      if (speed > 0.5 && speed < 50) gaze.wished = Math.atan2(body.y - gaze.y, body.x - gaze.x);
      const turn = Math.atan2(Math.sin(gaze.wished - gaze.yaw), Math.cos(gaze.wished - gaze.yaw));
      const share = 1 - Math.exp(-seconds / kTurnLag);
      gaze.yaw += turn * share;
      gaze.fall += ((body.z - gaze.z) / seconds - gaze.fall) * share;
    }
    gaze.x = body.x;
    gaze.y = body.y;
    gaze.z = body.z;
    return gaze;
  }

  private AddPair(body: Body, floats: Float32Array, size: number, gaze: Gaze, now: number): void {
    const sinceBlink = (now + 0.7 * (body.body % 11)) % kBlinkEvery;
    const isWide = Math.abs(gaze.fall) > 2.5;
    const lid = sinceBlink < kBlinkFor && !isWide ? 0.15 : 1;
    const eye = size * kEyeShare * (isWide ? 1.25 : 1);
    const look = Math.max(-0.5, Math.min(0.5, gaze.fall * 0.08));
    for (const side of [-1, 1]) {
      const yaw = gaze.yaw + side * kSpacing;
      const direction = this.m_direction.set(
        Math.cos(yaw) * Math.cos(kLift),
        Math.sin(yaw) * Math.cos(kLift),
        Math.sin(kLift),
      );
      const radius = FindRadius(body, floats, direction) - 0.38 * eye;
      WriteBall(this.m_whites, this.m_count, body, direction, radius, eye, lid);
      // The pupil protrudes from the eye.
      const ahead = this.m_direction.set(
        direction.x * radius + 0.36 * eye * (0.55 * direction.x + Math.cos(gaze.yaw)),
        direction.y * radius + 0.36 * eye * (0.55 * direction.y + Math.sin(gaze.yaw)),
        direction.z * radius + 0.36 * eye * (0.35 * direction.z + look),
      );
      WriteBall(this.m_pupils, this.m_count, body, ahead, 1, 0.6 * eye, lid);
      this.m_count += 1;
    }
  }
}

function MakeBalls(colour: string, roughness: number): InstancedMesh {
  const material = new MeshStandardMaterial({ color: colour, roughness });
  const balls = new InstancedMesh(new SphereGeometry(1, 20, 14), material, 2 * kMaxPlayers);
  balls.instanceMatrix.setUsage(DynamicDrawUsage);
  balls.frustumCulled = false;
  balls.count = 0;
  return balls;
}

// Distance of the surface from the centre in this direction: the mean over the vertices near it.
function FindRadius(body: Body, floats: Float32Array, direction: Vector3): number {
  let sum = 0;
  let weights = 1e-9;
  for (let i = 0, at = body.vertices; i < body.vertexCount; ++i, at += 3) {
    const x = floats[at] - body.x;
    const y = floats[at + 1] - body.y;
    const z = floats[at + 2] - body.z;
    const along = x * direction.x + y * direction.y + z * direction.z;
    if (along <= 0) continue;
    const length = Math.hypot(x, y, z);
    const weight = Math.exp(kSharpness * (along / length - 1));
    sum += weight * length;
    weights += weight;
  }
  return sum / weights;
}

function WriteBall(
  balls: InstancedMesh,
  index: number,
  body: Body,
  direction: Vector3,
  distance: number,
  radius: number,
  lid: number,
): void {
  const matrix = balls.instanceMatrix.array as Float32Array;
  const at = 16 * index;
  matrix.fill(0, at, at + 16);
  matrix[at] = matrix[at + 5] = radius;
  matrix[at + 10] = radius * lid;
  matrix[at + 12] = body.x + direction.x * distance;
  matrix[at + 13] = body.y + direction.y * distance;
  matrix[at + 14] = body.z + direction.z * distance;
  matrix[at + 15] = 1;
}
