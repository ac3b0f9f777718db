// Time to encode and decode a body in play: all frames of a few seconds in sequence, alone and in crowds, as a server
// and a client process them; the fastest of many passes counts.
#include <stdexcept>

#include "protocol/codec/encoding/crowd_encoder.h"
#include "protocol/snapshot.h"
#include "tests/bench/codec/experiments.h"
#include "tests/bench/codec/method.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr float kTimedTarget = 0.0025F;

using Payloads = std::vector<std::vector<std::uint8_t>>;

void EncodeAll(const Recording& recording, protocol::ShapeEncoder& encoder, Payloads& payloads) {
  const protocol::PatchModel model = FindModel(recording, 0);
  std::size_t next = 0;
  for (const auto& frame : recording.frames) {
    for (const server::CapturedBody& body : frame) {
      std::vector<std::uint8_t>& payload = payloads[next++];
      payload.clear();
      (void)encoder.Encode(model, body.pose, body.vertices, kTimedTarget * model.size, protocol::kMaxRecordPayload,
                           payload);
    }
  }
}

// The bodies of eight frames together: 32 of a blueprint.
void EncodeCrowds(const Recording& recording, protocol::CrowdEncoder& encoder, Payloads& payloads) {
  constexpr std::size_t kCrowd = 32;
  const protocol::PatchModel model = FindModel(recording, 0);
  std::vector<protocol::CrowdBody> bodies;
  std::size_t next = 0;
  const auto encode = [&] {
    encoder.Encode(model, protocol::kMaxRecordPayload, bodies);
    bodies.clear();
  };
  for (const auto& frame : recording.frames) {
    for (const server::CapturedBody& body : frame) {
      std::vector<std::uint8_t>& payload = payloads[next++];
      payload.clear();
      bodies.push_back({.pose = body.pose,
                        .vertices = body.vertices,
                        .targetRms = kTimedTarget * model.size,
                        .out = &payload,
                        .encoding = {}});
      if (bodies.size() == kCrowd) encode();
    }
  }
  encode();
}

void DecodeAll(const Recording& recording, protocol::ShapeDecoder& decoder, const Payloads& payloads) {
  const protocol::PatchModel model = FindModel(recording, 0);
  protocol::QuantisedPose pose;
  std::vector<protocol::Vector3> shape(recording.CountVertices());
  for (const auto& payload : payloads) {
    if (decoder.Decode(model, payload, pose, shape) != protocol::DecodeResult::kOk) {
      throw std::runtime_error("our codec cannot decode its own shape");
    }
  }
}

}  // namespace

void MeasureCodecTimes(Bench& bench) {
  const Recording recording = RecordBalls(Pattern::kChase, bench.options.seed, 2);
  protocol::ShapeEncoder encoder;
  protocol::CrowdEncoder crowdEncoder;
  protocol::ShapeDecoder decoder;
  Payloads payloads(recording.speeds.size()), payloadsOfCrowds(recording.speeds.size());
  const std::size_t passes = bench.options.quick ? 20 : 200;
  Fastest encode;
  Fastest encodeAlone;
  Fastest decode;
  for (std::size_t pass = 0; pass < passes && !bench.progress.IsStopAsked(); ++pass) {
    encodeAlone.Time([&] { EncodeAll(recording, encoder, payloads); });
    encode.Time([&] { EncodeCrowds(recording, crowdEncoder, payloadsOfCrowds); });
    if (payloads != payloadsOfCrowds) throw std::runtime_error("a crowd's payloads are not those of each body alone");
    decode.Time([&] { DecodeAll(recording, decoder, payloads); });
    bench.progress.Show(pass + 1, passes);
  }
  const auto count = static_cast<double>(payloads.size());
  // Times of a quick run depend too much on other load of the machine.
  const bool isHeld = !bench.options.quick;
  bench.results.AddFigureAtMost("encode_us_per_body", 1e6 * encode.Read() / count, 35, isHeld);
  bench.results.AddFigureAtMost("encode_alone_us_per_body", 1e6 * encodeAlone.Read() / count, 50, isHeld);
  bench.results.AddFigureAtMost("decode_us_per_body", 1e6 * decode.Read() / count, 20, isHeld);
}

}  // namespace wobble::bench
