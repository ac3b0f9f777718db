#include "client/command/command.h"

#include <CLI/CLI.hpp>
#include <cstdio>

namespace wobble::command {

CLI::Validator Within(double least, double most) {
  char range[64];
  std::snprintf(range, sizeof range, "%g to %.16g", least, most);
  const std::string allowed = range;
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0;
        const bool isNumber = CLI::detail::lexical_cast(text, value);
        return isNumber && value >= least && value <= most ? std::string() : "'" + text + "' is not " + allowed;
      },
      allowed);
}

std::filesystem::path FindProgramFolder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

std::filesystem::path FindShipped(const std::string& name) {
  const std::filesystem::path programs = FindProgramFolder();
  std::error_code error;
  if (std::filesystem::exists(programs / name, error)) return programs / name;
  return programs.parent_path() / "share" / "wobble" / name;
}

}  // namespace wobble::command
