// Context plans hold what many records have in common in their contexts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/basis.h"
#include "protocol/codec/contexts.h"

namespace wobble::protocol {

// The expected contexts of records, kept for each basis and step: they are half of the work of finding a context.
class ContextPlans {
 public:
  // For a record of `count` coefficients. basis: nullptr when it is coded without. Valid for the next
  // kMostPlans − 1 calls.
  [[nodiscard]] std::span<const ExpectedContext> Find(const Basis* basis, std::size_t count, int stepLevel);

 private:
  // 4 bytes a coefficient: 125 kB for balls of 162 vertices.
  static constexpr std::size_t kMostPlans = 64;
  struct Plan {
    std::uint64_t serial = 0;
    std::size_t count = 0;
    int stepLevel = 0;
    std::uint64_t used = 0;  // when it was asked for last
    std::vector<ExpectedContext> contexts;
  };

  std::vector<Plan> m_plans;
  std::uint64_t m_clock = 0;
  std::vector<int> m_levels;  // scratch
};

}  // namespace wobble::protocol
