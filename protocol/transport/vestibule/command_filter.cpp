// The layout of ENet's datagrams is that of enet/protocol.h, big-endian: a head of the peer's number with flags (2
// bytes), the time sent (2, if flagged) and the checksum (4), then commands of a kind, a channel, a number, and what
// follows.
#include "protocol/transport/vestibule/command_filter.h"

#include "protocol/limits.h"

namespace wobble::transport::vestibule {
namespace {

enum Command : std::uint8_t {
  kAcknowledge = 1,
  kConnect = 2,
  kDisconnect = 4,
  kPing = 5,
  kSendReliable = 6,
  kSendUnsequenced = 9,
  kBandwidthLimit = 10,
  kThrottleConfigure = 11,
};
constexpr std::uint8_t kCommandMask = 0x0F;
constexpr unsigned kHasSentTime = 0x8000, kIsCompressed = 0x4000;
constexpr std::size_t kConnectBytes = 48;

unsigned ReadShort(std::span<const std::uint8_t> bytes, std::size_t at) {
  return unsigned{bytes[at]} << 8U | bytes[at + 1];
}

// The bytes of a command without its data; 0 for one that clients do not send.
std::size_t FindSize(std::uint8_t command) {
  switch (command & kCommandMask) {
    case kAcknowledge:
    case kDisconnect:
    case kSendUnsequenced:
      return 8;
    case kConnect:
      return kConnectBytes;
    case kPing:
      return 4;
    case kSendReliable:
      return 6;
    case kBandwidthLimit:
      return 12;
    case kThrottleConfigure:
      return 16;
    default:
      return 0;
  }
}

}  // namespace

bool CommandFilter::Numbers::Note(std::uint16_t number) {
  const auto ahead_ = static_cast<std::uint16_t>(number - next);
  if (ahead_ >= 0x8000) return true;  // an old one again: ENet acknowledges it
  if (ahead_ >= kReliableWindow) return false;
  ahead[ahead_] = true;
  while (ahead[0]) {
    ahead >>= 1;
    ++next;
  }
  return true;
}

CommandFilter::Verdict CommandFilter::JudgeConnect(std::span<const std::uint8_t> command) {
  const std::uint32_t number = ReadShort(command, 40) << 16U | ReadShort(command, 42);
  if (number == 0 || (m_connection && *m_connection != number)) return Verdict::kOffence;
  m_connection = number;
  return Verdict::kPass;
}

CommandFilter::Verdict CommandFilter::Judge(std::span<const std::uint8_t> plain) {
  if (plain.size() < 2) return Verdict::kOffence;
  const unsigned head = ReadShort(plain, 0);
  const std::size_t headBytes = (head & kHasSentTime) != 0 ? 8 : 6;
  if ((head & kIsCompressed) != 0 || plain.size() <= headBytes) return Verdict::kOffence;
  std::span<const std::uint8_t> left = plain.subspan(headBytes);
  for (std::size_t count = 0; !left.empty(); ++count) {
    const std::uint8_t command = left[0] & kCommandMask;
    std::size_t size = FindSize(command);
    if (size == 0 || left.size() < size || count == kMaxCommands) return Verdict::kOffence;
    const bool isConnect = command == kConnect;
    if (isConnect && (count > 0 || left.size() != size)) return Verdict::kOffence;
    if (isConnect) return JudgeConnect(left);
    if (!m_connection) return Verdict::kDrop;
    if (command == kSendReliable) {
      const std::size_t data = ReadShort(left, 4);
      size += data;
      const auto number = static_cast<std::uint16_t>(ReadShort(left, 2));
      if (left[1] != 0 || data == 0 || left.size() < size || !m_control.Note(number)) return Verdict::kOffence;
    } else if (command == kSendUnsequenced) {
      size += ReadShort(left, 6);
      if (left[1] != 1 || left.size() < size) return Verdict::kOffence;
    }
    left = left.subspan(size);
  }
  return Verdict::kPass;
}

}  // namespace wobble::transport::vestibule
