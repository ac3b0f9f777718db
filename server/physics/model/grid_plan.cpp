// A row of the sweep is a row of the grid, or a whole layer, or the whole grid: vertices are numbered so that each of
// these lies in one piece. A direction that would lead from the end of a row of the grid to the beginning of the next
// has coefficients of zero there. Short rows leave lanes empty, long rows have more forces waiting for their vertices.
//
// Measured with 16 lanes, ns a vertex and step, for rows of the grid, layers, and all in one row: lattice of 4³
// vertices 140, 46, 44; of 9³ 72, 43, 34; of 21³ 56, 53, 41, but up to twice that while other cores use the outer
// caches; cloth of 30² without drag 21, as one layer 18; of 100² 19, 20. So the longest row is taken whose pending
// forces fit the core's own cache.
#include "server/physics/model/grid_plan.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {
namespace {

// Most bytes of pending forces: a quarter of the cache that a core has to itself.
constexpr std::size_t kMaxPending = 256 << 10;

std::uint32_t RoundUp(std::uint32_t number, std::uint32_t step) { return (number + step - 1) / step * step; }

// The way from vertex a to b > a, in rows and columns of the sweep.
struct Way {
  std::uint32_t rows = 0;
  std::int32_t columns = 0;

  auto operator<=>(const Way&) const = default;
};

template <class Real>
Way FindWay(const GridPlan<Real>& plan, std::uint32_t a, std::uint32_t b) {
  return {plan.RowOf(b) - plan.RowOf(a),
          static_cast<std::int32_t>(plan.ColumnOf(b)) - static_cast<std::int32_t>(plan.ColumnOf(a))};
}

template <class Real>
Way FindWay(const GridPlan<Real>& plan, const Spring<Real>& spring) {
  return FindWay(plan, std::min(spring.a, spring.b), std::max(spring.a, spring.b));
}

template <class Real>
std::uint32_t FindDirection(const GridPlan<Real>& plan, const Way& way) {
  const auto leads = [&](const GridDirection& each) { return each.rows == way.rows && each.columns == way.columns; };
  const auto found = std::find_if(plan.directions.begin(), plan.directions.end(), leads);
  return static_cast<std::uint32_t>(found - plan.directions.begin());
}

template <class Real>
Real* NumbersOf(std::vector<GridLine<Real>>& lines) {
  return reinterpret_cast<Real*>(lines.data());
}

// Collects rows of coefficients and keeps equal rows once.
template <class Real>
class RowPool {
 public:
  explicit RowPool(std::vector<GridLine<Real>>& lines) : m_lines(lines) {}

  // Returns where the row stands in the lines; kNoGridRow if all of it is zero.
  std::uint32_t Keep(const std::vector<Real>& row) {
    if (std::all_of(row.begin(), row.end(), [](Real number) { return number == Real(0); })) return kNoGridRow;
    const auto next = static_cast<std::uint32_t>(m_lines.size() * GridLine<Real>::kNumbers);
    const auto [kept, isNew] = m_kept.try_emplace(row, next);
    if (isNew) {
      m_lines.resize(m_lines.size() + row.size() / GridLine<Real>::kNumbers);
      std::copy(row.begin(), row.end(), NumbersOf(m_lines) + next);
    }
    return kept->second;
  }

 private:
  std::vector<GridLine<Real>>& m_lines;
  std::map<std::vector<Real>, std::uint32_t> m_kept;
};

// Reserves pending forces for this way.
template <class Real>
GridDirection PlaceForces(const Way& way, GridPlan<Real>& plan) {
  const std::uint32_t ringRows = way.rows + (way.rows > 0 ? 1 : 0);
  const GridDirection direction{
      .rows = way.rows, .columns = way.columns, .ringRows = std::max(1U, ringRows), .begin = plan.pendingSize};
  plan.pendingSize += direction.ringRows * 3 * (plan.width + 2 * plan.margin);
  return direction;
}

// The ways from a hinge's first vertex to the others.
using HingeWays = std::array<Way, 3>;

template <class Real>
HingeWays FindWays(const GridPlan<Real>& plan, const Hinge<Real>& hinge) {
  const auto& [a, b, c, d] = hinge.vertices;
  return {FindWay(plan, a, b), FindWay(plan, a, c), FindWay(plan, a, d)};
}

template <class Real>
std::set<HingeWays> FindHingeKinds(const Coefficients<Real>& body, const GridPlan<Real>& plan) {
  std::set<HingeWays> kinds;
  for (const Hinge<Real>& hinge : body.hinges) kinds.insert(FindWays(plan, hinge));
  return kinds;
}

template <class Real>
void PlaceHinges(const std::set<HingeWays>& kinds, GridPlan<Real>& plan) {
  for (const auto& [b, c, d] : kinds) {
    plan.hinges.push_back({.b = {.rows = b.rows, .columns = b.columns},
                           .c = {.rows = c.rows, .columns = c.columns},
                           .d = PlaceForces(d, plan)});
  }
}

template <class Real>
bool FillDirections(const Coefficients<Real>& body, const GridShape& shape, GridPlan<Real>& plan) {
  std::set<std::pair<std::uint32_t, Way>> ways;  // with what each adds to a vertex's number, ascending in that
  for (const Spring<Real>& spring : body.springs) {
    ways.insert({std::max(spring.a, spring.b) - std::min(spring.a, spring.b), FindWay(plan, spring)});
    if (ways.size() > kMaxGridDirections) return false;
  }
  const std::set<HingeWays> kinds = FindHingeKinds(body, plan);
  if (kinds.size() > kMaxGridHinges) return false;
  const std::uint32_t farthest = plan.hasDrag ? shape.columns + 1 : 0;
  std::uint32_t margin = plan.hasDrag ? static_cast<std::uint32_t>(FindWay(plan, 0, farthest).columns) : 0;
  for (const auto& [offset, way] : ways) margin = std::max(margin, static_cast<std::uint32_t>(std::abs(way.columns)));
  for (const HingeWays& each : kinds) {
    for (const Way& way : each) margin = std::max(margin, static_cast<std::uint32_t>(std::abs(way.columns)));
  }
  plan.margin = RoundUp(margin, GridLine<Real>::kNumbers);
  for (const auto& [offset, way] : ways) plan.directions.push_back(PlaceForces(way, plan));
  PlaceHinges(kinds, plan);
  if (!plan.hasDrag) return true;
  plan.squares = {.a = PlaceForces({}, plan),
                  .b = PlaceForces(FindWay(plan, 0, shape.columns), plan),
                  .c = PlaceForces(FindWay(plan, 0, farthest), plan),
                  .d = PlaceForces(FindWay(plan, 0, 1), plan)};
  return true;
}

// Collects the springs' coefficients by row and direction. False if two springs of a vertex go in one direction.
template <class Real>
bool FillSprings(const Coefficients<Real>& body, GridPlan<Real>& plan, RowPool<Real>& pool) {
  const std::size_t count = plan.directions.size();
  std::vector<std::vector<Real>> rows(plan.rows * count, std::vector<Real>(3 * plan.width, Real(0)));
  for (const Spring<Real>& spring : body.springs) {
    const std::uint32_t first = std::min(spring.a, spring.b);
    const std::uint32_t direction = FindDirection(plan, FindWay(plan, spring));
    Real* numbers = rows[plan.RowOf(first) * count + direction].data() + plan.ColumnOf(first);
    if (numbers[0] != Real(0)) return false;
    numbers[0] = spring.stiffness;
    numbers[plan.width] = spring.stiffness * spring.restLength;
    numbers[2 * plan.width] = spring.damping;
  }
  for (const std::vector<Real>& row : rows) plan.coefficients.springRows.push_back(pool.Keep(row));
  return true;
}

// Collects the hinges' coefficients by row and kind. False if two hinges of a vertex are of one kind.
template <class Real>
bool FillHingeRows(const Coefficients<Real>& body, GridPlan<Real>& plan, RowPool<Real>& pool) {
  const std::set<HingeWays> kinds = FindHingeKinds(body, plan);
  std::vector<std::vector<Real>> rows(plan.rows * kinds.size(), std::vector<Real>(2 * plan.width, Real(0)));
  for (const Hinge<Real>& hinge : body.hinges) {
    const std::uint32_t first = hinge.vertices[0];
    const auto kind = static_cast<std::size_t>(std::distance(kinds.begin(), kinds.find(FindWays(plan, hinge))));
    Real* numbers = rows[plan.RowOf(first) * kinds.size() + kind].data() + plan.ColumnOf(first);
    if (numbers[0] != Real(0)) return false;
    numbers[0] = hinge.stiffness;
    numbers[plan.width] = hinge.damping;
  }
  for (const std::vector<Real>& row : rows) plan.coefficients.hingeRows.push_back(pool.Keep(row));
  return true;
}

// The half of a square that a face is.
struct Half {
  std::uint32_t corner = 0;  // vertex of the square's corner a
  bool second = false;       // its second triangle
  bool cut = false;          // the square is cut from b to d, not from a to c
};

std::optional<Half> FindHalf(const GridShape& shape, Face face) {
  std::sort(face.begin(), face.end());
  const std::uint32_t n = shape.columns;
  const std::array<std::uint32_t, 2> steps{face[1] - 0U - face[0], face[2] - 0U - face[0]};
  // A square's corners in ascending order of their numbers are a, d, b, c; the steps between the face's numbers tell
  // which three it has.
  if (steps == std::array<std::uint32_t, 2>{n, n + 1}) return Half{face[0], false, false};     // a b c
  if (steps == std::array<std::uint32_t, 2>{1, n + 1}) return Half{face[0], true, false};      // a d c
  if (steps == std::array<std::uint32_t, 2>{1, n}) return Half{face[0], false, true};          // a d b
  if (steps == std::array<std::uint32_t, 2>{n - 1, n}) return Half{face[0] - 1U, true, true};  // d b c
  return std::nullopt;
}

// Collects the drag of the squares by row. False if a face is no half of a square, or two halves are cut differently.
template <class Real>
bool FillSquares(const Coefficients<Real>& body, const GridShape& shape, GridPlan<Real>& plan, RowPool<Real>& pool) {
  std::vector<std::vector<Real>> rows(plan.rows, std::vector<Real>(3 * plan.width, Real(0)));
  std::vector<std::optional<bool>> cuts(shape.CountVertices());
  for (const Face& face : body.faces) {
    const std::optional<Half> half = FindHalf(shape, face);
    if (!half || half->corner % shape.columns + 1 == shape.columns) return false;
    if (cuts[half->corner].value_or(half->cut) != half->cut) return false;
    cuts[half->corner] = half->cut;
    Real* numbers = rows[plan.RowOf(half->corner)].data() + plan.ColumnOf(half->corner);
    numbers[half->second ? plan.width : 0] += body.drag / Real(6);
    numbers[2 * plan.width] = half->cut ? Real(1) : Real(0);
  }
  for (const std::vector<Real>& row : rows) plan.coefficients.squareRows.push_back(pool.Keep(row));
  return true;
}

template <class Real>
bool HasDrag(const Coefficients<Real>& body) {
  return body.drag > Real(0) && !body.faces.empty();
}

template <class Real>
GridPlan<Real> LayOut(const Coefficients<Real>& body, const GridShape& shape, std::uint32_t rowLength) {
  GridPlan<Real> plan;
  plan.columns = rowLength;
  plan.rows = static_cast<std::uint32_t>(shape.CountVertices()) / rowLength;
  plan.width = RoundUp(rowLength, GridLine<Real>::kNumbers);
  plan.planar = body.planar;
  plan.hasDrag = HasDrag(body);
  plan.hingeFloorSquare = body.hingeFloorSquare;
  return plan;
}

template <class Real>
void FillMasses(const Coefficients<Real>& body, GridPlan<Real>& plan) {
  plan.inverseMasses.resize(plan.rows * plan.width / GridLine<Real>::kNumbers);
  for (std::size_t vertex = 0; vertex < body.inverseMasses.size(); ++vertex) {
    NumbersOf(plan.inverseMasses)[plan.RowOf(vertex) * plan.width + plan.ColumnOf(vertex)] = body.inverseMasses[vertex];
  }
}

}  // namespace

template <class Real>
GridPlan<Real> MakeGridPlan(const Coefficients<Real>& body, const GridShape& shape) {
  if (shape.columns == 0 || shape.CountVertices() != body.masses.size()) return {};
  if (body.gas > Real(0) || body.repulsion > Real(0)) return {};
  const bool hasDrag = HasDrag(body);
  if (hasDrag && (shape.layers > 1 || shape.columns < 2)) return {};
  GridPlan<Real> plan;
  for (const std::uint32_t length :
       {shape.columns * shape.rows * shape.layers, shape.columns * shape.rows, shape.columns}) {
    plan = LayOut(body, shape, length);
    if (!FillDirections(body, shape, plan)) return {};
    if (plan.pendingSize * sizeof(Real) <= kMaxPending) break;
  }
  RowPool<Real> pool(plan.coefficients.numbers);
  if (!FillSprings(body, plan, pool) || !FillHingeRows(body, plan, pool)) return {};
  if (hasDrag && !FillSquares(body, shape, plan, pool)) return {};
  FillMasses(body, plan);
  return plan;
}

template <class Real>
void RemoveTorn(const GridPlan<Real>& plan, const Coefficients<Real>& body, std::span<const std::uint8_t> torn,
                GridRows<Real>& rows) {
  rows = plan.coefficients;
  const std::size_t lines = 3 * plan.width / GridLine<Real>::kNumbers;
  for (std::size_t i = 0; i < torn.size(); ++i) {
    if (torn[i] == 0) continue;
    const std::uint32_t first = std::min(body.springs[i].a, body.springs[i].b);
    const std::uint32_t direction = FindDirection(plan, FindWay(plan, body.springs[i]));
    std::uint32_t& row = rows.springRows[plan.RowOf(first) * plan.directions.size() + direction];
    if (row < plan.coefficients.numbers.size() * GridLine<Real>::kNumbers) {  // still the shared row: copy it
      const std::size_t line = row / GridLine<Real>::kNumbers;
      row = static_cast<std::uint32_t>(rows.numbers.size() * GridLine<Real>::kNumbers);
      rows.numbers.resize(rows.numbers.size() + lines);
      std::copy_n(rows.numbers.begin() + line, lines, rows.numbers.end() - lines);
    }
    Real* numbers = NumbersOf(rows.numbers) + row + plan.ColumnOf(first);
    for (std::size_t k = 0; k < 3; ++k) numbers[k * plan.width] = 0;
  }
}

#define WOBBLE_INSTANTIATE(Real)                                                                                  \
  template GridPlan<Real> MakeGridPlan<Real>(const Coefficients<Real>&, const GridShape&);                        \
  template void RemoveTorn<Real>(const GridPlan<Real>&, const Coefficients<Real>&, std::span<const std::uint8_t>, \
                                 GridRows<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
