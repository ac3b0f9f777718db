// Principal directions (Karhunen–Loève): the strongest eigenvectors of the departures' second moments, as many as fit.
// They are rounded to bytes first, and levels and gains are measured on the basis that both ends complete from these
// bytes, so that all numbers describe the basis as clients have it.
//
// Each mode follows a share of the departure that contact predicts along it, found by least squares. A full matrix in
// place of that diagonal saved another 0.25 bits per vertex, but would be as large as the basis.
#include "server/training/basis_training.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "protocol/codec/basis_completion.h"
#include "protocol/codec/basis_reader.h"
#include "protocol/random.h"
#include "protocol/snapshot.h"
#include "server/snapshots/capture.h"

namespace wobble::server {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using protocol::BasisSource;
using protocol::Vector3;

constexpr std::size_t kPlayers = 4;
constexpr double kPlayTime = 12, kLeadTime = 1, kTickHz = 60;  // s
constexpr double kUsualVertices = 162;                         // larger bodies play for a shorter time
// Approximate size of a block of completed modes; each block is turned by a matrix of its own.
constexpr std::size_t kBlockSize = 48;
// The least share of a mode's variance for which it follows contact: each mode that does costs the decoder 20 ns.
constexpr double kLeastWorth = 0.03;
// The most vibrations sent of a patch: more add little, and so blueprints of eight patches stay within their limit.
constexpr std::size_t kMostVibrations = 48;

// Finds the order in which vertices are completed: first `spread` vertices far from each other, as many as the modes
// need, then the others by halving their bounding box recursively.
std::vector<std::uint16_t> FindOrder(std::span<const Vector3> rest, std::size_t spread) {
  std::vector<std::uint16_t> order{0};
  std::vector<float> distances(rest.size(), std::numeric_limits<float>::max());
  while (order.size() < spread) {
    for (std::size_t i = 0; i < rest.size(); ++i) {
      distances[i] = std::min(distances[i], protocol::Length(rest[i] - rest[order.back()]));
    }
    order.push_back(
        static_cast<std::uint16_t>(std::max_element(distances.begin(), distances.end()) - distances.begin()));
  }
  std::vector<std::uint16_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t begin = order.size();
  for (std::uint16_t i = 0; i < rest.size(); ++i) {
    if (!std::binary_search(sorted.begin(), sorted.end(), i)) order.push_back(i);
  }
  const auto read = [&](std::uint16_t i, int axis) {
    return axis == 0 ? rest[i].x : axis == 1 ? rest[i].y : rest[i].z;
  };
  const auto halve = [&](const auto& self, std::size_t from, std::size_t to) -> void {
    if (to - from <= 4) return;
    int longest = 0;
    float length = -1;
    for (int axis = 0; axis < 3; ++axis) {
      float low = read(order[from], axis), high = low;
      for (std::size_t i = from; i < to; ++i) {
        low = std::min(low, read(order[i], axis));
        high = std::max(high, read(order[i], axis));
      }
      if (high - low > length) length = high - low, longest = axis;
    }
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(from), order.begin() + static_cast<std::ptrdiff_t>(to),
              [&](std::uint16_t a, std::uint16_t b) { return read(a, longest) < read(b, longest); });
    self(self, from, (from + to) / 2);
    self(self, (from + to) / 2, to);
  };
  halve(halve, begin, order.size());
  return order;
}

void AppendRounded(const VectorXd& mode, std::vector<std::int8_t>& modes) {
  const double scale = 127 / mode.cwiseAbs().maxCoeff();
  for (const double entry : mode) modes.push_back(static_cast<std::int8_t>(std::lround(entry * scale)));
}

std::size_t CountBlocks(std::size_t rest) { return std::clamp(rest / kBlockSize, std::size_t{1}, std::size_t{255}); }

std::size_t FindBytes(std::size_t vertices, std::size_t modes) {
  const std::size_t rest = 3 * vertices - modes, blocks = CountBlocks(rest);
  const std::size_t block = rest / blocks + 1;
  return 16 + 2 * vertices + modes * 3 * vertices + blocks * block * block / 2 + 6 * vertices;
}

// Adds the turns: the principal directions of each block of the completed modes.
void AddTurns(const MatrixXd& departure, BasisSource& source) {
  const auto rows = static_cast<std::size_t>(departure.rows());
  std::vector<double> given(source.modes.begin(), source.modes.end());
  if (!protocol::Orthonormalise(given, rows)) return;
  std::vector<std::size_t> rowOrder;
  for (const std::uint16_t vertex : source.order) {
    for (std::size_t axis = 0; axis < 3; ++axis) rowOrder.push_back(3 * std::size_t{vertex} + axis);
  }
  const std::vector<double> completed = protocol::CompleteBasis(given, rows, rowOrder);
  const std::size_t rest = completed.size() / rows;
  MatrixXd modes(departure.rows(), static_cast<Index>(rest));
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < rest; ++j) {
      modes(static_cast<Index>(rowOrder[i]), static_cast<Index>(j)) = completed[i * rest + j];
    }
  }
  source.blocks = static_cast<std::uint8_t>(CountBlocks(rest));
  for (std::size_t block = 0; block < source.blocks; ++block) {
    const auto begin = static_cast<Index>(protocol::FindBlockBegin(rest, source.blocks, block));
    const auto size = static_cast<Index>(protocol::FindBlockBegin(rest, source.blocks, block + 1)) - begin;
    const auto part = modes.middleCols(begin, size);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(part.transpose() * departure * part));
    const MatrixXd turn = solver.eigenvectors().rowwise().reverse();
    const double scale = 7 * std::sqrt(static_cast<double>(size)) / 2.4;
    for (Index c = 0; c < size; ++c) {
      for (Index i = 0; i < size; ++i) {
        source.turns.push_back(static_cast<std::int8_t>(std::clamp(std::lround(turn(i, c) * scale), -7L, 7L)));
      }
    }
  }
}

// Adds level and gain of each coefficient of the basis as clients have it: its variance in play, and the share of the
// predicted departure that it follows.
void AddLevels(const BasisStatistics& statistics, BasisSource& source) {
  const std::size_t size = std::size_t{3} * source.vertices;
  source.levels.assign(size, 0);
  source.gains.assign(size, 0);
  const auto basis = protocol::ReadBasis(protocol::WriteBasis(source), source.vertices);
  MatrixXd modes = MatrixXd::Zero(static_cast<Index>(size), static_cast<Index>(size));
  for (std::size_t k = 0; k < size; ++k) {
    const auto column = basis->Column(basis->isScalar ? k / 3 : k);
    for (std::size_t i = 0; i < column.size(); ++i) {
      const std::size_t row = basis->isScalar ? 3 * i + k % 3 : i;
      modes(static_cast<Index>(row), static_cast<Index>(k)) = column[i] / 16384.0;
    }
  }
  const auto along = [&](const MatrixXd& moments) {
    return VectorXd(modes.cwiseProduct(moments * modes).colwise().sum().transpose());
  };
  const VectorXd departure = along(statistics.departure);
  const VectorXd both = along(statistics.departureByContact);
  const VectorXd contact = along(statistics.contact);
  for (std::size_t k = 0; k < size; ++k) {
    const auto i = static_cast<Index>(k);
    const bool isWorth = both[i] * both[i] > kLeastWorth * departure[i] * contact[i];
    const double gain = isWorth ? std::clamp(std::round(64 * both[i] / contact[i]), -127.0, 127.0) : 0;
    const double share = gain / 64;
    const double left = std::max(departure[i] - 2 * share * both[i] + share * share * contact[i], 1e-14);
    source.gains[k] = static_cast<std::int8_t>(gain);
    source.levels[k] =
        static_cast<std::uint8_t>(std::clamp(std::lround(4 * std::log2(left)) + protocol::kLevelZero, 0L, 255L));
  }
}

std::vector<std::uint8_t> TrainFrom(std::span<const Vector3> rest, const BasisStatistics& statistics) {
  BasisSource source;
  source.vertices = static_cast<std::uint16_t>(rest.size());
  std::size_t modes = 3 * rest.size() - 1;
  while (FindBytes(rest.size(), modes) > protocol::kMaxBasisBytes) --modes;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(statistics.departure);
  const Index last = statistics.departure.cols() - 1;
  for (std::size_t k = 0; k < modes; ++k) {
    AppendRounded(solver.eigenvectors().col(last - static_cast<Index>(k)), source.modes);
  }
  source.order = FindOrder(rest, (modes + 2) / 3);
  AddTurns(statistics.departure, source);
  AddLevels(statistics, source);
  return protocol::WriteBasis(source);
}

std::vector<std::uint8_t> MakeCosineBasis(const BasisStatistics& statistics, std::size_t columns, std::size_t rows,
                                          std::size_t layers) {
  BasisSource source;
  source.kind = BasisSource::Kind::kCosine;
  source.vertices = static_cast<std::uint16_t>(columns * rows * layers);
  source.grid = {static_cast<std::uint16_t>(columns), static_cast<std::uint16_t>(rows),
                 static_cast<std::uint16_t>(layers)};
  AddLevels(statistics, source);
  return protocol::WriteBasis(source);
}

// A basis of the eigenvectors of the Laplacian of the springs, and of the edges of tetrahedra, within the patch, lowest
// frequency first.
std::vector<std::uint8_t> MakeVibrationBasis(const physics::Blueprint& blueprint, std::span<const Vector3> rest,
                                             std::size_t first, const BasisStatistics& statistics) {
  const auto size = static_cast<Index>(rest.size());
  MatrixXd laplacian = MatrixXd::Zero(size, size);
  const auto join = [&](std::size_t one, std::size_t other) {
    if (one < first || other < first) return;
    const auto a = static_cast<Index>(one - first), b = static_cast<Index>(other - first);
    if (a >= size || b >= size) return;
    laplacian(a, b) -= 1;
    laplacian(b, a) -= 1;
    laplacian(a, a) += 1;
    laplacian(b, b) += 1;
  };
  for (const physics::Spring<double>& spring : blueprint.full.springs) join(spring.a, spring.b);
  for (const physics::Tetrahedron<double>& element : blueprint.full.tetrahedra) {
    for (std::size_t i = 1; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) join(element.vertices[i], element.vertices[j]);
    }
  }
  BasisSource source;
  source.kind = BasisSource::Kind::kScalar;
  source.vertices = static_cast<std::uint16_t>(rest.size());
  const std::size_t modes = std::min(kMostVibrations, rest.size() - 1);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(laplacian);
  for (std::size_t k = 0; k < modes; ++k) {
    AppendRounded(solver.eigenvectors().col(static_cast<Index>(k)), source.modes);
  }
  source.order = FindOrder(rest, std::max(modes, std::size_t{1}));
  AddLevels(statistics, source);
  return protocol::WriteBasis(source);
}

physics::Obstacle MakeBox(const physics::Vector3d& centre, const physics::Vector3d& half) {
  physics::Obstacle box;
  box.kind = physics::Obstacle::Kind::kBox;
  box.centre = centre;
  box.halfExtents = half;
  return box;
}

// Adds a floor and four walls, each `half` metres from the middle.
void AddRoom(double half, physics::World& world) {
  world.AddObstacle(MakeBox({0, 0, -1}, {half + 1, half + 1, 1}));
  for (const double side : {-1.0, 1.0}) {
    for (const bool alongX : {true, false}) {
      const physics::Vector3d direction = alongX ? physics::Vector3d::UnitX() : physics::Vector3d::UnitY();
      physics::Obstacle wall = MakeBox(side * (half + 0.5) * direction + physics::Vector3d(0, 0, half),
                                       physics::Vector3d(half + 1, half + 1, half + 1));
      wall.halfExtents[alongX ? 0 : 1] = 0.5;
      wall.friction = 0.2;
      world.AddObstacle(wall);
    }
  }
}

// Chooses the controls of four players: each moves towards another one or away from it, with occasional jumps and
// puffs, and chooses anew after 8 to 38 ticks.
class Chase {
 public:
  explicit Chase(std::uint64_t seed) : m_random(seed) {}

  physics::Control Choose(std::size_t player, int tick, std::span<const physics::Vector3d> centres) {
    physics::Control& control = m_controls[player];
    if (tick < m_until[player]) {
      control.jump = control.jump && tick % 16 != 0;
      return control;
    }
    const auto other = static_cast<std::size_t>(m_random.NextShare() * (kPlayers - 1));
    physics::Vector3d way = centres[(player + 1 + other) % kPlayers] - centres[player];
    way.z() = 0;
    way /= std::max(way.norm(), 1e-6);
    if (m_random.NextShare() < 0.25) way = -way;
    control.moveX = way.x();
    control.moveY = way.y();
    control.jump = m_random.NextShare() < 0.35;
    control.puff = m_random.NextShare() < 0.1;
    m_until[player] = tick + 8 + static_cast<int>(30 * m_random.NextShare());
    return control;
  }

 private:
  protocol::Random m_random;
  std::array<physics::Control, kPlayers> m_controls{};
  std::array<int, kPlayers> m_until{};
};

}  // namespace

RecordedPlay RecordPlay(const physics::Blueprint& blueprint, const physics::Vector3d& gravity,
                        const physics::ControlLimits& limits, std::uint64_t seed) {
  physics::WorldSettings settings;
  settings.gravity = gravity;
  settings.tickDuration = 1 / kTickHz;
  physics::World world(settings);
  static_cast<void>(world.AddBlueprint(blueprint));
  const double reach = std::max(blueprint.reach, physics::kMinSize);
  AddRoom(4 * reach, world);
  std::vector<physics::BodyId> ids;
  for (std::size_t i = 0; i < kPlayers; ++i) {
    const double x = i % 2 == 0 ? -1.4 : 1.4, y = i < 2 ? -1.4 : 1.4;
    ids.push_back(world.AddBody(0, reach * physics::Vector3d(x, y, 1.3 + 0.3 * static_cast<double>(i))));
  }
  RecordedPlay play;
  play.obstacles = CaptureObstacles(world.Obstacles());
  Chase chase(seed);
  std::vector<CapturedBody> captured(kPlayers);
  std::vector<physics::Vector3d> centres(kPlayers);
  // Larger bodies play for a shorter time, because the cost of a tick grows with their vertices.
  const double shorter = std::min(1.0, kUsualVertices / static_cast<double>(blueprint.rest.size()));
  const int lead = static_cast<int>(kLeadTime * kTickHz);
  const int ticks = lead + static_cast<int>(kPlayTime * shorter * kTickHz) + 2;
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < kPlayers; ++i) centres[i] = world.FindCentre(world.ReadBody(ids[i]));
    for (std::size_t i = 0; i < kPlayers; ++i) world.SetControl(ids[i], chase.Choose(i, tick, centres), limits);
    static_cast<void>(world.Step());
    if (tick < lead || tick % 2 == 0) continue;
    for (std::size_t i = 0; i < kPlayers; ++i) {
      CaptureBody(world, world.ReadBody(ids[i]), captured[i]);
      play.frames.push_back({captured[i].pose, captured[i].vertices});
    }
  }
  return play;
}

std::vector<std::uint8_t> TrainBasis(std::span<const Vector3> rest, const RecordedPlay& play) {
  return TrainFrom(rest, MeasurePlay(play, rest, 0));
}

Bases TrainBases(const physics::Blueprint& blueprint, const RecordedPlay& play) {
  const std::vector<Vector3> rest = CaptureBlueprint(blueprint).rest;
  const physics::GridShape& grid = blueprint.grid;
  Bases bases;
  if (rest.size() < 2 || play.frames.empty()) return bases;
  for (std::size_t first = 0; first < rest.size(); first += protocol::kMaxPatchVertices) {
    const auto part =
        std::span(rest).subspan(first, protocol::PatchSize(rest.size(), first / protocol::kMaxPatchVertices));
    const BasisStatistics statistics = MeasurePlay(play, part, first);
    const bool isGrid = grid.columns > 0 && grid.CountVertices() == rest.size();
    if (isGrid && part.size() == rest.size()) {
      bases.push_back(MakeCosineBasis(statistics, grid.columns, grid.rows, grid.layers));
    } else if (isGrid && grid.layers == 1 && protocol::kMaxPatchVertices % grid.columns == 0) {
      bases.push_back(MakeCosineBasis(statistics, grid.columns, part.size() / grid.columns, 1));
    } else if (rest.size() <= protocol::kMaxTrainedVertices) {
      bases.push_back(TrainFrom(part, statistics));
    } else {
      bases.push_back(MakeVibrationBasis(blueprint, part, first, statistics));
    }
  }
  return bases;
}

}  // namespace wobble::server
