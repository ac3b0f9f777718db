// The order of the checks is the order of their cost: kind and size, rate, keyed hash (0.3 us), and only for a proved
// address the key agreement (100 us).
#include "protocol/transport/vestibule/door.h"

#include <algorithm>
#include <cassert>

#include "protocol/limits.h"

namespace wobble::transport::vestibule {
namespace {

// A cookie holds for its epoch and the next one: the answer to a challenge may take 10 to 20 s.
constexpr double kEpochSeconds = 10;
// For so long a client's response may come again. Longer than its cookie holds, so that nobody can open a session
// twice.
constexpr double kAnsweredSeconds = 2 * kEpochSeconds + 1;

// Requests a second of a subnet, each of which costs an answer; and of handshakes, each of which costs 100 us. Clients
// try again, so a crowd behind one address only waits a little.
constexpr double kRequestRate = 50, kRequestBurst = 200;
// Under a flood, when all subnets together ask more often than kCalmRate, a subnet has the scarce rate alone: an answer
// costs as much as ten requests that are dropped, and an honest client needs two or three.
constexpr double kCalmRate = 2000, kCalmBurst = 4000;
constexpr double kScarceRate = 5, kScarceBurst = 20;
constexpr double kHandshakeRate = 50, kHandshakeBurst = 100;
constexpr double kHandshakeRateOfAll = 200, kHandshakeBurstOfAll = 400;
// Credentials that do not hold, a second of a subnet: a password of eight letters lasts for centuries.
constexpr double kGuessRate = 0.2, kGuessBurst = 10;
// A visitor may send so many seconds' datagrams at once, after a link that was dead for a while.
constexpr double kDatagramBurst = 2;

// ENet's first datagram comes with the response or soon after it. Silence ends a session in the server long before.
constexpr double kConnectSeconds = 5;
constexpr double kSilenceSeconds = 30;

constexpr std::uint32_t kSlotBits = 12;

// The first byte of a server query.
constexpr std::uint8_t kQueryByte = 0xFF;
static_assert(kMaxVisitors < 1U << kSlotBits);

// Of a credential that does not hold.
Turnaway FindTurnaway(Credential::Kind kind) {
  switch (kind) {
    case Credential::Kind::kNone:
      return Turnaway::kNothingShown;
    case Credential::Kind::kPassword:
      return Turnaway::kPassword;
    case Credential::Kind::kToken:
      return Turnaway::kToken;
    case Credential::Kind::kInvite:
      return Turnaway::kInvite;
    case Credential::Kind::kOwnerKey:
      return Turnaway::kOwnerKey;
    case Credential::Kind::kIntroduced:
      return Turnaway::kGateway;
  }
  return Turnaway::kNothingShown;
}

// What the client is told: of a credential only that it does not hold.
Refusal FindRefusal(Turnaway why) {
  switch (why) {
    case Turnaway::kFull:
      return Refusal::kFull;
    case Turnaway::kTooManyFromAddress:
      return Refusal::kTooManyFromAddress;
    case Turnaway::kBanned:
      return Refusal::kBanned;
    default:
      return Refusal::kBadCredential;
  }
}

}  // namespace

Door::Door(Settings settings)
    : m_settings(std::move(settings)),
      m_started(MakeKeyPair(m_settings.random)),
      m_requestRates(kRequestRate, kRequestBurst, m_started.secretKey),
      m_scarceRates(kScarceRate, kScarceBurst, m_started.secretKey),
      m_handshakeRates(kHandshakeRate, kHandshakeBurst, m_started.secretKey),
      m_guessRates(kGuessRate, kGuessBurst, m_started.secretKey),
      m_queries(m_settings.pictures, m_settings.random),
      m_slots(CountSlots(m_settings.maxVisitors)) {
  assert(m_settings.maxVisitors >= 1 && m_settings.maxVisitors <= kMaxVisitors);
  m_settings.random(m_cookieKey);
  // The same after a restart, so that clients of the run before can be told.
  static constexpr std::array<std::uint8_t, 5> kPurpose{'r', 'e', 's', 'e', 't'};
  ComputeHash(m_resetKey, m_settings.identity.secretKey, kPurpose);
}

Door::Result Door::TakeDatagram(const NetAddress& from, std::span<const std::uint8_t> datagram, double now) {
  if (datagram.empty()) return ++m_counts.invalid, Result{};
  switch (datagram[0]) {
    case static_cast<std::uint8_t>(OpenKind::kRequest):
      return TakeRequest(from, datagram, now);
    case static_cast<std::uint8_t>(OpenKind::kResponse):
      return TakeResponse(from, datagram, now);
    case static_cast<std::uint8_t>(SealedKind::kData):
      return TakeData(from, datagram, now);
    case kQueryByte:
      return TakeQuery(from, datagram, now);
    default:
      return ++m_counts.invalid, Result{};
  }
}

Door::Result Door::TakeRequest(const NetAddress& from, std::span<const std::uint8_t> datagram, double now) {
  const auto request = ReadRequest(datagram);
  if (!request) return ++m_counts.invalid, Result{};
  ++m_counts.requests;
  if (!MayAsk(FindSubnet(from), now)) return ++m_counts.limited, Result{};
  m_answer.clear();
  const Echo echo = MakeEcho(request->client);
  if (request->version != kVestibuleVersion) {
    Write(OtherVersion{.echo = echo, .version = kVestibuleVersion}, m_answer);
    return {.answer = m_answer};
  }
  const auto epoch = static_cast<std::uint64_t>(now / kEpochSeconds);
  Write(Challenge{.echo = echo,
                  .epoch = static_cast<std::uint8_t>(epoch),
                  .cookie = MakeCookie(from, request->client, epoch),
                  .server = m_settings.identity.publicKey,
                  .started = m_started.publicKey,
                  .wantsCredential = m_settings.judge != nullptr && m_settings.judge->WantsCredential()},
        m_answer);
  assert(m_answer.size() <= kRequestBytes);
  ++m_counts.challenges;
  return {.answer = m_answer};
}

bool Door::MayAsk(const Subnet& subnet, double now) {
  if (!m_requestRates.Take(subnet, now)) return false;
  return m_requests.Take(kCalmRate, kCalmBurst, now) || m_scarceRates.Take(subnet, now);
}

Door::Result Door::TakeResponse(const NetAddress& from, std::span<const std::uint8_t> datagram, double now) {
  const auto response = ReadResponse(datagram);
  if (!response) return ++m_counts.invalid, Result{};
  const auto present = static_cast<std::uint64_t>(now / kEpochSeconds);
  const auto age = static_cast<std::uint8_t>(static_cast<std::uint8_t>(present) - response->epoch);
  if (age > 1 || age > present) return ++m_counts.invalid, Result{};
  if (!AreEqual(MakeCookie(from, response->client, present - age), response->cookie)) {
    return ++m_counts.invalid, Result{};
  }
  if (const auto known = m_answered.find(response->client); known != m_answered.end()) {
    return AnswerAgain(known->second, *response, now);
  }
  const bool isWithinRates =
      m_handshakeRates.Take(FindSubnet(from), now) && m_handshakes.Take(kHandshakeRateOfAll, kHandshakeBurstOfAll, now);
  if (!isWithinRates) return ++m_counts.limited, Result{};
  const auto keys = DeriveAsServer(m_settings.identity, m_started, response->client);
  if (!keys) return ++m_counts.invalid, Result{};
  Opener opener(keys->toServer);
  if (!opener.Open(response->credential, m_plain)) return ++m_counts.invalid, Result{};
  ForgetAnswered(now);
  Judgement judgement = JudgeClient(from, now);
  if (judgement.refusal != Refusal::kNone) return Refuse(*response, *keys, judgement.refusal, now);
  return LetIn(from, *response, *keys, opener, std::move(judgement), now);
}

// m_plain has the credential.
Judgement Door::JudgeClient(const NetAddress& from, double now) {
  auto credential = ReadCredential(m_plain);
  if (!credential) return TurnAway(Turnaway::kNothingShown, from);
  const NetAddress source = m_settings.judge == nullptr ? from : m_settings.judge->FindSource(*credential, from);
  // Who is not let in for another reason learns nothing about the credential, and spends none.
  if (m_counted >= m_settings.maxVisitors || FindFreeSlot() == m_slots.size()) {
    return TurnAway(Turnaway::kFull, source);
  }
  if (CountVisitorsOf(source) >= m_settings.maxPerAddress) return TurnAway(Turnaway::kTooManyFromAddress, source);
  Judgement judgement;
  if (m_settings.judge != nullptr) judgement = JudgeCredential(*credential, source, now);
  judgement.admission.from = source;
  return judgement;
}

Judgement Door::JudgeCredential(const Credential& credential, const NetAddress& source, double now) {
  const bool isGateway = credential.kind == Credential::Kind::kIntroduced;  // and nobody whom the judge knows
  if (!m_guessRates.Take(FindSubnet(source), now)) {
    return TurnAway(isGateway ? Turnaway::kGateway : Turnaway::kTooManyGuesses, source);
  }
  Judgement judgement = m_settings.judge->Decide(credential, source);
  if (judgement.refusal != Refusal::kBadCredential) m_guessRates.Return(FindSubnet(source));
  if (judgement.refusal == Refusal::kBadCredential) return TurnAway(FindTurnaway(credential.kind), source);
  if (judgement.refusal == Refusal::kBanned) return TurnAway(Turnaway::kBanned, source);
  return judgement;
}

Judgement Door::TurnAway(Turnaway why, const NetAddress& source) {
  Turnaways& counted = m_counts.turnaways[static_cast<std::size_t>(why)];
  ++counted.count;
  counted.last = source;
  return {.refusal = FindRefusal(why)};
}

std::size_t Door::CountVisitorsOf(const NetAddress& source) const {
  return static_cast<std::size_t>(
      std::count_if(m_slots.begin(), m_slots.end(), [&](const std::unique_ptr<Visitor>& visitor) {
        return visitor != nullptr && !visitor->isReleased && visitor->judgement.admission.from.ip == source.ip;
      }));
}

Door::Result Door::LetIn(const NetAddress& from, const Response& response, const SessionKeys& keys, Opener opener,
                         Judgement judgement, double now) {
  const std::size_t slot = FindFreeSlot();
  auto fresh = std::make_unique<Visitor>();
  Visitor& visitor = *fresh;
  std::array<std::uint8_t, 2> high;
  m_settings.random(high);
  const std::uint32_t generation = (high[0] | std::uint32_t{high[1]} << 8U) & 0xFFFU;
  visitor.id = ++m_newest;
  // 0 is what a client writes that does not know its number yet.
  visitor.session = static_cast<std::uint32_t>(slot) | (generation == 0 ? 1U : generation) << kSlotBits;
  visitor.address = from;
  visitor.client = response.client;
  visitor.toClient = keys.toClient;
  visitor.opener = opener;
  visitor.control = Sealer(keys.control);
  visitor.letInAt = visitor.lastHeard = now;
  visitor.judgement = std::move(judgement);
  m_slots[slot] = std::move(fresh);
  m_slotOf[visitor.id] = slot;
  m_answered[response.client] = {.answer = {}, .visitor = visitor.id, .at = now};
  ++m_counted;
  ++m_counts.accepted;
  Result result = Pass(visitor, response.first, now);
  Accept(visitor);
  result.answer = m_answer;
  result.isNew = true;
  return result;
}

void Door::Accept(Visitor& visitor) {
  std::vector<std::uint8_t> plain;
  Write(Answer{.refusal = Refusal::kNone,
               .reset = MakeResetToken(visitor.address, visitor.session),
               .ticket = visitor.judgement.ticket},
        plain);
  const std::span<const std::uint8_t> part = plain;
  m_answer.clear();
  visitor.control.Seal(SealedKind::kControl, visitor.session, {&part, 1}, m_answer);
}

Door::Result Door::Refuse(const Response& response, const SessionKeys& keys, Refusal refusal, double now) {
  std::vector<std::uint8_t> plain;
  Write(Answer{.refusal = refusal, .reset = {}, .ticket = {}}, plain);
  const std::span<const std::uint8_t> part = plain;
  m_answer.clear();
  Sealer(keys.control).Seal(SealedKind::kControl, 0, {&part, 1}, m_answer);
  m_answered[response.client] = {.answer = m_answer, .visitor = 0, .at = now};
  ++m_counts.refused;
  return {.answer = m_answer};
}

Door::Result Door::AnswerAgain(const Answered& answered, const Response& response, double now) {
  if (answered.visitor == 0) {
    m_answer = answered.answer;
    return {.answer = m_answer};
  }
  Visitor* visitor = Find(answered.visitor);
  if (visitor == nullptr) return ++m_counts.invalid, Result{};
  Result result = Pass(*visitor, response.first, now);
  Accept(*visitor);
  result.answer = m_answer;
  return result;
}

// An answer in parts costs as many askings as it has parts.
Door::Result Door::TakeQuery(const NetAddress& from, std::span<const std::uint8_t> datagram, double now) {
  const auto query = protocol::ReadQuery(datagram);
  if (!query || !m_queries.IsOpen()) return ++m_counts.invalid, Result{};
  const Subnet subnet = FindSubnet(from);
  if (!MayAsk(subnet, now)) return ++m_counts.limited, Result{};
  Result result{.told = m_queries.Answer(from, *query, now)};
  m_counts.queries = m_queries.Counts();
  for (std::size_t i = 1; i < result.told.size(); ++i) {
    if (!MayAsk(subnet, now)) return ++m_counts.limited, Result{};
  }
  return result;
}

Door::Result Door::TakeData(const NetAddress& from, std::span<const std::uint8_t> datagram, double now) {
  if (datagram.size() < kSealedOverhead) return ++m_counts.invalid, Result{};
  const std::uint32_t session = ReadSession(datagram);
  const std::size_t slot = session & ((1U << kSlotBits) - 1);
  Visitor* visitor = slot < m_slots.size() ? m_slots[slot].get() : nullptr;
  if (visitor == nullptr || visitor->session != session || visitor->address != from) {
    ++m_counts.strangers;
    return SendReset(from, session, now);
  }
  return Pass(*visitor, datagram, now);
}

Door::Result Door::Pass(Visitor& visitor, std::span<const std::uint8_t> sealed, double now) {
  Result result{.visitor = visitor.id};
  if (sealed.empty()) return result;
  if (!visitor.opener.Open(sealed, m_plain)) return ++m_counts.invalid, Result{};
  if (visitor.isPutOut) return {};
  visitor.lastHeard = now;
  if (!visitor.rate.Take(m_settings.datagramRate, kDatagramBurst * m_settings.datagramRate, now))
    return ++m_counts.limited, Result{};
  switch (visitor.filter.Judge(m_plain)) {
    case CommandFilter::Verdict::kPass:
      ++m_counts.passed;
      result.plain = m_plain;
      break;
    case CommandFilter::Verdict::kDrop:
      break;
    case CommandFilter::Verdict::kOffence:
      ++m_counts.offences;
      visitor.isPutOut = result.isOffence = true;
      break;
  }
  return result;
}

Door::Result Door::SendReset(const NetAddress& from, std::uint32_t session, double now) {
  if (session == 0 || !MayAsk(FindSubnet(from), now)) return {};
  m_answer.clear();
  Write(Reset{.session = session, .token = MakeResetToken(from, session)}, m_answer);
  ++m_counts.resets;
  return {.answer = m_answer};
}

Door::Leg Door::FindLeg(VisitorId visitor) const {
  const auto slot = m_slotOf.find(visitor);
  if (slot == m_slotOf.end()) return {};
  const Visitor& found = *m_slots[slot->second];
  return {.address = found.address,
          .session = found.session,
          .toClient = found.toClient,
          .admission = found.judgement.admission};
}

void Door::Release(VisitorId visitor) {
  Visitor* found = Find(visitor);
  if (found == nullptr || found->isReleased) return;
  found->isReleased = true;
  --m_counted;
}

void Door::Remove(VisitorId visitor) {
  Release(visitor);
  const auto slot = m_slotOf.find(visitor);
  if (slot == m_slotOf.end()) return;
  m_slots[slot->second].reset();
  m_slotOf.erase(slot);
}

void Door::RemoveOverdue(double now, std::vector<VisitorId>& removed) {
  removed.clear();
  for (const std::unique_ptr<Visitor>& visitor : m_slots) {
    if (visitor == nullptr) continue;
    const bool isLate = !visitor->filter.ConnectionNumber() && now - visitor->letInAt > kConnectSeconds;
    if (isLate || now - visitor->lastHeard > kSilenceSeconds) removed.push_back(visitor->id);
  }
  for (const VisitorId visitor : removed) Remove(visitor);
}

Door::Visitor* Door::Find(VisitorId visitor) {
  const auto slot = m_slotOf.find(visitor);
  return slot == m_slotOf.end() ? nullptr : m_slots[slot->second].get();
}

std::size_t Door::FindFreeSlot() const {
  const auto free = std::find(m_slots.begin(), m_slots.end(), nullptr);
  return static_cast<std::size_t>(free - m_slots.begin());
}

// At most kHandshakeRateOfAll a second are added, so there are never more than a few thousand.
void Door::ForgetAnswered(double now) {
  std::erase_if(m_answered, [&](const auto& entry) { return now - entry.second.at > kAnsweredSeconds; });
}

namespace {

void AppendAddress(std::vector<std::uint8_t>& bytes, const NetAddress& address) {
  bytes.insert(bytes.end(), address.ip.begin(), address.ip.end());
  bytes.push_back(static_cast<std::uint8_t>(address.port));
  bytes.push_back(static_cast<std::uint8_t>(address.port >> 8U));
}

void AppendNumber(std::vector<std::uint8_t>& bytes, std::uint64_t number) {
  for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

}  // namespace

Cookie Door::MakeCookie(const NetAddress& from, const Key& client, std::uint64_t epoch) const {
  std::vector<std::uint8_t> message(client.begin(), client.end());
  AppendAddress(message, from);
  AppendNumber(message, epoch);
  Cookie cookie;
  ComputeHash(cookie, m_cookieKey, message);
  return cookie;
}

ResetToken Door::MakeResetToken(const NetAddress& from, std::uint32_t session) const {
  std::vector<std::uint8_t> message;
  AppendAddress(message, from);
  AppendNumber(message, session);
  ResetToken token;
  ComputeHash(token, m_resetKey, message);
  return token;
}

}  // namespace wobble::transport::vestibule
