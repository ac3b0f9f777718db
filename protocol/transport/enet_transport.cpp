// Connections over ENet: what is passed on, and when a connection is over.
//
// The bridges (server_bridge.h, client_bridge.h) carry ENet's datagrams; the vestibule decides who is let in. A peer's
// connection id is in ENetPeer::data; ids are counted up and never used again, while ENet reuses its slots.
#include "protocol/transport/enet_transport.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "protocol/transport/client_bridge.h"
#include "protocol/transport/enet_host.h"
#include "protocol/transport/server_bridge.h"

namespace wobble::transport {
namespace {

using vestibule::Caller;

// Seconds that Disconnect waits for the far end to acknowledge what is on its way and the close.
constexpr double kCloseTimeout = 3;

// A server's socket buffers, bytes. A burst of snapshots to all clients leaves within a millisecond. Linux silently
// limits both to net.core.rmem_max and wmem_max.
constexpr int kServerSocketBytes = 4 * 1024 * 1024;

// Bounds a Poll, so that a flood cannot keep it from returning: at 60 Hz these are 120,000 datagrams a second, four
// times what 500 clients send.
constexpr std::uint32_t kMaxDatagramsPerPoll = 2048;
// Datagrams that ENet takes from the pair in one call.
constexpr enet_uint32 kDatagramsPerService = 256;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct PacketDeleter {
  void operator()(ENetPacket* packet) const { enet_packet_destroy(packet); }
};

ConnectionId IdOf(const ENetPeer& peer) {
  return static_cast<ConnectionId>(reinterpret_cast<std::uintptr_t>(peer.data));
}

void SetId(ENetPeer& peer, ConnectionId id) { peer.data = reinterpret_cast<void*>(std::uintptr_t{id}); }

// Whether a message has been sent whose arrival the far end has not acknowledged.
bool IsMessageUnderway(ENetPeer& peer) {
  ENetList& sent = peer.sentReliableCommands;
  for (ENetListIterator each = enet_list_begin(&sent); each != enet_list_end(&sent); each = enet_list_next(each)) {
    if (reinterpret_cast<ENetOutgoingCommand*>(each)->packet != nullptr) return true;  // not a ping
  }
  return false;
}

// The words of protocol::Name for the same reasons, which this room does not know.
std::string_view Describe(const Caller& caller) {
  switch (caller.ReadState()) {
    case Caller::State::kWrongServer:
      return kWrongServerReason;
    case Caller::State::kOtherVersion:
      return "wrong protocol version";
    case Caller::State::kReset:
      return "the server was restarted";
    case Caller::State::kRefused:
      break;
    default:
      return "";
  }
  switch (caller.ReadRefusal()) {
    case vestibule::Refusal::kFull:
      return "server is full";
    case vestibule::Refusal::kTooManyFromAddress:
      return "too many connections from this address";
    case vestibule::Refusal::kBadCredential:
      return kBadCredentialReason;
    case vestibule::Refusal::kBanned:
      return "banned from this server";
    case vestibule::Refusal::kNone:
      break;
  }
  return "refused";
}

// Whether the server would answer the same to another try.
bool IsFinal(const Caller& caller) {
  if (caller.ReadState() == Caller::State::kReset) return false;
  if (caller.ReadState() != Caller::State::kRefused) return true;
  return caller.ReadRefusal() != vestibule::Refusal::kFull &&
         caller.ReadRefusal() != vestibule::Refusal::kTooManyFromAddress;
}

}  // namespace

struct EnetTransport::Impl {
  struct Connection {
    ENetPeer* peer;            // null for a client that is not let in yet
    bool isKnown;              // our user knows of it and must be told of its end
    bool isOpen = false;       // messages may pass: connected and not being closed
    double deadline = kNever;  // when it is dropped
  };

  explicit Impl(std::unique_ptr<ServerBridge> bridge) : server(std::move(bridge)), host(&server->Host()) {}
  explicit Impl(std::unique_ptr<ClientBridge> bridge) : client(std::move(bridge)), host(&client->Host()) {}
  ~Impl();

  void Poll(double time, const Sink& sink);
  void PollClient(const Sink& sink);
  void TakeNotices(const Sink& sink);
  void ReportOffence(const ENetPeer& peer, const Sink& sink);
  void GiveUpOverdue(const Sink& sink);
  void Dispatch(const ENetEvent& event, const Sink& sink);
  void Admit(ENetPeer& peer, const Sink& sink);
  void Receive(const ENetEvent& event, const Sink& sink);
  void Forget(ConnectionId id, const Sink& sink, std::string_view reason = {}, bool isFinal = false);
  void Drop(ENetPeer* peer);
  void BeginClosing(Connection& connection);
  bool IsAcceptable(Channel channel, const ENetPacket& packet) const;
  void FlushBridge();

  std::unique_ptr<ServerBridge> server;  // one of the two
  std::unique_ptr<ClientBridge> client;
  ENetHost* host;
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

// A disconnect would overtake a message that closes a connection, such as a goodbye: ENet at the far end throws away
// what has come just before a disconnect. So that message alone is sent, once.
EnetTransport::Impl::~Impl() {
  enet_host_flush(host);
  FlushBridge();
  for (auto& [id, connection] : connections) {
    const bool saysGoodbye = !connection.isOpen && connection.peer != nullptr && IsMessageUnderway(*connection.peer);
    if (!saysGoodbye) Drop(connection.peer);
  }
}

void EnetTransport::Impl::FlushBridge() {
  if (server != nullptr) server->Flush();
  if (client != nullptr) client->Flush();
}

// The far end hears of it, unless it does not know of the connection yet.
void EnetTransport::Impl::Drop(ENetPeer* peer) {
  if (peer == nullptr) return;
  if (peer->state == ENET_PEER_STATE_CONNECTING) {
    enet_peer_reset(peer);
  } else {
    enet_peer_disconnect_now(peer, 0);
  }
  FlushBridge();
  if (server != nullptr) server->Remove(ServerBridge::FindVisitor(*peer));
  SetId(*peer, 0);
}

void EnetTransport::Impl::Poll(double time, const Sink& sink) {
  assert(!isPolling && (!hasPolled || time >= now));
  isPolling = true;
  now = time;
  if (!hasPolled && client != nullptr) {
    for (auto& [id, connection] : connections)
      connection.deadline = std::min(connection.deadline, now + connectTimeout);
  }
  hasPolled = true;
  if (client != nullptr) PollClient(sink);
  GiveUpOverdue(sink);

  ENetEvent event;
  for (enet_uint32 taken = 0; taken < kMaxDatagramsPerPoll;) {
    const enet_uint32 before = host->totalReceivedPackets;
    const int result = enet_host_service(host, &event, 0);
    const enet_uint32 received = host->totalReceivedPackets - before;
    taken += received + 1;
    if (result > 0) {
      Dispatch(event, sink);
    } else if (received < kDatagramsPerService) {
      break;
    }
  }
  if (server != nullptr) TakeNotices(sink);
  FlushBridge();
  for (std::size_t slot = 0; slot < host->peerCount; ++slot) {
    ENetPeer& peer = host->peers[slot];
    LimitRetries(peer);
    if (server != nullptr && IsDeaf(peer)) ReportOffence(peer, sink);
  }
  isPolling = false;
}

// ENet begins to connect once its datagrams can be sealed.
void EnetTransport::Impl::PollClient(const Sink& sink) {
  client->Poll(now);
  const auto found = connections.find(kClientConnection);
  if (found == connections.end()) return;
  Connection& connection = found->second;
  if (client->Caller().HasEnded()) {
    if (connection.peer != nullptr) {
      SetId(*connection.peer, 0);
      enet_peer_reset(connection.peer);
    }
    Forget(kClientConnection, sink, Describe(client->Caller()), IsFinal(client->Caller()));
    return;
  }
  if (connection.peer != nullptr || !client->Caller().CanSeal()) return;
  connection.peer = enet_host_connect(host, &ClientBridge::kServerAddress, kChannelCount, 0);
  assert(connection.peer != nullptr);  // the host has one slot for one peer
  SetId(*connection.peer, kClientConnection);
}

void EnetTransport::Impl::TakeNotices(const Sink& sink) {
  for (const ServerBridge::Notice& notice : server->TakeNotices()) {
    const auto peers = std::span(host->peers, host->peerCount);
    const auto peer = std::find_if(peers.begin(), peers.end(), [&](const ENetPeer& each) {
      return each.state != ENET_PEER_STATE_DISCONNECTED && ServerBridge::FindVisitor(each) == notice.visitor;
    });
    if (peer == peers.end()) {
      server->Remove(notice.visitor);
      continue;
    }
    const ConnectionId id = IdOf(*peer);
    const auto found = connections.find(id);
    if (notice.isGone || found == connections.end()) {
      enet_peer_reset(&*peer);
      SetId(*peer, 0);
      server->Remove(notice.visitor);
      Forget(id, sink);
    } else {
      ReportOffence(*peer, sink);
    }
  }
}

void EnetTransport::Impl::ReportOffence(const ENetPeer& peer, const Sink& sink) {
  const auto found = connections.find(IdOf(peer));
  if (found == connections.end() || !found->second.isOpen || !found->second.isKnown) return;
  sink({.kind = Event::Kind::kOffence, .connection = found->first});
}

void EnetTransport::Impl::GiveUpOverdue(const Sink& sink) {
  overdue.clear();
  for (const auto& [id, connection] : connections) {
    if (connection.deadline <= now) overdue.push_back(id);
  }
  for (const ConnectionId id : overdue) {
    Drop(connections.at(id).peer);
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
      // ENet's last word to it is on its way already.
      if (server != nullptr) {
        server->Flush();
        server->Remove(ServerBridge::FindVisitor(*event.peer));
      }
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

// ENet's handshake has ended; on a server a connection begins here. One that is not wanted gets an id too, so that its
// closing has a deadline, but the sink never hears of it.
void EnetTransport::Impl::Admit(ENetPeer& peer, const Sink& sink) {
  ConnectionId id = IdOf(peer);
  const bool isWanted = IsAsAgreed(peer);
  if (server != nullptr) {
    id = ++newestId;
    SetId(peer, id);
    connections[id] = {.peer = &peer, .isKnown = isWanted};
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
  sink({.kind = Event::Kind::kConnected,
        .connection = id,
        .admission = server == nullptr ? nullptr : server->FindAdmission(ServerBridge::FindVisitor(peer))});
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

void EnetTransport::Impl::Forget(ConnectionId id, const Sink& sink, std::string_view reason, bool isFinal) {
  const auto found = connections.find(id);
  if (found == connections.end()) return;
  const bool isKnown = found->second.isKnown;
  connections.erase(found);
  if (isKnown) sink({.kind = Event::Kind::kDisconnected, .connection = id, .reason = reason, .isFinal = isFinal});
}

void EnetTransport::Impl::BeginClosing(Connection& connection) {
  connection.isOpen = false;
  if (connection.peer == nullptr || connection.peer->state == ENET_PEER_STATE_CONNECTING) {
    connection.deadline = -kNever;  // there is nothing to wait for: the next Poll drops it
    return;
  }
  enet_peer_disconnect_later(connection.peer, 0);
  connection.deadline = now + kCloseTimeout;
  // Its seat is free from now on, whether or not it ever acknowledges the end.
  if (server != nullptr) server->Keeper().Release(ServerBridge::FindVisitor(*connection.peer));
}

EnetTransport::EnetTransport(std::unique_ptr<Impl> impl) : m_impl(std::move(impl)) {}
EnetTransport::~EnetTransport() = default;

std::unique_ptr<EnetTransport> EnetTransport::Listen(const ListenOptions& options, std::string& error) {
  assert(options.maxConnections >= 1 && options.maxConnections <= kMaxListenConnections);
  if (!InitialiseEnet() || !vestibule::InitialiseSodium()) {
    error = "the network library does not start";
    return nullptr;
  }
  auto socket = vestibule::UdpSocket::Listen(options.host, options.port, error);
  if (!socket) return nullptr;
  socket->SetBuffers(kServerSocketBytes);
  vestibule::Door::Settings settings;
  settings.identity =
      options.secretKey ? vestibule::MakeKeyPair(*options.secretKey) : vestibule::MakeKeyPair(vestibule::FillRandomly);
  settings.maxVisitors = options.maxConnections;
  settings.datagramRate = options.datagramRate;
  settings.judge = options.judge;
  settings.pictures = options.pictures;
  settings.maxPerAddress = options.maxPerAddress == 0 ? options.maxConnections : options.maxPerAddress;
  constexpr std::size_t kMostReceived = std::max(protocol::kMaxClientMessageBytes, protocol::kMaxPacketBytes);
  auto bridge = ServerBridge::Open(std::move(*socket), std::move(settings), kMostReceived, error);
  if (bridge == nullptr) return nullptr;
  auto impl = std::make_unique<Impl>(std::move(bridge));
  impl->maxReceivedBytes = protocol::kMaxClientMessageBytes;
  impl->maxSentBytes = protocol::kMaxServerMessageBytes;
  return std::unique_ptr<EnetTransport>(new EnetTransport(std::move(impl)));
}

std::unique_ptr<EnetTransport> EnetTransport::Connect(const std::string& host, std::uint16_t port, std::string& error,
                                                      const ConnectOptions& options) {
  if (!InitialiseEnet() || !vestibule::InitialiseSodium()) {
    error = "the network library does not start";
    return nullptr;
  }
  std::vector<NetAddress> addresses = vestibule::ResolveAddresses(host, port, error);
  if (addresses.empty()) return nullptr;
  Caller::Settings settings{.credential = options.credential,
                            .server = options.serverKey,
                            .ownServer = options.ownServer,
                            .ownCredential = options.ownCredential};
  auto bridge = ClientBridge::Open(std::move(addresses), std::move(settings), protocol::kMaxServerMessageBytes, error);
  if (bridge == nullptr) return nullptr;
  auto impl = std::make_unique<Impl>(std::move(bridge));
  impl->maxReceivedBytes = protocol::kMaxServerMessageBytes;
  impl->maxSentBytes = protocol::kMaxClientMessageBytes;
  impl->connectTimeout = options.timeout;
  impl->newestId = kClientConnection;
  impl->connections[kClientConnection] = {.peer = nullptr, .isKnown = true};
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
  const ENetPeer* peer = found->second.peer;
  const bool isClosing = !found->second.isOpen && peer != nullptr && peer->state != ENET_PEER_STATE_CONNECTING;
  if (!isClosing) m_impl->BeginClosing(found->second);
}

void EnetTransport::Flush() {
  enet_host_flush(m_impl->host);
  m_impl->FlushBridge();
}

Statistics EnetTransport::ReadStatistics() const {
  Statistics statistics = m_impl->statistics;
  if (m_impl->server != nullptr) {
    const vestibule::Doorkeeper& keeper = m_impl->server->Keeper();
    const vestibule::DoorCounts counts = keeper.ReadCounts();
    statistics.bytesIn = keeper.BytesIn();
    statistics.bytesOut = keeper.BytesOut() + m_impl->server->BytesOut();
    statistics.datagramsRejected = counts.invalid + counts.limited + counts.strangers + counts.offences;
    statistics.turnaways = counts.turnaways;
    statistics.queries = counts.queries;
  } else {
    statistics.bytesIn = m_impl->client->BytesIn();
    statistics.bytesOut = m_impl->client->BytesOut();
    statistics.datagramsRejected = m_impl->client->Caller().CountInvalid();
  }
  return statistics;
}

double EnetTransport::ReadRoundTrip(ConnectionId connection) const {
  const auto found = m_impl->connections.find(connection);
  if (found == m_impl->connections.end()) return 0;
  // ENet's own guess before it has measured.
  return found->second.peer == nullptr ? 0.5 : found->second.peer->roundTripTime / 1000.0;
}

std::uint16_t EnetTransport::ReadPort() const {
  return m_impl->server == nullptr ? std::uint16_t{0} : m_impl->server->Keeper().Socket().ReadPort();
}

vestibule::Key EnetTransport::ReadServerKey() const {
  return m_impl->server != nullptr ? m_impl->server->Keeper().ServerKey() : m_impl->client->Caller().ServerKey();
}

std::vector<std::uint8_t> EnetTransport::ReadTicket() const {
  return m_impl->client == nullptr ? std::vector<std::uint8_t>() : m_impl->client->Caller().Ticket();
}

vestibule::Refusal EnetTransport::ReadRefusal() const {
  return m_impl->client == nullptr ? vestibule::Refusal::kNone : m_impl->client->Caller().ReadRefusal();
}

bool EnetTransport::ServerWantsCredential() const {
  return m_impl->client != nullptr && m_impl->client->Caller().WantsCredential();
}

vestibule::DoorCounts EnetTransport::ReadDoorCounts() const {
  return m_impl->server == nullptr ? vestibule::DoorCounts{} : m_impl->server->Keeper().ReadCounts();
}

}  // namespace wobble::transport
