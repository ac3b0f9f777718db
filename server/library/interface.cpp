// The functions of wobble_world.h: each checks its arguments, then asks the physics. Pointers that are not null are
// trusted to have what they say, everything else is not.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/c/structs.h"
#include "protocol/version.h"
#include "server/library/handle.h"
#include "server/physics/energy.h"
#include "server/physics/inspect.h"

namespace wobble::library {
namespace {

using physics::Vector3d;

constexpr double kMostTickRate = 1000;
constexpr double kLeastErrorTarget = 1e-12;
constexpr std::uint32_t kMostThreads = 64;
constexpr std::uint32_t kMostSubsteps = 65536;
// m, m/s, m/s², N; beyond it nothing that is computed has a meaning.
constexpr double kMostNumber = 1e9;

// Nothing that is thrown below leaves the library.
template <typename Call>
wobble_world_result Guard(Call&& call) noexcept {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return WOBBLE_WORLD_NO_MEMORY;
  } catch (...) {
    return WOBBLE_WORLD_INTERNAL;
  }
}

template <typename Struct>
wobble_world_result CheckStruct(const Struct* given) {
  if (given == nullptr) return WOBBLE_WORLD_NULL;
  return c::HasGoodSize(*given) ? WOBBLE_WORLD_OK : WOBBLE_WORLD_BAD_SIZE;
}

bool AreGood(const double* numbers, std::size_t count) {
  return std::all_of(numbers, numbers + count, [](double each) { return std::abs(each) <= kMostNumber; });
}

std::vector<Vector3d> ReadVectors(const double* numbers, std::size_t count) {
  std::vector<Vector3d> vectors(count);
  for (std::size_t i = 0; i < count; ++i) {
    vectors[i] = Vector3d(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
  }
  return vectors;
}

// 0 stands for the default. Adds a line to `text` when the number is out of its range.
void CheckRange(const char* name, double number, double low, double high, std::string& text) {
  if (number == 0 || (number >= low && number <= high)) return;
  std::array<char, 120> line{};
  std::snprintf(line.data(), line.size(), "%s%s = %g: must be %g to %g", text.empty() ? "" : "\n", name, number, low,
                high);
  text += line.data();
}

wobble_world_result CheckOptions(const wobble_world_options& options, std::string& text) {
  constexpr std::uint32_t kBoth = WOBBLE_WORLD_SINGLE | WOBBLE_WORLD_DOUBLE;
  if ((options.flags & ~kBoth) != 0 || options.flags == kBoth) return WOBBLE_WORLD_BAD_FLAGS;
  if ((options.scene == nullptr) == (options.text == nullptr)) return WOBBLE_WORLD_NULL;
  CheckRange("tick_rate", options.tick_rate, 1, kMostTickRate, text);
  CheckRange("error_target", options.error_target, kLeastErrorTarget, 1, text);
  CheckRange("threads", options.threads, 1, kMostThreads, text);
  CheckRange("substeps", options.substeps, 1, kMostSubsteps, text);
  return text.empty() ? WOBBLE_WORLD_OK : WOBBLE_WORLD_BAD_VALUE;
}

// Makes a world by `make`, and says why there is none.
template <typename Make>
wobble_world_result MakeWorld(wobble_world** world, char* message, std::size_t size, Make&& make) {
  *world = nullptr;
  std::string text;
  std::unique_ptr<wobble_world> made;
  const wobble_world_result result = Guard([&] { return make(made, text); });
  if (text.empty() && result != WOBBLE_WORLD_OK) text = wobble_world_describe(result);
  if (message != nullptr && size > 0) {
    const std::size_t count = std::min(text.size(), size - 1);
    std::memcpy(message, text.data(), count);
    message[count] = '\0';
  }
  *world = made.release();
  return result;
}

// A change of the world that a scene made.
template <typename Change>
wobble_world_result ChangeWorld(wobble_world* world, Change&& change) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (!world->own) return WOBBLE_WORLD_RECORDED;
  return Guard([&] { return change(*world->own); });
}

// The same of a body.
template <typename Change>
wobble_world_result ChangeBody(wobble_world* world, std::uint32_t number, Change&& change) {
  return ChangeWorld(world, [&](physics::World& own) -> wobble_world_result {
    const physics::Body* body = own.FindBody(number);
    return body == nullptr ? WOBBLE_WORLD_BAD_BODY : change(own, *body);
  });
}

void Add(const physics::StepReport& step, wobble_world_report& sum) {
  ++sum.ticks;
  sum.substeps += step.substeps;
  sum.awake += step.awake;
  sum.non_finite += step.nonFinite;
  sum.inverted += step.inverted;
  sum.quarantined += step.quarantined;
  sum.reset += step.reset;
  sum.torn += step.torn;
}

const std::vector<physics::EdgeEnds>& FindEdges(const physics::Blueprint& blueprint) {
  return blueprint.full.faces.empty() ? blueprint.edges : blueprint.topology.sides;
}

template <typename Element>
auto Numbers(const std::vector<Element>& elements) {
  return elements.empty() ? nullptr : elements.front().data();
}

wobble_world_body Describe(const physics::World& world, const physics::Body& body) {
  const physics::Blueprint& blueprint = world.BlueprintOf(body);
  wobble_world_body known{};
  known.body = body.id;
  known.blueprint = body.blueprint;
  known.vertex_count = static_cast<std::uint32_t>(blueprint.rest.size());
  known.face_count = static_cast<std::uint32_t>(blueprint.full.faces.size());
  known.edge_count = static_cast<std::uint32_t>(FindEdges(blueprint).size());
  known.is_asleep = body.asleep ? 1 : 0;
  known.mass = blueprint.totalMass;
  known.name = blueprint.name.c_str();
  known.rest = Numbers(blueprint.rest);
  known.masses = blueprint.full.masses.data();
  known.faces = Numbers(blueprint.full.faces);
  known.edges = Numbers(FindEdges(blueprint));
  if (const auto* single = std::get_if<physics::State<float>>(&body.state)) {
    known.positions_single = Numbers(single->positions);
    known.velocities_single = Numbers(single->velocities);
    std::copy_n(single->origin.data(), 3, known.origin);
  } else {
    const auto& full = std::get<physics::State<double>>(body.state);
    known.is_double = 1;
    known.positions_double = Numbers(full.positions);
    known.velocities_double = Numbers(full.velocities);
    std::copy_n(full.origin.data(), 3, known.origin);
  }
  return known;
}

}  // namespace
}  // namespace wobble::library

using namespace wobble;
using namespace wobble::library;

const char* wobble_world_describe(wobble_world_result result) {
  switch (result) {
    case WOBBLE_WORLD_OK:
      return "done";
    case WOBBLE_WORLD_AT_END:
      return "the recording has no more ticks";
    case WOBBLE_WORLD_NULL:
      return "a pointer is NULL that must not be, or both scene and text are given";
    case WOBBLE_WORLD_BAD_SIZE:
      return "struct_size is not the size of the struct";
    case WOBBLE_WORLD_BAD_FLAGS:
      return "a bit is set that has no meaning here";
    case WOBBLE_WORLD_BAD_VALUE:
      return "a number is not finite or out of its range";
    case WOBBLE_WORLD_BAD_SCENE:
      return "there is no such scene, or it has mistakes";
    case WOBBLE_WORLD_BAD_FILE:
      return "there is no such recording, or it is damaged";
    case WOBBLE_WORLD_BAD_BODY:
      return "there is no such body";
    case WOBBLE_WORLD_RECORDED:
      return "a recording plays what was recorded, and nothing else can change its world";
    case WOBBLE_WORLD_NO_MEMORY:
      return "there is not enough memory";
    case WOBBLE_WORLD_INTERNAL:
      return "a defect of the library";
    default:
      return "no result of this library";
  }
}

const char* wobble_world_version() { return kVersion; }

wobble_world_result wobble_world_load(const wobble_world_options* options, wobble_world** world, char* message,
                                      size_t message_size) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  return MakeWorld(world, message, message_size, [&](auto& made, std::string& text) -> wobble_world_result {
    if (const wobble_world_result bad = CheckStruct(options); bad != WOBBLE_WORLD_OK) return bad;
    const wobble_world_options known = c::Read(*options);
    if (const wobble_world_result bad = CheckOptions(known, text); bad != WOBBLE_WORLD_OK) return bad;
    return Load(known, made, text);
  });
}

wobble_world_result wobble_world_open_recording(const char* path, uint32_t threads, wobble_world** world, char* message,
                                                size_t message_size) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  return MakeWorld(world, message, message_size, [&](auto& made, std::string& text) -> wobble_world_result {
    if (path == nullptr) return WOBBLE_WORLD_NULL;
    if (threads < 1) return WOBBLE_WORLD_BAD_VALUE;
    CheckRange("threads", threads, 1, kMostThreads, text);
    if (!text.empty()) return WOBBLE_WORLD_BAD_VALUE;
    return OpenRecording(path, static_cast<int>(threads), made, text);
  });
}

void wobble_world_free(wobble_world* world) { delete world; }

wobble_world_result wobble_world_step(wobble_world* world, uint32_t ticks, wobble_world_report* report) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (report != nullptr && !c::HasGoodSize(*report)) return WOBBLE_WORLD_BAD_SIZE;
  return Guard([&]() -> wobble_world_result {
    wobble_world_report sum{};
    bool isAtEnd = false;
    while (sum.ticks < ticks && !isAtEnd) {
      if (world->own) {
        Add(world->own->Step(), sum);
      } else {
        isAtEnd = !world->film->replay->Advance();
        sum.ticks += isAtEnd ? 0 : 1;
      }
    }
    if (report != nullptr) c::Write(sum, *report);
    return isAtEnd ? WOBBLE_WORLD_AT_END : WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_seek(wobble_world* world, uint32_t tick) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (!world->film) return WOBBLE_WORLD_BAD_VALUE;
  const recording::Recording& recording = world->film->recording;
  if (tick < recording.FirstTick() || tick > recording.LastTick()) return WOBBLE_WORLD_BAD_VALUE;
  return Guard([&]() -> wobble_world_result {
    return world->film->replay->Seek(tick).empty() ? WOBBLE_WORLD_OK : WOBBLE_WORLD_BAD_FILE;
  });
}

wobble_world_result wobble_world_read_info(const wobble_world* world, wobble_world_info* info) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (const wobble_world_result bad = CheckStruct(info); bad != WOBBLE_WORLD_OK) return bad;
  const physics::World& shown = world->World();
  wobble_world_info known{};
  known.tick = shown.Tick();
  known.tick_duration = shown.Settings().tickDuration;
  known.time = known.tick * known.tick_duration;
  std::copy_n(shown.Settings().gravity.data(), 3, known.gravity);
  known.body_count = static_cast<std::uint32_t>(shown.Bodies().size());
  known.blueprint_count = static_cast<std::uint32_t>(shown.Blueprints().size());
  known.is_recording = world->film ? 1 : 0;
  known.first_tick = world->film ? world->film->recording.FirstTick() : 0;
  known.last_tick = world->film ? world->film->recording.LastTick() : 0;
  known.hash = shown.Hash();
  known.scene = world->scene.name.c_str();
  c::Write(known, *info);
  return WOBBLE_WORLD_OK;
}

wobble_world_result wobble_world_read_body(const wobble_world* world, uint32_t index, wobble_world_body* body) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (const wobble_world_result bad = CheckStruct(body); bad != WOBBLE_WORLD_OK) return bad;
  const auto bodies = world->World().Bodies();
  if (index >= bodies.size()) return WOBBLE_WORLD_BAD_BODY;
  c::Write(Describe(world->World(), bodies[index]), *body);
  return WOBBLE_WORLD_OK;
}

wobble_world_result wobble_world_read_energy(const wobble_world* world, uint32_t body, wobble_world_energy* energy) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (const wobble_world_result bad = CheckStruct(energy); bad != WOBBLE_WORLD_OK) return bad;
  return Guard([&]() -> wobble_world_result {
    const physics::World& shown = world->World();
    const physics::Body* one = body == 0 ? nullptr : shown.FindBody(body);
    if (body != 0 && one == nullptr) return WOBBLE_WORLD_BAD_BODY;
    physics::Energy sum;
    std::vector<Vector3d> scratch;
    for (const physics::Body& each : shown.Bodies()) {
      if (one == nullptr || &each == one) sum += physics::ComputeEnergy(shown, each, scratch);
    }
    wobble_world_energy known{};
    known.kinetic = sum.kinetic;
    known.gravity = sum.gravity;
    known.elastic = sum.springs;
    known.gas = sum.gas;
    c::Write(known, *energy);
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_read_forces(const wobble_world* world, uint32_t body,
                                             const wobble_world_forces* forces) {
  if (world == nullptr) return WOBBLE_WORLD_NULL;
  if (const wobble_world_result bad = CheckStruct(forces); bad != WOBBLE_WORLD_OK) return bad;
  return Guard([&]() -> wobble_world_result {
    const wobble_world_forces wanted = c::Read(*forces);
    const physics::World& shown = world->World();
    if (body == 0 || shown.FindBody(body) == nullptr) return WOBBLE_WORLD_BAD_BODY;
    const physics::InspectedForces found = physics::InspectForces(shown, body);
    if (wanted.vertex_capacity < found.weight.size()) return WOBBLE_WORLD_BAD_VALUE;
    const auto copy = [](const std::vector<Vector3d>& from, double* to) {
      if (to != nullptr && !from.empty()) std::memcpy(to, from.data(), from.size() * sizeof(Vector3d));
    };
    copy(found.elastic, wanted.elastic);
    copy(found.damping, wanted.damping);
    copy(found.gas, wanted.gas);
    copy(found.weight, wanted.weight);
    copy(found.contact, wanted.contact);
    copy(found.other, wanted.other);
    copy(found.accelerations, wanted.accelerations);
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_push(wobble_world* world, uint32_t body, uint32_t count, const uint16_t* vertices,
                                      const double* forces) {
  if (forces == nullptr) return WOBBLE_WORLD_NULL;
  return ChangeBody(world, body, [&](physics::World& own, const physics::Body& pushed) -> wobble_world_result {
    const std::size_t vertexCount = own.BlueprintOf(pushed).rest.size();
    if (count > vertexCount || !AreGood(forces, 3 * std::size_t{count})) return WOBBLE_WORLD_BAD_VALUE;
    std::vector<physics::VertexForce<double>> given(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t vertex = vertices == nullptr ? static_cast<std::uint16_t>(i) : vertices[i];
      if (vertex >= vertexCount) return WOBBLE_WORLD_BAD_VALUE;
      given[i] = {vertex, Vector3d(forces[3 * i], forces[3 * i + 1], forces[3 * i + 2])};
    }
    own.PushVertices(body, given);
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_set_motion(wobble_world* world, uint32_t body, uint32_t vertex_count,
                                            const double* positions, const double* velocities) {
  if (positions == nullptr || velocities == nullptr) return WOBBLE_WORLD_NULL;
  return ChangeBody(world, body, [&](physics::World& own, const physics::Body& moved) -> wobble_world_result {
    const std::size_t count = own.BlueprintOf(moved).rest.size();
    const bool isGood = vertex_count == count && AreGood(positions, 3 * count) && AreGood(velocities, 3 * count);
    if (!isGood) return WOBBLE_WORLD_BAD_VALUE;
    own.SetMotion(body, ReadVectors(positions, count), ReadVectors(velocities, count));
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_set_control(wobble_world* world, uint32_t body, const double move[2],
                                             uint32_t buttons) {
  if (move == nullptr) return WOBBLE_WORLD_NULL;
  return ChangeBody(world, body, [&](physics::World& own, const physics::Body&) -> wobble_world_result {
    if ((buttons & ~std::uint32_t{WOBBLE_WORLD_JUMP | WOBBLE_WORLD_PUFF | WOBBLE_WORLD_STIFFEN}) != 0) {
      return WOBBLE_WORLD_BAD_FLAGS;
    }
    const double length = std::hypot(move[0], move[1]);
    if (!(length <= 1 + 1e-9)) return WOBBLE_WORLD_BAD_VALUE;
    const double share = length > 1 ? 1 / length : 1;
    own.SetControl(body,
                   {.moveX = share * move[0],
                    .moveY = share * move[1],
                    .jump = (buttons & WOBBLE_WORLD_JUMP) != 0,
                    .puff = (buttons & WOBBLE_WORLD_PUFF) != 0,
                    .stiffen = (buttons & WOBBLE_WORLD_STIFFEN) != 0},
                   world->scene.player.limits);
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_set_gravity(wobble_world* world, const double gravity[3]) {
  if (gravity == nullptr) return WOBBLE_WORLD_NULL;
  return ChangeWorld(world, [&](physics::World& own) -> wobble_world_result {
    if (!AreGood(gravity, 3)) return WOBBLE_WORLD_BAD_VALUE;
    own.SetGravity(Vector3d(gravity[0], gravity[1], gravity[2]));
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_add_body(wobble_world* world, const char* blueprint, const double position[3],
                                          const double velocity[3], uint32_t* body) {
  if (blueprint == nullptr || position == nullptr || body == nullptr) return WOBBLE_WORLD_NULL;
  return ChangeWorld(world, [&](physics::World& own) -> wobble_world_result {
    const std::array<double, 3> still{};
    const double* speed = velocity == nullptr ? still.data() : velocity;
    if (!AreGood(position, 3) || !AreGood(speed, 3)) return WOBBLE_WORLD_BAD_VALUE;
    const auto kinds = own.Blueprints();
    const auto kind = std::ranges::find(kinds, std::string_view(blueprint), &physics::Blueprint::name);
    if (kind == kinds.end()) return WOBBLE_WORLD_BAD_BODY;
    *body = own.AddBody(static_cast<std::uint8_t>(kind - kinds.begin()),
                        Vector3d(position[0], position[1], position[2]), Vector3d(speed[0], speed[1], speed[2]));
    return WOBBLE_WORLD_OK;
  });
}

wobble_world_result wobble_world_remove_body(wobble_world* world, uint32_t body) {
  return ChangeBody(world, body, [&](physics::World& own, const physics::Body&) -> wobble_world_result {
    own.RemoveBody(body);
    return WOBBLE_WORLD_OK;
  });
}
