// Encoding of captured bodies: within the error target, one record per patch, and records that stay valid.
#include "server/snapshots/encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "protocol/codec/shape_codec.h"
#include "protocol/snapshot.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/world.h"
#include "tests/support/captures.h"
#include "tests/support/pace.h"
#include "tests/unit/protocol/shape_clouds.h"

namespace wobble::server {
namespace {

// Reads a record the way a client does, from a packet.
struct Read {
  protocol::RecordHead head;
  std::vector<std::uint8_t> payload;
};
Read ReadRecord(std::span<const std::uint8_t> record) {
  protocol::PacketBuilder builder;
  EXPECT_TRUE(builder.Add(record));
  protocol::SnapshotHead head;
  head.sequence = head.tick = 1;
  std::vector<protocol::Record> records;
  EXPECT_EQ(protocol::ReadSnapshot(builder.Finish(head), head, records), protocol::SnapshotResult::kOk);
  EXPECT_EQ(records.size(), 1U);
  return {records.at(0).head, {records[0].payload.begin(), records[0].payload.end()}};
}

std::vector<ShownBody> Show(const std::vector<CapturedBody>& bodies) {
  std::vector<ShownBody> shown;
  for (const CapturedBody& body : bodies) shown.push_back({body.body, {}});
  return shown;
}

class EncoderTest : public testing::Test {
 protected:
  // Balls of 162 and of 642 vertices, dropped and bounced for a second.
  EncoderTest() : world(physics::WorldSettings{}) {
    world.AddObstacle({});
    for (const int subdivisions : {2, 3}) {
      physics::BallDefinition definition;
      definition.subdivisions = subdivisions;
      definition.material.gas = 330;
      world.AddBlueprint(physics::MakeBall(definition));
      blueprints.push_back(CaptureBlueprint(world.Blueprints().back()));
    }
    world.AddBody(0, {0, 0, 1}, {3, 0, -6});
    world.AddBody(1, {4, 0, 1}, {0, 2, -6});
    world.AddBody(0, {-4, 0, 3});
    Play(30);
  }
  void Play(int ticks) {
    for (int i = 0; i < ticks; ++i) world.Step();
    test::CaptureAll(world, bodies);
  }

  // The records of every body.
  std::vector<Records> EncodeAll(Encoder& with, std::size_t quality = 0) {
    with.Follow(Show(bodies), world.Tick());
    std::vector<Records> all;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const EncodedBody& body = with.Encode(i, quality, bodies[i], blueprints[bodies[i].blueprint]);
      all.push_back(body.records);
      vertices += body.vertices;
      errorSquares += body.errorSquares;
    }
    return all;
  }
  std::vector<Records> EncodeAll() { return EncodeAll(encoder); }

  physics::World world;
  std::vector<CapturedBlueprint> blueprints;
  std::vector<CapturedBody> bodies;
  Encoder encoder;
  // Totals over all encoded bodies:
  std::uint64_t vertices = 0;
  double errorSquares = 0;
};

TEST_F(EncoderTest, OneRecordAPatch) {
  const auto encoded = EncodeAll();
  EXPECT_EQ(encoded[0].size(), 1U);
  ASSERT_EQ(encoded[1].size(), 2U);  // 642 = 512 + 130
  EXPECT_EQ(encoded[2].size(), 1U);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t patch = 0; patch < encoded[i].size(); ++patch) {
      const Read read = ReadRecord(encoded[i][patch]);
      EXPECT_EQ(read.head.body, bodies[i].body);
      EXPECT_EQ(read.head.blueprint, bodies[i].blueprint);
      EXPECT_EQ(read.head.patch, patch);
    }
  }
}

TEST_F(EncoderTest, DecodedVerticesAreWithinTheTarget) {
  double squares = 0;
  std::size_t decoded = 0;
  protocol::ShapeDecoder decoder;
  std::uint64_t missed = 0;
  for (int snapshot = 0; snapshot < test::Shorten(60); ++snapshot) {
    Play(2);
    const auto encoded = EncodeAll();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const CapturedBlueprint& blueprint = blueprints[bodies[i].blueprint];
      std::size_t first = 0;
      for (const auto& record : encoded[i]) {
        const Read read = ReadRecord(record);
        const std::size_t count = protocol::PatchSize(blueprint.rest.size(), read.head.patch);
        protocol::QuantisedPose pose;
        std::vector<protocol::Vector3> shape(count);
        const protocol::PatchModel model{.rest = std::span(blueprint.rest).subspan(first, count),
                                         .size = blueprint.size};
        ASSERT_EQ(decoder.Decode(model, read.payload, pose, shape), protocol::DecodeResult::kOk);
        double sum = 0;
        for (std::size_t v = 0; v < count; ++v) {
          const auto error = protocol::Transform(protocol::Dequantise(pose), shape[v]) - bodies[i].vertices[first + v];
          sum += double{protocol::Dot(error, error)};
        }
        // Single precision rounds a vertex to 1e-6 m here. 512 vertices in a violent impact may not fit a packet at the
        // target; they are then coarser, and that is counted.
        const double target = double{kSnapshotErrorShares[0] * blueprint.size};
        const double error = std::sqrt(sum / static_cast<double>(count));
        missed += error > target + 2e-6 ? 1 : 0;
        EXPECT_LE(error, count == protocol::kMaxPatchVertices ? 6 * target : target + 2e-6);
        squares += sum / std::pow(double{blueprint.size}, 2);
        decoded += count;
        first += count;
      }
      EXPECT_EQ(first, blueprint.rest.size());
    }
  }
  EXPECT_EQ(encoder.CoarsenedRecords(), missed);
  EXPECT_LT(missed, 30U);  // of 60 records of the large patch
  // The reported error equals the one that a client measures.
  EXPECT_EQ(vertices, decoded);
  EXPECT_NEAR(std::sqrt(errorSquares), std::sqrt(squares), 0.005 * std::sqrt(squares));
}

TEST_F(EncoderTest, EachCaptureIsEncodedOnce) {
  const auto before = EncodeAll();
  for (const Records records : before) {
    const std::uint8_t* next = records[0].data();
    for (const auto& record : records) {
      ASSERT_FALSE(record.empty());
      EXPECT_EQ(record.data(), next) << "one block, in order";
      next = record.data() + record.size();
    }
  }
  std::vector<std::vector<std::uint8_t>> bytes;
  for (const Records records : before) bytes.emplace_back(records[0].begin(), records[0].end());
  const auto isStill = [&](const std::vector<Records>& now, std::size_t i) {
    return now[i][0].data() == before[i][0].data() && std::equal(bytes[i].begin(), bytes[i].end(), now[i][0].begin());
  };
  // Also for bodies that have moved since, until they are captured again.
  for (CapturedBody& body : bodies) body.vertices[0].x += 0.1F;
  const auto again = EncodeAll();  // for another client
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(isStill(again, i));

  world.Step();
  CaptureBody(world, world.Bodies()[2], bodies[2]);
  const auto after = EncodeAll();
  EXPECT_TRUE(isStill(after, 0));
  EXPECT_FALSE(bytes[2].size() == after[2][0].size() &&
               std::equal(bytes[2].begin(), bytes[2].end(), after[2][0].begin()));
}

TEST_F(EncoderTest, EachQualityKeepsToItsOwnTarget) {
  bodies.erase(bodies.begin() + 1);  // the large one may not fit a packet
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (std::size_t quality = 0; quality < kQualities; ++quality) {
    vertices = 0;
    errorSquares = 0;
    std::size_t bytes = 0;
    for (const Records records : EncodeAll(encoder, quality)) bytes += records[0].size();
    const double error = std::sqrt(errorSquares / static_cast<double>(vertices));
    EXPECT_LE(error, 1.001 * double{kSnapshotErrorShares[quality]});
    EXPECT_GT(error, 0.5 * double{kSnapshotErrorShares[quality]});
    EXPECT_LT(bytes, last);
    last = bytes;
  }
}

// In a crowd bodies take turns: those read last time are not those read next.
TEST_F(EncoderTest, IsExpectedWhatHasBeenReadAtEvenIntervals) {
  const auto isExpected = [&](std::uint32_t tick) {
    encoder.Follow(Show(bodies), tick);
    return encoder.IsExpected(0);
  };
  const auto read = [&](std::uint32_t tick) {
    encoder.Follow(Show(bodies), tick);
    static_cast<void>(encoder.Encode(0, 1, bodies[0], blueprints[0]));
  };
  read(10);
  EXPECT_FALSE(isExpected(12)) << "read once";
  read(15);
  read(15);  // by another client
  EXPECT_FALSE(isExpected(17));
  EXPECT_TRUE(isExpected(20));
  read(20);
  EXPECT_TRUE(isExpected(25));
  EXPECT_FALSE(isExpected(30)) << "missed its turn";
}

TEST_F(EncoderTest, WhatIsEncodedAheadIsTheSame) {
  Encoder ahead({}, 2);
  std::uint32_t tick = 10;
  for (; tick < 14; tick += 2) {
    ahead.Follow(Show(bodies), tick);
    for (const std::size_t i : {0, 2}) {
      static_cast<void>(ahead.Encode(i, i == 0 ? 0 : 2, bodies[i], blueprints[bodies[i].blueprint]));
    }
  }
  Play(2);
  ahead.Follow(Show(bodies), tick);
  std::vector<FreshCapture> fresh;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_EQ(ahead.IsExpected(i), i != 1);
    fresh.push_back({i, &bodies[i], &blueprints[bodies[i].blueprint]});
  }
  ahead.EncodeAhead(fresh);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t quality = 0; quality < kQualities; ++quality) {
      const EncodedBody* found = ahead.Find(i, quality, bodies[i].version);
      const bool isAsked = (i == 0 && quality == 0) || (i == 2 && quality == 2);
      ASSERT_EQ(found != nullptr, isAsked) << i << " at " << quality;
      if (found == nullptr) continue;
      const std::vector<std::uint8_t> bytes(found->records[0].begin(), found->records[0].end());
      const Records alone = EncodeAll(encoder, quality)[i];
      EXPECT_EQ(bytes, std::vector<std::uint8_t>(alone[0].begin(), alone[0].end()));
    }
  }
}

// Forty balls of one blueprint with a basis, and one of another, at all qualities on two threads.
TEST_F(EncoderTest, ACrowdEncodedAheadIsTheSame) {
  blueprints[0].patches[0].basis =
      protocol::clouds::MakeBasis(protocol::BasisSource::Kind::kFull, blueprints[0].rest.size(), 0.05F);
  const CapturedBody ball = bodies[0];
  bodies.erase(bodies.begin() + 2);
  for (std::uint32_t i = 0; i < 40; ++i) {
    CapturedBody copy = ball;
    copy.body = 1000 + i;
    for (std::size_t k = 0; k < copy.vertices.size(); ++k) {
      copy.vertices[k].z += 0.004F * static_cast<float>(i) * std::sin(static_cast<float>(k));
    }
    bodies.push_back(copy);
  }
  Encoder ahead({}, 2);
  std::uint32_t tick = 10;
  for (; tick < 14; tick += 2) {
    ahead.Follow(Show(bodies), tick);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (std::size_t quality = 0; quality < kQualities; ++quality) {
        static_cast<void>(ahead.Encode(i, quality, bodies[i], blueprints[bodies[i].blueprint]));
      }
    }
  }
  std::vector<FreshCapture> fresh;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].version += 100;
    bodies[i].vertices[5].x += 0.01F;
    fresh.push_back({i, &bodies[i], &blueprints[bodies[i].blueprint]});
  }
  ahead.Follow(Show(bodies), tick);
  ahead.EncodeAhead(fresh);
  for (std::size_t quality = 0; quality < kQualities; ++quality) {
    const std::vector<Records> alone = EncodeAll(encoder, quality);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const EncodedBody* found = ahead.Find(i, quality, bodies[i].version);
      ASSERT_NE(found, nullptr) << i << " at " << quality;
      ASSERT_EQ(found->records.size(), alone[i].size());
      for (std::size_t j = 0; j < alone[i].size(); ++j) {
        EXPECT_TRUE(std::ranges::equal(found->records[j], alone[i][j])) << i << " at " << quality;
      }
    }
  }
}

TEST_F(EncoderTest, FollowsBodiesThatGo) {
  const auto before = EncodeAll();
  const std::vector<std::uint8_t> last(before[2][0].begin(), before[2][0].end());
  bodies.erase(bodies.begin());
  const auto after = EncodeAll();
  EXPECT_EQ(after[1][0].data(), before[2][0].data());
  EXPECT_EQ(std::vector<std::uint8_t>(after[1][0].begin(), after[1][0].end()), last);
}

TEST_F(EncoderTest, SameWorldSameBytes) {
  Encoder other;
  const auto one = EncodeAll();
  EncodeAll(other);
  for (CapturedBody& body : bodies) ++body.version;
  const auto two = EncodeAll(other);  // no state is kept from one snapshot to the next
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    ASSERT_EQ(two[i].size(), one[i].size());
    for (std::size_t j = 0; j < one[i].size(); ++j) {
      EXPECT_TRUE(std::equal(one[i][j].begin(), one[i][j].end(), two[i][j].begin(), two[i][j].end()));
    }
  }
}

TEST_F(EncoderTest, ABodyTornApartIsCoarsenedToFitAPacket) {
  CapturedBody& wreck = bodies[1];
  for (std::size_t v = 0; v < wreck.vertices.size(); ++v) {
    const float throwOut = v % 2 == 0 ? 1.0F : -0.6F;
    wreck.vertices[v].x += throwOut * static_cast<float>(v % 7);
    wreck.vertices[v].y -= throwOut * static_cast<float>(v % 5);
  }
  const auto encoded = EncodeAll();
  EXPECT_GE(encoder.CoarsenedRecords(), 1U);
  for (const Records records : encoded) {
    for (const auto& record : records) {
      EXPECT_LE(record.size() + protocol::kSnapshotHeadBytes, protocol::kMaxPacketBytes);
    }
  }
  EXPECT_EQ(encoded[0].size(), 1U);  // other bodies are unaffected
}

TEST_F(EncoderTest, ABodySpreadOverKilometresHarmsNobodyElse) {
  for (std::size_t v = 0; v < bodies[1].vertices.size(); ++v) {
    bodies[1].vertices[v].x += 1000.0F * static_cast<float>(v % 7) - 3000.0F;
  }
  for (protocol::Vector3& vertex : bodies[1].vertices) vertex.y = vertex.x;
  const auto encoded = EncodeAll();
  EXPECT_GE(encoder.CoarsenedRecords(), 1U);
  EXPECT_EQ(ReadRecord(encoded[0][0]).head.body, bodies[0].body);
  EXPECT_EQ(ReadRecord(encoded[2][0]).head.body, bodies[2].body);
}

}  // namespace
}  // namespace wobble::server
