// The first approach of many games: positions on a 16-bit grid, minus those of the previous frame, through a general
// compressor. All bodies of a frame are compressed together, whatever their total size, which favours the method over
// packet-sized pieces. Positions are in world coordinates and bytes in memory order; `tuned` improves both and takes
// fewer bits. Deltas are between grid numbers, so errors do not accumulate; but one lost packet loses the rest of the
// play, which is not counted here.
#include "tests/bench/codec/grid.h"
#include "tests/bench/codec/method.h"
#include "tests/bench/codec/zstd.h"

namespace wobble::bench {
namespace {

// Wraps modulo 2^16; the decoder wraps the same way.
std::int16_t Wrap(int number) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(number)); }

std::vector<std::uint8_t> ListBytes(const std::vector<std::int16_t>& numbers) {
  std::vector<std::uint8_t> bytes;
  for (const std::int16_t number : numbers) {
    bytes.push_back(static_cast<std::uint8_t>(number & 255));
    bytes.push_back(static_cast<std::uint8_t>(number >> 8 & 255));
  }
  return bytes;
}

std::vector<std::int16_t> JoinBytes(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::int16_t> numbers;
  for (std::size_t i = 0; i < bytes.size(); i += 2) numbers.push_back(Wrap(bytes[i] | bytes[i + 1] << 8));
  return numbers;
}

struct ZstdStream {
  const Recording& recording;
  double step;
  bool isTuned;
  std::vector<std::int16_t> last = {};     // of all bodies, as sent
  std::vector<std::int16_t> decoded = {};  // as received

  std::size_t Code(std::size_t frame, Shown& shown) {
    std::vector<std::int16_t> deltas;
    std::vector<protocol::Vector3> centres;
    last.resize(3 * recording.CountVertices() * shown.size());
    decoded.resize(last.size());
    for (const server::CapturedBody& body : recording.frames[frame]) {
      const GridBody grid = PutOnGrid(body, step, isTuned);
      centres.push_back(grid.centre);
      for (const std::int16_t place : grid.places) {
        std::int16_t& before = last[deltas.size()];
        deltas.push_back(Wrap(place - before));
        before = place;
      }
    }
    const std::vector<std::uint8_t> bytes = isTuned ? SplitPlanes(deltas) : ListBytes(deltas);
    const std::vector<std::uint8_t> packed = CompressWithZstd(bytes);
    const std::vector<std::uint8_t> received = DecompressWithZstd(packed, bytes.size());
    const std::vector<std::int16_t> unpacked = isTuned ? JoinPlanes(received) : JoinBytes(received);
    for (std::size_t i = 0; i < unpacked.size(); ++i) decoded[i] = Wrap(decoded[i] + unpacked[i]);
    Show(centres, shown);
    return packed.size() + shown.size() * (kBodyBytes + (isTuned ? kCentroidBytes : 0));
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

Method MakeDeltaZstd(bool isTuned) {
  const auto begin = [isTuned](const Recording& recording, double step) -> CodeFrame {
    return [stream = ZstdStream{recording, step, isTuned}](std::size_t frame, Shown& shown) mutable {
      return stream.Code(frame, shown);
    };
  };
  return {isTuned ? "int16 delta + zstd, tuned" : "int16 delta + zstd", {}, begin};
}

}  // namespace wobble::bench
