// What many games do first: places on a grid in 16 bits, less those of the frame before, through a general compressor.
// All bodies of a frame go through it together, which is better for it than one by one. Deltas are of numbers on the
// grid, so nothing builds up; but one lost packet and the rest of the play is lost, which is not counted here.
#include "tests/bench/codec/grid.h"
#include "tests/bench/codec/method.h"
#include "tests/bench/codec/zstd.h"

namespace wobble::bench {
namespace {

// Modulo 2^16, as it is undone.
std::int16_t Wrap(int number) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(number)); }

struct Stream {
  const Recording& recording;
  double step;
  bool isCentred;
  std::vector<std::int16_t> last = {};     // of all bodies, that the sender has sent
  std::vector<std::int16_t> decoded = {};  // and the receiver has had

  std::size_t Code(std::size_t frame, Shown& shown) {
    std::vector<std::int16_t> deltas;
    std::vector<protocol::Vector3> centres;
    last.resize(3 * recording.CountVertices() * shown.size());
    decoded.resize(last.size());
    for (const server::CapturedBody& body : recording.frames[frame]) {
      const GridBody grid = PutOnGrid(body, step, isCentred);
      centres.push_back(grid.centre);
      for (const std::int16_t place : grid.places) {
        std::int16_t& before = last[deltas.size()];
        deltas.push_back(Wrap(place - before));
        before = place;
      }
    }
    const std::vector<std::uint8_t> planes = SplitPlanes(deltas);
    const std::vector<std::uint8_t> packed = CompressWithZstd(planes);
    const std::vector<std::int16_t> unpacked = JoinPlanes(DecompressWithZstd(packed, planes.size()));
    for (std::size_t i = 0; i < unpacked.size(); ++i) decoded[i] = Wrap(decoded[i] + unpacked[i]);
    Show(centres, shown);
    return packed.size() + shown.size() * (kRecordHeadBytes + (isCentred ? kCentroidBytes : 0));
  }

  void Show(const std::vector<protocol::Vector3>& centres, Shown& shown) const {
    const auto count = static_cast<std::ptrdiff_t>(3 * recording.CountVertices());
    for (std::size_t body = 0; body < shown.size(); ++body) {
      const auto first = decoded.begin() + static_cast<std::ptrdiff_t>(body) * count;
      TakeOffGrid({centres[body], {first, first + count}}, step, shown[body]);
    }
  }
};

}  // namespace

Method MakeDeltaZstd(bool isCentred) {
  const auto begin = [isCentred](const Recording& recording, double step) -> CodeFrame {
    return [stream = Stream{recording, step, isCentred}](std::size_t frame, Shown& shown) mutable {
      return stream.Code(frame, shown);
    };
  };
  return {isCentred ? "int16 delta + zstd, centred" : "int16 delta + zstd", {}, begin};
}

}  // namespace wobble::bench
