// Bodies go through the stages of ShapeEncoder together. Records that the first rounding does not settle are rounded
// again in further waves, each with all that are left. What is rare (a record that does not fit, values beyond int16, a
// model without a basis) is left to the plain encoder.
#include "protocol/codec/encoding/crowd_encoder.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "protocol/codec/encoding/coefficient_writer.h"
#include "protocol/codec/encoding/departures.h"

namespace wobble::protocol {
namespace {

// With fewer records a plain rounding of each is as fast.
constexpr std::size_t kFewestLanes = 3;

}  // namespace

struct CrowdEncoder::Member {
  const CrowdBody* body = nullptr;
  Choice choice;
  double budget = 0;  // m²
  double error = 0;   // of the last rounding, m²
  StepSearch search{0, choice};
  ContactScratch contact;
  std::vector<Side> sides;
  bool isTouching = false;
  float unit = 0;              // of products, m
  std::vector<Vector3> local;  // as in ShapeEncoder
  std::vector<std::int16_t> rounded;
  std::vector<std::int32_t> products;
  std::vector<float> coefficients;
  std::vector<std::int32_t> chosen, bestChosen;
  std::vector<std::int16_t> values;  // of modes, in sixteenths of the step; of a scalar basis three rows
  bool isShort = false;              // whether they fit
  std::vector<std::uint32_t> sums;
  ShapeEncoding encoding;

  [[nodiscard]] std::span<const std::int32_t> Along() const {
    return choice.head.mode.followsContact ? std::span<const std::int32_t>(contact.along)
                                           : std::span<const std::int32_t>{};
  }
};

CrowdEncoder::CrowdEncoder(KernelSet kernels) : m_kernels(FindCrowdKernels(kernels)) {}
CrowdEncoder::~CrowdEncoder() = default;

void CrowdEncoder::Encode(const PatchModel& model, std::size_t maxBytes, std::span<CrowdBody> bodies) {
  for (; !bodies.empty(); bodies = bodies.subspan(std::min(bodies.size(), kMostLanes))) {
    EncodeTogether(model, maxBytes, bodies.first(std::min(bodies.size(), kMostLanes)));
  }
}

void CrowdEncoder::EncodeTogether(const PatchModel& model, std::size_t maxBytes, std::span<CrowdBody> bodies) {
  const auto encodeAlone = [&](CrowdBody& body) {
    body.encoding = m_alone.Encode(model, body.pose, body.vertices, body.targetRms, maxBytes, *body.out);
  };
  if (model.basis == nullptr || bodies.size() == 1) {
    for (CrowdBody& body : bodies) encodeAlone(body);
    return;
  }
  m_count = bodies.size();
  while (m_members.size() < m_count) m_members.push_back(std::make_unique<Member>());
  for (std::size_t i = 0; i < m_count; ++i) Prepare(model, bodies[i], *m_members[i]);
  FindCoefficients(model);
  m_searched.clear();
  for (std::size_t i = 0; i < m_count; ++i) m_searched.push_back(m_members[i].get());
  for (int i = 0; i < kRebuildings && !m_searched.empty(); ++i) {
    SearchSteps(model);
    Rebuild(model);
  }
  for (std::size_t i = 0; i < m_count; ++i) {
    const Member& member = *m_members[i];
    CrowdBody& body = bodies[i];
    const std::size_t begin = body.out->size();
    if (member.encoding.rmsError <= body.targetRms) {
      WriteShape(model.size, member.choice.head,
                 m_plans.Find(model.basis, member.chosen.size(), member.choice.StepLevel()), member.chosen, *body.out);
      body.encoding = member.encoding;
      if (body.out->size() - begin <= maxBytes) continue;
      body.out->resize(begin);
    }
    encodeAlone(body);
  }
}

void CrowdEncoder::Prepare(const PatchModel& model, const CrowdBody& body, Member& member) {
  assert(model.rest.size() == body.vertices.size() && body.targetRms > 0.0F);
  member.body = &body;
  member.choice = {.head = MakeHead(model, body.pose, body.targetRms)};
  const Pose seen = Dequantise(member.choice.head.pose);
  FindDepartures(model, seen, body.vertices, member.local, member.coefficients);
  member.unit = RoundDepartures(*model.basis, member.coefficients, member.rounded);
  member.products.resize(member.coefficients.size());
  FindSides(model.obstacles, seen, model.reach, member.sides);
  member.isTouching = FindPressed(model, member.sides, member.contact);
  member.chosen.resize(member.coefficients.size());
  member.bestChosen.resize(member.coefficients.size());
}

// The products with all modes; then the step at which each search begins.
void CrowdEncoder::FindCoefficients(const PatchModel& model) {
  const Basis& basis = *model.basis;
  const auto members = std::span(m_members).first(m_count);
  std::array<ProductRow, 3> rows;
  const auto addRows = [&](const std::int16_t* numbers, std::int32_t* products) {
    const std::size_t count = ListRows(basis, numbers, products, rows);
    m_rows.insert(m_rows.end(), rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count));
  };
  m_modes.resize(basis.Rows());
  std::iota(m_modes.begin(), m_modes.end(), std::uint16_t{0});
  m_rows.clear();
  for (const auto& each : members) addRows(each->rounded.data(), each->products.data());
  m_kernels.findProducts(MakeProductTask(basis, m_modes), m_rows.data(), m_rows.size());
  m_rows.clear();
  std::span<const std::uint16_t> modes;
  for (const auto& each : members) {
    if (!each->isTouching) continue;
    addRows(each->contact.moved.data(), each->contact.along.data());
    modes = each->contact.modes;
  }
  m_kernels.findProducts(MakeProductTask(basis, modes), m_rows.data(), m_rows.size());
  for (const auto& each : members) {
    Member& member = *each;
    const float target = member.body->targetRms;
    if (member.unit != 0) {
      for (std::size_t k = 0; k < member.products.size(); ++k) {
        member.coefficients[k] = static_cast<float>(member.products[k]) * member.unit;
      }
    }
    ShapeHead& head = member.choice.head;
    head.mode.followsContact =
        member.isTouching && FollowsContact(model, member.coefficients, member.contact.along, target);
    member.budget = FindBudget(model, target);
    head.stepIndex = GuessStep(model, head.pose.grid.grid, member.coefficients, member.Along(), member.budget, m_left);
  }
}

void CrowdEncoder::SearchSteps(const PatchModel& model) {
  for (Member* each : m_searched) each->search = StepSearch(each->budget, each->choice);
  m_rounded = m_searched;
  while (!m_rounded.empty()) {
    RoundTogether(model, m_rounded);
    std::erase_if(m_rounded, [](Member* each) {
      const StepSearch::Verdict verdict = each->search.Judge(each->error, each->choice);
      if (each->search.Keeps()) each->chosen.swap(each->bestChosen);
      if (verdict == StepSearch::Verdict::kBest) each->chosen.swap(each->bestChosen);
      return verdict != StepSearch::Verdict::kAgain;
    });
  }
  for (Member* each : m_searched) {
    if (each->search.Left() <= 0) continue;
    const RoundingTask task = MakeRoundingTask(model, each->choice, each->coefficients, each->contact.along, {});
    SpendRest(task, each->search.Left(), each->chosen, m_spend);
  }
}

void CrowdEncoder::RoundTogether(const PatchModel& model, std::span<Member* const> members) {
  std::array<RoundingLane, kMostLanes> lanes;
  const std::size_t count = members.front()->coefficients.size();
  for (std::size_t i = 0; i < members.size(); ++i) {
    Member& member = *members[i];
    const auto expected = m_plans.Find(model.basis, count, member.choice.StepLevel());
    const RoundingTask task =
        MakeRoundingTask(model, member.choice, member.coefficients, member.contact.along, expected);
    if (members.size() < kFewestLanes) {
      member.error = RoundCoefficients(task, member.chosen);
      continue;
    }
    lanes[i] = {.coefficients = task.coefficients.data(),
                .along = task.along.empty() ? nullptr : task.along.data(),
                .expected = expected.data(),
                .chosen = member.chosen.data(),
                .perStep = task.perStep,
                .contactScale = task.contactScale,
                .bitWorth = task.bitWorth};
  }
  if (members.size() < kFewestLanes) return;
  m_kernels.round({FindCostsByPlace(), model.basis->gains.data(), count}, lanes.data(), members.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    const double step = double{FindStep(members[i]->choice.StepLevel())};
    members[i]->error = lanes[i].error * step * step;
  }
}

// Decodes what was searched; records that are within their targets are done.
void CrowdEncoder::Rebuild(const PatchModel& model) {
  const Basis& basis = *model.basis;
  const std::size_t size = 3 * model.rest.size(), rows = basis.Rows(), axes = basis.isScalar ? 3 : 1;
  const std::size_t apart = rows + rows % 2;  // of rows of values: whole pairs
  m_values.resize(size);
  for (Member* each : m_searched) {
    const float step = FindStep(each->choice.StepLevel());
    FindValues(each->chosen, each->Along(), basis.gains, FindContactScale(model.size, step), m_values);
    each->values.assign(axes * apart, 0);
    each->sums.resize(size);
    std::uint32_t beyond = 0;
    for (std::size_t k = 0; k < size; ++k) beyond |= (m_values[k] + 0x8000U) >> 16;
    each->isShort = beyond == 0;
    if (!each->isShort) continue;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      std::int16_t* const values = each->values.data() + axis * apart;
      for (std::size_t k = 0; k < rows; ++k) values[k] = static_cast<std::int16_t>(m_values[k * axes + axis]);
    }
  }
  FindSumsTogether(basis);
  m_shape.resize(model.rest.size());
  std::erase_if(m_searched, [&](Member* each) {
    const ShapeHead& head = each->choice.head;
    const float step = FindStep(each->choice.StepLevel()), target = each->body->targetRms;
    if (each->isShort) {
      MoveVertices(model, each->sums, step, m_shape);
    } else {
      m_decoder.Rebuild(model, head, each->chosen, &each->contact, m_shape);
    }
    each->encoding = MeasureError(each->local, m_shape);
    each->encoding.step = step;
    if (each->encoding.rmsError <= target) return true;
    each->budget = ShrinkBudget(each->budget, each->encoding.rmsError, target);
    return false;
  });
}

void CrowdEncoder::FindSumsTogether(const Basis& basis) {
  const std::size_t rows = basis.Rows(), axes = basis.isScalar ? 3 : 1, pairs = (rows + 1) / 2;
  m_groups.clear();
  for (Member* each : m_searched) {
    for (std::size_t axis = 0; each->isShort && axis < axes; ++axis) {
      if (m_groups.empty() || m_groups.back().count == kMostProductRows) m_groups.emplace_back();
      SumGroup& group = m_groups.back();
      group.bodies[group.count++] = {each->values.data() + axis * 2 * pairs, each->sums.data() + axis * rows};
    }
  }
  m_usedPairs.resize(m_groups.size() * pairs);
  for (std::size_t i = 0; i < m_groups.size(); ++i) {
    SumGroup& group = m_groups[i];
    std::uint16_t* const used = m_usedPairs.data() + i * pairs;
    group.used = used;
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      int any = 0;
      for (std::size_t body = 0; body < group.count; ++body) {
        any |= group.bodies[body].values[2 * pair] | group.bodies[body].values[2 * pair + 1];
      }
      used[group.usedCount] = static_cast<std::uint16_t>(pair);
      group.usedCount += any != 0 ? 1 : 0;
    }
  }
  m_kernels.findSums({basis.pairs.data(), rows}, m_groups.data(), m_groups.size());
}

}  // namespace wobble::protocol
