// Records the events that a client hears.
#pragma once

#include <cstdint>
#include <vector>

#include "client/client.h"

namespace wobble::test {

struct Ear {
  explicit Ear(client::Client& client) {
    client.OnEvent([this](const client::Client::Event& event) { events.push_back(event); });
  }
  [[nodiscard]] int Count(protocol::wire::EventKind kind, std::uint32_t body) const {
    int count = 0;
    for (const auto& event : events) count += event.kind == kind && event.body == body ? 1 : 0;
    return count;
  }
  std::vector<client::Client::Event> events;
};

}  // namespace wobble::test
