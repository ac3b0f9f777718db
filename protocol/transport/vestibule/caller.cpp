// A response carries ENet's first datagram, so that ENet's handshake costs no round trip of its own. It is sealed anew
// for each try: the server takes every number once.
#include "protocol/transport/vestibule/caller.h"

#include <algorithm>
#include <cassert>

namespace wobble::transport::vestibule {
namespace {

// Seconds between tries, which double up to the second. Over 20 % loss each way a try fails one time in three, and one
// in 10,000 clients needs nine tries for one of the two answers: with up to 1 s between them that took 8 s, which is
// all the time that a client waits.
constexpr double kFirstRetry = 0.2, kLongestRetry = 0.4;

}  // namespace

Caller::Caller(Settings settings) : m_settings(std::move(settings)), m_own(MakeKeyPair(m_settings.random)) {}

void Caller::PlanRetry(double now) {
  m_wait = m_wait == 0 ? kFirstRetry : std::min(2 * m_wait, kLongestRetry);
  m_due = now + m_wait;
}

void Caller::FindDue(double now, std::vector<std::uint8_t>& datagram) {
  datagram.clear();
  if (now < m_due) return;
  if (m_state == State::kRequesting) {
    Write(Request{.version = kVestibuleVersion, .client = m_own.publicKey}, datagram);
    PlanRetry(now);
  } else if (m_state == State::kResponding && !m_first.empty()) {
    const std::vector<std::uint8_t> again = m_first;
    const std::span<const std::uint8_t> part = again;
    Seal({&part, 1}, now, datagram);
  }
}

void Caller::TakeChallenge(const Challenge& challenge) {
  if (challenge.echo != MakeEcho(m_own.publicKey)) {
    ++m_invalid;
    return;
  }
  m_server = challenge.server;
  m_wantsCredential = challenge.wantsCredential;
  if (m_settings.server && !AreEqual(*m_settings.server, challenge.server)) {
    m_state = State::kWrongServer;
    return;
  }
  const auto keys = DeriveAsClient(m_own, challenge.server, challenge.started);
  if (!keys) {
    ++m_invalid;
    return;
  }
  m_challenge = challenge;
  m_sealer = Sealer(keys->toServer);
  m_opener = Opener(keys->toClient);
  m_control = Opener(keys->control);
  m_showsOwn = m_settings.credential.kind == Credential::Kind::kNone && m_settings.ownServer &&
               AreEqual(*m_settings.ownServer, challenge.server);
  const std::vector<std::uint8_t> credential =
      WriteCredential(m_showsOwn ? m_settings.ownCredential : m_settings.credential);
  const std::span<const std::uint8_t> part = credential;
  m_sealer.Seal(SealedKind::kData, 0, {&part, 1}, m_credential);
  m_state = State::kResponding;
  m_wait = 0;
  if (!m_first.empty()) m_due = 0;  // of the try before; see AskWithoutOwnCredential
}

// The server keeps its answer to this key, so it is asked by another one. What ENet has sent goes out again.
void Caller::AskWithoutOwnCredential() {
  m_settings.ownServer.reset();
  m_credential.clear();
  m_own = MakeKeyPair(m_settings.random);
  m_state = State::kRequesting;
  m_wait = m_due = 0;
}

void Caller::WriteResponse(std::span<const std::uint8_t> first, std::vector<std::uint8_t>& datagram) const {
  Write(Response{.epoch = m_challenge.epoch,
                 .cookie = m_challenge.cookie,
                 .client = m_own.publicKey,
                 .credential = m_credential,
                 .first = first},
        datagram);
}

void Caller::Seal(std::span<const std::span<const std::uint8_t>> plain, double now,
                  std::vector<std::uint8_t>& datagram) {
  assert(CanSeal());
  datagram.clear();
  if (m_state == State::kIn) {
    m_sealer.Seal(SealedKind::kData, m_session, plain, datagram);
    return;
  }
  std::vector<std::uint8_t> first;
  m_sealer.Seal(SealedKind::kData, 0, plain, first);
  std::vector<std::uint8_t> last;
  for (const std::span<const std::uint8_t> part : plain) last.insert(last.end(), part.begin(), part.end());
  m_first = std::move(last);
  WriteResponse(first, datagram);
  PlanRetry(now);
}

std::span<const std::uint8_t> Caller::TakeDatagram(std::span<const std::uint8_t> datagram, double) {
  if (datagram.empty() || HasEnded()) return {};
  if (m_state == State::kRequesting) {
    if (const auto challenge = ReadChallenge(datagram)) {
      TakeChallenge(*challenge);
      return {};
    }
    const auto other = ReadOtherVersion(datagram);
    if (other && other->echo == MakeEcho(m_own.publicKey)) {
      m_state = State::kOtherVersion;
    } else {
      ++m_invalid;
    }
    return {};
  }
  if (datagram[0] == static_cast<std::uint8_t>(SealedKind::kData)) {
    // The numbers of both ends' data count separately, so this also proves that the server has the session.
    if (m_opener.Open(datagram, m_plain)) {
      m_session = ReadSession(datagram);
      m_state = State::kIn;
      return m_plain;
    }
    ++m_invalid;
  } else if (datagram[0] == static_cast<std::uint8_t>(SealedKind::kControl)) {
    TakeAnswer(datagram);
  } else if (const auto reset = ReadReset(datagram);
             reset && m_state == State::kIn && AreEqual(reset->token, m_resetToken) && m_resetToken != ResetToken{}) {
    m_state = State::kReset;
  } else if (!ReadChallenge(datagram)) {  // a late challenge is no fault
    ++m_invalid;
  }
  return {};
}

void Caller::TakeAnswer(std::span<const std::uint8_t> datagram) {
  if (!m_control.Open(datagram, m_plain)) {
    ++m_invalid;
    return;
  }
  const auto answer = ReadAnswer(m_plain);
  if (!answer) return;
  if (answer->refusal == Refusal::kBadCredential && m_showsOwn) return AskWithoutOwnCredential();
  if (answer->refusal != Refusal::kNone) {
    m_refusal = answer->refusal;
    m_state = State::kRefused;
    return;
  }
  m_session = ReadSession(datagram);
  m_resetToken = answer->reset;
  m_ticket = answer->ticket;
  m_state = State::kIn;
}

}  // namespace wobble::transport::vestibule
