#include "protocol/codec/context_plans.h"

#include <algorithm>

namespace wobble::protocol {
namespace {

// The level of every coefficient that is coded without a basis.
constexpr int kPlainLevel = 16;

// The level (contexts.h) of a coefficient. basis: nullptr when the record is coded without.
int FindLevel(const Basis* basis, std::size_t coefficient, int stepLevel) {
  if (basis == nullptr) return kPlainLevel;
  const int level = basis->levels[coefficient] - stepLevel;
  return level < kLowestLevel ? kLowestLevel : level > kHighestLevel ? kHighestLevel : level;
}

}  // namespace

std::span<const ExpectedContext> ContextPlans::Find(const Basis* basis, std::size_t count, int stepLevel) {
  // Without a basis all levels are the same, whatever the step.
  constexpr std::uint64_t kNoBasis = ~std::uint64_t{0};
  const std::uint64_t serial = basis == nullptr ? kNoBasis : basis->serial;
  if (basis == nullptr) stepLevel = 0;
  const auto found = std::find_if(m_plans.begin(), m_plans.end(), [&](const Plan& plan) {
    return plan.serial == serial && plan.stepLevel == stepLevel && plan.count == count;
  });
  ++m_clock;
  if (found != m_plans.end() && serial != 0) {
    found->used = m_clock;
    return found->contexts;
  }
  if (m_plans.size() < kMostPlans) m_plans.emplace_back();
  // The one not used for longest goes; a new one has not been used at all.
  Plan& plan =
      *std::min_element(m_plans.begin(), m_plans.end(), [](const Plan& a, const Plan& b) { return a.used < b.used; });
  plan.used = m_clock;
  plan.serial = serial, plan.stepLevel = stepLevel, plan.count = count;
  m_levels.resize(count);
  for (std::size_t k = 0; k < count; ++k) m_levels[k] = FindLevel(basis, k, stepLevel);
  plan.contexts.resize(count);
  Contexts::Expect(m_levels, plan.contexts);
  return plan.contexts;
}

}  // namespace wobble::protocol
