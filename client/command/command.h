// What the commands of `wobble` have in common: how main.cpp sees them, and the readers of their options.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>

#include "client/command/exit_codes.h"

namespace wobble::tool {

// True from the first Ctrl-C (or SIGTERM, SIGHUP) on.
using IsStopAsked = std::function<bool()>;

// One command: what it is called with, and what it does once that has been parsed. run returns the exit code.
struct Command {
  CLI::App* words = nullptr;
  std::function<int(const IsStopAsked&)> run;
};

// A number from least to most; CLI::Range lets "nan" through.
[[nodiscard]] CLI::Validator Within(double least, double most);

// The folder of the running program.
[[nodiscard]] std::filesystem::path FindProgramFolder();
// A folder that is shipped, such as "scripts" or "page": beside the program, as in a build folder, or in
// ../share/wobble, as installed. The latter is returned, though missing, when there is neither.
[[nodiscard]] std::filesystem::path FindShippedFolder(const std::string& name);

}  // namespace wobble::tool
