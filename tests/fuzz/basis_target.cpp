// A serialised basis: the first byte chooses the number of vertices (1 to 16), the others are read.
//
// Beyond memory safety: a basis that is accepted is nearly orthonormal, whatever modes and matrices were sent.
#include "protocol/codec/basis_reader.h"

#include <cmath>

#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

void FuzzOne(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const std::size_t vertices = 1 + bytes[0] % 16;
  const auto basis = protocol::ReadBasis(bytes.subspan(1), vertices);
  if (basis == nullptr) return;
  const std::size_t rows = basis->Rows();
  Require(basis->columns.size() == rows * rows);
  Require(basis->levels.size() == 3 * vertices && basis->gains.size() == 3 * vertices);
  for (std::size_t k = 0; k < rows; ++k) {
    double square = 0;
    for (const std::int16_t entry : basis->Column(k)) square += double{1} * entry * entry;
    Require(std::fabs(square / 16384 / 16384 - 1) < 0.01);
  }
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
