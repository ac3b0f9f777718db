// Where orders come in from outside the game: a Unix socket, HTTP and RCON.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/admin/admin_http.h"
#include "server/admin/admin_socket.h"
#include "server/admin/order_queue.h"
#include "server/admin/rcon_listener.h"
#include "server/program/options.h"

namespace wobble::server {

struct RconDoor {
  ops::Address address;
  std::string password;
};

// Of --rcon and --rcon-password-file. nullopt with one line in `error`, the option in it.
[[nodiscard]] std::optional<RconDoor> ReadRconDoor(const Options& options, std::string& error);

struct OrderDoors {
  admin::OrderQueue queue;
  std::unique_ptr<admin::AdminSocket> socket;
  std::unique_ptr<ops::HttpListener> http;
  std::unique_ptr<admin::RconListener> rcon;

  // Opens those that are asked for. Returns false after it has reported what failed.
  [[nodiscard]] bool Open(const Options& options, const admission::Gate& gate);

 private:
  bool OpenHttp(const Options& options, const admission::Gate& gate);
  bool OpenRcon(const Options& options);
};

}  // namespace wobble::server
