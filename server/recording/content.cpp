#include "server/recording/content.h"

#include "server/recording/fields.h"

namespace wobble::recording {

template <class Archive, Is<Head> Value>
void Describe(Archive& archive, Value& value) {
  auto& [version, scene, tickHz, seed, beginsFresh] = value;
  archive(version, scene, tickHz, seed, beginsFresh);
}

template <class Archive, Is<TimedEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [after, entry] = value;
  archive(after, entry);
}

template <class Archive, Is<Trace> Value>
void Describe(Archive& archive, Value& value) {
  auto& [fingerprint, hashes] = value;
  archive(fingerprint, hashes);
}

template <class Archive, Is<Second> Value>
void Describe(Archive& archive, Value& value) {
  auto& [begin, entries, traces] = value;
  archive(begin, entries, traces);
}

namespace {

constexpr std::size_t kSampled = 4;  // vertices of a body in a fingerprint

std::uint32_t Fold(std::uint64_t hash) { return static_cast<std::uint32_t>(hash ^ hash >> 32); }

// Other vertices each tick: a difference spreads over a body within a few ticks, so one of them soon has it.
std::uint64_t HashSample(const physics::Body& body, std::uint32_t tick, std::uint64_t hash) {
  return std::visit(
      [&](const auto& state) {
        const std::size_t count = state.positions.size();
        for (std::size_t i = 0; i < kSampled; ++i) {
          const auto& place = state.positions[(tick * 7 + i * count / kSampled) % count];
          hash = physics::HashBytes(std::as_bytes(std::span(place.data(), 3)), hash);
        }
        return hash;
      },
      body.state);
}

template <class Visit>
void VisitHashed(const physics::World& world, std::uint32_t tickHz, const Visit& visit) {
  for (const std::uint32_t place : world.Changes().stepped) {
    const physics::Body& body = world.Bodies()[place];
    if (body.id % tickHz == world.Tick() % tickHz) visit(body);
  }
}

}  // namespace

template <class Value>
Bytes ToBytes(const Value& value) {
  Writer writer;
  writer(value);
  return writer.Take();
}

template <class Value>
std::optional<Value> FromBytes(std::span<const std::uint8_t> bytes) {
  Reader reader(bytes);
  std::optional<Value> value(std::in_place);
  reader(*value);
  if (!reader.IsDone()) value.reset();
  return value;
}

template Bytes ToBytes(const Head&);
template Bytes ToBytes(const Second&);
template Bytes ToBytes(const server::PlaygroundState&);
template std::optional<Head> FromBytes(std::span<const std::uint8_t>);
template std::optional<Second> FromBytes(std::span<const std::uint8_t>);
template std::optional<server::PlaygroundState> FromBytes(std::span<const std::uint8_t>);

Trace MakeTrace(const physics::World& world, std::uint32_t tickHz) {
  std::uint64_t hash = physics::kHashSeed;
  for (const std::uint32_t place : world.Changes().stepped)
    hash = HashSample(world.Bodies()[place], world.Tick(), hash);
  Trace trace{.fingerprint = Fold(hash), .hashes = {}};
  VisitHashed(world, tickHz, [&](const physics::Body& body) {
    const auto find = [](const auto& state) { return physics::HashState(state, physics::kHashSeed); };
    trace.hashes.push_back(Fold(std::visit(find, body.state)));
  });
  return trace;
}

std::vector<physics::BodyId> ListHashed(const physics::World& world, std::uint32_t tickHz) {
  std::vector<physics::BodyId> bodies;
  VisitHashed(world, tickHz, [&](const physics::Body& body) { bodies.push_back(body.id); });
  return bodies;
}

}  // namespace wobble::recording
