// One IPv6 socket serves both: IPv4 addresses appear in it as ::ffff:a.b.c.d. Where the system has no IPv6, an IPv4
// socket stands in for it.
#include "protocol/transport/vestibule/udp_socket.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

namespace wobble::transport::vestibule {
namespace {

union SocketAddress {
  sockaddr any;
  sockaddr_in ipv4;
  sockaddr_in6 ipv6;
};

NetAddress FromSystem(const SocketAddress& address) {
  NetAddress result;
  if (address.any.sa_family == AF_INET6) {
    std::memcpy(result.ip.data(), &address.ipv6.sin6_addr, 16);
    result.port = ntohs(address.ipv6.sin6_port);
  } else {
    result.ip[10] = result.ip[11] = 0xFF;
    std::memcpy(result.ip.data() + 12, &address.ipv4.sin_addr, 4);
    result.port = ntohs(address.ipv4.sin_port);
  }
  return result;
}

// The length of the result.
socklen_t ToSystem(const NetAddress& address, bool isIpv6, SocketAddress& result) {
  std::memset(&result, 0, sizeof result);
  if (isIpv6) {
    result.ipv6.sin6_family = AF_INET6;
    result.ipv6.sin6_port = htons(address.port);
    std::memcpy(&result.ipv6.sin6_addr, address.ip.data(), 16);
    return sizeof result.ipv6;
  }
  result.ipv4.sin_family = AF_INET;
  result.ipv4.sin_port = htons(address.port);
  std::memcpy(&result.ipv4.sin_addr, address.ip.data() + 12, 4);
  return sizeof result.ipv4;
}

struct AddressListDeleter {
  void operator()(addrinfo* list) const { freeaddrinfo(list); }
};
using AddressList = std::unique_ptr<addrinfo, AddressListDeleter>;

// flags: of getaddrinfo.
AddressList Look(const std::string& host, std::uint16_t port, int flags) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const std::string service = std::to_string(port);
  const int result = getaddrinfo(host.empty() ? nullptr : host.c_str(), service.c_str(), &hints, &list);
  return AddressList(result == 0 ? list : nullptr);
}

int MakeSocket(int family) { return socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0); }

int MakeDualSocket(bool& isIpv6) {
  int descriptor = MakeSocket(AF_INET6);
  const int off = 0;
  isIpv6 = descriptor >= 0 && setsockopt(descriptor, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off) == 0;
  if (isIpv6) return descriptor;
  if (descriptor >= 0) close(descriptor);
  return MakeSocket(AF_INET);
}

}  // namespace

// Where a batch arrives. It is filled in once: most batches have one datagram, and to fill in all places for each of
// them would cost more than to open it.
struct UdpSocket::Inbox {
  std::array<std::array<std::uint8_t, kReceivedBytes>, kBatch> bytes;
  std::array<mmsghdr, kBatch> messages{};
  std::array<iovec, kBatch> parts;
  std::array<SocketAddress, kBatch> from;

  Inbox() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      parts[i] = {bytes[i].data(), kReceivedBytes};
      messages[i].msg_hdr.msg_name = &from[i];
      messages[i].msg_hdr.msg_namelen = sizeof from[i];
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
  }
};

std::optional<UdpSocket> UdpSocket::Listen(const std::string& host, std::uint16_t port, std::string& error) {
  bool isIpv6 = true;
  SocketAddress address;
  NetAddress any;
  if (!host.empty()) {
    const AddressList list = Look(host, port, 0);
    if (list == nullptr) {
      error = "no address is known for \"" + host + "\"";
      return {};
    }
    std::memcpy(&address, list->ai_addr, list->ai_addrlen);
    any = FromSystem(address);
  }
  any.port = port;
  UdpSocket result(MakeDualSocket(isIpv6), isIpv6);
  result.m_isIpv6 = isIpv6;
  const socklen_t length = ToSystem(any, isIpv6, address);
  if (result.m_descriptor >= 0 && bind(result.m_descriptor, &address.any, length) == 0) return result;
  const std::string which = (host.empty() ? "" : host + " ") + "port " + std::to_string(port) + " (UDP) ";
  error = errno == EADDRINUSE ? which + "is in use" : which + "cannot be opened: " + std::strerror(errno);
  return {};
}

std::optional<UdpSocket> UdpSocket::Open(std::string& error) {
  bool isIpv6 = true;
  const int descriptor = MakeDualSocket(isIpv6);
  if (descriptor >= 0) return UdpSocket(descriptor, isIpv6);
  error = std::string("no UDP socket can be opened: ") + std::strerror(errno);
  return {};
}

UdpSocket::UdpSocket(int descriptor, bool isIpv6) : m_descriptor(descriptor), m_isIpv6(isIpv6) {}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept
    : m_descriptor(std::exchange(other.m_descriptor, -1)),
      m_isIpv6(other.m_isIpv6),
      m_inbox(std::move(other.m_inbox)) {}

UdpSocket::~UdpSocket() {
  if (m_descriptor >= 0) close(m_descriptor);
}

std::uint16_t UdpSocket::ReadPort() const {
  SocketAddress address{};
  socklen_t length = sizeof address;
  return getsockname(m_descriptor, &address.any, &length) == 0 ? FromSystem(address).port : std::uint16_t{0};
}

void UdpSocket::SetBuffers(int bytes) {
  setsockopt(m_descriptor, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  setsockopt(m_descriptor, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
}

void UdpSocket::SetPatience(double seconds) {
  const timeval patience{.tv_sec = 0, .tv_usec = static_cast<suseconds_t>(1e6 * seconds)};
  setsockopt(m_descriptor, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
}

std::size_t UdpSocket::Receive(const TakeFunction& take, bool waits) {
  if (m_inbox == nullptr) m_inbox = std::make_unique<Inbox>();
  Inbox& inbox = *m_inbox;
  const int flags = waits ? MSG_WAITFORONE : MSG_DONTWAIT;
  const int count = recvmmsg(m_descriptor, inbox.messages.data(), kBatch, flags, nullptr);
  for (int i = 0; i < count; ++i) {
    const auto place = static_cast<std::size_t>(i);
    take(FromSystem(inbox.from[place]), {inbox.bytes[place].data(), inbox.messages[place].msg_len});
    inbox.messages[place].msg_hdr.msg_namelen = sizeof inbox.from[place];  // the system has written it
  }
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void SendBatch::Add(const NetAddress& to, std::span<const std::uint8_t> datagram) {
  m_entries.push_back({to, m_bytes.size(), datagram.size()});
  m_bytes.insert(m_bytes.end(), datagram.begin(), datagram.end());
}

std::uint64_t SendBatch::Flush(const UdpSocket& socket) {
  std::array<mmsghdr, UdpSocket::kBatch> messages;
  std::array<iovec, UdpSocket::kBatch> parts;
  std::array<SocketAddress, UdpSocket::kBatch> to;
  std::uint64_t bytes = 0;
  for (std::size_t begin = 0; begin < m_entries.size();) {
    const std::size_t count = std::min(m_entries.size() - begin, UdpSocket::kBatch);
    for (std::size_t i = 0; i < count; ++i) {
      const Entry& entry = m_entries[begin + i];
      parts[i] = {m_bytes.data() + entry.begin, entry.size};
      messages[i] = {};
      messages[i].msg_hdr.msg_name = &to[i];
      messages[i].msg_hdr.msg_namelen = ToSystem(entry.to, socket.m_isIpv6, to[i]);
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
    const int sent = sendmmsg(socket.m_descriptor, messages.data(), static_cast<unsigned>(count), MSG_DONTWAIT);
    for (int i = 0; i < sent; ++i) bytes += messages[static_cast<std::size_t>(i)].msg_len;
    // The call ends before a datagram that fails; that one is passed over.
    begin += sent > 0 ? static_cast<std::size_t>(sent) : 1;
  }
  m_entries.clear();
  m_bytes.clear();
  return bytes;
}

std::vector<NetAddress> ResolveAddresses(const std::string& host, std::uint16_t port, std::string& error) {
  std::vector<NetAddress> addresses;
  const AddressList list = host.empty() ? nullptr : Look(host, port, AI_ADDRCONFIG);
  for (const addrinfo* each = list.get(); each != nullptr && addresses.size() < kMaxAddresses; each = each->ai_next) {
    if (each->ai_family != AF_INET && each->ai_family != AF_INET6) continue;
    SocketAddress address{};
    std::memcpy(&address, each->ai_addr, std::min<std::size_t>(each->ai_addrlen, sizeof address));
    addresses.push_back(FromSystem(address));
  }
  if (addresses.empty()) error = "no address is known for \"" + host + "\"";
  return addresses;
}

}  // namespace wobble::transport::vestibule
