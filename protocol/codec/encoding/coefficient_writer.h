// The last part of an encoder: coefficients as bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/contexts.h"
#include "protocol/codec/shape_layout.h"

namespace wobble::protocol {

// Appends a payload. size: of the blueprint, m. expected: at the head's step.
void WriteShape(float size, const ShapeHead& head, std::span<const ExpectedContext> expected,
                std::span<const std::int32_t> coefficients, std::vector<std::uint8_t>& out);

}  // namespace wobble::protocol
