// A file that holds a secret, such as a password: on a command line everybody on the machine could read it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace wobble::transport::vestibule {

// The file's first line, 1 to kMaxCredentialBytes bytes. nullopt with one line in `error` when it is not there, empty
// or longer.
[[nodiscard]] std::optional<std::string> ReadSecret(const std::filesystem::path& file, std::string& error);

}  // namespace wobble::transport::vestibule
