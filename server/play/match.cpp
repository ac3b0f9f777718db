// Points and rounds of a side stand beside those of its players: a goal counts for both. Sides are evened out where all
// are put back to their places, so that nobody changes sides in the middle of play.
#include "server/play/match.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>
#include <utility>

namespace wobble::server {
namespace {

constexpr double kIntermission = 8;  // from one round or match to the next, s
constexpr double kKickOffTime = 3;   // s
constexpr double kGoldenTime = 60;   // the longest that the next point is waited for, s

// Sumo begins at once, as one falls into it; the others line up.
double FindKickOffTime(const scenes::GameRules& rules) {
  return rules.kind == scenes::GameRules::Kind::kSumo ? 0 : kKickOffTime;
}

}  // namespace

Match::Match(const scenes::GameRules& rules) : m_rules(rules) {
  m_memory.rounds = rules.rounds;
  m_memory.playLeft = rules.roundSeconds;
  m_memory.phase = rules.lobbySeconds > 0 ? Phase::kLobby : Phase::kPlaying;
  m_memory.secondsLeft = rules.lobbySeconds > 0 ? rules.lobbySeconds : rules.roundSeconds;
}

bool Match::Write(const Memory& memory) {
  const auto isGood = [this](const auto& entry) {
    const auto& [client, standing] = entry;
    return client != 0 && standing.client == client && standing.points >= 0 && standing.rounds >= 0 &&
           (m_rules.HasSides() ? standing.side == 1 || standing.side == 2 : standing.side == 0);
  };
  const bool isPossible = memory.round >= 1 && memory.rounds >= 0 && memory.matches >= 0 && memory.winningSide >= 0 &&
                          memory.winningSide <= 2 && memory.sides[0].points >= 0 && memory.sides[1].points >= 0;
  if (!isPossible || !std::ranges::all_of(memory.players, isGood)) return false;
  m_memory = memory;
  return true;
}

int Match::CountOn(int side) const {
  return static_cast<int>(
      std::ranges::count_if(m_memory.players, [&](const auto& entry) { return entry.second.side == side; }));
}

void Match::Enter(ClientId client, bool isBot) {
  const auto isPerson = [](const auto& entry) { return !entry.second.isBot; };
  const bool beginsAnew = !isBot && !m_memory.players.empty() && std::ranges::none_of(m_memory.players, isPerson);
  Standing& standing = m_memory.players[client];
  standing = {.client = client, .isReady = isBot, .isBot = isBot};
  if (m_rules.HasSides()) standing.side = CountOn(2) < CountOn(1) ? 2 : 1;
  ++m_memory.revision;
  if (beginsAnew) BeginAnew();
}

void Match::Leave(ClientId client) {
  m_memory.players.erase(client);
  ++m_memory.revision;
}

bool Match::SetReady(ClientId client, bool isReady) {
  const auto found = m_memory.players.find(client);
  if (found == m_memory.players.end()) return false;
  found->second.isReady = isReady;
  ++m_memory.revision;
  return true;
}

const Match::Standing* Match::Find(ClientId client) const {
  const auto found = m_memory.players.find(client);
  return found == m_memory.players.end() ? nullptr : &found->second;
}

bool Match::IsEnough() const {
  return m_rules.HasSides() ? CountOn(1) > 0 && CountOn(2) > 0 : m_memory.players.size() >= 2;
}

bool Match::AreAllReady() const {
  return std::ranges::all_of(m_memory.players, [](const auto& entry) { return entry.second.isReady; });
}

// The last to come change sides, bots before people.
void Match::Balance() {
  if (!m_rules.HasSides()) return;
  for (int more = CountOn(1) - CountOn(2); std::abs(more) >= 2; more = CountOn(1) - CountOn(2)) {
    const int larger = more > 0 ? 1 : 2;
    Standing* last = nullptr;
    for (auto& [client, standing] : m_memory.players) {
      if (standing.side == larger && (last == nullptr || standing.isBot >= last->isBot)) last = &standing;
    }
    last->side = 3 - larger;
    ++m_memory.revision;
  }
}

void Match::GoTo(Phase phase, double seconds) {
  m_memory.phase = phase;
  m_memory.secondsLeft = seconds;
  ++m_memory.revision;
}

void Match::BeginAnew() {
  for (auto& [client, standing] : m_memory.players) {
    standing.points = standing.rounds = 0;
    standing.isReady = standing.isBot;
  }
  m_memory.sides = {};
  m_memory.round = 1;
  m_memory.playLeft = m_rules.roundSeconds;
  if (m_rules.lobbySeconds > 0) return GoTo(Phase::kLobby, m_rules.lobbySeconds);
  BeginRound();
}

void Match::BeginRound() {
  for (auto& [client, standing] : m_memory.players) standing.points = 0;
  for (Side& side : m_memory.sides) side.points = 0;
  m_memory.playLeft = m_rules.roundSeconds;
  KickOff();
}

void Match::KickOff() {
  Balance();
  m_memory.places = true;
  const double seconds = FindKickOffTime(m_rules);
  if (seconds > 0) return GoTo(Phase::kKickOff, seconds);
  GoTo(Phase::kPlaying, m_memory.playLeft);
}

// A single player may practise without limit.
void Match::Wait() {
  if (m_rules.HasSides() && m_memory.players.size() >= 2) {  // all on one side
    Balance();
    if (m_memory.phase == Phase::kPlaying || m_memory.phase == Phase::kGolden) KickOff();
    return;
  }
  if (m_memory.phase == Phase::kWon || m_memory.phase == Phase::kOver) return;
  if (m_rules.lobbySeconds > 0 && m_memory.phase != Phase::kLobby) return BeginAnew();
  if (m_memory.phase == Phase::kLobby) {
    m_memory.secondsLeft = m_rules.lobbySeconds;
    return;
  }
  m_memory.playLeft = m_memory.secondsLeft = m_rules.roundSeconds;
  if (m_memory.phase != Phase::kPlaying) GoTo(Phase::kPlaying, m_memory.playLeft);
}

void Match::Advance(double seconds) {
  m_memory.now += seconds;
  const bool isEnough = IsEnough();
  if (!isEnough) Wait();
  const bool isAwaited = m_memory.phase == Phase::kWon || m_memory.phase == Phase::kOver;
  if (!isEnough && !isAwaited) return;
  m_memory.secondsLeft -= seconds;
  if (m_memory.phase == Phase::kPlaying) m_memory.playLeft = m_memory.secondsLeft;
  if (m_memory.phase == Phase::kLobby && AreAllReady()) m_memory.secondsLeft = 0;
  if (m_memory.secondsLeft > 0) return;
  switch (m_memory.phase) {
    case Phase::kLobby:
      return BeginRound();
    case Phase::kKickOff:
      return m_memory.playLeft > 0 ? GoTo(Phase::kPlaying, m_memory.playLeft) : GoTo(Phase::kGolden, kGoldenTime);
    case Phase::kPlaying:
      return EndTime();
    case Phase::kGolden:
      return EndRound();
    case Phase::kWon:
      ++m_memory.round;
      return BeginRound();
    case Phase::kOver:
      ++m_memory.matches;
      return BeginAnew();
  }
}

bool Match::IsDraw() const {
  if (m_rules.HasSides()) return m_memory.sides[0].points == m_memory.sides[1].points;
  const std::vector<Standing> standings = Standings();
  return standings.empty() || standings[0].points == 0 ||
         (standings.size() > 1 && standings[1].points == standings[0].points);
}

void Match::EndTime() {
  const bool hasGolden = m_rules.kind != scenes::GameRules::Kind::kSumo;
  if (!hasGolden || !IsDraw()) return EndRound();
  m_memory.playLeft = 0;
  if (m_rules.HasSides()) return KickOff();
  GoTo(Phase::kGolden, kGoldenTime);
}

void Match::Score(ClientId client, int side) {
  if (!IsCounting()) return;
  ++m_memory.revision;
  int points = 0;
  const auto scorer = m_memory.players.find(client);
  if (scorer != m_memory.players.end()) points = ++scorer->second.points;
  if (side != 0) points = ++m_memory.sides[static_cast<std::size_t>(side - 1)].points;
  if (m_memory.phase == Phase::kGolden || points >= m_rules.pointsToWin) return EndRound();
  if (side != 0) KickOff();
}

// Who has most points, in a match most rounds; more than one who has: nobody.
void Match::NameWinner(bool isOfMatch) {
  const auto countOf = [&](const auto& each) { return isOfMatch ? each.rounds : each.points; };
  m_memory.winner = 0;
  m_memory.winningSide = 0;
  int most = 0;
  const auto take = [&](int count, ClientId client, int side) {
    if (count < most || count == 0) return;
    m_memory.winner = count > most ? client : 0;
    m_memory.winningSide = count > most ? side : 0;
    most = count;
  };
  if (m_rules.HasSides()) {
    for (const int side : {1, 2}) take(countOf(m_memory.sides[static_cast<std::size_t>(side - 1)]), 0, side);
  } else {
    for (const auto& [client, standing] : m_memory.players) take(countOf(standing), client, 0);
  }
}

void Match::EndRound() {
  NameWinner(false);
  if (m_memory.winner != 0) ++m_memory.players[m_memory.winner].rounds;
  if (m_memory.winningSide != 0) ++m_memory.sides[static_cast<std::size_t>(m_memory.winningSide - 1)].rounds;
  const bool isLast = m_memory.rounds > 0 && m_memory.round >= m_memory.rounds;
  if (isLast) NameWinner(true);
  GoTo(isLast ? Phase::kOver : Phase::kWon, kIntermission);
}

bool Match::TakePlacing() { return std::exchange(m_memory.places, false); }

std::vector<Match::Standing> Match::Standings() const {
  std::vector<Standing> standings;
  for (const auto& [client, standing] : m_memory.players) standings.push_back(standing);
  std::ranges::stable_sort(standings, [](const Standing& a, const Standing& b) {
    return std::tie(a.points, a.rounds) > std::tie(b.points, b.rounds);
  });
  return standings;
}

}  // namespace wobble::server
