// A sidecar of Agones in this process: agones_model.h over HTTP.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/agones_model.h"

// Must follow Eigen where a test includes it: httplib's system headers define macros that break Eigen.
#include <httplib.h>

namespace wobble::test {

inline constexpr std::chrono::seconds kSidecarPatience{30};

class Sidecar {
 public:
  // record: of the cluster; it outlives a sidecar. port: 0: a free one.
  explicit Sidecar(int port = 0, AgonesModel record = {}) : m_model(std::move(record)) {
    const auto answer = [this](const httplib::Request& request, httplib::Response& response) {
      std::unique_lock lock(m_mutex);
      EXPECT_EQ(request.get_header_value("Content-Type"), request.method == "GET" ? "" : "application/json");
      m_changed.wait(lock, [this] { return !m_isFrozen; });
      const auto delay = m_delay;
      lock.unlock();
      std::this_thread::sleep_for(delay);
      lock.lock();
      const AgonesModel::Answer given = m_model.Take(request.method, request.target, request.body);
      response.status = given.status;
      response.set_content(given.body, "application/json");
      m_changed.notify_all();
    };
    m_server.Get(".*", answer);
    m_server.Post(".*", answer);
    m_server.Patch(".*", answer);
    if (port == 0) {
      m_port = m_server.bind_to_any_port("127.0.0.1");
    } else {
      m_port = m_server.bind_to_port("127.0.0.1", port) ? port : -1;
    }
    EXPECT_GT(m_port, 0);
    m_thread = std::thread([this] { m_server.listen_after_bind(); });
    m_writer = std::thread([this] { Write(); });
    while (!m_server.is_running()) std::this_thread::yield();
  }
  ~Sidecar() {
    Freeze(false);
    {
      const std::lock_guard lock(m_mutex);
      m_isEnding = true;
      m_changed.notify_all();
    }
    m_writer.join();
    m_server.stop();
    m_thread.join();
  }

  [[nodiscard]] std::uint16_t Port() const { return static_cast<std::uint16_t>(m_port); }

  // Accepts requests and does nothing until it is thawed; then it does them all.
  void Freeze(bool isFrozen) {
    const std::lock_guard lock(m_mutex);
    m_isFrozen = isFrozen;
    m_changed.notify_all();
  }

  // Changes or reads the model, its clock stopped.
  void Touch(const std::function<void(AgonesModel&)>& touch) {
    const std::lock_guard lock(m_mutex);
    touch(m_model);
  }
  [[nodiscard]] AgonesModel Read() {
    const std::lock_guard lock(m_mutex);
    return m_model;
  }
  // From now on does and answers everything so much later.
  void Delay(std::chrono::milliseconds delay) {
    const std::lock_guard lock(m_mutex);
    m_delay = delay;
  }

  // Waits until the model is as wanted, and returns it; fails the test when it does not become so.
  AgonesModel WaitUntil(const std::function<bool(const AgonesModel&)>& isSo) {
    std::unique_lock lock(m_mutex);
    EXPECT_TRUE(m_changed.wait_for(lock, kSidecarPatience, [&] { return isSo(m_model); }))
        << m_model.state << ", " << m_model.count << " players, " << m_model.values.size() << " listed";
    return m_model;
  }

 private:
  // The model's clock.
  void Write() {
    const auto begin = std::chrono::steady_clock::now();
    std::unique_lock lock(m_mutex);
    while (!m_isEnding) {
      m_model.Write(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      m_changed.notify_all();
      m_changed.wait_for(lock, std::chrono::milliseconds(50));
    }
  }

  httplib::Server m_server;
  int m_port = -1;
  std::mutex m_mutex;  // guards what follows
  std::chrono::milliseconds m_delay{0};
  std::condition_variable m_changed;
  AgonesModel m_model;
  bool m_isFrozen = false;
  bool m_isEnding = false;
  std::thread m_thread;
  std::thread m_writer;
};

}  // namespace wobble::test
