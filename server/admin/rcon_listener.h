// Listens for RCON (rcon.h) on a thread of its own. Not encrypted: for this machine, or a private network.
//
// Who has not shown the password has five seconds for it, and makes room for who comes later. Who has shown it may be
// silent for ten minutes, but has five seconds for each packet and to take each answer.
#pragma once

#include <memory>
#include <string>

#include "server/admin/order_queue.h"
#include "server/ops/address.h"

namespace wobble::admin {

class RconListener {
 public:
  static constexpr std::size_t kMostConnections = 16;
  static constexpr std::size_t kMostPerAddress = 8;

  // password: not empty. queue: outlives the listener. Null with one line in `error`.
  [[nodiscard]] static std::unique_ptr<RconListener> Listen(const ops::Address& address, const std::string& password,
                                                            OrderQueue& queue, std::string& error);
  // Closes all connections and joins the thread, after the order that is under way.
  ~RconListener();

  // The TCP port, whether given or picked by the system.
  [[nodiscard]] std::uint16_t ReadPort() const;

 private:
  struct Implementation;
  explicit RconListener(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::admin
