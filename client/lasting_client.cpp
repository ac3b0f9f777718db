// The old client stays until the new one plays, so that there is a world to show meanwhile. It has ended, so it sends
// nothing. The hello of a return names the blueprints that were downloaded before, and the server sends none of them
// again; an embedder who keeps them in files (files/kept_folder.h) gets them as with Client.
#include "client/lasting_client.h"

#include <cassert>
#include <utility>

#include "protocol/text.h"

namespace wobble::client {

LastingClient::LastingClient(std::unique_ptr<transport::Transport> transport, LastingOptions options, double now)
    : m_options(std::move(options)), m_plan(m_options.rejoin) {
  assert(m_options.connect);
  if (m_options.rejoin.patience > 0) {
    m_kept = std::make_shared<KeptBlueprints>();
    if (m_options.client.kept != nullptr) *m_kept = *m_options.client.kept;
  }
  m_client = MakeClient(std::move(transport), now);
}

std::unique_ptr<Client> LastingClient::MakeClient(std::unique_ptr<transport::Transport> transport, double now) {
  Options options = m_options.client;
  if (m_kept != nullptr) {
    options.kept = std::make_shared<const KeptBlueprints>(*m_kept);
    options.keep = [this](std::uint64_t hash, std::span<const std::uint8_t> bytes) { Remember(hash, bytes); };
  }
  auto client = std::make_unique<Client>(std::move(transport), std::move(options), now);
  if (m_options.prepare) m_options.prepare(*client);
  return client;
}

// Of what is more than a client may name, the newest count.
void LastingClient::Remember(std::uint64_t hash, std::span<const std::uint8_t> bytes) {
  if (m_options.client.keep) m_options.client.keep(hash, bytes);
  std::erase_if(*m_kept, [hash](const KeptBlueprint& each) { return each.hash == hash; });
  m_kept->insert(m_kept->begin(), {hash, {bytes.begin(), bytes.end()}});
  std::size_t sum = 0, count = 0;
  for (; count < m_kept->size() && count < protocol::kMaxKeptBlueprints; ++count) {
    sum += (*m_kept)[count].bytes.size();
    if (sum > protocol::kMaxKeptBytes) break;
  }
  m_kept->resize(count);
}

void LastingClient::Update(double now) {
  switch (m_state) {
    case LastingState::kJoining:
      return UpdateFirst(now);
    case LastingState::kPlaying:
      return UpdatePlaying(now);
    case LastingState::kRejoining:
      return UpdateRejoining(now);
    case LastingState::kEnded:
      return;
  }
}

void LastingClient::UpdateFirst(double now) {
  m_client->Update(now);
  if (m_client->ReadState() == State::kEnded) return End(m_client->EndReason());
  if (m_client->ReadState() != State::kPlaying) return;
  m_state = LastingState::kPlaying;
  m_plan.NotePlaying(now);
}

void LastingClient::UpdatePlaying(double now) {
  m_client->Update(now);
  if (m_client->ReadState() != State::kEnded) return;
  if (m_isLeaving) return End(m_client->EndReason());
  m_plan.NoteEnd(now, m_client->MayRejoin());
  if (m_plan.ReadState() == RejoinPlan::State::kOver) return End(m_client->EndReason());
  m_reason = m_client->EndReason();
  m_failure.clear();
  m_state = LastingState::kRejoining;
}

void LastingClient::UpdateRejoining(double now) {
  if (m_next != nullptr) {
    m_next->Update(now);
    if (m_next->ReadState() == State::kPlaying && !m_isLeaving) {
      m_client = std::move(m_next);
      m_state = LastingState::kPlaying;
      m_reason.clear();
      ++m_rejoins;
      return m_plan.NotePlaying(now);
    }
    if (m_next->ReadState() == State::kEnded) {
      if (m_isLeaving) return End(m_next->EndReason());
      const bool mayRejoin = m_next->MayRejoin();
      const std::string reason = m_next->EndReason();
      m_next.reset();
      return NoteTryFailed(now, mayRejoin, reason);
    }
  }
  if (m_isLeaving) return;
  if (m_plan.TakeDue(now)) {
    std::string error;
    auto transport = m_options.connect(error);
    if (transport == nullptr) return NoteTryFailed(now, true, error);
    m_next = MakeClient(std::move(transport), now);
    m_next->Update(now);
  } else if (m_plan.ReadState() == RejoinPlan::State::kOver) {
    End(DescribeGivingUp(m_reason, m_failure, m_options.rejoin));
  }
}

void LastingClient::NoteTryFailed(double now, bool mayRejoin, const std::string& reason) {
  m_failure = reason;
  m_plan.NoteEnd(now, mayRejoin);
  if (m_plan.ReadState() != RejoinPlan::State::kOver) return;
  End(mayRejoin ? DescribeGivingUp(m_reason, m_failure, m_options.rejoin) : reason);
}

void LastingClient::Leave(double now) {
  if (m_isLeaving || m_state == LastingState::kEnded) return;
  m_isLeaving = true;
  Client* client = m_state == LastingState::kRejoining ? m_next.get() : m_client.get();
  if (client != nullptr) client->Leave(now);
  if (client == nullptr || client->ReadState() == State::kEnded) End("left");
}

void LastingClient::Rename(const std::string& name) {
  m_options.client.name = protocol::MakeLine(name, protocol::kMaxNameBytes);
  m_client->Rename(m_options.client.name);
}

void LastingClient::End(std::string reason) {
  m_state = LastingState::kEnded;
  m_reason = std::move(reason);
  m_next.reset();
}

}  // namespace wobble::client
