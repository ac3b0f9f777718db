// A file or folder that is there whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace wobble::exporting {

// What is written lies beside its place, under the same name with ".partial" behind, until it is committed.
class Output {
 public:
  // isFolder: it begins as an empty folder.
  Output(const std::filesystem::path& target, bool isFolder);
  // Removes what was not committed.
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  // What is wrong with the place, in words that follow its name; empty: nothing. A file is replaced, but
  // never a recording: it may be the one that is exported. A folder must be empty or not there. Called once, before anything is written.
  [[nodiscard]] std::string Begin();
  [[nodiscard]] std::string Commit();

  [[nodiscard]] const std::filesystem::path& Target() const { return m_target; }    // without a final '/'
  [[nodiscard]] const std::filesystem::path& Partial() const { return m_partial; }  // where to write

 private:
  std::filesystem::path m_target;
  std::filesystem::path m_partial;
  bool m_isFolder = false;
  bool m_isBegun = false;
};

// Why writing has failed just now, by the system's words, behind the file's name.
[[nodiscard]] std::string DescribeWriteError();

// Bytes of a file, or of the files of a folder.
[[nodiscard]] std::uintmax_t CountBytes(const std::filesystem::path& path);

}  // namespace wobble::exporting
