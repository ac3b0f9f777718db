// Each world is asked twice: without a challenge, and with the one that it answers. The second round trip is the ping.
#include "client/list/ask.h"

#include <algorithm>

#include "client/command/clock.h"
#include "protocol/transport/vestibule/udp_socket.h"

namespace wobble::list {
namespace {

namespace vestibule = transport::vestibule;
using command::ReadClock;
using protocol::Query;
using protocol::QueryKind;

constexpr double kAskEvery = 0.4;  // s; a datagram may be lost
constexpr double kTurn = 0.02;     // s

struct Asking {
  World* world = nullptr;
  Query query = {};
  double askedAt = 0;  // s; 0: not yet
};

void Take(Asking& asking, std::span<const std::uint8_t> datagram, double now) {
  if (const auto challenge = protocol::ReadChallenge(datagram)) {
    if (asking.query.challenge == challenge) return;
    asking.query.challenge = challenge;
    asking.askedAt = 0;
  } else if (auto told = protocol::ReadInfo(datagram)) {
    asking.world->told = std::move(*told);
    asking.world->ping = now - asking.askedAt;
  }
}

}  // namespace

bool AskWorlds(std::vector<World>& worlds, double seconds, const std::function<bool()>& isStopAsked,
               std::string& error) {
  auto socket = vestibule::UdpSocket::Open(error);
  if (!socket) return false;
  socket->SetPatience(kTurn);
  std::vector<Asking> open;
  for (World& world : worlds) {
    if (world.resolved.port != 0) open.push_back({.world = &world});
  }
  vestibule::SendBatch batch;
  const auto take = [&](const transport::NetAddress& from, std::span<const std::uint8_t> datagram) {
    const double now = ReadClock();
    for (Asking& asking : open) {
      if (asking.world->resolved == from) Take(asking, datagram, now);
    }
  };
  for (const double end = ReadClock() + seconds; !open.empty() && ReadClock() < end && !isStopAsked();) {
    for (Asking& asking : open) {
      const double now = ReadClock();
      if (asking.askedAt != 0 && now - asking.askedAt < kAskEvery) continue;
      asking.askedAt = now;
      batch.Add(asking.world->resolved, protocol::MakeQuery(asking.query));
    }
    batch.Flush(*socket);
    socket->Await(take);
    std::erase_if(open, [](const Asking& asking) { return asking.world->ping.has_value(); });
  }
  return true;
}

}  // namespace wobble::list
