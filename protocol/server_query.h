// Valve's server query ("A2S"; Valve's developer wiki, "Server queries"), by which browsers of servers and `wobble
// list` learn what is played where. Bytes in, bytes out; whom a server answers, and how often, is the vestibule's
// affair.
//
//   request   FFFFFFFF  'T' "Source Engine Query\0" [challenge]   what is played
//             FFFFFFFF  'U' challenge                             who plays
//             FFFFFFFF  'V' challenge                             the rules, names and values
//   answer    FFFFFFFF  'A' challenge                             to a request without the right one
//             FFFFFFFF  'I', 'D' or 'E' ...                       to one with it
//
// Numbers are little-endian, texts end with a zero byte. An answer of more than kMaxQueryBytes comes in parts, each
// with a head of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace wobble::protocol {

inline constexpr std::size_t kMaxQueryBytes = 1400;     // of a datagram
inline constexpr std::size_t kMaxServerNameBytes = 63;  // as DNS has for a service's name
// The query counts players in a byte.
inline constexpr std::size_t kMaxCountedPlayers = 255;

enum class QueryKind : std::uint8_t { kInfo = 'T', kPlayers = 'U', kRules = 'V' };

struct Query {
  QueryKind kind = QueryKind::kInfo;
  std::optional<std::uint32_t> challenge = {};  // nullopt: none is shown, which only kInfo may
};

// What a server tells of itself. Texts have no zero bytes.
struct ServerPicture {
  std::string name = {};
  std::string scene = {};
  std::string version = {};
  std::uint16_t port = 0;
  std::size_t players = 0;  // who are in, watchers too; told up to kMaxCountedPlayers, as the next
  std::size_t maxPlayers = 0;
  bool isPrivate = false;  // something is asked for at the door, or it is locked

  struct Player {
    std::string name = {};
    std::uint32_t score = 0;  // points of this round, where a game is played
    double seconds = 0;       // since they came
  };
  std::vector<Player> named = {};  // of the players, those whose names are told
  std::vector<std::pair<std::string, std::string>> rules = {};
};

// nullopt: it is no query, or a shorter one than the challenge that answers it.
[[nodiscard]] std::optional<Query> ReadQuery(std::span<const std::uint8_t> datagram);
[[nodiscard]] std::vector<std::uint8_t> MakeQuery(const Query& query);

// Never longer than a query.
void WriteChallenge(std::uint32_t challenge, std::vector<std::uint8_t>& datagram);
// nullopt: it is no challenge.
[[nodiscard]] std::optional<std::uint32_t> ReadChallenge(std::span<const std::uint8_t> datagram);

// The datagrams that answer a query. number: of this answer, by which its parts are known to belong together.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> MakeAnswer(QueryKind kind, const ServerPicture& picture,
                                                                std::uint32_t number);

// What kInfo tells: all but `named` and `rules`. nullopt: it is not such an answer, whole. Its texts are as they came.
[[nodiscard]] std::optional<ServerPicture> ReadInfo(std::span<const std::uint8_t> datagram);

}  // namespace wobble::protocol
