// What recordings a folder has, found without playing or unpacking them whole.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobble::recording {

struct CatalogueEntry {
  std::string file;   // its name in the folder
  std::string scene;  // empty: it cannot be read
  double length = 0;  // s
  std::filesystem::file_time_type writtenAt;
  std::string fault;  // why it cannot be shown; empty: it can
  // What its blocks' heads and sizes say of damage, and up to where it is shown; empty: nothing. Damage inside a block
  // is found when it is read whole: of a hundred files that would be gigabytes each time.
  std::string damage;
};

// The recordings (*.wobrec) of the folder, the newest first, `most` of them. Reads a few bytes of each block, and three
// blocks whole: milliseconds for an hour. Empty if there is no such folder.
[[nodiscard]] std::vector<CatalogueEntry> ListRecordings(const std::filesystem::path& folder, std::size_t most);

}  // namespace wobble::recording
