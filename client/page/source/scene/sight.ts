// From where the camera sees its focus: static solids in between bring it nearer, or raise it.
//
// The line of sight is walked by the distance to the nearest solid (sphere tracing; Hart 1996), which serves all kinds
// of solids and gives a margin for nothing. Planes that stand are left out: they are drawn from inside alone.
import { ObstacleKind, type Ground, type Obstacle, type Vector } from 'wobble-client';

const kMargin = 0.15; // m between the line of sight and a solid
const kLeastStep = 0.04; // m
const kMostSteps = 200;
const kEnough = 3; // m of free sight, with which the camera is not raised
const kRaises = [0, 0.2, 0.4, 0.6, 0.8, 1, 1.2]; // rad
const kSteepest = 1.45; // rad
const kSlope = 0.3; // upward share of a plane's normal from which it is a floor

export interface Solids {
  obstacles: readonly Obstacle[];
  grounds: readonly Ground[];
}

export interface View {
  pitch: number; // rad downwards
  distance: number; // m
}

// Where the eye is, seen from the focus: against the direction of view.
export function FindEye(focus: Vector, yaw: number, { pitch, distance }: View): Vector {
  const level = Math.cos(pitch) * distance;
  return {
    x: focus.x - level * Math.cos(yaw),
    y: focus.y - level * Math.sin(yaw),
    z: focus.z + Math.sin(pitch) * distance,
  };
}

// The view nearest to the wished one with free sight, from no nearer than `least`, m, unless no view is as far.
export function FindView(solids: Solids, focus: Vector, yaw: number, wished: View, least: number): View {
  const enough = Math.min(wished.distance, Math.max(least, kEnough));
  let best: View = { pitch: wished.pitch, distance: 0 };
  for (const raise of kRaises) {
    const pitch = Math.max(wished.pitch, Math.min(kSteepest, wished.pitch + raise));
    const distance = FindFreeSight(solids, focus, FindEye(focus, yaw, { pitch, distance: wished.distance }));
    if (distance > best.distance + 1e-6) best = { pitch, distance };
    if (distance >= enough) break;
  }
  return best;
}

// Metres from `from` towards `to` without a solid.
export function FindFreeSight(solids: Solids, from: Vector, to: Vector): number {
  const way = { x: to.x - from.x, y: to.y - from.y, z: to.z - from.z };
  const length = Math.hypot(way.x, way.y, way.z);
  if (length < 1e-6) return 0;
  // A focus that is itself near a solid, as beside a wall, has as much margin as it is given there.
  const margin = Math.min(kMargin, 0.5 * FindDistance(solids, from));
  if (margin <= 0) return length; // from inside a solid nothing can be said
  let along = 0;
  for (let step = 0; step < kMostSteps && along < length; ++step) {
    const share = along / length;
    const point = { x: from.x + share * way.x, y: from.y + share * way.y, z: from.z + share * way.z };
    const distance = FindDistance(solids, point);
    if (distance < margin) return along;
    along += Math.max(kLeastStep, distance - 0.5 * margin);
  }
  return Math.min(along, length);
}

// Metres from the nearest solid; negative: inside it.
export function FindDistance({ obstacles, grounds }: Solids, point: Vector): number {
  let least = 1000;
  for (const obstacle of obstacles) least = Math.min(least, FindDistanceOf(obstacle, point));
  for (const ground of grounds) least = Math.min(least, FindHeightAbove(ground, point));
  return least;
}

function FindDistanceOf({ kind, a, b, radius }: Obstacle, point: Vector): number {
  const x = point.x - a.x;
  const y = point.y - a.y;
  const z = point.z - a.z;
  switch (kind) {
    case ObstacleKind.Plane:
      return a.z > kSlope ? a.x * point.x + a.y * point.y + a.z * point.z - b.x : Infinity;
    case ObstacleKind.Box: {
      const [right, ahead, up] = [Math.abs(x) - b.x, Math.abs(y) - b.y, Math.abs(z) - b.z];
      const outside = Math.hypot(Math.max(0, right), Math.max(0, ahead), Math.max(0, up));
      return outside > 0 ? outside : Math.max(right, ahead, up);
    }
    case ObstacleKind.Sphere:
      return Math.hypot(x, y, z) - radius;
    case ObstacleKind.Capsule: {
      const axis = { x: b.x - a.x, y: b.y - a.y, z: b.z - a.z };
      const square = axis.x * axis.x + axis.y * axis.y + axis.z * axis.z;
      const along = square > 0 ? (x * axis.x + y * axis.y + z * axis.z) / square : 0;
      const share = Math.max(0, Math.min(1, along));
      return Math.hypot(x - share * axis.x, y - share * axis.y, z - share * axis.z) - radius;
    }
  }
}

// Half the height above it, which is less than the distance from slopes up to 60 degrees; beside it there is none.
function FindHeightAbove({ corner, cellSize, columns, rows, heights }: Ground, point: Vector): number {
  const x = (point.x - corner.x) / cellSize;
  const y = (point.y - corner.y) / cellSize;
  if (x < 0 || y < 0 || x > columns - 1 || y > rows - 1) return Infinity;
  const column = Math.min(columns - 2, Math.floor(x));
  const row = Math.min(rows - 2, Math.floor(y));
  const [right, up] = [x - column, y - row];
  const at = row * columns + column;
  const below = heights[at] * (1 - right) + heights[at + 1] * right;
  const above = heights[at + columns] * (1 - right) + heights[at + columns + 1] * right;
  return 0.5 * (point.z - (below * (1 - up) + above * up));
}
