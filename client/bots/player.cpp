// Each connection has a client of its own. When it ends the client is destroyed with its socket and buffers, and only
// sums remain; otherwise a storm of joins would run out of sockets.
//
// client/lasting_client.h would keep the world of before to be shown, and every bot's blueprints in memory: nobody
// looks, and hundreds of bots would keep the same ones.
#include "client/bots/player.h"

#include <cassert>
#include <utility>

namespace wobble::bots {

Player::Player(client::Options options, const client::RejoinOptions& rejoin, OnSnapshot onSnapshot)
    : m_options(std::move(options)), m_onSnapshot(std::move(onSnapshot)), m_rejoin(rejoin), m_plan(rejoin) {}

void Player::Join(std::unique_ptr<transport::Transport> transport, double now) {
  assert(m_state == State::kAway);
  m_plan = client::RejoinPlan(m_rejoin);
  Connect(std::move(transport), now);
  m_state = State::kJoining;
}

bool Player::TakeRejoinDue(double now) {
  assert(m_state == State::kRejoining);
  if (m_plan.TakeDue(now)) return true;
  if (m_plan.ReadState() == client::RejoinPlan::State::kOver) {
    CloseConnection();
    Lose(client::DescribeGivingUp(m_lossReason, "", m_rejoin));
  }
  return false;
}

void Player::Rejoin(std::unique_ptr<transport::Transport> transport, double now) {
  assert(m_state == State::kRejoining);
  Connect(std::move(transport), now);
}

void Player::FailToRejoin(const std::string& reason, double now) {
  m_plan.NoteEnd(now, true);
  if (m_plan.ReadState() != client::RejoinPlan::State::kOver) return;
  Lose(client::DescribeGivingUp(m_lossReason, reason, m_rejoin));
}

void Player::Connect(std::unique_ptr<transport::Transport> transport, double now) {
  assert(m_client == nullptr);
  m_names.clear();
  m_bodies.clear();
  m_events.clear();
  m_transport = transport.get();
  m_client = std::make_unique<client::Client>(std::move(transport), m_options, now);
  m_client->OnSnapshot(m_onSnapshot);
  m_client->OnEvent([this](const client::Client::Event& event) { HearEvent(event); });
  m_client->OnNextScene([this](const std::string&) {
    m_names.clear();
    m_bodies.clear();
  });
}

void Player::Lose(std::string reason) {
  m_state = State::kLost;
  m_lossReason = std::move(reason);
}

void Player::Leave(double now) {
  if (m_state == State::kRejoining && m_client == nullptr) m_state = State::kAway;
  if (m_state != State::kJoining && m_state != State::kPlaying && m_state != State::kRejoining) return;
  StopMeasuring(now);
  m_client->Leave(now);
  m_state = State::kLeaving;
}

void Player::Update(double now) {
  if (m_client == nullptr) return;
  m_updated = now;
  m_client->Update(now);
  if (m_client->ReadState() == client::State::kEnded) {
    StopMeasuring(now);
    NoteEnd(now);
    CloseConnection();
  } else if (m_client->ReadState() == client::State::kPlaying &&
             (m_state == State::kJoining || m_state == State::kRejoining)) {
    NotePlaying(now);
  }
}

void Player::NoteEnd(double now) {
  if (!m_client->EndedUnasked()) {
    m_state = State::kAway;
    return;
  }
  m_wasSentAway = m_client->WasSentAway();
  const bool answered = m_transport->ReadStatistics().bytesIn > 0;
  const std::string reason = answered ? m_client->EndReason() : "";
  m_plan.NoteEnd(now, m_client->MayRejoin());
  if (m_plan.ReadState() == client::RejoinPlan::State::kOver) {
    const bool hasGivenUp = m_state == State::kRejoining && m_client->MayRejoin();
    return Lose(hasGivenUp ? client::DescribeGivingUp(m_lossReason, reason, m_rejoin) : reason);
  }
  if (m_state == State::kPlaying) {
    ++m_totals.cuts;
    m_cutAt = now;
    m_lossReason = reason;
  }
  m_state = State::kRejoining;
}

void Player::NotePlaying(double now) {
  ++m_totals.joins;
  m_totals.rejoins += m_state == State::kRejoining ? 1 : 0;
  m_state = State::kPlaying;
  m_plan.NotePlaying(now);
  m_ticket = m_transport->ReadTicket();
  m_measured = true;
  m_playedFrom = now;
  m_bytesFrom = m_transport->ReadStatistics().bytesIn;
}

void Player::StopMeasuring(double now) {
  if (!m_measured) return;
  m_measured = false;
  AddPresentStay(now, m_totals);
}

void Player::AddPresentStay(double now, Totals& totals) const {
  totals.playedSeconds += now - m_playedFrom;
  totals.playedBytes += m_transport->ReadStatistics().bytesIn - m_bytesFrom;
}

void Player::CloseConnection() {
  if (m_client == nullptr) return;
  m_totals = ReadTotals();
  m_client.reset();
  m_transport = nullptr;
}

Player::Totals Player::ReadTotals() const {
  Totals totals = m_totals;
  if (m_client == nullptr) return totals;
  totals.snapshots += m_client->ReadStatistics().snapshots;
  totals.stalls += m_client->ReadStatistics().stalls;
  if (m_measured) AddPresentStay(m_updated, totals);
  return totals;
}

void Player::HearEvent(const client::Client::Event& event) {
  if (event.kind == wire::EventKind::Join && event.body != 0 && m_names.size() < protocol::kMaxBodies) {
    m_names[event.body] = event.name;
    m_bodies[event.clientId] = event.body;
  } else if (event.kind == wire::EventKind::Rename && m_names.contains(event.body)) {
    m_names[event.body] = event.name;
  } else if (event.kind == wire::EventKind::Leave || event.kind == wire::EventKind::BodyRemoved) {
    m_names.erase(event.body);
    if (event.kind == wire::EventKind::Leave) m_bodies.erase(event.clientId);
  }
  m_events.push_back(event);
  if (m_events.size() > kMaxEvents) m_events.pop_front();
}

}  // namespace wobble::bots
