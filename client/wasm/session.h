// One connection of the page: the client library over a WebSocket, and the structs that the script reads.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/wasm/decoded_hash.h"
#include "client/wasm/layout.h"
#include "client/wasm/shown_bodies.h"
#include "client/wasm/web_socket_transport.h"

namespace wobble::wasm {

// Blueprints of earlier connections to this world, as TakeDownload gave them. Their hashes are computed anew, so that
// damaged ones are only useless.
using KeptBytes = std::vector<std::vector<std::uint8_t>>;

class Session {
 public:
  // name: cut to protocol::kMaxNameBytes. now: seconds, never backwards, as in all functions.
  Session(std::string name, bool isSpectator, KeptBytes kept, double now);

  // The buffer of at least so many bytes in which the script writes messages, texts and structs before it calls the
  // function that uses them.
  [[nodiscard]] std::uint8_t* PrepareInput(std::size_t size);
  [[nodiscard]] std::span<const std::uint8_t> Input(std::size_t size) const;
  [[nodiscard]] std::string Line(std::size_t size) const {
    const auto bytes = Input(size);
    return {bytes.begin(), bytes.end()};
  }

  [[nodiscard]] client::Client& Client() { return m_client; }
  [[nodiscard]] WebSocketTransport& Transport() { return *m_transport; }
  [[nodiscard]] ShownBodies& Bodies() { return m_bodies; }

  void Sample(double now);

  // Each result is valid until the next call of the same function.
  const WelcomeView& MakeWelcome();
  const StatisticsView& MakeStatistics(double now);
  // How often another scene has begun on this connection; all that was read before is then of no use.
  [[nodiscard]] unsigned CountNextScenes() const { return m_nextScenes; }
  // The oldest event not yet taken; nullptr when there is none.
  const EventView* TakeEvent();
  // The same for notices.
  const Text* TakeNotice();
  // Likewise for blueprints that are worth keeping. At most protocol::kMaxKeptBytes wait; more are dropped.
  const DownloadView* TakeDownload();
  const TuningView& MakeTuning();
  const ScoreboardView& MakeScoreboard();
  const ForcesView& MakeForces();

  // Sends a command to build; the server refuses unknown kinds.
  void Build(const BuildRequest& request);
  // Over everything decoded so far.
  [[nodiscard]] std::uint64_t DecodedHash() const { return m_decoded.Value(); }
  void RestartDecodedHash() { m_decoded = {}; }

 private:
  void NoteDownload(std::uint64_t hash, std::span<const std::uint8_t> bytes);

  WebSocketTransport* m_transport;  // owned by the client
  client::Client m_client;
  std::vector<std::uint8_t> m_input;
  std::vector<client::BodySample> m_samples;
  ShownBodies m_bodies;
  unsigned m_nextScenes = 0;
  std::deque<client::Client::Event> m_events;
  client::Client::Event m_event;  // the one taken last

  WelcomeView m_welcomeView;
  std::vector<GroundView> m_groundViews;
  StatisticsView m_statisticsView;
  EventView m_eventView;
  std::deque<std::string> m_notices;
  std::string m_notice;  // the one taken last
  Text m_noticeView;
  std::deque<client::KeptBlueprint> m_downloads;
  std::size_t m_downloadedBytes = 0;  // of these
  client::KeptBlueprint m_download;   // the one taken last
  DownloadView m_downloadView;
  TuningView m_tuningView;
  ScoreboardView m_scoreboardView;
  std::vector<ForceFieldView> m_fieldViews;
  ForcesView m_forcesView;
  wasm::DecodedHash m_decoded;
};

}  // namespace wobble::wasm
