#include "tests/bench/capacity/shown.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
  Comparison(const Truth& truth, std::span<const physics::BodyId> places, std::size_t nearest)
      : m_truth(truth), m_places(places), m_nearest(nearest) {}

  void Add(const View& view);
  [[nodiscard]] Shown Finish();

 private:
  // Fills m_near with the places of the bodies that count, the own one first; empty outside of the recorded time.
  void FindNear(const View& view);
  [[nodiscard]] double FindPercent(double share);

  const Truth& m_truth;
  std::span<const physics::BodyId> m_places;
  std::size_t m_nearest;
  std::vector<double> m_squares;  // mean over vertices per body and view, relative to the squared size
  std::size_t m_missing = 0;
  std::size_t m_late = 0;
  double m_size = 1;                                   // of a body, m
  std::vector<std::pair<double, std::size_t>> m_near;  // distance, m, and place
  std::vector<Vector3d> m_true;
};

void Comparison::FindNear(const View& view) {
  m_near.clear();
  const auto own = std::ranges::find(m_places, view.ownBody) - m_places.begin();
  if (!m_truth.Find(view.moment, static_cast<std::size_t>(own), m_true)) return;
  const Vector3d eye = FindMean(m_true);
  for (std::size_t place = 0; place < m_places.size(); ++place) {
    if (!m_truth.Find(view.moment, place, m_true)) continue;
    const double distance = (FindMean(m_true) - eye).norm();
    if (distance <= Shown::kNear) m_near.emplace_back(distance, place);
  }
  std::ranges::sort(m_near);
  if (m_near.size() - 1 > m_nearest) m_near.resize(m_nearest + 1);
}

void Comparison::Add(const View& view) {
  FindNear(view);
  for (const auto& [distance, place] : m_near) {
    const auto shown = std::ranges::find(view.bodies, m_places[place], &client::BodySample::body);
    if (shown == view.bodies.end()) {
      ++m_missing;
      continue;
    }
    if (shown->age > Shown::kLate) ++m_late;
    static_cast<void>(m_truth.Find(view.moment, place, m_true));  // was found above
    m_size = shown->blueprint->size;
    m_squares.push_back(FindMeanSquare(*shown, m_true) / (m_size * m_size));
  }
}

double Comparison::FindPercent(double share) {
  const auto rank = m_squares.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(m_squares.size()));
  std::nth_element(m_squares.begin(), rank, m_squares.end());
  return kPercent * std::sqrt(*rank);
}

Shown Comparison::Finish() {
  Shown shown;
  if (m_squares.empty()) return shown;
  double sum = 0;
  for (const double square : m_squares) sum += square;
  const auto count = static_cast<double>(m_squares.size());
  shown.error = kPercent * std::sqrt(sum / count);
  shown.errorP50 = FindPercent(0.5);
  shown.errorP99 = FindPercent(0.99);
  shown.lateShare = static_cast<double>(m_late) / count;
  shown.missingShare = static_cast<double>(m_missing) / (count + static_cast<double>(m_missing));
  shown.truthErrorOfHalf = kPercent * m_truth.ErrorOfHalf() / m_size;
  return shown;
}

}  // namespace

View MakeView(const client::Client& client, std::span<const client::BodySample> shown, double now) {
  return {.moment = client.ServerTime(now) - client.InterpolationDelay(),
          .ownBody = client.Welcome().ownBody,
          .bodies = {shown.begin(), shown.end()}};
}

Shown CompareViews(std::span<const View> views, const Truth& truth, std::span<const physics::BodyId> places,
                   std::size_t nearest) {
  Comparison comparison(truth, places, nearest);
  for (const View& view : views) comparison.Add(view);
  return comparison.Finish();
}

}  // namespace wobble::bench
