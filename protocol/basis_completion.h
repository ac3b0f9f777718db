// Completes a few orthonormal vectors to a basis of the whole space, to the same bits on every machine.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace wobble::protocol {

// given: orthonormal modes of `rows` numbers each, mode after mode, fewer than rows. order: a permutation of the rows.
// Returns the rows − given modes that complete them, orthonormal and orthogonal to the given ones, row after row of the
// permuted order: entry (row i of the order, mode j) is at i · count + j.
[[nodiscard]] std::vector<double> CompleteBasis(std::span<const double> given, std::size_t rows,
                                                std::span<const std::size_t> order);

// Makes vectors of `rows` numbers each, stored vector after vector, orthonormal in place (modified Gram–Schmidt). False
// when one of them is nearly spanned by those before it.
[[nodiscard]] bool Orthonormalise(std::span<double> vectors, std::size_t rows);

// The cosine basis (DCT-II) of a grid of nx · ny · nz points: that many squared numbers, mode after mode, modes by
// ascending frequency.
[[nodiscard]] std::vector<double> MakeCosines(std::size_t nx, std::size_t ny, std::size_t nz);

}  // namespace wobble::protocol
