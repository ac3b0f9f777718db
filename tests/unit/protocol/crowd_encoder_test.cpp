// A crowd's payloads against those of each body alone, and the crowd's kernels against plain loops, to the bit.
#include "protocol/codec/encoding/crowd_encoder.h"

#include <gtest/gtest.h>

#include <random>

#include "protocol/codec/encoding/rounding.h"
#include "protocol/codec/mode_sums.h"
#include "tests/unit/protocol/shape_clouds.h"

namespace wobble::protocol {
namespace {

using clouds::Cloud;
using clouds::MakeCloud;
using clouds::MakeFloor;
using CrowdBytes = std::vector<std::uint8_t>;

constexpr std::array kSets{KernelSet::kBaseline, KernelSet::kAvx512, KernelSet::kVnni};

void ExpectEqual(const ShapeEncoding& a, const ShapeEncoding& b) {
  EXPECT_EQ(a.fits, b.fits);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.rmsError, b.rmsError);
  EXPECT_EQ(a.maxError, b.maxError);
}

// targets: of the bodies in turn, as shares of the size.
void ExpectBytesOfEachAlone(const PatchModel& model, std::span<const Cloud> clouds, std::span<const float> targets,
                            std::size_t maxBytes) {
  for (const KernelSet set : kSets) {
    std::vector<CrowdBytes> payloads(clouds.size(), CrowdBytes{1, 2, 3});
    std::vector<CrowdBody> bodies;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      bodies.push_back({.pose = clouds[i].pose,
                        .vertices = clouds[i].vertices,
                        .targetRms = targets[i % targets.size()] * model.size,
                        .out = &payloads[i],
                        .encoding = {}});
    }
    CrowdEncoder crowd(set);
    crowd.Encode(model, maxBytes, bodies);
    ShapeEncoder alone;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      CrowdBytes bytes{1, 2, 3};
      const ShapeEncoding encoding =
          alone.Encode(model, clouds[i].pose, clouds[i].vertices, bodies[i].targetRms, maxBytes, bytes);
      ASSERT_EQ(payloads[i], bytes) << "body " << i << " of " << clouds.size() << ", "
                                    << "kernels " << static_cast<int>(set);
      ExpectEqual(bodies[i].encoding, encoding);
    }
  }
}

// Bodies of one blueprint, some at rest and some far out of shape, at the heights where a floor presses on most.
std::vector<Cloud> MakeClouds(unsigned seed, std::size_t bodies, std::size_t vertices, float size) {
  std::vector<Cloud> clouds;
  for (unsigned i = 0; i < bodies; ++i) {
    clouds.push_back(MakeCloud(100 * seed + i, vertices, size, i % 5 == 0 ? 0 : 0.03F * static_cast<float>(i % 11)));
    const float drop = clouds[0].pose.centroid.z - clouds[i].pose.centroid.z + 0.05F * static_cast<float>(i % 7) * size;
    clouds[i].pose.centroid.z += drop;
    for (Vector3& vertex : clouds[i].vertices) vertex.z += drop;
  }
  return clouds;
}

TEST(CrowdEncoder, HasTheBytesOfEachBodyAlone) {
  constexpr std::array<float, 4> kTargets{0.0025F, 0.01F, 0.001F, 0.005F};
  unsigned seed = 0;
  for (const BasisSource::Kind kind : clouds::kKinds) {
    for (const std::size_t vertices : {12U, 42U, 162U}) {
      const float size = vertices == 42 ? 0.4F : 1.0F;
      const auto basis = clouds::MakeBasis(kind, vertices, 0.05F * size);
      for (const std::size_t bodies : {1U, 2U, 3U, 9U, 17U, 37U}) {
        if (vertices == 162 && bodies == 17) continue;  // time under sanitizers
        const std::vector<Cloud> clouds = MakeClouds(++seed, bodies, vertices, size);
        const auto floor = MakeFloor(clouds[0]);
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        ExpectBytesOfEachAlone(clouds::MakeModel(clouds[0], basis.get(), floor), clouds, kTargets, kMaxRecordPayload);
        ExpectBytesOfEachAlone(clouds::MakeModel(clouds[0], basis.get()), clouds, std::span(kTargets).first(1), 1000);
      }
    }
  }
}

// Records that do not fit, values beyond int16, vertices beyond the sums' range, and no basis at all.
TEST(CrowdEncoder, HasTheBytesOfEachBodyAloneInRareCases) {
  std::vector<Cloud> clouds = MakeClouds(7, 12, 42, 1);
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const float far = std::ldexp(1.0F, static_cast<int>(i));
    if (i % 3 == 1) clouds[i].vertices[i].x += far;
    if (i % 3 == 2) clouds[i].vertices[i] = clouds[i].vertices[i] + Vector3{far, -far, far};
  }
  constexpr std::array<float, 3> kTargets{0.0025F, 0.0001F, 0.02F};
  for (const BasisSource::Kind kind : clouds::kKinds) {
    const auto basis = clouds::MakeBasis(kind, 42, 0.05F);
    for (const std::size_t maxBytes : {20U, 60U, 100U, 1000U}) {
      ExpectBytesOfEachAlone(clouds::MakeModel(clouds[0], basis.get()), clouds, kTargets, maxBytes);
    }
  }
  ExpectBytesOfEachAlone(clouds::MakeModel(clouds[0]), clouds, kTargets, 1000);
}

TEST(CrowdEncoder, ProductsHaveTheBitsOfPlainOnes) {
  std::mt19937 random(5);
  for (const std::size_t size : {1U, 2U, 15U, 16U, 31U, 33U, 47U, 64U, 129U}) {
    std::vector<std::int16_t> columns(size * size);
    for (auto& number : columns) number = static_cast<std::int16_t>(random());
    columns[0] = -32768;
    std::vector<std::uint16_t> modes;
    for (std::size_t k = 0; k < size; ++k) {
      if (random() % 3 != 0 || k == 0) modes.push_back(static_cast<std::uint16_t>(k));
    }
    for (std::size_t count = 0; count <= 13; ++count) {
      std::vector<std::vector<std::int16_t>> numbers(count, std::vector<std::int16_t>(PadRow(size)));
      std::vector<ProductRow> rows(count), plainRows(count);
      std::vector<std::int32_t> products(count * 3 * size, 7), plain = products;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t at = 0; at < size; ++at) {
          numbers[i][at] =
              random() % 4 == 0 || at / 16 % 3 == 1 ? std::int16_t{0} : static_cast<std::int16_t>(random());
        }
        const std::size_t stride = i % 2 == 0 ? 1 : 3;
        rows[i] = {numbers[i].data(), products.data() + i * 3 * size, stride};
        plainRows[i] = {numbers[i].data(), plain.data() + i * 3 * size, stride};
      }
      const ProductTask task{columns.data(), size, modes.data(), modes.size()};
      FindProductsPlainly(task, plainRows);
      FindProducts(task, rows);
      EXPECT_EQ(products, plain) << size;
      for (const KernelSet set : kSets) {
        std::fill(products.begin(), products.end(), 7);
        FindCrowdKernels(set).findProducts(task, rows.data(), rows.size());
        EXPECT_EQ(products, plain) << size << ", "
                                   << "kernels " << static_cast<int>(set);
      }
    }
  }
}

TEST(CrowdEncoder, SumsHaveTheBitsOfPlainOnes) {
  std::mt19937 random(6);
  for (const std::size_t rows : {1U, 2U, 7U, 16U, 33U, 63U, 64U, 129U, 150U}) {
    Basis basis;
    basis.isScalar = true;
    basis.vertices = rows;
    const std::size_t pairs = (rows + 1) / 2;
    basis.columns.resize(rows * rows);
    basis.pairs.resize(2 * pairs * rows);
    for (std::size_t k = 0; k < rows; ++k) {
      for (std::size_t i = 0; i < rows; ++i) {
        const auto number = static_cast<std::int16_t>(random());
        basis.columns[k * rows + i] = number;
        basis.pairs[2 * (k / 2 * rows + i) + k % 2] = number;
      }
    }
    for (std::size_t count = 1; count <= kMostProductRows; ++count) {
      std::vector<std::vector<std::int16_t>> values(count, std::vector<std::int16_t>(2 * pairs));
      std::vector<std::vector<std::uint32_t>> sums(count, std::vector<std::uint32_t>(rows));
      std::vector<std::uint16_t> used;
      SumGroup group;
      group.count = count;
      for (std::size_t i = 0; i < count; ++i) group.bodies[i] = {values[i].data(), sums[i].data()};
      for (std::size_t pair = 0; pair < pairs; ++pair) {
        if (random() % 3 == 0) continue;
        used.push_back(static_cast<std::uint16_t>(pair));
        for (auto& each : values) {
          each[2 * pair] = static_cast<std::int16_t>(random());
          if (2 * pair + 1 < rows) each[2 * pair + 1] = static_cast<std::int16_t>(random());
        }
      }
      group.used = used.data();
      group.usedCount = used.size();
      for (const KernelSet set : kSets) {
        FindCrowdKernels(set).findSums({basis.pairs.data(), rows}, &group, 1);
        for (std::size_t i = 0; i < count; ++i) {
          std::vector<std::uint32_t> wide(rows), plain(rows, 0);
          for (std::size_t k = 0; k < rows; ++k) wide[k] = static_cast<std::uint32_t>(values[i][k]);
          AddModesPlainly(basis, wide, plain.data());
          EXPECT_EQ(sums[i], plain) << rows << " rows, "
                                    << "kernels " << static_cast<int>(set);
        }
      }
    }
  }
}

// Coefficients of all sizes, from nothing to beyond the largest, with every context and escapes.
struct RoundedRecord {
  std::vector<float> coefficients;
  std::vector<std::int32_t> along;
  std::vector<ExpectedContext> expected;
  float step = 1;
  float bitWorth = 0.1F;

  [[nodiscard]] RoundingTask MakeTask(std::span<const std::int8_t> gains) const {
    RoundingTask task;
    task.coefficients = coefficients;
    task.expected = expected;
    task.step = step;
    task.perStep = 1.0F / step;
    task.contactScale = 0.013F / step;
    task.bitWorth = bitWorth;
    if (!along.empty()) task.along = along, task.gains = gains;
    return task;
  }
};

RoundedRecord MakeRecord(std::mt19937& random, std::size_t count, bool followsContact) {
  std::uniform_real_distribution<float> unit(-1, 1);
  RoundedRecord record;
  record.step = std::ldexp(1.0F + 0.5F * unit(random), static_cast<int>(random() % 6) - 10);
  record.bitWorth = 0.12F + 0.05F * unit(random);
  const int octave = static_cast<int>(random() % 24) - 4;
  std::vector<int> levels;
  for (std::size_t k = 0; k < count; ++k) {
    const int size = random() % 8 == 0 ? static_cast<int>(random() % 24) : octave - static_cast<int>(8 * k / count);
    record.coefficients.push_back(random() % 9 == 0 ? 0.0F : std::ldexp(record.step * unit(random), size));
    levels.push_back(std::clamp(8 * octave - static_cast<int>(random() % 60), kLowestLevel, kHighestLevel));
    if (followsContact) record.along.push_back(static_cast<std::int32_t>(random()) >> (8 + random() % 20));
  }
  record.expected.resize(count);
  Contexts::Expect(levels, record.expected);
  return record;
}

TEST(CrowdEncoder, LanesRoundAsThePlainLoop) {
  std::mt19937 random(8);
  for (int round = 0; round < 40; ++round) {
    const std::size_t count = std::array{1, 7, 16, 17, 48, 126, 486}[round % 7];
    const std::size_t records = 1 + random() % kMostLanes;
    std::vector<std::int8_t> gains;
    for (std::size_t k = 0; k < count; ++k) gains.push_back(static_cast<std::int8_t>(random()));
    std::vector<RoundedRecord> all;
    std::vector<std::vector<std::int32_t>> chosen(records, std::vector<std::int32_t>(count));
    for (std::size_t i = 0; i < records; ++i) all.push_back(MakeRecord(random, count, random() % 2 == 0));
    for (const KernelSet set : kSets) {
      std::vector<RoundingLane> lanes(records);
      for (std::size_t i = 0; i < records; ++i) {
        const RoundingTask task = all[i].MakeTask(gains);
        lanes[i] = {.coefficients = task.coefficients.data(),
                    .along = task.along.empty() ? nullptr : task.along.data(),
                    .expected = task.expected.data(),
                    .chosen = chosen[i].data(),
                    .perStep = task.perStep,
                    .contactScale = task.contactScale,
                    .bitWorth = task.bitWorth};
      }
      FindCrowdKernels(set).round({FindCostsByPlace(), gains.data(), count}, lanes.data(), records);
      for (std::size_t i = 0; i < records; ++i) {
        const RoundingTask task = all[i].MakeTask(gains);
        std::vector<std::int32_t> plain(count);
        const double error = RoundCoefficients(task, plain);
        ASSERT_EQ(chosen[i], plain) << "round " << round << ", record " << i << ", "
                                    << "kernels " << static_cast<int>(set);
        EXPECT_EQ(lanes[i].error * double{task.step} * double{task.step}, error);
      }
    }
  }
}

// As it was first written: a pass over all coefficients for each limit.
void SpendPlainly(const RoundingTask& task, double left, std::span<std::int32_t> chosen) {
  double steps = left / (double{task.step} * double{task.step});
  for (float most = 0.6F; most < 1.3F && steps > 2 * double{most} - 1.1; most += 0.05F) {
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const float wanted = std::fabs(FindWanted(task, k));
      if (wanted >= most || (chosen[k] != 1 && chosen[k] != -1)) continue;
      const double cost = 2 * double{wanted} - 1;
      if (cost > steps) continue;
      steps -= cost;
      chosen[k] = 0;
    }
  }
}

TEST(CrowdEncoder, SpendsAsPassesOverAllCoefficientsDo) {
  std::mt19937 random(9);
  SpendScratch scratch;
  int changed = 0;
  for (int round = 0; round < 400; ++round) {
    RoundedRecord record = MakeRecord(random, 486, false);
    std::uniform_real_distribution<float> size(0.4999F, 1.6F);
    for (float& x : record.coefficients) x = record.step * size(random) * (random() % 2 == 0 ? 1.0F : -1.0F);
    if (round % 10 == 0) record.coefficients[random() % 486] = std::nextafter(0.5F, 0.0F) * record.step;
    const RoundingTask task = record.MakeTask({});
    std::vector<std::int32_t> chosen(486);
    for (std::size_t k = 0; k < 486; ++k) {
      chosen[k] = static_cast<std::int32_t>(std::lround(record.coefficients[k] / record.step));
      if (random() % 4 == 0) chosen[k] = static_cast<std::int32_t>(random() % 3) - 1;
    }
    std::vector<std::int32_t> plain = chosen, before = chosen;
    const double left =
        double{record.step} * double{record.step} * std::ldexp(1.0, static_cast<int>(random() % 12) - 4);
    SpendPlainly(task, left, plain);
    SpendRest(task, left, chosen, scratch);
    ASSERT_EQ(chosen, plain) << "round " << round;
    changed += chosen != before ? 1 : 0;
  }
  EXPECT_GT(changed, 200);
}

}  // namespace
}  // namespace wobble::protocol
