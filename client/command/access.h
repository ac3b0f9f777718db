// How a command gets into a server: the password, and the key that the server must have.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "client/command/address.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::command {

struct Access {
  std::string passwordFile;  // empty: none
  std::string serverKey;     // 64 hexadecimal digits; empty: the one noted for the address, or any
};

// Declares --password-file and --server-key; parsing then writes into `access`, which outlives the command.
void AddAccessOptions(CLI::App& command, Access& access);

// Reads the password, and the key that is noted for the address. False with one line in `error`.
[[nodiscard]] bool FindAccess(const Access& access, const Address& server, transport::ConnectOptions& options,
                              std::string& error);

// Notes the key of a server that this user has joined for the first time. Call it once it plays.
void NoteServer(const Address& server, const transport::EnetTransport& transport);

}  // namespace wobble::command
