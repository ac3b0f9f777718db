// The code that becomes WebAssembly for the page, run natively: its transport, the geometry it shows, a whole session.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "client/wasm/session.h"
#include "client/wasm/shown_bodies.h"
#include "client/wasm/web_socket_transport.h"
#include "protocol/limits.h"
#include "tests/unit/client/scripted_server.h"

namespace wobble::wasm {
namespace {

using protocol::Vector3;
using transport::Channel;
using transport::SendResult;
using Kind = transport::Event::Kind;
using Bytes = std::vector<std::uint8_t>;

struct Seen {
  Kind kind;
  Channel channel;
  Bytes bytes;
};

std::vector<Seen> Poll(WebSocketTransport& transport) {
  std::vector<Seen> seen;
  transport.Poll(0, [&](const transport::Event& event) {
    const bool isAligned = reinterpret_cast<std::uintptr_t>(event.bytes.data()) % alignof(std::uint64_t) == 0;
    EXPECT_TRUE(isAligned);  // or FlatBuffers refuses it
    seen.push_back({event.kind, event.channel, {event.bytes.begin(), event.bytes.end()}});
  });
  return seen;
}

Bytes Frame(Channel channel, const Bytes& message) {
  Bytes bytes(1 + message.size(), static_cast<std::uint8_t>(channel));
  std::copy(message.begin(), message.end(), bytes.begin() + 1);
  return bytes;
}

TEST(WebSocketTransport, HandsOnWhatCameInOrderAndThenTheEnd) {
  WebSocketTransport transport;
  EXPECT_TRUE(Poll(transport).empty());
  transport.Open();
  transport.Receive(Frame(Channel::kSnapshot, {1, 2, 3}));
  transport.Receive(Frame(Channel::kControl, {4}));
  transport.Close();
  const std::vector<Seen> seen = Poll(transport);
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_EQ(seen[0].kind, Kind::kConnected);
  EXPECT_EQ(seen[1].channel, Channel::kSnapshot);
  EXPECT_EQ(seen[1].bytes, (Bytes{1, 2, 3}));
  EXPECT_EQ(seen[2].channel, Channel::kControl);
  EXPECT_EQ(seen[3].kind, Kind::kDisconnected);
  EXPECT_TRUE(Poll(transport).empty());
}

TEST(WebSocketTransport, RefusesWhatIsNoMessage) {
  WebSocketTransport transport;
  transport.Open();
  transport.Receive({});
  transport.Receive(Bytes{0});
  transport.Receive(Bytes{9, 1});
  transport.Receive(Bytes(protocol::kMaxServerMessageBytes + 2, 0));
  EXPECT_EQ(Poll(transport).size(), 1U);
  EXPECT_EQ(transport.ReadStatistics().messagesRejected, 4U);
}

TEST(WebSocketTransport, SendsOnlyWhileItIsOpen) {
  WebSocketTransport transport;
  const Bytes message{7, 8};
  const auto id = WebSocketTransport::kConnection;
  EXPECT_EQ(transport.Send(id, Channel::kInput, message), SendResult::kFailed);
  transport.Open();
  Poll(transport);
  EXPECT_EQ(transport.Send(id + 1, Channel::kInput, message), SendResult::kUnknownConnection);
  EXPECT_EQ(transport.Send(id, Channel::kInput, Bytes(protocol::kMaxClientMessageBytes + 1)), SendResult::kTooLarge);
  EXPECT_EQ(transport.Send(id, Channel::kInput, message), SendResult::kQueued);
  const auto outgoing = transport.FindOutgoing();
  EXPECT_EQ(Bytes(outgoing.begin(), outgoing.end()), Frame(Channel::kInput, message));
  transport.TakeOutgoing();
  EXPECT_TRUE(transport.FindOutgoing().empty());
  transport.Disconnect(id);
  EXPECT_TRUE(transport.IsCloseAsked());
  EXPECT_EQ(transport.Send(id, Channel::kInput, message), SendResult::kFailed);
}

client::BodySample MakeSample(std::uint32_t body, const std::shared_ptr<const client::Blueprint>& blueprint,
                              std::vector<Vector3> vertices) {
  client::BodySample sample;
  sample.body = body;
  sample.blueprint = blueprint;
  sample.vertices = std::move(vertices);
  return sample;
}

std::shared_ptr<const client::Blueprint> MakeSquare() {
  auto blueprint = std::make_shared<client::Blueprint>();
  blueprint->rest = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  blueprint->faces = {{0, 1, 2}, {0, 2, 3}};
  return blueprint;
}

TEST(ShownBodies, CountARevisionOnlyForWhatMoved) {
  const auto square = MakeSquare();
  ShownBodies bodies;
  std::vector<client::BodySample> samples{MakeSample(3, square, square->rest), MakeSample(5, square, square->rest)};
  bodies.Update(samples);
  ASSERT_EQ(bodies.Views().size(), 2U);
  const std::uint32_t first = bodies.Views()[0].revision, second = bodies.Views()[1].revision;
  samples[1].vertices[2].z = 1;
  bodies.Update(samples);
  EXPECT_EQ(bodies.Views()[0].revision, first);
  EXPECT_NE(bodies.Views()[1].revision, second);
  EXPECT_EQ(bodies.Views()[1].body, 5U);
}

TEST(ShownBodies, NameBlueprintsAndForgetThoseThatAreGone) {
  ShownBodies bodies;
  const std::vector<client::BodySample> before{MakeSample(1, MakeSquare(), {{}, {}, {}, {}})};
  bodies.Update(before);
  const std::uint32_t number = bodies.Views()[0].blueprint;
  ASSERT_NE(bodies.FindBlueprint(number), nullptr);
  EXPECT_EQ(bodies.FindBlueprint(number)->faceCount, 2U);
  const std::vector<client::BodySample> after{MakeSample(1, MakeSquare(), {{}, {}, {}, {}})};
  bodies.Update(after);
  EXPECT_NE(bodies.Views()[0].blueprint, number);
  EXPECT_EQ(bodies.FindBlueprint(number), nullptr);
}

TEST(Session, PlaysWhenTheWorldIsThere) {
  Session session(std::string(40, 'x'), false, {}, 0);  // longer than kMaxNameBytes
  session.Transport().Open();
  session.Client().Update(0);
  const auto hello = session.Transport().FindOutgoing();
  ASSERT_FALSE(hello.empty());
  const wire::ClientMessage* message = nullptr;
  const Bytes aligned(hello.begin() + 1, hello.end());
  ASSERT_EQ(protocol::ParseClientMessage(aligned, message), protocol::ParseResult::kOk);
  EXPECT_EQ(message->body_as_Hello()->name()->size(), protocol::kMaxNameBytes);

  protocol::WelcomeFields welcome;
  welcome.clientId = 4;
  welcome.ownBody = 9;
  welcome.tickHz = 60;
  welcome.snapshotHz = 30;
  welcome.scene = "arena";
  welcome.hands = protocol::kMayGrab | protocol::kMayPush;
  session.Transport().Receive(Frame(Channel::kControl, protocol::MakeWelcome(welcome)));
  session.Transport().Receive(Frame(Channel::kControl, protocol::MakeNotice("not here")));
  session.Client().Update(0.1);
  EXPECT_EQ(session.Client().ReadState(), client::State::kPlaying);
  EXPECT_EQ(session.MakeWelcome().ownBody, 9U);
  EXPECT_EQ(session.MakeWelcome().hands, 5U);
  ASSERT_NE(session.TakeNotice(), nullptr);
  EXPECT_EQ(session.TakeNotice(), nullptr);
}

// The hashes in the hello of a session that begins with these blueprints.
std::vector<std::uint64_t> SayHello(Session& session) {
  session.Transport().Open();
  session.Client().Update(0);
  const auto hello = session.Transport().FindOutgoing();
  const Bytes aligned(hello.begin() + 1, hello.end());
  const wire::ClientMessage* message = nullptr;
  EXPECT_EQ(protocol::ParseClientMessage(aligned, message), protocol::ParseResult::kOk);
  const auto* kept = message->body_as_Hello()->kept();
  return kept == nullptr ? std::vector<std::uint64_t>() : std::vector<std::uint64_t>(kept->begin(), kept->end());
}

void Welcome(Session& session) {
  protocol::WelcomeFields welcome;
  welcome.clientId = 4;
  welcome.tickHz = 60;
  welcome.snapshotHz = 30;
  welcome.blueprintCount = 1;
  session.Transport().Receive(Frame(Channel::kControl, protocol::MakeWelcome(welcome)));
}

TEST(Session, HandsOutDownloadsAndBeginsWithThoseOfEarlierOnes) {
  const protocol::Message strip = client::MakeStrip();
  Session first("ada", false, {}, 0);
  EXPECT_TRUE(SayHello(first).empty());
  Welcome(first);
  for (const auto& chunk : client::CutIntoChunks(0, strip, 1000)) {
    first.Transport().Receive(Frame(Channel::kControl, chunk));
  }
  first.Client().Update(0.1);
  const DownloadView* download = first.TakeDownload();
  ASSERT_NE(download, nullptr);
  const std::uint64_t hash = protocol::HashBytes(strip);
  EXPECT_EQ(download->hashLow, static_cast<std::uint32_t>(hash));
  EXPECT_EQ(download->hashHigh, static_cast<std::uint32_t>(hash >> 32));
  EXPECT_EQ(download->length, strip.size());
  EXPECT_EQ(first.TakeDownload(), nullptr);

  Session second("ada", false, {Bytes(100, 1), strip}, 0);  // the first is damaged
  EXPECT_EQ(SayHello(second), (std::vector<std::uint64_t>{protocol::HashBytes(Bytes(100, 1)), hash}));
  Welcome(second);
  const auto size = static_cast<std::uint32_t>(strip.size());
  second.Transport().Receive(Frame(Channel::kControl, protocol::MakeBlueprintChunk(0, hash, size, size, {})));
  second.Client().Update(0.1);
  EXPECT_EQ(second.Client().ReadState(), client::State::kPlaying);
  EXPECT_EQ(second.TakeDownload(), nullptr) << "not handed out again";
}

TEST(Session, DropsDownloadsThatNobodyTakes) {
  Session session("ada", false, {}, 0);
  SayHello(session);
  Welcome(session);
  const protocol::Message strip = client::MakeStrip();
  const std::size_t most = protocol::kMaxKeptBytes / strip.size();
  for (std::size_t i = 0; i <= most; ++i) {
    const auto generation = static_cast<std::uint8_t>(i % 2);
    for (const auto& chunk : client::CutIntoChunks(0, strip, protocol::kBlueprintChunkBytes, generation)) {
      session.Transport().Receive(Frame(Channel::kControl, chunk));
    }
    session.Client().Update(0.001 * static_cast<double>(i));
  }
  std::size_t count = 0;
  while (session.TakeDownload() != nullptr) ++count;
  EXPECT_EQ(count, most);
}

TEST(DecodedHash, TellsVerticesApart) {
  const std::vector<Vector3> shape{{1, 2, 3}};
  const std::vector<Vector3> other{{1, 2, 3.0000002F}};
  DecodedHash a, b, c;
  a.Add({1, 2, {}, shape});
  b.Add({1, 2, {}, shape});
  c.Add({1, 2, {}, other});
  EXPECT_EQ(a.Value(), b.Value());
  EXPECT_NE(a.Value(), c.Value());
}

}  // namespace
}  // namespace wobble::wasm
