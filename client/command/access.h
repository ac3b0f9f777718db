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

// Whose command it is: it says what is shown and noted without being asked for.
enum class Visitor {
  kPerson,   // shows the owner's key to the servers of this user on this machine; notes the keys of servers
  kProgram,  // neither
};

// Declares --password-file, --invite-file, --token-file, --owner-key and --server-key; parsing then writes into
// `access`, which outlives the command.
void AddAccessOptions(CLI::App& command, Access& access, Visitor visitor);

// Reads the files, and the key that is noted for the address. kPerson: to the servers of this user on this machine,
// which leave their keys in its state folder, it shows the owner's key. False with one line in `error`.
[[nodiscard]] bool FindAccess(const Access& access, const Address& server, Visitor visitor,
                              transport::ConnectOptions& options, std::string& error);

// Notes the key of a server that this user has joined for the first time. Call it once it plays.
void NoteServer(const Address& server, const transport::EnetTransport& transport);

// Explains the reason for which a server could not be joined: says where the key is noted that it does not have; empty:
// there is nothing to add.
[[nodiscard]] std::string AdviseOn(const std::string& reason, const Address& server);

}  // namespace wobble::command
