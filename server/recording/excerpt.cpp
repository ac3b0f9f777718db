#include "server/recording/excerpt.h"

#include <algorithm>

namespace wobble::recording {

std::string WriteExcerpt(const std::filesystem::path& from, std::uint32_t begin, std::uint32_t end,
                         const std::filesystem::path& to, const GroundSettings& settings) {
  Recording recording;
  std::string error = recording.Open(from);
  std::unique_ptr<server::Playground> ground;
  if (error.empty()) ground = MakeGround(recording.ReadHead(), settings, error);
  if (ground == nullptr) return from.string() + " " + error;
  begin = std::clamp(begin, recording.FirstTick(), recording.LastTick());
  const std::optional<Second> first = recording.ReadSecond(begin);
  if (!first || begin >= end) return from.string() + ": has no tick behind " + std::to_string(begin);
  Replay replay(recording, *ground);
  error = replay.Seek(first->begin);
  if (!error.empty()) return from.string() + ": " + error;

  Bytes file = MakeFileHead();
  const auto append = [&file](BlockKind kind, const Bytes& bytes) {
    const Bytes block = PackBlock(kind, bytes);
    file.insert(file.end(), block.begin(), block.end());
  };
  Head head = recording.ReadHead();
  head.beginsFresh = false;
  append(BlockKind::kHead, ToBytes(head));
  append(BlockKind::kKeyframe, ToBytes(ground->Capture()));
  for (std::uint32_t tick = first->begin; tick < end;) {
    const std::optional<Second> second = recording.ReadSecond(tick);
    if (!second) break;
    append(BlockKind::kSecond, ToBytes(*second));
    tick = second->begin + static_cast<std::uint32_t>(second->traces.size());
  }
  append(BlockKind::kEnd, {});
  error = WriteWhole(to, file);
  return error.empty() ? error : to.string() + ": " + error;
}

}  // namespace wobble::recording
