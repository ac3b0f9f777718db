// The method of games with large states since Quake III: each packet is coded against the newest snapshot that the
// client has acknowledged, so that it decodes whatever was lost since. At a round trip of 100 ms that is the third last
// frame. A packet must not depend on coder state from other packets, so the models restart in each; all bodies of a
// frame share them. The model of a number is chosen by the size of the preceding ones.
#include <algorithm>
#include <bit>
#include <cstdlib>

#include "tests/bench/codec/adaptive_coder.h"
#include "tests/bench/codec/grid.h"
#include "tests/bench/codec/method.h"

namespace wobble::bench {
namespace {

constexpr std::size_t kAge = 3;            // of the acknowledged frame, frames
constexpr std::size_t kBaselineBytes = 2;  // the number of that frame, once per packet

// One model for each mean size of the last numbers of the same axis.
class Numbers {
 public:
  NumberModel& Find(std::size_t axis) {
    return m_models[std::min<std::size_t>(std::bit_width(m_means[axis]), m_models.size() - 1)];
  }
  void Note(std::size_t axis, int number) {
    unsigned& mean = m_means[axis];
    mean = (3 * mean + 4 * static_cast<unsigned>(std::abs(number)) + 2) / 4;
  }

 private:
  std::array<NumberModel, 20> m_models;
  std::array<unsigned, 3> m_means{};  // times 4
};

std::vector<std::uint8_t> EncodeDeltas(const std::vector<int>& deltas) {
  AdaptiveEncoder encoder;
  Numbers numbers;
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    numbers.Find(i % 3).Write(deltas[i], encoder);
    numbers.Note(i % 3, deltas[i]);
  }
  return encoder.Finish();
}

std::vector<int> DecodeDeltas(const std::vector<std::uint8_t>& bytes, std::size_t count) {
  AdaptiveDecoder decoder(bytes);
  Numbers numbers;
  std::vector<int> deltas(count);
  for (std::size_t i = 0; i < count; ++i) {
    deltas[i] = numbers.Find(i % 3).Read(decoder);
    numbers.Note(i % 3, deltas[i]);
  }
  return deltas;
}

using Frame = std::vector<GridBody>;

struct AcknowledgedStream {
  const Recording& recording;
  double step;
  std::vector<Frame> sent = {};  // per frame, as sender and receiver know it

  std::size_t Code(std::size_t frame, Shown& shown) {
    Frame now;
    std::vector<int> deltas;
    for (std::size_t body = 0; body < shown.size(); ++body) {
      now.push_back(PutOnGrid(recording.frames[frame][body], step, true));
      for (std::size_t i = 0; i < now.back().places.size(); ++i) {
        deltas.push_back(now.back().places[i] - FindBaseline(frame, body, i));
      }
    }
    const std::vector<std::uint8_t> bytes = EncodeDeltas(deltas);
    const std::vector<int> received = DecodeDeltas(bytes, deltas.size());
    std::size_t next = 0;
    for (std::size_t body = 0; body < shown.size(); ++body) {
      for (std::size_t i = 0; i < now[body].places.size(); ++i) {
        now[body].places[i] = static_cast<std::int16_t>(received[next++] + FindBaseline(frame, body, i));
      }
      TakeOffGrid(now[body], step, shown[body]);
    }
    sent.push_back(std::move(now));
    return bytes.size() + kBaselineBytes + shown.size() * (kBodyBytes + kCentroidBytes);
  }

  [[nodiscard]] int FindBaseline(std::size_t frame, std::size_t body, std::size_t i) const {
    return frame >= kAge ? sent[frame - kAge][body].places[i] : 0;
  }
};

}  // namespace

Method MakeDeltaAcknowledged() {
  const auto begin = [](const Recording& recording, double step) -> CodeFrame {
    return [stream = AcknowledgedStream{recording, step}](std::size_t frame, Shown& shown) mutable {
      return stream.Code(frame, shown);
    };
  };
  return {"delta to acknowledged", {}, begin};
}

}  // namespace wobble::bench
