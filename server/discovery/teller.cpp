#include "server/discovery/teller.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/limits.h"
#include "protocol/text.h"

namespace wobble::discovery {
namespace {

constexpr double kTellEvery = 1;                 // s
constexpr std::size_t kMaxRuleValueBytes = 200;  // so that the rules fit one datagram

}  // namespace

std::string FindFault(const std::string& name) {
  if (name.size() <= protocol::kMaxServerNameBytes && protocol::MakeLine(name, name.size()) == name) return {};
  return fmt::format("must have at most {} bytes of UTF-8, without control characters", protocol::kMaxServerNameBytes);
}

protocol::ServerPicture MakePicture(const server::Server& server, const Identity& identity, double now) {
  const std::string scene = protocol::MakeLine(server.SceneName(), protocol::kMaxServerNameBytes);
  protocol::ServerPicture picture{.name = identity.name.empty() ? scene : identity.name,
                                  .scene = scene,
                                  .version = identity.version,
                                  .port = identity.port,
                                  .players = server.CountPlaying(),
                                  .maxPlayers = static_cast<std::size_t>(identity.maxClients),
                                  .isPrivate = identity.wantsCredential || server.IsLocked()};
  if (!picture.isPrivate) {
    for (const server::Server::Player& player : server.ListPlayers(now)) {
      picture.named.push_back({.name = player.name,
                               .score = static_cast<std::uint32_t>(std::max(player.points, 0)),
                               .seconds = player.seconds});
    }
  }
  picture.rules = {{"protocol", fmt::format("{}", protocol::kProtocolVersion)}, {"key", identity.key}};
  if (const auto rotation = server.ListRotation(); !rotation.empty()) {
    picture.rules.emplace_back("rotation",
                               protocol::MakeLine(fmt::format("{}", fmt::join(rotation, ",")), kMaxRuleValueBytes));
  }
  return picture;
}

void Teller::Update(const server::Server& server, double now) {
  if (now < m_next) return;
  m_next = now + kTellEvery;
  const protocol::ServerPicture picture = MakePicture(server, m_identity, now);
  for (const auto& slot : m_slots) slot->Put(std::make_unique<const protocol::ServerPicture>(picture));
}

}  // namespace wobble::discovery
