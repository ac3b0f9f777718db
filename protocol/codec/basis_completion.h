// Completes a few orthonormal vectors to a basis of the whole space, to the same bits on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace wobble::protocol {

inline constexpr std::size_t kPanel = 8;  // modes
// Half a row of a panel: what fits a register of AVX2. (An extension of GCC and Clang, also for WebAssembly.) Plain
// loops over a row are vectorised along the rows instead, with more shuffles than sums.
inline constexpr std::size_t kHalfPanel = kPanel / 2;
using HalfRow = double __attribute__((vector_size(kHalfPanel * sizeof(double))));
inline HalfRow LoadHalf(const double* from) {
  HalfRow half;
  std::memcpy(&half, from, sizeof half);
  return half;
}
inline void StoreHalf(const HalfRow& half, double* to) { std::memcpy(to, &half, sizeof half); }

// The modes that complete the given ones: orthonormal, and orthogonal to these. There are rows − given of them. They
// are made a panel at a time, so that a program that also draws can do it between frames, and because a panel stays in
// the cache through all reflections (a tenth of the time of all modes at once).
class Completion {
 public:
  // given: orthonormal modes of `rows` numbers each, mode after mode, fewer than rows. order: a permutation of the
  // rows.
  Completion(std::span<const double> given, std::size_t rows, std::span<const std::size_t> order);

  // False once all reflections are made; call it until then. Cost: 2 · rows · given multiplications.
  [[nodiscard]] bool MakeReflection();
  // Modes first … first + kPanel − 1, zeros from rows − given on: row i of the order, mode first + j is written to
  // panel[i · stride + j]. Call BeginPanel, then ReflectPanel for each number from given − 1 down to 0. Cost of
  // each: 2 · rows · kPanel multiplications.
  void BeginPanel(std::size_t first, std::size_t stride, double* panel) const;
  void ReflectPanel(std::size_t number, std::size_t stride, double* panel) const;

 private:
  // x − 2 v (v·x)/(v·v) for every column x of a matrix. v begins at row `first`.
  struct Reflection {
    std::size_t first = 0;
    std::vector<double> v;
    double factor = 0;  // 2/(v·v)
  };
  static void Reflect(const Reflection& reflection, std::size_t columns, double* matrix, double* dots);

  std::size_t m_rows;
  std::size_t m_modes;
  std::vector<double> m_work;  // rows × modes, the given ones with their rows in order
  std::vector<double> m_dots;
  std::vector<Reflection> m_reflections;
};

// The product of a row of numbers with a matrix of as many rows and kPanel columns, row after row. Sums run over the
// numbers from the first on, side by side.
[[nodiscard]] std::array<double, kPanel> MultiplyPanel(std::span<const double> row, std::span<const double> matrix);

// All modes that complete the given ones: row i of the order, mode j is at i · (rows − given) + j.
[[nodiscard]] std::vector<double> CompleteBasis(std::span<const double> given, std::size_t rows,
                                                std::span<const std::size_t> order);

// Makes the vector [begin, begin + rows) a unit vector orthogonal to those before it, which are so already (modified
// Gram–Schmidt). False when these nearly span it. Cost: 2 · begin multiplications.
[[nodiscard]] bool OrthonormaliseNext(std::span<double> vectors, std::size_t rows, std::size_t begin);
// All vectors of `rows` numbers each, stored vector after vector.
[[nodiscard]] bool Orthonormalise(std::span<double> vectors, std::size_t rows);

// The cosine basis (DCT-II) of a grid of nx · ny · nz points: that many squared numbers, mode after mode, modes by
// ascending frequency.
[[nodiscard]] std::vector<double> MakeCosines(std::size_t nx, std::size_t ny, std::size_t nz);

}  // namespace wobble::protocol
