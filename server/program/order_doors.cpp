#include "server/program/order_doors.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "protocol/transport/vestibule/secret_file.h"

namespace wobble::server {

std::optional<RconDoor> ReadRconDoor(const Options& options, std::string& error) {
  RconDoor door;
  if (options.rcon.empty()) {
    error = "--rcon must be given with --rcon-password-file";
  } else if (options.rconPasswordFile.empty()) {
    error = "--rcon " + options.rcon + ": there is no password (see --rcon-password-file)";
  } else if (!ops::ParseAddress(options.rcon, door.address, error)) {
    error = "--rcon " + error;
  } else if (const auto password = transport::vestibule::ReadSecret(options.rconPasswordFile, error)) {
    door.password = *password;
    return door;
  } else {
    error = "--rcon-password-file: " + error;
  }
  return {};
}

bool OrderDoors::Open(const Options& options, const admission::Gate& gate) {
  std::string error;
  if (!options.adminSocket.empty()) {
    socket = admin::AdminSocket::Listen(options.adminSocket, queue, error);
    if (socket == nullptr) return Complain(options, {"--admin-socket " + error}), false;
  }
  if (!options.adminHttp.empty() && !OpenHttp(options, gate)) return false;
  return (options.rcon.empty() && options.rconPasswordFile.empty()) || OpenRcon(options);
}

bool OrderDoors::OpenHttp(const Options& options, const admission::Gate& gate) {
  std::string error;
  ops::Address address;
  if (!gate.OwnerKey()) {
    error = options.adminHttp + ": there is no owner's key (see --owner-key)";
  } else if (ops::ParseAddress(options.adminHttp, address, error)) {
    http = admin::ListenForOrders(address, *gate.OwnerKey(), queue, error);
  }
  if (http == nullptr) return Complain(options, {"--admin-http " + error}), false;
  fmt::print("orders on TCP port {} of {}\n", http->ReadPort(), address.host);
  if (!ops::IsThisMachine(address)) {
    spdlog::warn("--admin-http {}: other machines reach it, and what is sent, the owner's key too, is not encrypted",
                 options.adminHttp);
  }
  return true;
}

bool OrderDoors::OpenRcon(const Options& options) {
  std::string error;
  const auto door = ReadRconDoor(options, error);
  if (!door) return Complain(options, {error}), false;
  rcon = admin::RconListener::Listen(door->address, door->password, queue, error);
  if (rcon == nullptr) return Complain(options, {"--rcon " + error}), false;
  fmt::print("RCON on TCP port {} of {}\n", rcon->ReadPort(), door->address.host);
  if (!ops::IsThisMachine(door->address)) {
    spdlog::warn("--rcon {}: other machines reach it, and what is sent, the password too, is not encrypted",
                 options.rcon);
  }
  return true;
}

}  // namespace wobble::server
