// The size is not asked for but found by reading: files of /proc have none, and a file may grow.
#include "server/scenes/text_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace wobble::scenes {
namespace {

const char* Describe(std::filesystem::file_type type) {
  using Type = std::filesystem::file_type;
  switch (type) {
    case Type::directory:
      return "a directory";
    case Type::fifo:
      return "a FIFO";
    case Type::socket:
      return "a socket";
    case Type::block:
    case Type::character:
      return "a device";
    default:
      return "something else";
  }
}

}  // namespace

std::string ReadTextFile(const std::filesystem::path& path, std::size_t maxBytes, std::string& text) {
  const std::string wanted = "a regular file of at most " + std::to_string(maxBytes >> 20) + " MiB";
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return "cannot be read: there is no such file";
  if (error) return "cannot be read: " + error.message();
  if (!std::filesystem::is_regular_file(status))
    return "is " + std::string(Describe(status.type())) + ", not " + wanted;
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  text.resize(maxBytes + 1);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file && !file.eof()) return std::string("cannot be read: ") + std::strerror(errno);
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text.size() > maxBytes ? "is larger than " + wanted : "";
}

}  // namespace wobble::scenes
