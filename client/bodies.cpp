// A body is one track for each of its patches, made with the body's first record and all at once, so that its whole
// cost is known and refused before anything is kept. Patches come in packets of their own and may be of different
// ticks; each is shown from its own track under its own pose, at the same moment, and the body's pose is that of the
// first. A patch nothing has come of is shown in its rest shape.
#include "client/bodies.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace wobble::client {
namespace {

std::size_t PatchCount(std::size_t vertices) {
  return (vertices + protocol::kMaxPatchVertices - 1) / protocol::kMaxPatchVertices;
}

std::size_t CostOf(const Blueprint& blueprint) {
  return blueprint.rest.size() + kTrackCost * PatchCount(blueprint.rest.size());
}

}  // namespace

bool Bodies::Add(const protocol::RecordHead& head, const Blueprint& blueprint, std::uint32_t tick, double time,
                 const protocol::Pose& pose, std::span<const protocol::Vector3> shape, double playback) {
  assert(shape.size() == protocol::PatchSize(blueprint.rest.size(), head.patch) && !shape.empty());
  if (WasRemoved(head.body, tick)) return true;
  const auto known = m_bodies.find(head.body);
  if (known != m_bodies.end() && known->second.blueprint != &blueprint) {  // another body under the same number
    if (tick < known->second.newestTick) return true;
    Erase(known);
  }
  Body* body = FindOrMake(head.body, blueprint);
  if (body == nullptr) return false;
  body->patches[head.patch].Insert(time, pose, shape, playback);
  if (tick >= body->newestTick) {
    body->newestTick = tick;
    body->newestTime = time;
  }
  return true;
}

Bodies::Body* Bodies::FindOrMake(std::uint32_t number, const Blueprint& blueprint) {
  const auto known = m_bodies.find(number);
  if (known != m_bodies.end()) return &known->second;
  if (m_bodies.size() >= protocol::kMaxBodies || m_tracked + CostOf(blueprint) > kMaxTrackedVertices) return nullptr;
  m_tracked += CostOf(blueprint);
  Body& body = m_bodies[number];
  body.blueprint = &blueprint;
  body.patches.assign(PatchCount(blueprint.rest.size()), Track(blueprint.size));
  return &body;
}

void Bodies::Remove(std::uint32_t body, std::uint32_t tick) {
  m_removals[m_nextRemoval] = {body, tick};
  m_nextRemoval = (m_nextRemoval + 1) % m_removals.size();
  const auto known = m_bodies.find(body);
  if (known != m_bodies.end() && known->second.newestTick <= tick) Erase(known);
}

bool Bodies::WasRemoved(std::uint32_t body, std::uint32_t tick) const {
  return std::any_of(m_removals.begin(), m_removals.end(),
                     [&](const Removal& removal) { return removal.body == body && tick <= removal.tick; });
}

Bodies::BodyMap::iterator Bodies::Erase(BodyMap::iterator body) {
  m_tracked -= CostOf(*body->second.blueprint);
  return m_bodies.erase(body);
}

void Bodies::Forget(double olderThan) {
  for (auto body = m_bodies.begin(); body != m_bodies.end();) {
    body = body->second.newestTime < olderThan ? Erase(body) : std::next(body);
  }
}

void Bodies::Sample(double time, double newest, Detail detail, std::vector<BodySample>& samples,
                    Statistics& statistics) {
  std::size_t count = 0;
  for (auto& [number, body] : m_bodies) {
    if (body.patches[0].Empty()) continue;  // no pose yet
    if (samples.size() == count) samples.emplace_back();
    BodySample& sample = samples[count++];
    sample.body = number;
    SampleBody(body, time, newest, detail, sample);
    ++statistics.framesSampled;
    if (sample.held) ++statistics.framesHeld;
    if (sample.held && !body.wasHeld) ++statistics.stalls;
    body.wasHeld = sample.held;
  }
  samples.resize(count);
}

void Bodies::SampleBody(const Body& body, double time, double newest, Detail detail, BodySample& sample) {
  sample.blueprint = body.blueprint;
  sample.vertices.clear();
  sample.age = 0;
  sample.held = false;
  for (std::size_t patch = 0; patch < body.patches.size(); ++patch) {
    const Track& track = body.patches[patch];
    if (track.Empty()) {
      if (detail == Detail::kPosesOnly) continue;
      const auto rest =
          std::span(body.blueprint->rest)
              .subspan(patch * protocol::kMaxPatchVertices, protocol::PatchSize(body.blueprint->rest.size(), patch));
      for (const protocol::Vector3& point : rest) sample.vertices.push_back(protocol::Transform(sample.pose, point));
      continue;
    }
    const Moment moment = track.FindMoment(time);
    const protocol::Pose pose = BlendPose(moment);
    if (patch == 0) sample.pose = pose;
    if (detail == Detail::kVertices) AppendVertices(moment, pose, sample.vertices);
    sample.age = std::max(sample.age, newest - moment.samples[moment.count - 1]->time);
    sample.held = sample.held || moment.held;
  }
}

}  // namespace wobble::client
