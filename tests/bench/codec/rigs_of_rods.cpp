// Rigs of Rods, a game with soft vehicles, sends every node of a vehicle ten times a second: a reference node in full
// and the others relative to it with 16 bits per coordinate. Its data on engine and lights are left out. It has no
// parameter, hence one point. GCC and clang convert to half floats as the processor does, to nearest even.
#include "tests/bench/codec/method.h"

namespace wobble::bench {
namespace {

using protocol::Vector3;

float RoundToHalf(float value) { return static_cast<float>(static_cast<_Float16>(value)); }

}  // namespace

Method MakeRigsOfRods() {
  const auto begin = [](const Recording& recording, double) -> CodeFrame {
    return [&recording](std::size_t frame, Shown& shown) {
      std::size_t bytes = 0;
      for (std::size_t body = 0; body < shown.size(); ++body) {
        const std::vector<Vector3>& vertices = recording.frames[frame][body].vertices;
        const Vector3 reference = vertices.front();
        for (std::size_t i = 0; i < vertices.size(); ++i) {
          const Vector3 way = vertices[i] - reference;
          shown[body][i] = reference + Vector3{RoundToHalf(way.x), RoundToHalf(way.y), RoundToHalf(way.z)};
        }
        bytes += AddHead(sizeof(Vector3) + 6 * (vertices.size() - 1));
      }
      return bytes;
    };
  };
  return {"Rigs of Rods", {0}, begin};
}

}  // namespace wobble::bench
