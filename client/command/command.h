// Shared by the commands of `wobble`: how main.cpp sees them, and the checks of their options.
//
// CLI11 takes seconds to compile, so it is declared here and included only in the sources that use it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "client/command/exit_codes.h"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace wobble::command {

// True from the first Ctrl-C (or SIGTERM, SIGHUP) on.
using IsStopAsked = std::function<bool()>;

// One command of the program.
struct Command {
  CLI::App* words = nullptr;                   // its options; owned by the program's App
  std::function<int(const IsStopAsked&)> run;  // once they have been parsed; returns the exit code
  bool takesEnvironment = false;               // of a service: its options are also variables (usage/command_line.h)
};

// Checks that an option is a number from `least` to `most`. CLI::Range lets "nan" through.
[[nodiscard]] CLI::Validator Within(double least, double most);

// The folder of the running program.
[[nodiscard]] std::filesystem::path FindProgramFolder();
// A folder or file that is shipped, such as "scripts", "page" or "worlds.toml": beside the program, as in a build
// folder, or in ../share/wobble, as installed. Returns the latter, though missing, when neither is there.
[[nodiscard]] std::filesystem::path FindShipped(const std::string& name);

}  // namespace wobble::command
