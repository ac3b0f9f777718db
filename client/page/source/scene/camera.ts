// The camera: behind the player's body or a followed one, circling the middle of the scene, or moved freely.
//
// It approaches its target values exponentially, so that nothing jumps or depends on the frame rate; a body that starts
// again elsewhere is the exception. When following, the camera turns by itself towards the direction of motion, more
// slowly than a player would, and not for a while after the player has turned it.
import type { PerspectiveCamera } from 'three';
import type { Vector } from 'wobble-client';

export enum CameraMode {
  Follow = 'follow',
  Orbit = 'orbit',
  Free = 'free',
}

const kFollowDistance = 5.6; // m, before zoom
const kFollowPitch = 0.42; // rad downwards
const kOrbitPitch = 0.42;
const kAboveBody = 0.45; // m
const kLeastPitch = -0.12;
const kMostPitch = 1.5;
const kLeastZoom = 0.3;
const kMostZoom = 5;
const kFollowLag = 0.11; // s; time constants, after which 1/e of the way remains
const kOrbitLag = 0.9;
const kTurnLag = 0.07;
const kModeLag = 0.35;
const kOrbitSpeed = 0.09; // rad/s
const kHeadingSpeed = 0.6; // rad/s at most
const kHeadingPause = 2.5; // s after the player has turned the camera
const kWalkingSpeed = 5; // m/s from which the camera follows the heading at full speed
const kRespawnDistance = 4; // m; no body moves so far between two frames
const kFlySpeed = 7; // m/s

export class OrbitCamera {
  mode = CameraMode.Follow;
  readonly focus: Vector = { x: 0, y: 0, z: 1 };
  distance = kFollowDistance;
  yaw = Math.PI / 2; // rad; direction of view, from x to y

  private readonly m_isCalm: boolean;
  private m_yawAsked = Math.PI / 2;
  private m_pitch = kFollowPitch;
  private m_tilt = 0;
  private m_zoom = 1;
  private m_sinceTurn = 100;
  private m_isPlaced = false;

  // isCalm: never turns by itself.
  constructor(isCalm: boolean) {
    this.m_isCalm = isCalm;
  }

  ChooseNextMode(hasBody: boolean): void {
    const order = hasBody
      ? [CameraMode.Follow, CameraMode.Orbit, CameraMode.Free]
      : [CameraMode.Orbit, CameraMode.Free];
    this.mode = order[(order.indexOf(this.mode) + 1) % order.length];
  }

  // The next Update takes its values over at once.
  Reset(mode: CameraMode): void {
    this.mode = mode;
    this.m_isPlaced = false;
  }

  Turn(angle: number, tilt: number): void {
    this.m_yawAsked += angle;
    const pitch = this.FindPitch();
    this.m_tilt = Math.max(kLeastPitch - pitch, Math.min(kMostPitch - pitch, this.m_tilt + tilt));
    this.m_sinceTurn = 0;
  }

  Zoom(factor: number): void {
    this.m_zoom = Math.max(kLeastZoom, Math.min(kMostZoom, this.m_zoom * factor));
  }

  // Free mode only: right, forward and up as seen, -1 to 1 each.
  Fly(right: number, forward: number, up: number, seconds: number): void {
    const way = kFlySpeed * seconds * Math.max(1, this.m_zoom);
    const ahead = this.ToWorld(right, forward);
    this.focus.x += ahead.x * way;
    this.focus.y += ahead.y * way;
    this.focus.z = Math.max(-20, this.focus.z + up * way);
  }

  // own: centre of the body to follow or null; middle, spread: of all bodies, m.
  Update(seconds: number, own: Vector | null, middle: Vector, spread: number): void {
    const follows = this.mode === CameraMode.Follow && own !== null;
    const target = follows ? { x: own.x, y: own.y, z: own.z + kAboveBody } : middle;
    const wished = this.m_zoom * (follows ? kFollowDistance : Math.max(6, Math.min(50, 1.7 * spread)));
    this.m_sinceTurn += seconds;
    const { x, y, z } = this.focus;
    const gap = Math.hypot(target.x - x, target.y - y, target.z - z);
    if (!this.m_isPlaced || (follows && gap > kRespawnDistance && this.m_sinceTurn > kModeLag)) {
      Object.assign(this.focus, target);
    } else if (this.mode !== CameraMode.Free) {
      this.MoveFocus(target, seconds, follows ? kFollowLag : kOrbitLag, follows ? 2 : 1);
      if (follows && !this.m_isCalm) this.FollowHeading(seconds, this.focus.x - x, this.focus.y - y);
    }
    const pitch = this.FindPitch() + this.m_tilt;
    this.distance = this.m_isPlaced ? Approach(this.distance, wished, seconds, kModeLag / 2) : wished;
    this.m_pitch = this.m_isPlaced ? Approach(this.m_pitch, pitch, seconds, kTurnLag) : pitch;
    if (this.mode === CameraMode.Orbit && !this.m_isCalm && this.m_sinceTurn > kHeadingPause) {
      this.m_yawAsked += kOrbitSpeed * seconds;
    }
    this.yaw = Approach(this.yaw, this.m_yawAsked, seconds, kTurnLag);
    this.m_isPlaced = true;
  }

  Apply(camera: PerspectiveCamera): void {
    const level = Math.cos(this.m_pitch) * this.distance;
    camera.position.set(
      this.focus.x - level * Math.cos(this.yaw),
      this.focus.y - level * Math.sin(this.yaw),
      this.focus.z + Math.sin(this.m_pitch) * this.distance,
    );
    camera.lookAt(this.focus.x, this.focus.y, this.focus.z);
    camera.updateMatrixWorld();
  }

  // Converts right and forward as seen to the world's horizontal plane.
  ToWorld(right: number, forward: number): { x: number; y: number } {
    const x = Math.cos(this.yaw);
    const y = Math.sin(this.yaw);
    return { x: right * y + forward * x, y: -right * x + forward * y };
  }

  private FindPitch(): number {
    return this.mode === CameraMode.Follow ? kFollowPitch : kOrbitPitch;
  }

  private MoveFocus(target: Vector, seconds: number, lag: number, heightShare: number): void {
    this.focus.x = Approach(this.focus.x, target.x, seconds, lag);
    this.focus.y = Approach(this.focus.y, target.y, seconds, lag);
    this.focus.z = Approach(this.focus.z, target.z, seconds, heightShare * lag);
  }

  private FollowHeading(seconds: number, x: number, y: number): void {
    const way = Math.hypot(x, y);
    if (this.m_sinceTurn < kHeadingPause || seconds <= 0 || way < 1e-6) return;
    const speed = way / seconds;
    if (speed > 10 * kWalkingSpeed) return;
    const sine = (Math.cos(this.m_yawAsked) * y - Math.sin(this.m_yawAsked) * x) / way;
    this.m_yawAsked += kHeadingSpeed * Math.min(speed / kWalkingSpeed, 1) * sine * seconds;
  }
}

function Approach(from: number, to: number, seconds: number, lag: number): number {
  return from + (to - from) * (1 - Math.exp(-seconds / lag));
}
