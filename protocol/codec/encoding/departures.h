// From vertices to coefficients, and what is decided by looking at these: the parts of an encoder before the rounding.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/encoding/step_search.h"
#include "protocol/codec/shape_codec.h"

namespace wobble::protocol {

// Share of the error allowed that is planned with; the rest is for the rounding of the transform.
inline constexpr double kPlannedShare = 0.9985;

// The squared error that is planned with, m².
[[nodiscard]] inline double FindBudget(const PatchModel& model, float targetRms) {
  return kPlannedShare * static_cast<double>(model.rest.size()) * double{targetRms} * double{targetRms};
}
// A record is rebuilt up to so many times, each time with a smaller budget, until its error is within the target.
inline constexpr int kRebuildings = 4;
[[nodiscard]] inline double ShrinkBudget(double budget, float rmsError, float targetRms) {
  const double over = double{rmsError} / double{targetRms};
  return budget * (0.998 / (over * over));
}

// The head of a record at this target, m, but for its step and whether it follows contact.
[[nodiscard]] ShapeHead MakeHead(const PatchModel& model, const Pose& pose, float targetRms);

// local: the vertices in the frame of the pose as decoded. departures: their displacements from the rest shape, m, by
// coordinate.
void FindDepartures(const PatchModel& model, const Pose& seen, std::span<const Vector3> vertices,
                    std::vector<Vector3>& local, std::vector<float>& departures);

// Rounds displacements to `rounded`, rows for products with the modes. Returns what a unit of such a product is, m; 0:
// all displacements are 0.
[[nodiscard]] float RoundDepartures(const Basis& basis, std::span<const float> departures,
                                    std::vector<std::int16_t>& rounded);

// Whether the coefficients, in usual steps, take fewer bits in all when the contact prediction is subtracted. along: of
// ContactScratch.
[[nodiscard]] bool FollowsContact(const PatchModel& model, std::span<const float> coefficients,
                                  std::span<const std::int32_t> along, float targetRms);

// The coarsest step whose error is probably within the budget, m². along: empty when the record does not follow
// contact. left: scratch.
[[nodiscard]] unsigned GuessStep(const PatchModel& model, unsigned grid, std::span<const float> coefficients,
                                 std::span<const std::int32_t> along, double budget, std::vector<float>& left);

// The error of a decoded shape. Measured in the body's frame: rotations preserve lengths.
[[nodiscard]] ShapeEncoding MeasureError(std::span<const Vector3> local, std::span<const Vector3> shape);

}  // namespace wobble::protocol
