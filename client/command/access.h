// How a command gets into a server: what it shows, and the key that the server must have.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "client/command/address.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::command {

// Files; empty: not given. At most one of the first four.
struct Access {
  std::string passwordFile;
  std::string inviteFile;
  std::string tokenFile;
  std::string ownerKeyFile;
  std::string serverKey;  // 64 hexadecimal digits; empty: the one noted for the address, or any
};

// Declares --password-file, --invite-file, --token-file, --owner-key and --server-key; parsing then writes into
// `access`, which outlives the command.
void AddAccessOptions(CLI::App& command, Access& access);

// Reads the files, and the key that is noted for the address. isOwner: to the servers of this user on this machine,
// which leave their keys in its state folder, it shows the owner's key. False with one line in `error`.
[[nodiscard]] bool FindAccess(const Access& access, const Address& server, bool isOwner,
                              transport::ConnectOptions& options, std::string& error);

// Notes the key of a server that this user has joined for the first time. Call it once it plays.
void NoteServer(const Address& server, const transport::EnetTransport& transport);

}  // namespace wobble::command
