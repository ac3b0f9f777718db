#include "server/recording/checkpoints.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "server/recording/fields.h"

namespace wobble::recording {

template <class Archive, Is<Checkpoint> Value>
void Describe(Archive& archive, Value& value) {
  auto& [number, ground, nextClient, seats, scene] = value;
  archive(number, ground, nextClient, seats);
}

namespace {

constexpr const char* kEnding = ".wobstate";
constexpr const char* kLockName = "world.lock";  // of a file that holds the number of the process that has locked it

std::string DescribeWorld(const std::string& scenes, const Head& head) {
  return fmt::format("{}, {} ticks a second, seed {}", scenes, head.tickHz, head.seed);
}

}  // namespace

Checkpoints::Checkpoints(std::filesystem::path folder, std::vector<Head> heads) : m_folder(std::move(folder)) {
  for (Head& head : heads) {
    head.beginsFresh = false;
    head.version.clear();  // for people alone: another version of the program goes on if it has the same format
    m_heads.push_back(ToBytes(head));
  }
  m_thread = std::thread([this] { Run(); });
}

Checkpoints::~Checkpoints() {
  {
    const std::lock_guard lock(m_mutex);
    m_isClosing = true;
  }
  m_wakes.notify_one();
  m_thread.join();
  if (m_lock >= 0) close(m_lock);
}

std::string Checkpoints::Claim() {
  const std::filesystem::path path = m_folder / kLockName;
  m_lock = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (m_lock < 0) return path.string() + ": " + std::strerror(errno);
  if (flock(m_lock, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return {};
    std::array<char, 32> owner{};
    const ssize_t read = pread(m_lock, owner.data(), owner.size() - 1, 0);
    return fmt::format("in use by another server{}", read > 0 ? fmt::format(", process {}", owner.data()) : "");
  }
  const std::string own = std::to_string(getpid());
  // Only for people: that the file is locked says enough.
  if (ftruncate(m_lock, 0) != 0 || pwrite(m_lock, own.data(), own.size(), 0) < 0) return {};
  return {};
}

std::string Checkpoints::Read(const std::filesystem::path& path, Checkpoint& checkpoint, std::string& conflict) const {
  BlockReader reader;
  std::string error = reader.Open(path);
  if (!error.empty()) return error;
  const auto head = reader.Next();
  if (!head || head->kind != BlockKind::kHead) return "is torn: " + reader.Fault();
  const auto of = std::ranges::find(m_heads, head->bytes);
  checkpoint.scene = static_cast<std::size_t>(of - m_heads.begin());
  if (of == m_heads.end()) {
    const auto other = FromBytes<Head>(head->bytes);
    if (!other) return "has no head that can be read";
    conflict = DescribeConflict(*other);
  }
  const auto block = reader.Next();
  if (!block || block->kind != BlockKind::kCheckpoint) {
    return "is torn: " + (reader.Fault().empty() ? "it ends behind its head" : reader.Fault());
  }
  Reader bytes(block->bytes);
  bytes(checkpoint);
  return bytes.IsDone() ? "" : "cannot be read";
}

std::string Checkpoints::DescribeConflict(const Head& found) const {
  std::vector<std::string> scenes;
  for (const Bytes& head : m_heads) scenes.push_back(FromBytes<Head>(head)->scene.name);
  const std::string holds = DescribeWorld(found.scene.name, found);
  const std::string wanted = DescribeWorld(fmt::format("{}", fmt::join(scenes, " or ")), *FromBytes<Head>(m_heads[0]));
  // By name they are the same: the scene's file is not.
  const bool hasName = std::ranges::find(scenes, found.scene.name) != scenes.end();
  const bool isChanged = hasName && DescribeWorld("", found) == DescribeWorld("", *FromBytes<Head>(m_heads[0]));
  return fmt::format("holds a world of {}; this is {}{}", holds, wanted,
                     isChanged ? ", and the scene has changed since" : "");
}

FoundCheckpoint Checkpoints::FindNewest() {
  FoundCheckpoint found;
  std::uint64_t newestOther = 0;
  std::string conflict;  // of newestOther
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(m_folder, error)) {
    if (entry.path().extension() != kEnding) continue;
    Checkpoint checkpoint;
    std::string difference;
    std::string complaint = Read(entry.path(), checkpoint, difference);
    if (complaint.empty() && checkpoint.number >= newestOther && !difference.empty()) {
      newestOther = checkpoint.number;
      conflict = entry.path().string() + " " + difference;
    }
    if (complaint.empty()) complaint = difference;
    if (!complaint.empty()) {
      found.complaints.push_back(entry.path().string() + " " + complaint);
    } else if (!found.checkpoint || checkpoint.number > found.checkpoint->number) {
      found.checkpoint = std::move(checkpoint);
    }
  }
  if (found.checkpoint) m_number = found.checkpoint->number;
  if (newestOther > m_number) found.conflict = std::move(conflict);
  return found;
}

void Checkpoints::Save(Checkpoint checkpoint) {
  {
    const std::lock_guard lock(m_mutex);
    checkpoint.number = ++m_number;
    m_waiting = std::move(checkpoint);
  }
  m_wakes.notify_one();
}

std::uint64_t Checkpoints::Failures() const {
  const std::lock_guard lock(m_mutex);
  return m_failures;
}

std::string Checkpoints::Error() const {
  const std::lock_guard lock(m_mutex);
  return m_error;
}

void Checkpoints::Run() {
  std::unique_lock lock(m_mutex);
  for (;;) {
    m_wakes.wait(lock, [this] { return m_isClosing || m_waiting; });
    if (!m_waiting) return;
    const Checkpoint checkpoint = std::move(*m_waiting);
    m_waiting.reset();
    lock.unlock();
    Write(checkpoint);
    lock.lock();
  }
}

void Checkpoints::Write(const Checkpoint& checkpoint) {
  Writer content;
  content(checkpoint);
  Bytes file = MakeFileHead();
  const auto append = [&file](const Bytes& bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); };
  append(PackBlock(BlockKind::kHead, m_heads[checkpoint.scene]));
  append(PackBlock(BlockKind::kCheckpoint, content.Read()));
  const std::filesystem::path path = m_folder / ("world-" + std::to_string(checkpoint.number % kKept) + kEnding);
  const std::filesystem::path beside = m_folder / "world.new";
  std::string error = WriteWhole(beside, file);
  std::error_code renamed;
  if (error.empty()) std::filesystem::rename(beside, path, renamed);
  if (error.empty() && renamed) error = renamed.message();
  if (error.empty()) return;
  const std::lock_guard lock(m_mutex);
  ++m_failures;
  m_error = beside.string() + ": " + error;
}

}  // namespace wobble::recording
