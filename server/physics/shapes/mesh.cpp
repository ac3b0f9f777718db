// Builds bodies from meshes. Gas pushes every vertex with f = (P − P₀) times its share of the area; springs of tension
// t pull with A t, where A holds the directions of the springs. Unlike on a sphere no common shortening of all springs
// balances the two: bumps would be pulled in and hollows blown out. So each spring gets a tension of its own: the
// solution of A t = −f that is nearest to even tensions (conjugate gradients on the normal equations; Hestenes &
// Stiefel 1952). A closed mesh has 3V − 6 sides, as many as there are equations, and its tensions would vary wildly;
// springs across each side double the unknowns, and the tensions become mild.
//
// Balance alone does not make a shape stable. It is pushed a little out of shape and must come to rest near where it
// was; where it comes to rest is the rest shape.
#include "server/physics/shapes/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "server/physics/contact/contact.h"
#include "server/physics/methods/forces.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"
#include "server/physics/shapes/relax.h"

namespace wobble::physics {
namespace {

constexpr int kSolverSteps = 400;
constexpr double kSolverTolerance = 1e-10;  // as a share of the gas's forces
constexpr double kKick = 1e-3;              // the push out of shape, as a share of the size
constexpr int kRelaxSteps = 20000;
constexpr double kRestTolerance = 1e-3;  // m/s²
// The largest change of a shape that comes to rest, as a share of its size.
constexpr double kMaxChange = 0.05;

using Edge = std::array<std::uint16_t, 2>;

Edge MakeEdge(std::uint16_t a, std::uint16_t b) { return {std::min(a, b), std::max(a, b)}; }

struct Frame {
  std::vector<Edge> sides;   // ascending
  std::vector<Edge> across;  // the two corners opposite a side, where no side joins them
  bool closed = true;
};

Frame FindFrame(std::span<const Face> faces) {
  std::map<Edge, std::vector<std::uint16_t>> opposite;
  for (const Face& face : faces) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      opposite[MakeEdge(face[(corner + 1) % 3], face[(corner + 2) % 3])].push_back(face[corner]);
    }
  }
  Frame frame;
  for (const auto& [side, corners] : opposite) {
    frame.sides.push_back(side);
    if (corners.size() != 2) {
      frame.closed = false;
    } else if (!opposite.contains(MakeEdge(corners[0], corners[1])) && corners[0] != corners[1]) {
      frame.across.push_back(MakeEdge(corners[0], corners[1]));
    }
  }
  std::ranges::sort(frame.across);
  frame.across.erase(std::unique(frame.across.begin(), frame.across.end()), frame.across.end());
  return frame;
}

// The equations A t = −f of the head of this file, for t/√(kℓ).
class Balance {
 public:
  Balance(const std::vector<Spring<double>>& springs, const std::vector<Vector3d>& x) : m_springs(springs) {
    for (const Spring<double>& spring : springs) {
      const Vector3d l = x[spring.a] - x[spring.b];
      m_weights.push_back(std::sqrt(spring.stiffness * l.norm()));
      m_directions.push_back(m_weights.back() * l.normalized());
    }
  }

  // r −= step · A t
  void SubtractForces(const std::vector<double>& tensions, double step, std::vector<Vector3d>& r) const {
    for (std::size_t i = 0; i < m_springs.size(); ++i) {
      const Vector3d force = step * tensions[i] * m_directions[i];
      r[m_springs[i].a] += force;
      r[m_springs[i].b] -= force;
    }
  }
  // Aᵀ r
  [[nodiscard]] std::vector<double> Project(const std::vector<Vector3d>& r) const {
    std::vector<double> projected;
    for (std::size_t i = 0; i < m_springs.size(); ++i) {
      projected.push_back(m_directions[i].dot(r[m_springs[i].b] - r[m_springs[i].a]));
    }
    return projected;
  }

  // Replaces `tensions`, N, by the solution of A t = −`gas` that is nearest to them.
  void Solve(const std::vector<Vector3d>& gas, std::vector<double>& tensions) const {
    for (std::size_t i = 0; i < tensions.size(); ++i) tensions[i] /= m_weights[i];
    std::vector<Vector3d> r;
    for (const Vector3d& force : gas) r.push_back(-force);
    const double enough = kSolverTolerance * kSolverTolerance * SumSquares(r);
    SubtractForces(tensions, 1, r);
    std::vector<double> s = Project(r);
    std::vector<double> direction = s;
    double gamma = std::inner_product(s.begin(), s.end(), s.begin(), 0.0);
    for (int step = 0; step < kSolverSteps && SumSquares(r) > enough && gamma > 0; ++step) {
      std::vector<Vector3d> moved(r.size(), Vector3d::Zero());
      SubtractForces(direction, -1, moved);
      const double alpha = gamma / SumSquares(moved);
      for (std::size_t i = 0; i < tensions.size(); ++i) tensions[i] += alpha * direction[i];
      for (std::size_t i = 0; i < r.size(); ++i) r[i] -= alpha * moved[i];
      s = Project(r);
      const double next = std::inner_product(s.begin(), s.end(), s.begin(), 0.0);
      for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = s[i] + next / gamma * direction[i];
      gamma = next;
    }
    for (std::size_t i = 0; i < tensions.size(); ++i) tensions[i] *= m_weights[i];
  }

 private:
  static double SumSquares(const std::vector<Vector3d>& values) {
    double sum = 0;
    for (const Vector3d& value : values) sum += value.squaredNorm();
    return sum;
  }

  const std::vector<Spring<double>>& m_springs;
  std::vector<double> m_weights;       // √(kℓ)
  std::vector<Vector3d> m_directions;  // unit vectors from b to a, times the weights
};

// Adds springs at their rest lengths, without tension.
Blueprint MakeSlack(const MeshDefinition& definition, const Frame& frame) {
  const Material& material = definition.material;
  const double vertexMass = material.mass / static_cast<double>(definition.vertices.size());
  const double damping = FindDamping(material.dampingRatio, material.stiffness, vertexMass);
  Blueprint mesh;
  mesh.name = definition.name;
  for (const Vector3d& x : definition.vertices) mesh.rest.push_back(definition.scale * x);
  mesh.full.masses.assign(mesh.rest.size(), vertexMass);
  mesh.full.faces = definition.faces;
  const auto add = [&](const Edge& edge, double share) {
    const double length = (mesh.rest[edge[0]] - mesh.rest[edge[1]]).norm();
    mesh.full.springs.push_back({.a = edge[0],
                                 .b = edge[1],
                                 .restLength = length,
                                 .stiffness = share * material.stiffness,
                                 .damping = share * damping});
  };
  for (const Edge& side : frame.sides) add(side, 1);
  for (const Edge& pair : frame.across) {
    if (definition.bend > 0) add(pair, definition.bend);
  }
  mesh.full.drag = material.drag;
  return mesh;
}

// Shortens the springs of a slack mesh until they hold the gas.
void Tighten(const MeshDefinition& definition, Blueprint& mesh) {
  const Material& material = definition.material;
  Coefficients<double>& full = mesh.full;
  full.gas = material.gas;
  full.ambientPressure = material.ambientPressure;
  mesh.gasDampingRatio = material.FindGasDampingRatio();
  std::vector<Vector3d> gas(mesh.rest.size(), Vector3d::Zero());
  AddGas<double>(full, 1, mesh.rest, gas);
  // Even tensions balance the virial of the springs, Σ k s ℓ², with that of the gas.
  double virial = 0;
  for (std::size_t i = 0; i < gas.size(); ++i) virial += gas[i].dot(mesh.rest[i]);
  double whole = 0;
  for (const Spring<double>& spring : full.springs) {
    whole += spring.stiffness * spring.restLength * spring.restLength;
  }
  std::vector<double> tensions;
  for (const Spring<double>& spring : full.springs) {
    tensions.push_back(virial / whole * spring.stiffness * spring.restLength);
  }
  Balance(full.springs, mesh.rest).Solve(gas, tensions);
  for (std::size_t i = 0; i < tensions.size(); ++i)
    full.springs[i].restLength -= tensions[i] / full.springs[i].stiffness;
}

void Kick(Blueprint& mesh) {
  const double way = kKick * mesh.size;
  for (std::size_t i = 0; i < mesh.rest.size(); ++i) {
    const auto phase = static_cast<double>(i);
    mesh.rest[i] += way * Vector3d(std::sin(1.3 * phase), std::cos(2.1 * phase), std::sin(0.7 * phase + 1));
  }
}

struct Built {
  Blueprint mesh;
  double longestShare = 0;  // the largest shortening of a spring, as a share of its length
  bool rests = true;
  double change = 0;  // RMS, as a share of the size
};

Built Build(const MeshDefinition& definition) {
  const Material& material = definition.material;
  const Frame frame = FindFrame(definition.faces);
  Built built{MakeSlack(definition, frame)};
  Blueprint& mesh = built.mesh;
  const bool hasGas = frame.closed && material.gas > 0;
  if (hasGas) {
    const std::vector<Spring<double>> slack = mesh.full.springs;
    Tighten(definition, mesh);
    for (std::size_t i = 0; i < slack.size(); ++i) {
      built.longestShare = std::max(built.longestShare, 1 - mesh.full.springs[i].restLength / slack[i].restLength);
    }
  }
  SetRepulsion(mesh, material.repulsion);
  FinishBlueprint(mesh);
  mesh.full.contact = MakeContactParameters(material, mesh.full.masses[0], mesh.size);
  if (hasGas && built.longestShare <= 1 - kMinRestShare) {
    const std::vector<Vector3d> before = mesh.rest;
    Kick(mesh);
    built.rests = RelaxRest(mesh, kRestTolerance, kRelaxSteps);
    double squares = 0;
    for (std::size_t i = 0; i < before.size(); ++i) squares += (mesh.rest[i] - before[i]).squaredNorm();
    built.change = std::sqrt(squares / static_cast<double>(before.size())) / mesh.size;
  }
  FinishBlueprint(mesh);
  if (hasGas && mesh.coreRadius > 0) SetAim(mesh);
  return built;
}

bool IsOnePiece(const MeshDefinition& d) {
  std::vector<std::size_t> root(d.vertices.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const Face& face : d.faces) {
    root[find(face[0])] = find(face[1]);
    root[find(face[1])] = find(face[2]);
  }
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (find(i) != find(0)) return false;
  }
  return true;
}

// Checks the faces and what follows from them; errors name `file`, the scene's one field for the whole mesh.
void CheckGeometry(std::vector<FieldError>& errors, const MeshDefinition& d) {
  const auto refuse = [&](const std::string& value, const std::string& range) {
    errors.push_back({"file", value, range});
  };
  if (d.faces.empty()) return refuse("no faces", "a mesh with at least one face");
  if (d.vertices.size() > kMaxMeshVertices) {
    return refuse(std::to_string(d.vertices.size()) + " vertices", "at most " + std::to_string(kMaxMeshVertices));
  }
  for (const MeshFault& fault : FindMeshFaults(d.vertices, d.faces)) {
    refuse("face " + std::to_string(fault.face + 1) + " " + fault.what, "a mesh whose faces join side by side");
  }
  if (!errors.empty()) return;
  if (!IsOnePiece(d)) return refuse("several pieces", "a mesh in one piece, every vertex on a face");
  const bool closed = FindFrame(d.faces).closed;
  if (closed && !(ComputeVolume<double>(d.faces, d.vertices) > 0)) {
    refuse("faces look inward", "a closed mesh whose faces are counter-clockwise seen from outside");
  }
  CheckField(errors, "gas", d.material.gas, closed || d.material.gas == 0, "0: the mesh is open");
  double reach = 0;
  for (const Vector3d& x : d.vertices) reach = std::max(reach, d.scale * (x - d.vertices[0]).norm());
  CheckField(errors, "scale", d.scale, reach >= 0.05 && reach <= 100, "what makes the mesh 0.05 to 100 m large");
}

}  // namespace

std::vector<FieldError> ValidateMesh(const MeshDefinition& d) {
  std::vector<FieldError> errors;
  const Material& m = d.material;
  CheckField(errors, "scale", d.scale, d.scale >= 1e-3 && d.scale <= 1e3, "0.001 to 1000");
  CheckField(errors, "bend", d.bend, d.bend >= 0 && d.bend <= 1, "0 to 1");
  CheckMaterial(errors, m);
  CheckGas(errors, m);
  CheckGeometry(errors, d);
  if (!errors.empty()) return errors;

  const double volume = d.scale * d.scale * d.scale * ComputeVolume<double>(d.faces, d.vertices);
  const double pressure = m.gas > 0 ? m.gas / volume - m.ambientPressure : 0;
  CheckField(errors, "gas", m.gas, pressure >= 0, "more, or ambient_pressure lower: the mesh would be crushed");
  if (!errors.empty()) return errors;
  const Built built = Build(d);
  const double most = (pressure * (1 - kMinRestShare) / built.longestShare + m.ambientPressure) * volume;
  CheckField(
      errors, "gas", m.gas, built.longestShare <= 1 - kMinRestShare,
      ("at most " + std::to_string(most) + " J for this mesh and stiffness, or its springs would vanish").c_str());
  CheckField(errors, "gas", m.gas, built.rests && built.change <= kMaxChange,
             "lower, or stiffness or bend higher: the mesh does not hold its shape against this gas");
  if (errors.empty()) CheckStiffness(errors, m, built.mesh);
  return errors;
}

Blueprint MakeMesh(const MeshDefinition& definition) { return Build(definition).mesh; }

}  // namespace wobble::physics
