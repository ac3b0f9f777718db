// The module wobble._wobble, which wobble/__init__.py shows as `wobble`.
#include <cmath>

#include "protocol/version.h"
#include "server/library/python/binding.h"

namespace wobble::python {
namespace {

std::string DescribeShape(const Numbers& numbers) {
  return py::str(py::tuple(numbers.attr("shape"))).cast<std::string>();
}

void CheckFinite(const char* name, const Numbers& numbers) {
  // m, m/s, m/s², N; as in wobble_world.h.
  constexpr double kMost = 1e9;
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    if (std::abs(numbers.data()[i]) <= kMost) continue;
    throw py::value_error(std::string(name) + ": number " + std::to_string(i) + " is " +
                          std::to_string(numbers.data()[i]) + "; it must be finite and from -1e9 to 1e9");
  }
}

}  // namespace

void CheckVectors(const char* name, const Numbers& numbers, py::ssize_t rows) {
  const bool isGood = numbers.ndim() == 2 && numbers.shape(1) == 3 && (rows < 0 || numbers.shape(0) == rows);
  if (!isGood) {
    throw py::value_error(std::string(name) + " has shape " + DescribeShape(numbers) + "; it must be (" +
                          (rows < 0 ? "n" : std::to_string(rows)) + ", 3)");
  }
  CheckFinite(name, numbers);
}

void CheckVector(const char* name, const Numbers& numbers, py::ssize_t count) {
  if (numbers.ndim() != 1 || numbers.shape(0) != count) {
    throw py::value_error(std::string(name) + " has shape " + DescribeShape(numbers) + "; it must be (" +
                          std::to_string(count) + ",)");
  }
  CheckFinite(name, numbers);
}

}  // namespace wobble::python

PYBIND11_MODULE(_wobble, module) {
  module.attr("__version__") = wobble::kVersion;
  wobble::python::DefineWorlds(module);
  wobble::python::DefineClient(module);
  wobble::python::DefineProblems(module);
}
