// Tracks and bodies between, after and without samples.
#include "client/interpolator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "client/bodies.h"
#include "protocol/snapshot.h"

namespace wobble::client {
namespace {

using protocol::Pose;
using protocol::Quaternion;
using protocol::Vector3;

constexpr double kBetweenSnapshots = 1.0 / 30;

Quaternion TurnAboutZ(double angle) {
  return {static_cast<float>(std::cos(angle / 2)), 0, 0, static_cast<float>(std::sin(angle / 2))};
}

void InsertAt(Track& track, double time, const Pose& pose, const std::vector<Vector3>& shape = {{1, 0, 0}}) {
  EXPECT_TRUE(track.Insert(time, false, pose, shape, 0)) << "at " << time;
}

Vector3 VertexAt(const Track& track, double time) {
  const Moment moment = track.FindMoment(time);
  std::vector<Vector3> vertices;
  AppendVertices(moment, BlendPose(moment), vertices);
  return vertices.at(0);
}

const std::vector<double> kUnevenTimes{0.0, 0.033, 0.05, 0.15, 0.167, 0.2, 0.3};

TEST(ClientInterpolator, ReproducesUniformAccelerationOverUnevenTimes) {
  const auto height = [](double t) { return 3.0 + 2.0 * t - 4.9 * t * t; };
  Track track(1);
  for (const double t : kUnevenTimes)
    InsertAt(track, t, {{static_cast<float>(5 * t), 0, static_cast<float>(height(t))}, {}});
  for (double t = 0; t < 0.3; t += 0.001) {  // also the end segments, which use a parabola of three samples
    const Pose pose = BlendPose(track.FindMoment(t));
    EXPECT_NEAR(pose.centroid.x, 5 * t, 2e-6) << "at " << t;
    EXPECT_NEAR(pose.centroid.z, height(t), 2e-6) << "at " << t;
  }
}

TEST(ClientInterpolator, WhatRestsStaysWhereItIsUntilShortlyBeforeItIsSeenToMove) {
  const auto at = [](double x) { return Pose{{static_cast<float>(x), 0, 0}, {}}; };
  Track track(1);
  InsertAt(track, 0, at(0));
  InsertAt(track, kBetweenSnapshots, at(1));
  EXPECT_TRUE(track.Insert(2 * kBetweenSnapshots, true, at(2), std::vector<Vector3>{{1, 0, 0}}, 0));
  const auto show = [&](double time) { return BlendPose(track.FindMoment(time)).centroid.x; };
  // A body at rest is never extrapolated, nor held without a record.
  for (const double later : {0.001, 0.05, 0.2, 60.0}) {
    EXPECT_EQ(show(2 * kBetweenSnapshots + later), 2) << later;
    EXPECT_FALSE(track.FindMoment(2 * kBetweenSnapshots + later).held) << later;
  }
  InsertAt(track, 10, at(3));
  EXPECT_EQ(show(5), 2);
  EXPECT_EQ(show(10 - kWakeSpan), 2);
  EXPECT_NEAR(show(10 - kWakeSpan / 2), 2.5, 1e-6);
  EXPECT_EQ(show(10), 3);
  // The samples are two metres apart: it moves within the last interval, not over the ten seconds before.
  EXPECT_NEAR(show(10 + kWakeSpan / 2), 3.5, 1e-6);
  InsertAt(track, 10 + kBetweenSnapshots, at(4));
  EXPECT_NEAR(show(10 + kBetweenSnapshots / 2), 3.5, 1e-6);
}

TEST(ClientInterpolator, ABodyThatRestsIsNotForgotten) {
  const auto blueprint = std::make_shared<Blueprint>();
  blueprint->rest.assign(4, {1, 0, 0});
  blueprint->size = 1;
  const std::vector<Vector3> shape(4, Vector3{1, 0, 0});
  Bodies bodies;
  EXPECT_TRUE(bodies.Add({.body = 1}, blueprint, 100, 1.0, {}, shape, 0));
  EXPECT_TRUE(bodies.Add({.body = 2, .restTick = 90}, blueprint, 100, 0.9, {}, shape, 0));
  Statistics statistics;
  std::vector<BodySample> samples;
  bodies.Sample(50, 50, Detail::kVertices, samples, statistics);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_TRUE(samples[0].held);
  EXPECT_FALSE(samples[1].held);
  EXPECT_GT(samples[0].age, 40);
  EXPECT_EQ(samples[1].age, 0);
  bodies.Forget(40);
  EXPECT_EQ(bodies.Count(), 1U);
  // It moves again, and then no record comes.
  EXPECT_TRUE(bodies.Add({.body = 2}, blueprint, 6000, 60.0, {}, shape, 50));
  // A late record of its rest changes nothing.
  EXPECT_TRUE(bodies.Add({.body = 2, .restTick = 90}, blueprint, 110, 0.9, {}, shape, 50));
  bodies.Forget(61);
  EXPECT_EQ(bodies.Count(), 0U);
}

TEST(ClientInterpolator, StraightLinesKeepToTheTwoSamplesBesideThem) {
  Track track(1, Curve::kLinear);
  for (const double t : kUnevenTimes) InsertAt(track, t, {{static_cast<float>(t * t), 0, 0}, {}});
  for (std::size_t i = 0; i + 1 < kUnevenTimes.size(); ++i) {
    const double from = kUnevenTimes[i], to = kUnevenTimes[i + 1];
    const Moment moment = track.FindMoment((from + to) / 2);
    EXPECT_EQ(moment.count, 2U);
    EXPECT_NEAR(BlendPose(moment).centroid.x, (from * from + to * to) / 2, 1e-7) << "between " << from << " and " << to;
  }
}

TEST(ClientInterpolator, ShapesFollowTheSameCurve) {
  const auto bulge = [](double t) { return 1 + 0.5 * t - 3 * t * t; };
  Track track(1);
  for (const double t : kUnevenTimes) InsertAt(track, t, {}, {{static_cast<float>(bulge(t)), 0, 0}});
  for (double t = 0; t < 0.3; t += 0.001) EXPECT_NEAR(VertexAt(track, t).x, bulge(t), 2e-6) << "at " << t;
}

TEST(ClientInterpolator, PassesThroughItsSamplesWithoutAKink) {
  Track track(1);
  for (int i = 0; i < 10; ++i) {
    InsertAt(track, i * kBetweenSnapshots, {{static_cast<float>(std::sin(i * 1.3)), 0, 0}, {}});
  }
  const auto at = [&](double t) { return static_cast<double>(BlendPose(track.FindMoment(t)).centroid.x); };
  for (int i = 2; i < 8; ++i) {
    const double t = i * kBetweenSnapshots, h = 1e-3;
    EXPECT_NEAR(at(t), std::sin(i * 1.3), 1e-5);
    EXPECT_NEAR((at(t) - at(t - h)) / h, (at(t + h) - at(t)) / h, 6.0) << "sample " << i;  // slopes reach 40
  }
}

// RMS error along a 3 Hz oscillation sampled at 30 Hz, of the track and of linear interpolation.
TEST(ClientInterpolator, IsAtLeastThreeTimesCloserThanLinearOnASwing) {
  const auto swing = [](double t) { return std::sin(2 * std::numbers::pi * 3 * t); };
  Track track(1);
  for (int i = 0; i < 20; ++i)
    InsertAt(track, i * kBetweenSnapshots, {{static_cast<float>(swing(i * kBetweenSnapshots)), 0, 0}, {}});
  double curve = 0, line = 0;
  for (double t = 2 * kBetweenSnapshots; t < 17 * kBetweenSnapshots; t += 0.0005) {
    const double begin = std::floor(t / kBetweenSnapshots) * kBetweenSnapshots;
    const double u = (t - begin) / kBetweenSnapshots;
    const double straight = (1 - u) * swing(begin) + u * swing(begin + kBetweenSnapshots);
    curve += std::pow(static_cast<double>(BlendPose(track.FindMoment(t)).centroid.x) - swing(t), 2);
    line += std::pow(straight - swing(t), 2);
  }
  const double ratio = std::sqrt(line / curve);
  RecordProperty("linear_over_catmull_rom", std::to_string(ratio));
  std::printf("linear error / Catmull-Rom error on a 3 Hz swing at 30 Hz: %.2f\n", ratio);
  EXPECT_GT(ratio, 3.0);
}

TEST(ClientInterpolator, TurnsTheShortWayWhateverTheSignsOfQuaternions) {
  Track track(1);
  for (int i = 0; i < 10; ++i) {
    Quaternion q = TurnAboutZ(i * 0.2);
    if (i % 3 == 1) q = {-q.w, -q.x, -q.y, -q.z};  // the same rotation
    InsertAt(track, i * kBetweenSnapshots, {{}, q});
  }
  for (double t = 0; t < 9 * kBetweenSnapshots; t += 0.0007) {
    const Vector3 vertex = VertexAt(track, t);
    EXPECT_NEAR(std::atan2(vertex.y, vertex.x), 0.2 * t / kBetweenSnapshots, 2e-4) << "at " << t;
    EXPECT_NEAR(protocol::Length(vertex), 1, 1e-5);
  }
}

TEST(ClientInterpolator, GoesOnForATenthOfASecondThenHolds) {
  Track track(1);
  InsertAt(track, 0, {{0, 0, 0}, {}});
  InsertAt(track, kBetweenSnapshots, {{0.1F, 0, 0}, {}}, {{2, 0, 0}});
  const Moment going = track.FindMoment(kBetweenSnapshots + 0.05);
  EXPECT_FALSE(going.held);
  EXPECT_NEAR(BlendPose(going).centroid.x, 0.1 + 3 * 0.05, 1e-5);
  EXPECT_NEAR(VertexAt(track, kBetweenSnapshots + 0.05).x, 0.1 + 3 * 0.05 + 2, 1e-5);  // the last shape

  for (const double beyond : {0.101, 0.2, 5.0}) {
    const Moment held = track.FindMoment(kBetweenSnapshots + beyond);
    EXPECT_TRUE(held.held);
    EXPECT_NEAR(BlendPose(held).centroid.x, 0.1 + 3 * 0.1, 1e-5);
  }
}

TEST(ClientInterpolator, DoesNotFlyAcrossARespawn) {
  Track track(0.5F);
  for (int i = 0; i < 8; ++i) {
    InsertAt(track, i * kBetweenSnapshots, {{i < 4 ? 0.0F : 40.0F, 0, static_cast<float>(i) * 0.1F}, {}});
  }
  for (double t = 0; t < 7.5 * kBetweenSnapshots; t += 0.0007) {
    const float x = BlendPose(track.FindMoment(t)).centroid.x;
    EXPECT_TRUE(x == 0.0F || x == 40.0F) << x << " at " << t;
    EXPECT_EQ(x, t < 4 * kBetweenSnapshots ? 0.0F : 40.0F);
  }
}

TEST(ClientInterpolator, TakesSamplesInAnyOrderOnceEach) {
  Track ordered(1), mixed(1);
  const std::vector<int> order{3, 0, 2, 5, 1, 4};
  for (int i = 0; i < 6; ++i) InsertAt(ordered, i * kBetweenSnapshots, {{static_cast<float>(i * i), 0, 0}, {}});
  for (const int i : order) InsertAt(mixed, i * kBetweenSnapshots, {{static_cast<float>(i * i), 0, 0}, {}});
  EXPECT_FALSE(mixed.Insert(2 * kBetweenSnapshots, false, {{99, 0, 0}, {}}, std::vector<Vector3>{{1, 0, 0}}, 0));
  for (double t = 0; t < 5.5 * kBetweenSnapshots; t += 0.001) {
    EXPECT_EQ(BlendPose(mixed.FindMoment(t)).centroid.x, BlendPose(ordered.FindMoment(t)).centroid.x);
  }
}

TEST(ClientInterpolator, KeepsNoMoreSamplesThanItMayAndTheNewestOfThem) {
  Track track(1);
  for (int i = 1; i <= 1000; ++i) InsertAt(track, i * kBetweenSnapshots, {{static_cast<float>(i) * 0.1F, 0, 0}, {}});
  EXPECT_FALSE(track.Insert(kBetweenSnapshots, false, {}, std::vector<Vector3>{{1, 0, 0}}, 0));
  const double oldest = (1001 - static_cast<double>(kTrackSamples));
  EXPECT_NEAR(BlendPose(track.FindMoment(0)).centroid.x, oldest * 0.1, 1e-4);
  EXPECT_NEAR(BlendPose(track.FindMoment(1000 * kBetweenSnapshots)).centroid.x, 100, 1e-4);
}

TEST(ClientInterpolator, KeepsWhatTheShownMomentStillNeeds) {
  Track full(1), trimmed(1);
  for (int i = 0; i < 20; ++i) {
    const double playback = (i - 3) * kBetweenSnapshots;
    const Pose pose{{static_cast<float>(std::sin(i)), 0, 0}, {}};
    const std::vector<Vector3> shape{{1, 0, 0}};
    EXPECT_TRUE(full.Insert(i * kBetweenSnapshots, false, pose, shape, 0));
    EXPECT_TRUE(trimmed.Insert(i * kBetweenSnapshots, false, pose, shape, playback));
    for (double t = std::max(playback, 0.0); t < i * kBetweenSnapshots; t += 0.003) {
      ASSERT_EQ(BlendPose(trimmed.FindMoment(t)).centroid.x, BlendPose(full.FindMoment(t)).centroid.x);
    }
  }
}

TEST(ClientInterpolator, StaysExactFarFromTheOrigin) {
  Track track(1);
  for (int i = 0; i < 6; ++i) InsertAt(track, i * kBetweenSnapshots, {{8000, 0, 0}, {}});
  for (double t = 0; t < 0.3; t += 0.001) EXPECT_EQ(BlendPose(track.FindMoment(t)).centroid.x, 8000.0F);
}

// Tests of whole bodies.
using SharedBlueprint = std::shared_ptr<const Blueprint>;

SharedBlueprint MakeRow(std::size_t vertices) {
  auto row = std::make_shared<Blueprint>();
  for (std::size_t i = 0; i < vertices; ++i) row->rest.push_back({static_cast<float>(i), 0, 0});
  row->size = 1;
  return row;
}

bool AddRecord(Bodies& bodies, const SharedBlueprint& blueprint, std::uint32_t body, std::uint8_t patch,
               std::uint32_t tick, float x) {
  const std::size_t first = patch * protocol::kMaxPatchVertices;
  const auto shape = std::span(blueprint->rest).subspan(first, protocol::PatchSize(blueprint->rest.size(), patch));
  return bodies.Add({body, 0, patch}, blueprint, tick, tick / 60.0, {{x, 0, 0}, {}}, shape, 0);
}

TEST(ClientBodies, CountsAStallOnceForEachBeginning) {
  const SharedBlueprint blueprint = MakeRow(1);
  Bodies bodies;
  Statistics statistics;
  std::vector<BodySample> samples;
  for (std::uint32_t tick = 0; tick < 12; tick += 2) ASSERT_TRUE(AddRecord(bodies, blueprint, 1, 0, tick, 0));
  for (double t = 0.1; t < 1; t += 0.01) bodies.Sample(t, 10 / 60.0, Detail::kPosesOnly, samples, statistics);
  EXPECT_EQ(statistics.stalls, 1U);
  EXPECT_GT(statistics.framesHeld, 60U);
  EXPECT_TRUE(samples.at(0).held);
  for (std::uint32_t tick = 60; tick < 66; tick += 2) ASSERT_TRUE(AddRecord(bodies, blueprint, 1, 0, tick, 0));
  bodies.Sample(1.05, 64 / 60.0, Detail::kPosesOnly, samples, statistics);
  EXPECT_FALSE(samples.at(0).held);
  bodies.Sample(2, 64 / 60.0, Detail::kPosesOnly, samples, statistics);
  EXPECT_EQ(statistics.stalls, 2U);
}

TEST(ClientBodies, JoinsPatchesEachUnderItsOwnPose) {
  const SharedBlueprint blueprint = MakeRow(protocol::kMaxPatchVertices + 10);
  Bodies bodies;
  Statistics statistics;
  std::vector<BodySample> samples;
  ASSERT_TRUE(AddRecord(bodies, blueprint, 7, 1, 60, 5000));
  bodies.Sample(1, 1, Detail::kVertices, samples, statistics);
  EXPECT_TRUE(samples.empty());  // without the first patch it has no pose
  ASSERT_TRUE(AddRecord(bodies, blueprint, 7, 0, 62, 1000));
  bodies.Sample(1, 62 / 60.0, Detail::kVertices, samples, statistics);
  ASSERT_EQ(samples.size(), 1U);
  ASSERT_EQ(samples[0].vertices.size(), blueprint->rest.size());
  EXPECT_EQ(samples[0].pose.centroid.x, 1000);
  EXPECT_EQ(samples[0].vertices[3].x, 1003);
  EXPECT_EQ(samples[0].vertices[protocol::kMaxPatchVertices].x, 5000 + protocol::kMaxPatchVertices);
  EXPECT_NEAR(samples[0].age, 2 / 60.0, 1e-9);  // the age of its oldest patch
}

TEST(ClientBodies, SamplesByAscendingNumberAndForgets) {
  const SharedBlueprint blueprint = MakeRow(1);
  Bodies bodies;
  Statistics statistics;
  std::vector<BodySample> samples;
  for (const std::uint32_t body : {9U, 2U, 70000U, 4U}) ASSERT_TRUE(AddRecord(bodies, blueprint, body, 0, 60, 0));
  bodies.Remove(4, 61);
  ASSERT_TRUE(AddRecord(bodies, blueprint, 4, 0, 59, 0));  // late, of a tick before the removal
  bodies.Sample(1, 1, Detail::kPosesOnly, samples, statistics);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[0].body, 2U);
  EXPECT_EQ(samples[1].body, 9U);
  EXPECT_EQ(samples[2].body, 70000U);
  ASSERT_TRUE(AddRecord(bodies, blueprint, 4, 0, 62, 0));  // made again
  ASSERT_TRUE(AddRecord(bodies, blueprint, 9, 0, 6000, 0));
  bodies.Forget(100 - kForgetAfter);
  EXPECT_EQ(bodies.Count(), 1U);
}

TEST(ClientBodies, RefusesMoreThanItMayHold) {
  const SharedBlueprint large = MakeRow(protocol::kMaxBodyVertices);
  Bodies bodies;
  std::uint32_t number = 1;
  while (number < 10000 && AddRecord(bodies, large, number, 0, 60, 0)) ++number;
  EXPECT_LE(bodies.Count() * large->rest.size(), kMaxTrackedVertices);
  EXPECT_GE((bodies.Count() + 2) * large->rest.size(), kMaxTrackedVertices);
  bodies.Remove(1, 60);
  EXPECT_TRUE(AddRecord(bodies, large, 10001, 0, 60, 0));

  const SharedBlueprint small = MakeRow(1);
  Bodies many;
  for (number = 1; AddRecord(many, small, number, 0, 60, 0); ++number) ASSERT_LT(number, 1U << 20);
  EXPECT_LE(many.Count(), protocol::kMaxBodies);
}

// Two forms alternate with each tick and are shown far behind: the memory is bounded, and freed.
TEST(ClientBodies, KeepsNoMoreFormsThanItMayAndGivesThemBack) {
  const SharedBlueprint one = MakeRow(2000), two = MakeRow(3000);
  Bodies bodies;
  Statistics statistics;
  std::vector<BodySample> samples;
  for (std::uint32_t body = 1; body <= 5; ++body) {
    for (std::uint32_t tick = 60; tick < 260; tick += 2) {
      ASSERT_TRUE(AddRecord(bodies, tick % 4 == 0 ? one : two, body, 0, tick, static_cast<float>(tick)));
    }
  }
  bodies.Sample(1, 5, Detail::kPosesOnly, samples, statistics);
  ASSERT_EQ(samples.size(), 5U);
  EXPECT_EQ(samples[0].pose.centroid.x, 260 - 2 * static_cast<float>(kMaxForms)) << "the oldest that is kept";
  bodies.Sample(259 / 60.0, 5, Detail::kPosesOnly, samples, statistics);
  EXPECT_EQ(samples[0].blueprint, two);
  for (std::uint32_t body = 1; body <= 5; ++body) bodies.Remove(body, 300);
  EXPECT_EQ(bodies.Count(), 0U);
  const SharedBlueprint large = MakeRow(protocol::kMaxBodyVertices);
  std::uint32_t number = 100;
  while (number < 10000 && AddRecord(bodies, large, number, 0, 400, 0)) ++number;
  EXPECT_GE((bodies.Count() + 2) * large->rest.size(), kMaxTrackedVertices) << "nothing is still counted";
}

}  // namespace
}  // namespace wobble::client
