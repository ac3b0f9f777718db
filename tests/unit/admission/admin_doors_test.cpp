// Orders from outside the game: the Unix socket and HTTP, with the client that people use.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "client/admin/ask.h"
#include "server/admin/admin_http.h"
#include "server/admin/admin_socket.h"
#include "tests/support/game.h"

namespace wobble::admin {
namespace {

// A game whose orders a thread carries out, as the loop of a server does.
class AdminDoorsTest : public testing::Test {
 protected:
  AdminDoorsTest() {
    EXPECT_TRUE(transport::vestibule::InitialiseSodium());
    m_key.fill(7);
    m_thread = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        queue.CarryOutAll({m_game.server, m_gate}, 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  static admission::GateSettings MakeSettings() {
    admission::GateSettings settings;
    settings.readUnixTime = [] { return std::uint64_t{1'800'000'000}; };
    return settings;
  }

  const std::string m_path = testing::TempDir() + "wobble-admin-" + std::to_string(getpid());
  transport::vestibule::Key m_key{};
  test::Game m_game{test::MakeYard()};
  admission::Gate m_gate{MakeSettings(), {}, {}};
  OrderQueue queue;
  std::string error;
  std::jthread m_thread;
};

TEST_F(AdminDoorsTest, TheSocketIsItsUsersOwnAndAnswers) {
  auto socket = AdminSocket::Listen(m_path, queue, error);
  ASSERT_NE(socket, nullptr) << error;
  struct stat status {};
  ASSERT_EQ(stat(m_path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  const Reply good = AskSocket(m_path, "status");
  EXPECT_TRUE(good.isDone) << good.text;
  EXPECT_EQ(good.text, "scene yard, 0 in, open, tick 0\n");
  EXPECT_FALSE(AskSocket(m_path, "kick 3").isDone);
  EXPECT_FALSE(AskSocket(m_path, std::string(3000, 'a')).isDone);
  EXPECT_EQ(AskSocket(m_path, "").text, "an order is missing (see help)\n");
  EXPECT_TRUE(AskSocket(m_path, "status").isDone) << "and it lives";
  EXPECT_EQ(AdminSocket::Listen(m_path, queue, error), nullptr);
  EXPECT_NE(error.find("another server answers"), std::string::npos) << error;
  socket.reset();
  EXPECT_NE(access(m_path.c_str(), F_OK), 0);
  EXPECT_FALSE(AskSocket(m_path, "status").isDone);

  // What a killed server left behind is no hindrance; a file of somebody is.
  const int left = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  m_path.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(left, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(left);
  EXPECT_NE(AdminSocket::Listen(m_path, queue, error), nullptr) << error;
  std::ofstream(m_path) << "a letter";
  EXPECT_EQ(AdminSocket::Listen(m_path, queue, error), nullptr);
  EXPECT_NE(error.find("no socket"), std::string::npos) << error;
  unlink(m_path.c_str());
}

TEST_F(AdminDoorsTest, HttpAsksForTheOwnersKey) {
  const auto listener = ListenForOrders({"127.0.0.1", 0}, m_key, queue, error);
  ASSERT_NE(listener, nullptr) << error;
  const std::string key = transport::vestibule::FormatKey(m_key);
  const Reply good = AskHttp("127.0.0.1", listener->ReadPort(), key, "status");
  EXPECT_TRUE(good.isDone) << good.text;
  EXPECT_EQ(good.text, "scene yard, 0 in, open, tick 0\n");
  EXPECT_FALSE(AskHttp("127.0.0.1", listener->ReadPort(), key, "kick 3").isDone);
  std::string other = key;
  other.back() = '8';
  EXPECT_EQ(AskHttp("127.0.0.1", listener->ReadPort(), other, "status").text, "the server has another owner's key\n");
}

}  // namespace
}  // namespace wobble::admin
