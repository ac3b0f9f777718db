#include "client/gateway/credential.h"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/transport/vestibule/token.h"

namespace wobble::gateway {

namespace vestibule = transport::vestibule;
using vestibule::Credential;

namespace {

constexpr std::array kKinds{
    std::pair{std::string_view("password."), Credential::Kind::kPassword},
    std::pair{std::string_view("invite."), Credential::Kind::kInvite},
    std::pair{std::string_view("token."), Credential::Kind::kToken},
    std::pair{std::string_view("owner."), Credential::Kind::kOwnerKey},
};

constexpr std::string_view kMore = "more.";

// Takes the first part of a list with commas, without the spaces around it.
std::string_view TakeFirst(std::string_view& list) {
  const std::size_t comma = list.find(',');
  const std::string_view part = list.substr(0, comma);
  list = comma == std::string_view::npos ? std::string_view() : list.substr(comma + 1);
  const std::size_t begin = part.find_first_not_of(" \t");
  return begin == std::string_view::npos ? "" : part.substr(begin, part.find_last_not_of(" \t") - begin + 1);
}

}  // namespace

std::optional<Credential> FindCredential(std::string_view subprotocols) {
  Credential credential;
  while (!subprotocols.empty()) {
    const std::string_view part = TakeFirst(subprotocols);
    for (const auto& [prefix, kind] : kKinds) {
      if (part.substr(0, prefix.size()) != prefix) continue;
      auto bytes = vestibule::ParseSecret(part.substr(prefix.size()));
      if (!bytes || bytes->size() > kMaxBrowserCredentialBytes || credential.kind != Credential::Kind::kNone) return {};
      credential = {kind, std::move(*bytes)};
    }
  }
  return credential;
}

std::optional<LaneKey> FindLaneKey(std::string_view subprotocols) {
  while (!subprotocols.empty()) {
    const std::string_view part = TakeFirst(subprotocols);
    if (part.substr(0, kMore.size()) != kMore) continue;
    const auto bytes = vestibule::ParseSecret(part.substr(kMore.size()));
    LaneKey key;
    if (!bytes || bytes->size() != key.size()) return {};
    std::copy(bytes->begin(), bytes->end(), key.begin());
    return key;
  }
  return {};
}

Credential Introduce(const Credential& own, const std::string& address, const vestibule::Key& gatewayKey,
                     std::uint64_t now) {
  vestibule::Token token;
  token.issued = now;
  token.expires = now + vestibule::kMaxTokenSeconds;
  token.admission.from = transport::ParseIp(address).value_or(transport::NetAddress{});
  vestibule::FillRandomly(token.number);
  Credential credential{Credential::Kind::kIntroduced,
                        SealToken(vestibule::TokenKind::kIntroduction, token, gatewayKey, vestibule::FillRandomly)};
  const std::vector<std::uint8_t> inner = WriteCredential(own);
  credential.bytes.insert(credential.bytes.end(), inner.begin(), inner.end());
  return credential;
}

}  // namespace wobble::gateway
