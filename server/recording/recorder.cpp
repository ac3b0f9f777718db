#include "server/recording/recorder.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <unistd.h>

#include <cerrno>

namespace wobble::recording {
namespace {

constexpr std::uint32_t kKeyframeSeconds = 60;
constexpr std::uint32_t kRetrySeconds = 10;  // after a failure, until the next file is tried
// What may wait for the writing thread. A crowd's second has 50 KB, its keyframe 2 MB: more means that the disk hangs.
constexpr std::size_t kMostQueuedBytes = std::size_t{64} << 20;
// Bytes of an entry and of a tick's trace as they wait, about.
constexpr std::size_t kEntryBytes = 200;

std::size_t EstimateBytes(const server::PlaygroundState& state) {
  std::size_t bytes = 0;
  for (const physics::Body& body : state.world.bodies) {
    bytes += sizeof body;
    std::visit([&](const auto& each) { bytes += each.positions.size() * 2 * sizeof each.positions[0]; }, body.state);
  }
  return bytes;
}

}  // namespace

Recorder::Recorder(RecorderSettings settings, Head head, const server::Playground& ground)
    : m_settings(std::move(settings)), m_head(std::move(head)), m_thread([this] { Write(); }) {
  StartFile(ground, ground.World().Tick() == 0 && ground.Players().empty());
}

Recorder::~Recorder() { Close(); }

void Recorder::Close() {
  if (!m_thread.joinable()) return;
  if (m_state == State::kWriting) {
    EndSecond();
    Enqueue(FileEnd{}, 0);
  }
  {
    const std::lock_guard lock(m_mutex);
    m_isClosing = true;
  }
  m_wakes.notify_one();
  m_thread.join();
  m_state = State::kBroken;
}

RecorderCounts Recorder::Counts() const {
  const std::lock_guard lock(m_mutex);
  return m_counts;
}

std::string Recorder::Error() const {
  const std::lock_guard lock(m_mutex);
  return m_error;
}

std::filesystem::path Recorder::Path() const {
  const std::lock_guard lock(m_mutex);
  return m_path;
}

void Recorder::Note(const server::Entry& entry, std::uint32_t tick) {
  if (m_state == State::kBroken) return;
  if (std::holds_alternative<server::RestartEntry>(entry)) m_wantsFile = true;
  m_second.entries.push_back({static_cast<std::uint16_t>(tick - m_second.begin), entry});
}

void Recorder::FollowTick(const server::Playground& ground) {
  const std::uint32_t tick = ground.World().Tick();
  if (m_state == State::kBroken) {
    CountLost(1);
    if (++m_brokenTicks < kRetrySeconds * m_head.tickHz) return;
    StartFile(ground, false);
    return;
  }
  m_second.traces.push_back(MakeTrace(ground.World(), m_head.tickHz));
  ++m_ticksInFile;
  if (m_hasFailed) {
    m_state = State::kBroken;
    m_brokenTicks = 0;
    CountLost(m_second.traces.size());
    m_second = {};
    return;
  }
  const bool isFull = m_fileBytes > m_settings.maxFileBytes;
  if (m_second.traces.size() < m_head.tickHz && !m_wantsFile) return;
  EndSecond();
  if (m_wantsFile || isFull) {
    Enqueue(FileEnd{}, 0);
    StartFile(ground, false);
    return;
  }
  if (m_ticksInFile % (kKeyframeSeconds * m_head.tickHz) == 0) EnqueueKeyframe(ground);
  StartSecond(tick);
}

void Recorder::BeginScene(scenes::SceneSource scene, const server::Playground& ground) {
  m_head.scene = std::move(scene);
  if (m_state == State::kBroken) return;
  EndSecond();
  Enqueue(FileEnd{}, 0);
  StartFile(ground, ground.World().Tick() == 0 && ground.Players().empty());
}

void Recorder::StartFile(const server::Playground& ground, bool beginsFresh) {
  m_state = State::kWriting;
  m_hasFailed = false;
  m_wantsFile = false;
  m_ticksInFile = 0;
  m_fileBytes = 0;
  Head head = m_head;
  head.beginsFresh = beginsFresh;
  Enqueue(FileBegin{std::move(head)}, 0);
  if (!beginsFresh) EnqueueKeyframe(ground);
  StartSecond(ground.World().Tick());
}

void Recorder::EnqueueKeyframe(const server::Playground& ground) {
  server::PlaygroundState state = ground.Capture();
  const std::size_t bytes = EstimateBytes(state);
  Enqueue(std::move(state), bytes);
}

void Recorder::StartSecond(std::uint32_t tick) {
  m_second = {.begin = tick, .entries = {}, .traces = {}};
  m_second.traces.reserve(m_head.tickHz);
}

void Recorder::EndSecond() {
  if (m_second.entries.empty() && m_second.traces.empty()) return;
  std::size_t bytes = m_second.entries.size() * kEntryBytes;
  for (const Trace& trace : m_second.traces) bytes += sizeof trace + 4 * trace.hashes.size();
  Enqueue(std::exchange(m_second, {}), bytes);
}

void Recorder::Enqueue(Job job, std::size_t bytes) {
  {
    const std::lock_guard lock(m_mutex);
    if (m_queuedBytes + bytes > kMostQueuedBytes) {
      m_hasFailed = true;
      ++m_counts.failures;
      m_error = "the disk takes longer to write than there is to record";
      if (const auto* second = std::get_if<Second>(&job)) m_counts.lostTicks += second->traces.size();
      return;
    }
    m_queuedBytes += bytes;
    m_jobs.emplace_back(std::move(job), bytes);
  }
  m_wakes.notify_one();
}

void Recorder::Write() {
  std::unique_lock lock(m_mutex);
  for (;;) {
    m_wakes.wait(lock, [this] { return m_isClosing || !m_jobs.empty(); });
    if (m_jobs.empty()) break;
    const auto [job, bytes] = std::move(m_jobs.front());
    m_jobs.pop_front();
    lock.unlock();
    std::visit([this](const auto& each) { Do(each); }, job);
    lock.lock();
    m_queuedBytes -= bytes;
  }
  if (m_file >= 0) close(m_file);
}

void Recorder::Do(const FileBegin& begin) {
  if (m_file >= 0) close(m_file);
  const std::filesystem::path path = MakePath(begin.head.scene.name);
  m_file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (m_file < 0) return Fail(path.string() + ": " + std::strerror(errno));
  {
    const std::lock_guard lock(m_mutex);
    ++m_counts.files;
    m_path = path;
  }
  m_fileBytes = 0;
  m_isWorthKeeping = false;
  Append(MakeFileHead());
  Append(PackBlock(BlockKind::kHead, ToBytes(begin.head)));
}

void Recorder::Do(const Second& second) {
  Append(PackBlock(BlockKind::kSecond, ToBytes(second)));
  if (m_file < 0) return CountLost(second.traces.size());
  m_isWorthKeeping = true;
}

void Recorder::Do(const server::PlaygroundState& state) {
  const Bytes bytes = ToBytes(state);
  if (bytes.size() > kMaxBlockBytes) return Fail("a keyframe has " + std::to_string(bytes.size()) + " bytes");
  Append(PackBlock(BlockKind::kKeyframe, bytes));
}

void Recorder::Do(const FileEnd& /*end*/) {
  Append(PackBlock(BlockKind::kEnd, {}));
  if (m_file >= 0) close(m_file);
  if (m_file >= 0 && !m_isWorthKeeping) {
    TakeBack();
    const std::lock_guard lock(m_mutex);
    --m_counts.files;
  }
  m_file = -1;
}

// A block that is written in part is taken back, so that the file ends with a whole one.
void Recorder::Append(std::span<const std::uint8_t> bytes) {
  if (m_file < 0) return;
  const off_t begin = lseek(m_file, 0, SEEK_CUR);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = write(m_file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const std::string why = std::strerror(errno);
      if (ftruncate(m_file, begin) != 0) return Fail(why + ", and the last block is cut short");
      return Fail(why);
    }
    done += static_cast<std::size_t>(written);
  }
  m_fileBytes += bytes.size();
  const std::lock_guard lock(m_mutex);
  m_counts.bytes += bytes.size();
}

// A file without a second to play: a full disk is tried again and again, and a world may begin anew twice in a moment.
void Recorder::TakeBack() { unlink(Path().c_str()); }

void Recorder::Fail(const std::string& why) {
  if (m_file >= 0) close(m_file);
  if (m_file >= 0 && !m_isWorthKeeping) TakeBack();
  m_file = -1;
  m_hasFailed = true;
  const std::lock_guard lock(m_mutex);
  ++m_counts.failures;
  m_error = why;
}

void Recorder::CountLost(std::size_t ticks) {
  const std::lock_guard lock(m_mutex);
  m_counts.lostTicks += ticks;
}

// By the scene and the time, with a number where a name is taken.
std::filesystem::path Recorder::MakePath(const std::string& scene) {
  const auto time = static_cast<std::time_t>(m_settings.readUnixTime());
  const std::string stem = fmt::format("{}-{:%Y%m%d-%H%M%S}", scene, fmt::gmtime(time));
  std::filesystem::path path = m_settings.folder / (stem + ".wobrec");
  std::error_code error;
  for (int number = 2; std::filesystem::exists(path, error); ++number) {
    path = m_settings.folder / (stem + "-" + std::to_string(number) + ".wobrec");
  }
  return path;
}

}  // namespace wobble::recording
