// Who comes in: passwords, tokens, tickets, invites, the owner's key, introductions and bans, on a clock of the test.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "server/admission/gate.h"
#include "server/admission/open_gate.h"
#include "tests/unit/vestibule/deterministic.h"

namespace wobble::admission {
namespace {

namespace vestibule = transport::vestibule;
using transport::Rank;
using vestibule::Bytes;
using vestibule::Credential;
using vestibule::Refusal;
using vestibule::Token;
using vestibule::TokenKind;

constexpr std::uint64_t kStart = 1'800'000'000;

vestibule::Key MakeKey(std::uint8_t first) {
  vestibule::Key key{};
  key[0] = first;
  return key;
}

class GateTest : public testing::Test {
 protected:
  GateTest() {
    EXPECT_TRUE(vestibule::InitialiseSodium());
    settings.secretKey = MakeKey(1);
    settings.readUnixTime = [this] { return now; };
    settings.random = vestibule::MakeRandom(1);
  }
  void Open() { gate = std::make_unique<Gate>(settings, Bans{}, Invites{}); }
  vestibule::Judgement Show(Credential::Kind kind, Bytes bytes = {}, transport::NetAddress from = kHome) {
    return gate->Decide({kind, std::move(bytes)}, from);
  }
  Refusal Refused(Credential::Kind kind, Bytes bytes = {}, transport::NetAddress from = kHome) {
    return Show(kind, std::move(bytes), from).refusal;
  }
  Token MakeToken() {
    Token token{.issued = now, .expires = now + 30, .server = {}, .admission = {.rank = Rank::kPlayer, .account = 7}};
    settings.random(token.number);
    return token;
  }
  Bytes Seal(const Token& token, std::uint8_t key = 2) {
    return SealToken(TokenKind::kConnect, token, MakeKey(key), settings.random);
  }

  inline static const transport::NetAddress kHome = vestibule::MakeAddress(203, 0, 113, 5, 1000);
  GateSettings settings;
  std::unique_ptr<Gate> gate;
  std::uint64_t now = kStart;
};

TEST_F(GateTest, AnOpenServerTakesEverybodyButWrongSecrets) {
  settings.owner = MakeKey(9);
  Open();
  EXPECT_FALSE(gate->WantsCredential());
  EXPECT_EQ(Refused(Credential::Kind::kNone), Refusal::kNone);
  EXPECT_EQ(Refused(Credential::Kind::kPassword, {'x'}), Refusal::kNone) << "a client cannot know that none is needed";
  EXPECT_EQ(Refused(Credential::Kind::kToken, {1, 2}), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kInvite, {1, 2}), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kOwnerKey, Bytes(32, 1)), Refusal::kBadCredential);
  const vestibule::Key owner = MakeKey(9);
  EXPECT_EQ(Show(Credential::Kind::kOwnerKey, {owner.begin(), owner.end()}).admission.rank, Rank::kOwner);
}

TEST_F(GateTest, APasswordIsWanted) {
  settings.password = "tulip";
  Open();
  EXPECT_TRUE(gate->WantsCredential());
  EXPECT_EQ(Refused(Credential::Kind::kNone), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kPassword, {'t', 'u', 'l', 'i'}), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kPassword, {'t', 'u', 'l', 'i', 'p'}), Refusal::kNone);
}

TEST_F(GateTest, ATokenIsGoodOnceAndForALittleWhile) {
  settings.token = MakeKey(2);
  Open();
  const Bytes bytes = Seal(MakeToken());
  const auto first = Show(Credential::Kind::kToken, bytes);
  EXPECT_EQ(first.refusal, Refusal::kNone);
  EXPECT_EQ(first.admission.account, 7U);
  EXPECT_EQ(Refused(Credential::Kind::kToken, bytes), Refusal::kBadCredential) << "spent";
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(MakeToken(), 3)), Refusal::kBadCredential) << "another key";

  Token late = MakeToken(), early = MakeToken(), lasting = MakeToken(), elsewhere = MakeToken(), past = MakeToken();
  lasting.expires = now + 31;
  early.issued = now + 6, early.expires = now + 20;
  elsewhere.server = MakeKey(8);
  past.issued = kStart - 1;
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(lasting)), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(early)), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(elsewhere)), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(past)), Refusal::kBadCredential) << "the run before may have had it";
  Token here = MakeToken();
  here.server = vestibule::MakeKeyPair(MakeKey(1)).publicKey;
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(here)), Refusal::kNone);
  now += 30;
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(late)), Refusal::kBadCredential);
  EXPECT_EQ(Refused(Credential::Kind::kToken, bytes), Refusal::kBadCredential) << "forgotten as spent, but expired";
}

TEST_F(GateTest, EveryBitOfATokenCounts) {
  settings.token = MakeKey(2);
  Open();
  const Bytes good = Seal(MakeToken());
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    ASSERT_EQ(Refused(Credential::Kind::kToken, bad), Refusal::kBadCredential) << bit;
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_EQ(Refused(Credential::Kind::kToken, {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}),
              Refusal::kBadCredential);
  }
  EXPECT_EQ(Refused(Credential::Kind::kToken, good), Refusal::kNone);
}

TEST_F(GateTest, WhoWasLetInComesBackByTicketEvenAfterARestart) {
  settings.token = MakeKey(2);
  Open();
  const auto first = Show(Credential::Kind::kToken, Seal(MakeToken()));
  ASSERT_FALSE(first.ticket.empty());
  ASSERT_LE(first.ticket.size(), vestibule::kMaxCredentialBytes);
  now += 600;
  Open();
  for (int i = 0; i < 3; ++i) {
    const auto again = Show(Credential::Kind::kToken, first.ticket);
    EXPECT_EQ(again.refusal, Refusal::kNone);
    EXPECT_EQ(again.admission.account, 7U);
  }
  now += 24 * 3600;
  EXPECT_EQ(Refused(Credential::Kind::kToken, first.ticket), Refusal::kBadCredential);
  settings.secretKey = MakeKey(5);
  Open();
  now = kStart;
  EXPECT_EQ(Refused(Credential::Kind::kToken, first.ticket), Refusal::kBadCredential) << "another server's";
}

TEST_F(GateTest, WhoeverGetsATicketIsKnownByItAgain) {
  using Identity = decltype(transport::Admission::identity);
  Open();
  EXPECT_TRUE(Show(Credential::Kind::kNone).ticket.empty());
  settings.givesTicketsToAll = true;
  Open();
  const auto first = Show(Credential::Kind::kNone);
  const auto other = Show(Credential::Kind::kNone);
  EXPECT_NE(first.admission.identity, Identity{});
  EXPECT_NE(first.admission.identity, other.admission.identity);
  now += 600;
  Open();
  auto again = Show(Credential::Kind::kToken, first.ticket);
  EXPECT_EQ(again.admission.identity, first.admission.identity);
  again = Show(Credential::Kind::kToken, again.ticket);
  EXPECT_EQ(again.admission.identity, first.admission.identity) << "by the ticket of its return, too";
  now += 2 * 24 * 3600;
  const auto late = Show(Credential::Kind::kToken, first.ticket);
  EXPECT_EQ(late.refusal, Refusal::kNone) << "an open server lets everybody in";
  EXPECT_NE(late.admission.identity, first.admission.identity) << "but as somebody else";
}

TEST_F(GateTest, AnInviteHasARankAnEndAndUses) {
  settings.isByInviteOnly = true;
  Open();
  Invite wanted{.rank = Rank::kModerator, .until = now + 60, .uses = 2, .isCounted = true};
  std::string error;
  const std::string secret = gate->ChangeInvites(
      [&](Invites& invites, std::uint64_t at, const auto& random) { return invites.Make(wanted, at, random, error); });
  const Bytes bytes = vestibule::ParseSecret(secret).value();
  EXPECT_EQ(Refused(Credential::Kind::kNone), Refusal::kBadCredential);
  const auto guest = Show(Credential::Kind::kInvite, bytes);
  EXPECT_EQ(guest.admission.rank, Rank::kModerator);
  EXPECT_EQ(Refused(Credential::Kind::kInvite, bytes), Refusal::kNone);
  EXPECT_EQ(Refused(Credential::Kind::kInvite, bytes), Refusal::kBadCredential) << "used up";
  EXPECT_EQ(Refused(Credential::Kind::kToken, guest.ticket), Refusal::kNone) << "its guests come back";
  const auto revoke = [&](Invites& invites, std::uint64_t at, const auto&) {
    return invites.Revoke(wanted.number, at, error);
  };
  EXPECT_TRUE(gate->ChangeInvites(revoke));
  EXPECT_FALSE(gate->ChangeInvites(revoke));
  EXPECT_EQ(Refused(Credential::Kind::kToken, guest.ticket), Refusal::kBadCredential);
}

TEST_F(GateTest, BansHoldForAddressesSubnetsAndAccountsUntilTheyEnd) {
  settings.token = MakeKey(2);
  settings.owner = MakeKey(9);
  Open();
  std::string error;
  const auto ban = [&](const Ban& wanted) {
    gate->ChangeBans([&](Bans& bans, std::uint64_t at) { bans.Add(wanted, at, error); });
  };
  ban({.until = now + 100, .account = 0, .address = kHome, .reason = ""});
  ban({.until = 0, .account = 7, .address = {}, .reason = "cuts"});
  ban({.until = now + 100, .account = 0, .address = transport::ParseIp("2001:db8:1:2::3").value(), .reason = ""});
  const auto other = vestibule::MakeAddress(203, 0, 113, 6, 1);
  Token stranger = MakeToken();
  stranger.admission.account = 8;
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(stranger)), Refusal::kBanned);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(stranger), other), Refusal::kNone) << "not even spent before";
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(MakeToken()), other), Refusal::kBanned) << "the account";
  const auto near = transport::ParseIp("2001:db8:1:2:ffff::1").value(),
             far = transport::ParseIp("2001:db8:1:3::3").value();
  settings.random(stranger.number);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(stranger), near), Refusal::kBanned);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(stranger), far), Refusal::kNone);
  now += 101;
  stranger = MakeToken();
  stranger.admission.account = 8;
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(stranger)), Refusal::kNone);
  EXPECT_EQ(Refused(Credential::Kind::kToken, Seal(MakeToken())), Refusal::kBanned) << "for good";
}

TEST_F(GateTest, AGatewaySaysWhoseConnectionItIs) {
  settings.gateway = MakeKey(4);
  settings.password = "tulip";
  Open();
  const auto browser = transport::ParseIp("198.51.100.9").value();
  const auto introduce = [&](std::uint8_t key, std::uint64_t expires) {
    const Token token{.issued = now, .expires = expires, .server = {}, .admission = {.from = browser}};
    Credential credential{Credential::Kind::kIntroduced,
                          SealToken(TokenKind::kIntroduction, token, MakeKey(key), settings.random)};
    EXPECT_EQ(credential.bytes.size(), vestibule::CountIntroductionBytes());
    const Bytes inner = vestibule::WriteCredential({Credential::Kind::kPassword, {'t', 'u', 'l', 'i', 'p'}});
    credential.bytes.insert(credential.bytes.end(), inner.begin(), inner.end());
    return credential;
  };
  Credential good = introduce(4, now + 30);
  EXPECT_EQ(gate->FindSource(good, kHome).ip, browser.ip);
  EXPECT_EQ(gate->Decide(good, browser).refusal, Refusal::kNone);
  for (Credential bad : {introduce(5, now + 30), introduce(4, now + 31), introduce(4, now)}) {
    EXPECT_EQ(gate->FindSource(bad, kHome).ip, kHome.ip);
    EXPECT_EQ(gate->Decide(bad, kHome).refusal, Refusal::kBadCredential);
  }
}

struct Folder {
  Folder() : path(testing::TempDir() + "wobble-gate-" + std::to_string(getpid())) {
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  [[nodiscard]] std::string operator/(const char* name) const { return (path / name).string(); }
  std::filesystem::path path;
};

TEST_F(GateTest, BansAndInvitesOutliveTheServerAndFaultyFilesAreNamed) {
  const Folder folder;
  GateFiles files;
  files.ownerKey = folder / "owner.key";
  files.bans = folder / "bans";
  files.invites = folder / "invites";
  std::string error, secret;
  const auto open = [&] {
    return OpenGate(
        files, MakeKey(1), [this] { return now; }, error);
  };
  auto opened = open();
  ASSERT_NE(opened, nullptr) << error;
  EXPECT_TRUE(opened->WantsCredential());
  Invite wanted{.until = now + 60};
  opened->ChangeInvites([&](Invites& invites, std::uint64_t at, const auto& random) {
    secret = invites.Make(wanted, at, random, error);
  });
  opened->ChangeBans([&](Bans& bans, std::uint64_t at) {
    bans.Add({.until = 0, .account = 0, .address = kHome, .reason = "cuts everything"}, at, error);
  });
  EXPECT_EQ(error, "");
  opened = open();
  ASSERT_NE(opened, nullptr) << error;
  const Bytes bytes = vestibule::ParseSecret(secret).value();
  EXPECT_EQ(opened->Decide({Credential::Kind::kInvite, bytes}, kHome).refusal, Refusal::kBanned);
  const auto other = vestibule::MakeAddress(203, 0, 113, 6, 1);
  EXPECT_EQ(opened->Decide({Credential::Kind::kInvite, bytes}, other).refusal, Refusal::kNone);
  std::ifstream in(files.invites);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(text.find(secret), std::string::npos) << "the file has hashes alone";

  // What others write into the files holds once they are read again, and nothing does of a faulty one.
  std::ofstream(files.bans) << "ever 203.0.113.6\n";
  EXPECT_EQ(opened->Decide({Credential::Kind::kInvite, bytes}, kHome).refusal, Refusal::kBanned);
  ASSERT_TRUE(ReloadGate(files, *opened, error)) << error;
  EXPECT_EQ(opened->Decide({Credential::Kind::kInvite, bytes}, kHome).refusal, Refusal::kNone);
  EXPECT_EQ(opened->Decide({Credential::Kind::kInvite, bytes}, other).refusal, Refusal::kBanned);
  files.password = folder / "password";
  EXPECT_FALSE(ReloadGate(files, *opened, error));
  EXPECT_NE(error.find("--password-file"), std::string::npos) << error;
  std::ofstream(files.password) << "sesame\n";
  std::ofstream(files.bans) << "";
  ASSERT_TRUE(ReloadGate(files, *opened, error)) << error;
  const std::string sesame = "sesame";
  EXPECT_EQ(opened->Decide({Credential::Kind::kPassword, {sesame.begin(), sesame.end()}}, other).refusal,
            Refusal::kNone);
  files.password.clear();
  std::ofstream(files.bans) << "ever 192.0.2\n";
  EXPECT_FALSE(ReloadGate(files, *opened, error));
  EXPECT_EQ(opened->Decide({Credential::Kind::kPassword, {sesame.begin(), sesame.end()}}, other).refusal,
            Refusal::kNone);
  std::ofstream(files.bans) << "";
  error.clear();

  for (const auto& [file, line] : {std::pair{files.bans, "tomorrow 192.0.2.1"}, std::pair{files.bans, "ever 192.0.2"},
                                   std::pair{files.invites, "1 king ever any 00"}}) {
    const std::string before = [&] {
      std::ifstream old(file);
      return std::string((std::istreambuf_iterator<char>(old)), {});
    }();
    std::ofstream(file) << line << "\n";
    error.clear();
    EXPECT_EQ(open(), nullptr);
    EXPECT_NE(error.find(line), std::string::npos) << error;
    std::ofstream(file) << before;
  }
  std::ofstream(folder / "empty");
  files.password = folder / "empty";
  std::filesystem::permissions(files.password, std::filesystem::perms::owner_read);
  const std::vector<std::string> others{folder / "server.key", ""};
  EXPECT_TRUE(FindReadableByAll(files, others).empty());
  std::filesystem::permissions(files.password, std::filesystem::perms(0644));
  EXPECT_EQ(FindReadableByAll(files, others), std::vector{files.password});
  EXPECT_EQ(open(), nullptr);
  EXPECT_EQ(error.rfind("--password-file", 0), 0U) << error;
}

}  // namespace
}  // namespace wobble::admission
