#include "server/play/sumo.h"

#include <algorithm>
#include <utility>

namespace wobble::server {
namespace {

constexpr double kBlame = 6;         // how long after a touch a fall scores for the toucher, s
constexpr double kIntermission = 8;  // from one round to the next, s

}  // namespace

void Sumo::Enter(ClientId client) {
  m_wrestlers[client].standing.client = client;
  ++m_revision;
}

void Sumo::Leave(ClientId client) {
  m_wrestlers.erase(client);
  ++m_revision;
}

void Sumo::NoteTouch(ClientId a, ClientId b) {
  const auto note = [&](ClientId touched, ClientId by) {
    const auto found = m_wrestlers.find(touched);
    if (found == m_wrestlers.end() || !m_wrestlers.contains(by)) return;
    found->second.touchedBy = by;
    found->second.touchedAt = m_now;
  };
  note(a, b);
  note(b, a);
}

ClientId Sumo::NoteFall(ClientId fallen) {
  const auto found = m_wrestlers.find(fallen);
  if (found == m_wrestlers.end() || m_phase != Phase::kPlaying) return 0;
  const ClientId by = std::exchange(found->second.touchedBy, 0);
  const auto scorer = m_wrestlers.find(by);
  if (scorer == m_wrestlers.end() || m_now - found->second.touchedAt > kBlame) return 0;
  ++m_revision;
  if (++scorer->second.standing.points >= m_rules.pointsToWin) EndRound();
  return by;
}

void Sumo::Advance(double seconds) {
  m_now += seconds;
  // A single player may practise without limit.
  if (m_phase == Phase::kPlaying && m_wrestlers.size() < 2) {
    m_secondsLeft = m_rules.roundSeconds;
    return;
  }
  m_secondsLeft -= seconds;
  if (m_secondsLeft > 0) return;
  if (m_phase == Phase::kPlaying) {
    EndRound();
  } else {
    BeginRound();
  }
}

void Sumo::EndRound() {
  const std::vector<Standing> standings = Standings();
  const bool isDraw = standings.empty() || standings[0].points == 0 ||
                      (standings.size() > 1 && standings[1].points == standings[0].points);
  m_winner = isDraw ? 0 : standings[0].client;
  if (!isDraw) ++m_wrestlers[m_winner].standing.rounds;
  m_phase = Phase::kWon;
  m_secondsLeft = kIntermission;
  ++m_revision;
}

void Sumo::BeginRound() {
  for (auto& [client, wrestler] : m_wrestlers) {
    wrestler.standing.points = 0;
    wrestler.touchedBy = 0;
  }
  m_phase = Phase::kPlaying;
  m_secondsLeft = m_rules.roundSeconds;
  ++m_round;
  ++m_revision;
}

std::vector<Sumo::Standing> Sumo::Standings() const {
  std::vector<Standing> standings;
  for (const auto& [client, wrestler] : m_wrestlers) standings.push_back(wrestler.standing);
  std::stable_sort(standings.begin(), standings.end(), [](const Standing& a, const Standing& b) {
    return a.points != b.points ? a.points > b.points : a.rounds > b.rounds;
  });
  return standings;
}

}  // namespace wobble::server
