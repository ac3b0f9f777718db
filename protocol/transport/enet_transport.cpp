// Connections over ENet: who is let in, what is passed on, when a connection is over.
//
// enet_host.h has the settings of ENet and judges datagrams. ENet's own answer to a full server is silence, so a few
// slots are kept for refusing. A peer's connection id is in ENetPeer::data; ids are counted up and never used again,
// while ENet reuses its slots.
#include "protocol/transport/enet_transport.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "protocol/transport/enet_host.h"

namespace wobble::transport {
namespace {

// Seconds that Disconnect waits for the far end to acknowledge what is on its way and the close.
constexpr double kCloseTimeout = 3;

// Slots beyond maxConnections and beyond maxPerAddress, in which a client too many is connected to be told so.
constexpr std::size_t kRefusalSlots = 8;
constexpr std::size_t kRefusalSlotsPerAddress = 2;

// Socket buffers, bytes. After a late tick a server finds every client's inputs in its buffer, where a datagram of 100
// bytes is charged about 400: ENet's 256 KiB hold 600 inputs, 4 MiB 10,000, which is a second of 160 clients at 60 Hz.
// In the other direction a burst of snapshots to all clients leaves within a millisecond, and ENet silently loses what
// the send buffer cannot hold. Linux silently limits both to net.core.rmem_max and wmem_max.
constexpr int kServerSocketBytes = 4 * 1024 * 1024;
constexpr int kClientSocketBytes = 1024 * 1024;

// Bounds a Poll, so that a flood cannot keep it from returning. Dropping a datagram costs 2 to 4 us, nearly all of it
// the system call, so these cost 5 to 9 ms; at 60 Hz they are 120,000 a second, four times what 500 clients send.
constexpr std::uint32_t kMaxDatagramsPerPoll = 2048;
// Datagrams that ENet takes from the socket in one call.
constexpr enet_uint32 kDatagramsPerService = 256;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct PacketDeleter {
  void operator()(ENetPacket* packet) const { enet_packet_destroy(packet); }
};

}  // namespace

struct EnetTransport::Impl {
  struct Connection {
    ENetPeer* peer;
    bool isKnown;              // our user knows of it and must be told of its end
    bool isOpen = false;       // messages may pass: connected and not being closed
    double deadline = kNever;  // when it is dropped
  };

  explicit Impl(ENetHost* enetHost) : host(enetHost) {}
  ~Impl();

  void Poll(double time, const Sink& sink);
  void GiveUpOverdue(const Sink& sink);
  void Dispatch(const ENetEvent& event, const Sink& sink);
  void Admit(ENetPeer& peer, const Sink& sink);
  void Receive(const ENetEvent& event, const Sink& sink);
  void Forget(ConnectionId id, const Sink& sink);
  void BeginClosing(Connection& connection);
  bool IsFull(const ENetPeer& peer) const;
  bool IsAcceptable(Channel channel, const ENetPacket& packet) const;
  void CollectTotals();

  ENetHost* host;
  bool isServer = false;
  std::size_t maxConnections = 1;
  std::size_t maxPerAddress = 1;
  std::size_t maxReceivedBytes = 0;  // of a control message
  std::size_t maxSentBytes = 0;      // likewise
  double connectTimeout = 0;

  std::unordered_map<ConnectionId, Connection> connections;
  ConnectionId newestId = 0;
  double now = 0;
  bool hasPolled = false;
  bool isPolling = false;
  Statistics statistics;
  std::vector<ConnectionId> overdue;  // scratch
};

namespace {

ConnectionId IdOf(const ENetPeer& peer) {
  return static_cast<ConnectionId>(reinterpret_cast<std::uintptr_t>(peer.data));
}

void SetId(ENetPeer& peer, ConnectionId id) { peer.data = reinterpret_cast<void*>(std::uintptr_t{id}); }

void Drop(ENetPeer& peer) {
  if (peer.state == ENET_PEER_STATE_CONNECTING) {
    enet_peer_reset(&peer);  // the far end does not know of it yet
  } else {
    enet_peer_disconnect_now(&peer, 0);
  }
  SetId(peer, 0);
}

}  // namespace

EnetTransport::Impl::~Impl() {
  for (auto& [id, connection] : connections) Drop(*connection.peer);
  enet_host_destroy(host);
}

// ENet's totals are 32 bits wide and wrap after 4 GiB.
void EnetTransport::Impl::CollectTotals() {
  statistics.bytesIn += host->totalReceivedData;
  statistics.bytesOut += host->totalSentData;
  host->totalReceivedData = 0;
  host->totalSentData = 0;
}

void EnetTransport::Impl::Poll(double time, const Sink& sink) {
  assert(!isPolling && (!hasPolled || time >= now));
  isPolling = true;
  now = time;
  if (!hasPolled && !isServer) {
    for (auto& [id, connection] : connections)
      connection.deadline = std::min(connection.deadline, now + connectTimeout);
  }
  hasPolled = true;
  GiveUpOverdue(sink);

  // The outcome of a call shows in errno, which ENet leaves as the last failed system call set it: EAGAIN when the
  // socket is empty, another error when sending failed (the next call goes on with the next peer), and none when ENet
  // stopped at a datagram larger than its buffer (result -1) or at an empty one, which it takes for the end of input.
  PolledEvent polled{{}, isServer, 0};
  for (std::uint32_t taken = 0; taken < kMaxDatagramsPerPoll;) {
    const enet_uint32 before = host->totalReceivedPackets;
    errno = 0;
    const int result = enet_host_service(host, &polled.event, 0);
    if (result > 0) {
      Dispatch(polled.event, sink);
      continue;
    }
    if (result == 0 && errno != 0) break;
    const enet_uint32 received = host->totalReceivedPackets - before;
    if (errno == 0 && received < kDatagramsPerService) ++polled.rejected;
    taken += received + 1;
  }
  statistics.datagramsRejected += polled.rejected;
  for (std::size_t slot = 0; slot < host->peerCount; ++slot) LimitRetries(host->peers[slot]);
  CollectTotals();
  isPolling = false;
}

void EnetTransport::Impl::GiveUpOverdue(const Sink& sink) {
  overdue.clear();
  for (const auto& [id, connection] : connections) {
    if (connection.deadline <= now) overdue.push_back(id);
  }
  for (const ConnectionId id : overdue) {
    Drop(*connections.at(id).peer);
    Forget(id, sink);
  }
}

void EnetTransport::Impl::Dispatch(const ENetEvent& event, const Sink& sink) {
  switch (event.type) {
    case ENET_EVENT_TYPE_CONNECT:
      Admit(*event.peer, sink);
      break;
    case ENET_EVENT_TYPE_DISCONNECT: {
      const ConnectionId id = IdOf(*event.peer);
      SetId(*event.peer, 0);
      Forget(id, sink);
      break;
    }
    case ENET_EVENT_TYPE_RECEIVE:
      Receive(event, sink);
      break;
    case ENET_EVENT_TYPE_NONE:
      break;
  }
}

bool EnetTransport::Impl::IsFull(const ENetPeer& peer) const {
  std::size_t all = 0;
  std::size_t ofAddress = 0;
  for (const auto& [id, connection] : connections) {
    if (!connection.isKnown) continue;
    ++all;
    if (connection.peer->address.host == peer.address.host) ++ofAddress;
  }
  return all >= maxConnections || ofAddress >= maxPerAddress;
}

// A handshake has ended; on a server a connection begins here. One that is not wanted gets an id too, so that its
// closing has a deadline, but the sink never hears of it.
void EnetTransport::Impl::Admit(ENetPeer& peer, const Sink& sink) {
  ConnectionId id = IdOf(peer);
  const bool isWanted = IsAsAgreed(peer) && (!isServer || !IsFull(peer));
  if (isServer) {
    id = ++newestId;
    SetId(peer, id);
    connections[id] = {&peer, isWanted};
  }
  SetTimeouts(peer);
  Connection& connection = connections.at(id);
  if (!isWanted) {
    BeginClosing(connection);
    return;
  }
  SwitchThrottleOff(peer);
  connection.isOpen = true;
  connection.deadline = kNever;
  sink({.kind = Event::Kind::kConnected, .connection = id});
}

// Our own ends send control messages reliably and the rest unsequenced and unfragmented; nothing else is taken.
bool EnetTransport::Impl::IsAcceptable(Channel channel, const ENetPacket& packet) const {
  if (static_cast<std::size_t>(channel) >= kChannelCount) return false;
  if (channel == Channel::kControl) {
    return packet.dataLength <= maxReceivedBytes && (packet.flags & ENET_PACKET_FLAG_RELIABLE) != 0;
  }
  return packet.dataLength <= protocol::kMaxPacketBytes && (packet.flags & ENET_PACKET_FLAG_UNSEQUENCED) != 0;
}

void EnetTransport::Impl::Receive(const ENetEvent& event, const Sink& sink) {
  const std::unique_ptr<ENetPacket, PacketDeleter> packet(event.packet);
  const auto found = connections.find(IdOf(*event.peer));
  if (found == connections.end() || !found->second.isOpen) return;  // being closed
  const auto channel = static_cast<Channel>(event.channelID);
  if (!IsAcceptable(channel, *packet)) {
    ++statistics.messagesRejected;
    return;
  }
  // FlatBuffers' verifier needs the alignment; ENet's packets begin where malloc puts them.
  assert(reinterpret_cast<std::uintptr_t>(packet->data) % 8 == 0);
  sink({.kind = Event::Kind::kMessage,
        .connection = found->first,
        .channel = channel,
        .bytes = {packet->data, packet->dataLength}});
}

void EnetTransport::Impl::Forget(ConnectionId id, const Sink& sink) {
  const auto found = connections.find(id);
  if (found == connections.end()) return;
  const bool isKnown = found->second.isKnown;
  connections.erase(found);
  if (isKnown) sink({.kind = Event::Kind::kDisconnected, .connection = id});
}

void EnetTransport::Impl::BeginClosing(Connection& connection) {
  connection.isOpen = false;
  if (connection.peer->state == ENET_PEER_STATE_CONNECTING) {
    connection.deadline = -kNever;  // there is nothing to wait for: the next Poll drops it
  } else {
    enet_peer_disconnect_later(connection.peer, 0);
    connection.deadline = now + kCloseTimeout;
  }
}

EnetTransport::EnetTransport(std::unique_ptr<Impl> impl) : m_impl(std::move(impl)) {}
EnetTransport::~EnetTransport() = default;

std::unique_ptr<EnetTransport> EnetTransport::Listen(const ListenOptions& options, std::string& error) {
  assert(options.maxConnections >= 1 && options.maxConnections <= kMaxListenConnections);
  if (!InitialiseEnet()) {
    error = "the network library does not start";
    return nullptr;
  }
  ENetAddress address{ENET_HOST_ANY, options.port};
  const std::size_t slots = options.maxConnections + kRefusalSlots;
  errno = 0;
  ENetHost* host = MakeHost(&address, slots, std::max(options.maxMessageBytes, protocol::kMaxClientMessageBytes),
                            kServerSocketBytes);
  if (host == nullptr) {
    const std::string port = "port " + std::to_string(options.port) + " (UDP) ";
    error = errno == EADDRINUSE ? port + "is in use" : port + "cannot be opened: " + std::strerror(errno);
    return nullptr;
  }
  host->duplicatePeers = options.maxPerAddress == 0 ? slots : options.maxPerAddress + kRefusalSlotsPerAddress;

  auto impl = std::make_unique<Impl>(host);
  impl->isServer = true;
  impl->maxConnections = options.maxConnections;
  impl->maxPerAddress = options.maxPerAddress == 0 ? options.maxConnections : options.maxPerAddress;
  impl->maxReceivedBytes = options.maxMessageBytes;
  impl->maxSentBytes = protocol::kMaxServerMessageBytes;
  return std::unique_ptr<EnetTransport>(new EnetTransport(std::move(impl)));
}

std::unique_ptr<EnetTransport> EnetTransport::Connect(const std::string& host, std::uint16_t port, std::string& error,
                                                      const ConnectOptions& options) {
  if (!InitialiseEnet()) {
    error = "the network library does not start";
    return nullptr;
  }
  ENetAddress address{0, port};
  if (host.empty() || enet_address_set_host(&address, host.c_str()) != 0) {
    error = "no IPv4 address is known for \"" + host + "\"";
    return nullptr;
  }
  errno = 0;
  ENetHost* enetHost = MakeHost(nullptr, 1, protocol::kMaxServerMessageBytes, kClientSocketBytes);
  if (enetHost == nullptr) {
    error = std::string("no UDP socket can be opened: ") + std::strerror(errno);
    return nullptr;
  }
  auto impl = std::make_unique<Impl>(enetHost);
  impl->maxReceivedBytes = protocol::kMaxServerMessageBytes;
  impl->maxSentBytes = protocol::kMaxClientMessageBytes;
  impl->connectTimeout = options.timeout;
  ENetPeer* peer = enet_host_connect(enetHost, &address, kChannelCount, 0);
  if (peer == nullptr) {
    error = "out of memory";
    return nullptr;
  }
  SetId(*peer, kClientConnection);
  impl->newestId = kClientConnection;
  impl->connections[kClientConnection] = {peer, true};
  return std::unique_ptr<EnetTransport>(new EnetTransport(std::move(impl)));
}

void EnetTransport::Poll(double now, const Sink& sink) { m_impl->Poll(now, sink); }

SendResult EnetTransport::Send(ConnectionId connection, Channel channel, std::span<const std::uint8_t> message) {
  assert(static_cast<std::size_t>(channel) < kChannelCount);
  const auto found = m_impl->connections.find(connection);
  if (found == m_impl->connections.end() || !found->second.isKnown) return SendResult::kUnknownConnection;
  const bool isControl = channel == Channel::kControl;
  if (message.size() > (isControl ? m_impl->maxSentBytes : protocol::kMaxPacketBytes)) return SendResult::kTooLarge;
  if (!found->second.isOpen) return SendResult::kFailed;

  ENetHost& host = *m_impl->host;
  const enet_uint32 flags = isControl ? ENET_PACKET_FLAG_RELIABLE : ENET_PACKET_FLAG_UNSEQUENCED;
  ENetPacket* packet = enet_packet_create(message.data(), message.size(), flags);
  if (packet == nullptr) return SendResult::kFailed;
  // ENet has one limit for both directions, and a server sends larger messages than it takes.
  const std::size_t receiveLimit = host.maximumPacketSize;
  host.maximumPacketSize = std::max(receiveLimit, message.size());
  const int result = enet_peer_send(found->second.peer, static_cast<enet_uint8>(channel), packet);
  host.maximumPacketSize = receiveLimit;
  if (result == 0) return SendResult::kQueued;
  enet_packet_destroy(packet);
  return SendResult::kFailed;
}

void EnetTransport::Disconnect(ConnectionId connection) {
  const auto found = m_impl->connections.find(connection);
  if (found == m_impl->connections.end()) return;
  const bool isClosing = !found->second.isOpen && found->second.peer->state != ENET_PEER_STATE_CONNECTING;
  if (!isClosing) m_impl->BeginClosing(found->second);
}

void EnetTransport::Flush() { enet_host_flush(m_impl->host); }

Statistics EnetTransport::ReadStatistics() const {
  Statistics statistics = m_impl->statistics;
  statistics.bytesIn += m_impl->host->totalReceivedData;
  statistics.bytesOut += m_impl->host->totalSentData;
  return statistics;
}

double EnetTransport::ReadRoundTrip(ConnectionId connection) const {
  const auto found = m_impl->connections.find(connection);
  return found == m_impl->connections.end() ? 0 : found->second.peer->roundTripTime / 1000.0;
}

std::uint16_t EnetTransport::ReadPort() const { return m_impl->isServer ? m_impl->host->address.port : 0; }

}  // namespace wobble::transport
