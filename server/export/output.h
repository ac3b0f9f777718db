// A file or folder that is there whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace wobble::exporting {

// What is written lies beside its place, under the same name with ".partial" behind, until it is committed.
class Output {
 public:
  // isFolder: it begins as an empty folder. replaces: what is there may be replaced, if it is an export.
  Output(const std::filesystem::path& target, bool isFolder, bool replaces = false);
  // Removes what was not committed.
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  // What is wrong with the place, in words that follow its name; empty: nothing. Never is a recording replaced, which
  // may be the one that is exported, nor a folder that has other files than VTK's. Called once, before anything is
  // written.
  [[nodiscard]] std::string Begin();
  [[nodiscard]] std::string Commit();

  [[nodiscard]] const std::filesystem::path& Target() const { return m_target; }    // without a final '/'
  [[nodiscard]] const std::filesystem::path& Partial() const { return m_partial; }  // where to write

 private:
  // What of it keeps it from being replaced; empty: nothing.
  [[nodiscard]] std::string FindHindrance() const;

  std::filesystem::path m_target;
  std::filesystem::path m_partial;
  bool m_isFolder = false;
  bool m_replaces = false;
  bool m_isBegun = false;
};

// Why writing has failed just now, by the system's words, behind the file's name.
[[nodiscard]] std::string DescribeWriteError();

// Bytes of a file, or of the files of a folder.
[[nodiscard]] std::uintmax_t CountBytes(const std::filesystem::path& path);

}  // namespace wobble::exporting
