#include "tests/bench/capacity/shown.h"

#include <algorithm>
#include <cmath>

#include "tests/bench/interpolation/showing.h"

namespace wobble::bench {
namespace {

constexpr double kPercent = 100;

Vector3d FindMean(const std::vector<Vector3d>& points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

class Comparison {
 public:
  Comparison(const Truth& truth, std::span<const physics::BodyId> places) : m_truth(truth), m_places(places) {}

  void Add(const View& view);
  [[nodiscard]] Shown Finish();

 private:
  const Truth& m_truth;
  std::span<const physics::BodyId> m_places;
  std::vector<double> m_squares;  // mean over vertices per body and view, relative to the squared size
  std::size_t m_missing = 0;
  double m_size = 1;  // of a body, m
  std::vector<Vector3d> m_true;
};

void Comparison::Add(const View& view) {
  const auto own = std::ranges::find(m_places, view.ownBody) - m_places.begin();
  if (!m_truth.Find(view.moment, static_cast<std::size_t>(own), m_true)) return;  // outside of the recorded time
  const Vector3d eye = FindMean(m_true);
  for (std::size_t place = 0; place < m_places.size(); ++place) {
    if (!m_truth.Find(view.moment, place, m_true) || (FindMean(m_true) - eye).norm() > Shown::kNear) continue;
    const auto shown = std::ranges::find(view.bodies, m_places[place], &client::BodySample::body);
    if (shown == view.bodies.end()) {
      ++m_missing;
      continue;
    }
    m_size = shown->blueprint->size;
    m_squares.push_back(FindMeanSquare(*shown, m_true) / (m_size * m_size));
  }
}

Shown Comparison::Finish() {
  Shown shown;
  if (m_squares.empty()) return shown;
  double sum = 0;
  for (const double square : m_squares) sum += square;
  const auto count = static_cast<double>(m_squares.size());
  shown.error = kPercent * std::sqrt(sum / count);
  const auto p99 = m_squares.begin() + static_cast<std::ptrdiff_t>(0.99 * count);
  std::nth_element(m_squares.begin(), p99, m_squares.end());
  shown.errorP99 = kPercent * std::sqrt(*p99);
  shown.missingShare = static_cast<double>(m_missing) / (count + static_cast<double>(m_missing));
  shown.truthErrorOfHalf = kPercent * m_truth.ErrorOfHalf() / m_size;
  return shown;
}

}  // namespace

Shown CompareViews(std::span<const View> views, const Truth& truth, std::span<const physics::BodyId> places) {
  Comparison comparison(truth, places);
  for (const View& view : views) comparison.Add(view);
  return comparison.Finish();
}

}  // namespace wobble::bench
