// Orders on their way from the threads that take them to the thread of the ticks, and the answers back.
#pragma once

#include <chrono>
#include <future>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/admin/orders.h"

namespace wobble::admin {

class OrderQueue {
 public:
  // From any thread; waits until the order has been carried out, or for `patience`. way: see Issuer.
  [[nodiscard]] Answer Ask(std::string line, const char* way, std::chrono::milliseconds patience) {
    std::future<Answer> answer;
    {
      const std::lock_guard lock(m_mutex);
      if (m_waiting.size() >= kMostWaiting) return {.isDone = false, .lines = {"too many orders at once"}};
      answer = m_waiting.emplace_back(std::move(line), way, std::promise<Answer>()).answer.get_future();
    }
    if (answer.wait_for(patience) == std::future_status::ready) return answer.get();
    return {.isDone = false, .lines = {"the server does not answer; the order may still be carried out"}};
  }

  // On the thread of the ticks, between two of them. now: s.
  void CarryOutAll(const Realm& realm, double now) {
    std::vector<Waiting> waiting;
    {
      const std::lock_guard lock(m_mutex);
      waiting.swap(m_waiting);
    }
    for (Waiting& each : waiting) each.answer.set_value(CarryOut(realm, {.way = each.way}, each.line, now));
  }

 private:
  struct Waiting {
    std::string line;
    const char* way;
    std::promise<Answer> answer;
  };
  static constexpr std::size_t kMostWaiting = 64;

  std::mutex m_mutex;  // over what follows
  std::vector<Waiting> m_waiting;
};

}  // namespace wobble::admin
