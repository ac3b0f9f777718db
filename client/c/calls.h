// What the functions of wobble.h share: they check their arguments, and let nothing that is thrown out of the library.
#pragma once

#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include "client/c/frames.h"
#include "client/c/player.h"
#include "client/c/structs.h"
#include "client/wobble.h"
#include "protocol/geometry.h"

struct wobble_client {
  std::unique_ptr<wobble::c::Player> player;
  wobble::c::Frames frames;
  double now = 0;
};

namespace wobble::c {

// Seconds; doubles tell tenths of a millisecond apart there.
inline constexpr double kMaxTime = 1e12;
// Of any text that is given; longer ones are not read to their end.
inline constexpr std::size_t kMaxTextBytes = 1024;

// Nothing that is thrown below leaves the library.
template <typename Call>
[[nodiscard]] wobble_result Guard(Call&& call) noexcept {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return WOBBLE_NO_MEMORY;
  } catch (...) {
    return WOBBLE_INTERNAL;
  }
}

[[nodiscard]] inline bool IsTime(double now) { return std::isfinite(now) && std::abs(now) < kMaxTime; }

// Answers a question about the client. find(): the answer, or nullopt when there is nothing at an index.
template <typename Struct, typename Find>
[[nodiscard]] wobble_result Answer(const wobble_client* client, Struct* answer, Find&& find) {
  if (client == nullptr) return WOBBLE_NULL;
  if (const wobble_result bad = CheckStruct(answer); bad != WOBBLE_OK) return bad;
  const std::optional<Struct> found = find();
  if (!found) return WOBBLE_BAD_INDEX;
  Write(*found, *answer);
  return WOBBLE_OK;
}

// Does to the client what belongs to a moment.
template <typename Call>
[[nodiscard]] wobble_result At(wobble_client* client, double now, Call&& call) {
  if (client == nullptr) return WOBBLE_NULL;
  if (!IsTime(now) || now < client->now) return WOBBLE_BAD_TIME;
  client->now = now;
  return Guard(call);
}

// nullopt: not three finite numbers.
[[nodiscard]] inline std::optional<protocol::Vector3> ReadVector(const float* numbers) {
  const protocol::Vector3 vector{numbers[0], numbers[1], numbers[2]};
  if (!std::isfinite(vector.x) || !std::isfinite(vector.y) || !std::isfinite(vector.z)) return {};
  return vector;
}

// nullopt: too long.
[[nodiscard]] inline std::optional<std::string_view> ReadText(const char* text) {
  if (text == nullptr) return "";
  const std::size_t length = strnlen(text, kMaxTextBytes + 1);
  if (length > kMaxTextBytes) return {};
  return std::string_view(text, length);
}

}  // namespace wobble::c
