// `wobble watch` on a terminal: a real server, a real pseudo-terminal, and all ways to end.
//
// The test plays the terminal: it reads the output, computes the screen (support/screen.h), and types. After any end
// the alternate screen must be left, the cursor shown, colours reset, the keyboard's modes popped, and the terminal's
// settings restored.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"
#include "protocol/transport/enet_transport.h"
#include "tests/support/watching.h"

namespace wobble::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// A spectator that reads the player's position.
class Observer {
 public:
  explicit Observer(int port) {
    std::string error;
    auto transport = transport::EnetTransport::Connect("127.0.0.1", static_cast<std::uint16_t>(port), error);
    client::Options options;
    options.spectator = true;
    m_client = std::make_unique<client::Client>(std::move(transport), options, ReadClock());
    m_client->OnEvent([this](const client::Client::Event& event) {
      if (event.kind == wire::EventKind::Join && event.body != 0) m_body = event.body;
    });
  }
  // Position of the player who joined last; nullopt before its body is known.
  std::optional<protocol::Vector3> FindPlayer() {
    m_client->Update(ReadClock());
    const auto pose = m_client->NewestPose(m_body);
    return pose ? std::optional(pose->centroid) : std::nullopt;
  }

 private:
  std::unique_ptr<client::Client> m_client;
  std::uint32_t m_body = 0;
};

bool IsStopped(pid_t process) {
  const std::string stat = ReadWhole("/proc/" + std::to_string(process) + "/stat");
  const std::size_t name = stat.rfind(')');
  return name != std::string::npos && stat.compare(name, 3, ") T") == 0;
}

TEST(Watch, ShowsTheWorldAndQuitsByKey) {
  const Wobbled server;
  for (const std::string key : {"q", "\x03", "\033", "\033[113u"}) {
    Session session(Watching(server.Port()));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    EXPECT_TRUE(session.IsRaw());
    EXPECT_TRUE(session.Shown().IsSet("?1049"));
    EXPECT_FALSE(session.Shown().IsSet("?25"));
    EXPECT_FALSE(session.Shown().IsSet("?7"));
    EXPECT_TRUE(session.AwaitStatus("13 bodies  1 player ")) << session.Status();
    session.Type(key);
    EXPECT_EQ(session.AwaitEnd(), 0);
    session.ExpectRestored();
    EXPECT_EQ(session.Errors(), "");
  }
}

TEST(Watch, KeysMoveTheOwnBody) {
  const Wobbled server;
  Observer observer(server.Port());
  Session session(Watching(server.Port()));
  std::optional<protocol::Vector3> at;
  const auto awaitPlayer = [&](const std::function<bool()>& condition) {
    return session.Await([&] {
      at = observer.FindPlayer();
      return at && condition();
    });
  };
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  ASSERT_TRUE(awaitPlayer([] { return true; }));
  const double landed = ReadClock() + 3;
  ASSERT_TRUE(awaitPlayer([&] { return ReadClock() > landed; }));
  const protocol::Vector3 start = *at;
  // The camera looks along (0.36, 0.93) until it is turned; a held key is sent repeatedly.
  EXPECT_TRUE(awaitPlayer([&] {
    session.Type("w");
    return at->y - start.y > 1.5F && at->x > start.x;
  })) << "forward";
  const protocol::Vector3 far = *at;
  EXPECT_TRUE(awaitPlayer([&] {
    session.Type("\033[B");
    return at->y - far.y < -1;
  })) << "back";
  session.Type("x ");
  EXPECT_TRUE(awaitPlayer([&] { return at->z > start.z + 0.4F; })) << "up";
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
}

TEST(Watch, HelpComesAndGoes) {
  const Wobbled server;
  Session session(Watching(server.Port(), {"--spectate"}), "");
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  EXPECT_TRUE(session.AwaitStatus("12 bodies  0 players")) << session.Status();
  session.Type("?");
  EXPECT_TRUE(session.Await([&] { return session.Text().find("let go of all keys") != std::string::npos; }));
  session.Type("?");
  EXPECT_TRUE(session.Await([&] { return session.Text().find("let go of all keys") == std::string::npos; }));
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
}

TEST(Watch, EndsByItselfAndCapturesItsPicture) {
  const Wobbled server;
  const std::string file = testing::TempDir() + "/watch_test.svg";
  Session session(Watching(server.Port(), {"--for", "4", "--capture", file}));
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
  const std::string svg = ReadWhole(file);
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("kbit/s"));
  std::filesystem::remove(file);
}

TEST(Watch, IsRestoredAfterEverySignal) {
  const Wobbled server;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    Session session(Watching(server.Port()));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    kill(session.Guardian(), signal);
    EXPECT_EQ(session.AwaitEnd(), 0) << "signal " << signal;
    session.ExpectRestored();
  }
}

TEST(Watch, IsRestoredWhateverBecomesOfTheDrawingProcess) {
  const Wobbled server;
  for (const int signal : {SIGTERM, SIGKILL, SIGSEGV, SIGABRT}) {
    Session session(Watching(server.Port()));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    const std::vector<pid_t> drawing = session.FindChildren();
    ASSERT_EQ(drawing.size(), 1U);
    kill(drawing[0], signal);
    EXPECT_EQ(session.AwaitEnd(), signal == SIGTERM ? 0 : 1) << "signal " << signal;
    session.ExpectRestored();
    if (signal == SIGKILL) {
      EXPECT_THAT(session.Errors(), HasSubstr("ended by signal 9"));
    }
  }
}

TEST(Watch, IsRestoredWhenItsGuardianIsKilled) {
  const Wobbled server;
  Session session(Watching(server.Port()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  const std::vector<pid_t> drawing = session.FindChildren();
  ASSERT_EQ(drawing.size(), 1U);
  kill(session.Guardian(), SIGKILL);
  EXPECT_EQ(session.AwaitEnd(), 128 + SIGKILL);
  EXPECT_TRUE(session.Await([&] { return ReadWhole("/proc/" + std::to_string(drawing[0]) + "/cmdline").empty(); }));
  session.ExpectRestored();
}

// A shell with line editing takes the terminal before the drawing process learns of the guardian's end.
TEST(Watch, AKilledGuardianLeavesTheShellItsOwnSettings) {
  const Wobbled server;
  Session session({"/bin/bash", "-c", "exec 2>&1; exec bash --norc --noprofile -i"});
  ASSERT_TRUE(session.Await([&] { return session.IsRaw(); }));
  const tcflag_t prompting = session.LocalModes();
  session.Type("'" + FindProgram("wobble") + "' watch 127.0.0.1:" + std::to_string(server.Port()) + "\n");
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text();
  const std::vector<pid_t> jobs = session.FindChildren();
  ASSERT_EQ(jobs.size(), 1U);
  kill(jobs[0], SIGKILL);
  ASSERT_TRUE(session.Await([&] { return !session.Shown().IsSet("?1049"); }));
  // The shell prompts again, and its settings stay unchanged.
  ASSERT_TRUE(session.Await([&] { return session.LocalModes() == prompting; }));
  for (int i = 0; i < 10; ++i) session.Take(50);
  EXPECT_EQ(session.LocalModes(), prompting);
  session.Type("exit\n");
  EXPECT_NE(session.AwaitEnd(), -1);
  // The position of the shell's first prompt is undefined: it may come before the picture has gone.
  EXPECT_FALSE(session.Shown().IsSet("?1049"));
  EXPECT_TRUE(session.Shown().IsSet("?25"));
}

TEST(Watch, SaysWhyItEndedOnceTheTerminalIsRestored) {
  Wobbled server;
  const std::string address = "127.0.0.1:" + std::to_string(server.Port());
  {
    Session session(Watching(server.Port(), {"--rejoin", "0"}));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    server.Signal(SIGSTOP);
    EXPECT_TRUE(session.AwaitStatus("nothing from the server for 2 s")) << session.Status();
    server.Signal(SIGCONT);
    server.Signal(SIGTERM);
    EXPECT_EQ(session.AwaitEnd(), 1);
    session.ExpectRestored();
    EXPECT_EQ(session.Errors().rfind("wobble watch: " + address + " is no longer there: ", 0), 0U) << session.Errors();
  }
  server.Kill();
  Session session(Watching(server.Port()));
  EXPECT_TRUE(session.Await([&] { return session.Text().find("connecting to " + address) != std::string::npos; }));
  EXPECT_EQ(session.AwaitEnd(), 2);
  session.ExpectRestored();
  EXPECT_EQ(session.Errors(), "wobble watch: no server answers at " + address + "\n");
}

// Killed without a goodbye and started again: the picture stays meanwhile, and the view goes on. It ends by key at once
// while it tries to join again.
TEST(Watch, JoinsARestartedServerAgain) {
  auto server = std::make_unique<Wobbled>();
  const int port = server->Port();
  Session session(Watching(port));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  server->Kill();
  ASSERT_TRUE(session.AwaitStatus("nothing from the server for 2 s")) << session.Status();
  server = std::make_unique<Wobbled>("arena", port);
  const double started = ReadClock();
  EXPECT_TRUE(session.AwaitStatus("13 bodies  1 player ")) << session.Status();
  EXPECT_LT(ReadClock() - started, kIsSanitized ? kPatience : 5);
  server->Signal(SIGTERM);
  EXPECT_TRUE(session.AwaitStatus("connection lost (server is closing); joining again ...")) << session.Status();
  const double asked = ReadClock();
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  EXPECT_LT(ReadClock() - asked, 1);
  session.ExpectRestored();
  EXPECT_EQ(session.Errors(), "");
}

TEST(Watch, GoesAlongIntoTheNextScene) {
  const std::string socket = testing::TempDir() + "/watch_admin_" + std::to_string(getpid());
  const Wobbled server("pair,curtain", 0, {"--untrained", "--admin-socket", socket});
  Session session(Watching(server.Port()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  EXPECT_TRUE(session.AwaitStatus("9 bodies  1 player ")) << session.Status();
  const std::string order = FindProgram("wobble") + " admin --socket " + socket + " next >/dev/null";
  EXPECT_EQ(std::system(order.c_str()), 0);
  EXPECT_TRUE(session.AwaitStatus("next scene: curtain")) << session.Status();
  EXPECT_TRUE(session.AwaitStatus("4 bodies  1 player ")) << session.Status();
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
  EXPECT_EQ(session.Errors(), "");
}

// Under a shell with job control, as in use; the shell takes its standard error for its terminal.
TEST(Watch, SuspendsAndComesBack) {
  const Wobbled server;
  for (const bool byKey : {true, false}) {
    Session session({"/bin/bash", "-c",
                     "exec 2>&1; set -m; '" + FindProgram("wobble") + "' watch 127.0.0.1:" +
                         std::to_string(server.Port()) + "; echo left; read line; fg; echo over"});
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    const std::vector<pid_t> jobs = session.FindChildren();
    ASSERT_EQ(jobs.size(), 1U);
    if (byKey) {
      session.Type("\x1a");
    } else {
      kill(jobs[0], SIGTSTP);
    }
    ASSERT_TRUE(session.Await([&] { return session.Text().find("left") != std::string::npos; })) << session.Text();
    EXPECT_TRUE(IsStopped(jobs[0]));
    session.ExpectRestored();
    const std::size_t before = session.Bytes();
    for (int i = 0; i < 10; ++i) session.Take(50);
    EXPECT_EQ(session.Bytes(), before) << "nothing is drawn meanwhile";
    session.Type("\n");
    ASSERT_TRUE(session.Await([&] { return session.Shown().IsSet("?1049"); })) << session.Text();
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text();  // by itself, the picture of before may be enough for it
    EXPECT_TRUE(session.IsRaw());
    session.Type("q");
    EXPECT_EQ(session.AwaitEnd(), 0);
    session.ExpectRestored();
    EXPECT_THAT(session.Text(), HasSubstr("over"));
  }
}

TEST(Watch, WithoutAShellItDoesNotStop) {
  const Wobbled server;
  Session session(Watching(server.Port()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  session.Type("\x1a");
  for (int i = 0; i < 10; ++i) session.Take(50);
  EXPECT_FALSE(IsStopped(session.Guardian()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text();
  EXPECT_TRUE(session.Shown().IsSet("?1049"));
  // Stopped and continued by another process: the screen is redrawn.
  kill(session.Guardian(), SIGSTOP);
  ASSERT_TRUE(session.Await([&] { return IsStopped(session.Guardian()); }));
  session.Scribble();
  ASSERT_THAT(session.Text(), HasSubstr("scribbled"));
  kill(session.Guardian(), SIGCONT);
  EXPECT_TRUE(session.Await([&] { return session.Text().find("scribbled") == std::string::npos; })) << session.Text();
  EXPECT_EQ(session.Shown().KeyboardModes(), 1);
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
}

TEST(Watch, FollowsTheTerminalsSize) {
  const Wobbled server;
  Session session(Watching(server.Port()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  session.Resize(120, 40);
  EXPECT_TRUE(session.AwaitPlaying()) << session.Text();
  session.Resize(12, 3);
  EXPECT_TRUE(session.Await([&] { return session.Text().find("too small") != std::string::npos; })) << session.Text();
  session.Resize(80, 24);
  EXPECT_TRUE(session.AwaitPlaying());
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
}

// A terminal that is not read: the program goes on, keeps its connection, and ends when asked to.
TEST(Watch, IsNotHeldUpByASlowTerminal) {
  const Wobbled server;
  Session session(Watching(server.Port()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  session.Type("lllllllll");  // changes the whole picture
  usleep(1'500'000);          // the test reads nothing
  const std::size_t before = session.Bytes();
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  EXPECT_LT(session.Bytes() - before, 200'000U) << "at most what the system buffers, a picture, and the end";
  session.ExpectRestored();
}

}  // namespace
}  // namespace wobble::test
