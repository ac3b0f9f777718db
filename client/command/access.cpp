#include "client/command/access.h"

#include <algorithm>
#include <fstream>

#include "client/files/known_servers.h"
#include "protocol/transport/vestibule/key_file.h"
#include "protocol/transport/vestibule/secret_file.h"
#include "protocol/transport/vestibule/token.h"

namespace wobble::command {

namespace vestibule = transport::vestibule;
using vestibule::Credential;

namespace {

// People paste the whole link; the invite is what follows this.
constexpr std::string_view kInviteMark = "#invite=";

// Finds the invite in what `wobble admin invite` prints, which has other lines, too; empty: the file has none.
std::string FindInviteLink(const std::string& file) {
  constexpr std::streamsize kMostBytes = 4096;
  std::ifstream in(file, std::ios::binary);
  std::string text(static_cast<std::size_t>(kMostBytes), '\0');
  in.read(text.data(), kMostBytes);
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  const std::size_t mark = text.find(kInviteMark);
  if (mark == std::string::npos) return "";
  const std::size_t begin = mark + kInviteMark.size();
  return text.substr(begin, text.find_first_of(" \r\n\t", begin) - begin);
}

// Reads the credential in a file's first line, or an invite in any; nullopt with one line in `error`.
std::optional<Credential> ReadCredentialFile(const char* option, const std::string& file, Credential::Kind kind,
                                             std::string& error) {
  const auto line = vestibule::ReadSecret(file, error);
  if (!line) {
    error = std::string(option) + ": " + error;
    return {};
  }
  if (kind == Credential::Kind::kPassword) return Credential{kind, {line->begin(), line->end()}};
  const std::string link = kind == Credential::Kind::kInvite ? FindInviteLink(file) : "";
  const auto bytes = vestibule::ParseSecret(link.empty() ? *line : link);
  if (bytes && bytes->size() <= vestibule::kMaxCredentialBytes) return Credential{kind, *bytes};
  error = std::string(option) + ": " + file + ": the first line must be what the server or its matchmaker gave out";
  return {};
}

// Reads what the files of a server on this machine say of its owner.
void FindOwnServer(transport::ConnectOptions& options) {
  const auto find = [](const char* name) -> std::optional<vestibule::Key> {
    const std::filesystem::path file = vestibule::FindStateFile(name);
    std::string ignored;  // most people have no server
    return file.empty() ? std::nullopt : vestibule::LoadKey(file, ignored);
  };
  const auto server = find(vestibule::kServerKeyName), owner = find(vestibule::kOwnerKeyName);
  if (!server || !owner) return;
  options.ownServer = vestibule::MakeKeyPair(*server).publicKey;
  options.ownCredential = {Credential::Kind::kOwnerKey, {owner->begin(), owner->end()}};
}

}  // namespace

void AddAccessOptions(CLI::App& command, Access& access, Visitor visitor) {
  const auto addFile = [&](const char* name, std::string& file, const char* description) {
    return command.add_option(name, file, description)->type_name("FILE");
  };
  CLI::Option* password = addFile("--password-file", access.passwordFile, "File whose first line is the password");
  CLI::Option* invite = addFile("--invite-file", access.inviteFile,
                                "File with an invite: what wobble admin invite prints, the link, or the invite alone");
  CLI::Option* token = addFile("--token-file", access.tokenFile, "File whose first line is a token (wobble token)");
  CLI::Option* owner = addFile("--owner-key", access.ownerKeyFile,
                               visitor == Visitor::kPerson
                                   ? "File of the server's owner key; not needed for your own server on this machine"
                                   : "File of the server's owner key");
  for (CLI::Option* each : {invite, token, owner}) each->excludes(password);
  token->excludes(invite);
  owner->excludes(invite)->excludes(token);
  command
      .add_option("--server-key", access.serverKey,
                  std::string("The server's key, 64 hexadecimal digits as it prints them; else the one that ") +
                      (visitor == Visitor::kPerson ? "was noted at the first visit" : "`wobble watch` has noted") +
                      " (known_servers in the user's data folder; keys of servers on this machine are not noted)")
      ->type_name("KEY");
}

bool FindAccess(const Access& access, const Address& server, Visitor visitor, transport::ConnectOptions& options,
                std::string& error) {
  const auto read = [&](const char* option, const std::string& file, Credential::Kind kind) {
    if (file.empty()) return true;
    auto credential = ReadCredentialFile(option, file, kind, error);
    if (credential) options.credential = std::move(*credential);
    return credential.has_value();
  };
  if (!read("--password-file", access.passwordFile, Credential::Kind::kPassword) ||
      !read("--invite-file", access.inviteFile, Credential::Kind::kInvite) ||
      !read("--token-file", access.tokenFile, Credential::Kind::kToken)) {
    return false;
  }
  if (!access.ownerKeyFile.empty()) {
    const auto key = vestibule::LoadKey(access.ownerKeyFile, error);
    if (!key) {
      error = "--owner-key: " + error;
      return false;
    }
    options.credential = {Credential::Kind::kOwnerKey, {key->begin(), key->end()}};
  }
  if (visitor == Visitor::kPerson) FindOwnServer(options);
  options.serverKey = access.serverKey.empty()
                          ? files::KnownServers(files::FindKnownServersFile()).Find(Describe(server))
                          : vestibule::ParseKey(access.serverKey);
  if (access.serverKey.empty() || options.serverKey) return true;
  error = "--server-key: '" + access.serverKey + "' must be 64 hexadecimal digits";
  return false;
}

std::string AdviseOn(const std::string& reason, const Address& server) {
  const files::KnownServers known(files::FindKnownServersFile());
  if (reason != transport::kWrongServerReason || !known.Find(Describe(server))) return "";
  return "; if its host says that it has a new one, delete the line of " + Describe(server) + " in " +
         known.File().string();
}

void NoteServer(const Address& server, const transport::EnetTransport& transport) {
  files::KnownServers(files::FindKnownServersFile()).Note(Describe(server), transport.ReadServerKey());
}

}  // namespace wobble::command
