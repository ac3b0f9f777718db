// A key is written under another name and linked to its own, which fails where there is one already: of servers that
// start at once, one makes the key, and the others never see half of it.
#include "protocol/transport/vestibule/key_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

namespace wobble::transport::vestibule {

namespace {

// Sets errno when it fails.
bool WriteNewFile(const std::filesystem::path& file, const std::string& line) {
  const std::string draft = file.string() + "." + std::to_string(getpid());
  const int descriptor = open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor < 0) return false;
  const bool isWritten =
      write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size()) && fsync(descriptor) == 0;
  close(descriptor);
  const bool isLinked = isWritten && link(draft.c_str(), file.c_str()) == 0;
  const int reason = errno;
  unlink(draft.c_str());
  errno = reason;
  return isLinked;
}

}  // namespace

std::optional<Key> LoadKey(const std::filesystem::path& file, std::string& error) {
  const std::string name = "key file " + file.string() + ": ";
  std::ifstream in(file);
  if (!in) {
    error = name + std::strerror(errno);
    return {};
  }
  // Some more than a key has: a file without an end is not read to it.
  std::string text(80, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  text.erase(text.find_last_not_of(" \r\n\t") + 1);
  const std::optional<Key> key = ParseKey(text);
  if (!key) error = name + "must hold 64 hexadecimal digits";
  return key;
}

std::optional<Key> LoadOrMakeKey(const std::filesystem::path& file, std::string& error) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    Key key;
    FillRandomly(key);
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    if (WriteNewFile(file, FormatKey(key) + "\n")) return key;
    if (errno != EEXIST) {
      error = "key file " + file.string() + ": " + std::strerror(errno);
      return {};
    }
  }
  return LoadKey(file, error);
}

std::filesystem::path FindStateFile(const std::string& name) {
  const auto find = [&](const char* variable, const char* below) -> std::filesystem::path {
    const char* folder = std::getenv(variable);
    return folder != nullptr && *folder == '/' ? std::filesystem::path(folder) / below / name : std::filesystem::path();
  };
  for (const auto& [variable, below] : {std::pair{"STATE_DIRECTORY", ""}, std::pair{"XDG_STATE_HOME", "wobble"},
                                        std::pair{"HOME", ".local/state/wobble"}}) {
    if (auto file = find(variable, below); !file.empty()) return file;
  }
  return {};
}

}  // namespace wobble::transport::vestibule
