// A world that objects of Python share, and how they ask it.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "server/library/handle.h"
#include "server/library/python/binding.h"
#include "server/library/wobble_world.h"

namespace wobble::python {

struct Held {
  struct Free {
    void operator()(wobble_world* freed) const { wobble_world_free(freed); }
  };
  std::unique_ptr<wobble_world, Free> world;
  std::mutex turn;
  std::mutex counting;                 // guards `views`; nothing else is called under it
  std::map<std::uint32_t, int> views;  // by body
};
using Shared = std::shared_ptr<Held>;

struct BodyOf {
  Shared held;
  std::uint32_t number = 0;
};

// Sets this exception of Python's and throws it.
[[noreturn]] void Raise(PyObject* type, const std::string& text);
// Raises what fits the result, if it is a fault: `what`, a colon, and `reason`, or else the result's description.
void Check(wobble_world_result result, const std::string& what, std::string reason = {});

template <typename Call>
auto Use(const Shared& held, Call&& call) {
  return TakeTurn(held->turn, [&] { return call(held->world.get()); });
}

[[nodiscard]] inline std::string NameBody(std::uint32_t number) { return "body " + std::to_string(number); }

// 0: the sum over all bodies.
[[nodiscard]] wobble_world_energy ReadEnergy(const Shared& held, std::uint32_t number);

void DefineBody(py::module_& module);

}  // namespace wobble::python
