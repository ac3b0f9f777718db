// The name of a file is a hash of everything that the training depends on: the blueprint's rest shape, springs,
// tetrahedra, hinges, masses and material, gravity, the limits of players' controls, and a number that is raised when
// the training changes. The file holds, for each patch, the length of its basis in four bytes and the basis.
#include "server/training/basis_shelf.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

#include "protocol/codec/basis_reader.h"
#include "protocol/messages.h"
#include "protocol/snapshot.h"

namespace wobble::server {
namespace {

constexpr std::uint64_t kTrainingVersion = 1;
constexpr std::uint64_t kTrainingSeed = 0x5EED;

class Fingerprint {
 public:
  template <class Number>
  void Add(Number number) {
    const std::size_t at = m_bytes.size();
    m_bytes.resize(at + sizeof number);
    std::memcpy(m_bytes.data() + at, &number, sizeof number);
  }
  void Add(const physics::Vector3d& v) {
    for (const double part : {v.x(), v.y(), v.z()}) Add(part);
  }
  [[nodiscard]] std::uint64_t Hash() const { return protocol::HashBytes(m_bytes); }

 private:
  std::vector<std::uint8_t> m_bytes;
};

std::uint64_t FindHash(const physics::Blueprint& blueprint, const scenes::Scene& scene) {
  Fingerprint print;
  print.Add(kTrainingVersion);
  for (const physics::Vector3d& vertex : blueprint.rest) print.Add(vertex);
  for (const auto& spring : blueprint.full.springs) {
    print.Add(spring.a);
    print.Add(spring.b);
    for (const double number : {spring.restLength, spring.stiffness, spring.damping}) print.Add(number);
  }
  for (const auto& element : blueprint.full.tetrahedra) {
    for (const std::uint16_t vertex : element.vertices) print.Add(vertex);
  }
  if (!blueprint.full.tetrahedra.empty()) {
    const auto& [shear, bulk, restRatio, viscosity] = blueprint.full.solid;
    for (const double number : {shear, bulk, restRatio, viscosity}) print.Add(number);
  }
  for (const auto& hinge : blueprint.full.hinges) {
    for (const std::uint16_t vertex : hinge.vertices) print.Add(vertex);
    for (const double number : {hinge.stiffness, hinge.damping}) print.Add(number);
  }
  for (const double mass : blueprint.full.masses) print.Add(mass);
  const physics::Coefficients<double>& full = blueprint.full;
  for (const double number :
       {full.gas, full.ambientPressure, full.repulsion, full.drag, full.contact.stiffness, full.contact.friction,
        full.contact.damping, full.contact.rollingResistance, blueprint.gasViscosity}) {
    print.Add(number);
  }
  print.Add(scene.gravity);
  const physics::ControlLimits& limits = scene.player.limits;
  for (const double number :
       {limits.acceleration, limits.speed, limits.jumpSpeed, limits.puffFactor, limits.stiffenFactor}) {
    print.Add(number);
  }
  return print.Hash();
}

// Returns false when the file is missing or does not hold one valid basis per patch.
bool ReadFile(const std::filesystem::path& path, std::size_t vertices, Bases& bases) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return false;
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::size_t next = 0;
  for (std::size_t patch = 0; protocol::PatchSize(vertices, patch) > 0; ++patch) {
    std::uint32_t length = 0;
    if (bytes.size() - next < sizeof length) return false;
    std::memcpy(&length, bytes.data() + next, sizeof length);
    next += sizeof length;
    if (length > bytes.size() - next) return false;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(next);
    bases.emplace_back(begin, begin + length);
    if (protocol::ReadBasis(bases.back(), protocol::PatchSize(vertices, patch)) == nullptr) return false;
    next += length;
  }
  return next == bytes.size();
}

void WriteFile(const std::filesystem::path& path, const Bases& bases) {
  // Written under another name first, because two servers may share the folder.
  const std::filesystem::path draft = path.string() + fmt::format(".{:x}", std::random_device{}());
  std::ofstream file(draft, std::ios::binary);
  for (const auto& basis : bases) {
    const auto length = static_cast<std::uint32_t>(basis.size());
    file.write(reinterpret_cast<const char*>(&length), sizeof length);
    file.write(reinterpret_cast<const char*>(basis.data()), length);
  }
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(draft, path, error);
  if (!file || error) spdlog::warn("bases: {} cannot be written", path.string());
}

Bases LoadOrTrain(const physics::Blueprint& blueprint, const scenes::Scene& scene,
                  const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / fmt::format("{:016x}.basis", FindHash(blueprint, scene));
  Bases bases;
  if (!folder.empty() && ReadFile(path, blueprint.rest.size(), bases)) {
    spdlog::info("basis of {}: read from {}", blueprint.name, path.string());
    return bases;
  }
  spdlog::info("basis of {}: training", blueprint.name);
  bases = TrainBases(blueprint, RecordPlay(blueprint, scene.gravity, scene.player.limits, kTrainingSeed));
  std::size_t bytes = 0;
  for (const auto& basis : bases) bytes += basis.size();
  spdlog::info("basis of {}: trained, {} KiB", blueprint.name, (bytes + 1023) / 1024);
  if (!folder.empty() && !bases.empty()) WriteFile(path, bases);
  return bases;
}

}  // namespace

std::vector<Bases> LoadBases(const scenes::Scene& scene, const std::filesystem::path& folder, int threads) {
  if (!folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
  }
  std::vector<Bases> bases(scene.blueprints.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < bases.size(); i = next++) {
      bases[i] = LoadOrTrain(scenes::MakeBlueprint(scene.blueprints[i]), scene, folder);
    }
  };
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < std::min(bases.size(), static_cast<std::size_t>(threads)); ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  return bases;
}

}  // namespace wobble::server
