// How names are written in variables of the environment.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace wobble::usage {

// "MAX_CLIENTS" of "max-clients" and of "max_clients".
[[nodiscard]] inline std::string InCapitals(std::string_view name) {
  std::string capitals;
  for (const char c : name) {
    capitals += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return capitals;
}

}  // namespace wobble::usage
