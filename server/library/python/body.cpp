// Body.
//
// Views: positions and velocities of a world's body are numpy arrays over the engine's own memory, which stays where it
// is until the body is removed or the world freed (wobble_world.h). A view keeps the world alive, and a body that is
// viewed cannot be removed, as Python's bytearray cannot be resized while it is viewed. A recording swaps memory as it
// likes, so its bodies give copies.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "server/library/python/held.h"

namespace wobble::python {
namespace {

// With the world's turn.
wobble_world_result Find(const wobble_world* world, std::uint32_t number, wobble_world_body& body) {
  const auto bodies = world->World().Bodies();
  const physics::Body* found = world->World().FindBody(number);
  if (found == nullptr) return WOBBLE_WORLD_BAD_BODY;
  return wobble_world_read_body(world, static_cast<std::uint32_t>(found - bodies.data()), &body);
}

// Calls read(body) with the world's turn.
template <typename Read>
auto ReadBody(const BodyOf& of, Read&& read) {
  auto known = MakeStruct<wobble_world_body>();
  wobble_world_result found = WOBBLE_WORLD_OK;
  auto answer = Use(of.held, [&](const wobble_world* world) -> std::optional<decltype(read(known))> {
    found = Find(world, of.number, known);
    if (found < 0) return std::nullopt;
    return read(known);
  });
  Check(found, NameBody(of.number));
  return *std::move(answer);
}

// Rows of three numbers of the body's blueprint, which a tear replaces: a copy.
template <typename Number>
std::vector<Number> CopyNumbers(const Number* numbers, std::size_t count) {
  return numbers == nullptr ? std::vector<Number>{} : std::vector<Number>(numbers, numbers + count);
}
template <typename Number>
py::array Shape(const std::vector<Number>& numbers, py::ssize_t columns) {
  return CopyRows(numbers.data(), static_cast<py::ssize_t>(numbers.size()) / columns, columns);
}

// While one of these is alive the body cannot be removed.
struct View {
  BodyOf of;
  explicit View(BodyOf viewed) : of(std::move(viewed)) {
    const std::lock_guard lock(of.held->counting);
    ++of.held->views[of.number];
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
  ~View() {
    const std::lock_guard lock(of.held->counting);
    if (--of.held->views[of.number] == 0) of.held->views.erase(of.number);
  }
};

template <typename Real>
py::array MakeArray(const Real* numbers, std::uint32_t rows, const py::object& base) {
  py::array_t<Real> array({py::ssize_t{rows}, py::ssize_t{3}}, numbers, base);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// An array of the body's state: a view, or a copy of what a recording shows.
py::array ReadState(const BodyOf& of, bool velocities) {
  std::unique_ptr<View> view;
  std::vector<float> single;
  std::vector<double> full;
  const auto body = ReadBody(of, [&](wobble_world_body known) {
    if (velocities) known.positions_single = known.velocities_single, known.positions_double = known.velocities_double;
    if (!of.held->world->film) {
      view = std::make_unique<View>(of);  // before another thread's turn to remove the body
    } else if (known.is_double != 0) {
      full = CopyNumbers(known.positions_double, 3 * known.vertex_count);
    } else {
      single = CopyNumbers(known.positions_single, 3 * known.vertex_count);
    }
    return known;
  });
  if (!view) return body.is_double != 0 ? Shape(full, 3) : Shape(single, 3);
  const py::capsule base(view.get(), [](void* viewed) { delete static_cast<View*>(viewed); });
  static_cast<void>(view.release());
  return body.is_double != 0 ? MakeArray(body.positions_double, body.vertex_count, base)
                             : MakeArray(body.positions_single, body.vertex_count, base);
}

py::array FindPlaces(const BodyOf& of) {
  return Shape(ReadBody(of,
                        [](const wobble_world_body& body) {
                          std::vector<double> places(3 * std::size_t{body.vertex_count});
                          for (std::size_t i = 0; i < places.size(); ++i) {
                            places[i] = body.origin[i % 3] + (body.is_double != 0 ? body.positions_double[i]
                                                                                  : double{body.positions_single[i]});
                          }
                          return places;
                        }),
               3);
}

void Remove(const BodyOf& of) {
  bool isViewed = false;
  const auto result = Use(of.held, [&](wobble_world* world) -> wobble_world_result {
    {
      const std::lock_guard lock(of.held->counting);
      isViewed = of.held->views.contains(of.number);  // no other thread makes a view meanwhile: it has no turn
    }
    return isViewed ? WOBBLE_WORLD_OK : wobble_world_remove_body(world, of.number);
  });
  Check(result, NameBody(of.number));
  if (isViewed) Raise(PyExc_BufferError, NameBody(of.number) + ": arrays view its state; delete them first");
}

py::dict ReadForces(const BodyOf& of) {
  constexpr std::pair<const char*, double * wobble_world_forces::*> kKinds[] = {
      {"elastic", &wobble_world_forces::elastic},
      {"damping", &wobble_world_forces::damping},
      {"gas", &wobble_world_forces::gas},
      {"weight", &wobble_world_forces::weight},
      {"contact", &wobble_world_forces::contact},
      {"other", &wobble_world_forces::other},
      {"accelerations", &wobble_world_forces::accelerations}};
  auto forces = MakeStruct<wobble_world_forces>();
  forces.vertex_capacity = ReadBody(of, [](const wobble_world_body& body) { return body.vertex_count; });
  py::dict named;
  for (const auto& [name, field] : kKinds) {
    py::array_t<double> array({py::ssize_t{forces.vertex_capacity}, py::ssize_t{3}});
    forces.*field = array.mutable_data();
    named[name] = array;
  }
  Check(Use(of.held, [&](wobble_world* world) { return wobble_world_read_forces(world, of.number, &forces); }),
        NameBody(of.number));
  return named;
}

void Push(const BodyOf& of, const Numbers& forces, const std::optional<std::vector<std::uint16_t>>& vertices) {
  const std::uint32_t count = ReadBody(of, [](const wobble_world_body& body) { return body.vertex_count; });
  CheckVectors("forces", forces, vertices ? static_cast<py::ssize_t>(vertices->size()) : py::ssize_t{count});
  for (const std::uint16_t vertex : vertices.value_or(std::vector<std::uint16_t>{})) {
    if (vertex >= count) {
      Raise(PyExc_IndexError, "vertices has " + std::to_string(vertex) + "; " + NameBody(of.number) + " has " +
                                  std::to_string(count) + " vertices");
    }
  }
  const auto rows = static_cast<std::uint32_t>(forces.shape(0));
  Check(Use(of.held,
            [&](wobble_world* world) {
              return wobble_world_push(world, of.number, rows, vertices ? vertices->data() : nullptr, forces.data());
            }),
        NameBody(of.number));
}

void SetMotion(const BodyOf& of, const Numbers& positions, const Numbers& velocities) {
  const std::uint32_t count = ReadBody(of, [](const wobble_world_body& body) { return body.vertex_count; });
  CheckVectors("positions", positions, py::ssize_t{count});
  CheckVectors("velocities", velocities, py::ssize_t{count});
  Check(Use(of.held,
            [&](wobble_world* world) {
              return wobble_world_set_motion(world, of.number, count, positions.data(), velocities.data());
            }),
        NameBody(of.number));
}

void SetControl(const BodyOf& of, const Numbers& move, bool jump, bool puff, bool stiffen) {
  CheckVector("move", move, 2);
  const std::uint32_t buttons =
      (jump ? WOBBLE_WORLD_JUMP : 0) | (puff ? WOBBLE_WORLD_PUFF : 0) | (stiffen ? WOBBLE_WORLD_STIFFEN : 0);
  const auto result = Use(
      of.held, [&](wobble_world* world) { return wobble_world_set_control(world, of.number, move.data(), buttons); });
  Check(result, NameBody(of.number), result == WOBBLE_WORLD_BAD_VALUE ? "move is longer than 1" : "");
}

}  // namespace

[[noreturn]] void Raise(PyObject* type, const std::string& text) {
  PyErr_SetString(type, text.c_str());
  throw py::error_already_set();
}

void Check(wobble_world_result result, const std::string& what, std::string reason) {
  if (result >= 0) return;
  if (reason.empty()) reason = wobble_world_describe(result);
  const std::string text = what + ": " + reason;
  switch (result) {
    case WOBBLE_WORLD_BAD_BODY:
      Raise(PyExc_LookupError, text);
    case WOBBLE_WORLD_BAD_FILE:
      Raise(PyExc_OSError, text);
    case WOBBLE_WORLD_NO_MEMORY:
      Raise(PyExc_MemoryError, text);
    case WOBBLE_WORLD_RECORDED:
    case WOBBLE_WORLD_INTERNAL:
      Raise(PyExc_RuntimeError, text);
    default:
      Raise(PyExc_ValueError, text);
  }
}

wobble_world_energy ReadEnergy(const Shared& held, std::uint32_t number) {
  auto energy = MakeStruct<wobble_world_energy>();
  Check(Use(held, [&](wobble_world* world) { return wobble_world_read_energy(world, number, &energy); }),
        NameBody(number));
  return energy;
}

void DefineBody(py::module_& module) {
  py::class_<BodyOf> body(module, "Body", R"(A body of a World or Recording. After its removal: LookupError.

positions and velocities of a World's body are views: numpy arrays over the engine's own memory, without a copy. They are
read-only, always show the present state, and hold for as long as one likes: they keep the world alive, and the body cannot
be removed while there is one (BufferError). To keep a state, copy it. A step in another thread may be seen half-way. Of a
Recording they are copies.

>>> ball = wobble.World("ball_drop").bodies[0]
>>> x = ball.positions
>>> x.flags.owndata, x.flags.writeable
(False, False)
)");
  const auto show = [&](const char* name, auto read, const char* text) {
    body.def_property_readonly(
        name, [read](const BodyOf& self) { return ReadBody(self, read); }, text);
  };
  const auto copy = [&](const char* name, auto read, py::ssize_t columns, const char* text) {
    body.def_property_readonly(
        name, [read, columns](const BodyOf& self) { return Shape(ReadBody(self, read), columns); }, text);
  };
  using Known = const wobble_world_body&;
  body.def_readonly("number", &BodyOf::number, "Which it keeps; from 1.");
  show(
      "blueprint", [](Known known) { return std::string(known.name); }, "The name of its kind.");
  show(
      "mass", [](Known known) { return known.mass; }, "kg.");
  show(
      "is_asleep", [](Known known) { return known.is_asleep != 0; },
      "At rest, and not stepped until something wakes it.");
  body.def_property_readonly(
      "positions", [](const BodyOf& self) { return ReadState(self, false); },
      "From `origin`, float32 or float64 (n, 3), m: a view.");
  body.def_property_readonly(
      "velocities", [](const BodyOf& self) { return ReadState(self, true); },
      "float32 or float64 (n, 3), m/s: a view.");
  body.def_property_readonly(
      "origin",
      [](const BodyOf& self) {
        return py::array_t<double>(3, ReadBody(self, [](Known known) { return known; }).origin);
      },
      "float64 (3,), m; moves with the body now and then.");
  body.def_property_readonly("places", &FindPlaces, "origin + positions, float64 (n, 3), m: a copy.");
  copy(
      "rest", [](Known known) { return CopyNumbers(known.rest, 3 * std::size_t{known.vertex_count}); }, 3,
      "Rest shape about its centre of mass, float64 (n, 3), m: a copy.");
  body.def_property_readonly(
      "masses",
      [](const BodyOf& self) {
        return py::array(
            py::cast(ReadBody(self, [](Known known) { return CopyNumbers(known.masses, known.vertex_count); })));
      },
      "float64 (n,), kg: a copy.");
  copy(
      "faces", [](Known known) { return CopyNumbers(known.faces, 3 * std::size_t{known.face_count}); }, 3,
      "Vertices, counter-clockwise seen from outside, uint16 (m, 3): a copy.");
  copy(
      "edges", [](Known known) { return CopyNumbers(known.edges, 2 * std::size_t{known.edge_count}); }, 2,
      "Sides of faces, or springs of a body without faces, uint16 (m, 2): a copy.");
  body.def(
      "energy", [](const BodyOf& self) { return ReadEnergy(self.held, self.number); },
      "Without what contacts store, J.");
  body.def("forces", &ReadForces, R"(Forces on each vertex by kind, float64 (n, 3), N, and `accelerations`, m/s^2.

>>> sorted(wobble.World("pair").bodies[0].forces())
['accelerations', 'contact', 'damping', 'elastic', 'gas', 'other', 'weight']
)");
  body.def("push", &Push, py::arg("forces"), py::arg("vertices") = py::none(),
           "Adds forces, N, on these vertices (default: all, in order) through the next tick.");
  body.def("set_motion", &SetMotion, py::arg("positions"), py::arg("velocities"),
           "Sets where every vertex is in the world, m, and how it moves, m/s. Fixed vertices stay at rest.");
  body.def("set_control", &SetControl, py::arg("move") = py::make_tuple(0, 0), py::kw_only(), py::arg("jump") = false,
           py::arg("puff") = false, py::arg("stiffen") = false,
           "What a player would ask of it, until the next call. move: along x and y, at most 1 long.");
  body.def("remove", &Remove, "Takes it out of the world. BufferError: an array still views its state.");
  body.def("__repr__", [](const BodyOf& self) {
    return "<wobble.Body " + std::to_string(self.number) + ": " +
           ReadBody(self, [](Known known) { return std::string(known.name); }) + ">";
  });
}

}  // namespace wobble::python
