// Convex polygons on planes.
import { Vector3 } from 'three';

export interface HalfSpace {
  normal: Vector3; // points inside have normal . point >= offset
  offset: number;
}

// The square with this half width in the plane, around the point nearest to `centre`, counterclockwise seen from the
// front.
export function MakeSquare(plane: HalfSpace, centre: Vector3, halfWidth: number): Vector3[] {
  const middle = centre.clone().addScaledVector(plane.normal, plane.offset - plane.normal.dot(centre));
  const helper = Math.abs(plane.normal.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0);
  const right = new Vector3().crossVectors(helper, plane.normal).normalize();
  const up = new Vector3().crossVectors(plane.normal, right);
  const corner = (a: number, b: number) =>
    middle
      .clone()
      .addScaledVector(right, a * halfWidth)
      .addScaledVector(up, b * halfWidth);
  return [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
}

// The part of the polygon inside the half space.
export function Clip(polygon: Vector3[], by: HalfSpace): Vector3[] {
  const clipped: Vector3[] = [];
  for (let i = 0; i < polygon.length; ++i) {
    const from = polygon[i];
    const to = polygon[(i + 1) % polygon.length];
    const a = by.normal.dot(from) - by.offset;
    const b = by.normal.dot(to) - by.offset;
    if (a >= 0) clipped.push(from);
    if (a >= 0 !== b >= 0) clipped.push(from.clone().lerp(to, a / (a - b)));
  }
  return clipped;
}
