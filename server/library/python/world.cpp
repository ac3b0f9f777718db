// World and Recording.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "server/library/python/held.h"

namespace wobble::python {
namespace {

// Two types for Python: what a recording shows cannot be changed.
struct World {
  Shared held;
};
struct Recording {
  Shared held;
};

// Makes a world by `make`(world, message, size).
template <typename Make>
Shared MakeHeld(const std::string& what, Make&& make) {
  auto held = std::make_shared<Held>();
  std::string message(2000, '\0');
  wobble_world* made = nullptr;
  const wobble_world_result result = TakeTurn(held->turn, [&] { return make(&made, message.data(), message.size()); });
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
    for (const auto field :
         {&wobble_world_report::substeps, &wobble_world_report::awake, &wobble_world_report::non_finite,
          &wobble_world_report::inverted, &wobble_world_report::quarantined, &wobble_world_report::reset,
          &wobble_world_report::torn}) {
      sum.*field += report.*field;
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return sum;
}

BodyOf AddBody(const World& world, const std::string& blueprint, const Numbers& position, const Numbers& velocity) {
  CheckVector("position", position);
  CheckVector("velocity", velocity);
  std::uint32_t number = 0;
  const auto result = Use(world.held, [&](wobble_world* own) {
    return wobble_world_add_body(own, blueprint.c_str(), position.data(), velocity.data(), &number);
  });
  Check(result, "blueprint '" + blueprint + "'",
        result == WOBBLE_WORLD_BAD_BODY ? "the world has no such blueprint" : "");
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
  show(
      "tick", [](wobble_world* world) { return world->World().Tick(); }, "Steps taken.");
  show(
      "tick_duration", [](wobble_world* world) { return world->World().Settings().tickDuration; }, "s.");
  show(
      "time", [](wobble_world* world) { return world->World().Tick() * world->World().Settings().tickDuration; },
      "tick * tick_duration, s.");
  show(
      "hash", [](wobble_world* world) { return world->World().Hash(); }, "Of every bit of every body's state.");
  show(
      "scene", [](wobble_world* world) { return world->scene.name; }, "Its name.");
  shown.def_property_readonly(
      "bodies", [](const Shown& self) { return ListBodies(self.held); }, "All bodies, by ascending number.");
  shown.def(
      "step", [](const Shown& self, std::uint32_t ticks) { return Step(self.held, ticks); }, py::arg("ticks") = 1,
      "Plays so many ticks, and tells what they did. Other threads of Python run meanwhile.");
  shown.def(
      "body",
      [](const Shown& self, std::uint32_t number) {
        const BodyOf body{self.held, number};
        const bool isThere =
            Use(self.held, [=](wobble_world* world) { return world->World().FindBody(number) != nullptr; });
        Check(isThere ? WOBBLE_WORLD_OK : WOBBLE_WORLD_BAD_BODY, NameBody(number));
        return body;
      },
      py::arg("number"), "The body of this number; LookupError: there is none.");
  shown.def(
      "energy", [](const Shown& self) { return ReadEnergy(self.held, 0); },
      "Of all bodies, without what contacts store, J.");
}

void DefineReports(py::module_& module) {
  py::class_<wobble_world_report> report(module, "Report", "What the ticks of a call of step did, summed over them.");
  report.def_readonly("ticks", &wobble_world_report::ticks, "That were played; a recording may have fewer than asked.")
      .def_readonly("substeps", &wobble_world_report::substeps, "Summed over the bodies.")
      .def_readonly("awake", &wobble_world_report::awake, "Bodies that were stepped.")
      .def_readonly("non_finite", &wobble_world_report::non_finite, "Bodies with a non-finite coordinate in a try.")
      .def_readonly("inverted", &wobble_world_report::inverted, "Bodies that ended a tick inside out.")
      .def_readonly("quarantined", &wobble_world_report::quarantined,
                    "Bodies stepped again in more substeps, or reset.")
      .def_readonly("reset", &wobble_world_report::reset, "Bodies put back into their rest shapes.")
      .def_readonly("torn", &wobble_world_report::torn, "Springs that tore.");
  py::class_<wobble_world_energy>(module, "Energy", "J.")
      .def_readonly("kinetic", &wobble_world_energy::kinetic)
      .def_readonly("gravity", &wobble_world_energy::gravity, "0 at the world's origin.")
      .def_readonly("elastic", &wobble_world_energy::elastic, "Of springs, tetrahedra and hinges, with repulsion.")
      .def_readonly("gas", &wobble_world_energy::gas, "Up to a constant.");
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
  const auto show = [&](const char* name, std::uint32_t (recording::Recording::*read)() const, const char* text) {
    film.def_property_readonly(
        name,
        [read](const Recording& self) {
          return Use(self.held, [read](wobble_world* own) { return (own->film->recording.*read)(); });
        },
        text);
  };
  show("first_tick", &recording::Recording::FirstTick, "Where it begins.");
  show("last_tick", &recording::Recording::LastTick, "Where it ends.");
  film.def(
      "seek",
      [](const Recording& self, std::uint32_t tick) {
        Check(Use(self.held, [&](wobble_world* own) { return wobble_world_seek(own, tick); }),
              "tick " + std::to_string(tick));
      },
      py::arg("tick"), "Goes to the state after so many ticks, from first_tick to last_tick.");
}

}  // namespace wobble::python
