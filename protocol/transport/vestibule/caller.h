// The client's side of the vestibule: asks to be let in, seals what ENet sends and opens what it receives.
//
// Like the door it knows neither sockets nor clocks. One connection; one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/transport/vestibule/handshake.h"
#include "protocol/transport/vestibule/seal.h"

namespace wobble::transport::vestibule {

class Caller {
 public:
  struct Settings {
    Credential credential = {};
    std::optional<Key> server = {};  // the key that it must have; nullopt: any
    // Shown to the server with this key alone, if there is no credential for all: whoever has a server is its owner.
    // If that server does not take it, since it was started with another owner's key, the caller asks once more and
    // shows nothing.
    std::optional<Key> ownServer = {};
    Credential ownCredential = {};
    RandomSource random = FillRandomly;
  };
  explicit Caller(Settings settings);

  // kRequesting:  requests go out until a challenge comes.
  // kResponding:  it has keys: what ENet sends goes out within responses, until anything sealed comes back.
  // kIn:          ENet's datagrams go out sealed.
  // kRefused:     the server does not let it in; see ReadRefusal, or the server speaks another version.
  // kWrongServer: another server answers than the one whose key is known.
  // kReset:       the server was restarted and knows this session no more.
  enum class State : std::uint8_t { kRequesting, kResponding, kIn, kRefused, kWrongServer, kOtherVersion, kReset };
  [[nodiscard]] State ReadState() const { return m_state; }
  [[nodiscard]] bool HasEnded() const { return m_state >= State::kRefused; }
  [[nodiscard]] Refusal ReadRefusal() const { return m_refusal; }
  // From kResponding on, and for kWrongServer.
  [[nodiscard]] const Key& ServerKey() const { return m_server; }
  [[nodiscard]] bool WantsCredential() const { return m_wantsCredential; }
  // To come back with as a token; empty: the server gave none.
  [[nodiscard]] const std::vector<std::uint8_t>& Ticket() const { return m_ticket; }

  // Replaces `datagram` by the one that is due by now; empty: none. It goes to every address of the server while
  // kRequesting, then to the one that answered.
  void FindDue(double now, std::vector<std::uint8_t>& datagram);

  // Takes a datagram of the server. Returns ENet's plain bytes, valid until the next call; empty: it held none, or was
  // not from the server.
  [[nodiscard]] std::span<const std::uint8_t> TakeDatagram(std::span<const std::uint8_t> datagram, double now);

  // Whether Seal may be called: kResponding and kIn.
  [[nodiscard]] bool CanSeal() const { return m_state == State::kResponding || m_state == State::kIn; }
  // Replaces `datagram` by what is to be sent for one datagram of ENet, given in consecutive parts.
  void Seal(std::span<const std::span<const std::uint8_t>> plain, double now, std::vector<std::uint8_t>& datagram);

  // Datagrams that were not from the server.
  [[nodiscard]] std::uint64_t CountInvalid() const { return m_invalid; }

 private:
  void TakeChallenge(const Challenge& challenge);
  void TakeAnswer(std::span<const std::uint8_t> datagram);
  void AskWithoutOwnCredential();
  void WriteResponse(std::span<const std::uint8_t> first, std::vector<std::uint8_t>& datagram) const;
  void PlanRetry(double now);

  Settings m_settings;
  KeyPair m_own;
  State m_state = State::kRequesting;
  Refusal m_refusal = Refusal::kNone;
  bool m_wantsCredential = false;
  bool m_showsOwn = false;  // ownCredential
  double m_due = 0;         // of the next request or response, s
  double m_wait = 0;
  Challenge m_challenge;
  Key m_server{};
  std::vector<std::uint8_t> m_credential;  // sealed
  std::vector<std::uint8_t> m_first;       // what ENet sent last, plain, while kResponding
  Sealer m_sealer;
  Opener m_opener;
  Opener m_control;
  std::uint32_t m_session = 0;
  ResetToken m_resetToken{};
  std::vector<std::uint8_t> m_ticket;
  std::vector<std::uint8_t> m_plain;
  std::uint64_t m_invalid = 0;
};

}  // namespace wobble::transport::vestibule
