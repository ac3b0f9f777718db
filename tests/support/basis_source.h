// Bases for tests, of random modes.
#pragma once

#include <cstdint>
#include <random>

#include "protocol/codec/basis.h"

namespace wobble::test {

using protocol::BasisSource;

inline BasisSource MakeBasisSource(BasisSource::Kind kind, std::size_t vertices, std::size_t modes,
                                   std::uint8_t blocks) {
  std::mt19937 random(7);
  BasisSource source;
  source.kind = kind;
  source.vertices = static_cast<std::uint16_t>(vertices);
  source.levels.assign(3 * vertices, 150);
  source.gains.assign(3 * vertices, -3);
  if (kind == BasisSource::Kind::kCosine) {
    source.grid = {static_cast<std::uint16_t>(vertices / 2), 2, 1};
    return source;
  }
  const std::size_t rows = kind == BasisSource::Kind::kFull ? 3 * vertices : vertices;
  for (std::size_t i = 0; i < modes * rows; ++i) {
    source.modes.push_back(static_cast<std::int8_t>(static_cast<int>(random() % 255) - 127));
  }
  for (std::size_t i = 0; i < vertices; ++i) source.order.push_back(static_cast<std::uint16_t>((5 * i) % vertices));
  source.blocks = blocks;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t rest = rows - modes;
    const std::size_t size =
        protocol::FindBlockBegin(rest, blocks, block + 1) - protocol::FindBlockBegin(rest, blocks, block);
    for (std::size_t i = 0; i < size * size; ++i) {
      source.turns.push_back(
          static_cast<std::int8_t>(static_cast<int>(random() % 7) - 3 + (i % (size + 1) == 0 ? 4 : 0)));
    }
  }
  return source;
}

}  // namespace wobble::test
