// The camera: behind the player's body or a followed one, circling the middle of the scene, or moved freely.
//
// It approaches its target values exponentially, so that nothing jumps or depends on the frame rate; a body that starts
// again elsewhere is the exception. When following, the camera turns by itself towards the direction of motion, more
// slowly than a player would, and not for a while after the player has turned it. It keeps its distance from large
// bodies, and gives way to solids that would hide the body.
import type { PerspectiveCamera } from 'three';
import type { Vector } from 'wobble-client';
import { FindEye, FindFreeSight, FindView, type Solids } from './sight';

export enum CameraMode {
  Follow = 'follow',
  Orbit = 'orbit',
  Free = 'free',
}

const kFollowDistance = 5.6; // m, before zoom
const kFollowPitch = 0.42; // rad downwards
const kOrbitPitch = 0.42;
const kFullWidth = 0.9; // width of the picture per height with which the whole scene is in it
const kMostNarrow = 1.8; // factor on the distance, of narrower ones
const kAboveBody = 0.45; // m
const kLeastPitch = -0.12;
const kMostPitch = 1.5;
const kLeastZoom = 0.3;
const kMostZoom = 5;
const kFollowLag = 0.11; // s; time constants, after which 1/e of the way remains
const kOrbitLag = 0.9;
const kGiveWayLag = 0.06; // s; towards solids that hide the body, and back
const kBackLag = 0.25;
const kTurnLag = 0.07;
const kModeLag = 0.35;
const kOrbitSpeed = 0.09; // rad/s
const kHeadingSpeed = 0.6; // rad/s at most
const kHeadingPause = 2.5; // s after the player has turned the camera
const kWalkingSpeed = 5; // m/s from which the camera follows the heading at full speed
const kRespawnDistance = 4; // m; no body moves so far between two frames
const kFlySpeed = 7; // m/s
const kSizesAway = 10; // distance to a followed body before zoom, in its sizes, where that is more than kFollowDistance
const kLeastSizesAway = 3; // whatever the zoom, and so of the largest body of the scene
const kLeastDistance = 1.2; // m
const kNearest = 0.3; // m; with solids all around

export interface Watched extends Vector {
  size: number; // RMS distance of its vertices from its centre, m
}

// The middle of all bodies, m, and how far they reach around it.
export interface Crowd {
  middle: Vector;
  spread: number;
  largest: number; // size
}

export class OrbitCamera {
  mode = CameraMode.Follow;
  readonly focus: Vector = { x: 0, y: 0, z: 1 };
  distance = kFollowDistance;
  yaw = Math.PI / 2; // rad; direction of view, from x to y

  isCalm = false; // never turns by itself
  zoom = 1; // factor on the distance
  aspect = 1; // width of the picture per height
  solids: Solids = { obstacles: [], grounds: [] };

  private m_yawAsked = Math.PI / 2;
  private m_pitch = kFollowPitch;
  private m_tilt = 0;
  private m_sinceTurn = 100;
  private m_isPlaced = false;

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
    this.zoom = Math.max(kLeastZoom, Math.min(kMostZoom, this.zoom * factor));
  }

  // Free mode only: right, forward and up as seen, -1 to 1 each.
  Fly(right: number, forward: number, up: number, seconds: number): void {
    const way = kFlySpeed * seconds * Math.max(1, this.zoom);
    const ahead = this.ToWorld(right, forward);
    this.focus.x += ahead.x * way;
    this.focus.y += ahead.y * way;
    this.focus.z = Math.max(-20, this.focus.z + up * way);
  }

  // own: the body to follow or null.
  Update(seconds: number, own: Watched | null, crowd: Crowd): void {
    const follows = this.mode === CameraMode.Follow && own !== null;
    const target = follows ? { x: own.x, y: own.y, z: own.z + kAboveBody } : crowd.middle;
    this.m_sinceTurn += seconds;
    const { x, y, z } = this.focus;
    const gap = Math.hypot(target.x - x, target.y - y, target.z - z);
    if (!this.m_isPlaced || (follows && gap > kRespawnDistance && this.m_sinceTurn > kModeLag)) {
      Object.assign(this.focus, target);
    } else if (this.mode !== CameraMode.Free) {
      this.MoveFocus(target, seconds, follows ? kFollowLag : kOrbitLag, follows ? 2 : 1);
      if (follows && !this.isCalm) this.FollowHeading(seconds, this.focus.x - x, this.focus.y - y);
    }
    if (this.mode === CameraMode.Orbit && !this.isCalm && this.m_sinceTurn > kHeadingPause) {
      this.m_yawAsked += kOrbitSpeed * seconds;
    }
    this.yaw = Approach(this.yaw, this.m_yawAsked, seconds, kTurnLag);
    this.Place(seconds, follows, follows ? own.size : crowd.largest, this.FindDistance(follows ? own : null, crowd));
    this.m_isPlaced = true;
  }

  Apply(camera: PerspectiveCamera): void {
    const eye = this.FindEye();
    camera.position.set(eye.x, eye.y, eye.z);
    camera.lookAt(this.focus.x, this.focus.y, this.focus.z);
    camera.updateMatrixWorld();
  }

  FindEye(): Vector {
    return FindEye(this.focus, this.yaw, { pitch: this.m_pitch, distance: this.distance });
  }

  // Converts right and forward as seen to the world's horizontal plane.
  ToWorld(right: number, forward: number): { x: number; y: number } {
    const x = Math.cos(this.yaw);
    const y = Math.sin(this.yaw);
    return { x: right * y + forward * x, y: -right * x + forward * y };
  }

  private FindDistance(own: Watched | null, crowd: Crowd): number {
    const narrow = Math.max(1, Math.min(kMostNarrow, kFullWidth / this.aspect));
    const wished =
      own === null
        ? narrow * Math.max(6, Math.min(50, 1.7 * crowd.spread))
        : Math.max(kFollowDistance, kSizesAway * own.size);
    const least = kLeastSizesAway * (own?.size ?? crowd.largest);
    return Math.max(kLeastDistance, least, this.zoom * wished);
  }

  // A camera that follows nobody stands still when solids are in between: the scene is seen from all sides in turn.
  private Place(seconds: number, follows: boolean, size: number, distance: number): void {
    const wished = { pitch: this.FindPitch() + this.m_tilt, distance };
    const least = Math.max(kLeastDistance, kLeastSizesAway * size);
    const view = follows ? FindView(this.solids, this.focus, this.yaw, wished, least) : wished;
    if (!this.m_isPlaced) {
      this.m_pitch = view.pitch;
      this.distance = view.distance;
      return;
    }
    const isGivingWay = view.distance < this.distance || view.pitch > this.m_pitch;
    const givesWay = isGivingWay && (view.distance < distance || view.pitch > wished.pitch);
    this.distance = Approach(this.distance, view.distance, seconds, givesWay ? kGiveWayLag : kBackLag);
    this.m_pitch = Approach(this.m_pitch, view.pitch, seconds, kTurnLag);
    // On the way there the eye does not pass through a solid either.
    if (!follows) return;
    const free = FindFreeSight(this.solids, this.focus, this.FindEye());
    this.distance = Math.max(kNearest, Math.min(this.distance, free));
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
