// The server's side of the vestibule: who is let in, and what of theirs may pass to ENet.
//
// It knows neither sockets nor clocks: datagrams, addresses and times go in, answers and plain bytes come out, so that
// a test can play every datagram of an attack in virtual time. One thread only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "protocol/transport/transport.h"
#include "protocol/transport/vestibule/command_filter.h"
#include "protocol/transport/vestibule/handshake.h"
#include "protocol/transport/vestibule/judge.h"
#include "protocol/transport/vestibule/query_desk.h"
#include "protocol/transport/vestibule/rate_table.h"
#include "protocol/transport/vestibule/seal.h"

namespace wobble::transport::vestibule {

// A client whose address is proved and who was let in. Counts from 1, never reused; the session's number on the wire is
// another one.
using VisitorId = std::uint32_t;

// ENet numbers its peers in 12 bits.
inline constexpr std::size_t kMaxVisitors = 4000;
// Visitors that there is room for, with those who are being sent away and do not count.
[[nodiscard]] inline std::size_t CountSlots(std::size_t maxVisitors) {
  return std::min<std::size_t>(4095, maxVisitors + maxVisitors / 2 + 16);
}

// What happened, in datagrams.
struct DoorCounts {
  std::uint64_t requests = 0;
  std::uint64_t challenges = 0;
  std::uint64_t accepted = 0;   // visitors
  std::uint64_t refused = 0;    // responses with a valid cookie
  std::uint64_t passed = 0;     // to ENet
  std::uint64_t limited = 0;    // above a rate: dropped
  std::uint64_t invalid = 0;    // no datagram of ours, a wrong cookie, not sealed with the session's key, or again
  std::uint64_t strangers = 0;  // of a session that is not known, or from another address than its own
  std::uint64_t resets = 0;     // answers to these
  std::uint64_t offences = 0;   // visitors put out for what they sent
  std::array<Turnaways, kTurnawayCount> turnaways = {};  // those who were refused, by Turnaway
  QueryCounts queries = {};
};

class Door {
 public:
  struct Settings {
    KeyPair identity;
    std::size_t maxVisitors = 64;    // that count, see Release; at most kMaxVisitors
    std::size_t maxPerAddress = 64;  // likewise, of one IP address
    double datagramRate = 400;       // of one visitor, a second: an input a tick, acknowledgements and commands
    RandomSource random = FillRandomly;
    std::shared_ptr<Judge> judge = {};           // null: everybody may come in
    std::shared_ptr<PictureSlot> pictures = {};  // of what is played, for strangers who ask; null: none is answered
  };
  // now: s, above 0, never backwards, in all functions.
  explicit Door(Settings settings);

  // What became of a datagram. The spans are valid until the next call.
  struct Result {
    std::span<const std::uint8_t> answer = {};  // to be sent back; empty: nothing
    VisitorId visitor = 0;                      // whose datagram it was; 0: of nobody who is in
    bool isNew = false;                         // let in with this datagram
    bool isOffence = false;                     // the visitor sent what no honest client sends; it was dropped
    std::span<const std::uint8_t> plain = {};   // for ENet; empty: nothing
    std::span<const std::vector<std::uint8_t>> told = {};  // to a stranger who asks, to be sent back each
  };
  [[nodiscard]] Result TakeDatagram(const NetAddress& from, std::span<const std::uint8_t> datagram, double now);

  // What is needed to send to a visitor.
  struct Leg {
    NetAddress address;
    std::uint32_t session = 0;
    Key toClient{};
    Admission admission = {};
  };
  [[nodiscard]] Leg FindLeg(VisitorId visitor) const;

  // The visitor is being sent away: it counts no longer for maxVisitors and maxPerAddress.
  void Release(VisitorId visitor);
  void Remove(VisitorId visitor);
  // Removes visitors who have not begun ENet's handshake in time or have been silent for long, and lists them.
  void RemoveOverdue(double now, std::vector<VisitorId>& removed);

  [[nodiscard]] const DoorCounts& Counts() const { return m_counts; }
  [[nodiscard]] std::size_t CountVisitors() const { return m_slotOf.size(); }
  [[nodiscard]] const Key& ServerKey() const { return m_settings.identity.publicKey; }

 private:
  struct Visitor {
    VisitorId id = 0;
    std::uint32_t session = 0;
    NetAddress address;
    Key client{};
    Key toClient{};
    Opener opener;
    Sealer control;
    CommandFilter filter;
    TokenBucket rate;
    double letInAt = 0;
    double lastHeard = 0;
    Judgement judgement;
    bool isReleased = false;
    bool isPutOut = false;  // nothing more of it passes
  };
  // A client that was answered not long ago: its response comes again while the answer is under way, and a recorded one
  // must not open a session with the same keys.
  struct Answered {
    std::vector<std::uint8_t> answer;  // of one who was refused
    VisitorId visitor = 0;             // of one who was let in; it may be gone
    double at = 0;
  };

  Result TakeRequest(const NetAddress& from, std::span<const std::uint8_t> datagram, double now);
  Result TakeResponse(const NetAddress& from, std::span<const std::uint8_t> datagram, double now);
  Result TakeQuery(const NetAddress& from, std::span<const std::uint8_t> datagram, double now);
  Result TakeData(const NetAddress& from, std::span<const std::uint8_t> datagram, double now);
  Result AnswerAgain(const Answered& answered, const Response& response, double now);
  Result LetIn(const NetAddress& from, const Response& response, const SessionKeys& keys, Opener opener,
               Judgement judgement, double now);
  Result Refuse(const Response& response, const SessionKeys& keys, Refusal refusal, double now);
  Result Pass(Visitor& visitor, std::span<const std::uint8_t> sealed, double now);
  // Whether a subnet may have one more answer that it has not earned.
  [[nodiscard]] bool MayAsk(const Subnet& subnet, double now);
  Result SendReset(const NetAddress& from, std::uint32_t session, double now);
  void Accept(Visitor& visitor);  // writes the answer into m_answer

  [[nodiscard]] Cookie MakeCookie(const NetAddress& from, const Key& client, std::uint64_t epoch) const;
  [[nodiscard]] ResetToken MakeResetToken(const NetAddress& from, std::uint32_t session) const;
  // Of the credential in m_plain. Counts who is refused.
  [[nodiscard]] Judgement JudgeClient(const NetAddress& from, double now);
  // now: s. The guesses of a subnet are bounded.
  [[nodiscard]] Judgement JudgeCredential(const Credential& credential, const NetAddress& source, double now);
  Judgement TurnAway(Turnaway why, const NetAddress& source);
  [[nodiscard]] std::size_t CountVisitorsOf(const NetAddress& source) const;
  [[nodiscard]] std::size_t FindFreeSlot() const;
  [[nodiscard]] Visitor* Find(VisitorId visitor);
  void ForgetAnswered(double now);

  Settings m_settings;
  KeyPair m_started;
  Key m_cookieKey{};
  Key m_resetKey{};
  RateTable m_requestRates;
  TokenBucket m_requests;
  RateTable m_scarceRates;
  RateTable m_handshakeRates;
  RateTable m_guessRates;
  TokenBucket m_handshakes;
  QueryDesk m_queries;
  std::vector<std::unique_ptr<Visitor>> m_slots;  // the low bits of a session's number name its slot
  std::unordered_map<VisitorId, std::size_t> m_slotOf;
  std::map<Key, Answered> m_answered;  // by the client's key
  VisitorId m_newest = 0;
  std::size_t m_counted = 0;  // visitors that are not released
  std::vector<std::uint8_t> m_answer;
  std::vector<std::uint8_t> m_plain;
  DoorCounts m_counts;
};

}  // namespace wobble::transport::vestibule
