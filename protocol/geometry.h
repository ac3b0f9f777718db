// The geometry that both ends share: vectors, quaternions, poses. Floats, metres.
//
// The protocol and the client use no linear-algebra library, so that they compile to WebAssembly as they are. Every
// operation has one order of evaluation and no fused multiply-add, so every client computes the same bits.
#pragma once

#include <cmath>

namespace wobble::protocol {

struct Vector3 {
  float x = 0, y = 0, z = 0;
};

inline Vector3 operator+(Vector3 a, Vector3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector3 operator*(Vector3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline float Dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector3 Cross(Vector3 a, Vector3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float Length(Vector3 a) { return std::sqrt(Dot(a, a)); }

// A rotation when of unit length.
struct Quaternion {
  float w = 1, x = 0, y = 0, z = 0;
};

inline Quaternion Conjugate(Quaternion q) { return {q.w, -q.x, -q.y, -q.z}; }

// v rotated by the unit quaternion q: v + 2 u × (u × v + w v), u = (x, y, z).
inline Vector3 Rotate(Quaternion q, Vector3 v) {
  const Vector3 u{q.x, q.y, q.z};
  return v + Cross(u, Cross(u, v) + v * q.w) * 2.0F;
}

// Place and rotation of a body: point p of its frame is at centroid + Rotate(rotation, p) in the world.
struct Pose {
  Vector3 centroid;
  Quaternion rotation;
};

inline Vector3 Transform(const Pose& pose, Vector3 point) { return pose.centroid + Rotate(pose.rotation, point); }

}  // namespace wobble::protocol
