// Sums, products, quotients and square roots of doubles in one fixed order: IEEE 754 defines each result exactly, so
// all clients get the same bits. Sums run over rows in ascending order; the inner loops run over columns, which the
// compiler may vectorise without changing any of them. Gram–Schmidt on unit vectors would be simpler, but its last
// vectors would consist of rounding errors.
#include "protocol/codec/basis_completion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "protocol/heap_sort.h"

namespace wobble::protocol {

Completion::Completion(std::span<const double> given, std::size_t rows, std::span<const std::size_t> order)
    : m_rows(rows), m_modes(given.size() / rows), m_work(given.size()), m_dots(m_modes) {
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t k = 0; k < m_modes; ++k) m_work[i * m_modes + k] = given[k * rows + order[i]];
  }
}

void Completion::Reflect(const Reflection& reflection, std::size_t columns, double* matrix, double* dots) {
  double* const begin = matrix + reflection.first * columns;
  std::fill_n(dots, columns, 0.0);
  for (std::size_t i = 0; i < reflection.v.size(); ++i) {
    const double v = reflection.v[i];
    for (std::size_t j = 0; j < columns; ++j) dots[j] += v * begin[i * columns + j];
  }
  for (std::size_t j = 0; j < columns; ++j) dots[j] *= reflection.factor;
  for (std::size_t i = 0; i < reflection.v.size(); ++i) {
    const double v = reflection.v[i];
    for (std::size_t j = 0; j < columns; ++j) begin[i * columns + j] -= v * dots[j];
  }
}

void Completion::ReflectPanel(std::size_t number, std::size_t stride, double* panel) const {
  const Reflection& reflection = m_reflections[number];
  double* const begin = panel + reflection.first * stride;
  const std::size_t rows = reflection.v.size();
  HalfRow low{}, high{};
  for (std::size_t i = 0; i < rows; ++i) {
    const double* const row = begin + i * stride;
    low += reflection.v[i] * LoadHalf(row);
    high += reflection.v[i] * LoadHalf(row + kHalfPanel);
  }
  low *= reflection.factor;
  high *= reflection.factor;
  for (std::size_t i = 0; i < rows; ++i) {
    double* const row = begin + i * stride;
    StoreHalf(LoadHalf(row) - reflection.v[i] * low, row);
    StoreHalf(LoadHalf(row + kHalfPanel) - reflection.v[i] * high, row + kHalfPanel);
  }
}

// The reflection that turns column `first`, from row `first` on, into a multiple of the first unit vector.
bool Completion::MakeReflection() {
  if (m_reflections.size() == m_modes) return false;
  Reflection reflection;
  reflection.first = m_reflections.size();
  reflection.v.reserve(m_rows - reflection.first);
  double square = 0;
  for (std::size_t i = reflection.first; i < m_rows; ++i) {
    const double x = m_work[i * m_modes + reflection.first];
    reflection.v.push_back(x);
    square += x * x;
  }
  const double length = std::sqrt(square);
  reflection.v[0] += reflection.v[0] < 0 ? -length : length;
  double vv = 0;
  for (const double v : reflection.v) vv += v * v;
  reflection.factor = vv > 0 ? 2 / vv : 0;
  Reflect(reflection, m_modes, m_work.data(), m_dots.data());
  m_reflections.push_back(std::move(reflection));
  return true;
}

void Completion::BeginPanel(std::size_t first, std::size_t stride, double* panel) const {
  for (std::size_t i = 0; i < m_rows; ++i) {
    for (std::size_t j = 0; j < kPanel; ++j) panel[i * stride + j] = i == m_modes + first + j ? 1 : 0;
  }
}

std::array<double, kPanel> MultiplyPanel(std::span<const double> row, std::span<const double> matrix) {
  HalfRow low{}, high{};
  for (std::size_t j = 0; j < row.size(); ++j) {
    low += row[j] * LoadHalf(matrix.data() + j * kPanel);
    high += row[j] * LoadHalf(matrix.data() + j * kPanel + kHalfPanel);
  }
  std::array<double, kPanel> sums;
  StoreHalf(low, sums.data());
  StoreHalf(high, sums.data() + kHalfPanel);
  return sums;
}

std::vector<double> CompleteBasis(std::span<const double> given, std::size_t rows, std::span<const std::size_t> order) {
  Completion completion(given, rows, order);
  while (completion.MakeReflection()) continue;
  const std::size_t rest = rows - given.size() / rows;
  std::vector<double> completed(rows * rest);
  std::vector<double> panel(rows * kPanel);
  for (std::size_t first = 0; first < rest; first += kPanel) {
    completion.BeginPanel(first, kPanel, panel.data());
    for (std::size_t k = given.size() / rows; k-- > 0;) completion.ReflectPanel(k, kPanel, panel.data());
    const std::size_t columns = std::min(kPanel, rest - first);
    for (std::size_t i = 0; i < rows; ++i) {
      std::copy_n(panel.data() + i * kPanel, columns, completed.data() + i * rest + first);
    }
  }
  return completed;
}

bool OrthonormaliseNext(std::span<double> vectors, std::size_t rows, std::size_t begin) {
  constexpr double kSmallest = 1e-3;  // share of a vector's length that must be left
  const auto measure = [](std::span<const double> vector) {
    double square = 0;
    for (const double x : vector) square += x * x;
    return std::sqrt(square);
  };
  const std::span<double> vector = vectors.subspan(begin, rows);
  const double before = measure(vector);
  for (std::size_t other = 0; other < begin; other += rows) {
    const std::span<const double> unit = vectors.subspan(other, rows);
    double dot = 0;
    for (std::size_t i = 0; i < rows; ++i) dot += unit[i] * vector[i];
    for (std::size_t i = 0; i < rows; ++i) vector[i] -= dot * unit[i];
  }
  const double left = measure(vector);
  if (!(left > kSmallest * before)) return false;
  for (double& x : vector) x /= left;
  return true;
}

bool Orthonormalise(std::span<double> vectors, std::size_t rows) {
  for (std::size_t begin = 0; begin < vectors.size(); begin += rows) {
    if (!OrthonormaliseNext(vectors, rows, begin)) return false;
  }
  return true;
}

std::vector<double> MakeCosines(std::size_t nx, std::size_t ny, std::size_t nz) {
  const std::array<std::size_t, 3> counts{nx, ny, nz};
  std::array<std::vector<double>, 3> axes;  // mode · count + place
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t n = counts[axis];
    for (std::size_t m = 0; m < n; ++m) {
      const double scale = std::sqrt((m == 0 ? 1.0 : 2.0) / static_cast<double>(n));
      for (std::size_t i = 0; i < n; ++i) {
        const double angle = std::numbers::pi * static_cast<double>(m * (2 * i + 1)) / static_cast<double>(2 * n);
        axes[axis].push_back(scale * std::cos(angle));
      }
    }
  }
  // Frequencies as integers, so that equal ones keep the order of their numbers: (m/n)² times (nx ny nz)².
  const std::size_t rows = nx * ny * nz;
  const auto frequency = [&](std::size_t mode) {
    const std::uint64_t a = mode % nx * ny * nz, b = mode / nx % ny * nx * nz, c = mode / (nx * ny) * nx * ny;
    return a * a + b * b + c * c;
  };
  std::vector<std::size_t> modes(rows);
  std::iota(modes.begin(), modes.end(), std::size_t{0});
  const auto isBefore = [&](std::size_t a, std::size_t b) {
    return frequency(a) != frequency(b) ? frequency(a) < frequency(b) : a < b;
  };
  HeapSort(modes, isBefore);
  std::vector<double> cosines;
  cosines.reserve(rows * rows);
  for (const std::size_t mode : modes) {
    const double* x = axes[0].data() + mode % nx * nx;
    const double* y = axes[1].data() + mode / nx % ny * ny;
    const double* z = axes[2].data() + mode / (nx * ny) * nz;
    for (std::size_t row = 0; row < rows; ++row) {
      cosines.push_back(x[row % nx] * y[row / nx % ny] * z[row / (nx * ny)]);
    }
  }
  return cosines;
}

}  // namespace wobble::protocol
