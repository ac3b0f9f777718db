#include "server/admission/gate.h"

#include <algorithm>
#include <utility>

namespace wobble::admission {

namespace vestibule = transport::vestibule;
using transport::Admission;
using transport::NetAddress;
using vestibule::Credential;
using vestibule::Judgement;
using vestibule::Refusal;
using vestibule::TokenKind;

namespace {

// Who was let in may come back for so long without what let them in, which was good once or has ended, s.
constexpr std::uint64_t kTicketSeconds = 24 * 3600;
// A matchmaker's clock may be ahead of this one's by so much, s.
constexpr std::uint64_t kClockSkew = 5;

vestibule::Key DeriveTicketKey(const vestibule::Key& secretKey) {
  static constexpr std::array<std::uint8_t, 6> kPurpose{'t', 'i', 'c', 'k', 'e', 't'};
  vestibule::Key key;
  vestibule::ComputeHash(key, secretKey, kPurpose);
  return key;
}

bool IsShort(const vestibule::Token& token, std::uint64_t now) {
  return token.issued <= now + kClockSkew && token.expires > now && token.expires >= token.issued &&
         token.expires - token.issued <= vestibule::kMaxTokenSeconds;
}

bool AsksForSomething(const GateSettings& settings) {
  return !settings.password.empty() || settings.token || settings.isByInviteOnly;
}

std::span<const std::uint8_t> BytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

Gate::Gate(GateSettings settings, Bans bans, Invites invites)
    : m_settings(std::move(settings)),
      m_wantsCredential(AsksForSomething(m_settings)),
      m_publicKey(vestibule::MakeKeyPair(m_settings.secretKey).publicKey),
      m_ticketKey(DeriveTicketKey(m_settings.secretKey)),
      m_startedAt(m_settings.readUnixTime()),
      m_bans(std::move(bans)),
      m_invites(std::move(invites)) {}

bool Gate::Reload(GateSettings settings, std::string& error) {
  const std::lock_guard lock(m_mutex);
  Bans bans = m_bans;
  Invites invites = m_invites;
  if (!bans.Reload(error) || !invites.Reload(error)) return false;
  m_bans = std::move(bans);
  m_invites = std::move(invites);
  m_settings.password = std::move(settings.password);
  m_settings.token = settings.token;
  m_settings.owner = settings.owner;
  m_settings.gateway = settings.gateway;
  m_wantsCredential = AsksForSomething(m_settings);
  return true;
}

NetAddress Gate::FindSource(Credential& credential, const NetAddress& from) {
  const std::lock_guard lock(m_mutex);
  if (credential.kind != Credential::Kind::kIntroduced || !m_settings.gateway) return from;
  const std::size_t size = vestibule::CountIntroductionBytes();
  if (credential.bytes.size() <= size) return from;
  const std::span<const std::uint8_t> bytes = credential.bytes;
  const auto introduction = vestibule::OpenToken(TokenKind::kIntroduction, bytes.first(size), *m_settings.gateway);
  auto inner = vestibule::ReadCredential(bytes.subspan(size));
  if (!introduction || !inner || !IsShort(*introduction, m_settings.readUnixTime())) return from;
  credential = std::move(*inner);
  return introduction->admission.from;
}

Judgement Gate::Decide(const Credential& credential, const NetAddress& source) {
  const std::lock_guard lock(m_mutex);
  const std::uint64_t now = m_settings.readUnixTime();
  if (m_bans.IsBanned(source, 0, now)) return {.refusal = Refusal::kBanned};
  TicketNumber number{};
  const std::optional<Admission> admission = FindAdmission(credential, number);
  if (!admission) return {.refusal = Refusal::kBadCredential};
  if (m_bans.IsBanned(source, admission->account, now)) return {.refusal = Refusal::kBanned};
  Judgement judgement{.admission = *admission};
  const bool mayNotComeTwice =
      credential.kind == Credential::Kind::kToken || credential.kind == Credential::Kind::kInvite;
  if (!mayNotComeTwice && !m_settings.givesTicketsToAll) return judgement;
  if (number == TicketNumber{}) m_settings.random(number);
  vestibule::ComputeHash(judgement.admission.identity, m_ticketKey, number);
  judgement.ticket = MakeTicket(number, *admission);
  return judgement;
}

std::optional<Admission> Gate::FindAdmission(const Credential& credential, TicketNumber& number) {
  switch (credential.kind) {
    case Credential::Kind::kNone:
      return m_wantsCredential ? std::nullopt : std::optional(Admission{});
    case Credential::Kind::kPassword: {
      // A client that has a password for an open server is let in; it cannot know.
      const bool isRight = !m_wantsCredential || (!m_settings.password.empty() &&
                                                  vestibule::AreEqual(credential.bytes, BytesOf(m_settings.password)));
      return isRight ? std::optional(Admission{}) : std::nullopt;
    }
    case Credential::Kind::kToken: {
      const bool isTicket =
          !credential.bytes.empty() && credential.bytes[0] == static_cast<std::uint8_t>(TokenKind::kTicket);
      if (!isTicket) return TakeConnectToken(credential.bytes);
      // An open server lets in who comes with an old ticket as it lets in everybody, but not as who they were.
      const auto admission = TakeTicket(credential.bytes, number);
      return admission || m_wantsCredential ? admission : std::optional(Admission{});
    }
    case Credential::Kind::kInvite: {
      const auto invite = m_invites.Use(credential.bytes, m_settings.readUnixTime());
      if (!invite) return {};
      return Admission{.rank = invite->rank, .invite = invite->number};
    }
    case Credential::Kind::kOwnerKey:
      if (!m_settings.owner || !vestibule::AreEqual(credential.bytes, *m_settings.owner)) return {};
      return Admission{.rank = transport::Rank::kOwner};
    case Credential::Kind::kIntroduced:  // by nobody whom this server trusts
      return {};
  }
  return {};
}

std::optional<Admission> Gate::TakeConnectToken(std::span<const std::uint8_t> bytes) {
  if (!m_settings.token) return {};
  const auto token = vestibule::OpenToken(TokenKind::kConnect, bytes, *m_settings.token);
  const std::uint64_t now = m_settings.readUnixTime();
  if (!token || !IsShort(*token, now)) return {};
  // Which tokens the run before has taken is not known.
  if (token->issued < m_startedAt) return {};
  if (token->server != vestibule::Key{} && token->server != m_publicKey) return {};
  std::erase_if(m_spent, [&](const auto& entry) { return entry.second <= now; });
  if (!m_spent.emplace(token->number, token->expires).second) return {};
  return token->admission;
}

// A ticket is good many times: only its client has it, and only for a client that was let in before.
std::optional<Admission> Gate::TakeTicket(std::span<const std::uint8_t> bytes, TicketNumber& number) const {
  const auto ticket = vestibule::OpenToken(TokenKind::kTicket, bytes, m_ticketKey);
  const std::uint64_t now = m_settings.readUnixTime();
  if (!ticket || ticket->expires <= now) return {};
  const std::uint32_t invite = ticket->admission.invite;
  if (invite != 0 && !m_invites.IsValid(invite, now)) return {};
  number = ticket->number;
  return ticket->admission;
}

std::vector<std::uint8_t> Gate::MakeTicket(const TicketNumber& number, const Admission& admission) const {
  const std::uint64_t now = m_settings.readUnixTime();
  const vestibule::Token ticket{
      .number = number, .issued = now, .expires = now + kTicketSeconds, .server = {}, .admission = admission};
  return vestibule::SealToken(TokenKind::kTicket, ticket, m_ticketKey, m_settings.random);
}

}  // namespace wobble::admission
