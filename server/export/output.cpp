#include "server/export/output.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "server/recording/block_file.h"

namespace wobble::exporting {

namespace fs = std::filesystem;

Output::Output(const fs::path& target, bool isFolder, bool replaces)
    : m_target((target / "").parent_path()), m_partial(m_target), m_isFolder(isFolder), m_replaces(replaces) {
  m_partial += ".partial";
}

Output::~Output() {
  std::error_code error;
  if (m_isBegun) fs::remove_all(m_partial, error);
}

std::string Output::FindHindrance() const {
  std::error_code error;
  const fs::file_status status = fs::status(m_target, error);
  if (!fs::exists(status)) return {};
  if (recording::IsBlockFile(m_target)) return "is a recording or a state of wobble: must be another file";
  if (m_isFolder != fs::is_directory(status)) return m_isFolder ? "is no folder" : "is no file";
  // A rename would replace a device by a file.
  if (!m_isFolder && !fs::is_regular_file(status)) return "is no file";
  if (m_isFolder && fs::is_empty(m_target, error)) return {};
  if (!m_replaces) return "is there already: must be new, or --force given";
  if (!m_isFolder) return {};
  for (const auto& entry : fs::directory_iterator(m_target, error)) {
    const fs::path ending = entry.path().extension();
    if (entry.is_directory(error) || (ending != ".pvd" && ending != ".vtp")) {
      return "is not replaced: it has " + entry.path().filename().string() + ", which is no file of VTK";
    }
  }
  return error ? "cannot be read: " + error.message() : "";
}

std::string Output::Begin() {
  std::string hindrance = FindHindrance();
  if (!hindrance.empty()) return hindrance;
  std::error_code error;
  if (fs::exists(m_partial, error)) {
    return "cannot be begun: " + m_partial.string() + " is there; remove it unless another export writes it";
  }
  errno = 0;
  m_isBegun = m_isFolder ? fs::create_directory(m_partial, error) : std::ofstream(m_partial).is_open();
  return m_isBegun ? "" : DescribeWriteError();
}

std::string Output::Commit() {
  std::error_code error;
  if (m_isFolder && m_replaces) fs::remove_all(m_target, error);
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
