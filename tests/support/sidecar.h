// A sidecar of Agones in this process: answers requests and stores them.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

// Must follow Eigen where a test includes it: httplib's system headers define macros that break Eigen.
#include <httplib.h>

namespace wobble::test {

inline constexpr std::chrono::seconds kSidecarPatience{20};

// Answers requests and stores method, target and body of each: "POST /ready {}".
class Sidecar {
 public:
  explicit Sidecar(int port = 0) {
    const auto answer = [this](const httplib::Request& request, httplib::Response& response) {
      const std::lock_guard lock(m_mutex);
      EXPECT_EQ(request.get_header_value("Content-Type"), "application/json");
      m_requests.push_back(request.method + " " + request.target + " " + request.body);
      const auto refusal = m_refusals.find(request.target);
      response.status = refusal == m_refusals.end() ? 200 : refusal->second;
      response.set_content("{}", "application/json");
      m_changed.notify_all();
    };
    m_server.Post(".*", answer);
    m_server.Patch(".*", answer);
    if (port == 0) {
      m_port = m_server.bind_to_any_port("127.0.0.1");
    } else {
      m_port = m_server.bind_to_port("127.0.0.1", port) ? port : -1;
    }
    EXPECT_GT(m_port, 0);
    m_thread = std::thread([this] { m_server.listen_after_bind(); });
    while (!m_server.is_running()) std::this_thread::yield();
  }
  ~Sidecar() {
    m_server.stop();
    m_thread.join();
  }

  [[nodiscard]] std::uint16_t Port() const { return static_cast<std::uint16_t>(m_port); }

  // From now on answers requests to this target with this status; 0: normal answers.
  void Refuse(const std::string& target, int status) {
    const std::lock_guard lock(m_mutex);
    if (status == 0) {
      m_refusals.erase(target);
    } else {
      m_refusals[target] = status;
    }
  }

  // Waits for `count` requests and returns all stored ones.
  std::vector<std::string> WaitFor(std::size_t count) {
    std::unique_lock lock(m_mutex);
    m_changed.wait_for(lock, kSidecarPatience, [&] { return m_requests.size() >= count; });
    EXPECT_GE(m_requests.size(), count);
    return m_requests;
  }

 private:
  httplib::Server m_server;
  int m_port = -1;
  std::mutex m_mutex;
  std::condition_variable m_changed;
  std::vector<std::string> m_requests;
  std::map<std::string, int> m_refusals;
  std::thread m_thread;
};

}  // namespace wobble::test
