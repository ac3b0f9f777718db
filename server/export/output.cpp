#include "server/export/output.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "server/recording/block_file.h"

namespace wobble::exporting {

namespace fs = std::filesystem;

Output::Output(const fs::path& target, bool isFolder)
    : m_target((target / "").parent_path()), m_partial(m_target), m_isFolder(isFolder) {
  m_partial += ".partial";
}

Output::~Output() {
  std::error_code error;
  if (m_isBegun) fs::remove_all(m_partial, error);
}

std::string Output::Begin() {
  std::error_code error;
  const fs::file_status status = fs::status(m_target, error);
  const bool isThere = fs::exists(status);
  if (isThere && m_isFolder && !(fs::is_directory(status) && fs::is_empty(m_target, error))) {
    return "is there already: must be a new or an empty folder";
  }
  // A rename would replace a device by a file.
  if (isThere && !m_isFolder && !fs::is_regular_file(status)) return "must be a file";
  if (recording::IsBlockFile(m_target)) return "is a recording or a state of wobble: must be another file";
  if (fs::exists(m_partial, error)) {
    return "cannot be begun: " + m_partial.string() + " is there, of an export that runs or was killed";
  }
  errno = 0;
  m_isBegun = m_isFolder ? fs::create_directory(m_partial, error) : std::ofstream(m_partial).is_open();
  return m_isBegun ? "" : DescribeWriteError();
}

std::string Output::Commit() {
  std::error_code error;
  fs::rename(m_partial, m_target, error);
  if (error) return "cannot be written: " + error.message();
  m_isBegun = false;
  return {};
}

std::string DescribeWriteError() {
  return std::string("cannot be written") + (errno != 0 ? ": " : "") + (errno != 0 ? std::strerror(errno) : "");
}

std::uintmax_t CountBytes(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return fs::file_size(path, error);
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(path, error)) bytes += entry.file_size(error);
  return bytes;
}

}  // namespace wobble::exporting
