// Growth is judged by means over blocks, each twice as long as the one before: close to the stability limit a motion
// swells and shrinks by a factor of twenty without growing, in beats of up to a hundred steps, so its size at one
// moment means nothing. The eigenvalues of one step's matrix would be faster to compute, but the server plays the step
// itself, not its matrix.
#include "tests/bench/stability/growing.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kSmallness = 1e-7;    // of the disturbance, relative to the body
constexpr int kFirstBlock = 256;       // steps
constexpr double kSureGrowth = 3;      // e³ = 20
constexpr double kSureDecay = -7;      // lower than any single motion can lie below the sum of all
constexpr double kRescaleBeyond = 10;  // in either direction

}  // namespace

Disturbed::Disturbed(const Blueprint& blueprint, Integrator integrator, bool alongX)
    : m_body(blueprint, integrator),
      m_frequency(blueprint.angularFrequency),
      m_size(kSmallness * blueprint.size * blueprint.angularFrequency) {
  std::mt19937_64 random(1);  // the same for all bodies; random directions only ensure that every motion is excited
  const auto draw = [&] { return static_cast<double>(random() >> 11) / 4503599627370496.0 - 1; };
  for (const double inverseMass : blueprint.full.inverseMasses) {
    const Vector3d direction(draw(), alongX ? 0 : draw(), alongX || blueprint.full.planar ? 0 : draw());
    m_directions.push_back(inverseMass > 0 ? direction : Vector3d::Zero());
  }
}

void Disturbed::Begin() {
  double sum = 0;
  for (const Vector3d& each : m_directions) sum += each.squaredNorm();
  const double way = m_size / (m_frequency * std::sqrt(sum));
  m_scaled = 0;
  for (std::size_t i = 0; i < m_directions.size(); ++i) {
    m_body.x[i] = m_body.blueprint.rest[i] + way * m_directions[i];
    m_body.v[i].setZero();
  }
}

void Disturbed::Scale(double factor) {
  for (std::size_t i = 0; i < m_body.x.size(); ++i) {
    const Vector3d& rest = m_body.blueprint.rest[i];
    m_body.x[i] = rest + factor * (m_body.x[i] - rest);
    m_body.v[i] *= factor;
  }
  m_scaled -= std::log(factor);
}

double Disturbed::Step(double h, int steps) {
  double mean = 0;  // of squares, over m_size² e^{2 reference}
  const double reference = m_scaled;
  for (int step = 0; step < steps; ++step) {
    m_body.Step(h);
    double square = 0;
    for (std::size_t i = 0; i < m_body.x.size(); ++i) {
      square += m_frequency * m_frequency * (m_body.x[i] - m_body.blueprint.rest[i]).squaredNorm() +
                m_body.v[i].squaredNorm();
    }
    const double size = std::sqrt(square) / m_size;
    mean += std::exp(2 * (m_scaled - reference)) * size * size / steps;
    if ((size > kRescaleBeyond || size < 1 / kRescaleBeyond) && size > 0) Scale(1 / size);
  }
  return reference + std::log(mean) / 2;
}

double Disturbed::FindGrowth(double h, int steps) {
  Begin();
  const double before = Step(h, steps / 2);
  return (Step(h, steps / 2) - before) / (steps / 2);
}

bool Disturbed::Grows(double h, int maxSteps, double margin) {
  Begin();
  double before = Step(h, kFirstBlock);
  const double first = before;
  double growth = 0;
  for (int done = kFirstBlock; done < maxSteps; done *= 2) {
    const double after = Step(h, done);
    growth = after - before;
    before = after;
    if (!(growth < kSureGrowth)) return true;  // NaN counts as growth
    if (after - first < kSureDecay) return false;
  }
  return growth > margin;
}

}  // namespace wobble::bench
