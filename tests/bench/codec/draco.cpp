// Draco codes one mesh or point cloud at a time and uses no motion. As a mesh it predicts vertices from adjacent
// triangles, but sends the triangles in every frame and returns vertices in its own order. As a cloud it must keep the
// order (its kd-tree does not), so that vertices can be identified. Slowest and best settings.
#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include <limits>
#include <stdexcept>

#include "tests/bench/codec/method.h"

namespace wobble::bench {
namespace {

using protocol::Vector3;

constexpr int kThorough = 0;

std::size_t CompressWithDraco(draco::ExpertEncoder& encoder, int method, int bits, draco::DecoderBuffer& buffer,
                              draco::EncoderBuffer& bytes) {
  encoder.SetSpeedOptions(kThorough, kThorough);
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(0, bits);
  const draco::Status status = encoder.EncodeToBuffer(&bytes);
  if (!status.ok()) throw std::runtime_error("Draco: " + status.error_msg_string());
  buffer.Init(bytes.data(), bytes.size());
  return bytes.size();
}

std::vector<Vector3> ReadPoints(const draco::PointCloud& cloud) {
  const draco::PointAttribute* const attribute = cloud.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  std::vector<Vector3> points(cloud.num_points());
  for (draco::PointIndex i(0); i < cloud.num_points(); ++i) {
    attribute->GetMappedValue(i, &points[i.value()].x);
  }
  return points;
}

// Matches points to vertices by distance, because Draco's order is unknown: each lies far closer to its own vertex than
// to any other.
void ShowNearest(const std::vector<Vector3>& points, const std::vector<Vector3>& vertices,
                 std::vector<Vector3>& shown) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    float least = std::numeric_limits<float>::infinity();
    for (const Vector3& point : points) {
      const Vector3 off = point - vertices[i];
      if (protocol::Dot(off, off) >= least) continue;
      least = protocol::Dot(off, off);
      shown[i] = point;
    }
  }
}

std::size_t CodeMesh(const std::vector<Vector3>& vertices, const std::vector<physics::Face>& faces, int bits,
                     std::vector<Vector3>& shown) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(faces.size()));
  const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(static_cast<std::uint32_t>(i)),
                                      &vertices[faces[i][0]].x, &vertices[faces[i][1]].x, &vertices[faces[i][2]].x);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::ExpertEncoder encoder(*mesh);
  draco::EncoderBuffer bytes;
  draco::DecoderBuffer buffer;
  const std::size_t size = CompressWithDraco(encoder, draco::MESH_EDGEBREAKER_ENCODING, bits, buffer, bytes);
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw std::runtime_error("Draco cannot decode its own mesh");
  ShowNearest(ReadPoints(*decoded.value()), vertices, shown);
  return size;
}

std::size_t CodePoints(const std::vector<Vector3>& vertices, int bits, std::vector<Vector3>& shown) {
  draco::PointCloudBuilder builder;
  builder.Start(static_cast<std::uint32_t>(vertices.size()));
  const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  builder.SetAttributeValuesForAllPoints(attribute, vertices.data(), sizeof(Vector3));
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  draco::ExpertEncoder encoder(*cloud);
  draco::EncoderBuffer bytes;
  draco::DecoderBuffer buffer;
  const std::size_t size = CompressWithDraco(encoder, draco::POINT_CLOUD_SEQUENTIAL_ENCODING, bits, buffer, bytes);
  auto decoded = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  if (!decoded.ok()) throw std::runtime_error("Draco cannot decode its own point cloud");
  shown = ReadPoints(*decoded.value());
  return size;
}

Method MakeDraco(const char* name, bool isMesh) {
  const auto begin = [isMesh](const Recording& recording, double bits) -> CodeFrame {
    return [&recording, isMesh, bits = static_cast<int>(bits)](std::size_t frame, Shown& shown) {
      std::size_t bytes = 0;
      for (std::size_t body = 0; body < shown.size(); ++body) {
        const std::vector<Vector3>& vertices = recording.frames[frame][body].vertices;
        bytes += AddHead(isMesh ? CodeMesh(vertices, recording.faces, bits, shown[body])
                                : CodePoints(vertices, bits, shown[body]));
      }
      return bytes;
    };
  };
  return {name, {6, 7, 8, 9, 10, 11, 12, 13}, begin};
}

}  // namespace

Method MakeDracoMesh() { return MakeDraco("Draco, mesh", true); }
Method MakeDracoPoints() { return MakeDraco("Draco, points", false); }

}  // namespace wobble::bench
