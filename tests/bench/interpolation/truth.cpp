#include "tests/bench/interpolation/truth.h"

#include <cmath>

#include "tests/bench/contact/bodies.h"

namespace wobble::bench {
namespace {

// Hermite cubic at u in 0 to 1, from `from` to `to`, which are `h` seconds apart.
Vector3d FindBetween(const Vector3d& from, const Vector3d& fromVelocity, const Vector3d& to, const Vector3d& toVelocity,
                     double h, double u) {
  const double v = 1 - u;
  return (1 + 2 * u) * v * v * from + u * u * (3 - 2 * u) * to + h * u * v * (v * fromVelocity - u * toVelocity);
}

}  // namespace

void Truth::Add(const physics::World& world) {
  Tick& tick = m_ticks[world.Tick() % kKept];
  tick.tick = world.Tick();
  tick.bodies.clear();
  for (const physics::Body& body : world.Bodies()) tick.bodies.push_back({ReadPositions(body), ReadVelocities(body)});
  NoteError(tick.tick);
}

const Truth::Tick* Truth::FindTick(std::uint32_t tick) const {
  const Tick& kept = m_ticks[tick % kKept];
  return tick > 0 && kept.tick == tick ? &kept : nullptr;
}

bool Truth::Find(double time, std::size_t place, std::vector<Vector3d>& vertices) const {
  const double ticks = time / m_tickSeconds;
  if (!(ticks >= 1)) return false;
  const auto before = static_cast<std::uint32_t>(ticks);
  const Tick* const from = FindTick(before);
  const Tick* const to = FindTick(before + 1);
  if (from == nullptr || to == nullptr || place >= from->bodies.size()) return false;
  const Body& a = from->bodies[place];
  const Body& b = to->bodies[place];
  vertices.clear();
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    vertices.push_back(
        FindBetween(a.positions[i], a.velocities[i], b.positions[i], b.velocities[i], m_tickSeconds, ticks - before));
  }
  return true;
}

void Truth::NoteError(std::uint32_t newest) {
  if (newest < 3) return;
  const Tick* const from = FindTick(newest - 2);
  const Tick* const middle = FindTick(newest - 1);
  const Tick* const to = FindTick(newest);
  if (from == nullptr || middle == nullptr || from->bodies.size() != to->bodies.size()) return;
  for (std::size_t body = 0; body < from->bodies.size(); ++body) {
    const Body& a = from->bodies[body];
    const Body& b = to->bodies[body];
    for (std::size_t i = 0; i < a.positions.size(); ++i) {
      const Vector3d found =
          FindBetween(a.positions[i], a.velocities[i], b.positions[i], b.velocities[i], 2 * m_tickSeconds, 0.5);
      m_squares += (found - middle->bodies[body].positions[i]).squaredNorm();
    }
    m_count += a.positions.size();
  }
}

double Truth::ErrorOfHalf() const { return std::sqrt(m_squares / static_cast<double>(m_count)); }

}  // namespace wobble::bench
