// Clients of a live world on the virtual network: well-formed messages with fields of any value, bytes that are no
// messages, on any channel, in any order, while the world steps. All bodies must stay finite and in the world's reach.
#include <cmath>
#include <memory>

#include "protocol/messages.h"
#include "protocol/transport/virtual_network.h"
#include "server/admin/orders.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "tests/fuzz/feed.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

constexpr const char* kScene = R"(
kill_height = -5
[[obstacle]]
kind = "box"
center = [0, 0, -1]
half_extents = [6, 6, 1]
[[blueprint]]
name = "ball"
subdivisions = 0
mass = 4
gas = 150
[[blueprint]]
name = "frame"
kind = "graph"
particle = [{ position = [0, 0, 0], fixed = true }, { position = [1, 0, 0] }, { position = [0, 0, 1] }]
spring = [{ ends = [0, 1], stiffness = 500 }, { ends = [0, 2], stiffness = 500 }, { ends = [1, 2], stiffness = 500 }]
[[bodies]]
blueprint = "ball"
position = [3, 3, 1]
[[bodies]]
blueprint = "frame"
position = [0, 0, 2]
[player]
blueprint = "ball"
spawn = [0, 0, 1]
[workshop]
blueprint = "frame"
[hands]
grab = true
cut = true
push = true
[tuning]
gravity = "everyone"
stiffness = "everyone"
time = "everyone"
[game]
kind = "sumo"
)";

class Match {
 public:
  Match() : m_server(server::Config{}, scenes::ParseScene(kScene, "fuzz").scene, m_network.MakeServer(), 0) {
    admission::GateSettings settings;
    settings.readUnixTime = [] { return std::uint64_t{1'800'000'000}; };
    m_gate = std::make_unique<admission::Gate>(settings, admission::Bans{}, admission::Invites{});
    m_server.SetOrderTaker([this](server::ClientId client, transport::Rank rank, const std::string& line) {
      return admin::CarryOut({m_server, *m_gate}, {.rank = rank, .client = client}, line, m_now).lines;
    });
    for (auto& client : m_clients) client = m_network.MakeClient();
    Run(3);
  }

  void Act(Feed& feed) {
    const std::uint8_t choice = feed.TakeByte();
    transport::Transport& client = *m_clients[choice / 16 % m_clients.size()];
    const auto say = [&](transport::Channel channel, const std::vector<std::uint8_t>& bytes) {
      static_cast<void>(client.Send(1, channel, bytes));
    };
    const auto control = [&](const protocol::Message& message) { say(transport::Channel::kControl, message); };
    const auto place = [&] { return protocol::Vector3{TakeLength(feed), TakeLength(feed), TakeLength(feed)}; };
    if (choice >= 192) return Talk(feed, client);
    switch (choice % 12) {
      case 0:
        return Run(1 + feed.TakeByte() % 8);
      case 1:
        return control(protocol::MakeHello(feed.TakeText().substr(0, protocol::kMaxNameBytes),
                                           static_cast<protocol::wire::Role>(feed.TakeByte() % 2)));
      case 2:
        return SayInput(feed, client);
      case 3:
        return control(protocol::MakePush(feed.TakeByte() % 8, feed.TakeByte(), place()));
      case 4:
        return control(protocol::MakeCut(feed.TakeByte() % 8, place(), place(), place()));
      case 5:
        return control(protocol::MakeInspect(feed.TakeByte() % 8));
      case 6:
        return control(protocol::MakeTune(static_cast<protocol::wire::TuneKind>(feed.TakeByte() % 4), place()));
      case 7:
        return control(protocol::MakeBuild({.kind = static_cast<protocol::wire::BuildKind>(feed.TakeByte() % 6),
                                            .a = feed.TakeByte(),
                                            .b = feed.TakeByte(),
                                            .at = place(),
                                            .mass = TakeLength(feed),
                                            .fixed = feed.TakeByte() % 2 == 0,
                                            .stiffness = feed.Take<float>(),
                                            .damping = TakeLength(feed),
                                            .restLength = TakeLength(feed)}));
      case 8:
        return control(protocol::MakeOrder(feed.TakeText().substr(0, protocol::kMaxOrderBytes)));
      case 9:
        static_cast<void>(m_server.SetRank(1 + feed.TakeByte() % 3, static_cast<transport::Rank>(feed.TakeByte() % 4)));
        return;
      case 10:
        return say(static_cast<transport::Channel>(feed.TakeByte() % 3), feed.TakeSome());
      default:
        return control(protocol::MakeClientGoodbye(protocol::wire::GoodbyeReason::Left, feed.TakeText()));
    }
  }

  void Check() {
    for (const physics::Body& body : m_server.World().Bodies()) {
      physics::VisitVertices(body, [](std::size_t, const physics::Vector3d& x) {
        Require(x.allFinite() && x.cwiseAbs().maxCoeff() < 1e6);
      });
    }
  }
  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      m_now = m_server.NextCall();
      static_cast<void>(m_server.Tick(m_now));
      for (auto& client : m_clients) client->Poll(m_now, [](const transport::Event&) {});
    }
  }

 private:
  // Mostly within the world, sometimes any float.
  static float TakeLength(Feed& feed) {
    const auto number = feed.Take<std::int16_t>();
    return number == 32767 ? feed.Take<float>() : static_cast<float>(number) / 4096;
  }
  static void Talk(Feed& feed, transport::Transport& client) {
    const std::uint8_t choice = feed.TakeByte();
    const std::string text = feed.TakeText();
    const protocol::Message message = choice % 3 == 0 ? protocol::MakeSay(text.substr(0, protocol::kMaxSaidBytes))
                                      : choice % 3 == 1
                                          ? protocol::MakeRename(text.substr(0, protocol::kMaxNameBytes))
                                          : protocol::MakeEmote(static_cast<protocol::wire::EmoteKind>(choice % 6));
    static_cast<void>(client.Send(1, transport::Channel::kControl, message));
  }
  void SayInput(Feed& feed, transport::Transport& client) {
    std::vector<protocol::wire::InputFrame> frames;
    const std::uint32_t tick = m_server.World().Tick() + feed.TakeByte() % 80;
    for (std::size_t i = 0; i <= feed.TakeByte() % protocol::kMaxInputFrames; ++i) {
      frames.emplace_back(tick - static_cast<std::uint32_t>(i), feed.Take<std::int8_t>(), feed.Take<std::int8_t>(),
                          feed.TakeByte());
    }
    const protocol::wire::Hand hand({TakeLength(feed), TakeLength(feed), TakeLength(feed)}, feed.TakeByte() % 8,
                                    feed.TakeByte(), feed.TakeByte());
    const auto message = protocol::MakeInput({.frames = frames,
                                              .ackedSequence = feed.TakeByte(),
                                              .ackedHistory = feed.Take<std::uint64_t>(),
                                              .hand = feed.TakeByte() % 2 == 0 ? nullptr : &hand,
                                              .stalls = feed.TakeByte(),
                                              .downloaded = feed.Take<std::uint16_t>()});
    static_cast<void>(client.Send(1, transport::Channel::kInput, message));
  }

  transport::VirtualNetwork m_network;
  server::Server m_server;
  std::unique_ptr<admission::Gate> m_gate;
  std::array<std::unique_ptr<transport::Transport>, 2> m_clients;
  double m_now = 0;
};

void FuzzOne(std::span<const std::uint8_t> bytes) {
  Feed feed(bytes);
  Match match;
  for (int i = 0; i < 60 && !feed.IsEmpty(); ++i) match.Act(feed);
  match.Run(4);
  match.Check();
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
