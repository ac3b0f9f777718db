// One patch of one body in bytes, to be decoded alone: pose, then its departure from the rest shape along the modes of
// its basis.
//
// There is no baseline: a soft body forgets its shape in 50 ms, so that against the last acknowledged snapshot a
// record would be 3 % shorter, but different for each client and lost with that one. What each part brings, in bits a
// vertex on balls of 162 vertices thrown about a room (targets 0.25 %, 0.5 %, 0.1 % of the size; 4.36, 2.25, 8.12 in
// all): completion of the basis 0.7, 0.2 and most of the last (basis.h); contexts from what came before 0.36, 0.14, 0.6
// (contexts.h); following what contact with known walls suggests 0.29, 0.27, 0.31 (flat_sides.h); rate-distortion
// optimised rounding 0.28, 0.22, 0.21 (shape_encoder.cpp); a pose as coarse as the target 0.25, 0.28, 0.2 (pose.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/flat_sides.h"
#include "protocol/geometry.h"
#include "protocol/patch_model.h"
#include "protocol/pose.h"

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

// The rest shape where contact would press it, and how far along each mode that is.
struct ContactScratch {
  std::vector<Vector3> pressed;
  std::vector<std::int16_t> moved;
  std::vector<std::int32_t> along;
};

struct ShapeHead;

// Reads a payload's pose alone, which takes no basis.
[[nodiscard]] DecodeResult DecodePose(std::span<const std::uint8_t> payload, float size, QuantisedPose& pose);

// Keeps its memory between records.
class ShapeDecoder {
 public:
  // Reads one payload of any bytes. `shape` has the size of model.rest and gets vertices in the body's frame, m; `pose`
  // gets the pose on its grid, which Dequantise turns into metres. On any result but kOk the contents of `pose` and
  // `shape` are unspecified and must not be shown.
  [[nodiscard]] DecodeResult Decode(const PatchModel& model, std::span<const std::uint8_t> payload, QuantisedPose& pose,
                                    std::span<Vector3> shape);
  // The shape that Decode reads where this head and these coefficients, in steps, were written: the encoder's look at
  // its own work.
  void Rebuild(const PatchModel& model, const ShapeHead& head, std::span<const std::int32_t> coefficients,
               std::span<Vector3> shape);

 private:
  // In the model's basis, and by what contact suggests.
  void MoveAlongModes(const PatchModel& model, std::span<const std::int32_t> coefficients, bool followsContact,
                      float step, std::span<Vector3> shape);

  std::vector<std::int32_t> m_coefficients;
  ContactScratch m_contact;
  std::vector<std::uint32_t> m_sums;
  std::vector<Side> m_sides;
};

struct ShapeEncoding {
  bool fits = false;   // false: not within maxBytes at any step, nothing was written
  float step = 0;      // quantiser step, metres
  float rmsError = 0;  // over the patch's vertices, as the decoder will see them, metres
  float maxError = 0;  // metres
};

// Keeps its memory between records.
class ShapeEncoder {
 public:
  // Appends a shape payload to `out`. vertices: the model's in the world, m, finite. The RMS error is at most, and
  // nearly, targetRms (> 0, metres); if that takes more than maxBytes, the least of its multiples by 5/4 that fits.
  [[nodiscard]] ShapeEncoding Encode(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                     float targetRms, std::size_t maxBytes, std::vector<std::uint8_t>& out);

 private:
  struct Choice;
  [[nodiscard]] ShapeEncoding EncodeAt(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                       float targetRms, std::vector<std::uint8_t>& out);
  void FindDepartures(const PatchModel& model, const Pose& seen, std::span<const Vector3> vertices);
  void Transform(const Basis& basis);
  [[nodiscard]] bool FollowsContact(const PatchModel& model, float targetRms) const;
  double Round(const PatchModel& model, const Choice& choice);
  void GuessStep(const PatchModel& model, double budget, Choice& choice);
  void SearchStep(const PatchModel& model, double budget, Choice& choice);
  void SpendRest(double left, const Choice& choice);
  void Write(const PatchModel& model, const Choice& choice, std::vector<std::uint8_t>& out) const;
  [[nodiscard]] ShapeEncoding Measure(std::span<const Vector3> shape) const;

  ShapeDecoder m_decoder;
  ContactScratch m_contact;
  std::vector<Side> m_sides;
  std::vector<Vector3> m_local;         // where the vertices are in the frame of the pose as decoded
  std::vector<std::int16_t> m_rounded;  // departures, for the transform
  std::vector<float> m_coefficients;    // m
  std::vector<float> m_left;            // of these, without what contact suggests
  std::vector<float> m_wanted;          // magnitudes, in steps
  std::vector<std::int32_t> m_chosen;   // in steps
  std::vector<float> m_bestWanted;      // of the best try so far
  std::vector<std::int32_t> m_bestChosen;
  std::vector<Vector3> m_shape;  // as decoded
};

}  // namespace wobble::protocol
