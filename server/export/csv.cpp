#include "server/export/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>

#include "server/export/output.h"
#include "server/physics/energy.h"
#include "server/physics/world_state.h"

namespace wobble::exporting {
namespace {

constexpr const char* kHead =
    "# Units: SI. Axes: right-handed, x and y level, z up, origin and directions of the scene.\n"
    "# time: since the recording began. x, y, z: centre of mass. vx, vy, vz: velocity of the centre of mass.\n"
    "# springs: elastic energy, with tetrahedra and hinges. gas: up to a constant. gravity: 0 at the origin.\n"
    "# A name that begins with = + - or @ has a ' before it, so that no spreadsheet takes it for a formula.\n"
    "time [s],tick,body,blueprint,player,x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],"
    "kinetic [J],springs [J],gas [J],gravity [J],asleep,torn springs\n";

// As RFC 4180 has it. Players choose their names.
std::string Quote(const std::string& text) {
  const bool isFormula = !text.empty() && std::string("=+-@").find(text[0]) != std::string::npos;
  const std::string safe = isFormula ? "'" + text : text;
  if (safe.find_first_of(",\"\r\n") == std::string::npos) return safe;
  std::string quoted = "\"";
  for (const char c : safe) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::size_t Count(const std::vector<std::uint8_t>& torn) {
  return torn.size() - static_cast<std::size_t>(std::ranges::count(torn, 0));
}

}  // namespace

CsvWriter::CsvWriter(const std::filesystem::path& file, const std::string& scene) : m_file(file, std::ios::binary) {
  std::string name = scene;
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < ' '; }, ' ');
  m_file << "# wobble: bodies of scene " << name << '\n' << kHead;
}

// What has torn is taken out of the blueprint after a while; the world's state still tells it.
std::size_t CsvWriter::CountTorn(const physics::World& world, const physics::Body& body) {
  if (const std::uint64_t revision = world.Changes().blueprintRevision; m_revision != revision) {
    m_revision = revision;
    const physics::WorldState state = world.Capture();
    m_tornInSlots.assign(world.Blueprints().size() - state.slots.size(), 0);  // of the scene: whole
    for (const physics::SlotState& slot : state.slots) m_tornInSlots.push_back(Count(slot.recipe.torn));
  }
  return m_tornInSlots[body.blueprint] + Count(ReadTorn(body));
}

std::string CsvWriter::Add(const Frame& frame) {
  const physics::World& world = frame.ground.World();
  errno = 0;
  for (const physics::Body* body : frame.bodies) {
    const physics::Blueprint& blueprint = world.BlueprintOf(*body);
    const physics::Vector3d at = world.FindCentre(*body);
    const physics::Vector3d v = std::visit(
        [&](const auto& state) -> physics::Vector3d { return FindMeanVelocity(blueprint, state); }, body->state);
    const physics::Energy energy = ComputeEnergy(world, *body, m_scratch);
    m_file << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:d},{}\n", frame.time, frame.tick, body->id,
                          Quote(blueprint.name), Quote(FindPlayerName(frame.ground, body->id)), at.x(), at.y(), at.z(),
                          v.x(), v.y(), v.z(), energy.kinetic, energy.springs, energy.gas, energy.gravity, body->asleep,
                          CountTorn(world, *body));
  }
  return m_file.good() ? "" : DescribeWriteError();
}

std::string CsvWriter::Finish() {
  errno = 0;
  m_file.close();
  return m_file.good() ? "" : DescribeWriteError();
}

}  // namespace wobble::exporting
