// Source RCON (Valve's developer wiki, "Source RCON Protocol"): orders from the consoles that administrators of game
// servers use. This file has one connection's bytes, and who guesses the password; rcon_listener.h has the sockets.
//
// A packet is its size without these four bytes, an id and a type, each an int32, little-endian, a text with a zero
// byte behind it, and one more zero byte. A client shows the password (kAuth) and then gives orders (kExecute). Three
// things are as clients need them rather than as the wiki has them:
//   - A wrong password is answered by kAuthResponse alone. The empty kValue that comes before it where the password is
//     right would be taken for the answer by clients that read one packet.
//   - An empty kValue of a client is answered by the same alone, not by a second packet behind it. Clients send it
//   after
//     an order: what comes with its id ends an answer in several packets.
//   - Whoever gives an order without the password is sent away.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/transport/net_address.h"
#include "protocol/transport/vestibule/rate_table.h"

namespace wobble::admin {

inline constexpr std::size_t kMinRconBytes = 10;    // of a packet, behind its size
inline constexpr std::size_t kMaxRconBytes = 4096;  // likewise
inline constexpr std::int32_t kRefusedRcon = -1;    // the id of the answer to a wrong password

enum class RconType : std::int32_t { kValue = 0, kExecute = 2, kAuthResponse = 2, kAuth = 3 };

enum class RconGuess : std::uint8_t { kRight, kWrong, kShutOut };

// Judges passwords. A subnet (/24, /64) that was wrong three times is not listened to, and may then be wrong once a
// minute; meanwhile the right one is refused, too.
class RconGuard {
 public:
  // password: not empty. hashKey: a secret of this run.
  RconGuard(std::string password, const transport::vestibule::Key& hashKey);
  // now: s, above 0, never backwards.
  [[nodiscard]] RconGuess Judge(const transport::NetAddress& from, std::string_view password, double now);

 private:
  std::string m_password;
  transport::vestibule::RateTable m_guesses;
};

class RconSession {
 public:
  using Judge = std::function<RconGuess(std::string_view password)>;
  using Obey = std::function<std::vector<std::string>(const std::string& order)>;  // returns lines
  RconSession(Judge judge, Obey obey) : m_judge(std::move(judge)), m_obey(std::move(obey)) {}

  // What has come.
  void Add(std::string_view bytes) { m_received += bytes; }

  // kWaits: there is no whole packet. kAnswered: one was taken, and `answer` is to be sent. kEnds: likewise, and then
  // the connection is to be closed.
  enum class Step : std::uint8_t { kWaits, kAnswered, kEnds };
  // Takes one packet. Replaces `answer`.
  [[nodiscard]] Step TakeNext(std::string& answer);

  [[nodiscard]] bool IsIn() const { return m_isIn; }  // the password was shown
  // Part of a packet has come.
  [[nodiscard]] bool IsInPacket() const { return !m_received.empty(); }

 private:
  Step TakeAuth(std::int32_t id, std::string_view password, std::string& answer);

  Judge m_judge;
  Obey m_obey;
  bool m_isIn = false;
  std::string m_received;
};

}  // namespace wobble::admin
