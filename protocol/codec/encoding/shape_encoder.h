// Encodes shapes one by one: the reference that a crowd (crowd_encoder.h) must equal to the byte.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/context_plans.h"
#include "protocol/codec/encoding/rounding.h"
#include "protocol/codec/encoding/step_search.h"
#include "protocol/codec/shape_codec.h"

namespace wobble::protocol {

// Encodes payloads; keeps its memory between them. The laboratory holds it to 50 us for a ball of 162 vertices.
class ShapeEncoder {
 public:
  // Appends a shape payload to `out`. vertices: the model's in the world, m, finite. The RMS error is at most, and
  // nearly, targetRms (> 0, m). When that takes more than maxBytes, targetRms is multiplied by 5/4 until it fits.
  [[nodiscard]] ShapeEncoding Encode(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                     float targetRms, std::size_t maxBytes, std::vector<std::uint8_t>& out);

 private:
  [[nodiscard]] ShapeEncoding EncodeAt(const PatchModel& model, const Pose& pose, std::span<const Vector3> vertices,
                                       float targetRms, std::vector<std::uint8_t>& out);
  void Transform(const Basis& basis);
  [[nodiscard]] RoundingTask MakeTask(const PatchModel& model, const Choice& choice);
  void SearchStep(const PatchModel& model, double budget, Choice& choice);

  ShapeDecoder m_decoder;
  ContextPlans m_plans;
  ContactScratch m_contact;
  std::vector<Side> m_sides;
  std::vector<Vector3> m_local;          // the vertices in the frame of the pose as decoded, m
  std::vector<std::int16_t> m_rounded;   // displacements, rounded for the transform
  std::vector<std::int32_t> m_products;  // of these with the modes
  std::vector<std::uint16_t> m_modes;    // all of the basis
  std::vector<float> m_coefficients;     // m
  std::vector<float> m_left;             // the coefficients less the contact prediction, m
  std::vector<std::int32_t> m_chosen;    // in steps
  std::vector<std::int32_t> m_bestChosen;
  SpendScratch m_spend;
  std::vector<Vector3> m_shape;  // as decoded
};

}  // namespace wobble::protocol
