// A player who stays: a client that joins again by itself when it was cut off, because the server was restarted or
// closes, or because the link was dead for too long.
//
// Each try is a connection and a Client of its own. Like Client it reads no clock, starts no thread, and is for one
// thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "client/client.h"
#include "client/rejoin.h"

namespace wobble::client {

struct LastingOptions {
  Options client;  // of every connection: the same name, the same role
  RejoinOptions rejoin = {};
  // Begins a connection to the same server, as for Client; null with one line in `error` counts as a try that failed.
  // Called inside Update. EnetTransport::Connect resolves the server's name in it, which may block. Who came with a
  // connect token shows EnetTransport::ReadTicket from now on.
  std::function<std::unique_ptr<transport::Transport>(std::string& error)> connect;
  // Called with each new client before its first Update, for handlers such as OnEvent. May be empty.
  std::function<void(Client& client)> prepare = {};
};

enum class LastingState {
  kJoining,    // for the first time; if that fails, it ends
  kPlaying,    // as Client's, or between two scenes of the server (Client::OnNextScene)
  kRejoining,  // cut off, see Reason; waits for the next try or tries
  kEnded,      // see Reason
};

class LastingClient {
 public:
  // transport: of the first connection, already connecting. now: seconds, as for Client.
  LastingClient(std::unique_ptr<transport::Transport> transport, LastingOptions options, double now);
  LastingClient(const LastingClient&) = delete;
  LastingClient& operator=(const LastingClient&) = delete;

  // Call it once a frame, as Client::Update, which it calls.
  void Update(double now);
  // As Client::Leave; ends at once while it is joining again and no connection is there.
  void Leave(double now);

  // As Client::Rename, and for returns.
  void Rename(const std::string& name);

  [[nodiscard]] LastingState ReadState() const { return m_state; }
  // The client that plays. While kRejoining and kEnded the one that played last: its bodies stand still, and commands
  // to it are not sent. Another object after each return, so do not keep the reference beyond the next Update.
  [[nodiscard]] Client& Current() { return *m_client; }
  [[nodiscard]] const Client& Current() const { return *m_client; }
  // One line for people. While kRejoining why the connection was lost, in kEnded why it ended; else empty.
  [[nodiscard]] const std::string& Reason() const { return m_reason; }
  // True when it has ended without Leave.
  [[nodiscard]] bool EndedUnasked() const { return m_state == LastingState::kEnded && !m_isLeaving; }
  // How often it has come back.
  [[nodiscard]] std::uint64_t CountRejoins() const { return m_rejoins; }

 private:
  [[nodiscard]] std::unique_ptr<Client> MakeClient(std::unique_ptr<transport::Transport> transport, double now);
  void UpdateFirst(double now);
  void UpdatePlaying(double now);
  void UpdateRejoining(double now);
  void NoteTryFailed(double now, bool mayRejoin, const std::string& reason);
  void End(std::string reason);
  void Remember(std::uint64_t hash, std::span<const std::uint8_t> bytes);

  LastingOptions m_options;
  RejoinPlan m_plan;
  LastingState m_state = LastingState::kJoining;
  std::unique_ptr<Client> m_client;
  std::unique_ptr<Client> m_next;  // of the try that is under way
  bool m_isLeaving = false;
  std::string m_reason;
  std::string m_failure;  // of the last try
  std::uint64_t m_rejoins = 0;
  std::shared_ptr<KeptBlueprints> m_kept;  // what a return need not download, the newest first
};

}  // namespace wobble::client
