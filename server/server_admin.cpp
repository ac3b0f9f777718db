// The part of the server that the administration acts on: clients by number, the lock, and the world as a whole.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "protocol/text.h"
#include "server/server.h"

namespace wobble::server {

using protocol::wire::GoodbyeReason;

namespace {

constexpr const char* kUnmuted = "you may act again";
// Who was muted and may come back; of more the oldest are forgotten.
constexpr std::size_t kMostMutedOnes = 1000;

// Whether both are known, and the same.
template <class MutedOne>
bool IsSame(const MutedOne& one, const transport::Admission& admission) {
  const bool hasAccount = admission.account != 0, hasTicket = admission.identity != decltype(admission.identity){};
  return (hasAccount && one.account == admission.account) || (hasTicket && one.identity == admission.identity);
}

}  // namespace

Session* Server::FindSession(ClientId client) {
  const auto found = std::find_if(m_sessions.begin(), m_sessions.end(), [&](const auto& entry) {
    return entry.second.IsIn() && entry.second.clientId == client;
  });
  return found == m_sessions.end() ? nullptr : &found->second;
}

std::vector<Server::Player> Server::ListPlayers(double now) const {
  std::vector<Player> players;
  const Game* game = m_stage->playground.ReadGame();
  for (const auto& [connection, session] : m_sessions) {
    if (!session.IsIn()) continue;
    const Match::Standing* standing = game == nullptr ? nullptr : game->ReadMatch().Find(session.clientId);
    players.push_back({.client = session.clientId,
                       .name = session.name,
                       .admission = session.admission,
                       .isSpectator = session.spectator,
                       .isMuted = session.isMuted,
                       .mutedFor = session.isMuted ? session.mutedUntil - now : 0,
                       .points = standing == nullptr ? 0 : standing->points,
                       .seconds = now - session.connectedAt,
                       .roundTrip = session.roundTrip,
                       .rate = session.subscription.room.Rate(1000 * m_config.clientKbit)});
  }
  std::sort(players.begin(), players.end(), [](const Player& a, const Player& b) { return a.client < b.client; });
  return players;
}

bool Server::Dismiss(ClientId client, GoodbyeReason reason, const std::string& why) {
  Session* session = FindSession(client);
  if (session == nullptr) return false;
  End(*session, reason, why);
  return true;
}

bool Server::Mute(ClientId client, double until) {
  Session* session = FindSession(client);
  if (session == nullptr) return false;
  session->isMuted = true;
  session->mutedUntil = until;
  Notify(*session, kMuted);
  std::erase_if(m_mutedOnes, [&](const MutedOne& one) { return IsSame(one, session->admission); });
  if (m_mutedOnes.size() == kMostMutedOnes) m_mutedOnes.erase(m_mutedOnes.begin());
  m_mutedOnes.push_back({session->admission.account, session->admission.identity, until});
  return true;
}

bool Server::Unmute(ClientId client) {
  Session* session = FindSession(client);
  if (session == nullptr) return false;
  std::erase_if(m_mutedOnes, [&](const MutedOne& one) { return IsSame(one, session->admission); });
  if (session->isMuted) Notify(*session, kUnmuted);
  session->isMuted = false;
  return true;
}

void Server::RecallMute(Session& session, double now) {
  const auto one = std::ranges::find_if(
      m_mutedOnes, [&](const MutedOne& each) { return IsSame(each, session.admission) && each.until > now; });
  if (one != m_mutedOnes.end()) Mute(session.clientId, one->until);
}

void Server::LiftMutes(double now) {
  for (auto& [connection, session] : m_sessions) {
    if (session.isMuted && session.IsIn() && session.mutedUntil <= now) Unmute(session.clientId);
  }
}

bool Server::SetRank(ClientId client, transport::Rank rank) {
  Session* session = FindSession(client);
  if (session == nullptr) return false;
  session->admission.rank = rank;
  SendTuning();
  return true;
}

bool Server::SetProtected(bool isProtected) {
  if (m_stage->playground.ReadWorkshop() == nullptr) return false;
  m_stage->playground.Take(ProtectEntry{isProtected});
  return true;
}

bool Server::IsProtected() const {
  const Workshop* workshop = m_stage->playground.ReadWorkshop();
  return workshop != nullptr && workshop->IsProtected();
}

void Server::PutBack(const Entry& entry) {
  const bool wasUsual = m_stage->playground.ReadTuning().IsUsual() && m_clock.Rate() == 1;
  m_stage->playground.Take(entry);
  m_clock.SetRate(1);
  if (!wasUsual) SendTuning();
  TellHappenings();
}

void Server::ResetWorld() { PutBack(ResetEntry{}); }

void Server::RestartWorld() {
  PutBack(RestartEntry{});
  // Not left to TellStandings: the new game counts its changes from 0, and may stand where the old one stood.
  if (m_stage->playground.ReadGame() != nullptr) SendStandings();
  spdlog::info("tick {}: the world begins anew", World().Tick());
}

std::vector<ClientId> Server::ListVoters() const {
  std::vector<ClientId> voters;
  for (const auto& [connection, session] : m_sessions) {
    if (session.state == Session::State::kPlaying && session.body != 0 && !session.isMuted) {
      voters.push_back(session.clientId);
    }
  }
  return voters;
}

namespace {

struct Ballot {
  const char* order;   // behind "vote"
  const char* wish;    // behind a name that votes to
  const char* passed;  // what follows
};

Ballot MakeBallot(Server::Question question) {
  if (question == Server::Question::kRestart) return {"restart", "begin anew", "the world begins anew"};
  return {"next", "go to the next scene", "the next scene begins"};
}

}  // namespace

std::string Server::VoteFor(Question question, ClientId client, double now) {
  if (question == Question::kNextScene && m_rotation.empty()) return GoToNextScene();
  const std::vector<ClientId> voters = ListVoters();
  if (std::ranges::find(voters, client) == voters.end()) return "who watches or is muted has no vote";
  // A vote would be the way round it: whoever is alone could clear what all others have built.
  if (IsProtected()) return "what is built here is protected; only moderators let the world begin anew";
  if (m_vote.IsOpen() && question != m_question) {
    return fmt::format("a vote to {} goes on (order: vote {})", MakeBallot(m_question).wish,
                       MakeBallot(m_question).order);
  }
  switch (m_vote.Cast(client, now)) {
    case Vote::Voice::kRepeated:
      return "you have voted already";
    case Vote::Voice::kTooEarly:
      return fmt::format("a vote has just passed; the next may begin in {:.0f} s", std::ceil(m_vote.SecondsLeft(now)));
    case Vote::Voice::kTaken:
      break;
  }
  m_question = question;
  FollowVote(now);
  if (m_vote.IsOpen()) {
    const Ballot ballot = MakeBallot(question);
    Say(fmt::format("{} votes to {}: {} of {}; {} are enough, {:.0f} s are left (order: vote {})",
                    FindSession(client)->name, ballot.wish, m_vote.Voices(), voters.size(), FindMajority(voters.size()),
                    std::ceil(m_vote.SecondsLeft(now)), ballot.order));
  }
  return "";
}

void Server::FollowVote(double now) {
  if (!m_vote.IsOpen()) return;
  const std::vector<ClientId> voters = ListVoters();
  const Vote::Outcome outcome = m_vote.Follow(voters, now);
  if (outcome == Vote::Outcome::kNone) return;
  const bool hasPassed = outcome == Vote::Outcome::kPassed;
  const Ballot ballot = MakeBallot(m_question);
  std::string refusal;
  if (hasPassed && m_question == Question::kRestart) RestartWorld();
  if (hasPassed && m_question == Question::kNextScene) refusal = GoToNextScene();
  const std::string result = hasPassed ? ballot.passed : "too few, it goes on as it is";
  Say(fmt::format("{} of {} have voted to {}: {}", m_vote.Voices(), voters.size(), ballot.wish,
                  refusal.empty() ? result : refusal));
}

void Server::Say(const std::string& text) {
  Broadcast(protocol::MakeNotice(protocol::MakeLine(text, protocol::kMaxNoticeBytes)));
}

bool Server::Tell(ClientId client, const std::string& text) {
  const Session* session = FindSession(client);
  if (session == nullptr) return false;
  Notify(*session, text);
  return true;
}

void Server::TakeOrder(Session& session, const std::string& line) {
  // The order may end this very session.
  const ClientId client = session.clientId;
  const auto answer = m_orderTaker ? m_orderTaker(client, session.admission.rank, line)
                                   : std::vector<std::string>{"this server takes no orders"};
  for (const std::string& each : answer) {
    if (const Session* present = FindSession(client)) Notify(*present, each);
  }
}

}  // namespace wobble::server
