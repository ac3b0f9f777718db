// How a client ends: by Leave, by a goodbye, by silence, over a link too poor to play on.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/client/scripted_server.h"

namespace wobble::client {
namespace {

TEST_F(ClientTest, ShowsWhyTheServerSaidGoodbye) {
  Start();
  Connect();
  Arrive(Channel::kControl,
         protocol::MakeServerGoodbye(wire::GoodbyeReason::ServerFull, "64 of\n\x1b[31m 64 " + std::string(5000, 'x')));
  EXPECT_EQ(client->ReadState(), State::kEnded);
  EXPECT_TRUE(client->EndedUnasked());
  EXPECT_EQ(client->EndReason().substr(0, 27), "server is full: 64 of  [31m");
  EXPECT_LT(client->EndReason().size(), 250U);
  EXPECT_EQ(link.disconnects, 1);
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason().substr(0, 14), "server is full");
}

TEST_F(ClientTest, HandsOnNoTextThatATerminalWouldObey) {
  Join();
  std::vector<std::string> heard;
  client->OnNotice([&](const std::string& text) { heard.push_back(text); });
  client->OnEvent([&](const Client::Event& event) { heard.push_back(event.name); });
  const std::string hostile =
      "a\xC2\x9B"
      "2J\xE2\x80\xAE"
      "b\x1b\n\xFF";
  Arrive(Channel::kControl, protocol::MakeNotice(hostile));
  Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::Join, 1, 2, 3, hostile));
  EXPECT_EQ(heard, (std::vector<std::string>(2, "a 2Jb  \xEF\xBF\xBD")));
  Arrive(Channel::kControl, protocol::MakeServerGoodbye(wire::GoodbyeReason::Busy, hostile));
  EXPECT_EQ(client->EndReason(), std::string(protocol::Name(wire::GoodbyeReason::Busy)) + ": a 2Jb  \xEF\xBF\xBD");
}

TEST_F(ClientTest, EndsWhenNobodyAnswersOrTheLinkIsLost) {
  Start();
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason(), "no answer from the server");
  Start();
  client->Update(now += protocol::kSilenceTimeout - 0.1);
  EXPECT_EQ(client->ReadState(), State::kConnecting);
  client->Update(now += 0.2);
  EXPECT_EQ(client->EndReason(), "no answer from the server");
  Join();
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason(), "connection lost");
  EXPECT_TRUE(client->EndedUnasked());
}

TEST_F(ClientTest, EndsWhenTheServerIsSilent) {
  Join();
  for (int i = 0; i < 79; ++i) client->Update(now += 0.1);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  for (int i = 0; i < 2; ++i) client->Update(now += 0.1);
  EXPECT_EQ(client->ReadState(), State::kEnded);
  EXPECT_EQ(client->EndReason(), "server silent for 8 s");
  const std::size_t sent = link.sent.size();
  client->Update(now += 1);
  EXPECT_EQ(link.sent.size(), sent);
}

TEST_F(ClientTest, WaitsEightRoundTripsLongerForItsWelcomeThanInPlay) {
  link.roundTrip = 0.5;
  Start();
  Connect();
  client->Update(now += 8 + 4 - 0.1);
  EXPECT_EQ(client->ReadState(), State::kJoining);
  client->Update(now += 0.2);
  EXPECT_EQ(client->EndReason(), "server silent for 12 s");
  Join();
  client->Update(now += 8 + 0.1);
  EXPECT_EQ(client->EndReason(), "server silent for 8 s");

  link.roundTrip = 100;  // bounded by kMaxJoinRoundTrip
  Start();
  Connect();
  client->Update(now += 8 + 24 + 0.1);
  EXPECT_EQ(client->EndReason(), "server silent for 32 s");
}

TEST_F(ClientTest, EndsOverALinkOnWhichHardlyAnythingArrives) {
  for (const unsigned everyNth : {4u, 10u}) {
    Join();
    const double begin = now;
    for (std::uint32_t sequence = 1; sequence <= 40 * 30 && client->ReadState() != State::kEnded; ++sequence) {
      now += 1.0 / 30;
      if (sequence % everyNth == 0) Snapshot(sequence);
      client->Update(now);
    }
    EXPECT_EQ(client->ReadState(), everyNth == 4 ? State::kPlaying : State::kEnded);
    if (everyNth == 4) continue;
    EXPECT_LT(now - begin, 2 * protocol::kSilenceTimeout + 0.1);
    EXPECT_EQ(client->EndReason(), "connection too poor: 432 of the last 480 packets were lost");
  }
}

TEST_F(ClientTest, ABlackoutThatEndsInTimeIsNoPoorLink) {
  Join();
  for (std::uint32_t sequence = 1; sequence <= 60 * 30; ++sequence) {
    now += 1.0 / 30;
    if (sequence % (16 * 30) >= 7 * 30) Snapshot(sequence);
    client->Update(now);
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying) << client->EndReason();
}

TEST_F(ClientTest, LeavesWithAGoodbyeAndDoesNotWaitForEver) {
  Join();
  link.sent.clear();
  client->Leave(now);
  ASSERT_EQ(link.sent.size(), 1U);
  const wire::ClientMessage* message = nullptr;
  ASSERT_EQ(protocol::ParseClientMessage(link.sent[0].bytes, message), protocol::ParseResult::kOk);
  ASSERT_NE(message->body_as_Goodbye(), nullptr);
  EXPECT_EQ(link.disconnects, 1);
  client->Update(now += 0.5);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(link.sent.size(), 1U);  // no more inputs
  client->Update(now += 0.6);
  EXPECT_EQ(client->ReadState(), State::kEnded);
  EXPECT_EQ(client->EndReason(), "left");
  EXPECT_FALSE(client->EndedUnasked());

  Join();
  link.roundTrip = 0.5;
  client->Leave(now);
  client->Update(now += 2.9);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  client->Update(now += 0.2);
  EXPECT_EQ(client->ReadState(), State::kEnded);

  Join();
  link.roundTrip = 1000;  // bounded by kMaxLeaveRoundTrip
  client->Leave(now);
  client->Update(now += kLongestLeave);
  EXPECT_EQ(client->ReadState(), State::kEnded);
  link.roundTrip = 0;

  Join();
  client->Leave(now);
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason(), "left");
  Start();
  client->Leave(now);  // before it was connected
  EXPECT_EQ(client->EndReason(), "left");
}

}  // namespace
}  // namespace wobble::client
