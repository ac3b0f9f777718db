// What browsers show among the subprotocols, and how the gateway says whose it is.
#include "client/gateway/credential.h"

#include <gtest/gtest.h>

#include "protocol/transport/vestibule/token.h"

namespace wobble::gateway {
namespace {

namespace vestibule = transport::vestibule;
using vestibule::Credential;
using Bytes = std::vector<std::uint8_t>;

Bytes ToBytes(std::string_view text) { return {text.begin(), text.end()}; }

TEST(LaneKeys, StandAmongTheSubprotocols) {
  LaneKey key{};
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<std::uint8_t>(3 * i);
  EXPECT_EQ(FindLaneKey("wobble.6, more." + vestibule::FormatSecret(key)), key);
  for (const char* offered : {"", "wobble.6", "more.", "more.AAAA", "wobble.6, more.AAAAAAAAAAAAAAAAAAAAAA=", "more"})
    EXPECT_EQ(FindLaneKey(offered), std::nullopt) << offered;
}

TEST(Credentials, StandAmongTheSubprotocols) {
  const struct {
    const char* offered;
    Credential::Kind kind;
    const char* bytes;
  } cases[] = {
      {"", Credential::Kind::kNone, ""},
      {"wobble.6", Credential::Kind::kNone, ""},
      {"wobble.6, chat, passwords.AA", Credential::Kind::kNone, ""},
      {"wobble.6, password.dHVsaXA", Credential::Kind::kPassword, "tulip"},
      {"password.dHVsaXA,wobble.6", Credential::Kind::kPassword, "tulip"},
      {"wobble.6,\tinvite.dHVsaXA ", Credential::Kind::kInvite, "tulip"},
      {"wobble.6, token.dHVsaXA", Credential::Kind::kToken, "tulip"},
      {"wobble.6, owner.dHVsaXA", Credential::Kind::kOwnerKey, "tulip"},
      {"wobble.6, password._-8", Credential::Kind::kPassword, "\xFF\xEF"},
  };
  for (const auto& each : cases) {
    const auto credential = FindCredential(each.offered);
    ASSERT_TRUE(credential) << each.offered;
    EXPECT_EQ(credential->kind, each.kind) << each.offered;
    EXPECT_EQ(credential->bytes, ToBytes(each.bytes)) << each.offered;
  }
}

TEST(Credentials, AreRefusedWhenMalformed) {
  for (const char* bad :
       {"password.", "password.a", "password.dHVsaXA=", "password.+/8", "password.dHVs aXA", "password.dHVsaXB",
        "wobble.6, invite.dHVsaXA, password.dHVsaXA", "password.dHVsaXA, password.dHVsaXA", "token.d.H"}) {
    EXPECT_FALSE(FindCredential(bad)) << bad;
  }
}

TEST(Credentials, HaveALargestSize) {
  for (const std::size_t more : {0, 1}) {
    const std::string word = "token." + vestibule::FormatSecret(Bytes(kMaxBrowserCredentialBytes + more, 7));
    EXPECT_EQ(FindCredential(word).has_value(), more == 0);
  }
  EXPECT_FALSE(FindCredential("token." + std::string(100'000, 'A')));
}

TEST(Introductions, SayWhoseConnectionItIs) {
  const vestibule::Key key{1, 2, 3}, other{4};
  const Credential own{Credential::Kind::kInvite, Bytes(kMaxBrowserCredentialBytes, 9)};
  for (const char* address : {"198.51.100.7", "2001:db8::7"}) {
    const Credential introduced = Introduce(own, address, key, 1000);
    EXPECT_EQ(introduced.kind, Credential::Kind::kIntroduced);
    EXPECT_LE(introduced.bytes.size(), vestibule::kMaxCredentialBytes);
    const std::span<const std::uint8_t> bytes = introduced.bytes;
    const std::size_t size = vestibule::CountIntroductionBytes();
    const auto token = vestibule::OpenToken(vestibule::TokenKind::kIntroduction, bytes.first(size), key);
    ASSERT_TRUE(token);
    EXPECT_EQ(transport::FormatIp(token->admission.from), address);
    EXPECT_EQ(token->issued, 1000U);
    EXPECT_EQ(token->expires, 1000 + vestibule::kMaxTokenSeconds);
    const auto inner = vestibule::ReadCredential(bytes.subspan(size));
    ASSERT_TRUE(inner);
    EXPECT_EQ(inner->kind, own.kind);
    EXPECT_EQ(inner->bytes, own.bytes);
    EXPECT_FALSE(vestibule::OpenToken(vestibule::TokenKind::kIntroduction, bytes.first(size), other));
    EXPECT_FALSE(vestibule::OpenToken(vestibule::TokenKind::kConnect, bytes.first(size), key));
  }
}

}  // namespace
}  // namespace wobble::gateway
