// Files that hold a secret key: a server's own, by which clients know it again, its owner's, a matchmaker's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "protocol/transport/vestibule/keys.h"

namespace wobble::transport::vestibule {

// Reads a key, 64 hexadecimal digits. nullopt with one line in `error`.
[[nodiscard]] std::optional<Key> LoadKey(const std::filesystem::path& file, std::string& error);

// Reads the key, or makes one and writes it for its owner alone. nullopt with one line in `error` when the file holds
// something else, or can neither be read nor written.
[[nodiscard]] std::optional<Key> LoadOrMakeKey(const std::filesystem::path& file, std::string& error);

// A file in $STATE_DIRECTORY (systemd's), in $XDG_STATE_HOME/wobble, or in ~/.local/state/wobble. Empty when none of
// these is known.
[[nodiscard]] std::filesystem::path FindStateFile(const std::string& name);
// The keys that a server has unless it is told otherwise.
inline constexpr const char* kServerKeyName = "server.key";
inline constexpr const char* kOwnerKeyName = "owner.key";

}  // namespace wobble::transport::vestibule
