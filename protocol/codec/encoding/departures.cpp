#include "protocol/codec/encoding/departures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wobble::protocol {
namespace {

// The usual ratio of step and target.
constexpr float kUsualStep = 2.3F;
// The largest ratio of the grid of poses and the target.
constexpr float kPoseShare = 0.3F;

unsigned FindGrid(float targetRms) {
  unsigned grid = 0;
  while (grid < kFinestGrid && std::ldexp(1.0F, -static_cast<int>(grid)) > kPoseShare * targetRms) ++grid;
  return grid;
}

// Estimates the squared error at a step, m²: about a twelfth of the step's square for a coefficient that is rounded,
// its own square for one that becomes 0.
double GuessError(std::span<const float> coefficients, float step) {
  constexpr std::size_t kLanes = 8;  // independent sums, so that the compiler vectorises
  std::array<float, kLanes> sums{};
  const float dead = 0.4F * step * step, rounded = 0.08F * step * step;
  const std::size_t whole = coefficients.size() / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float square = coefficients[i + lane] * coefficients[i + lane];
      sums[lane] += square < dead ? square : rounded;
    }
  }
  double sum = 0;
  for (std::size_t i = whole; i < coefficients.size(); ++i) {
    const float square = coefficients[i] * coefficients[i];
    sum += double{square < dead ? square : rounded};
  }
  for (const float each : sums) sum += double{each};
  return sum;
}

}  // namespace

ShapeHead MakeHead(const PatchModel& model, const Pose& pose, float targetRms) {
  ShapeHead head;
  head.pose = Quantise(pose, MakePoseGrid(FindGrid(targetRms), model.size));
  head.mode.usesBasis = model.basis != nullptr;
  return head;
}

void FindDepartures(const PatchModel& model, const Pose& seen, std::span<const Vector3> vertices,
                    std::vector<Vector3>& local, std::vector<float>& departures) {
  const std::size_t count = model.rest.size();
  const Quaternion inverse = Conjugate(seen.rotation);
  local.resize(count);
  departures.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    local[i] = Rotate(inverse, vertices[i] - seen.centroid);
    const Vector3 way = local[i] - model.rest[i];
    departures[3 * i] = way.x;
    departures[3 * i + 1] = way.y;
    departures[3 * i + 2] = way.z;
  }
}

// Columns are of unit length (2^14), so numbers whose squares add up to less than 2^34 have a product with a column of
// less than 2^31.
float RoundDepartures(const Basis& basis, std::span<const float> departures, std::vector<std::int16_t>& rounded) {
  const std::size_t size = departures.size(), apart = PadRow(basis.Rows());
  rounded.assign(basis.isScalar ? 3 * apart : apart, 0);
  double square = 0;
  float largest = 0;
  for (const float x : departures) {
    square += double{x} * double{x};
    largest = std::max(largest, std::fabs(x));
  }
  if (square <= 0) return 0;
  const auto scale = static_cast<float>(std::min(1.28e5 / std::sqrt(square), 32767.0 / double{largest}));
  const auto round = [scale](float x) { return static_cast<std::int16_t>(std::nearbyint(x * scale)); };
  if (basis.isScalar) {
    for (std::size_t i = 0; i < size; ++i) rounded[i % 3 * apart + i / 3] = round(departures[i]);
  } else {
    for (std::size_t i = 0; i < size; ++i) rounded[i] = round(departures[i]);
  }
  return 1.0F / (16384.0F * scale);
}

bool FollowsContact(const PatchModel& model, std::span<const float> coefficients, std::span<const std::int32_t> along,
                    float targetRms) {
  const float scale = FindContactScale(model.size, 16.0F);  // in metres
  const float sixteenths = 16.0F / (kUsualStep * targetRms);
  const auto measure = [&](float coefficient) {
    return FindLogarithm(16 + static_cast<std::uint32_t>(std::min(std::fabs(coefficient) * sixteenths, 1e9F)));
  };
  int with = 0, without = 0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    if (along[k] == 0) continue;
    const float suggested = static_cast<float>(along[k]) * static_cast<float>(model.basis->gains[k]) * scale;
    with += measure(coefficients[k] - suggested);
    without += measure(coefficients[k]);
  }
  return with < without;
}

unsigned GuessStep(const PatchModel& model, unsigned grid, std::span<const float> coefficients,
                   std::span<const std::int32_t> along, double budget, std::vector<float>& left) {
  left.assign(coefficients.begin(), coefficients.end());
  const float scale = FindContactScale(model.size, 16.0F);  // in metres
  for (std::size_t k = 0; k < along.size(); ++k) {
    left[k] -= static_cast<float>(along[k]) * static_cast<float>(model.basis->gains[k]) * scale;
  }
  unsigned low = 0, high = kSteps - 1;
  while (low < high) {
    const unsigned middle = (low + high + 1) / 2;
    const float step = FindStep(FindStepLevel(grid, middle));
    if (GuessError(left, step) <= budget)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

ShapeEncoding MeasureError(std::span<const Vector3> local, std::span<const Vector3> shape) {
  ShapeEncoding encoding{true};
  double sum = 0;
  float largest = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vector3 error = shape[i] - local[i];
    const float square = Dot(error, error);
    sum += double{square};
    largest = std::max(largest, square);
  }
  encoding.rmsError = static_cast<float>(std::sqrt(sum / static_cast<double>(shape.size())));
  encoding.maxError = std::sqrt(largest);
  return encoding;
}

}  // namespace wobble::protocol
