// ENet 1.3.17 held to what this project needs of it.
//
// ENet is used for its handshake, its reliable channel and its unsequenced packets. What it does wrong is switched off
// or checked here: a CRC keyed with the connection's id on every datagram (without it one forged datagram drops a
// peer), small limits on what a peer may make us hold, no throttle that discards snapshots at the sender, no fragmented
// snapshots, time-outs that survive 20 % loss (its defaults drop 14 of 32 peers in 20 s), and an end to the doubling of
// the wait before something reliable is sent again (transport.h says why).
// Every datagram is judged in one place, OpenDatagram, before ENet sees it; a cookie against forged connects and
// sealing belong there too. ENet's own answer to a full server is silence, so a few slots are kept for saying no.
// A peer's connection id sits in ENetPeer::data; ids are counted up and never used again, while ENet's slots are.
#include "protocol/transport/enet_transport.h"

#include <enet/enet.h>
#include <enet/time.h>
#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <unordered_map>
#include <vector>

namespace wobble::transport {
namespace {

// IPv6's smallest MTU less the headers of IP (40) and UDP (8): no path cuts such a datagram in pieces. It is also just
// what a message of kMaxPacketBytes needs, since ENet fragments (and thereby makes reliable) what does not fit beside
// the largest of its headers.
constexpr enet_uint32 kMtu = 1280 - 40 - 8;
static_assert(protocol::kMaxPacketBytes + sizeof(ENetProtocolHeader) + sizeof(ENetProtocolSendFragment) +
                  sizeof(enet_uint32) <=
              kMtu);

// What one peer may have waiting for us in ENet's queues, bytes: a second of snapshots at 1 Mbit/s.
constexpr std::size_t kMaxWaitingBytes = 128 * 1024;

// ENet gives a peer up when something reliable stays unanswered for the third (ms), or for the second once the wait
// before the next try has grown by the first, which LimitRetries never lets it. The session layer is far quicker.
constexpr enet_uint32 kTimeoutLimit = 4096;
constexpr enet_uint32 kTimeoutMinimumMs = 30000;
constexpr enet_uint32 kTimeoutMaximumMs = 60000;

// Seconds that Disconnect waits for the far end to take what is still on its way and agree.
constexpr double kCloseTimeout = 3;

// Slots beyond maxConnections (and beyond maxPerAddress) in which one too many is let in just to be told so.
constexpr std::size_t kRefusalSlots = 8;
constexpr std::size_t kRefusalSlotsPerAddress = 2;

// Socket buffers, bytes. A server that comes back from a late tick finds every client's inputs in its buffer, where a
// datagram of 100 bytes is charged some 400 of what is asked for: ENet's 256 KiB hold 600 inputs, 4 MiB 10,000, which
// is a second of 160 clients at 60 Hz. The other way a burst of snapshots to all clients leaves within a millisecond,
// and what the send buffer cannot hold ENet loses in silence. Linux cuts both down to net.core.rmem_max and wmem_max
// without a word.
constexpr int kServerSocketBytes = 4 * 1024 * 1024;
constexpr int kClientSocketBytes = 1024 * 1024;

// A flood must not keep Poll from returning. To throw one datagram away costs 2 to 4 us, nearly all of it the system
// call, so these cost 5 to 9 ms; at 60 Hz they are 120,000 a second, four times what 500 clients send.
constexpr std::uint32_t kMaxDatagramsPerPoll = 2048;
// ENet takes this many from the socket in one go.
constexpr enet_uint32 kDatagramsPerService = 256;

constexpr double kNever = std::numeric_limits<double>::infinity();

// ENet hands its event to the interceptor untouched, so what follows it reaches the interceptor without a global.
struct PolledEvent {
  ENetEvent event;  // first: the two addresses are the same
  bool acceptsConnects;
  std::uint64_t rejected;
};

// Cuts down what ENet has doubled. Its own record of when the next is due is set only for the first in the list; in
// this list, whatever ENet does with it, what was sent last stands last.
void LimitRetries(ENetPeer& peer) {
  if (enet_list_empty(&peer.sentReliableCommands)) return;
  const auto longest = static_cast<enet_uint32>(1000 * FindLongestRetry(peer.roundTripTime / 1000.0));
  for (ENetListIterator at = enet_list_begin(&peer.sentReliableCommands);
       at != enet_list_end(&peer.sentReliableCommands); at = enet_list_next(at)) {
    auto* command = reinterpret_cast<ENetOutgoingCommand*>(at);
    command->roundTripTimeout = std::min(command->roundTripTimeout, longest);
    const enet_uint32 due = command->sentTime + command->roundTripTimeout;
    if (ENET_TIME_LESS(due, peer.nextTimeout)) peer.nextTimeout = due;
  }
}

// The same numbers as enet_crc32, which goes byte by byte and took 4 % of a server with 64 clients; zlib takes a fifth
// of that.
enet_uint32 ENET_CALLBACK ComputeChecksum(const ENetBuffer* buffers, std::size_t count) {
  uLong crc = crc32(0, nullptr, 0);
  for (const ENetBuffer& buffer : std::span(buffers, count)) {
    crc = crc32(crc, static_cast<const Bytef*>(buffer.data), static_cast<uInt>(buffer.dataLength));
  }
  return ENET_HOST_TO_NET_32(static_cast<enet_uint32>(crc));
}

bool IsFrom(const ENetPeer& peer, const ENetAddress& address) {
  return peer.address.host == address.host && peer.address.port == address.port;
}

// Whether a datagram addressed to `peer` comes from where that peer is, in its present incarnation.
bool IsForLivePeer(const ENetPeer& peer, const ENetAddress& from, unsigned session) {
  if (peer.state == ENET_PEER_STATE_DISCONNECTED || peer.state == ENET_PEER_STATE_ZOMBIE) return false;
  if (!IsFrom(peer, from)) return false;
  const bool hasSession = peer.outgoingPeerID < ENET_PROTOCOL_MAXIMUM_PEER_ID;
  return !hasSession || session == peer.incomingSessionID;
}

// The checks ENet makes itself, made before it: the layout is peer id with flags and session (2 bytes), the time sent
// (2, if flagged), the CRC (4), commands. ENet reads the CRC without looking whether the datagram is that long.
// The CRC is taken over the datagram with the connection's random id in the CRC's place, or 0 where there is none yet.
bool IsGenuine(const ENetHost& host, bool acceptsConnects) {
  const enet_uint8* data = host.receivedData;
  const std::size_t length = host.receivedDataLength;
  if (length < sizeof(ENetProtocolHeader::peerID)) return false;
  const unsigned head = unsigned{data[0]} << 8 | data[1];
  if ((head & ENET_PROTOCOL_HEADER_FLAG_COMPRESSED) != 0) return false;
  const std::size_t checksumAt = (head & ENET_PROTOCOL_HEADER_FLAG_SENT_TIME) != 0 ? sizeof(ENetProtocolHeader)
                                                                                   : sizeof(ENetProtocolHeader::peerID);
  const std::size_t commandsAt = checksumAt + sizeof(enet_uint32);
  if (length < commandsAt + sizeof(ENetProtocolCommandHeader)) return false;

  const unsigned session = (head & ENET_PROTOCOL_HEADER_SESSION_MASK) >> ENET_PROTOCOL_HEADER_SESSION_SHIFT;
  const unsigned slot = head & ENET_PROTOCOL_MAXIMUM_PEER_ID;
  enet_uint32 key = 0;
  if (slot == ENET_PROTOCOL_MAXIMUM_PEER_ID) {  // from someone who has no slot yet: it can only ask for one
    const bool isConnect = (data[commandsAt] & ENET_PROTOCOL_COMMAND_MASK) == ENET_PROTOCOL_COMMAND_CONNECT &&
                           length >= commandsAt + sizeof(ENetProtocolConnect);
    if (!acceptsConnects || !isConnect) return false;
  } else {
    if (slot >= host.peerCount || !IsForLivePeer(host.peers[slot], host.receivedAddress, session)) return false;
    key = host.peers[slot].connectID;
  }

  enet_uint32 stated;
  std::memcpy(&stated, data + checksumAt, sizeof stated);
  const ENetBuffer parts[] = {
      {host.receivedData, checksumAt}, {&key, sizeof key}, {host.receivedData + commandsAt, length - commandsAt}};
  return ComputeChecksum(parts, std::size(parts)) == stated;
}

// ENet's intercept callback, and the one place where a datagram is opened. 1: ENet forgets it; 0: ENet goes on.
int ENET_CALLBACK OpenDatagram(ENetHost* host, ENetEvent* event) {
  auto* polled = reinterpret_cast<PolledEvent*>(event);
  if (IsGenuine(*host, polled->acceptsConnects)) return 0;
  ++polled->rejected;
  return 1;
}

bool InitialiseEnet() {
  static const bool isReady = enet_initialize() == 0;  // for the process; nothing needs enet_deinitialize on Unix
  return isReady;
}

// The settings that both ends share. Null with errno set when there is no socket or the port cannot be bound.
ENetHost* MakeHost(const ENetAddress* address, std::size_t slots, std::size_t maxReceivedBytes, int socketBytes) {
  ENetHost* host = enet_host_create(address, slots, kChannelCount, 0, 0);
  if (host == nullptr) return nullptr;
  host->checksum = ComputeChecksum;
  host->intercept = OpenDatagram;
  host->mtu = kMtu;
  for (std::size_t slot = 0; slot < slots; ++slot) host->peers[slot].mtu = kMtu;  // were copied from the host's before
  host->maximumPacketSize = maxReceivedBytes;
  host->maximumWaitingData = kMaxWaitingBytes;
  host->randomSeed = std::random_device{}();  // connection ids key the CRC; ENet would take them from the time of day
  enet_socket_set_option(host->socket, ENET_SOCKOPT_RCVBUF, socketBytes);
  enet_socket_set_option(host->socket, ENET_SOCKOPT_SNDBUF, socketBytes);
  return host;
}

// ENet's throttle discards unreliable packets at the sender when the round trip grows. It never slows down like this.
// A client's CONNECT sets the server's values and must be echoed unchanged, so this can only be done once connected.
void SwitchThrottleOff(ENetPeer& peer) {
  enet_peer_throttle_configure(&peer, ENET_PEER_PACKET_THROTTLE_INTERVAL, ENET_PEER_PACKET_THROTTLE_SCALE, 0);
}

// Whether the handshake ended with what our own ends ask for: fewer channels or a smaller MTU would make ENet refuse
// or fragment what is sent.
bool IsAsAgreed(const ENetPeer& peer) { return peer.channelCount == kChannelCount && peer.mtu == kMtu; }

struct PacketDeleter {
  void operator()(ENetPacket* packet) const { enet_packet_destroy(packet); }
};

}  // namespace

struct EnetTransport::Impl {
  struct Connection {
    ENetPeer* peer;
    bool isKnown;              // to our user, who is therefore told of its end
    bool isOpen = false;       // messages may pass: connected, and not being closed
    double deadline = kNever;  // when it is given up
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
    enet_peer_reset(&peer);  // there is nobody to tell
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

void EnetTransport::Impl::CollectTotals() {  // ENet's totals are 32 bits wide and wrap after 4 GiB
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

  // What a call came to shows in errno, which ENet leaves as the last failed system call set it: EAGAIN when the socket
  // is empty, another error when sending failed (the next call goes on with the next peer), and none when ENet stopped
  // at a datagram larger than its buffer (result -1) or at an empty one, which it takes for the end of all there is.
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

// A handshake has ended. On a server this is where a connection begins; one that is not wanted gets an id too, so that
// its closing has a deadline, but nobody hears of it.
void EnetTransport::Impl::Admit(ENetPeer& peer, const Sink& sink) {
  ConnectionId id = IdOf(peer);
  const bool isWanted = IsAsAgreed(peer) && (!isServer || !IsFull(peer));
  if (isServer) {
    id = ++newestId;
    SetId(peer, id);
    connections[id] = {&peer, isWanted};
  }
  enet_peer_timeout(&peer, kTimeoutLimit, kTimeoutMinimumMs, kTimeoutMaximumMs);
  Connection& connection = connections.at(id);
  if (!isWanted) {
    BeginClosing(connection);
    return;
  }
  SwitchThrottleOff(peer);
  connection.isOpen = true;
  connection.deadline = kNever;
  sink({Event::Kind::kConnected, id, Channel::kControl, {}});
}

// Ours send control reliably and the rest unsequenced and unfragmented; anything else is somebody's experiment.
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
  // FlatBuffers' verifier wants it aligned; ENet's packets begin where malloc puts them.
  assert(reinterpret_cast<std::uintptr_t>(packet->data) % 8 == 0);
  sink({Event::Kind::kMessage, found->first, channel, {packet->data, packet->dataLength}});
}

void EnetTransport::Impl::Forget(ConnectionId id, const Sink& sink) {
  const auto found = connections.find(id);
  if (found == connections.end()) return;
  const bool isKnown = found->second.isKnown;
  connections.erase(found);
  if (isKnown) sink({Event::Kind::kDisconnected, id, Channel::kControl, {}});
}

void EnetTransport::Impl::BeginClosing(Connection& connection) {
  connection.isOpen = false;
  if (connection.peer->state == ENET_PEER_STATE_CONNECTING) {
    connection.deadline = -kNever;  // nothing to wait for; the event comes with the next Poll
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
  // ENet has one limit for both ways; a server sends larger messages than it is willing to take.
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
