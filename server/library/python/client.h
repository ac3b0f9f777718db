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

}  // namespace wobble::python
