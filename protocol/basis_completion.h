// An orthonormal basis of the whole space from a few of its vectors, the same on every machine to the last bit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace wobble::protocol {

// `given`: orthonormal modes of `rows` numbers each, mode after mode, fewer than rows.
// order: a permutation of the rows. Returns rows − given modes that are orthonormal and orthogonal to the given, row
// after row of the permuted order: entry (row i of the order, mode j) at i · count + j.
[[nodiscard]] std::vector<double> CompleteBasis(std::span<const double> given, std::size_t rows,
                                                std::span<const std::size_t> order);

// Makes vectors of `rows` numbers each, vector after vector, orthonormal one after the other (modified Gram–Schmidt).
// False when one is nearly spanned by those before it.
[[nodiscard]] bool Orthonormalise(std::span<double> vectors, std::size_t rows);

// The basis of cosines of a grid: (counts product)² numbers, mode after mode, modes by ascending frequency.
[[nodiscard]] std::vector<double> MakeCosines(std::size_t nx, std::size_t ny, std::size_t nz);

}  // namespace wobble::protocol
