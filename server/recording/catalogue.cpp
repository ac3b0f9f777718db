#include "server/recording/catalogue.h"

#include <algorithm>
#include <utility>

#include "server/recording/content.h"

namespace wobble::recording {
namespace {

namespace fs = std::filesystem;

std::optional<Second> ReadSecondAt(BlockReader& reader, std::uint64_t offset) {
  reader.Seek(offset);
  const std::optional<Block> block = reader.Next();
  return block ? FromBytes<Second>(block->bytes) : std::nullopt;
}

// From the first second to the last, s.
double FindLength(BlockReader& reader, std::uint32_t tickHz, std::string& damage) {
  std::optional<std::uint64_t> first, last;
  for (std::uint64_t offset = reader.Offset(); const auto kind = reader.Skip(); offset = reader.Offset()) {
    if (*kind != BlockKind::kSecond) continue;
    if (!first) first = offset;
    last = offset;
  }
  if (!reader.IsAtEnd()) damage = "byte " + std::to_string(reader.Offset()) + ": no whole block";
  if (!first) return 0;
  const auto begin = ReadSecondAt(reader, *first);
  const auto end = begin ? ReadSecondAt(reader, *last) : std::nullopt;
  if (!begin || !end) damage = reader.Fault().empty() ? "a second cannot be read" : reader.Fault();
  if (!begin || !end || end->begin < begin->begin) return 0;
  return static_cast<double>(end->begin - begin->begin + end->traces.size()) / tickHz;
}

void Describe(const fs::path& path, CatalogueEntry& entry) {
  BlockReader reader;
  entry.fault = reader.Open(path);
  if (!entry.fault.empty()) return;
  const std::optional<Block> block = reader.Next();
  const auto head = block && block->kind == BlockKind::kHead ? FromBytes<Head>(block->bytes) : std::nullopt;
  if (!head || head->tickHz == 0) {
    entry.fault = "has no head that can be read";
    return;
  }
  entry.scene = head->scene.name;
  entry.length = FindLength(reader, head->tickHz, entry.damage);
}

}  // namespace

std::vector<CatalogueEntry> ListRecordings(const fs::path& folder, std::size_t most) {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code error;
  for (const auto& each : fs::directory_iterator(folder, error)) {
    if (each.path().extension() != ".wobrec" || !each.is_regular_file(error)) continue;
    found.emplace_back(each.last_write_time(error), each.path());
  }
  std::ranges::sort(found, std::ranges::greater());
  if (found.size() > most) found.resize(most);
  std::vector<CatalogueEntry> entries;
  for (const auto& [time, path] : found) {
    CatalogueEntry& entry = entries.emplace_back();
    entry.file = path.filename().string();
    entry.writtenAt = time;
    Describe(path, entry);
  }
  return entries;
}

}  // namespace wobble::recording
