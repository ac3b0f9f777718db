// Poses are kept as they came off the wire: few of the hundreds that arrive in a second are ever asked for, and turning
// one into floats costs more than keeping it.
//
// Records arrive in any order, also relative to events. So a removed body keeps its entry until Forget: a late record
// then does not bring it back.
#include "client/newest_poses.h"

#include <algorithm>

#include "protocol/limits.h"

namespace wobble::client {

NewestPoses::Entry* NewestPoses::FindOrMake(std::uint32_t body) {
  const auto known = m_entries.find(body);
  if (known != m_entries.end()) return &known->second;
  return m_entries.size() < protocol::kMaxBodies ? &m_entries[body] : nullptr;
}

void NewestPoses::Add(const protocol::RecordHead& head, std::uint32_t tick, const protocol::QuantisedPose& pose) {
  Entry* entry = FindOrMake(head.body);
  if (entry == nullptr || tick <= entry->tick || tick <= entry->removed) return;
  entry->before = entry->pose;
  entry->beforeTick = entry->IsThere() ? entry->tick : 0;
  entry->pose = pose;
  entry->form = {head.blueprint, head.generation};
  entry->rests = head.restTick != 0;
  entry->tick = tick;
}

void NewestPoses::Remove(std::uint32_t body, std::uint32_t tick) {
  if (Entry* entry = FindOrMake(body)) entry->removed = std::max(entry->removed, tick);
}

void NewestPoses::NoteRespawn(std::uint32_t body, std::uint32_t tick) {
  if (Entry* entry = FindOrMake(body)) entry->respawned = std::max(entry->respawned, tick);
}

void NewestPoses::Forget(std::uint32_t tick) {
  std::erase_if(m_entries, [tick](const auto& known) {
    const Entry& entry = known.second;
    const bool rests = entry.rests && entry.IsThere();
    return !rests && std::max({entry.tick, entry.removed, entry.respawned}) < tick;
  });
}

std::optional<protocol::Pose> NewestPoses::Find(std::uint32_t body) const {
  const auto known = m_entries.find(body);
  if (known == m_entries.end() || !known->second.IsThere()) return std::nullopt;
  return protocol::Dequantise(known->second.pose);
}

std::optional<NewestPoses::Form> NewestPoses::FindForm(std::uint32_t body) const {
  const auto known = m_entries.find(body);
  if (known == m_entries.end() || !known->second.IsThere()) return std::nullopt;
  return known->second.form;
}

std::optional<Sighting> NewestPoses::FindSighting(std::uint32_t body, double tickSeconds,
                                                  std::uint32_t newestTick) const {
  const auto known = m_entries.find(body);
  if (known == m_entries.end() || !known->second.IsThere()) return std::nullopt;
  return MakeSighting(body, known->second, tickSeconds, newestTick);
}

void NewestPoses::List(double tickSeconds, std::uint32_t newestTick, std::vector<Sighting>& sightings) const {
  sightings.clear();
  for (const auto& [body, entry] : m_entries) {
    if (entry.IsThere()) sightings.push_back(MakeSighting(body, entry, tickSeconds, newestTick));
  }
}

Sighting NewestPoses::MakeSighting(std::uint32_t body, const Entry& entry, double tickSeconds,
                                   std::uint32_t newestTick) {
  Sighting sighting;
  sighting.body = body;
  sighting.pose = protocol::Dequantise(entry.pose);
  if (entry.rests) {
    sighting.velocity = protocol::Vector3{};
    return sighting;
  }
  sighting.age = newestTick > entry.tick ? (newestTick - entry.tick) * tickSeconds : 0;
  const double span = (entry.tick - entry.beforeTick) * tickSeconds;
  // At the tick of a respawn the body may be at either place.
  if (entry.beforeTick > entry.respawned && span <= kMaxVelocitySpan) {
    const protocol::Vector3 way = sighting.pose.centroid - protocol::Dequantise(entry.before).centroid;
    sighting.velocity = way * static_cast<float>(1 / span);
  }
  return sighting;
}

}  // namespace wobble::client
