#include "client/command/access.h"

#include "client/files/known_servers.h"
#include "protocol/transport/vestibule/secret_file.h"

namespace wobble::command {

void AddAccessOptions(CLI::App& command, Access& access) {
  command.add_option("--password-file", access.passwordFile, "File whose first line is the server's password")
      ->type_name("FILE");
  command
      .add_option("--server-key", access.serverKey,
                  "The server's key, 64 hexadecimal digits as it prints them; else the one that was noted at the first "
                  "visit (known_servers in the user's data folder)")
      ->type_name("KEY");
}

bool FindAccess(const Access& access, const Address& server, transport::ConnectOptions& options, std::string& error) {
  if (!access.passwordFile.empty()) {
    const auto password = transport::vestibule::ReadSecret(access.passwordFile, error);
    if (!password) {
      error = "--password-file: " + error;
      return false;
    }
    options.credential = {.kind = transport::vestibule::Credential::Kind::kPassword,
                          .bytes = {password->begin(), password->end()}};
  }
  options.serverKey = access.serverKey.empty()
                          ? files::KnownServers(files::FindKnownServersFile()).Find(Describe(server))
                          : transport::vestibule::ParseKey(access.serverKey);
  if (access.serverKey.empty() || options.serverKey) return true;
  error = "--server-key: '" + access.serverKey + "' must be 64 hexadecimal digits";
  return false;
}

void NoteServer(const Address& server, const transport::EnetTransport& transport) {
  files::KnownServers(files::FindKnownServersFile()).Note(Describe(server), transport.ReadServerKey());
}

}  // namespace wobble::command
