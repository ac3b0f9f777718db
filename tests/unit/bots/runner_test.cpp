// The bots of a load test on virtual time, against a server that speaks a minimal part of the protocol: when bots join,
// which of the script's inputs reach the server, and the figures of good and bad runs.
#include "client/bots/runner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "protocol/messages.h"
#include "protocol/snapshot.h"
#include "protocol/transport/virtual_network.h"

namespace wobble::bots {
namespace {

using transport::Channel;

constexpr double kRound = 1.0 / 60;

protocol::Message MakeTetrahedron() {
  const std::vector<protocol::Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return protocol::MakeBlueprint({.name = "tetrahedron", .rest = rest, .faces = faces, .size = 1.732F});
}

// Welcomes every known version, sends an empty snapshot to all clients every second round, and stores what it receives.
class TinyServer {
 public:
  explicit TinyServer(std::unique_ptr<transport::Transport> transport) : m_transport(std::move(transport)) {}

  void RunRound(double now) {
    m_transport->Poll(now, [&](const transport::Event& event) { TakeIn(event, now); });
    if (++m_round % 2 == 0) {
      for (const transport::ConnectionId connection : m_welcomed) SendSnapshot(connection);
    }
    m_transport->Flush();
  }
  void TurnAway(transport::ConnectionId connection, wire::GoodbyeReason reason = wire::GoodbyeReason::ServerFull) {
    Send(connection, protocol::MakeServerGoodbye(reason, "enough"));
    m_welcomed.erase(connection);
    m_transport->Disconnect(connection);
  }

  std::vector<double> joins;
  std::map<transport::ConnectionId, float> moves;  // latest input along x, -127..127
  unsigned goodbyes = 0;

 private:
  void TakeIn(const transport::Event& event, double now) {
    if (event.kind != transport::Event::Kind::kMessage) return;
    const wire::ClientMessage* message = nullptr;
    ASSERT_EQ(protocol::ParseClientMessage(event.bytes, message), protocol::ParseResult::kOk);
    if (const auto* hello = message->body_as_Hello()) {
      if (hello->protocol_version() != protocol::kProtocolVersion) return TurnAway(event.connection);
      joins.push_back(now);
      Welcome(event.connection);
    } else if (const auto* input = message->body_as_Input()) {
      moves[event.connection] = static_cast<float>(input->frames()->Get(0)->move_x());
    } else if (message->body_as_Goodbye() != nullptr) {
      ++goodbyes;
      m_welcomed.erase(event.connection);
    }
  }
  void Welcome(transport::ConnectionId connection) {
    protocol::WelcomeFields fields;
    fields.clientId = connection;
    fields.ownBody = connection;
    fields.tick = m_round;
    fields.tickHz = 60;
    fields.snapshotHz = 30;
    fields.scene = "nothing";
    fields.blueprintCount = 1;
    Send(connection, protocol::MakeWelcome(fields));
    const protocol::Message blueprint = MakeTetrahedron();
    Send(connection, protocol::MakeBlueprintChunk(0, protocol::HashBytes(blueprint),
                                                  static_cast<std::uint32_t>(blueprint.size()), 0, blueprint));
    m_welcomed.insert(connection);
  }
  void SendSnapshot(transport::ConnectionId connection) {
    protocol::SnapshotHead head;
    head.sequence = ++m_sequences[connection];
    head.tick = m_round;
    head.timeRatio = 1;
    protocol::PacketBuilder builder;
    const auto bytes = builder.Finish(head);
    static_cast<void>(m_transport->Send(connection, Channel::kSnapshot, bytes));
  }
  void Send(transport::ConnectionId connection, const protocol::Message& message) {
    ASSERT_EQ(m_transport->Send(connection, Channel::kControl, message), transport::SendResult::kQueued);
  }

  std::unique_ptr<transport::Transport> m_transport;
  std::set<transport::ConnectionId> m_welcomed;
  std::map<transport::ConnectionId, std::uint32_t> m_sequences;
  std::uint32_t m_round = 0;
};

// Server, network and runner; a step is one round of each.
class Theatre {
 public:
  Theatre(const LoadTestOptions& options, const std::string& source)
      : server(m_network.MakeServer()),
        m_script(options.seed, {}),
        m_runner(
            options, m_script, [this](auto, std::string& error) { return Connect(error); }, [] { return 0.0; },
            [this](std::string_view line) { log.emplace_back(line); }) {
    std::string error;
    EXPECT_TRUE(m_script.Load(source, "test.lua", error)) << error;
    m_network.SetConditions(transport::LinkConditions{.delay = 0.02});
  }
  void RunUntil(double time) {
    for (; m_now < time; m_now += kRound) {
      for (unsigned part = 0; part < parts; ++part) m_runner.RunRound(m_now + kRound * part / parts, 0.0005, parts);
      if (serverLives) server.RunRound(m_now);
    }
  }
  void Leave() { m_runner.Leave(m_now); }
  Runner& Bots() { return m_runner; }
  double Now() const { return m_now; }

  bool serverLives = true;
  bool canConnect = true;
  unsigned parts = 1;
  std::vector<std::string> log;

 private:
  std::unique_ptr<transport::Transport> Connect(std::string& error) {
    if (canConnect) return m_network.MakeClient();
    error = "no such host";
    return nullptr;
  }

  transport::VirtualNetwork m_network;

 public:
  TinyServer server;

 private:
  Script m_script;
  Runner m_runner;
  double m_now = 0;
};

LoadTestOptions MakeOptions(unsigned count, double ramp = 0) {
  LoadTestOptions options;
  options.count = count;
  options.ramp = ramp;
  return options;
}

TEST(BotRunner, RampSpreadsTheJoinsAndScriptsReachTheServer) {
  Theatre theatre(MakeOptions(4, 2), "function run(bot) bot:move(bot:id() / 8, 0) end");
  theatre.RunUntil(4);
  ASSERT_EQ(theatre.server.joins.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_NEAR(theatre.server.joins[i] - theatre.server.joins[i - 1], 0.5, 1.5 * kRound);
  }
  ASSERT_EQ(theatre.server.moves.size(), 4U);
  std::set<int> eighths;
  for (const auto& [connection, move] : theatre.server.moves) {
    eighths.insert(static_cast<int>(std::lround(move * 8 / 127)));
  }
  EXPECT_EQ(eighths, (std::set<int>{1, 2, 3, 4}));

  EXPECT_FALSE(theatre.Bots().HaveAllEnded());
  const std::uint64_t snapshots = theatre.Bots().ReadFigures().snapshots;
  theatre.Leave();
  theatre.RunUntil(5.5);
  EXPECT_TRUE(theatre.Bots().HaveAllEnded());
  EXPECT_EQ(theatre.server.goodbyes, 4U);
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.bots, 4U);
  EXPECT_EQ(figures.connected, 4U);
  EXPECT_EQ(figures.disconnects, 0U);
  EXPECT_EQ(figures.scriptErrors, 0U);
  EXPECT_NEAR(static_cast<double>(snapshots), 30 * (4 + 3.5 + 3 + 2.5), 20);
  EXPECT_NEAR(figures.lateMsP99.value(), 0.5, 0.5 * Histogram::kRelativeError);
  // Connecting and joining take a round trip of 40 ms each, plus up to two rounds at either end.
  EXPECT_GT(figures.joinMsP99.value(), 79);
  EXPECT_LT(figures.joinMsP99.value(), 200);
  EXPECT_TRUE(figures.snapshotAgeMsP50.has_value());
  EXPECT_GT(figures.kbitPerSecondPerBot.value(), 1);
  EXPECT_FALSE(figures.decodeUsP99.has_value());  // no record was decoded
  EXPECT_TRUE(theatre.log.empty()) << theatre.log[0];
}

TEST(BotRunner, RoundsInPartsLookAfterEveryBot) {
  Theatre theatre(MakeOptions(6), "function run(bot) bot:move(bot:id() / 8, 0) bot:wait(60) end");
  theatre.parts = 4;
  theatre.RunUntil(2);
  std::set<float> moves;
  for (const auto& [connection, move] : theatre.server.moves) moves.insert(move);
  EXPECT_EQ(moves.size(), 6U);
  EXPECT_EQ(theatre.Bots().ReadFigures().joins, 6U);
  EXPECT_NEAR(static_cast<double>(theatre.Bots().ReadFigures().snapshots), 6 * 30 * 1.9, 40);
}

// Used by measurements of a stretch of play: excludes joining and settling, and shows what players see.
TEST(BotRunner, ForgetsTimesAndHandsOnWhatDecodingBotsShow) {
  LoadTestOptions options = MakeOptions(4);
  options.decodeShare = {1, 2};
  Theatre theatre(options, "function run(bot) end");
  std::set<const client::Client*> watched;
  unsigned shown = 0;
  theatre.Bots().SetOnShown([&](client::Client& client, std::span<const client::BodySample>, double now) {
    EXPECT_EQ(client.ReadState(), client::State::kPlaying);
    EXPECT_NEAR(now, theatre.Now(), 1e-9);
    watched.insert(&client);
    ++shown;
  });
  theatre.RunUntil(2);
  EXPECT_EQ(watched.size(), 2U);
  EXPECT_NEAR(shown, 2 * 60 * 1.9, 10);
  const Figures before = theatre.Bots().ReadFigures();
  ASSERT_TRUE(before.snapshotAgeMsP50.has_value());
  theatre.Bots().ForgetTimes();
  const Figures after = theatre.Bots().ReadFigures();
  EXPECT_FALSE(after.snapshotAgeMsP50.has_value());
  EXPECT_FALSE(after.lateMsP99.has_value());
  EXPECT_EQ(after.joinMsP99, before.joinMsP99);
  EXPECT_EQ(after.snapshots, before.snapshots);
  EXPECT_FALSE(theatre.Bots().IsHopeless(theatre.Now() + 10));
  theatre.RunUntil(3);
  EXPECT_TRUE(theatre.Bots().ReadFigures().snapshotAgeMsP50.has_value());
}

// Who sends bots away decides so; a server that does not answer fails.
TEST(BotRunner, BotsSentAwayAreCountedApartFromThoseNeverAnswered) {
  Theatre theatre(MakeOptions(4, 4), "function run(bot) bot:wait(60) end");
  theatre.RunUntil(1.5);
  theatre.server.TurnAway(1, wire::GoodbyeReason::Kicked);
  theatre.RunUntil(2.8);
  theatre.serverLives = false;  // bot 4 gets no answer
  theatre.RunUntil(4);
  theatre.Leave();
  theatre.RunUntil(6);
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.bots, 4U);
  EXPECT_EQ(figures.connected, 3U);
  EXPECT_EQ(figures.disconnects, 1U);
  EXPECT_EQ(figures.sentAway, 1U);
  ASSERT_EQ(theatre.log.size(), 1U);
  EXPECT_EQ(theatre.log[0].find("bot 1 ended: "), 0U) << theatre.log[0];
  EXPECT_NE(theatre.log[0].find("enough"), std::string::npos) << theatre.log[0];
}

// Who was cut off comes back and plays on, and has been lost all the same.
TEST(BotRunner, BotsThatAreCutOffJoinAgainAndCountAsLost) {
  LoadTestOptions options = MakeOptions(3);
  for (const double patience : {60.0, 0.0}) {
    options.rejoin.patience = patience;
    Theatre theatre(options, "function run(bot) while true do bot:move(1, 0) bot:wait(1) end end");
    theatre.RunUntil(2);
    EXPECT_EQ(theatre.Bots().TakeProgress().playing, 3U);
    theatre.server.TurnAway(2, wire::GoodbyeReason::ServerClosing);
    theatre.RunUntil(2.1);
    EXPECT_EQ(theatre.Bots().TakeProgress().playing, 2U);
    EXPECT_EQ(theatre.Bots().ReadFigures().disconnects, 1U);
    theatre.RunUntil(4);
    EXPECT_EQ(theatre.Bots().TakeProgress().playing, patience > 0 ? 3U : 2U);
    theatre.Leave();
    theatre.RunUntil(5.5);
    EXPECT_TRUE(theatre.Bots().HaveAllEnded());
    const Figures figures = theatre.Bots().ReadFigures();
    EXPECT_EQ(figures.connected, 3U);
    EXPECT_EQ(figures.joins, patience > 0 ? 4U : 3U);
    EXPECT_EQ(figures.rejoins, patience > 0 ? 1U : 0U);
    EXPECT_EQ(figures.disconnects, 1U);
    EXPECT_LT(figures.joinMsP99.value(), 200);
    EXPECT_EQ(figures.rejoinMsP99.has_value(), patience > 0);
    ASSERT_EQ(theatre.log.size(), 1U);
    EXPECT_EQ(theatre.log[0], patience > 0 ? "bot 2 was cut off and joins again: server is closing: enough"
                                           : "bot 2 ended: server is closing: enough");
    if (patience == 0) continue;
    EXPECT_EQ(theatre.server.moves.at(4), 127);  // its script goes on
    EXPECT_GT(figures.rejoinMsP99.value(), 125 + 79);
    EXPECT_LT(figures.rejoinMsP99.value(), 250 + 200);
  }
}

// The run of bots whose server has gone for good ends, and says why.
TEST(BotRunner, BotsGiveUpAServerThatStaysAway) {
  LoadTestOptions options = MakeOptions(2);
  options.rejoin.patience = 5;
  Theatre theatre(options, "function run(bot) bot:wait(60) end");
  theatre.RunUntil(2);
  theatre.server.TurnAway(1, wire::GoodbyeReason::ServerClosing);
  theatre.server.TurnAway(2, wire::GoodbyeReason::ServerClosing);
  theatre.RunUntil(2.05);
  theatre.serverLives = false;
  theatre.RunUntil(6);
  EXPECT_FALSE(theatre.Bots().HaveAllEnded());
  theatre.RunUntil(7.5);
  EXPECT_TRUE(theatre.Bots().HaveAllEnded());
  EXPECT_EQ(theatre.Bots().ReadFigures().disconnects, 2U);
  EXPECT_EQ(theatre.Bots().ReadFigures().rejoins, 0U);
  ASSERT_EQ(theatre.log.size(), 4U);
  EXPECT_NE(theatre.log[2].find(" ended: server is closing: enough; gave up joining again after 5 s"),
            std::string::npos)
      << theatre.log[2];
}

TEST(BotRunner, SilenceIsHopelessButNoRefusal) {
  Theatre theatre(MakeOptions(3, 30), "function run(bot) end");
  theatre.serverLives = false;
  theatre.RunUntil(protocol::kConnectTimeout - 1);
  EXPECT_FALSE(theatre.Bots().HasAnyFailed());
  theatre.RunUntil(protocol::kConnectTimeout + 3);
  EXPECT_TRUE(theatre.Bots().HasAnyFailed());
  EXPECT_TRUE(theatre.Bots().IsHopeless(theatre.Now()));
  EXPECT_EQ(theatre.Bots().Refusal(), "");
  EXPECT_EQ(theatre.Bots().ReadFigures().connected, 0U);
  EXPECT_TRUE(theatre.log.empty());
}

TEST(BotRunner, ARefusalIsKeptAndSaidByNobodyElse) {
  LoadTestOptions options = MakeOptions(3);
  options.protocolVersion = protocol::kProtocolVersion + 1;
  Theatre theatre(options, "function run(bot) end");
  theatre.RunUntil(2);
  EXPECT_TRUE(theatre.Bots().HaveAllEnded());
  EXPECT_NE(theatre.Bots().Refusal().find("enough"), std::string::npos) << theatre.Bots().Refusal();
  EXPECT_EQ(theatre.Bots().ReadFigures().disconnects, 3U);
  EXPECT_TRUE(theatre.log.empty());

  Theatre nowhere(MakeOptions(2), "function run(bot) end");
  nowhere.canConnect = false;
  nowhere.RunUntil(0.1);
  EXPECT_TRUE(nowhere.Bots().HaveAllEnded());
  EXPECT_EQ(nowhere.Bots().Refusal(), "no such host");
}

TEST(BotRunner, AFailedScriptLeavesItsBotConnected) {
  Theatre theatre(MakeOptions(2), R"(function run(bot)
    bot:move(1, 0)
    bot:wait(0.5)
    if bot:id() == 1 then error('tired') end
    bot:wait(60)
  end)");
  theatre.RunUntil(2);
  EXPECT_EQ(theatre.server.moves.size(), 2U);
  unsigned walking = 0;
  for (const auto& [connection, move] : theatre.server.moves) walking += move != 0 ? 1 : 0;
  EXPECT_EQ(walking, 1U);
  EXPECT_FALSE(theatre.Bots().HaveAllScriptsFailed());
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.scriptErrors, 1U);
  EXPECT_EQ(figures.disconnects, 0U);
  ASSERT_EQ(theatre.log.size(), 1U);
  EXPECT_EQ(theatre.log[0], "bot 1 stands still: test.lua:4: tired");

  Theatre both(MakeOptions(2), "function run(bot) error('tired') end");
  both.RunUntil(2);
  EXPECT_TRUE(both.Bots().HaveAllScriptsFailed());
  EXPECT_EQ(both.log.size(), 1U);  // the same error is reported once

  Theatre many(MakeOptions(7), "function run(bot) error('tired ' .. bot:id()) end");
  many.RunUntil(2);
  EXPECT_EQ(many.Bots().ReadFigures().scriptErrors, 7U);
  ASSERT_EQ(many.log.size(), 5U);
  EXPECT_EQ(many.log[3].find("counted"), std::string::npos) << many.log[3];
  EXPECT_NE(many.log[4].find("(other errors are only counted)"), std::string::npos) << many.log[4];
}

TEST(BotRunner, LeavingAndJoiningAgainIsNoDisconnect) {
  Theatre theatre(MakeOptions(3), R"(function run(bot)
    for i = 1, 3 do
      bot:move(1, 0)
      bot:wait(1)
      bot:leave()
      assert(bot:position() == nil and bot:body() == nil and #bot:near() == 0)
      bot:leave()  -- is away already
      bot:wait(0.5)
      if bot:id() == 3 then return end  -- stays away
      bot:join()
      assert(bot:body() ~= nil)
    end
    assert(bot:time() > 4.5 and bot:time() < 5.5, bot:time())
    bot:wait(60)
  end)");
  theatre.RunUntil(8);
  EXPECT_EQ(theatre.server.joins.size(), 9U);
  EXPECT_EQ(theatre.server.goodbyes, 7U);
  EXPECT_EQ(theatre.Bots().TakeProgress().playing, 2U);
  EXPECT_FALSE(theatre.Bots().HaveAllEnded());
  theatre.Leave();
  theatre.RunUntil(10);
  EXPECT_TRUE(theatre.Bots().HaveAllEnded());
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.bots, 3U);
  EXPECT_EQ(figures.connected, 3U);
  EXPECT_EQ(figures.joins, 9U);
  EXPECT_EQ(figures.disconnects, 0U);
  EXPECT_EQ(figures.scriptErrors, 0U);
  // Played for a bit more than 3 s of 8, 3 s and 1 s, always at 30 snapshots a second.
  EXPECT_GT(figures.snapshots, 30U * 8);
  EXPECT_LT(figures.snapshots, 30U * 14);
  EXPECT_TRUE(theatre.log.empty()) << theatre.log[0];
}

TEST(BotRunner, ABotThatIsTurnedAwayOnItsReturnIsADisconnect) {
  Theatre theatre(MakeOptions(2), R"(function run(bot)
    bot:wait(1)
    if bot:id() == 1 then bot:leave() bot:join() end
    bot:wait(60)
  end)");
  theatre.RunUntil(1);
  theatre.canConnect = false;
  theatre.RunUntil(2);
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.connected, 2U);
  EXPECT_EQ(figures.joins, 2U);
  EXPECT_EQ(figures.disconnects, 1U);
  ASSERT_EQ(theatre.log.size(), 1U);
  EXPECT_EQ(theatre.log[0], "bot 1 ended: no such host");
}

TEST(BotRunner, StagesGoUpAndDownTheLastToJoinLeavesFirst) {
  LoadTestOptions options = MakeOptions(1);
  options.stages = {{2, 4}, {1, 4}, {2, 1}, {1, 3}};
  Theatre theatre(options, "function run(bot) bot:move(bot:id() / 8, 0) bot:wait(60) end");
  const auto playingAt = [&](double time) {
    theatre.RunUntil(time);
    return theatre.Bots().TakeProgress().playing;
  };
  EXPECT_EQ(playingAt(0.4), 1U);
  EXPECT_EQ(playingAt(1.4), 3U);
  EXPECT_EQ(playingAt(2.9), 4U);
  static_cast<void>(theatre.Bots().TakeProgress());
  theatre.RunUntil(3.2);
  const double steady = theatre.Bots().TakeProgress().kbitPerSecondPerBot.value();
  theatre.RunUntil(3.5);
  const Runner::Progress falling = theatre.Bots().TakeProgress();
  EXPECT_EQ(falling.playing, 3U);
  // figures of bots that left count while they played
  EXPECT_NEAR(falling.kbitPerSecondPerBot.value(), steady, 0.1 * steady);
  EXPECT_EQ(playingAt(4.9), 1U);
  EXPECT_EQ(playingAt(5.2), 2U);  // bot 1 stays, bot 5 has joined
  EXPECT_EQ(theatre.server.goodbyes, 3U);
  EXPECT_EQ(playingAt(6.0), 3U);
  theatre.Leave();
  theatre.RunUntil(7.5);
  EXPECT_TRUE(theatre.Bots().HaveAllEnded());
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.bots, 6U);
  EXPECT_EQ(figures.connected, 6U);
  EXPECT_EQ(figures.joins, 6U);
  EXPECT_EQ(figures.disconnects, 0U);
  EXPECT_EQ(theatre.server.goodbyes, 6U);
}

// A script's bots rejoin as the script asks; bots dismissed by a stage do not return.
TEST(BotRunner, StagesEndBotsThatAreAwayOrOnTheirWayToo) {
  LoadTestOptions options = MakeOptions(1);
  options.stages = {{0.5, 4}, {0.5, 0}, {0.1, 0}};
  Theatre theatre(options, "function run(bot) while true do bot:leave() bot:join() end end");
  theatre.RunUntil(2.5);
  EXPECT_EQ(theatre.Bots().TakeProgress().playing, 0U);
  EXPECT_FALSE(theatre.Bots().HaveAllEnded());  // the last stage runs to its end
  theatre.Leave();
  EXPECT_TRUE(theatre.Bots().HaveAllEnded());
  const Figures figures = theatre.Bots().ReadFigures();
  EXPECT_EQ(figures.bots, 4U);
  EXPECT_EQ(figures.disconnects, 0U);
  EXPECT_EQ(theatre.server.goodbyes, theatre.server.joins.size());
}

}  // namespace
}  // namespace wobble::bots
