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

std::optional<vestibule::Key> LoadOrMakeKey(const std::filesystem::path& file, std::string& error) {
  const std::string name = "key file " + file.string() + ": ";
  if (std::ifstream in(file); in) {
    std::string digits, more;
    in >> digits;
    const std::optional<vestibule::Key> key = vestibule::ParseKey(digits);
    if (key && !(in >> more)) return key;
    error = name + "must hold 64 hexadecimal digits";
    return {};
  }
  vestibule::Key key;
  vestibule::FillRandomly(key);
  std::error_code ignored;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
  // O_EXCL: of two servers that start at once, one makes the key.
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  const std::string line = vestibule::FormatKey(key) + "\n";
  const bool isWritten =
      descriptor >= 0 && write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  if (!isWritten) error = name + std::strerror(errno);
  if (descriptor >= 0) close(descriptor);
  return isWritten ? std::optional(key) : std::nullopt;
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
