// Asks a server's administration to carry out an order.
#pragma once

#include <string>

namespace wobble::admin {

struct Reply {
  bool isDone = false;
  std::string text;  // lines, each ended by a newline; where the order did not get through, the reason
};

// By the Unix socket of --admin-socket.
[[nodiscard]] Reply AskSocket(const std::string& path, const std::string& order);
// By HTTP. key: of the owner, 64 hexadecimal digits.
[[nodiscard]] Reply AskHttp(const std::string& host, int port, const std::string& key, const std::string& order);

}  // namespace wobble::admin
