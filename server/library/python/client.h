// The client behind Python's, and what stands around its player.
#pragma once

#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/wobble.h"
#include "server/library/python/binding.h"

namespace wobble::python {

struct Player {
  struct Destroy {
    void operator()(wobble_client* destroyed) const { wobble_destroy(destroyed); }
  };
  std::unique_ptr<wobble_client, Destroy> client;
  std::mutex turn;
  double ahead = 0;            // the user's time minus the clock's, s
  std::uint32_t vertices = 0;  // of the last sample
  std::uint32_t indices = 0;
};

// Throws what the result is in Python; nothing when it is no fault.
inline void Check(wobble_result result, const char* what) {
  if (result >= 0) return;
  const std::string text = std::string(what) + ": " + wobble_describe(result);
  if (result == WOBBLE_NO_MEMORY) throw std::bad_alloc();
  if (result == WOBBLE_NOT_PLAYING || result == WOBBLE_INTERNAL) throw std::runtime_error(text);
  throw py::value_error(text);
}

template <typename Call>
void Ask(Player& player, const char* what, Call&& call) {
  Check(TakeTurn(player.turn, [&] { return call(player.client.get()); }), what);
}

// The word for a number of an enumeration; "unknown" for those of a newer library.
template <std::size_t count>
[[nodiscard]] const char* NameAt(const char* const (&names)[count], std::int32_t number) {
  return number >= 0 && static_cast<std::size_t>(number) < count ? names[number] : "unknown";
}
// The words for the bits that are set; the first word is of bit 0.
template <std::size_t count>
[[nodiscard]] std::vector<std::string> NameBits(const char* const (&names)[count], std::uint32_t bits) {
  std::vector<std::string> named;
  for (std::size_t i = 0; i < count; ++i) {
    if ((bits >> i & 1U) != 0) named.emplace_back(names[i]);
  }
  return named;
}
[[nodiscard]] const char* NameEmote(std::int32_t emote);

// Throws ValueError, which names the argument, unless there are so many finite numbers.
[[nodiscard]] inline std::vector<float> ReadFloats(const char* name, const Numbers& numbers, py::ssize_t count = 3) {
  CheckVector(name, numbers, count);
  return {numbers.data(), numbers.data() + count};
}

struct Obstacle {
  wobble_obstacle read{};
};
struct Ground {
  wobble_ground read{};
  py::array heights;
};
[[nodiscard]] std::vector<Obstacle> ListObstacles(Player& player);
[[nodiscard]] std::vector<Ground> ListGrounds(Player& player);
void DefineSurroundings(py::module_& module);
void DefineRules(py::module_& module, py::class_<Player>& client);

}  // namespace wobble::python
