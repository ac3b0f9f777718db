// Messages that the pair has no room for wait here, at most kMostWaiting of them: ENet's thread may be late by a tick
// or two, and the kernel's buffer holds some hundred messages only. Beyond that they are lost, as on a network.
#include "protocol/transport/vestibule/doorkeeper.h"

#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <utility>

namespace wobble::transport::vestibule {
namespace {

constexpr std::size_t kMostWaiting = 16'384;
// Batches of datagrams in one turn, so that a flood does not keep the thread from its other work.
constexpr int kMostBatches = 16;
constexpr double kOverdueEvery = 0.5;
// From so many strangers' datagrams a second on, the thread takes them a millisecond at a time: to wake for each of
// them costs several times what it costs to drop it. Visitors' datagrams then wait a millisecond, too.
constexpr double kFloodRate = 5000;
constexpr double kFloodWindow = 0.05;  // s
constexpr auto kRest = std::chrono::milliseconds(1);
// The longest wait for a datagram, s. Leavers are noted then or with the next datagram, before it is judged.
constexpr double kPatience = 0.025;

double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Doorkeeper::Doorkeeper(UdpSocket socket, Door door, int pairEnd)
    : m_socket(std::move(socket)),
      m_door(std::move(door)),
      m_serverKey(m_door.ServerKey()),
      m_pairEnd(pairEnd),
      m_thread([this] {
        m_socket.SetPatience(kPatience);
        Run();
      }) {}

Doorkeeper::~Doorkeeper() {
  {
    const std::lock_guard lock(m_mutex);
    m_isStopping = true;
  }
  m_thread.join();
  close(m_pairEnd);
}

void Doorkeeper::Leave(VisitorId visitor, bool isGone) {
  {
    const std::lock_guard lock(m_mutex);
    m_leavers.push_back({visitor, isGone});
  }
}

DoorCounts Doorkeeper::ReadCounts() const {
  const std::lock_guard lock(m_mutex);
  return m_counts;
}

// A turn waits in the call that receives: to poll first would be a second system call for each datagram.
void Doorkeeper::Run() {
  for (;;) {
    {
      const std::lock_guard lock(m_mutex);
      if (m_isStopping) return;
      m_counts = m_door.Counts();
    }
    if (m_isFlooded) std::this_thread::sleep_for(kRest);
    double now = 0;
    const auto wake = [&] {
      now = ReadClock();
      TakeLeavers();
      JudgeFlood(now);
    };
    const auto take = [&](const NetAddress& from, std::span<const std::uint8_t> datagram) {
      if (now == 0) wake();
      TakeDatagram(from, datagram, now);
    };
    for (int i = 0; i < kMostBatches; ++i) {
      const bool mayWait = i == 0 && m_toPair.empty();
      const std::size_t taken = mayWait ? m_socket.Await(take) : m_socket.Receive(take);
      m_bytesOut.fetch_add(m_answers.Flush(m_socket), std::memory_order_relaxed);
      WriteToPair();
      if (taken < UdpSocket::kBatch) break;
    }
    if (!m_toPair.empty()) std::this_thread::sleep_for(kRest);  // the pair is full
    if (now == 0) wake();
    if (now < m_nextOverdue) continue;
    m_nextOverdue = now + kOverdueEvery;
    m_door.RemoveOverdue(now, m_overdue);
    for (const VisitorId visitor : m_overdue) HandOn(visitor, PairHead::Kind::kGone, {});
    WriteToPair();
  }
}

void Doorkeeper::JudgeFlood(double now) {
  const double seconds = now - m_strangersFrom;
  if (seconds < kFloodWindow) return;
  m_isFlooded = m_strangers > kFloodRate * seconds;
  m_strangersFrom = now;
  m_strangers = 0;
}

void Doorkeeper::TakeLeavers() {
  std::vector<Leaver> leavers;
  {
    const std::lock_guard lock(m_mutex);
    leavers.swap(m_leavers);
  }
  for (const Leaver& leaver : leavers) {
    if (leaver.isGone) {
      m_door.Remove(leaver.visitor);
    } else {
      m_door.Release(leaver.visitor);
    }
  }
}

void Doorkeeper::TakeDatagram(const NetAddress& from, std::span<const std::uint8_t> datagram, double now) {
  m_bytesIn.fetch_add(datagram.size(), std::memory_order_relaxed);
  const Door::Result result = m_door.TakeDatagram(from, datagram, now);
  if (result.visitor == 0) ++m_strangers;
  if (!result.answer.empty()) m_answers.Add(from, result.answer);
  for (const std::vector<std::uint8_t>& each : result.told) m_answers.Add(from, each);
  if (result.isNew) {
    const Door::Leg leg = m_door.FindLeg(result.visitor);
    HandOn(result.visitor, PairHead::Kind::kNew, {reinterpret_cast<const std::uint8_t*>(&leg), sizeof leg});
  }
  if (result.isOffence) HandOn(result.visitor, PairHead::Kind::kOffence, {});
  if (!result.plain.empty()) HandOn(result.visitor, PairHead::Kind::kData, result.plain);
}

void Doorkeeper::HandOn(VisitorId visitor, PairHead::Kind kind, std::span<const std::uint8_t> bytes) {
  if (m_toPair.size() >= kMostWaiting && kind == PairHead::Kind::kData) return;
  const PairHead head{.visitor = visitor, .kind = kind};
  std::vector<std::uint8_t> message(sizeof head + bytes.size());
  std::memcpy(message.data(), &head, sizeof head);
  if (!bytes.empty()) std::memcpy(message.data() + sizeof head, bytes.data(), bytes.size());
  m_toPair.push_back(std::move(message));
}

void Doorkeeper::WriteToPair() {
  while (!m_toPair.empty()) {
    std::array<mmsghdr, UdpSocket::kBatch> messages;
    std::array<iovec, UdpSocket::kBatch> parts;
    const std::size_t count = std::min(m_toPair.size(), messages.size());
    for (std::size_t i = 0; i < count; ++i) {
      parts[i] = {m_toPair[i].data(), m_toPair[i].size()};
      messages[i] = {};
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
    const int sent = sendmmsg(m_pairEnd, messages.data(), static_cast<unsigned>(count), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent <= 0) return;
    m_toPair.erase(m_toPair.begin(), m_toPair.begin() + sent);
  }
}

}  // namespace wobble::transport::vestibule
