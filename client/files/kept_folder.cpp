// One file a blueprint, FOLDER/SERVER/HASH. A file is written under another name and renamed, so that a program that is
// killed, or two that write at once, leave no half file; Load checks the hash all the same.
#include "client/files/kept_folder.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <system_error>

namespace wobble::files {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytesOfAll = 64U * 1024 * 1024;

struct KeptFile {
  fs::path path;
  std::uintmax_t bytes = 0;
  fs::file_time_type time;
};

// The files below a folder, the newest first.
std::vector<KeptFile> ListFiles(const fs::path& folder) {
  std::vector<KeptFile> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unread;
    if (!at->is_regular_file(unread)) continue;
    KeptFile file{at->path(), at->file_size(unread), at->last_write_time(unread)};
    if (!unread) files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(), [](const KeptFile& a, const KeptFile& b) { return a.time > b.time; });
  return files;
}

void RemoveOldest(const fs::path& folder, std::size_t mostFiles, std::uintmax_t mostBytes) {
  std::uintmax_t bytes = 0;
  std::size_t files = 0;
  for (const KeptFile& file : ListFiles(folder)) {
    bytes += file.bytes;
    std::error_code ignored;
    if (++files > mostFiles || bytes > mostBytes) fs::remove(file.path, ignored);
  }
}

// The name as a folder's: everything but letters, digits, dots and minus becomes a minus, so none leads elsewhere.
std::string MakeFolderName(const std::string& server) {
  std::string name = server;
  for (char& c : name) {
    const bool isPlain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.';
    if (!isPlain) c = '-';
  }
  return "server-" + name;
}

std::string MakeFileName(std::uint64_t hash) {
  std::array<char, 16> digits{};
  const auto [end, result] = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16);
  return {digits.data(), end};
}

}  // namespace

KeptFolder::KeptFolder(const fs::path& folder, const std::string& server) : m_all(folder) {
  if (!folder.empty()) m_own = folder / MakeFolderName(server);
}

std::shared_ptr<const client::KeptBlueprints> KeptFolder::Load() const {
  auto kept = std::make_shared<client::KeptBlueprints>();
  if (m_own.empty()) return kept;
  std::size_t bytes = 0;
  for (const KeptFile& file : ListFiles(m_own)) {
    if (file.bytes > protocol::kMaxBlueprintBytes) continue;
    client::KeptBlueprint blueprint;
    blueprint.bytes.resize(static_cast<std::size_t>(file.bytes));
    std::ifstream in(file.path, std::ios::binary);
    in.read(reinterpret_cast<char*>(blueprint.bytes.data()), static_cast<std::streamsize>(blueprint.bytes.size()));
    blueprint.hash = protocol::HashBytes(blueprint.bytes);
    if (!in || file.path.filename() != MakeFileName(blueprint.hash)) continue;
    bytes += blueprint.bytes.size();
    if (bytes > protocol::kMaxKeptBytes || kept->size() == protocol::kMaxKeptBlueprints) break;
    kept->push_back(std::move(blueprint));
  }
  return kept;
}

void KeptFolder::Keep(std::uint64_t hash, std::span<const std::uint8_t> bytes) const {
  if (m_own.empty()) return;
  std::error_code error;
  fs::create_directories(m_own, error);
  const fs::path path = m_own / MakeFileName(hash);
  const fs::path unfinished = path.string() + "-" + std::to_string(getpid());
  {
    std::ofstream out(unfinished, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
      fs::remove(unfinished, error);
      return;
    }
  }
  fs::rename(unfinished, path, error);
  if (error) fs::remove(unfinished, error);
  RemoveOldest(m_own, protocol::kMaxKeptBlueprints, protocol::kMaxKeptBytes);
  RemoveOldest(m_all, static_cast<std::size_t>(-1), kMostBytesOfAll);
}

void UseKeptFolder(const fs::path& folder, const std::string& server, client::Options& options) {
  const KeptFolder kept(folder, server);
  options.kept = kept.Load();
  options.keep = [kept](std::uint64_t hash, std::span<const std::uint8_t> bytes) { kept.Keep(hash, bytes); };
}

fs::path FindBasesFolder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    return fs::path(cache) / "wobble" / "bases";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return fs::path(home) / ".cache" / "wobble" / "bases";
  }
  return {};
}

}  // namespace wobble::files
