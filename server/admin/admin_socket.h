// Orders over a Unix socket that only the server's own user can open: a line in, "ok" or "no" and lines of answer out,
// then the end. `echo players | socat - UNIX:PATH` will do.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "server/admin/order_queue.h"

namespace wobble::admin {

class AdminSocket {
 public:
  // queue: outlives the socket. Null with one line in `error`: the path is no socket, or another server answers there.
  [[nodiscard]] static std::unique_ptr<AdminSocket> Listen(const std::string& path, OrderQueue& queue,
                                                           std::string& error);
  // Removes the file.
  ~AdminSocket();

 private:
  AdminSocket(std::string path, int listener, OrderQueue& queue);
  void Run();
  void Serve(int connection);

  std::string m_path;
  int m_listener;
  OrderQueue& m_queue;
  std::atomic<bool> m_isStopping{false};
  std::thread m_thread;  // last: everything else is there when it begins
};

}  // namespace wobble::admin
