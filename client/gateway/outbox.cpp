// One queue for all channels keeps their order: a browser on a good link receives what a native client does. The oldest
// snapshot is found by a linear search, past at most a thousand control messages of 4 KiB.
#include "client/gateway/outbox.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "protocol/transport/transport.h"

namespace wobble::gateway {
namespace {

bool IsSnapshot(const Outbox::Message& message) {
  return message[0] == static_cast<std::uint8_t>(transport::Channel::kSnapshot);
}

}  // namespace

void Outbox::Add(std::uint8_t channel, std::span<const std::uint8_t> bytes) {
  Message message;
  message.reserve(1 + bytes.size());
  message.push_back(channel);
  message.insert(message.end(), bytes.begin(), bytes.end());
  m_bytes += message.size();
  if (IsSnapshot(message)) m_snapshotBytes += message.size();
  m_messages.push_back(std::move(message));
  while (m_snapshotBytes > kMaxWaitingSnapshotBytes) DropOldestSnapshot();
}

Outbox::Message Outbox::Take() {
  assert(!m_messages.empty());
  Message message = std::move(m_messages.front());
  m_messages.pop_front();
  m_bytes -= message.size();
  if (IsSnapshot(message)) m_snapshotBytes -= message.size();
  return message;
}

void Outbox::DropOldestSnapshot() {
  const auto oldest = std::find_if(m_messages.begin(), m_messages.end(), IsSnapshot);
  m_bytes -= oldest->size();
  m_snapshotBytes -= oldest->size();
  m_messages.erase(oldest);
  ++m_dropped;
}

}  // namespace wobble::gateway
