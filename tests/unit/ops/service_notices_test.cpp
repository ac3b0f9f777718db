#include "server/ops/service_notices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/log_catcher.h"
#include "tests/support/notice_socket.h"

namespace wobble::ops {
namespace {

using test::NoticeSocket;
using testing::HasSubstr;

std::string MakePath() { return std::filesystem::temp_directory_path() / ("notices" + std::to_string(getpid())); }

TEST(ServiceNotices, ReachAPathAndAnAbstractName) {
  for (const std::string& name : {MakePath(), "@wobble" + std::to_string(getpid())}) {
    const NoticeSocket manager(name);
    ServiceNotices notices(name, 0);
    notices.TellReady();
    EXPECT_EQ(manager.Receive(1000), "READY=1");
    notices.TellEnding();
    EXPECT_EQ(manager.Receive(1000), "STOPPING=1");
  }
}

TEST(ServiceNotices, TwoSignsOfLifeInEachTimeOfTheWatchdogAndOnlyFromTheLoop) {
  const NoticeSocket manager(MakePath());
  ServiceNotices notices(manager.Name(), 10);
  int signs = 0;
  for (int turn = 0; turn < 6000; ++turn) {  // 100 s at 60 Hz
    notices.TellAlive(turn / 60.0);
    signs += manager.Receive(0) == "WATCHDOG=1" ? 1 : 0;
  }
  EXPECT_NEAR(signs, 20, 1);
  EXPECT_EQ(manager.Receive(200), "") << "the loop hangs";
}

TEST(ServiceNotices, WithoutAWatchdogThereAreNoSigns) {
  const NoticeSocket manager(MakePath());
  ServiceNotices notices(manager.Name(), 0);
  for (int now = 0; now < 100; ++now) notices.TellAlive(now);
  EXPECT_EQ(manager.Receive(0), "");
}

// A manager that reads nothing: its socket is full after some notices.
TEST(ServiceNotices, NeverWait) {
  const NoticeSocket manager(MakePath());
  const test::LogCatcher log;
  ServiceNotices notices(manager.Name(), 0);
  for (int i = 0; i < 10000; ++i) notices.TellReady();
  const std::string text = log.Text();
  EXPECT_THAT(text, HasSubstr("systemd is not told READY=1: "));
  EXPECT_EQ(text.find('\n'), text.size() - 1) << "once";
}

TEST(ServiceNotices, SocketsThatAreNone) {
  for (const std::string& name : {std::string("relative"), std::string("/") + std::string(200, 'x')}) {
    const test::LogCatcher log;
    ServiceNotices(name, 1).TellReady();
    EXPECT_THAT(log.Text(), HasSubstr("NOTIFY_SOCKET " + name + ": must be a path")) << name;
  }
  const test::LogCatcher log;
  ServiceNotices("", 1).TellReady();
  EXPECT_EQ(log.Text(), "");
  ServiceNotices("/nowhere/socket", 1).TellReady();
  EXPECT_THAT(log.Text(), HasSubstr("No such file"));
}

TEST(ServiceNotices, TheWatchdogOfAParentIsNotOurs) {
  const NoticeSocket manager(MakePath());
  setenv("NOTIFY_SOCKET", manager.Name().c_str(), 1);
  setenv("WATCHDOG_USEC", "1000000", 1);
  const auto countSigns = [&manager] {
    ServiceNotices notices = ServiceNotices::FromEnvironment();
    for (int now = 0; now < 4; ++now) notices.TellAlive(now);
    int signs = 0;
    while (manager.Receive(0) == "WATCHDOG=1") ++signs;
    return signs;
  };
  EXPECT_EQ(countSigns(), 4);
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_EQ(countSigns(), 4);
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(countSigns(), 0);
  for (const char* variable : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(variable);
}

}  // namespace
}  // namespace wobble::ops
