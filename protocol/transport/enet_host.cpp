// ENet 1.3.17 restricted to what this project needs of it.
//
// ENet's handshake, reliable channel and unsequenced packets are used. Its faults are switched off or checked here:
// small limits on what a peer can make us hold, no throttle that discards snapshots at the sender, no fragmented
// snapshots, time-outs that survive 20 % loss (its defaults drop 14 of 32 peers in 20 s), and a limit on the doubling
// of the wait before a reliable command is sent again (transport.h says why).
//
// ENet has no hook that may lengthen a datagram, so its socket is one end of a pair that only this process has, and the
// network is the bridge's. ENet reads what is written to the other end. The other direction is full from the beginning:
// what ENet sends is taken from its buffers in the checksum's callback, which it calls just before, and its own call
// then finds no room and gives up in silence. If that ever fails to hold, nothing is sent at all, so it cannot fail
// unseen. Interposing ENet's socket functions was rejected: it fails silently where the linker binds them early. A
// socket for each client costs twice the time.
#include "protocol/transport/enet_host.h"

#include <enet/time.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <random>
#include <span>

#include "protocol/limits.h"
#include "protocol/transport/transport.h"

namespace wobble::transport {
namespace {

// Bytes of one peer's messages that may wait in ENet's queues behind one that is missing. When they are used up, ENet
// refuses the missing one too, and the connection is stuck for ever. So a client has room for all that a server can
// have on its way: a window of downloads, and welcome, events and scoreboards beside it. A server's clients send
// little.
constexpr std::size_t kClientWaitingBytes = protocol::kDownloadWindowBytes + 512 * 1024;
constexpr std::size_t kServerWaitingBytes = 64 * 1024;

// ENet gives a peer up when a reliable command stays unanswered for kTimeoutMaximumMs, or for kTimeoutMinimumMs once
// the wait before the next try has grown by the factor kTimeoutLimit, which LimitRetries prevents. The session layer
// gives up far sooner.
constexpr enet_uint32 kTimeoutLimit = 4096;
constexpr enet_uint32 kTimeoutMinimumMs = 30000;
constexpr enet_uint32 kTimeoutMaximumMs = 60000;

// Room in the pair, bytes: Linux charges some 800 for a message of 100, and limits this to net.core.wmem_max.
constexpr int kPairBytes = 4 * 1024 * 1024;

// ENet's field for data of a compressor, which is not used: it stays null without the functions beside it.
Bridge& BridgeOf(const ENetHost& host) { return *static_cast<Bridge*>(host.compressor.context); }

// The place of the checksum in a datagram: behind the peer's number, and the time sent if there is one.
enet_uint32 ReadChecksum(const ENetBuffer& buffer) {
  const auto* data = static_cast<const enet_uint8*>(buffer.data);
  const bool hasTime = (data[0] & (ENET_PROTOCOL_HEADER_FLAG_SENT_TIME >> 8U)) != 0;
  enet_uint32 checksum;
  std::memcpy(&checksum, data + (hasTime ? sizeof(ENetProtocolHeader) : sizeof(ENetProtocolHeader::peerID)),
              sizeof checksum);
  return checksum;
}

// ENet's checksum callback. Sealing makes a checksum needless, so its field carries what ENet writes there before it
// asks: the connection's id. On receipt ENet has put the id that it expects in that place, so the field itself is the
// right answer. A datagram to be sent has several parts, the first of them in the host itself; one received has one.
enet_uint32 ENET_CALLBACK TakeDatagram(const ENetBuffer* buffers, std::size_t count) {
  const enet_uint32 connection = ReadChecksum(buffers[0]);
  if (count == 1) return connection;
  const auto* begin = reinterpret_cast<const char*>(buffers) - offsetof(ENetHost, buffers);
  BridgeOf(*reinterpret_cast<const ENetHost*>(begin)).send(connection, {buffers, count});
  return connection;
}

// ENet's intercept callback. 1: ENet drops the datagram; 0: ENet goes on with it. ENet reads the checksum without
// checking that the datagram is so long.
int ENET_CALLBACK OpenDatagram(ENetHost* host, ENetEvent*) {
  const bool isKept = BridgeOf(*host).receive(*host);
  return isKept && host->receivedDataLength > sizeof(ENetProtocolHeader) + sizeof(enet_uint32) ? 0 : 1;
}

// A pair whose direction away from `enetEnd` has no room left.
bool MakePair(int& enetEnd, int& otherEnd) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) return false;
  enetEnd = ends[0];
  otherEnd = ends[1];
  const int least = 1;
  setsockopt(enetEnd, SOL_SOCKET, SO_SNDBUF, &least, sizeof least);
  setsockopt(otherEnd, SOL_SOCKET, SO_SNDBUF, &kPairBytes, sizeof kPairBytes);
  while (send(enetEnd, "", 1, MSG_NOSIGNAL) == 1) {
  }
  return true;
}

// How often the oldest command that is not acknowledged has been sent.
std::size_t CountTries(const ENetPeer& peer) {
  if (enet_list_empty(&peer.sentReliableCommands)) return 0;
  return reinterpret_cast<const ENetOutgoingCommand*>(enet_list_front(&peer.sentReliableCommands))->sendAttempts;
}

constexpr std::size_t kPatientTries = 8;
constexpr std::size_t kTrickle = 4;
constexpr enet_uint32 kTrickleWaitMs = 10000;
// 10 s at least: an honest client whose link is dead for so long is silent, too, and has been given up before.
constexpr std::size_t kMostTries = 40;

}  // namespace

bool IsDeaf(const ENetPeer& peer) { return CountTries(peer) >= kMostTries; }

bool InitialiseEnet() {
  static const bool isReady = enet_initialize() == 0;
  return isReady;
}

ENetHost* MakeHost(Bridge& bridge, std::size_t slots, bool isServer, std::size_t maxReceivedBytes, int& pairEnd) {
  int enetEnd = -1;
  if (!MakePair(enetEnd, pairEnd)) return nullptr;
  ENetHost* host = enet_host_create(nullptr, slots, kChannelCount, 0, 0);
  if (host == nullptr) {
    close(enetEnd);
    close(pairEnd);
    return nullptr;
  }
  enet_socket_destroy(host->socket);
  host->socket = enetEnd;
  host->compressor.context = &bridge;
  host->checksum = TakeDatagram;
  host->intercept = OpenDatagram;
  host->mtu = kMtu;
  for (std::size_t slot = 0; slot < slots; ++slot)
    host->peers[slot].mtu = kMtu;  // ENet has copied them from the host already
  host->maximumPacketSize = maxReceivedBytes;
  host->maximumWaitingData = isServer ? kServerWaitingBytes : kClientWaitingBytes;
  host->randomSeed = std::random_device{}();  // ENet would take connection ids from the time of day
  return host;
}

void SetTimeouts(ENetPeer& peer) { enet_peer_timeout(&peer, kTimeoutLimit, kTimeoutMinimumMs, kTimeoutMaximumMs); }

// The throttle discards unreliable packets when the round trip grows; with a deceleration of 0 it never does. A
// client's CONNECT sets the server's values and must be echoed unchanged, so this can only be done once connected.
void SwitchThrottleOff(ENetPeer& peer) {
  enet_peer_throttle_configure(&peer, ENET_PEER_PACKET_THROTTLE_INTERVAL, ENET_PEER_PACKET_THROTTLE_SCALE, 0);
}

bool IsAsAgreed(const ENetPeer& peer) { return peer.channelCount == kChannelCount && peer.mtu == kMtu; }

// What is sent again to a peer that acknowledges nothing: 64 KiB (ENet's window) kPatientTries times, then kTrickle
// commands each time, so half a megabyte and not 15. Over 20 % loss each way one command in 3,000 is tried so often,
// and what waits behind it goes on as soon as it has arrived.
//
// ENet records when the next retry is due only for the first command in the list, so that record is moved forward as
// well. ENet keeps the list in the order of sending.
void LimitRetries(ENetPeer& peer) {
  if (enet_list_empty(&peer.sentReliableCommands)) return;
  const auto longest = static_cast<enet_uint32>(1000 * FindLongestRetry(peer.roundTripTime / 1000.0));
  const bool isTrickle = CountTries(peer) >= kPatientTries;
  std::size_t place = 0;
  for (ENetListIterator at = enet_list_begin(&peer.sentReliableCommands);
       at != enet_list_end(&peer.sentReliableCommands); at = enet_list_next(at)) {
    auto* command = reinterpret_cast<ENetOutgoingCommand*>(at);
    const bool waits = isTrickle && place++ >= kTrickle;
    command->roundTripTimeout = waits ? kTrickleWaitMs : std::min(command->roundTripTimeout, longest);
    const enet_uint32 due = command->sentTime + command->roundTripTimeout;
    if (ENET_TIME_LESS(due, peer.nextTimeout)) peer.nextTimeout = due;
  }
}

}  // namespace wobble::transport
