// The player behind a wobble_client: one who joins again, with what has happened since the program last asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "client/command/address.h"
#include "client/lasting_client.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::c {

struct PlayerOptions {
  command::Address server;
  transport::ConnectOptions access;
  client::Options client;
  bool rejoins = true;
};

struct Event {
  std::int32_t kind = 0;  // WOBBLE_JOIN ...
  std::uint32_t clientId = 0;
  std::uint32_t body = 0;
  std::string text = {};
  std::int32_t emote = 0;
};
inline constexpr std::size_t kMaxEvents = 1024;  // that wait; the oldest are dropped

class Player {
 public:
  // Null when the server's name has no address. now: seconds, never backwards, as in all functions.
  [[nodiscard]] static std::unique_ptr<Player> Connect(PlayerOptions options, double now);
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  void Update(double now);
  void Leave(double now) { m_client->Leave(now); }
  // Holds over a return.
  void SetInput(const client::Input& input);

  void Rename(const std::string& name) { m_client->Rename(name); }

  [[nodiscard]] bool IsPlaying() const;
  [[nodiscard]] client::LastingClient& Lasting() { return *m_client; }
  [[nodiscard]] const client::LastingClient& Lasting() const { return *m_client; }
  [[nodiscard]] client::Client& Current() { return m_client->Current(); }
  [[nodiscard]] const client::Client& Current() const { return m_client->Current(); }

  // The oldest event; nullptr when there is none. Valid until the next call.
  [[nodiscard]] const Event* TakeEvent();
  [[nodiscard]] std::uint64_t CountLostEvents() const { return m_eventsLost; }
  // 64 hexadecimal digits; empty before it has played.
  [[nodiscard]] const std::string& ServerKey() const { return m_serverKey; }

 private:
  explicit Player(PlayerOptions options) : m_options(std::move(options)) {}
  [[nodiscard]] std::unique_ptr<transport::Transport> Dial(std::string& error);
  void Prepare(client::Client& client);
  void NoteFirstPlay();
  void Add(Event event);

  PlayerOptions m_options;
  client::Input m_input;
  std::deque<Event> m_events;
  Event m_taken;
  std::uint64_t m_eventsLost = 0;
  std::string m_serverKey;
  bool m_hasConnected = false;
  // Of the first connection, owned by m_client; used until that one plays.
  transport::EnetTransport* m_transport = nullptr;
  std::unique_ptr<client::LastingClient> m_client;  // last: its handlers use what is above
};

}  // namespace wobble::c
