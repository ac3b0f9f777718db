// The inner loops of a crowd's encoder, compiled once for each instruction set. They have the same bits on all.
#pragma once

#include <cstddef>
#include <cstdint>

#include "protocol/codec/mode_products.h"

namespace wobble::protocol {

// Sums of modes for up to kMostProductRows bodies.
struct SumGroup {
  struct Body {
    const std::int16_t* values = nullptr;  // of the modes, two for each pair
    std::uint32_t* sums = nullptr;         // of the rows; overwritten
  };
  Body bodies[kMostProductRows];
  std::size_t count = 0;
  const std::uint16_t* used = nullptr;  // the pairs of which any body has a value
  std::size_t usedCount = 0;
};
struct SumTask {
  const std::int16_t* pairs = nullptr;  // of the basis
  std::size_t rows = 0;
};

// One record that is rounded in a lane.
struct RoundingLane {
  const float* coefficients = nullptr;  // m
  const std::int32_t* along = nullptr;  // of ContactScratch; nullptr when the record does not follow contact
  const void* expected = nullptr;       // ExpectedContext of each coefficient
  std::int32_t* chosen = nullptr;       // in steps
  float perStep = 0;                    // 1 / step, 1/m
  float contactScale = 0;
  float bitWorth = 0;
  double error = 0;  // out: the sum of squared errors, steps²
};
struct RoundingLanes {
  const float* costs = nullptr;        // FindCostsByPlace
  const std::int8_t* gains = nullptr;  // of the basis
  std::size_t count = 0;               // of coefficients
};

struct CrowdKernels {
  // As FindProducts; any number of rows.
  void (*findProducts)(const ProductTask& task, const ProductRow* rows, std::size_t count) = nullptr;
  void (*findSums)(const SumTask& task, const SumGroup* groups, std::size_t count) = nullptr;
  // Of at most kMostLanes lanes.
  void (*round)(const RoundingLanes& task, RoundingLane* lanes, std::size_t count) = nullptr;
};
inline constexpr std::size_t kMostLanes = 32;

enum class KernelSet { kBaseline, kAvx512, kVnni };
// The best that the processor has, up to `most`.
[[nodiscard]] const CrowdKernels& FindCrowdKernels(KernelSet most = KernelSet::kVnni);

// Contexts are thirds of places on the scale of three eighths of an octave (Contexts::Find): with a row for each place
// the lanes need no division.
inline constexpr std::size_t kPlaces = 108;
inline constexpr std::size_t kCostsOfPlace = 16;
[[nodiscard]] const float* FindCostsByPlace();

}  // namespace wobble::protocol
