// Rounds, decodes its own coefficients, and looks whether the error is within the target: a record's error is what its
// decoders will see.
#include "protocol/codec/encoding/shape_encoder.h"

#include <cassert>
#include <numeric>

#include "protocol/codec/encoding/coefficient_writer.h"
#include "protocol/codec/encoding/departures.h"

namespace wobble::protocol {

// Turns displacements into coefficients in the basis.
void ShapeEncoder::Transform(const Basis& basis) {
  const std::size_t size = m_coefficients.size();
  const float unit = RoundDepartures(basis, m_coefficients, m_rounded);
  if (unit == 0) return;
  m_products.resize(size);
  m_modes.resize(basis.Rows());
  std::iota(m_modes.begin(), m_modes.end(), std::uint16_t{0});
  std::array<ProductRow, 3> rows;
  const std::size_t count = ListRows(basis, m_rounded.data(), m_products.data(), rows);
  FindProducts(MakeProductTask(basis, m_modes), std::span(rows).first(count));
  for (std::size_t k = 0; k < size; ++k) m_coefficients[k] = static_cast<float>(m_products[k]) * unit;
}

RoundingTask ShapeEncoder::MakeTask(const PatchModel& model, const Choice& choice) {
  const Basis* basis = choice.head.mode.usesBasis ? model.basis : nullptr;
  const auto expected = m_plans.Find(basis, m_coefficients.size(), choice.StepLevel());
  return MakeRoundingTask(model, choice, m_coefficients, m_contact.along, expected);
}

// Tries steps and worths of a bit until the error is just within the budget, m². The coefficients of the best try stay
// chosen.
void ShapeEncoder::SearchStep(const PatchModel& model, double budget, Choice& choice) {
  StepSearch search(budget, choice);
  m_chosen.resize(m_coefficients.size());
  m_bestChosen.resize(m_coefficients.size());
  for (;;) {
    const StepSearch::Verdict verdict = search.Judge(RoundCoefficients(MakeTask(model, choice), m_chosen), choice);
    if (search.Keeps()) m_chosen.swap(m_bestChosen);
    if (verdict == StepSearch::Verdict::kBest) m_chosen.swap(m_bestChosen);
    if (verdict != StepSearch::Verdict::kAgain) break;
  }
  if (search.Left() > 0) SpendRest(MakeTask(model, choice), search.Left(), m_chosen, m_spend);
}

ShapeEncoding ShapeEncoder::EncodeAt(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                     float targetRms, std::vector<std::uint8_t>& out) {
  Choice choice{.head = MakeHead(model, pose, targetRms)};
  ShapeHead& head = choice.head;
  const Pose seen = Dequantise(head.pose);
  FindDepartures(model, seen, vertices, m_local, m_coefficients);
  if (head.mode.usesBasis) {
    Transform(*model.basis);
    FindSides(model.obstacles, seen, model.reach, m_sides);
    head.mode.followsContact =
        FindContact(model, m_sides, m_contact) && FollowsContact(model, m_coefficients, m_contact.along, targetRms);
  }
  double budget = FindBudget(model, targetRms);
  std::span<const std::int32_t> along;
  if (head.mode.followsContact) along = m_contact.along;
  head.stepIndex = GuessStep(model, head.pose.grid.grid, m_coefficients, along, budget, m_left);
  ShapeEncoding encoding;
  m_shape.resize(vertices.size());
  for (int i = 0; i < kRebuildings; ++i) {
    SearchStep(model, budget, choice);
    m_decoder.Rebuild(model, head, m_chosen, &m_contact, m_shape);
    encoding = MeasureError(m_local, m_shape);
    encoding.step = FindStep(choice.StepLevel());
    if (encoding.rmsError <= targetRms) break;
    budget = ShrinkBudget(budget, encoding.rmsError, targetRms);
  }
  const Basis* basis = head.mode.usesBasis ? model.basis : nullptr;
  WriteShape(model.size, head, m_plans.Find(basis, m_chosen.size(), choice.StepLevel()), m_chosen, out);
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
