// A small basis of each kind, for fuzz targets.
#pragma once

#include <array>
#include <memory>

#include "protocol/codec/basis_reader.h"

namespace wobble::fuzz {

// kind: 0 … 2; vertices: even. Levels vary, so that coefficients of all sizes occur.
inline std::shared_ptr<const protocol::Basis> MakeBasis(unsigned kind, std::size_t vertices) {
  using Kind = protocol::BasisSource::Kind;
  protocol::BasisSource source;
  source.kind = static_cast<Kind>(kind);
  source.vertices = static_cast<std::uint16_t>(vertices);
  source.grid = {static_cast<std::uint16_t>(vertices / 2), 2, 1};
  if (source.kind != Kind::kCosine) {
    const std::size_t rows = source.kind == Kind::kFull ? 3 * vertices : vertices;
    for (std::size_t i = 0; i < rows; ++i) source.modes.push_back(static_cast<std::int8_t>(i % 100 + 1));
    for (std::size_t i = 0; i < vertices; ++i) source.order.push_back(static_cast<std::uint16_t>(i));
  }
  for (std::size_t i = 0; i < 3 * vertices; ++i) {
    source.levels.push_back(static_cast<std::uint8_t>(40 + 37 * i % 200));
    source.gains.push_back(static_cast<std::int8_t>(29 * i % 255 - 127));
  }
  return protocol::ReadBasis(protocol::WriteBasis(source), vertices);
}

}  // namespace wobble::fuzz
