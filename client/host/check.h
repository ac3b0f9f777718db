// Asks the programs themselves whether they would start with what a file says: `wobbled --check` and `wobble gateway
// --check`. So ranges, scenes and files are judged in one place, which is theirs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/host/worlds_file.h"

namespace wobble::host {

// Every mistake that the programs name, each with the line or the variable that it comes from, in the form of
// WorldsFile::errors. folder: of FindStateFolder. Takes a tenth of a second a world.
[[nodiscard]] std::vector<std::string> CheckWithPrograms(const WorldsFile& file, const std::filesystem::path& folder,
                                                         const std::filesystem::path& programFolder);

// What a program complained of, in the words of the file: "--max-clients 5000: must be 1 to 4000" becomes
// "worlds.toml:7: max_clients = 5000: must be 1 to 4000". refused: the key, empty when the line names none of `values`;
// then `otherwise` stands before the line.
[[nodiscard]] std::string Translate(const std::string& line, const Values& values, const std::string& otherwise,
                                    std::string& refused);

}  // namespace wobble::host
