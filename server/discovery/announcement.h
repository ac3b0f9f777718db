// Announces a world in the local network, by DNS-SD over multicast DNS (RFC 6763, RFC 6762) as the service
// _wobble._udp, so that `wobble list` and other browsers of services find it.
//
// By Avahi's daemon where one runs; where none does, the server answers for itself. All of it is on a thread of its
// own.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "protocol/transport/vestibule/query_desk.h"

namespace wobble::discovery {

class Announcement {
 public:
  // pictures: the first one begins the announcement; a new name or scene renews it.
  explicit Announcement(std::shared_ptr<transport::vestibule::PictureSlot> pictures);
  // Withdraws it.
  ~Announcement();

 private:
  void Run();

  std::shared_ptr<transport::vestibule::PictureSlot> m_pictures;
  std::atomic<bool> m_isStopping{false};
  std::thread m_thread;  // last: everything else is there when it begins
};

}  // namespace wobble::discovery
