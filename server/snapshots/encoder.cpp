// Each thread has an encoder with working memory of its own, which takes bodies of one blueprint together. Records are
// kept per body and quality with the version of the capture that they were made from, so a body that several clients
// take, or that has not moved, is encoded once.
#include "server/snapshots/encoder.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "protocol/codec/encoding/crowd_encoder.h"
#include "protocol/snapshot.h"
#include "server/physics/model/parallel.h"

namespace wobble::server {

// One body at one quality, to be encoded.
struct Encoder::Job {
  const CapturedBody* body = nullptr;
  const CapturedBlueprint* blueprint = nullptr;
  std::size_t quality = 0;
  Encoding* encoding = nullptr;
};

// The encoder of one thread; reuses its memory from crowd to crowd.
class Encoder::CrowdOfThread {
 public:
  explicit CrowdOfThread(std::span<const protocol::wire::Obstacle> obstacles) : m_obstacles(obstacles) {}

  // jobs: at most protocol::kMostLanes, of one blueprint.
  void Encode(std::span<const Job> jobs);

  [[nodiscard]] std::uint64_t CoarsenedRecords() const { return m_coarsened; }

 private:
  void AddRecord(const Job& job, std::uint8_t patch, std::size_t count, const protocol::CrowdBody& body);
  static void Finish(Encoding& encoding);

  std::span<const protocol::wire::Obstacle> m_obstacles;
  protocol::CrowdEncoder m_shapes;
  std::vector<protocol::CrowdBody> m_bodies;
  std::vector<std::vector<std::uint8_t>> m_payloads;
  std::uint64_t m_coarsened = 0;
};

void Encoder::CrowdOfThread::Encode(std::span<const Job> jobs) {
  const CapturedBlueprint& blueprint = *jobs.front().blueprint;
  const std::size_t vertexCount = blueprint.rest.size();
  m_bodies.resize(jobs.size());
  if (m_payloads.size() < jobs.size()) m_payloads.resize(jobs.size());
  for (const Job& job : jobs) {
    Encoding& encoding = *job.encoding;
    encoding.version = job.body->version;
    encoding.body = {};
    encoding.bytes.clear();
    encoding.bytes.reserve((vertexCount / protocol::kMaxPatchVertices + 1) * protocol::kMaxPacketBytes);
    encoding.ends.clear();
  }
  std::size_t first = 0;
  for (std::uint8_t patch = 0; first < vertexCount; ++patch) {
    const std::size_t count = protocol::PatchSize(vertexCount, patch);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      m_payloads[i].clear();
      m_bodies[i] = {.pose = jobs[i].body->pose,
                     .vertices = std::span(jobs[i].body->vertices).subspan(first, count),
                     .targetRms = kSnapshotErrorShares[jobs[i].quality] * blueprint.size,
                     .out = &m_payloads[i],
                     .encoding = {}};
    }
    const protocol::PatchModel model =
        protocol::MakePatchModel(blueprint.rest, blueprint.size, blueprint.patches, patch, m_obstacles);
    m_shapes.Encode(model, protocol::kMaxRecordPayload, m_bodies);
    for (std::size_t i = 0; i < jobs.size(); ++i) AddRecord(jobs[i], patch, count, m_bodies[i]);
    first += count;
  }
  for (const Job& job : jobs) Finish(*job.encoding);
}

void Encoder::CrowdOfThread::AddRecord(const Job& job, std::uint8_t patch, std::size_t count,
                                       const protocol::CrowdBody& body) {
  const protocol::ShapeEncoding& shape = body.encoding;
  const CapturedBlueprint& blueprint = *job.blueprint;
  if (!shape.fits || shape.rmsError > body.targetRms) ++m_coarsened;
  if (!shape.fits) return;  // spread over hundreds of metres: left out until the body is reset
  Encoding& encoding = *job.encoding;
  protocol::AppendRecord({.body = job.body->body,
                          .blueprint = job.body->blueprint,
                          .patch = patch,
                          .generation = blueprint.generation,
                          .restTick = job.body->restTick},
                         *body.out, encoding.bytes);
  encoding.ends.push_back(encoding.bytes.size());
  const double share = double{shape.rmsError} / double{blueprint.size};
  encoding.body.vertices += static_cast<std::uint32_t>(count);
  encoding.body.errorSquares += share * share * static_cast<double>(count);
}

void Encoder::CrowdOfThread::Finish(Encoding& encoding) {
  const double vertexCount = std::max(1U, encoding.body.vertices);
  encoding.body.error = std::sqrt(encoding.body.errorSquares / vertexCount);
  // Spans into the bytes are valid only now that the bytes no longer grow.
  encoding.records.clear();
  for (std::size_t begin = 0; const std::size_t end : encoding.ends) {
    encoding.records.push_back(std::span<const std::uint8_t>(encoding.bytes).subspan(begin, end - begin));
    begin = end;
  }
  encoding.body.records = encoding.records;
}

struct Encoder::Work {
  Work(std::span<const protocol::wire::Obstacle> obstacles, int count)
      : threads(count),
        threadCount(static_cast<std::size_t>(count)),
        encoders([obstacles] { return CrowdOfThread(obstacles); }) {}

  physics::Threads threads;
  std::size_t threadCount;
  tbb::enumerable_thread_specific<CrowdOfThread> encoders;
  std::vector<Job> jobs;
  std::vector<std::span<const Job>> crowds;  // of one blueprint each
};

Encoder::Encoder(std::vector<protocol::wire::Obstacle> obstacles, int threads)
    : m_obstacles(std::move(obstacles)), m_work(std::make_unique<Work>(m_obstacles, threads)) {}
Encoder::~Encoder() = default;

void Encoder::Follow(std::span<const ShownBody> bodies, std::uint32_t tick) {
  FollowBodies(bodies, m_bodies);
  m_tick = tick;
}

const EncodedBody& Encoder::NoteRead(Encoding& encoding) const {
  if (encoding.lastRead != m_tick) encoding.readBefore = std::exchange(encoding.lastRead, m_tick);
  return encoding.body;
}

const EncodedBody& Encoder::Encode(std::size_t index, std::size_t quality, const CapturedBody& body,
                                   const CapturedBlueprint& blueprint) {
  Encoding& encoding = m_bodies[index].qualities[quality];
  if (encoding.version != body.version) {
    const Job job{&body, &blueprint, quality, &encoding};
    m_work->encoders.local().Encode({&job, 1});
  }
  return NoteRead(encoding);
}

const EncodedBody* Encoder::Find(std::size_t index, std::size_t quality, std::uint64_t version) {
  Encoding& encoding = m_bodies[index].qualities[quality];
  return version != 0 && encoding.version == version ? &NoteRead(encoding) : nullptr;
}

bool Encoder::IsExpected(std::size_t index) const {
  return std::ranges::any_of(m_bodies[index].qualities, [this](const Encoding& each) { return IsExpected(each); });
}

void Encoder::EncodeAhead(std::span<const FreshCapture> captures) {
  std::vector<Job>& jobs = m_work->jobs;
  jobs.clear();
  for (const FreshCapture& fresh : captures) {
    for (std::size_t quality = 0; quality < kQualities; ++quality) {
      Encoding& encoding = m_bodies[fresh.index].qualities[quality];
      if (!IsExpected(encoding) || encoding.version == fresh.body->version) continue;
      jobs.push_back({fresh.body, fresh.blueprint, quality, &encoding});
    }
  }
  // By blueprint; their order within it decides only who shares a crowd with whom, and no byte depends on that.
  std::ranges::sort(jobs, std::less<>(), &Job::blueprint);
  // As large as kernels take, but so small that all threads have one.
  const std::size_t most = std::clamp<std::size_t>(jobs.size() / m_work->threadCount, 1, protocol::kMostLanes);
  std::vector<std::span<const Job>>& crowds = m_work->crowds;
  crowds.clear();
  for (std::size_t begin = 0, end = 0; begin < jobs.size(); begin = end) {
    while (end < jobs.size() && end - begin < most && jobs[end].blueprint == jobs[begin].blueprint) ++end;
    crowds.push_back(std::span<const Job>(jobs).subspan(begin, end - begin));
  }
  m_work->threads.ForEach(crowds.size(), [&](std::size_t i) { m_work->encoders.local().Encode(crowds[i]); });
}

physics::Threads& Encoder::Workers() { return m_work->threads; }

std::uint64_t Encoder::CoarsenedRecords() const {
  std::uint64_t sum = 0;
  for (const CrowdOfThread& each : m_work->encoders) sum += each.CoarsenedRecords();
  return sum;
}

}  // namespace wobble::server
