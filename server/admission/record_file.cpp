#include "server/admission/record_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

namespace wobble::admission {

namespace {

constexpr std::streamsize kMostBytes = 1024 * 1024;

}  // namespace

bool ReadLines(const std::filesystem::path& file, std::vector<std::string>& lines, std::string& error) {
  lines.clear();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return true;
  std::ifstream in(file, std::ios::binary);
  std::string text(static_cast<std::size_t>(kMostBytes) + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad() || !in.eof()) {
    error = file.string() + ": cannot be read, or has more than " + std::to_string(kMostBytes) + " bytes";
    return false;
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  }
  return true;
}

bool WriteLines(const std::filesystem::path& file, const std::string& comment, const std::vector<std::string>& lines,
                std::string& error) {
  std::string text = "# " + comment + "\n";
  for (const std::string& line : lines) text += line + "\n";
  const std::string draft = file.string() + "." + std::to_string(getpid());
  const int descriptor = open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
  bool isWritten = descriptor >= 0 &&
                   write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                   fsync(descriptor) == 0;
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  std::error_code failure;
  if (isWritten) {
    std::filesystem::rename(draft, file, failure);
    isWritten = !failure;
  }
  if (isWritten) return true;
  error = file.string() + ": " + (failure ? failure.message() : std::strerror(reason));
  unlink(draft.c_str());
  return false;
}

}  // namespace wobble::admission
