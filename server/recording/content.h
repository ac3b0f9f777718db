// What the blocks of a recording hold, as plain data (fields.h lists the fields of the types within).
//
// A file is a head, a keyframe unless it begins with the scene's first tick, then a block a second and a keyframe a
// minute, and an end if it was ended on purpose. It has no address, ticket or secret of anybody; names that players
// chose are in it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/play/playground_state.h"
#include "server/recording/block_file.h"
#include "server/scenes/loader.h"

namespace wobble::recording {

struct Head {
  std::string version;  // of the program, for people
  scenes::SceneSource scene;
  std::uint32_t tickHz = 60;
  std::uint64_t seed = 1;
  bool beginsFresh = true;  // with the scene's first tick; otherwise a keyframe follows
};

// An entry, and after how many of the second's ticks it came.
struct TimedEntry {
  std::uint16_t after = 0;
  server::Entry entry;
};

// What a tick has made of the world, in a few bytes.
struct Trace {
  std::uint32_t fingerprint = 0;      // of a few vertices of every body that moved
  std::vector<std::uint32_t> hashes;  // of the whole state of a sixtieth of the bodies that moved, by ascending id
};

struct Second {
  std::uint32_t begin = 0;  // ticks played before
  std::vector<TimedEntry> entries;
  std::vector<Trace> traces;  // one a tick
};

template <class Value>
[[nodiscard]] Bytes ToBytes(const Value& value);
// nullopt unless the bytes are those of a value, and no more.
template <class Value>
[[nodiscard]] std::optional<Value> FromBytes(std::span<const std::uint8_t> bytes);

// The trace of the tick that the world has just played. tickHz: each body is hashed once in so many ticks, all of them
// within a second: hashing all after the same tick would make it longer.
[[nodiscard]] Trace MakeTrace(const physics::World& world, std::uint32_t tickHz);
// The ids of the bodies that Trace::hashes are of.
[[nodiscard]] std::vector<physics::BodyId> ListHashed(const physics::World& world, std::uint32_t tickHz);

}  // namespace wobble::recording
