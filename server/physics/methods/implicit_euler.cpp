// One sparse matrix a topology, in the natural order of the vertices: filled, factorised (LDLᵀ) and solved anew for
// each body and step. The gas is a correction of rank one to the solution.
#include "server/physics/methods/implicit_euler.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::physics {
namespace {

template <class Real>
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
template <class Real>
using VectorX = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
template <class Real>
using SparseMatrix = Eigen::SparseMatrix<Real, Eigen::ColMajor, int>;

constexpr std::size_t kSolversKept = 8;

// Eigen's factorize() allocates a matrix on every call, which it does not use in the natural order; this calls only the
// part that computes.
template <class Real>
struct InPlaceFactor : Eigen::SimplicialLDLT<SparseMatrix<Real>, Eigen::Upper, Eigen::NaturalOrdering<int>> {
  void Factorise(const SparseMatrix<Real>& matrix) { this->template factorize_preordered<true>(matrix); }
};

// d dᵀ
template <class Real>
Matrix3<Real> Square(const Vector3<Real>& d) {
  return d * d.transpose();
}

}  // namespace

// The matrix of one topology: filled, factorised and solved anew for each body and step.
template <class Real>
class ImplicitSolver {
 public:
  explicit ImplicitSolver(std::shared_ptr<const SparsePattern> pattern) : m_pattern(std::move(pattern)) {
    const auto size = static_cast<int>(3 * m_pattern->places.size());
    const std::vector<Real> ones(m_pattern->rows.size(), Real(1));
    m_matrix =
        Eigen::Map<const SparseMatrix<Real>>(size, size, static_cast<int>(m_pattern->rows.size()),
                                             m_pattern->columnBegins.data(), m_pattern->rows.data(), ones.data());
    m_factor.analyzePattern(m_matrix);
    for (VectorX<Real>* vector : {&m_right, &m_solution, &m_gradient, &m_gradientSolution}) vector->setZero(size);
    m_volumeGradient.resize(m_pattern->places.size());
  }

  [[nodiscard]] const SparsePattern* Pattern() const { return m_pattern.get(); }

  void Step(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> a, std::span<Vector3<Real>> x,
            std::span<Vector3<Real>> v) {
    m_body = &body.blueprint->template Read<Real>();
    Begin(h, a);
    AddSprings(h, body, x, v);
    AddContacts(h, body, x, v);
    Real softness = 0;
    if (m_body->gas > Real(0)) softness = AddGas(h, body, x, v);
    m_factor.Factorise(m_matrix);
    m_solution = m_factor.solve(m_right);
    if (softness > Real(0)) CorrectByGas(softness);
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] += m_solution.template segment<3>(RowOf(i));
      x[i] += h * v[i];
    }
  }

 private:
  [[nodiscard]] int RowOf(std::size_t vertex) const { return 3 * m_pattern->places[vertex]; }
  [[nodiscard]] bool IsFixed(std::size_t vertex) const { return !(m_body->inverseMasses[vertex] > Real(0)); }

  // A fixed vertex keeps its mass in its rows and nothing else: no acceleration, no change of velocity.
  void Begin(Real h, std::span<const Vector3<Real>> a) {
    std::fill_n(m_matrix.valuePtr(), m_matrix.nonZeros(), Real(0));
    for (std::size_t i = 0; i < a.size(); ++i) {
      AddToDiagonal(i, Matrix3<Real>::Identity() * m_body->masses[i]);
      m_right.template segment<3>(RowOf(i)) = (IsFixed(i) ? Real(0) : h * m_body->masses[i]) * a[i];
    }
  }

  void AddToDiagonal(std::size_t vertex, const Matrix3<Real>& block) {
    for (int column = 0; column < 3; ++column) {
      Real* values = m_matrix.valuePtr() + m_pattern->FindDiagonal(vertex, column);
      for (int row = 0; row <= column; ++row) values[row] += block(row, column);
    }
  }

  // Adds symmetric stiffness and damping that act on one vertex. velocity: against what the vertex is tied to, m/s.
  void AddToVertex(Real h, std::size_t vertex, const Matrix3<Real>& stiffness, const Matrix3<Real>& damping,
                   const Vector3<Real>& velocity) {
    if (IsFixed(vertex)) return;
    AddToDiagonal(vertex, h * h * stiffness + h * damping);
    m_right.template segment<3>(RowOf(vertex)) -= h * h * (stiffness * velocity);
  }

  void AddSprings(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> x,
                  std::span<const Vector3<Real>> v) {
    for (std::size_t s = 0; s < m_body->springs.size(); ++s) {
      const Spring<Real>& spring = m_body->springs[s];
      const Vector3<Real> l = x[spring.a] - x[spring.b];
      const Real length = std::sqrt(l.dot(l));
      if (!(length > Real(0)) || IsTorn(body, s)) continue;
      const Matrix3<Real> along = Square<Real>(l / length);
      const Real sideways = std::max(Real(0), Real(1) - spring.restLength / length);
      const Real factor = body.load->stiffnessFactor;
      const Matrix3<Real> stiffness =
          factor * spring.stiffness * (along + sideways * (Matrix3<Real>::Identity() - along));
      const Matrix3<Real> damping = factor * spring.damping * along;
      const Vector3<Real> velocity = v[spring.a] - v[spring.b];
      AddToVertex(h, spring.a, stiffness, damping, velocity);
      AddToVertex(h, spring.b, stiffness, damping, -velocity);
      if (IsFixed(spring.a) || IsFixed(spring.b)) continue;
      const Matrix3<Real> block = h * h * stiffness + h * damping;
      for (int column = 0; column < 3; ++column) {
        Real* values = m_matrix.valuePtr() + m_pattern->pairBlocks[s][static_cast<std::size_t>(column)];
        for (int row = 0; row < 3; ++row) values[row] -= block(row, column);
      }
    }
  }

  void AddContacts(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v) {
    for (const Contact<Real>& contact : body.contacts) {
      const ContactStiffness<Real> at =
          FindContactStiffness<Real>(m_body->contact, m_body->contactShares, body.surfaces, contact, x, v);
      const Matrix3<Real> along = Square<Real>(at.normal);
      const Matrix3<Real> across = Matrix3<Real>::Identity() - along;
      AddToVertex(h, contact.vertex, at.stiffness * along + at.stickStiffness * across,
                  at.damping * along + at.stickDamping * across, v[contact.vertex]);
    }
  }

  // Fills in the gradient of the volume and adds its part of the right side. Returns σ = −h² dP/dV of the term
  // σ ∇V ∇Vᵀ, which is not in the matrix; P is ComputePressure's, constant below zero volume.
  Real AddGas(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> x,
              std::span<const Vector3<Real>> v) {
    for (Vector3<Real>& g : m_volumeGradient) g.setZero();
    for (const Face& face : m_body->faces) {
      const Vector3<Real> origin = x[face[0]];
      const Vector3<Real> third = (x[face[1]] - origin).cross(x[face[2]] - origin) / Real(6);
      for (const std::uint16_t vertex : face) m_volumeGradient[vertex] += third;
    }
    Real growth = 0;  // of the volume, m³/s
    for (std::size_t i = 0; i < x.size(); ++i) growth += m_volumeGradient[i].dot(v[i]);
    const Real volume = ComputeVolume<Real>(m_body->faces, x);
    const Real bounded = std::max(volume, m_body->floorVolume);
    const Real fall = volume > Real(0) ? body.load->gasFactor * m_body->gas / (bounded * bounded) : Real(0);
    const Real softness = h * h * fall;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const int row = RowOf(i);
      m_gradient.template segment<3>(row) = (IsFixed(i) ? Real(0) : Real(1)) * m_volumeGradient[i];
      m_right.template segment<3>(row) -= softness * growth * m_gradient.template segment<3>(row);
    }
    return softness;
  }

  // (B + σ g gᵀ)⁻¹ r = y − w σ (g·y)/(1 + σ g·w), with B y = r and B w = g. Sums in the vertices' order.
  void CorrectByGas(Real softness) {
    m_gradientSolution = m_factor.solve(m_gradient);
    Real ofSolution = 0;
    Real ofGradient = 0;
    for (Eigen::Index i = 0; i < m_gradient.size(); ++i) {
      ofSolution += m_gradient[i] * m_solution[i];
      ofGradient += m_gradient[i] * m_gradientSolution[i];
    }
    m_solution -= m_gradientSolution * (softness * ofSolution / (Real(1) + softness * ofGradient));
  }

  std::shared_ptr<const SparsePattern> m_pattern;
  const Coefficients<Real>* m_body = nullptr;  // during Step
  SparseMatrix<Real> m_matrix;
  InPlaceFactor<Real> m_factor;
  VectorX<Real> m_right;
  VectorX<Real> m_solution;
  VectorX<Real> m_gradient;
  VectorX<Real> m_gradientSolution;
  std::vector<Vector3<Real>> m_volumeGradient;
};

namespace {

template <class Real>
ImplicitSolver<Real>& FindSolver(const std::shared_ptr<const SparsePattern>& pattern, ImplicitScratch<Real>& scratch) {
  for (const auto& solver : scratch.solvers) {
    if (solver->Pattern() == pattern.get()) return *solver;
  }
  auto made = std::make_shared<ImplicitSolver<Real>>(pattern);
  if (scratch.solvers.size() < kSolversKept) return *scratch.solvers.emplace_back(std::move(made));
  auto& replaced = scratch.solvers[scratch.oldest];
  scratch.oldest = (scratch.oldest + 1) % kSolversKept;
  return *(replaced = std::move(made));
}

}  // namespace

template <class Real>
void StepImplicitEuler(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> a,
                       std::span<Vector3<Real>> x, std::span<Vector3<Real>> v, ImplicitScratch<Real>& scratch) {
  assert(body.blueprint->sparsePattern != nullptr);
  FindSolver<Real>(body.blueprint->sparsePattern, scratch).Step(h, body, a, x, v);
}

#define WOBBLE_INSTANTIATE(Real)                                                                        \
  template class ImplicitSolver<Real>;                                                                  \
  template void StepImplicitEuler<Real>(Real, const SteppedBody<Real>&, std::span<const Vector3<Real>>, \
                                        std::span<Vector3<Real>>, std::span<Vector3<Real>>, ImplicitScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
