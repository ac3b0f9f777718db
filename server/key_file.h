// The file of the server's secret key, by which clients know the server again after a restart.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "protocol/transport/vestibule/keys.h"

namespace wobble::server {

// Reads the key, 64 hexadecimal digits, or makes one and writes it for its owner alone. nullopt with one line in
// `error` when the file holds something else, or can neither be read nor written.
[[nodiscard]] std::optional<transport::vestibule::Key> LoadOrMakeKey(const std::filesystem::path& file,
                                                                     std::string& error);

// Where the key is unless --key says otherwise: server.key in $STATE_DIRECTORY (systemd's), in $XDG_STATE_HOME/wobble,
// or in ~/.local/state/wobble. Empty when none of these is known.
[[nodiscard]] std::filesystem::path FindKeyFile();

}  // namespace wobble::server
