// A TCP download from the server's end to the client's, as fast as the line lets it: what somebody else in the house
// does.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "tests/net/emulator/side.h"

namespace wobble::emulator {

class Download {
 public:
  Download(Side& server, Side& client, const std::string& serverAddress);
  ~Download() { End(); }
  // Stops it. Its mean rate, bit/s.
  double End();

 private:
  int m_sender = -1, m_receiver = -1;  // sockets of the two namespaces
  std::chrono::steady_clock::time_point m_begin;
  std::atomic<std::uint64_t> m_bytes = 0;
  std::jthread m_sending, m_receiving;
};

}  // namespace wobble::emulator
