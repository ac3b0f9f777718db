// An ENet host with the settings of this project, and the one place where a datagram is judged before ENet sees it.
//
// For enet_transport.cpp alone: it includes enet.h.
#pragma once

#include <enet/enet.h>

#include <cstddef>
#include <cstdint>

namespace wobble::transport {

// False when ENet cannot be initialised. Once for the process; Unix needs no enet_deinitialize.
[[nodiscard]] bool InitialiseEnet();

// A host for `slots` peers with the settings that both ends share. address: to listen at; nullptr for a client.
// maxReceivedBytes: of one packet; socketBytes: of each socket buffer. Null, with errno set, when there is no socket or
// the port cannot be bound.
[[nodiscard]] ENetHost* MakeHost(const ENetAddress* address, std::size_t slots, std::size_t maxReceivedBytes,
                                 int socketBytes);

// The event to pass to enet_host_service. ENet hands it to the interceptor untouched, so the fields behind it reach the
// interceptor without a global.
struct PolledEvent {
  ENetEvent event;  // first: the two addresses are the same
  bool acceptsConnects;
  std::uint64_t rejected;  // datagrams that the interceptor has dropped
};

// Sets how long ENet waits for a peer. To be called once its handshake has ended.
void SetTimeouts(ENetPeer& peer);
// Keeps ENet from discarding unreliable packets at the sender. Sends a command, so only to peers that stay.
void SwitchThrottleOff(ENetPeer& peer);
// Whether the handshake ended with the channels and MTU that our own ends ask for: with fewer channels or a smaller MTU
// ENet would refuse or fragment what is sent.
[[nodiscard]] bool IsAsAgreed(const ENetPeer& peer);

// Shortens the waits that ENet has doubled to FindLongestRetry. To be called for each peer with each Poll.
void LimitRetries(ENetPeer& peer);

}  // namespace wobble::transport
