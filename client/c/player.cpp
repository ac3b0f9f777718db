// It adds to LastingClient what a program in C cannot give it: the transport, and queues in place of handlers, because
// a call back into the program could throw, or call the library again, in the middle of an update.
#include "client/c/player.h"

#include <random>
#include <utility>

#include "client/wobble.h"

namespace wobble::c {

namespace vestibule = transport::vestibule;
using protocol::wire::EventKind;

static_assert(WOBBLE_JOIN == static_cast<int>(EventKind::Join) && WOBBLE_LEAVE == static_cast<int>(EventKind::Leave) &&
              WOBBLE_RESPAWN == static_cast<int>(EventKind::Respawn) &&
              WOBBLE_BODY_REMOVED == static_cast<int>(EventKind::BodyRemoved) &&
              WOBBLE_FALL == static_cast<int>(EventKind::Fall) && EventKind::MAX == EventKind::Crown);
static_assert(WOBBLE_CHEER == static_cast<int>(protocol::wire::EmoteKind::MAX));

namespace {

// Kinds that came later than WOBBLE_NOTICE have numbers of their own here.
std::int32_t FindKind(EventKind kind) {
  switch (kind) {
    case EventKind::Said:
      return WOBBLE_SAID;
    case EventKind::Emote:
      return WOBBLE_EMOTED;
    case EventKind::Rename:
      return WOBBLE_RENAMED;
    case EventKind::Goal:
      return WOBBLE_GOAL;
    case EventKind::Crown:
      return WOBBLE_CROWN;
    default:
      return static_cast<std::int32_t>(kind);
  }
}

}  // namespace

std::unique_ptr<Player> Player::Connect(PlayerOptions options, double now) {
  std::unique_ptr<Player> player(new Player(std::move(options)));
  std::string error;
  auto transport = player->Dial(error);
  if (transport == nullptr) return nullptr;

  client::LastingOptions lasting;
  lasting.client = player->m_options.client;
  lasting.rejoin.seed = std::random_device{}();
  if (!player->m_options.rejoins) lasting.rejoin.patience = 0;
  lasting.connect = [self = player.get()](std::string& reason) { return self->Dial(reason); };
  lasting.prepare = [self = player.get()](client::Client& client) { self->Prepare(client); };
  player->m_client = std::make_unique<client::LastingClient>(std::move(transport), std::move(lasting), now);
  return player;
}

std::unique_ptr<transport::Transport> Player::Dial(std::string& error) {
  const auto& [host, port] = m_options.server;
  auto transport = transport::EnetTransport::Connect(host, port, error, m_options.access);
  m_transport = transport.get();
  return transport;
}

void Player::Prepare(client::Client& client) {
  if (m_hasConnected) Add({.kind = WOBBLE_NEW_WORLD});
  m_hasConnected = true;
  client.SetInput(m_input);
  client.OnEvent([this](const client::Client::Event& event) {
    Add({FindKind(event.kind), event.clientId, event.body, event.name, static_cast<std::int32_t>(event.emote)});
  });
  client.OnNotice([this](const std::string& text) { Add({.kind = WOBBLE_NOTICE, .text = text}); });
  client.OnNextScene([this](const std::string& scene) { Add({.kind = WOBBLE_NEW_WORLD, .text = scene}); });
}

void Player::Update(double now) {
  m_client->Update(now);
  if (m_serverKey.empty() && m_client->ReadState() == client::LastingState::kPlaying) NoteFirstPlay();
}

// From now on it has to be this server, also after it was restarted. A ticket stands for a token that is good only
// once.
void Player::NoteFirstPlay() {
  m_options.access.serverKey = m_transport->ReadServerKey();
  m_serverKey = vestibule::FormatKey(*m_options.access.serverKey);
  auto ticket = m_transport->ReadTicket();
  if (!ticket.empty()) m_options.access.credential = {vestibule::Credential::Kind::kToken, std::move(ticket)};
}

void Player::SetInput(const client::Input& input) {
  m_input = input;
  Current().SetInput(input);
}

bool Player::IsPlaying() const {
  return m_client->ReadState() == client::LastingState::kPlaying && Current().ReadState() == client::State::kPlaying;
}

void Player::Add(Event event) {
  if (m_events.size() == kMaxEvents) {
    m_events.pop_front();
    ++m_eventsLost;
  }
  m_events.push_back(std::move(event));
}

const Event* Player::TakeEvent() {
  if (m_events.empty()) return nullptr;
  m_taken = std::move(m_events.front());
  m_events.pop_front();
  return &m_taken;
}

}  // namespace wobble::c
