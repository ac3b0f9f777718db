// Snapshots: which ones the client takes, where it shows bodies, and how close to their true places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "client/newest_poses.h"
#include "tests/unit/client/scripted_server.h"

namespace wobble::client {
namespace {

TEST_F(ClientTest, ShowsBodiesWhereTheyWereADelayAgo) {
  Join();
  std::vector<BodySample> samples;
  client->Sample(now, Detail::kVertices, samples);
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(client->ServerTime(now), 0);

  // Body 3 moves along x at 3 m/s, body 8 does not move.
  const auto placeAt = [](double time) { return static_cast<float>(3 * (time - 100.0 / kTickHz)); };
  for (std::uint32_t i = 1; i <= 60; ++i) {
    now = joinedAt + i / 30.0;
    Snapshot(i, {MakeRecord(8, {{0, 5, 0}, {}}), MakeRecord(3, {{placeAt(CurrentTick() / 60.0), 0, 1}, {}})});
  }
  EXPECT_NEAR(client->ServerTime(now), CurrentTick() / 60.0, 1e-3);
  EXPECT_NEAR(client->InterpolationDelay(), 2.0 / 30, 0.005);
  client->Sample(now, Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].body, 3U);
  EXPECT_EQ(samples[1].body, 8U);
  EXPECT_EQ(samples[0].blueprint, samples[1].blueprint);
  EXPECT_EQ(samples[0].blueprint->name, "tetrahedron");
  EXPECT_EQ(samples[0].blueprint->faces.size(), 4U);
  const double shown = client->ServerTime(now) - client->InterpolationDelay();
  EXPECT_NEAR(samples[0].pose.centroid.x, placeAt(shown), 0.002);
  ASSERT_EQ(samples[0].vertices.size(), 4U);
  EXPECT_NEAR(samples[0].vertices[1].y, -1, 0.005);
  EXPECT_NEAR(samples[0].vertices[1].x, placeAt(shown) + 1, 0.005);
  EXPECT_FALSE(samples[0].held);
  EXPECT_NEAR(client->NewestPose(3)->centroid.x, placeAt(CurrentTick() / 60.0), 0.002);
  EXPECT_FALSE(client->NewestPose(4).has_value());

  client->Sample(now, Detail::kPosesOnly, samples);
  EXPECT_TRUE(samples.at(0).vertices.empty());
  EXPECT_EQ(client->ReadStatistics().stalls, 0U);
  client->Update(now += 1);
  client->Sample(now, Detail::kPosesOnly, samples);
  EXPECT_TRUE(samples.at(0).held);
  EXPECT_EQ(client->ReadStatistics().stalls, 2U);

  Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::BodyRemoved, CurrentTick(), 0, 8, ""));
  client->Sample(now, Detail::kPosesOnly, samples);
  EXPECT_EQ(samples.size(), 1U);
}

TEST_F(ClientTest, MeasuresFromInputToSnapshotAndAge) {
  Join();
  std::vector<SnapshotArrival> arrivals;
  client->OnSnapshot([&](const SnapshotArrival& arrival) { arrivals.push_back(arrival); });
  link.sent.clear();
  client->Update(now += 0.1);
  const std::uint32_t frame = Inputs().at(0)->frames()->Get(0)->tick();
  const std::uint32_t tick = CurrentTick();
  now += 0.080;
  Arrive(Channel::kSnapshot, MakeSnapshot({.sequence = 1, .tick = tick, .inputTick = frame}));
  Arrive(Channel::kSnapshot, MakeSnapshot({.sequence = 2, .tick = tick, .inputTick = frame}));
  Arrive(Channel::kSnapshot, MakeSnapshot({.sequence = 3, .tick = tick, .inputTick = 4000000000U}));  // was never sent
  ASSERT_EQ(arrivals.size(), 3U);
  EXPECT_EQ(arrivals[0].tick, tick);
  EXPECT_NEAR(arrivals[0].inputToSnapshot, 0.080, 1e-9);
  EXPECT_EQ(arrivals[1].inputToSnapshot, -1);
  EXPECT_EQ(arrivals[2].inputToSnapshot, -1);
  EXPECT_NEAR(client->ReadStatistics().inputToSnapshot, 0.080, 1e-9);
  // This packet came 80 ms later than the welcome, which had no delay; the trip counts half of 80 ms less a tick.
  EXPECT_NEAR(arrivals[0].age, 0.080 + (0.080 - 0.5 / kTickHz) / 2, 1e-6);
}

TEST_F(ClientTest, IgnoresDuplicateAndAncientPackets) {
  Join();
  now += 0.1;
  const auto record = MakeRecord(3, {{1, 0, 0}, {}});
  Snapshot(200, {record});
  Snapshot(200, {MakeRecord(3, {{2, 0, 0}, {}}), record});
  Snapshot(100, {record});
  EXPECT_EQ(client->ReadStatistics().snapshots, 1U);
  EXPECT_EQ(client->ReadStatistics().duplicates, 2U);
  EXPECT_EQ(client->ReadStatistics().records, 1U);
  EXPECT_NEAR(client->NewestPose(3)->centroid.x, 1, 1e-3);
}

TEST_F(ClientTest, WithoutDecodingKnowsWhereBodiesAreAndNoMore) {
  Join({.name = "bot", .decode = false});
  now += 0.1;
  Snapshot(1, {MakeRecord(3, {{1.5F, 0, 0}, {}}), MakeRecord(8, {{2, 0, 0}, {}})});
  EXPECT_EQ(client->ReadStatistics().records, 2U);
  EXPECT_NEAR(client->NewestPose(3)->centroid.x, 1.5, 1e-3);
  EXPECT_NEAR(client->NewestPose(8)->centroid.x, 2, 1e-3);
  EXPECT_FALSE(client->NewestPose(9).has_value());
  std::vector<BodySample> samples(3);
  client->Sample(now, Detail::kVertices, samples);
  EXPECT_TRUE(samples.empty());
}

TEST_F(ClientTest, KnowsHowFastBodiesGoWithAndWithoutDecoding) {
  for (const bool decode : {true, false}) {
    SCOPED_TRACE(decode);
    Join({.name = "bot", .decode = decode});
    const auto hear = [&](std::uint32_t sequence, double after, float x) {
      now += after;
      Snapshot(sequence, {MakeRecord(8, {{x, 5, 0}, {}})});
      return client->FindSighting(8);
    };
    EXPECT_FALSE(client->FindSighting(8).has_value());
    EXPECT_FALSE(hear(1, 0.1, 1)->velocity.has_value());  // a single pose gives no velocity
    const auto second = hear(2, 0.05, 1.25F);
    EXPECT_NEAR(second->pose.centroid.x, 1.25F, 1e-3);
    EXPECT_NEAR(second->velocity.value().x, 5, 0.02);
    EXPECT_NEAR(second->velocity.value().y, 0, 0.02);
    EXPECT_EQ(second->age, 0);

    Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::Respawn, CurrentTick() + 1, 0, 8, ""));
    EXPECT_FALSE(hear(3, 0.05, -4)->velocity.has_value());  // it respawned in between
    EXPECT_NEAR(hear(4, 0.05, -3)->velocity.value().x, 20, 0.1);
    EXPECT_FALSE(hear(5, kMaxVelocitySpan + 0.1, -2)->velocity.has_value());  // too long ago

    now += 0.2;
    Snapshot(6, {MakeRecord(9, {})});
    std::vector<Sighting> sightings;
    client->ListSightings(sightings);
    ASSERT_EQ(sightings.size(), 2U);
    EXPECT_NEAR(client->FindSighting(8)->age, 0.2, 1e-6);

    Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::BodyRemoved, CurrentTick(), 0, 8, ""));
    Arrive(Channel::kSnapshot, MakeSnapshot({.sequence = 7, .tick = CurrentTick() - 6}, {MakeRecord(8, {})}));  // late
    EXPECT_FALSE(client->FindSighting(8).has_value());
    client->ListSightings(sightings);
    ASSERT_EQ(sightings.size(), 1U);
    EXPECT_EQ(sightings[0].body, 9U);
  }
}

TEST_F(ClientTest, CountsRecordsThatItCannotUse) {
  Join();
  now += 0.1;
  Snapshot(1, {MakeRecord(3, {{1, 0, 0}, {}}, 7)});  // an unknown generation
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  std::vector<std::uint8_t> noise(40, 0xFF), broken, beyond;
  protocol::AppendRecord({.body = 4}, noise, broken);
  protocol::AppendRecord({.body = 5, .patch = 1}, noise, beyond);  // a patch the blueprint does not have
  Snapshot(2, {broken, beyond, MakeRecord(6, {{1, 0, 0}, {}})});
  EXPECT_EQ(client->ReadStatistics().badRecords, 2U);
  EXPECT_TRUE(client->NewestPose(6).has_value());
  EXPECT_FALSE(client->NewestPose(4).has_value());
}

TEST_F(ClientTest, TakesASnapshotThatOvertookTheWelcome) {
  Start();
  Connect();
  Arrive(Channel::kSnapshot, MakeSnapshot({.sequence = 1, .tick = 100}, {MakeRecord(3, {})}));
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  EXPECT_EQ(client->ReadStatistics().snapshots, 1U);
  EXPECT_EQ(client->ServerTime(now), 0);
}

// Flips every bit of an honest snapshot and cuts it at every length. The head's first six bytes (kind, version,
// sequence) come last: a packet with a sequence far ahead makes all later ones too old.
TEST_F(ClientTest, SurvivesDamagedSnapshots) {
  Join();
  const auto first = MakeRecord(3, {{1, 2, 3}, {}}), second = MakeRecord(8, {});
  std::uint32_t sequence = 0;
  const auto makeWhole = [&] { return MakeSnapshot({.sequence = ++sequence, .tick = 130}, {first, second}); };
  const std::size_t size = makeWhole().size();
  for (std::size_t length = 0; length < size; ++length) {
    const Message whole = makeWhole();
    Arrive(Channel::kSnapshot, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
  }
  // All but two are broken: the head alone, and the head with the first record.
  EXPECT_EQ(client->ReadStatistics().badSnapshots, size - 2);

  std::vector<BodySample> samples;
  for (std::size_t i = 0; i < size * 8; ++i) {
    Message damaged = makeWhole();
    const std::size_t bit = (i + 6 * 8) % (size * 8);
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    Arrive(Channel::kSnapshot, std::move(damaged));
    client->Sample(now += 0.001, Detail::kVertices, samples);
    for (const BodySample& sample : samples) {
      ASSERT_TRUE(std::isfinite(sample.pose.centroid.x) && std::isfinite(sample.pose.rotation.w));
    }
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_GT(client->ReadStatistics().badRecords, 20U);
  EXPECT_GT(client->ReadStatistics().snapshots, 100U);
}

struct LinkCase {
  const char* name;
  double loss;       // share
  double jitter;     // seconds, uniform
  double reordered;  // share held back by another 40 ms
  double maxError;   // metres RMS, of a body that circles at 6 m/s and bounces
  double maxDelay;   // seconds
  double maxHeld;    // share of frames
};

class ClientOverLink : public ClientTest, public testing::WithParamInterface<LinkCase> {};

Pose PoseAt(double t) {
  const double angle = 4 * t;
  return {{static_cast<float>(3 * std::cos(2 * t)), static_cast<float>(3 * std::sin(2 * t)),
           static_cast<float>(std::fabs(std::sin(3 * t)))},
          {static_cast<float>(std::cos(angle / 2)), 0, 0, static_cast<float>(std::sin(angle / 2))}};
}

// The shown pose stays close to the true pose at the shown moment.
TEST_P(ClientOverLink, FollowsABody) {
  const LinkCase& conditions = GetParam();
  Join();
  std::mt19937 random(20);
  std::uniform_real_distribution<double> chance(0, 1);
  std::vector<Link::Arrival> arrivals;
  for (std::uint32_t i = 1; i <= 30 * 60; ++i) {
    if (chance(random) < conditions.loss) continue;
    const double delay =
        0.05 + conditions.jitter * chance(random) + (chance(random) < conditions.reordered ? 0.04 : 0.0);
    const std::uint32_t tick = 100 + 2 * i;
    arrivals.push_back({joinedAt + i / 30.0 + delay, transport::Event::Kind::kMessage, Channel::kSnapshot,
                        MakeSnapshot({.sequence = i, .tick = tick}, {MakeRecord(3, PoseAt(tick / 60.0))})});
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Link::Arrival& a, const Link::Arrival& b) { return a.at < b.at; });
  link.arrivals.assign(arrivals.begin(), arrivals.end());

  std::vector<BodySample> samples;
  double sum = 0, lastShown = 0;
  int frames = 0;
  for (; now < joinedAt + 60; now += 1.0 / kTickHz) {
    client->Update(now);
    client->Sample(now, Detail::kPosesOnly, samples);
    if (now < joinedAt + 3) continue;
    ASSERT_EQ(samples.size(), 1U);
    const double shown = client->ServerTime(now) - client->InterpolationDelay();
    ASSERT_GT(shown, lastShown);
    lastShown = shown;
    const float error = protocol::Length(samples[0].pose.centroid - PoseAt(shown).centroid);
    sum += static_cast<double>(error * error);
    ++frames;
  }
  const double rms = std::sqrt(sum / frames);
  const auto held = static_cast<double>(client->ReadStatistics().framesHeld) / frames;
  std::printf("%s: %.1f mm RMS off, delay %.0f ms, %.2f %% of frames held\n", conditions.name, 1000 * rms,
              1000 * client->InterpolationDelay(), 100 * held);
  EXPECT_LT(rms, conditions.maxError);
  EXPECT_LT(client->InterpolationDelay(), conditions.maxDelay);
  EXPECT_LE(held, conditions.maxHeld);
}

INSTANTIATE_TEST_SUITE_P(Links, ClientOverLink,
                         testing::Values(LinkCase{.name = "Clean",
                                                  .loss = 0,
                                                  .jitter = 0,
                                                  .reordered = 0,
                                                  .maxError = 0.006,
                                                  .maxDelay = 0.075,
                                                  .maxHeld = 0},
                                         LinkCase{.name = "Loss5Jitter20",
                                                  .loss = 0.05,
                                                  .jitter = 0.020,
                                                  .reordered = 0,
                                                  .maxError = 0.010,
                                                  .maxDelay = 0.110,
                                                  .maxHeld = 0},
                                         LinkCase{.name = "Loss5Jitter20Reordered4",
                                                  .loss = 0.05,
                                                  .jitter = 0.020,
                                                  .reordered = 0.04,
                                                  .maxError = 0.010,
                                                  .maxDelay = 0.150,
                                                  .maxHeld = 0},
                                         LinkCase{.name = "Loss20Jitter100Reordered4",
                                                  .loss = 0.20,
                                                  .jitter = 0.100,
                                                  .reordered = 0.04,
                                                  .maxError = 0.012,
                                                  .maxDelay = 0.250,
                                                  .maxHeld = 0.02}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace wobble::client
