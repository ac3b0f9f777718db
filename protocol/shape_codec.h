// One patch of one body in bytes: pose, then every vertex's departure from the rest shape in the body's own frame.
//
// The frame is the pose after rounding, so the error is that of the shape alone: with quantiser step s each coordinate
// is off by at most s/2 and a vertex by at most s√3/2 (plus float rounding, under 1e-6 of its distance), uniformly
// spread, hence RMS s/2. The residuals go through one adaptive Rice code (k from the running mean of magnitudes, as in
// JPEG-LS, Weinberger, Seroussi & Sapiro 2000): no tables, no baseline, so every record decodes alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/geometry.h"

namespace wobble::protocol {

struct ShapeEncoding {
  bool fits = false;   // false: not within maxBytes at any step, nothing was written
  float step = 0;      // quantiser step, metres
  float rmsError = 0;  // over the patch's vertices, as the decoder will see them, metres
  float maxError = 0;  // metres
};

// Appends a shape payload to `out`. rest: the patch's rest vertices in the body frame; vertices: the same vertices in
// the world, metres. The finest step needed keeps the RMS error within targetRms (> 0, metres); if that takes more than
// maxBytes the step is made coarser until it fits.
[[nodiscard]] ShapeEncoding EncodeShape(const Pose& pose, std::span<const Vector3> rest,
                                        std::span<const Vector3> vertices, float targetRms, std::size_t maxBytes,
                                        std::vector<std::uint8_t>& out);

enum class DecodeResult : std::uint8_t { kOk, kTruncated, kBadPose, kBadStep, kBadResidual, kTrailingBytes };
[[nodiscard]] const char* Name(DecodeResult result);

// Reads one payload of any bytes. `shape` has the size of `rest` and gets vertices in the body frame, metres. On any
// result but kOk the contents of `pose` and `shape` are unspecified and must not be shown.
[[nodiscard]] DecodeResult DecodeShape(std::span<const std::uint8_t> payload, std::span<const Vector3> rest, Pose& pose,
                                       std::span<Vector3> shape);

}  // namespace wobble::protocol
