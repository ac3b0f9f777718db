// Encodes many bodies of one blueprint together, to the same bytes as ShapeEncoder encodes each.
//
// What is a matrix times a vector for one body is a matrix times a matrix for a crowd, so that the basis is read once
// for many; and what is serial for one body runs with bodies in lanes. A ball of 162 vertices in a crowd of 32 takes 34
// us on a noisy core of an Intel Xeon at 2.5 GHz with VNNI, 39 without, 44 with AVX2; alone 56.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/codec/context_plans.h"
#include "protocol/codec/encoding/crowd_kernels.h"
#include "protocol/codec/encoding/shape_encoder.h"

namespace wobble::protocol {

// One body, or a body at one quality: qualities may be mixed.
struct CrowdBody {
  Pose pose;
  std::span<const Vector3> vertices;         // the model's in the world, m, finite
  float targetRms = 0;                       // above 0, m
  std::vector<std::uint8_t>* out = nullptr;  // the payload is appended
  ShapeEncoding encoding;                    // out: as ShapeEncoder::Encode returns it
};

// Keeps its memory from crowd to crowd: about 20 kB for each of kMostLanes balls of 162 vertices.
class CrowdEncoder {
 public:
  // kernels: see FindCrowdKernels.
  explicit CrowdEncoder(KernelSet kernels = KernelSet::kVnni);
  ~CrowdEncoder();

  // Encodes any number of bodies, kMostLanes at a time. maxBytes: see ShapeEncoder::Encode.
  void Encode(const PatchModel& model, std::size_t maxBytes, std::span<CrowdBody> bodies);

 private:
  struct Member;

  void EncodeTogether(const PatchModel& model, std::size_t maxBytes, std::span<CrowdBody> bodies);
  void Prepare(const PatchModel& model, const CrowdBody& body, Member& member);
  void FindCoefficients(const PatchModel& model);
  void SearchSteps(const PatchModel& model);
  void RoundTogether(const PatchModel& model, std::span<Member* const> members);
  void Rebuild(const PatchModel& model);
  void FindSumsTogether(const Basis& basis);

  const CrowdKernels& m_kernels;
  ShapeEncoder m_alone;
  ShapeDecoder m_decoder;
  ContextPlans m_plans;
  std::vector<std::unique_ptr<Member>> m_members;
  std::size_t m_count = 0;          // of members in use
  std::vector<Member*> m_searched;  // whose records are not found yet
  std::vector<Member*> m_rounded;   // those among them that are rounded once more
  std::vector<std::uint16_t> m_modes;
  std::vector<ProductRow> m_rows;
  std::vector<SumGroup> m_groups;
  std::vector<std::uint16_t> m_usedPairs;
  std::vector<float> m_left;
  std::vector<std::uint32_t> m_values;
  std::vector<Vector3> m_shape;
  SpendScratch m_spend;
};

}  // namespace wobble::protocol
