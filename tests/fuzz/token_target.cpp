// What a client shows to be let in: credentials of any bytes, tokens of any content under the right keys,
// introductions, links, and the words of the administration that name somebody.
#include <memory>

#include "protocol/transport/net_address.h"
#include "server/admin/orders.h"
#include "server/admission/gate.h"
#include "tests/fuzz/feed.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

namespace vestibule = transport::vestibule;
using vestibule::Credential;
using vestibule::Token;
using vestibule::TokenKind;

constexpr std::uint64_t kNow = 1'800'000'000;

vestibule::Key MakeKey(std::uint8_t first) {
  vestibule::Key key{};
  key[0] = first;
  return key;
}

Token TakeToken(Feed& feed) {
  Token token;
  token.number[0] = feed.TakeByte();
  token.issued = kNow + feed.Take<std::int8_t>();
  token.expires = kNow + feed.Take<std::int16_t>();
  token.server[0] = feed.TakeByte();
  token.admission.rank = static_cast<transport::Rank>(feed.TakeByte() % 4);
  token.admission.account = feed.Take<std::uint64_t>();
  token.admission.invite = feed.TakeByte();
  for (char& letter : token.admission.name) letter = static_cast<char>(feed.TakeByte());
  for (std::uint8_t& byte : token.admission.from.ip) byte = feed.TakeByte();
  return token;
}

void CheckToken(const Token& token, TokenKind kind, const vestibule::Key& key) {
  const auto bytes = SealToken(kind, token, key, vestibule::FillRandomly);
  Require(bytes.size() <= vestibule::kMaxCredentialBytes);
  const auto back = OpenToken(kind, bytes, key);
  Require(back && back->number == token.number && back->issued == token.issued && back->expires == token.expires);
  Require(back->admission.account == token.admission.account && back->admission.rank == token.admission.rank);
  Require(!OpenToken(kind, bytes, MakeKey(99)));
}

void FuzzOne(std::span<const std::uint8_t> bytes) {
  static const bool isReady = vestibule::InitialiseSodium();
  Require(isReady);
  Feed feed(bytes);
  admission::GateSettings settings;
  settings.secretKey = MakeKey(1);
  settings.token = MakeKey(2);
  settings.gateway = MakeKey(3);
  settings.owner = MakeKey(4);
  settings.password = "tulip";
  settings.readUnixTime = [] { return kNow; };
  admission::Gate gate(settings, {}, {});
  while (!feed.IsEmpty()) {
    const std::uint8_t choice = feed.TakeByte();
    Credential credential{static_cast<Credential::Kind>(choice % 6), {}};
    const TokenKind kind = static_cast<TokenKind>(1 + choice / 8 % 3);
    if (choice >= 128) {
      const Token token = TakeToken(feed);
      const vestibule::Key key = MakeKey(static_cast<std::uint8_t>(2 + choice / 64 % 2));
      CheckToken(token, kind, key);
      credential.bytes = SealToken(kind, token, key, vestibule::FillRandomly);
    }
    const auto more = feed.TakeSome();
    credential.bytes.insert(credential.bytes.end(), more.begin(), more.end());
    if (credential.bytes.size() > vestibule::kMaxCredentialBytes)
      credential.bytes.resize(vestibule::kMaxCredentialBytes);
    const auto plain = vestibule::WriteCredential(credential);
    Require(vestibule::ReadCredential(plain)->bytes == credential.bytes);
    static_cast<void>(vestibule::ReadCredential(more));
    const transport::NetAddress source = gate.FindSource(credential, {});
    const vestibule::Judgement judgement = gate.Decide(credential, source);
    Require(judgement.ticket.size() <= vestibule::kMaxCredentialBytes);
    const bool mayOwn = credential.kind == Credential::Kind::kOwnerKey || credential.kind == Credential::Kind::kToken;
    Require(judgement.refusal != vestibule::Refusal::kNone || judgement.admission.rank != transport::Rank::kOwner ||
            mayOwn);
    const std::string text(more.begin(), more.end());
    if (const auto secret = vestibule::ParseSecret(text)) Require(vestibule::FormatSecret(*secret) == text);
    if (const auto address = transport::ParseIp(text))
      Require(transport::ParseIp(transport::FormatIp(*address)) == address);
    static_cast<void>(admin::ParseSpan(text));
  }
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
