#include "protocol/transport/vestibule/query_desk.h"

#include <array>

namespace wobble::transport::vestibule {
namespace {

// A challenge holds for its epoch and the next one, as a cookie does.
constexpr double kChallengeSeconds = 10;

QueryAnswer FindAnswer(protocol::QueryKind kind) {
  switch (kind) {
    case protocol::QueryKind::kInfo:
      return QueryAnswer::kInfo;
    case protocol::QueryKind::kPlayers:
      return QueryAnswer::kPlayers;
    case protocol::QueryKind::kRules:
      return QueryAnswer::kRules;
  }
  return QueryAnswer::kInfo;
}

}  // namespace

QueryDesk::QueryDesk(std::shared_ptr<PictureSlot> slot, const RandomSource& random) : m_slot(std::move(slot)) {
  random(m_key);
}

std::span<const std::vector<std::uint8_t>> QueryDesk::Answer(const NetAddress& from, const protocol::Query& query,
                                                             double now) {
  if (auto fresh = m_slot->Take()) m_picture = std::move(fresh);
  if (m_picture == nullptr) return {};
  const auto present = static_cast<std::uint64_t>(now / kChallengeSeconds);
  const bool isProved = query.challenge && (*query.challenge == MakeChallenge(from, present) ||
                                            (present > 0 && *query.challenge == MakeChallenge(from, present - 1)));
  QueryAnswer answer = QueryAnswer::kChallenge;
  if (isProved) {
    answer = FindAnswer(query.kind);
    m_answer = protocol::MakeAnswer(query.kind, *m_picture, ++m_number);
  } else {
    m_answer.resize(1);
    protocol::WriteChallenge(MakeChallenge(from, present), m_answer.front());
  }
  ++m_counts[static_cast<std::size_t>(answer)];
  return m_answer;
}

std::uint32_t QueryDesk::MakeChallenge(const NetAddress& from, std::uint64_t epoch) const {
  std::array<std::uint8_t, 26> message{};
  std::copy(from.ip.begin(), from.ip.end(), message.begin());
  for (std::size_t i = 0; i < 2; ++i) message[16 + i] = static_cast<std::uint8_t>(from.port >> 8 * i);
  for (std::size_t i = 0; i < 8; ++i) message[18 + i] = static_cast<std::uint8_t>(epoch >> 8 * i);
  std::array<std::uint8_t, 16> hash;
  ComputeHash(hash, m_key, message);
  std::uint32_t challenge = 0;
  for (std::size_t i = 0; i < 4; ++i) challenge |= std::uint32_t{hash[i]} << 8 * i;
  return challenge;
}

}  // namespace wobble::transport::vestibule
