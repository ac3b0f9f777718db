// Blueprints that arrive in chunks, their generations, and bodies that change from one blueprint to another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "protocol/codec/basis.h"
#include "tests/support/basis_source.h"
#include "tests/unit/client/scripted_server.h"

namespace wobble::client {
namespace {

// The tetrahedron without two of its faces, and a body of springs alone.
Message MakeTornTetrahedron() {
  const std::vector<Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 3, 1}};
  return protocol::MakeBlueprint({.name = "torn", .rest = rest, .faces = faces, .size = 1.732F});
}
const std::vector<Vector3> kChainRest{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
Message MakeChain() {
  const std::vector<std::array<std::uint16_t, 2>> edges{{0, 1}, {1, 2}};
  return protocol::MakeBlueprint({.name = "chain", .rest = kChainRest, .size = 0.8F, .edges = edges});
}

TEST_F(ClientTest, KnowsWhichBlueprintsAreOpenAndWhichAreOfEdges) {
  Join();
  for (const Message& chunk : CutIntoChunks(1, MakeTornTetrahedron(), 64)) Arrive(Channel::kControl, chunk);
  for (const Message& chunk : CutIntoChunks(2, MakeChain(), 64)) Arrive(Channel::kControl, chunk);
  Snapshot(1, {MakeRecord(3, {}), MakeRecord(4, {}, 1), MakeRecord(5, {}, 2, 0, kChainRest)});
  std::vector<BodySample> samples;
  client->Sample(now, Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 3U) << "blueprints beyond the welcome's count may come at any time";
  EXPECT_FALSE(samples[0].blueprint->open);
  EXPECT_TRUE(samples[1].blueprint->open);
  EXPECT_TRUE(samples[0].blueprint->edges.empty());
  ASSERT_EQ(samples[2].blueprint->edges.size(), 2U);
  EXPECT_EQ(samples[2].blueprint->edges[1][1], 2);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
}

TEST_F(ClientTest, ARecordIsReadUnderItsOwnGenerationAlone) {
  Join();
  const auto chunks = CutIntoChunks(0, MakeChain(), 64, 1);
  Snapshot(1, {MakeRecord(3, {})});
  now += 1.0 / 30;
  // A record that overtakes its blueprint is dropped, not kept for later.
  Snapshot(2, {MakeRecord(3, {}, 0, 1, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  for (std::size_t i = 0; i + 1 < chunks.size(); ++i) Arrive(Channel::kControl, chunks[i]);
  Snapshot(3, {MakeRecord(8, {})});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U) << "the old one holds until the new one is whole";
  Arrive(Channel::kControl, chunks.back());
  Snapshot(4, {MakeRecord(9, {})});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 2U) << "late, of the generation before";
  Snapshot(5, {MakeRecord(10, {}, 0, 1, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 2U);
  EXPECT_EQ(client->ReadStatistics().badRecords, 0U);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
  Arrive(Channel::kControl, chunks[0]);
  EXPECT_EQ(client->ReadStatistics().badMessages, 1U) << "the generation that is here already";

  std::vector<BodySample> samples;
  client->Sample(now, Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[0].blueprint->name, "tetrahedron") << "bodies keep what they were made from";
  EXPECT_EQ(samples[2].blueprint->name, "chain");
  EXPECT_EQ(samples[2].vertices.size(), 3U);
}

// A body moves at 6 m/s and becomes a chain, or a torn tetrahedron, at 0.5 s; packets come in swapped pairs.
TEST_F(ClientTest, ABodyGoesOverToAnotherBlueprintWithoutAJump) {
  for (const bool isTorn : {false, true}) {
    SCOPED_TRACE(isTorn ? "the same rest shape" : "another number of vertices");
    link = {};
    now = 50;
    Join();
    const Message other = isTorn ? MakeTornTetrahedron() : MakeChain();
    for (const Message& chunk : CutIntoChunks(1, other, 64)) Arrive(Channel::kControl, chunk);
    std::uint32_t sequence = 0;
    std::vector<BodySample> samples;
    double changedAt = 0, before = 0;
    for (int frame = 0; frame < 60; ++frame) {
      const auto makePacket = [&](int i) {
        const double time = i / 30.0;
        const Pose pose{{static_cast<float>(6 * time), 0, 0}, {}};
        const protocol::SnapshotHead head{.sequence = ++sequence, .tick = 100 + static_cast<std::uint32_t>(2 * i)};
        if (i < 15) return MakeSnapshot(head, {MakeRecord(3, pose)});
        return MakeSnapshot(head, {isTorn ? MakeRecord(3, pose, 1) : MakeRecord(3, pose, 1, 0, kChainRest)});
      };
      if (frame % 2 == 1) {
        Arrive(Channel::kSnapshot, makePacket(frame));
        Arrive(Channel::kSnapshot, makePacket(frame - 1));
      }
      now += 1.0 / 30;
      client->Sample(now, Detail::kVertices, samples);
      if (samples.empty()) continue;
      ASSERT_EQ(samples.size(), 1U);
      ASSERT_EQ(samples[0].vertices.size(), samples[0].blueprint->rest.size());
      const double x = static_cast<double>(samples[0].pose.centroid.x);
      EXPECT_TRUE(frame <= 8 || std::fabs(x - before - 0.2) < 0.05) << "frame " << frame << ": " << x - before;
      before = x;
      if (changedAt == 0 && samples[0].blueprint->name != "tetrahedron") changedAt = x;
    }
    EXPECT_NEAR(changedAt, 6 * 0.5, 0.21) << "where it was when it changed, within a frame";
    EXPECT_EQ(client->ReadStatistics().badRecords, 0U);
  }
}

TEST_F(ClientTest, RefusesBlueprintChunksThatDoNotAddUp) {
  const Message blueprint = MakeTetrahedron();
  const auto total = static_cast<std::uint32_t>(blueprint.size());
  const auto hash = protocol::HashBytes(blueprint);
  const auto part = [&](std::uint32_t begin, std::uint32_t end) {
    return std::span(blueprint).subspan(begin, end - begin);
  };
  Start();
  Connect();
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash, total, 0, part(0, 40)));  // before the welcome
  EXPECT_EQ(client->ReadStatistics().badMessages, 1U);
  Welcome();
  Welcome();  // again
  EXPECT_EQ(client->ReadStatistics().badMessages, 2U);
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(255, hash, total, 0, part(0, 40)));  // no such number
  EXPECT_EQ(client->ReadStatistics().badMessages, 3U);

  const auto begin = [&] { Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash, total, 0, part(0, 40))); };
  const std::vector<Message> wrongSeconds{
      protocol::MakeBlueprintChunk(0, hash, total, 48, part(48, 80)),        // a gap
      protocol::MakeBlueprintChunk(0, hash, total - 8, 40, part(40, 80)),    // another total
      protocol::MakeBlueprintChunk(0, hash ^ 1, total, 40, part(40, 80)),    // another hash
      protocol::MakeBlueprintChunk(0, hash, total, 40, part(0, total - 40))  // whole, but with another hash
  };
  for (const Message& wrong : wrongSeconds) {
    const auto before = client->ReadStatistics().badMessages;
    begin();
    EXPECT_EQ(client->ReadStatistics().badMessages, before);
    Arrive(Channel::kControl, wrong);
    EXPECT_EQ(client->ReadStatistics().badMessages, before + 1);
    EXPECT_EQ(client->ReadState(), State::kJoining);
  }
  // A valid blueprint, but not the one that its hash names.
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash ^ 1, total, 0, blueprint));
  EXPECT_EQ(client->ReadState(), State::kJoining);
  const Message nonsense(128, 0x41);  // the hash is right, the content is not
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, protocol::HashBytes(nonsense), 128, 0, nonsense));
  EXPECT_EQ(client->ReadState(), State::kJoining);
  const auto before = client->ReadStatistics().badMessages;

  for (const Message& chunk : CutIntoChunks(0, blueprint, 40)) Arrive(Channel::kControl, chunk);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(client->ReadStatistics().badMessages, before);
  begin();  // after it was complete
  EXPECT_EQ(client->ReadStatistics().badMessages, before + 1);
}

TEST_F(ClientTest, PlaysOnceItHasItsOwnBlueprintAndTakesTheOthersLater) {
  Start();
  Connect();
  protocol::WelcomeFields welcome;
  welcome.ownBody = 3;
  welcome.tick = 100;
  welcome.tickHz = kTickHz;
  welcome.snapshotHz = 30;
  welcome.blueprintCount = 2;
  welcome.ownBlueprint = 1;
  Arrive(Channel::kControl, protocol::MakeWelcome(welcome));
  for (const Message& chunk : CutIntoChunks(1, MakeTetrahedron(), 64)) {
    EXPECT_EQ(client->ReadState(), State::kJoining);
    Arrive(Channel::kControl, chunk);
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  Snapshot(1, {MakeRecord(3, {}, 1), MakeRecord(4, {}, 0, 0, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  for (const Message& chunk : CutIntoChunks(0, MakeChain(), 64)) Arrive(Channel::kControl, chunk);
  Snapshot(2, {MakeRecord(3, {}, 1), MakeRecord(4, {}, 0, 0, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
}

TEST_F(ClientTest, AChunkWithOffset0BeginsTheBlueprintAnew) {
  Start();
  Connect();
  Welcome();
  const auto first = CutIntoChunks(0, MakeTetrahedron(), 64);
  Arrive(Channel::kControl, first[0]);
  Arrive(Channel::kControl, first[1]);
  for (const Message& chunk : CutIntoChunks(0, MakeChain(), 64, 1)) Arrive(Channel::kControl, chunk);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
  Snapshot(1, {MakeRecord(3, {}, 0, 1, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 0U);
}

// What one connection downloads, the next need not.
TEST_F(ClientTest, KeepsLargeBlueprintsForLaterConnections) {
  const auto kept = std::make_shared<KeptBlueprints>();
  Options options;
  options.keep = [&](std::uint64_t hash, std::span<const std::uint8_t> bytes) {
    kept->push_back({hash, {bytes.begin(), bytes.end()}});
  };
  Start(options);
  Connect();
  Welcome(2);
  const Message strip = MakeStrip(), small = MakeTetrahedron();
  std::size_t bytes = 0;
  for (const Message& chunk : CutIntoChunks(0, strip, 1000)) Arrive(Channel::kControl, chunk);
  for (const Message& chunk : CutIntoChunks(1, small, 64)) Arrive(Channel::kControl, chunk);
  ASSERT_EQ(kept->size(), 1U) << "the small one is not worth a file";
  EXPECT_EQ((*kept)[0].bytes, strip);
  now += 0.1;
  client->Update(now);
  bytes = strip.size() + small.size();
  EXPECT_EQ(Inputs().back()->downloaded(), bytes);

  link.sent.clear();
  kept->push_back({7, Message(100, 1)});  // spoilt
  const std::size_t before = kept->size();
  options.kept = kept;
  now += 1;
  Start(options);
  Connect();
  const wire::ClientMessage* message = nullptr;
  ASSERT_EQ(protocol::ParseClientMessage(link.sent.at(0).bytes, message), protocol::ParseResult::kOk);
  ASSERT_EQ(message->body_as_Hello()->kept()->size(), 2U);
  EXPECT_EQ(message->body_as_Hello()->kept()->Get(0), protocol::HashBytes(strip));
  Welcome(2);
  const auto tellKept = [&](std::uint64_t hash, std::size_t total) {
    const auto size = static_cast<std::uint32_t>(total);
    Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash, size, size, {}));
  };
  tellKept(7, 100);
  tellKept(8, strip.size());  // not listed
  EXPECT_EQ(client->ReadState(), State::kJoining);
  EXPECT_EQ(client->ReadStatistics().badMessages, 2U);
  tellKept(protocol::HashBytes(strip), strip.size());
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  now += 0.1;
  client->Update(now);
  EXPECT_EQ(Inputs().back()->downloaded(), 3 * protocol::kKeptPieceBytes);
  EXPECT_EQ(kept->size(), before) << "not kept again";
}

// A ball's basis takes a tenth of a second: frames go on meanwhile.
TEST_F(ClientTest, CompletesBasesOverSeveralUpdates) {
  std::vector<Vector3> rest;
  for (int i = 0; i < 162; ++i)
    rest.push_back({static_cast<float>(i % 6), static_cast<float>(i / 6 % 6), static_cast<float>(i / 36)});
  const std::vector<std::vector<std::uint8_t>> bases{
      protocol::WriteBasis(test::MakeBasisSource(protocol::BasisSource::Kind::kFull, 162, 40, 8))};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}};
  const Message ball =
      protocol::MakeBlueprint({.name = "ball", .rest = rest, .faces = faces, .size = 5, .bases = bases});
  Options options;
  options.completionWork = 5'000'000;
  Start(options);
  Connect();
  Welcome();
  const auto chunks = CutIntoChunks(0, ball, 4096);
  for (const Message& chunk : chunks) Arrive(Channel::kControl, chunk);
  const auto last = static_cast<std::uint32_t>(ball.size() - (chunks.size() - 1) * 4096);
  int updates = 0;
  for (; client->ReadState() == State::kJoining && updates < 100; ++updates) {
    if (updates == 3) {  // the same once more: it is out of place
      Arrive(Channel::kControl, chunks[0]);
      EXPECT_EQ(client->ReadStatistics().badMessages, 1U);
    }
    now += 1.0 / 60;
    client->Update(now);
    if (client->ReadState() == State::kJoining) {
      EXPECT_EQ(Inputs().back()->downloaded(), ball.size() - last) << "it cannot be decoded yet";
    }
  }
  EXPECT_GT(updates, 3);
  EXPECT_LT(updates, 20);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  now += 1.0 / 60;
  client->Update(now);
  EXPECT_EQ(Inputs().back()->downloaded(), ball.size() + 4096) << "and the one out of place";
  EXPECT_EQ(client->ReadStatistics().badMessages, 1U);
}

// Its modes span nothing.
TEST_F(ClientTest, DropsABlueprintWhoseBasisIsBad) {
  std::vector<Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  protocol::BasisSource source = test::MakeBasisSource(protocol::BasisSource::Kind::kFull, 4, 2, 0);
  std::ranges::fill(source.modes, std::int8_t{0});
  const std::vector<std::vector<std::uint8_t>> bases{protocol::WriteBasis(source)};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}};
  Start();
  Connect();
  Welcome();
  const Message bad = protocol::MakeBlueprint({.name = "bad", .rest = rest, .faces = faces, .size = 2, .bases = bases});
  for (const Message& chunk : CutIntoChunks(0, bad, 4096)) Arrive(Channel::kControl, chunk);
  EXPECT_EQ(client->ReadState(), State::kJoining);
  EXPECT_EQ(client->ReadStatistics().badMessages, 1U);
  for (const Message& chunk : CutIntoChunks(0, MakeTetrahedron(), 4096)) Arrive(Channel::kControl, chunk);
  EXPECT_EQ(client->ReadState(), State::kPlaying) << "it may come again";
}

// A hello names no more than the server takes.
TEST_F(ClientTest, ListsAsManyKeptBlueprintsAsAHelloHolds) {
  const auto kept = std::make_shared<KeptBlueprints>();
  for (std::uint64_t i = 0; i < 100; ++i) kept->push_back({i, Message(8, 1)});
  Options options;
  options.kept = kept;
  Start(options);
  Connect();
  const wire::ClientMessage* message = nullptr;
  ASSERT_EQ(protocol::ParseClientMessage(link.sent.at(0).bytes, message), protocol::ParseResult::kOk);
  EXPECT_EQ(message->body_as_Hello()->kept()->size(), protocol::kMaxKeptBlueprints);
}

}  // namespace
}  // namespace wobble::client
