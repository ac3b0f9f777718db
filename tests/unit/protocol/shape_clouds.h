// Bodies, bases and floors for tests of the shape codec, and its use with checks.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "protocol/codec/basis_reader.h"
#include "protocol/codec/encoding/shape_encoder.h"
#include "protocol/codec/pose.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/limits.h"
#include "protocol/messages.h"
#include "protocol/snapshot.h"

namespace wobble::protocol::clouds {

struct Cloud {
  std::vector<Vector3> rest;      // body frame
  std::vector<Vector3> vertices;  // world
  Pose pose;
  float size = 1;
};

// A sphere of `count` points on a golden spiral, pressed in and rippled by about `deformation` of its radius.
inline Cloud MakeCloud(unsigned seed, std::size_t count, float size, float deformation) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  Cloud cloud;
  cloud.size = size;
  cloud.pose.centroid = {20 * unit(random), 20 * unit(random), 20 * unit(random)};
  Quaternion q{unit(random), unit(random), unit(random), unit(random)};
  const float length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  cloud.pose.rotation = {q.w / length, q.x / length, q.y / length, q.z / length};
  const Vector3 wave{4 * unit(random), 4 * unit(random), 4 * unit(random)};
  const float phase = 3 * unit(random);
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
    const float radius = std::sqrt(1 - z * z), angle = 2.3999632F * static_cast<float>(i);
    const Vector3 rest = Vector3{radius * std::cos(angle), radius * std::sin(angle), z} * size;
    const Vector3 noise = Vector3{unit(random), unit(random), unit(random)} * (0.3F * deformation * size);
    const float ripple = 1 + deformation * std::sin(Dot(wave, rest) / size + phase);
    cloud.rest.push_back(rest);
    cloud.vertices.push_back(Transform(cloud.pose, rest * ripple + noise));
  }
  return cloud;
}

struct Error {
  double rms = 0, max = 0;
};

// Between the vertices and where a client shows them, metres in the world.
inline Error FindError(std::span<const Vector3> vertices, const Pose& pose, std::span<const Vector3> shape) {
  Error error;
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3 seen = Transform(pose, shape[i]);
    const double x = double{seen.x} - vertices[i].x, y = double{seen.y} - vertices[i].y,
                 z = double{seen.z} - vertices[i].z;
    sum += x * x + y * y + z * z;
    error.max = std::max(error.max, std::sqrt(x * x + y * y + z * z));
  }
  error.rms = std::sqrt(sum / static_cast<double>(vertices.size()));
  return error;
}

struct Coded {
  ShapeEncoding encoding;
  std::vector<std::uint8_t> bytes;
};

inline PatchModel MakeModel(const Cloud& cloud, const Basis* basis = nullptr,
                            std::span<const wire::Obstacle> obstacles = {}) {
  return {
      .rest = cloud.rest, .size = cloud.size, .basis = basis, .obstacles = obstacles, .reach = FindReach(cloud.rest)};
}

inline Coded Encode(const Cloud& cloud, float target, const Basis* basis = nullptr,
                    std::size_t maxBytes = kMaxRecordPayload, std::span<const wire::Obstacle> obstacles = {}) {
  Coded coded;
  ShapeEncoder encoder;
  coded.encoding =
      encoder.Encode(MakeModel(cloud, basis, obstacles), cloud.pose, cloud.vertices, target, maxBytes, coded.bytes);
  return coded;
}

// Decodes into the middle of a block whose other vertices must stay as they are.
inline DecodeResult Decode(std::span<const std::uint8_t> bytes, const PatchModel& model, Pose& pose,
                           std::vector<Vector3>& shape) {
  constexpr float kUntouched = 12345;
  constexpr std::size_t kGuard = 4;
  std::vector<Vector3> block(model.rest.size() + 2 * kGuard, {kUntouched, kUntouched, kUntouched});
  ShapeDecoder decoder;
  QuantisedPose read;
  const DecodeResult result = decoder.Decode(model, bytes, read, std::span(block).subspan(kGuard, model.rest.size()));
  for (std::size_t i = 0; i < kGuard; ++i) {
    for (const Vector3& guard : {block[i], block[block.size() - 1 - i]}) {
      EXPECT_TRUE(guard.x == kUntouched && guard.y == kUntouched && guard.z == kUntouched);
    }
  }
  pose = Dequantise(read);
  shape.assign(block.begin() + kGuard, block.end() - kGuard);
  EXPECT_STRNE(Name(result), "unknown");
  return result;
}

inline void ExpectFinite(const Pose& pose, std::span<const Vector3> shape) {
  const Quaternion q = pose.rotation;
  EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-5);
  for (const Vector3& v : shape) EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
}

// A basis of every kind for `vertices` = 6 · n, whose coefficients all spread by about `spread` metres.
inline std::shared_ptr<const Basis> MakeBasis(BasisSource::Kind kind, std::size_t vertices, float spread) {
  std::mt19937 random(21);
  BasisSource source;
  source.kind = kind;
  source.vertices = static_cast<std::uint16_t>(vertices);
  if (kind == BasisSource::Kind::kCosine) {
    source.grid = {3, static_cast<std::uint16_t>(vertices / 6), 2};
  } else {
    const std::size_t rows = kind == BasisSource::Kind::kFull ? 3 * vertices : vertices;
    for (std::size_t i = 0; i < 5 * rows; ++i) source.modes.push_back(static_cast<std::int8_t>(random() % 255) - 127);
    for (std::size_t i = 0; i < vertices; ++i) source.order.push_back(static_cast<std::uint16_t>(vertices - 1 - i));
  }
  source.levels.assign(3 * vertices,
                       static_cast<std::uint8_t>(kLevelZero + std::lround(8 * std::log2(static_cast<double>(spread)))));
  source.gains.assign(3 * vertices, 48);
  return ReadBasis(WriteBasis(source), vertices);
}

inline constexpr std::array<BasisSource::Kind, 3> kKinds = {BasisSource::Kind::kFull, BasisSource::Kind::kScalar,
                                                            BasisSource::Kind::kCosine};

// A floor that reaches a little into a body at this pose.
inline std::vector<wire::Obstacle> MakeFloor(const Cloud& cloud) {
  const Vector3 c = cloud.pose.centroid;
  return {wire::Obstacle(wire::ObstacleKind::Box, wire::Vec3(c.x, c.y, c.z - 0.8F * cloud.size - 1),
                         wire::Vec3(50, 50, 1), 0.0F)};
}

}  // namespace wobble::protocol::clouds
