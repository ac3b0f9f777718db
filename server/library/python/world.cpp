// World, Recording and Body.
//
// Views: positions and velocities of a world's body are numpy arrays over the engine's own memory, which stays where it is
// until the body is removed or the world freed (wobble_world.h). A view keeps the world alive, and a body that is viewed
// cannot be removed, as Python's bytearray cannot be resized while it is viewed. A recording swaps memory as it likes, so
// its bodies give copies.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/library/handle.h"
#include "server/library/python/binding.h"
#include "server/library/wobble_world.h"

namespace wobble::python {
namespace {

// A world that Python's objects share.
struct Held {
  struct Free {
    void operator()(wobble_world* world) const { wobble_world_free(world); }
  };
  std::unique_ptr<wobble_world, Free> world;
  std::mutex turn;
  std::mutex counting;                  // guards `views`; nothing else is called under it
  std::map<std::uint32_t, int> views;  // by body
};
using Shared = std::shared_ptr<Held>;

// Two types for Python: what a recording shows cannot be changed.
struct World {
  Shared held;
};
struct Recording {
  Shared held;
};
struct BodyOf {
  Shared held;
  std::uint32_t number = 0;
};

[[noreturn]] void Raise(PyObject* type, const std::string& text) {
  PyErr_SetString(type, text.c_str());
  throw py::error_already_set();
}

void Check(wobble_world_result result, const std::string& what, std::string reason = {}) {
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

template <typename Call>
auto Use(const Shared& held, Call&& call) {
  return TakeTurn(held->turn, [&] { return call(held->world.get()); });
}

std::string NameBody(std::uint32_t number) { return "body " + std::to_string(number); }

// Makes a world by `make`(world, message, size).
template <typename Make>
Shared MakeHeld(const std::string& what, Make&& make) {
  auto held = std::make_shared<Held>();
  std::string message(2000, '\0');
  wobble_world* made = nullptr;
  const wobble_world_result result =
      TakeTurn(held->turn, [&] { return make(&made, message.data(), message.size()); });
  held->world.reset(made);
  Check(result, what, message.c_str());
  return held;
}

// An option that is given must not be the 0 that stands for the default.
template <typename Number>
Number ReadOption(const char* name, const std::optional<Number>& option) {
  if (option && *option == 0) throw py::value_error(std::string(name) + " = 0; None stands for the default");
  return option.value_or(0);
}

World MakeWorld(const std::optional<std::filesystem::path>& scene, const std::optional<std::string>& text,
                const std::optional<std::filesystem::path>& folder, std::optional<std::uint64_t> seed,
                std::optional<double> tickRate, const std::optional<std::string>& precision,
                std::optional<double> errorTarget, std::optional<std::uint32_t> threads,
                std::optional<std::uint32_t> substeps) {
  if (scene.has_value() == text.has_value()) throw py::value_error("World takes either a scene or its text");
  if (precision && *precision != "single" && *precision != "double") {
    throw py::value_error("precision = '" + *precision + "'; it must be 'single' or 'double'");
  }
  auto options = MakeStruct<wobble_world_options>();
  if (precision) options.flags = *precision == "single" ? WOBBLE_WORLD_SINGLE : WOBBLE_WORLD_DOUBLE;
  options.scene = scene ? scene->c_str() : nullptr;
  options.text = text ? text->c_str() : nullptr;
  options.folder = folder ? folder->c_str() : nullptr;
  options.seed = ReadOption("seed", seed);
  options.tick_rate = ReadOption("tick_rate", tickRate);
  options.error_target = ReadOption("error_target", errorTarget);
  options.threads = ReadOption("threads", threads);
  options.substeps = ReadOption("substeps", substeps);
  return {MakeHeld("World", [&](wobble_world** world, char* message, std::size_t size) {
    return wobble_world_load(&options, world, message, size);
  })};
}

Recording OpenRecording(const std::filesystem::path& path, std::uint32_t threads) {
  return {MakeHeld("Recording", [&](wobble_world** world, char* message, std::size_t size) {
    return wobble_world_open_recording(path.c_str(), threads, world, message, size);
  })};
}

// In slices, so that Ctrl-C is heard.
wobble_world_report Step(const Shared& held, std::uint32_t ticks) {
  constexpr std::uint32_t kSlice = 16;
  auto sum = MakeStruct<wobble_world_report>();
  for (wobble_world_result result = WOBBLE_WORLD_OK; sum.ticks < ticks && result != WOBBLE_WORLD_AT_END;) {
    auto report = MakeStruct<wobble_world_report>();
    result = Use(held, [&](wobble_world* world) {
      return wobble_world_step(world, std::min(kSlice, ticks - sum.ticks), &report);
    });
    Check(result, "step");
    sum.ticks += report.ticks;
    for (const auto field : {&wobble_world_report::substeps, &wobble_world_report::awake,
                             &wobble_world_report::non_finite, &wobble_world_report::inverted,
                             &wobble_world_report::quarantined, &wobble_world_report::reset,
                             &wobble_world_report::torn}) {
      sum.*field += report.*field;
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return sum;
}

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
    const std::lock_guard lock(of.held->counting);
    isViewed = of.held->views.contains(of.number);
    return isViewed ? WOBBLE_WORLD_OK : wobble_world_remove_body(world, of.number);
  });
  Check(result, NameBody(of.number));
  if (isViewed) Raise(PyExc_BufferError, NameBody(of.number) + ": arrays view its state; delete them first");
}

wobble_world_energy ReadEnergy(const Shared& held, std::uint32_t number) {
  auto energy = MakeStruct<wobble_world_energy>();
  Check(Use(held, [&](wobble_world* world) { return wobble_world_read_energy(world, number, &energy); }),
        NameBody(number));
  return energy;
}

py::dict ReadForces(const BodyOf& of) {
  constexpr std::pair<const char*, double * wobble_world_forces::*> kKinds[] = {
      {"elastic", &wobble_world_forces::elastic}, {"damping", &wobble_world_forces::damping},
      {"gas", &wobble_world_forces::gas},         {"weight", &wobble_world_forces::weight},
      {"contact", &wobble_world_forces::contact}, {"other", &wobble_world_forces::other},
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
  const auto result =
      Use(of.held, [&](wobble_world* world) { return wobble_world_set_control(world, of.number, move.data(), buttons); });
  Check(result, NameBody(of.number), result == WOBBLE_WORLD_BAD_VALUE ? "move is longer than 1" : "");
}

BodyOf AddBody(const World& world, const std::string& blueprint, const Numbers& position, const Numbers& velocity) {
  CheckVector("position", position);
  CheckVector("velocity", velocity);
  std::uint32_t number = 0;
  const auto result = Use(world.held, [&](wobble_world* own) {
    return wobble_world_add_body(own, blueprint.c_str(), position.data(), velocity.data(), &number);
  });
  Check(result, "blueprint '" + blueprint + "'", result == WOBBLE_WORLD_BAD_BODY ? "the world has no such blueprint" : "");
  return {world.held, number};
}

std::vector<BodyOf> ListBodies(const Shared& held) {
  std::vector<BodyOf> bodies;
  Use(held, [&](wobble_world* world) {
    for (const physics::Body& body : world->World().Bodies()) bodies.push_back({held, body.id});
  });
  return bodies;
}

// What worlds and recordings have in common.
template <typename Shown>
void DefineReading(py::class_<Shown>& shown) {
  const auto show = [&](const char* name, auto read, const char* text) {
    shown.def_property_readonly(
        name, [read](const Shown& self) { return Use(self.held, read); }, text);
  };
  show("tick", [](wobble_world* world) { return world->World().Tick(); }, "Steps taken.");
  show("tick_duration", [](wobble_world* world) { return world->World().Settings().tickDuration; }, "s.");
  show(
      "time", [](wobble_world* world) { return world->World().Tick() * world->World().Settings().tickDuration; },
      "tick * tick_duration, s.");
  show("hash", [](wobble_world* world) { return world->World().Hash(); }, "Of every bit of every body's state.");
  show("scene", [](wobble_world* world) { return world->scene.name; }, "Its name.");
  shown.def_property_readonly(
      "bodies", [](const Shown& self) { return ListBodies(self.held); }, "All bodies, by ascending number.");
  shown.def(
      "step", [](const Shown& self, std::uint32_t ticks) { return Step(self.held, ticks); }, py::arg("ticks") = 1,
      "Plays so many ticks, and tells what they did. Other threads of Python run meanwhile.");
  shown.def(
      "body",
      [](const Shown& self, std::uint32_t number) {
        const BodyOf body{self.held, number};
        static_cast<void>(ReadBody(body, [](const wobble_world_body& known) { return known.body; }));
        return body;
      },
      py::arg("number"), "The body of this number; LookupError: there is none.");
  shown.def(
      "energy", [](const Shown& self) { return ReadEnergy(self.held, 0); },
      "Of all bodies, without what contacts store, J.");
}

template <typename Struct>
struct Field {
  const char* name;
  std::uint64_t Struct::*field;
};

void DefineReports(py::module_& module) {
  py::class_<wobble_world_report> report(module, "Report", "What the ticks of a call of step did, summed over them.");
  report.def_readonly("ticks", &wobble_world_report::ticks, "That were played; a recording may have fewer than asked.")
      .def_readonly("substeps", &wobble_world_report::substeps, "Summed over the bodies.")
      .def_readonly("awake", &wobble_world_report::awake, "Bodies that were stepped.")
      .def_readonly("non_finite", &wobble_world_report::non_finite, "Bodies with a non-finite coordinate in a try.")
      .def_readonly("inverted", &wobble_world_report::inverted, "Bodies that ended a tick inside out.")
      .def_readonly("quarantined", &wobble_world_report::quarantined, "Bodies stepped again in more substeps, or reset.")
      .def_readonly("reset", &wobble_world_report::reset, "Bodies put back into their rest shapes.")
      .def_readonly("torn", &wobble_world_report::torn, "Springs that tore.");
  py::class_<wobble_world_energy>(module, "Energy", "J.")
      .def_readonly("kinetic", &wobble_world_energy::kinetic)
      .def_readonly("gravity", &wobble_world_energy::gravity, "0 at the world's origin.")
      .def_readonly("elastic", &wobble_world_energy::elastic, "Of springs, tetrahedra and hinges, with repulsion.")
      .def_readonly("gas", &wobble_world_energy::gas, "Up to a constant.");
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
  show("blueprint", [](Known known) { return std::string(known.name); }, "The name of its kind.");
  show("mass", [](Known known) { return known.mass; }, "kg.");
  show("is_asleep", [](Known known) { return known.is_asleep != 0; }, "At rest, and not stepped until something wakes it.");
  body.def_property_readonly(
      "positions", [](const BodyOf& self) { return ReadState(self, false); },
      "From `origin`, float32 or float64 (n, 3), m: a view.");
  body.def_property_readonly(
      "velocities", [](const BodyOf& self) { return ReadState(self, true); }, "float32 or float64 (n, 3), m/s: a view.");
  body.def_property_readonly(
      "origin",
      [](const BodyOf& self) { return py::array_t<double>(3, ReadBody(self, [](Known known) { return known; }).origin); },
      "float64 (3,), m; moves with the body now and then.");
  body.def_property_readonly("places", &FindPlaces, "origin + positions, float64 (n, 3), m: a copy.");
  copy(
      "rest", [](Known known) { return CopyNumbers(known.rest, 3 * std::size_t{known.vertex_count}); }, 3,
      "Rest shape about its centre of mass, float64 (n, 3), m: a copy.");
  body.def_property_readonly(
      "masses",
      [](const BodyOf& self) {
        return py::array(py::cast(ReadBody(self, [](Known known) { return CopyNumbers(known.masses, known.vertex_count); })));
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

}  // namespace

void DefineWorlds(py::module_& module) {
  DefineReports(module);
  DefineBody(module);
  py::class_<World> world(module, "World", R"(A scene with its bodies, and without players: what falls goes on to fall.

scene: name of a shipped scene such as "arena", or the path of a TOML file; or text: a scene's TOML itself. folder: where
names are looked for. seed: of random placement, from 1. tick_rate: ticks a second, 1 to 1000, default 60. precision:
"single" or "double", default as the scene says. error_target: m/s that may build up in a second, 1e-12 to 1. threads: 1 to
64, default 1. substeps: a fixed number a tick, default as many as error_target and stability ask for.

The same calls give the same bits, whatever the number of threads. ValueError names what is wrong, each mistake of a scene
with its line.

>>> world = wobble.World("ball_drop", seed=7)
>>> world.step(60).ticks, world.time
(60, 1.0)
)");
  world.def(py::init(&MakeWorld), py::arg("scene") = py::none(), py::kw_only(), py::arg("text") = py::none(),
            py::arg("folder") = py::none(), py::arg("seed") = py::none(), py::arg("tick_rate") = py::none(),
            py::arg("precision") = py::none(), py::arg("error_target") = py::none(), py::arg("threads") = py::none(),
            py::arg("substeps") = py::none());
  DefineReading(world);
  world.def_property_readonly(
      "blueprints",
      [](const World& self) {
        return Use(self.held, [](wobble_world* own) {
          std::vector<std::string> names;
          for (const physics::Blueprint& each : own->World().Blueprints()) names.push_back(each.name);
          return names;
        });
      },
      "Names of the kinds of bodies that `add` takes.");
  world.def_property(
      "gravity",
      [](const World& self) {
        const auto gravity = Use(self.held, [](wobble_world* own) { return own->World().Settings().gravity; });
        return py::array_t<double>(3, gravity.data());
      },
      [](const World& self, const Numbers& gravity) {
        CheckVector("gravity", gravity);
        Check(Use(self.held, [&](wobble_world* own) { return wobble_world_set_gravity(own, gravity.data()); }),
              "gravity");
      },
      "m/s^2, float64 (3,): a copy. To change it, assign.");
  world.def("add", &AddBody, py::arg("blueprint"), py::arg("position"), py::arg("velocity") = py::make_tuple(0, 0, 0),
            "Adds a body of this kind. position: of its centre of mass, m.");

  py::class_<Recording> film(module, "Recording", R"(What a server has recorded (.wobrec), from its first tick on.

OSError: there is no such recording, or it is damaged. threads: 1 to 64.)");
  film.def(py::init(&OpenRecording), py::arg("path"), py::kw_only(), py::arg("threads") = 1);
  DefineReading(film);
  const auto show = [&](const char* name, std::uint32_t (recording::Recording::*read)() const) {
    film.def_property_readonly(name, [read](const Recording& self) {
      return Use(self.held, [read](wobble_world* own) { return (own->film->recording.*read)(); });
    });
  };
  show("first_tick", &recording::Recording::FirstTick);
  show("last_tick", &recording::Recording::LastTick);
  film.def(
      "seek",
      [](const Recording& self, std::uint32_t tick) {
        Check(Use(self.held, [&](wobble_world* own) { return wobble_world_seek(own, tick); }),
              "tick " + std::to_string(tick));
      },
      py::arg("tick"), "Goes to the state after so many ticks, from first_tick to last_tick.");
}

}  // namespace wobble::python
