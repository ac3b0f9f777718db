#include "client/gateway/outbox.h"

#include <cassert>
#include <utility>

#include "protocol/transport/transport.h"

namespace wobble::gateway {
namespace {

Outbox::Message MakeMessage(std::uint8_t channel, std::span<const std::uint8_t> bytes) {
  Outbox::Message message;
  message.reserve(1 + bytes.size());
  message.push_back(channel);
  message.insert(message.end(), bytes.begin(), bytes.end());
  return message;
}

}  // namespace

void Outbox::Add(std::uint8_t channel, std::span<const std::uint8_t> bytes) {
  m_others.push_back(MakeMessage(channel, bytes));
  m_bytes += m_others.back().size();
}

void Outbox::AddSnapshot(std::span<const std::uint8_t> bytes, double now) {
  m_snapshots.push_back({MakeMessage(static_cast<std::uint8_t>(transport::Channel::kSnapshot), bytes), now});
  m_bytes += m_snapshots.back().message.size();
}

void Outbox::DropLate(double now) {
  for (; HasSnapshot() && m_snapshots.front().since < now - kLongestWait; ++m_dropped) {
    m_bytes -= m_snapshots.front().message.size();
    m_snapshots.pop_front();
  }
}

Outbox::Message Outbox::Take() {
  assert(!IsEmpty());
  if (m_others.empty() || (m_isSnapshotNext && HasSnapshot())) return TakeSnapshot();
  Message message = std::move(m_others.front());
  m_others.pop_front();
  m_bytes -= message.size();
  m_isSnapshotNext = true;
  return message;
}

Outbox::Message Outbox::TakeSnapshot() {
  assert(HasSnapshot());
  Message message = std::move(m_snapshots.front().message);
  m_snapshots.pop_front();
  m_bytes -= message.size();
  m_isSnapshotNext = false;
  return message;
}

}  // namespace wobble::gateway
