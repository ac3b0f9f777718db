#include "server/recording/keyframe_index.h"

#include <fcntl.h>
#include <unistd.h>

#include "server/recording/replay.h"

namespace wobble::recording {
namespace {

void Append(const Bytes& block, Bytes& file) { file.insert(file.end(), block.begin(), block.end()); }

}  // namespace

KeyframeIndex::KeyframeIndex(std::filesystem::path path) : m_path(std::move(path)), m_thread([this] { Make(); }) {}

KeyframeIndex::~KeyframeIndex() {
  m_isStopped = true;
  m_thread.join();
}

std::optional<KeyframeIndex::Keyframe> KeyframeIndex::Find(std::uint32_t tick) const {
  const std::lock_guard lock(m_mutex);
  const auto behind = m_keyframes.upper_bound(tick);
  if (behind == m_keyframes.begin()) return {};
  const auto& [found, packed] = *std::prev(behind);
  auto block = UnpackBlock(packed);
  if (!block) return {};
  return Keyframe{found, std::move(block->bytes)};
}

// What tells this recording from others, and from itself when it was longer or shorter.
Bytes KeyframeIndex::MakeHead(const Recording& recording) const {
  std::error_code error;
  Writer head;
  head(std::uint64_t{std::filesystem::file_size(m_path, error)}, recording.FirstTick(), recording.LastTick(),
       ToBytes(recording.ReadHead()));
  return head.Take();
}

bool KeyframeIndex::Load(const Recording& recording) {
  BlockReader file;
  if (!file.Open(Path()).empty()) return false;
  const auto head = file.Next();
  if (!head || head->kind != BlockKind::kHead || head->bytes != MakeHead(recording)) return false;
  std::map<std::uint32_t, Bytes> keyframes;
  bool isWhole = false;
  while (const auto block = file.Next()) {
    isWhole = block->kind == BlockKind::kEnd;
    if (block->kind != BlockKind::kKeyframe) continue;
    std::uint32_t tick = 0;
    Reader reader(block->bytes);
    reader(tick);
    keyframes[tick] = PackBlock(BlockKind::kKeyframe, block->bytes);
  }
  if (!isWhole) return false;
  const std::lock_guard lock(m_mutex);
  m_keyframes = std::move(keyframes);
  m_madeUpTo = recording.LastTick();
  return true;
}

void KeyframeIndex::Make() {
  Recording recording;
  if (!recording.Open(m_path).empty() || Load(recording)) return;
  std::string error;
  const auto ground = MakeGround(recording.ReadHead(), {}, error);
  if (ground == nullptr) return;
  Replay replay(recording, *ground);
  if (!replay.Seek(recording.FirstTick()).empty()) return;
  const std::uint32_t every = kIndexSeconds * recording.ReadHead().tickHz;
  do {
    m_madeUpTo = replay.Tick();
    if ((replay.Tick() - recording.FirstTick()) % every != 0) continue;
    Bytes packed = PackBlock(BlockKind::kKeyframe, ToBytes(ground->Capture()));
    const std::lock_guard lock(m_mutex);
    m_keyframes[replay.Tick()] = std::move(packed);
  } while (!m_isStopped && replay.Advance());
  // A stop comes too late once all is made.
  if (!m_isStopped || m_madeUpTo == recording.LastTick()) Keep(recording);
}

// A recording in a folder that cannot be written is indexed anew each time.
void KeyframeIndex::Keep(const Recording& recording) const {
  Bytes bytes = MakeFileHead();
  Append(PackBlock(BlockKind::kHead, MakeHead(recording)), bytes);
  for (const auto& [tick, packed] : m_keyframes) Append(packed, bytes);
  Append(PackBlock(BlockKind::kEnd, {}), bytes);
  const std::filesystem::path beside = Path().string() + ".new";
  std::error_code renamed;
  if (WriteWhole(beside, bytes).empty()) std::filesystem::rename(beside, Path(), renamed);
}

}  // namespace wobble::recording
