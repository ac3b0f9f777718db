// The gate of a server from the files that its options name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/admission/gate.h"

namespace wobble::admission {

// Paths; empty: not given.
struct GateFiles {
  std::string password;
  std::string tokenKey;  // made if it is not there, as the other keys are
  std::string ownerKey;  // empty: owner.key in the user's state folder, if it can be kept there
  std::string gatewayKey;
  std::string invites;  // with it only who is invited may come in, or who has a password or token
  std::string bans;
  bool givesTicketsToAll = false;  // GateSettings
};

// Null with one line in `error` that names the option.
[[nodiscard]] std::shared_ptr<Gate> OpenGate(const GateFiles& files, const transport::vestibule::Key& secretKey,
                                             std::function<std::uint64_t()> readUnixTime, std::string& error);

// Reads the files again: passwords, keys, bans and invites that others have changed. Who is in stays in. False with one
// line in `error` that names the option; then nothing has changed.
[[nodiscard]] bool ReloadGate(const GateFiles& files, Gate& gate, std::string& error);

// What OpenGate would refuse, one line for each file; nothing is made. A key that is not there is no mistake.
[[nodiscard]] std::vector<std::string> FindMistakes(const GateFiles& files);

// The files that everybody on this machine can read, of those that hold a secret. others: files beside the gate's, the
// server's key among them; some may be empty.
[[nodiscard]] std::vector<std::string> FindReadableByAll(const GateFiles& files, std::vector<std::string> others);

// Where the owner's key is.
[[nodiscard]] std::string FindOwnerKeyFile(const GateFiles& files);

}  // namespace wobble::admission
