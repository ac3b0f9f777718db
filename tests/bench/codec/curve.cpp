#include "tests/bench/codec/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wobble::bench {
namespace {

constexpr std::size_t kFirstFrame = 6;

Shown MakeShown(const Recording& recording) {
  return Shown(recording.frames.front().size(), std::vector<protocol::Vector3>(recording.CountVertices()));
}

}  // namespace

RatePoint MeasurePoint(const Recording& recording, const Method& method, double parameter) {
  const CodeFrame code = method.begin(recording, parameter);
  Shown shown = MakeShown(recording);
  std::size_t bytes = 0;
  double sum = 0;
  std::vector<float> errors;
  for (std::size_t frame = 0; frame < recording.frames.size(); ++frame) {
    const std::size_t taken = code(frame, shown);
    if (frame < kFirstFrame) continue;
    bytes += taken;
    for (std::size_t body = 0; body < shown.size(); ++body) {
      for (std::size_t i = 0; i < shown[body].size(); ++i) {
        const protocol::Vector3 off = shown[body][i] - recording.frames[frame][body].vertices[i];
        const float square = protocol::Dot(off, off);
        sum += static_cast<double>(square);
        errors.push_back(square);
      }
    }
  }
  const auto count = static_cast<double>(errors.size());
  const auto p999 = errors.begin() + static_cast<std::ptrdiff_t>(0.999 * (count - 1));
  std::nth_element(errors.begin(), p999, errors.end());
  const double percent = 100 / static_cast<double>(recording.blueprint.size);
  return {parameter, 8 * static_cast<double>(bytes) / count, percent * std::sqrt(sum / count),
          percent * std::sqrt(static_cast<double>(*p999))};
}

double FindBitsAt(const Curve& curve, double errorPercent) {
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const double from = std::log(curve[i].errorPercent);
    const double to = std::log(curve[i + 1].errorPercent);
    const double share = (std::log(errorPercent) - from) / (to - from);
    if (share >= 0 && share <= 1) {
      return curve[i].bitsPerVertex + share * (curve[i + 1].bitsPerVertex - curve[i].bitsPerVertex);
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double FindFewestBitsAt(const std::vector<Curve>& curves, double errorPercent) {
  double fewest = std::numeric_limits<double>::quiet_NaN();
  for (const Curve& curve : curves) fewest = std::fmin(fewest, FindBitsAt(curve, errorPercent));
  return fewest;
}

}  // namespace wobble::bench
