// ENet 1.3.17 restricted to what this project needs of it.
//
// ENet's handshake, reliable channel and unsequenced packets are used. Its faults are switched off or checked here: a
// CRC keyed with the connection's id on every datagram (without it one forged datagram drops a peer), small limits on
// what a peer can make us hold, no throttle that discards snapshots at the sender, no fragmented snapshots, time-outs
// that survive 20 % loss (its defaults drop 14 of 32 peers in 20 s), and a limit on the doubling of the wait before a
// reliable command is sent again (transport.h says why). Every datagram is judged in one place, OpenDatagram, before
// ENet sees it; a cookie against forged connects and sealing belong there too.
#include "protocol/transport/enet_host.h"

#include <enet/time.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <random>
#include <span>

#include "protocol/limits.h"
#include "protocol/transport/transport.h"

namespace wobble::transport {
namespace {

// IPv6's smallest MTU less the headers of IP (40) and UDP (8): no path fragments such a datagram. It is also just
// enough for a message of kMaxPacketBytes: ENet fragments, and thereby makes reliable, a packet that does not fit
// beside the largest of its headers.
constexpr enet_uint32 kMtu = 1280 - 40 - 8;
static_assert(protocol::kMaxPacketBytes + sizeof(ENetProtocolHeader) + sizeof(ENetProtocolSendFragment) +
                  sizeof(enet_uint32) <=
              kMtu);

// Bytes of one peer's messages that may wait in ENet's queues behind one that is missing. When they are used up, ENet
// refuses the missing one too, and the connection is stuck for ever. So a client has room for all that a server can
// have on its way: a window of downloads, and welcome, events and scoreboards beside it. A server's clients send
// little.
constexpr std::size_t kClientWaitingBytes = protocol::kDownloadWindowBytes + 512 * 1024;
constexpr std::size_t kServerWaitingBytes = 128 * 1024;

// ENet gives a peer up when a reliable command stays unanswered for kTimeoutMaximumMs, or for kTimeoutMinimumMs once
// the wait before the next try has grown by the factor kTimeoutLimit, which LimitRetries prevents. The session layer
// gives up far sooner.
constexpr enet_uint32 kTimeoutLimit = 4096;
constexpr enet_uint32 kTimeoutMinimumMs = 30000;
constexpr enet_uint32 kTimeoutMaximumMs = 60000;

// The same result as enet_crc32, which goes byte by byte and took 4 % of a server with 64 clients; zlib takes a fifth
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

// Whether a datagram for `peer` comes from that peer's address, in its present session.
bool IsForLivePeer(const ENetPeer& peer, const ENetAddress& from, unsigned session) {
  if (peer.state == ENET_PEER_STATE_DISCONNECTED || peer.state == ENET_PEER_STATE_ZOMBIE) return false;
  if (!IsFrom(peer, from)) return false;
  const bool hasSession = peer.outgoingPeerID < ENET_PROTOCOL_MAXIMUM_PEER_ID;
  return !hasSession || session == peer.incomingSessionID;
}

// Makes ENet's own checks before ENet, which reads the CRC without checking that the datagram is that long. Layout:
// peer id with flags and session (2 bytes), the time sent (2, if flagged), the CRC (4), commands. The CRC is taken over
// the datagram with the connection's random id in the CRC's place, or 0 where there is no connection yet.
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
  if (slot == ENET_PROTOCOL_MAXIMUM_PEER_ID) {  // from an address without a slot: only a connect is valid
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

// ENet's intercept callback. 1: ENet drops the datagram; 0: ENet goes on with it.
int ENET_CALLBACK OpenDatagram(ENetHost* host, ENetEvent* event) {
  auto* polled = reinterpret_cast<PolledEvent*>(event);
  if (IsGenuine(*host, polled->acceptsConnects)) return 0;
  ++polled->rejected;
  return 1;
}

}  // namespace

bool InitialiseEnet() {
  static const bool isReady = enet_initialize() == 0;
  return isReady;
}

ENetHost* MakeHost(const ENetAddress* address, std::size_t slots, std::size_t maxReceivedBytes, int socketBytes) {
  ENetHost* host = enet_host_create(address, slots, kChannelCount, 0, 0);
  if (host == nullptr) return nullptr;
  host->checksum = ComputeChecksum;
  host->intercept = OpenDatagram;
  host->mtu = kMtu;
  for (std::size_t slot = 0; slot < slots; ++slot)
    host->peers[slot].mtu = kMtu;  // ENet has copied them from the host already
  host->maximumPacketSize = maxReceivedBytes;
  host->maximumWaitingData = address == nullptr ? kClientWaitingBytes : kServerWaitingBytes;
  host->randomSeed = std::random_device{}();  // connection ids key the CRC; ENet would take them from the time of day
  enet_socket_set_option(host->socket, ENET_SOCKOPT_RCVBUF, socketBytes);
  enet_socket_set_option(host->socket, ENET_SOCKOPT_SNDBUF, socketBytes);
  return host;
}

void SetTimeouts(ENetPeer& peer) { enet_peer_timeout(&peer, kTimeoutLimit, kTimeoutMinimumMs, kTimeoutMaximumMs); }

// The throttle discards unreliable packets when the round trip grows; with a deceleration of 0 it never does. A
// client's CONNECT sets the server's values and must be echoed unchanged, so this can only be done once connected.
void SwitchThrottleOff(ENetPeer& peer) {
  enet_peer_throttle_configure(&peer, ENET_PEER_PACKET_THROTTLE_INTERVAL, ENET_PEER_PACKET_THROTTLE_SCALE, 0);
}

bool IsAsAgreed(const ENetPeer& peer) { return peer.channelCount == kChannelCount && peer.mtu == kMtu; }

// ENet records when the next retry is due only for the first command in the list, so that record is moved forward as
// well. ENet keeps the list in the order of sending.
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

}  // namespace wobble::transport
