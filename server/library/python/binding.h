// What the files of the Python module share. They stand on the interfaces for C, which check what they are given, and
// on what is behind these where that is less work.
//
// Threads: a call releases Python's lock (GIL) for as long as it computes or waits, and a world or client lets in one
// call at a time. No call waits for a world with Python's lock in its hand.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <mutex>
#include <string>

namespace wobble::python {

namespace py = pybind11;

void DefineWorlds(py::module_& module);
void DefineClient(py::module_& module);
void DefineProblems(py::module_& module);

// Any array or nested sequence of numbers.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Throws ValueError, which names the argument, unless it has `rows` rows of three finite numbers (-1: any number of
// rows).
void CheckVectors(const char* name, const Numbers& numbers, py::ssize_t rows = -1);
// The same for one row of so many numbers.
void CheckVector(const char* name, const Numbers& numbers, py::ssize_t count = 3);

// A copy of `rows` vectors in an array of Python's.
template <typename Number>
[[nodiscard]] py::array_t<Number> CopyRows(const Number* numbers, py::ssize_t rows, py::ssize_t columns = 3) {
  py::array_t<Number> copy({rows, columns});
  if (numbers != nullptr) std::copy_n(numbers, rows * columns, copy.mutable_data());
  return copy;
}

// Calls with Python's lock released, and with nobody else in what `turn` guards.
template <typename Call>
auto TakeTurn(std::mutex& turn, Call&& call) {
  const py::gil_scoped_release released;
  const std::lock_guard lock(turn);
  return call();
}

template <typename Struct>
[[nodiscard]] Struct MakeStruct() {
  Struct made{};
  made.struct_size = sizeof made;
  return made;
}

}  // namespace wobble::python
