// Records what a client receives: `record_session SCENE SECONDS trained|untrained FILE` writes every message that one
// client of a server got, in the form that `replay` and session.py read, and prints the number of records that this
// client decoded and their hash. SCENE is a shipped scene, the path of one, or several with commas between, of which
// each begins when its share of the time does; untrained: without any bases. The folder data has what it wrote of 1.2 s
// of arena, 0.8 s of curtain and 1 s of data/patches.toml, all trained.
//
// Server and clients run in one process on virtual time, so a recording takes no port, takes a fraction of its own
// duration and is the same on every machine. The network loses, delays, duplicates and reorders messages, because a
// decoder has to cope with all four. Recording a program over a socket was rejected: it needs a free port and real time
// and gives other bytes at each run.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/wasm/decoded_hash.h"
#include "protocol/transport/virtual_network.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "server/training/basis_shelf.h"
#include "tests/support/places.h"

namespace {

using namespace wobble;

constexpr int kOthers = 2;  // players beside the one whose messages are recorded

// Passes everything on and writes each message that comes in: its length, its channel, its bytes.
class RecordingTransport final : public transport::Transport {
 public:
  RecordingTransport(std::unique_ptr<transport::Transport> inner, std::ostream& out)
      : m_inner(std::move(inner)), m_out(out) {}

  void Poll(double now, const Sink& sink) override {
    m_inner->Poll(now, [&](const transport::Event& event) {
      if (event.kind == transport::Event::Kind::kMessage) Write(event);
      sink(event);
    });
  }
  [[nodiscard]] transport::SendResult Send(transport::ConnectionId connection, transport::Channel channel,
                                           std::span<const std::uint8_t> message) override {
    return m_inner->Send(connection, channel, message);
  }
  void Disconnect(transport::ConnectionId connection) override { m_inner->Disconnect(connection); }
  void Flush() override { m_inner->Flush(); }
  [[nodiscard]] transport::Statistics ReadStatistics() const override { return m_inner->ReadStatistics(); }
  [[nodiscard]] double ReadRoundTrip(transport::ConnectionId connection) const override {
    return m_inner->ReadRoundTrip(connection);
  }

 private:
  void Write(const transport::Event& event) {
    const auto size = static_cast<std::uint32_t>(event.bytes.size() + 1);
    for (unsigned i = 0; i < 4; ++i) m_out.put(static_cast<char>(size >> 8 * i));
    m_out.put(static_cast<char>(event.channel));
    m_out.write(reinterpret_cast<const char*>(event.bytes.data()), static_cast<std::streamsize>(event.bytes.size()));
  }

  std::unique_ptr<transport::Transport> m_inner;
  std::ostream& m_out;
};

void Record(std::vector<server::RotationScene> scenes, double seconds, std::ostream& out) {
  transport::VirtualNetwork network({.seed = 1});
  transport::LinkConditions conditions;
  conditions.loss = 0.05;
  conditions.delay = 0.03;
  conditions.jitter = 0.02;
  conditions.duplicate = 0.02;
  conditions.reorder = 0.02;
  network.SetConditions(conditions);
  double now = 0;
  const std::size_t count = scenes.size();
  server::Server server({}, scenes.front().scene, network.MakeServer(), now, scenes.front().bases);
  if (count > 1) server.Rotate(std::move(scenes));
  // At once, so that what is decoded follows from the messages alone.
  const client::Options options{.completionWork = std::numeric_limits<std::size_t>::max()};
  std::vector<std::unique_ptr<client::Client>> clients;
  clients.push_back(
      std::make_unique<client::Client>(std::make_unique<RecordingTransport>(network.MakeClient(), out), options, now));
  for (int i = 0; i < kOthers; ++i) {
    clients.push_back(std::make_unique<client::Client>(network.MakeClient(), client::Options{}, now));
  }
  wasm::DecodedHash hash;
  std::uint64_t records = 0;
  clients.front()->OnDecoded([&](const client::DecodedPatch& patch) {
    hash.Add(patch);
    ++records;
  });
  for (std::size_t begun = 1; now < seconds;) {
    now = server.NextCall();
    if (begun < count && now > seconds * static_cast<double>(begun) / static_cast<double>(count)) {
      static_cast<void>(server.GoToNextScene());
      ++begun;
    }
    server.Tick(now);
    for (std::size_t i = 0; i < clients.size(); ++i) {
      clients[i]->SetInput({i % 2 == 0 ? 1.0F : -0.5F, 0.7F, static_cast<int>(now) % 2 == 1});
      clients[i]->Update(now);
    }
  }
  std::cout << records << ' ' << std::hex << hash.Value() << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: record_session SCENE SECONDS trained|untrained FILE\n";
    return 2;
  }
  std::vector<server::RotationScene> scenes;
  std::istringstream names(argv[1]);
  for (std::string name; std::getline(names, name, ',');) {
    scenes::LoadResult loaded = scenes::LoadScene(name, test::FindSource("server/scenes"));
    for (const std::string& error : loaded.errors) std::cerr << error << '\n';
    if (!loaded.errors.empty()) return 1;
    std::vector<server::Bases> bases;
    if (std::string(argv[3]) == "trained") bases = server::LoadBases(loaded.scene, "", 2);
    scenes.push_back({.scene = std::move(loaded.scene), .source = {}, .bases = std::move(bases)});
  }
  std::ofstream out(argv[4], std::ios::binary);
  if (scenes.empty() || !out) return 1;
  Record(std::move(scenes), std::atof(argv[2]), out);
  return 0;
}
