// One patch of one body as bytes that are decoded alone: the pose, then the vertices' displacements from the rest shape
// along the modes of the patch's basis.
//
// There is no baseline. A soft body forgets its shape in 50 ms: coded against the last acknowledged snapshot a record
// would be 3 % shorter, but different for each client and lost together with that snapshot. Savings of each part in
// bits a vertex, on balls of 162 vertices thrown about a room, at targets of 0.25 %, 0.5 % and 0.1 % of the size (4.36,
// 2.25 and 8.12 bits in all): completion of the basis 0.7, 0.2 and most of the last (basis.h); adaptive contexts 0.36,
// 0.14, 0.6 (contexts.h); prediction of contact with known walls 0.29, 0.27, 0.31 (flat_sides.h); rate-distortion
// optimised rounding 0.28, 0.22, 0.21 (encoding/rounding.h); a pose as coarse as the target 0.25, 0.28, 0.2 (pose.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/context_plans.h"
#include "protocol/codec/flat_sides.h"
#include "protocol/codec/mode_sums.h"
#include "protocol/codec/patch_model.h"
#include "protocol/codec/pose.h"
#include "protocol/geometry.h"

namespace wobble::protocol {

enum class DecodeResult : std::uint8_t {
  kOk,
  kTruncated,
  kBadMode,
  kBadPose,
  kBadStep,
  kBadCoefficient,
  kTrailingBytes
};
[[nodiscard]] const char* Name(DecodeResult result);

// The effect of contact alone on the rest shape; FindContact fills it in.
struct ContactScratch {
  std::vector<Vector3> pressed;  // the rest shape pressed out of the sides, body frame, m
  // By how much, in units of 2^-12 of the power of two above the size. Scalar: all x, then all y, then all z, each
  // padded as a ProductRow.
  std::vector<std::int16_t> moved;
  std::vector<std::uint16_t> modes;  // that follow contact
  std::vector<std::int32_t> along;   // the motion along each mode; 0 for modes that do not follow
};

struct ShapeHead;

// Reads the pose of a payload and nothing behind it. It needs no basis. size: of the blueprint, m.
[[nodiscard]] DecodeResult DecodePose(std::span<const std::uint8_t> payload, float size, QuantisedPose& pose);

// Decodes payloads; keeps its memory between them. The laboratory holds it to 20 us for a ball of 162 vertices.
class ShapeDecoder {
 public:
  // Reads one payload of any bytes. `shape` has the size of model.rest and gets vertices in the body's frame, m; `pose`
  // gets the pose on its grid, which Dequantise turns into metres. On any result but kOk the contents of `pose` and
  // `shape` are unspecified and must not be shown.
  [[nodiscard]] DecodeResult Decode(const PatchModel& model, std::span<const std::uint8_t> payload, QuantisedPose& pose,
                                    std::span<Vector3> shape);
  // Makes the shape that Decode would read from this head and these coefficients, in steps. With it the encoder sees
  // exactly what decoders will. contact: as FindContact found it for the head's pose, read where it follows contact;
  // nullptr: it is found here.
  void Rebuild(const PatchModel& model, const ShapeHead& head, std::span<const std::int32_t> coefficients,
               const ContactScratch* contact, std::span<Vector3> shape);

 private:
  // The shape from coefficients in the model's basis, plus the contact prediction `along` unless it is empty.
  void MoveAlongModes(const PatchModel& model, std::span<const std::int32_t> coefficients,
                      std::span<const std::int32_t> along, float step, std::span<Vector3> shape);

  std::vector<std::int32_t> m_coefficients;
  ContactScratch m_contact;
  std::vector<std::uint32_t> m_values;  // of the modes, in 2^-4 steps
  std::vector<std::uint32_t> m_sums;    // of the rows, in 2^-18 steps
  ModeSums m_modeSums;
  ContextPlans m_plans;
  std::vector<Side> m_sides;
};

struct ShapeEncoding {
  bool fits = false;   // false: not within maxBytes at any step, nothing was written
  float step = 0;      // quantiser step, metres
  float rmsError = 0;  // over the patch's vertices, as the decoder will see them, metres
  float maxError = 0;  // metres
};

}  // namespace wobble::protocol
