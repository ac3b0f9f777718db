// meshoptimizer's codec predicts each byte of a vertex from the one before and packs the differences in groups of
// sixteen; it is designed to be followed by a general compressor. It gets the vertices in an order of spatial
// proximity, computed once from the rest shape, with 16-bit positions on the grid.
#include <meshoptimizer.h>

#include <array>
#include <stdexcept>

#include "tests/bench/codec/grid.h"
#include "tests/bench/codec/method.h"
#include "tests/bench/codec/zstd.h"

namespace wobble::bench {
namespace {

using PackedVertex = std::array<std::int16_t, 4>;  // the codec requires multiples of four bytes; the last number is 0

std::vector<std::uint8_t> EncodeVertices(const std::vector<PackedVertex>& vertices) {
  std::vector<std::uint8_t> out(meshopt_encodeVertexBufferBound(vertices.size(), sizeof(PackedVertex)));
  out.resize(
      meshopt_encodeVertexBuffer(out.data(), out.size(), vertices.data(), vertices.size(), sizeof(PackedVertex)));
  return out;
}

std::vector<PackedVertex> DecodeVertices(const std::vector<std::uint8_t>& bytes, std::size_t count) {
  std::vector<PackedVertex> vertices(count);
  if (meshopt_decodeVertexBuffer(vertices.data(), count, sizeof(PackedVertex), bytes.data(), bytes.size()) != 0) {
    throw std::runtime_error("meshoptimizer cannot decode its own buffer");
  }
  return vertices;
}

// Index of each vertex in the buffer.
std::vector<unsigned> FindOrder(const Recording& recording) {
  std::vector<unsigned> order(recording.CountVertices());
  meshopt_spatialSortRemap(order.data(), &recording.blueprint.rest.front().x, order.size(), sizeof(protocol::Vector3));
  return order;
}

struct MeshStream {
  const Recording& recording;
  double step;
  bool isDelta;
  std::vector<unsigned> order;
  std::vector<GridBody> last = {};
  std::vector<GridBody> decoded = {};

  std::size_t Code(std::size_t frame, Shown& shown) {
    const std::size_t count = order.size();
    last.resize(shown.size(), {{}, std::vector<std::int16_t>(3 * count)});
    decoded.resize(shown.size(), last.front());
    std::vector<PackedVertex> vertices(shown.size() * count);
    for (std::size_t body = 0; body < shown.size(); ++body) {
      const GridBody grid = PutOnGrid(recording.frames[frame][body], step, true);
      for (std::size_t i = 0; i < 3 * count; ++i) {
        const int baseline = isDelta ? last[body].places[i] : 0;
        vertices[body * count + order[i / 3]][i % 3] = static_cast<std::int16_t>(grid.places[i] - baseline);
      }
      last[body] = grid;
    }
    const std::vector<std::uint8_t> encoded = EncodeVertices(vertices);
    const std::vector<std::uint8_t> packed = CompressWithZstd(encoded);
    const std::vector<PackedVertex> received =
        DecodeVertices(DecompressWithZstd(packed, encoded.size()), vertices.size());
    for (std::size_t body = 0; body < shown.size(); ++body) {
      decoded[body].centre = last[body].centre;
      for (std::size_t i = 0; i < 3 * count; ++i) {
        std::int16_t& place = decoded[body].places[i];
        place = static_cast<std::int16_t>(received[body * count + order[i / 3]][i % 3] + (isDelta ? place : 0));
      }
      TakeOffGrid(decoded[body], step, shown[body]);
    }
    return packed.size() + shown.size() * (kBodyBytes + kCentroidBytes);
  }
};

}  // namespace

Method MakeMeshoptimizer(bool isDelta) {
  const auto begin = [isDelta](const Recording& recording, double step) -> CodeFrame {
    return [stream = MeshStream{recording, step, isDelta, FindOrder(recording)}](
               std::size_t frame, Shown& shown) mutable { return stream.Code(frame, shown); };
  };
  return {isDelta ? "meshoptimizer delta + zstd" : "meshoptimizer + zstd", {}, begin};
}

}  // namespace wobble::bench
