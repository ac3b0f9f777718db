#include "server/play/sumo.h"

#include <algorithm>
#include <utility>

namespace wobble::server {
namespace {

constexpr double kBlame = 6;         // how long after a touch a fall scores for the toucher, s
constexpr double kIntermission = 8;  // from one round to the next, s

}  // namespace

void Sumo::Enter(ClientId client) {
  m_memory.wrestlers[client].standing.client = client;
  ++m_memory.revision;
}

void Sumo::Leave(ClientId client) {
  m_memory.wrestlers.erase(client);
  ++m_memory.revision;
}

void Sumo::NoteTouch(ClientId a, ClientId b) {
  const auto note = [&](ClientId touched, ClientId by) {
    const auto found = m_memory.wrestlers.find(touched);
    if (found == m_memory.wrestlers.end() || !m_memory.wrestlers.contains(by)) return;
    found->second.touchedBy = by;
    found->second.touchedAt = m_memory.now;
  };
  note(a, b);
  note(b, a);
}

ClientId Sumo::NoteFall(ClientId fallen) {
  const auto found = m_memory.wrestlers.find(fallen);
  if (found == m_memory.wrestlers.end() || m_memory.phase != Phase::kPlaying) return 0;
  const ClientId by = std::exchange(found->second.touchedBy, 0);
  const auto scorer = m_memory.wrestlers.find(by);
  if (scorer == m_memory.wrestlers.end() || m_memory.now - found->second.touchedAt > kBlame) return 0;
  ++m_memory.revision;
  if (++scorer->second.standing.points >= m_rules.pointsToWin) EndRound();
  return by;
}

void Sumo::Advance(double seconds) {
  m_memory.now += seconds;
  // A single player may practise without limit.
  if (m_memory.phase == Phase::kPlaying && m_memory.wrestlers.size() < 2) {
    m_memory.secondsLeft = m_rules.roundSeconds;
    return;
  }
  m_memory.secondsLeft -= seconds;
  if (m_memory.secondsLeft > 0) return;
  if (m_memory.phase == Phase::kPlaying) {
    EndRound();
  } else {
    BeginRound();
  }
}

void Sumo::EndRound() {
  const std::vector<Standing> standings = Standings();
  const bool isDraw = standings.empty() || standings[0].points == 0 ||
                      (standings.size() > 1 && standings[1].points == standings[0].points);
  m_memory.winner = isDraw ? 0 : standings[0].client;
  if (!isDraw) ++m_memory.wrestlers[m_memory.winner].standing.rounds;
  m_memory.phase = Phase::kWon;
  m_memory.secondsLeft = kIntermission;
  ++m_memory.revision;
}

void Sumo::BeginRound() {
  for (auto& [client, wrestler] : m_memory.wrestlers) {
    wrestler.standing.points = 0;
    wrestler.touchedBy = 0;
  }
  m_memory.phase = Phase::kPlaying;
  m_memory.secondsLeft = m_rules.roundSeconds;
  ++m_memory.round;
  ++m_memory.revision;
}

std::vector<Sumo::Standing> Sumo::Standings() const {
  std::vector<Standing> standings;
  for (const auto& [client, wrestler] : m_memory.wrestlers) standings.push_back(wrestler.standing);
  std::stable_sort(standings.begin(), standings.end(), [](const Standing& a, const Standing& b) {
    return a.points != b.points ? a.points > b.points : a.rounds > b.rounds;
  });
  return standings;
}

}  // namespace wobble::server
