// Sums of modes, each times its coefficient: the inner loop of the decoder, and half of what the encoder does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/basis.h"

namespace wobble::protocol {

class ModeSums {
 public:
  // sums[i] += Σ values[k] · basis.Column(k)[i], modulo 2^32, over all modes k. sums: of basis.Rows() numbers.
  void Add(const Basis& basis, std::span<const std::uint32_t> values, std::uint32_t* sums);

 private:
  // Two modes with values that fit int16.
  struct Term {
    const std::int16_t* pair;
    std::int16_t values[2];
  };
  void AddTerms(std::size_t rows, std::uint32_t* sums) const;

  std::vector<Term> m_terms;
};

// The same, a mode at a time. Add gives these bits.
void AddModesPlainly(const Basis& basis, std::span<const std::uint32_t> values, std::uint32_t* sums);

}  // namespace wobble::protocol
