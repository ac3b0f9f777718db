// An ENet host with the settings of this project, whose datagrams go by a bridge instead of a network.
//
// For enet_transport.cpp and the bridges alone: it includes enet.h.
#pragma once

#include <enet/enet.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "protocol/limits.h"
#include "protocol/transport/vestibule/seal.h"

namespace wobble::transport {

// A datagram on the wire: IPv6's smallest MTU less the headers of IP (40) and UDP (8), so that no path fragments it.
// What is left for ENet after sealing is just enough for a message of kMaxPacketBytes: ENet fragments, and thereby
// makes reliable, a packet that does not fit beside the largest of its headers.
inline constexpr std::size_t kMaxDatagramBytes = 1280 - 40 - 8;
inline constexpr enet_uint32 kMtu = kMaxDatagramBytes - vestibule::kSealedOverhead;
static_assert(protocol::kMaxPacketBytes + sizeof(ENetProtocolHeader) + sizeof(ENetProtocolSendFragment) +
                  sizeof(enet_uint32) <=
              kMtu);

// False when ENet cannot be initialised. Once for the process; Unix needs no enet_deinitialize.
[[nodiscard]] bool InitialiseEnet();

// What stands between an ENet host and the network.
struct Bridge {
  // host.receivedData is a message from the pair. Makes it a datagram of ENet and sets host.receivedAddress; false: the
  // message is dropped.
  std::function<bool(ENetHost& host)> receive;
  // Sends one datagram of ENet, in consecutive parts. connection: the id of its connection, as ENet stores it; 0 while
  // the far end has not answered.
  std::function<void(enet_uint32 connection, std::span<const ENetBuffer> parts)> send;
};

// A host for `slots` peers. What is written to `pairEnd`, which the caller closes, goes to bridge.receive; what ENet
// sends, to bridge.send. bridge: outlives the host. isServer: it takes connections, else it makes one.
// maxReceivedBytes: of one packet. Null when the system has no descriptors or memory left.
[[nodiscard]] ENetHost* MakeHost(Bridge& bridge, std::size_t slots, bool isServer, std::size_t maxReceivedBytes,
                                 int& pairEnd);

// Sets how long ENet waits for a peer. To be called once its handshake has ended.
void SetTimeouts(ENetPeer& peer);
// Keeps ENet from discarding unreliable packets at the sender. Sends a command, so only to peers that stay.
void SwitchThrottleOff(ENetPeer& peer);
// Whether the handshake ended with the channels and MTU that our own ends ask for: with fewer channels or a smaller MTU
// ENet would refuse or fragment what is sent.
[[nodiscard]] bool IsAsAgreed(const ENetPeer& peer);

// Shortens the waits that ENet has doubled to FindLongestRetry. To be called for each peer with each Poll.
void LimitRetries(ENetPeer& peer);
// Whether the peer has not acknowledged for long what it was sent again and again.
[[nodiscard]] bool IsDeaf(const ENetPeer& peer);

}  // namespace wobble::transport
