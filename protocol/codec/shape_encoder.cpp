// Rate-distortion optimised rounding. For each coefficient the encoder chooses among the nearest value, the next
// smaller one and 0: the one with the least error plus 0.1 squared steps a bit (0.06 and 0.15 made records 1 % longer).
// For each record it searches the coarsest step at which the error stays within the target, and then the highest worth
// of a bit, in three or four tries. A trellis over contexts was not worth its time, nor were values reconstructed
// nearer to zero.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "protocol/codec/contexts.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/codec/shape_layout.h"

namespace wobble::protocol {
namespace {

// Squared steps of error that a bit is worth.
constexpr float kBitWorth = 0.1F;
constexpr float kLeastBitWorth = 0.07F;
constexpr float kMostBitWorth = 0.17F;
// Relative growth of the error when the worth of a bit grows by one squared step.
constexpr double kErrorGrowth = 2;
// Share of the error allowed that must be used; with less, another try is worth its time. The remainder is spent on
// making zeros of ones.
constexpr double kEnough = 0.93;
// The usual ratio of step and target.
constexpr float kUsualStep = 2.3F;
// The largest ratio of the grid of poses and the target.
constexpr float kPoseShare = 0.3F;
// Share of the error allowed that is planned with; the rest is for the rounding of the transform.
constexpr double kPlannedShare = 0.9985;

using Costs = std::array<std::array<float, kMagnitudes>, kContexts>;

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

Costs MakeCosts() {
  Costs costs{};
  for (std::size_t context = 0; context < kContexts; ++context) {
    for (std::size_t i = 0; i < kMagnitudes; ++i) {
      const double share = static_cast<double>(FindFrequencies(context)[i].size) / kFrequencyTotal;
      costs[context][i] = static_cast<float>(FindLowBits(context) - std::log2(share));
    }
  }
  return costs;
}

const Costs kCosts = MakeCosts();

// The cost of a coefficient of this magnitude, in bits, its sign included.
float FindCost(std::size_t context, std::uint32_t magnitude) {
  const std::uint32_t high = magnitude >> FindLowBits(context);
  const float sign = magnitude > 0 ? 1.0F : 0.0F;
  if (high < kEscapeMagnitude) return kCosts[context][high] + sign;
  const int length = std::bit_width(high - kEscapeMagnitude + 1) - 1;
  return kCosts[context][kEscapeMagnitude] + sign + static_cast<float>(2 * length + 1);
}

std::uint32_t ChooseMagnitude(std::size_t context, float wanted, float bitWorth) {
  const auto nearest = static_cast<std::uint32_t>(std::min(wanted + 0.5F, static_cast<float>(kMaxMagnitude)));
  if (nearest == 0) return 0;
  const auto price = [&](std::uint32_t magnitude) {
    const float error = wanted - static_cast<float>(magnitude);
    return error * error + bitWorth * FindCost(context, magnitude);
  };
  std::uint32_t best = nearest;
  float least = price(nearest);
  for (const std::uint32_t other : {nearest - 1, std::uint32_t{0}}) {
    const float each = price(other);
    if (each < least) best = other, least = each;
  }
  return best;
}

void WriteEscape(RangeEncoder& encoder, std::uint32_t rest) {
  const auto length = static_cast<unsigned>(std::bit_width(rest + 1) - 1);
  for (unsigned i = 0; i < length; ++i) encoder.EncodeBits(1, 1);
  if (length < 20) encoder.EncodeBits(0, 1);
  const std::uint32_t number = rest + 1 - (1U << length);
  const unsigned high = length > 16 ? length - 16 : 0;
  encoder.EncodeBits(number & ((1U << (length - high)) - 1), length - high);
  encoder.EncodeBits(number >> (length - high), high);
}

void WriteCoefficient(RangeEncoder& encoder, Contexts& contexts, const ExpectedContext& expected, std::int32_t value) {
  const std::size_t context = contexts.Find(expected);
  const auto magnitude = static_cast<std::uint32_t>(value < 0 ? -value : value);
  const unsigned lowBits = FindLowBits(context);
  const std::uint32_t high = magnitude >> lowBits;
  const Frequency frequency = FindFrequencies(context)[std::min(high, kEscapeMagnitude)];
  encoder.Encode(frequency.start, frequency.size);
  if (high >= kEscapeMagnitude) WriteEscape(encoder, high - kEscapeMagnitude);
  if (lowBits > 0) encoder.EncodeBits(magnitude & ((1U << lowBits) - 1), lowBits);
  contexts.Add(magnitude);
  if (value != 0) encoder.EncodeBits(value < 0 ? 1 : 0, 1);
}

unsigned FindGrid(float targetRms) {
  unsigned grid = 0;
  while (grid < kFinestGrid && std::ldexp(1.0F, -static_cast<int>(grid)) > kPoseShare * targetRms) ++grid;
  return grid;
}

}  // namespace

struct ShapeEncoder::Choice {
  ShapeHead head;
  float bitWorth = kBitWorth;

  [[nodiscard]] int StepLevel() const { return FindStepLevel(head.pose.grid.grid, head.stepIndex); }
};

void ShapeEncoder::FindDepartures(const PatchModel& model, const Pose& seen, std::span<const Vector3> vertices) {
  const std::size_t count = model.rest.size();
  const Quaternion inverse = Conjugate(seen.rotation);
  m_local.resize(count);
  m_coefficients.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    m_local[i] = Rotate(inverse, vertices[i] - seen.centroid);
    const Vector3 way = m_local[i] - model.rest[i];
    m_coefficients[3 * i] = way.x;
    m_coefficients[3 * i + 1] = way.y;
    m_coefficients[3 * i + 2] = way.z;
  }
}

// Turns displacements into coefficients in the basis. Columns are of unit length (2^14), so numbers whose squares add
// up to less than 2^34 have a product with a column of less than 2^31.
void ShapeEncoder::Transform(const Basis& basis) {
  const std::size_t size = m_coefficients.size(), count = basis.vertices;
  double square = 0;
  float largest = 0;
  for (const float x : m_coefficients) {
    square += double{x} * double{x};
    largest = std::max(largest, std::fabs(x));
  }
  if (square <= 0) return;
  const auto scale = static_cast<float>(std::min(1.28e5 / std::sqrt(square), 32767.0 / double{largest}));
  m_rounded.resize(size);
  const auto round = [scale](float x) { return static_cast<std::int16_t>(std::nearbyint(x * scale)); };
  const float unit = 1.0F / (16384.0F * scale);
  if (!basis.isScalar) {
    for (std::size_t i = 0; i < size; ++i) m_rounded[i] = round(m_coefficients[i]);
    for (std::size_t k = 0; k < size; ++k) {
      m_coefficients[k] = static_cast<float>(Project(basis.Column(k), m_rounded.data())) * unit;
    }
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) m_rounded[axis * count + i] = round(m_coefficients[3 * i + axis]);
  }
  for (std::size_t mode = 0; mode < count; ++mode) {
    const auto along = ProjectAxes(basis.Column(mode), m_rounded.data(), count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      m_coefficients[3 * mode + axis] = static_cast<float>(along[axis]) * unit;
    }
  }
}

void ShapeEncoder::GuessStep(const PatchModel& model, double budget, Choice& choice) {
  const Choice& c = choice;
  m_left = m_coefficients;
  if (c.head.mode.followsContact) {
    const float scale = FindContactScale(model.size, 16.0F);  // in metres
    for (std::size_t k = 0; k < m_left.size(); ++k) {
      m_left[k] -= static_cast<float>(m_contact.along[k]) * static_cast<float>(model.basis->gains[k]) * scale;
    }
  }
  unsigned low = 0, high = kSteps - 1;
  while (low < high) {
    const unsigned middle = (low + high + 1) / 2;
    const float step = FindStep(FindStepLevel(c.head.pose.grid.grid, middle));
    if (GuessError(m_left, step) <= budget)
      low = middle;
    else
      high = middle - 1;
  }
  choice.head.stepIndex = low;
}

// Whether the coefficients, in usual steps, take fewer bits in all when the contact prediction is subtracted.
bool ShapeEncoder::FollowsContact(const PatchModel& model, float targetRms) const {
  const float scale = FindContactScale(model.size, 16.0F);  // in metres
  const float sixteenths = 16.0F / (kUsualStep * targetRms);
  const auto measure = [&](float coefficient) {
    return FindLogarithm(16 + static_cast<std::uint32_t>(std::min(std::fabs(coefficient) * sixteenths, 1e9F)));
  };
  int with = 0, without = 0;
  for (std::size_t k = 0; k < m_coefficients.size(); ++k) {
    if (m_contact.along[k] == 0) continue;
    const float suggested = static_cast<float>(m_contact.along[k]) * static_cast<float>(model.basis->gains[k]) * scale;
    with += measure(m_coefficients[k] - suggested);
    without += measure(m_coefficients[k]);
  }
  return with < without;
}

// Chooses all coefficients for a step and a worth of a bit. Returns the sum of squared errors, m².
double ShapeEncoder::Round(const PatchModel& model, const Choice& choice) {
  const Basis* basis = choice.head.mode.usesBasis ? model.basis : nullptr;
  const int stepLevel = choice.StepLevel();
  const float step = FindStep(stepLevel);
  const float scale = FindContactScale(model.size, step), perStep = 1.0F / step;
  const std::span<const ExpectedContext> expected = m_plans.Find(basis, m_coefficients.size(), stepLevel);
  Contexts contexts;
  double sum = 0;
  m_chosen.resize(m_coefficients.size());
  m_wanted.resize(m_coefficients.size());
  for (std::size_t k = 0; k < m_coefficients.size(); ++k) {
    float wanted = m_coefficients[k] * perStep;
    if (choice.head.mode.followsContact) {
      wanted -= static_cast<float>(FindSuggestion(m_contact.along[k], basis->gains[k], scale)) / 16.0F;
    }
    const std::size_t context = contexts.Find(expected[k]);
    const std::uint32_t magnitude = ChooseMagnitude(context, std::fabs(wanted), choice.bitWorth);
    contexts.Add(magnitude);
    const float error = std::fabs(wanted) - static_cast<float>(magnitude);
    sum += double{error * error};
    m_wanted[k] = std::fabs(wanted);
    m_chosen[k] = wanted < 0 ? -static_cast<std::int32_t>(magnitude) : static_cast<std::int32_t>(magnitude);
  }
  return sum * double{step} * double{step};
}

// Tries steps and worths of a bit until the error is just within the budget, m². The coefficients of the best try stay
// chosen.
void ShapeEncoder::SearchStep(const PatchModel& model, double budget, Choice& choice) {
  unsigned& index = choice.head.stepIndex;
  choice.bitWorth = kBitWorth;
  Choice best = choice;
  double bestError = -1;
  double error = 0;
  constexpr int kTries = 4;
  for (int i = 0; i < kTries; ++i) {
    error = Round(model, choice);
    if (error <= budget && error > kEnough * budget) return SpendRest(budget - error, choice);
    if (error <= budget && error > bestError) {
      best = choice;
      bestError = error;
      m_chosen.swap(m_bestChosen);
      m_wanted.swap(m_bestWanted);
    }
    const double ratio = budget / std::max(error, 1e-9 * budget);
    const float worth = choice.bitWorth + static_cast<float>((0.995 * ratio - 1) / kErrorGrowth);
    if (worth >= kLeastBitWorth && worth <= kMostBitWorth) {
      choice.bitWorth = worth;
      continue;
    }
    // The error grows somewhat slower than the square of the step.
    const int way = static_cast<int>(std::lround(5 * std::log2(ratio)));
    const int next = static_cast<int>(index) + (ratio < 1 ? std::min(way, -1) : std::max(way, 1));
    if (next < 0 || next >= static_cast<int>(kSteps)) break;
    index = static_cast<unsigned>(next);
    choice.bitWorth = kBitWorth;
  }
  if (bestError >= 0) {
    choice = best;
    m_chosen.swap(m_bestChosen);
    m_wanted.swap(m_bestWanted);
    return SpendRest(budget - bestError, choice);
  }
  choice.bitWorth = kBitWorth;
  for (error = Round(model, choice); error > budget && index > 0; error = Round(model, choice)) --index;
}

// Makes zeros of ones while the error that is left, m², allows it; those that cost the least error go first.
void ShapeEncoder::SpendRest(double left, const Choice& choice) {
  const float step = FindStep(choice.StepLevel());
  double steps = left / (double{step} * double{step});
  for (float most = 0.6F; most < 1.3F && steps > 2 * double{most} - 1.1; most += 0.05F) {
    for (std::size_t k = 0; k < m_chosen.size(); ++k) {
      if (m_wanted[k] >= most || (m_chosen[k] != 1 && m_chosen[k] != -1)) continue;
      const double cost = 2 * double{m_wanted[k]} - 1;  // w² − (1 − w)²
      if (cost > steps) continue;
      steps -= cost;
      m_chosen[k] = 0;
    }
  }
}

void ShapeEncoder::Write(const PatchModel& model, const Choice& choice, std::vector<std::uint8_t>& out) {
  const Basis* basis = choice.head.mode.usesBasis ? model.basis : nullptr;
  RangeEncoder encoder(out);
  WriteHead(encoder, model.size, choice.head);
  const std::span<const ExpectedContext> expected = m_plans.Find(basis, m_chosen.size(), choice.StepLevel());
  Contexts contexts;
  for (std::size_t k = 0; k < m_chosen.size(); ++k) {
    WriteCoefficient(encoder, contexts, expected[k], m_chosen[k]);
  }
  encoder.Finish();
}

// The error of a decoded shape. Measured in the body's frame: rotations preserve lengths.
ShapeEncoding ShapeEncoder::Measure(std::span<const Vector3> shape) const {
  ShapeEncoding encoding{true};
  double sum = 0;
  float largest = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vector3 error = shape[i] - m_local[i];
    const float square = Dot(error, error);
    sum += double{square};
    largest = std::max(largest, square);
  }
  encoding.rmsError = static_cast<float>(std::sqrt(sum / static_cast<double>(shape.size())));
  encoding.maxError = std::sqrt(largest);
  return encoding;
}

ShapeEncoding ShapeEncoder::EncodeAt(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                     float targetRms, std::vector<std::uint8_t>& out) {
  Choice choice;
  ShapeHead& head = choice.head;
  const unsigned grid = FindGrid(targetRms);
  head.pose = Quantise(pose, MakePoseGrid(grid, model.size));
  const Pose seen = Dequantise(head.pose);
  FindDepartures(model, seen, vertices);
  FindSides(model.obstacles, seen, model.reach, m_sides);
  head.mode.usesBasis = model.basis != nullptr;
  if (head.mode.usesBasis) {
    Transform(*model.basis);
    head.mode.followsContact = FindContact(model, m_sides, m_contact) && FollowsContact(model, targetRms);
  }
  double budget = kPlannedShare * static_cast<double>(vertices.size()) * double{targetRms} * double{targetRms};
  GuessStep(model, budget, choice);
  ShapeEncoding encoding;
  m_shape.resize(vertices.size());
  constexpr int kTries = 4;
  for (int i = 0; i < kTries; ++i) {
    SearchStep(model, budget, choice);
    m_decoder.Rebuild(model, head, m_chosen, m_shape);
    encoding = Measure(m_shape);
    encoding.step = FindStep(choice.StepLevel());
    if (encoding.rmsError <= targetRms) break;
    const double over = double{encoding.rmsError} / double{targetRms};
    budget *= 0.998 / (over * over);
  }
  Write(model, choice, out);
  return encoding;
}

ShapeEncoding ShapeEncoder::Encode(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                   float targetRms, std::size_t maxBytes, std::vector<std::uint8_t>& out) {
  assert(!model.rest.empty() && model.rest.size() == vertices.size() && targetRms > 0.0F);
  const std::size_t begin = out.size();
  constexpr int kCoarsenings = 64;  // a million times coarser
  float target = targetRms;
  for (int i = 0; i < kCoarsenings; ++i, target *= 1.25F) {
    ShapeEncoding encoding = EncodeAt(model, pose, vertices, target, out);
    if (model.basis != nullptr && encoding.rmsError > target) {  // too far for the decoder's sums: vertex by vertex
      PatchModel plain = model;
      plain.basis = nullptr;
      out.resize(begin);
      encoding = EncodeAt(plain, pose, vertices, target, out);
    }
    if (out.size() - begin <= maxBytes) return encoding;
    out.resize(begin);
  }
  return {};
}

}  // namespace wobble::protocol
