// A key is written under another name and linked to its own, which fails where there is one already: of servers that
// start at once, one makes the key, and the others never see half of it.
#include "server/key_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

namespace wobble::server {

namespace vestibule = transport::vestibule;

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

std::optional<vestibule::Key> LoadOrMakeKey(const std::filesystem::path& file, std::string& error) {
  const std::string name = "key file " + file.string() + ": ";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    vestibule::Key key;
    vestibule::FillRandomly(key);
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    if (WriteNewFile(file, vestibule::FormatKey(key) + "\n")) return key;
    if (errno != EEXIST) {
      error = name + std::strerror(errno);
      return {};
    }
  }
  std::ifstream in(file);
  if (!in) {
    error = name + std::strerror(errno);
    return {};
  }
  std::string digits, more;
  in >> digits;
  const std::optional<vestibule::Key> key = vestibule::ParseKey(digits);
  if (key && !(in >> more)) return key;
  error = name + "must hold 64 hexadecimal digits";
  return {};
}

std::filesystem::path FindKeyFile() {
  const auto find = [](const char* variable, const char* below) -> std::filesystem::path {
    const char* folder = std::getenv(variable);
    return folder != nullptr && *folder == '/' ? std::filesystem::path(folder) / below : std::filesystem::path();
  };
  for (const auto& [variable, below] :
       {std::pair{"STATE_DIRECTORY", "server.key"}, std::pair{"XDG_STATE_HOME", "wobble/server.key"},
        std::pair{"HOME", ".local/state/wobble/server.key"}}) {
    if (auto file = find(variable, below); !file.empty()) return file;
  }
  return {};
}

}  // namespace wobble::server
