// One connection from hello to goodbye. Update is Poll → take in → send what is due → move the shown moment on.
//
// Everything that comes in is untrusted: it is verified, counted when it is wrong and dropped whole, and what it can
// make the client keep is bounded (blueprint_store.h, bodies.h). A message that is out of place is treated like a
// broken one.
//
// Inputs go out once a tick even when nobody presses anything, and from spectators too: each carries the
// acknowledgement of snapshots and says that somebody is still there.
#include "client/client.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "client/blueprint_store.h"
#include "client/bodies.h"
#include "client/clock.h"
#include "client/grounds.h"
#include "client/input_stream.h"
#include "client/jitter_buffer.h"
#include "client/newest_poses.h"
#include "client/news.h"
#include "protocol/acknowledgement.h"
#include "protocol/shape_codec.h"
#include "protocol/snapshot.h"

namespace wobble::client {
namespace {

// Seconds that a goodbye of our own may take until the link is taken for closed, and round trips beyond that: a few
// tries, since a server that never hears it keeps the body until it finds the silence too long. A link that claims to
// take longer than kMaxLeaveRoundTrip, seconds, gains no more by it.
constexpr double kLeaveTimeout = 1;
constexpr double kLeaveRoundTrips = 4;
constexpr double kMaxLeaveRoundTrip = 1;
static_assert(kLeaveTimeout + kLeaveRoundTrips * kMaxLeaveRoundTrip == kLongestLeave);
// Inputs sent in one Update at most; after a longer pause the schedule starts anew.
constexpr int kMaxCatchUp = 3;
// Snapshot intervals that the measured one may reach, in terms of the promised one, before it is not believed.
constexpr double kMaxIntervalRatio = 3.0;
constexpr double kIntervalSmoothing = 1.0 / 32.0;
constexpr double kForgetEvery = 1.0;
// A tick that comes late now and then is no slower world.
constexpr double kOnPace = 0.97;
// A link on which, over the first, seconds, less than the second, a share, of what the server sent has come is taken
// for lost: it would show a world that jumps twice a second and call that playing. Twice the silence that is allowed,
// so that a black-out which ends in time does not count as such a link.
constexpr double kPoorLinkWindow = 2 * protocol::kSilenceTimeout;
constexpr double kPoorLinkShare = 0.2;
constexpr std::uint32_t kPoorLinkPackets = 64;  // of fewer no share is told
// Bytes of a server's words shown to people.
constexpr std::size_t kMaxDetail = 200;

// One line that a terminal cannot take for anything but text.
std::string MakeLine(const flatbuffers::String& words) {
  std::string text(words.string_view().substr(0, kMaxDetail));
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) c = ' ';
  }
  return text;
}

std::string DescribeGoodbye(const wire::Goodbye& goodbye) {
  const std::string reason = protocol::Name(goodbye.reason());
  const bool hasDetail = goodbye.detail() != nullptr && goodbye.detail()->size() > 0;
  return hasDetail ? reason + ": " + MakeLine(*goodbye.detail()) : reason;
}

}  // namespace

struct Client::Implementation {
  explicit Implementation(Curve curve) : bodies(curve) {}

  std::unique_ptr<transport::Transport> transport;
  Options options;
  transport::ConnectionId connection = 0;
  State state = State::kConnecting;
  std::string endReason;
  bool leaving = false;
  double leaveDeadline = 0;
  double startedAt = 0;
  double now = 0;  // of the latest Update or Sample
  double lastReceived = 0;

  bool welcomed = false;
  protocol::WelcomeFields welcome;
  double tickSeconds = 0;
  double snapshotSeconds = 0;  // promised
  client::Grounds grounds;
  BlueprintStore blueprints;
  Statistics statistics;
  std::function<void(const Event&)> onEvent;
  std::function<void(const SnapshotArrival&)> onSnapshot;
  std::function<void(const std::string&)> onNotice;
  std::function<void(const DecodedPatch&)> onDecoded;
  News news;

  Input input;
  std::optional<wire::Hand> hand;
  std::uint16_t grips = 0;  // made so far
  InputStream inputs;
  double nextInput = 0;
  double smallestInputToSnapshot = -1;

  protocol::ReceivedWindow received;
  double windowBegin = 0;           // of judging the link
  std::uint32_t windowNewest = 0;   // the newest packet at that moment
  std::uint64_t windowArrived = 0;  // packets until that moment
  bool hasSnapshot = false;
  std::uint32_t newestTick = 0;
  Clock clock;
  JitterBuffer jitter;
  Bodies bodies;
  double nextForget = 0;
  NewestPoses newestPoses;
  std::vector<protocol::Record> records;  // scratch
  protocol::ShapeDecoder decoder;
  std::vector<protocol::Vector3> shape;  // scratch

  void TakeIn(const transport::Event& event);
  void End(std::string reason);
  void EndIfSilent();
  void EndIfPoor();
  void SayHello();
  void StartPlayingWhenComplete();

  void HandleControl(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool HandleWelcome(const wire::Welcome& message);
  void HandleEvent(const wire::Event& message);

  void HandleSnapshot(std::span<const std::uint8_t> bytes);
  void MeasureSnapshot(const protocol::SnapshotHead& head);
  double MeasureInput(std::uint32_t inputTick);
  void HandleRecord(const protocol::Record& record, std::uint32_t tick);
  [[nodiscard]] bool DecodeRecord(const protocol::Record& record, const std::shared_ptr<const Blueprint>& blueprint,
                                  std::uint32_t tick);

  void SendDueInputs();
  void SendInput();
  void Ask(const protocol::Message& message);

  void MoveOn(double to);
  [[nodiscard]] double TimeOf(std::uint32_t tick) const { return static_cast<double>(tick) * tickSeconds; }
};

Client::Client(std::unique_ptr<transport::Transport> transport, Options options, double now)
    : m(std::make_unique<Implementation>(options.curve)) {
  assert(transport != nullptr && options.name.size() <= protocol::kMaxNameBytes);
  m->transport = std::move(transport);
  m->options = std::move(options);
  if (!m->options.decode) m->blueprints.PassOverBases();
  m->startedAt = m->now = m->lastReceived = m->windowBegin = now;
}

Client::~Client() = default;

void Client::Update(double now) {
  assert(now >= m->now);
  m->now = std::max(now, m->now);
  m->transport->Poll(m->now, [this](const transport::Event& event) { m->TakeIn(event); });
  if (m->leaving && m->now >= m->leaveDeadline) m->End("left");
  m->EndIfSilent();
  m->EndIfPoor();
  if (m->state != State::kEnded) {
    if (m->welcomed && !m->leaving) m->SendDueInputs();
    m->MoveOn(m->now);
  }
  m->transport->Flush();
}

void Client::SetInput(const Input& input) { m->input = input; }

void Client::SetHand(const std::optional<Hand>& hand) {
  if (!hand) {
    m->hand.reset();
    return;
  }
  const bool isSame = m->hand && m->hand->body() == hand->body && m->hand->vertex() == hand->vertex;
  if (!isSame && ++m->grips == 0) m->grips = 1;  // 0 says that the hand is empty
  m->hand.emplace(wire::Vec3(hand->target.x, hand->target.y, hand->target.z), hand->body, hand->vertex, m->grips);
}

void Client::Push(std::uint32_t body, std::uint16_t vertex, const protocol::Vector3& direction) {
  m->Ask(protocol::MakePush(body, vertex, direction));
}

void Client::Cut(std::uint32_t body, const protocol::Vector3& eye, const protocol::Vector3& from,
                 const protocol::Vector3& to) {
  m->Ask(protocol::MakeCut(body, eye, from, to));
}

void Client::Inspect(std::uint32_t body) { m->Ask(protocol::MakeInspect(body)); }
void Client::Tune(wire::TuneKind kind, const protocol::Vector3& value) { m->Ask(protocol::MakeTune(kind, value)); }
void Client::Build(const protocol::BuildFields& fields) { m->Ask(protocol::MakeBuild(fields)); }

void Client::Leave(double now) {
  if (m->state == State::kEnded || m->leaving) return;
  m->leaving = true;
  const double roundTrip = m->connection != 0 ? m->transport->ReadRoundTrip(m->connection) : 0;
  m->leaveDeadline = now + kLeaveTimeout + kLeaveRoundTrips * std::min(roundTrip, kMaxLeaveRoundTrip);
  if (m->connection == 0) {
    m->End("left");
    return;
  }
  const auto goodbye = protocol::MakeClientGoodbye(wire::GoodbyeReason::Left, "");
  // Whether it could be queued makes no difference: the link is closed either way.
  static_cast<void>(m->transport->Send(m->connection, transport::Channel::kControl, goodbye));
  m->transport->Disconnect(m->connection);
  m->transport->Flush();
}

State Client::ReadState() const { return m->state; }
const std::string& Client::EndReason() const { return m->endReason; }
bool Client::EndedUnasked() const { return m->state == State::kEnded && !m->leaving; }
const protocol::WelcomeFields& Client::Welcome() const { return m->welcome; }
const std::vector<Ground>& Client::Grounds() const { return m->grounds.All(); }
const Statistics& Client::ReadStatistics() const { return m->statistics; }
double Client::Pace() const {
  const double pace = m->statistics.timeRatio / double{m->news.tuning.timeRate};
  return pace < kOnPace ? pace : 1;
}
const Tuning& Client::ReadTuning() const { return m->news.tuning; }
const Scoreboard& Client::ReadScoreboard() const { return m->news.scoreboard; }
const Forces& Client::ReadForces() const { return m->news.forces; }
double Client::ServerTime(double now) const { return m->hasSnapshot ? m->clock.ServerTime(now) : 0.0; }
double Client::InterpolationDelay() const { return m->jitter.Delay(); }
void Client::OnEvent(std::function<void(const Event&)> handler) { m->onEvent = std::move(handler); }
void Client::OnNotice(std::function<void(const std::string&)> handler) { m->onNotice = std::move(handler); }
void Client::OnDecoded(std::function<void(const DecodedPatch&)> handler) { m->onDecoded = std::move(handler); }
void Client::OnSnapshot(std::function<void(const SnapshotArrival&)> handler) { m->onSnapshot = std::move(handler); }

void Client::Sample(double now, Detail detail, std::vector<BodySample>& samples) {
  m->now = std::max(now, m->now);
  m->MoveOn(m->now);
  m->bodies.Sample(m->jitter.Playback(), m->TimeOf(m->newestTick), detail, samples, m->statistics);
}

std::optional<protocol::Pose> Client::NewestPose(std::uint32_t body) const { return m->newestPoses.Find(body); }

std::optional<Sighting> Client::FindSighting(std::uint32_t body) const {
  return m->newestPoses.FindSighting(body, m->tickSeconds, m->newestTick);
}

void Client::ListSightings(std::vector<Sighting>& sightings) const {
  m->newestPoses.List(m->tickSeconds, m->newestTick, sightings);
}

void Client::Implementation::TakeIn(const transport::Event& event) {
  if (state == State::kEnded) return;
  switch (event.kind) {
    case transport::Event::Kind::kConnected:
      if (connection != 0) return;
      connection = event.connection;
      lastReceived = now;
      state = State::kJoining;
      SayHello();
      return;
    case transport::Event::Kind::kDisconnected:
      End(leaving ? "left" : state == State::kConnecting ? "no answer from the server" : "connection lost");
      return;
    case transport::Event::Kind::kMessage:
      break;
  }
  if (state == State::kConnecting) return;
  lastReceived = now;
  statistics.bytesReceived += event.bytes.size();
  switch (event.channel) {
    case transport::Channel::kControl:
      HandleControl(event.bytes);
      return;
    case transport::Channel::kSnapshot:
      HandleSnapshot(event.bytes);
      return;
    case transport::Channel::kInput:
      ++statistics.badMessages;
      return;  // goes the other way only
  }
}

void Client::Implementation::End(std::string reason) {
  if (state == State::kEnded) return;
  state = State::kEnded;
  endReason = std::move(reason);
  if (connection != 0) transport->Disconnect(connection);
}

void Client::Implementation::EndIfSilent() {
  if (state == State::kEnded) return;
  double patience = protocol::kSilenceTimeout;
  if (state == State::kJoining) patience += protocol::FindJoinPatience(transport->ReadRoundTrip(connection));
  if (now - lastReceived < patience) return;
  const auto seconds = static_cast<int>(patience);
  End(state == State::kConnecting ? "no answer from the server"
                                  : "server silent for " + std::to_string(seconds) + " s");
}

void Client::Implementation::EndIfPoor() {
  if (state == State::kEnded || now - windowBegin < kPoorLinkWindow) return;
  const std::uint32_t sent = received.Newest() - windowNewest;
  const std::uint64_t arrived = statistics.snapshots - windowArrived;
  windowBegin = now;
  windowNewest = received.Newest();
  windowArrived = statistics.snapshots;
  if (sent < kPoorLinkPackets || static_cast<double>(arrived) >= kPoorLinkShare * sent) return;
  End("connection too poor: " + std::to_string(sent - arrived) + " of the last " + std::to_string(sent) +
      " packets were lost");
}

void Client::Implementation::SayHello() {
  const auto role = options.spectator ? wire::Role::Spectator : wire::Role::Player;
  const auto hello = protocol::MakeHello(options.name, role, options.protocolVersion);
  const auto sent = transport->Send(connection, transport::Channel::kControl, hello);
  if (sent != transport::SendResult::kQueued) End("connection lost");
}

void Client::Implementation::StartPlayingWhenComplete() {
  if (state != State::kJoining || !welcomed || !blueprints.Complete() || !grounds.Complete()) return;
  state = State::kPlaying;
  statistics.joinSeconds = now - startedAt;
}

void Client::Implementation::HandleControl(std::span<const std::uint8_t> bytes) {
  const wire::ServerMessage* message = nullptr;
  if (protocol::ParseServerMessage(bytes, message) != protocol::ParseResult::kOk) {
    ++statistics.badMessages;
    return;
  }
  bool inPlace = true;
  if (const auto* goodbye = message->body_as_Goodbye()) {
    End(leaving ? "left" : DescribeGoodbye(*goodbye));
  } else if (const auto* fields = message->body_as_Welcome()) {
    inPlace = HandleWelcome(*fields);
  } else if (const auto* chunk = message->body_as_BlueprintChunk()) {
    inPlace = blueprints.AddChunk(*chunk);
  } else if (const auto* rows = message->body_as_HeightRows()) {
    inPlace = grounds.AddRows(*rows);
  } else if (const auto* event = message->body_as_Event()) {
    HandleEvent(*event);
  } else if (const auto* notice = message->body_as_Notice()) {
    if (onNotice) onNotice(MakeLine(*notice->text()));
  } else {
    inPlace = welcomed && news.Take(*message);
  }
  if (!inPlace) ++statistics.badMessages;
  StartPlayingWhenComplete();
}

bool Client::Implementation::HandleWelcome(const wire::Welcome& message) {
  if (welcomed) return false;
  welcomed = true;
  welcome.clientId = message.client_id();
  welcome.ownBody = message.own_body();
  welcome.tick = message.tick();
  welcome.tickHz = message.tick_hz();
  welcome.snapshotHz = message.snapshot_hz();
  welcome.scene = message.scene()->str();
  welcome.blueprintCount = message.blueprint_count();
  welcome.obstacles.reserve(message.obstacles()->size());
  for (const wire::Obstacle* obstacle : *message.obstacles()) welcome.obstacles.push_back(*obstacle);
  for (const wire::HeightField* field : *message.height_fields()) welcome.heightFields.push_back(*field);
  welcome.hands = message.hands();
  welcome.reach = message.reach();
  welcome.game = message.game()->str();
  welcome.workshop = message.workshop();
  grounds.Expect(welcome.heightFields);
  blueprints.Expect(welcome.blueprintCount);

  tickSeconds = 1.0 / welcome.tickHz;
  snapshotSeconds = 1.0 / welcome.snapshotHz;
  statistics.snapshotInterval = snapshotSeconds;
  clock.AddArrival(TimeOf(welcome.tick), 1.0, now);  // a first idea of the time, for the inputs' stamps
  nextInput = now;
  return true;
}

void Client::Implementation::HandleEvent(const wire::Event& message) {
  if (message.kind() == wire::EventKind::BodyRemoved) {
    bodies.Remove(message.body(), message.tick());
    newestPoses.Remove(message.body(), message.tick());
  } else if (message.kind() == wire::EventKind::Respawn) {
    newestPoses.NoteRespawn(message.body(), message.tick());
  }
  if (onEvent) onEvent({message.kind(), message.client_id(), message.body(), message.name()->str()});
}

void Client::Implementation::HandleSnapshot(std::span<const std::uint8_t> bytes) {
  protocol::SnapshotHead head;
  if (protocol::ReadSnapshot(bytes, head, records) != protocol::SnapshotResult::kOk) {
    ++statistics.badSnapshots;
    return;
  }
  if (received.Record(head.sequence) != protocol::ReceivedWindow::Arrival::kNew) {
    ++statistics.duplicates;
    return;
  }
  ++statistics.snapshots;
  statistics.records += records.size();
  const unsigned known = std::min(received.Newest() - 1, protocol::kAckHistory);
  const auto arrived = static_cast<unsigned>(std::popcount(received.History()));
  statistics.lossShare = known == 0 ? 0.0 : std::max(0.0, 1.0 - static_cast<double>(arrived) / known);
  if (!welcomed) {  // overtook it: without tick rate and blueprints there is nothing to be made of it
    statistics.unknownRecords += records.size();
    return;
  }
  MeasureSnapshot(head);
  for (const protocol::Record& record : records) HandleRecord(record, head.tick);
}

void Client::Implementation::MeasureSnapshot(const protocol::SnapshotHead& head) {
  const double time = TimeOf(head.tick);
  clock.AddArrival(time, head.timeRatio, now);
  if (hasSnapshot && head.tick > newestTick) {
    const double interval = std::min(TimeOf(head.tick - newestTick), kMaxIntervalRatio * snapshotSeconds);
    statistics.snapshotInterval += (interval - statistics.snapshotInterval) * kIntervalSmoothing;
  }
  if (!hasSnapshot || head.tick > newestTick) {
    newestTick = head.tick;
    statistics.timeRatio = static_cast<double>(head.timeRatio);
  }
  hasSnapshot = true;
  const double behind = clock.ServerTime(now) - time;
  jitter.AddArrival(behind, std::max(statistics.snapshotInterval, snapshotSeconds), now);

  SnapshotArrival arrival;
  arrival.tick = head.tick;
  arrival.inputToSnapshot = MeasureInput(head.inputTick);
  arrival.age = clock.Lateness() + std::max(0.0, (smallestInputToSnapshot - tickSeconds) / 2);
  statistics.snapshotAge = arrival.age;
  if (onSnapshot) onSnapshot(arrival);
}

double Client::Implementation::MeasureInput(std::uint32_t inputTick) {
  const double seconds = inputs.MeasureEcho(inputTick, now);
  if (seconds < 0) return seconds;
  statistics.inputToSnapshot = seconds;
  if (smallestInputToSnapshot < 0 || seconds < smallestInputToSnapshot) smallestInputToSnapshot = seconds;
  return seconds;
}

void Client::Implementation::HandleRecord(const protocol::Record& record, std::uint32_t tick) {
  const std::shared_ptr<const Blueprint> blueprint = blueprints.Find(record.head.blueprint, record.head.generation);
  if (blueprint == nullptr) {
    ++statistics.unknownRecords;
    return;
  }
  protocol::QuantisedPose pose;
  const bool isGood = protocol::PatchSize(blueprint->rest.size(), record.head.patch) > 0 &&
                      (!options.decode || DecodeRecord(record, blueprint, tick)) &&
                      protocol::DecodePose(record.payload, blueprint->size, pose) == protocol::DecodeResult::kOk;
  if (!isGood) {
    ++statistics.badRecords;
  } else if (record.head.patch == 0) {
    newestPoses.Add(record.head.body, tick, record.head.restTick != 0, pose);
  }
}

bool Client::Implementation::DecodeRecord(const protocol::Record& record,
                                          const std::shared_ptr<const Blueprint>& blueprint, std::uint32_t tick) {
  const std::size_t size = protocol::PatchSize(blueprint->rest.size(), record.head.patch);
  const auto rest = std::span(blueprint->rest).subspan(record.head.patch * protocol::kMaxPatchVertices, size);
  protocol::Pose pose;
  shape.resize(size);
  const protocol::Basis* basis = blueprint->bases.empty() ? nullptr : blueprint->bases[record.head.patch].get();
  const protocol::PatchModel model{rest, blueprint->size, basis, welcome.obstacles};
  if (decoder.Decode(model, record.payload, pose, shape) != protocol::DecodeResult::kOk) return false;
  if (onDecoded) onDecoded({record.head.body, tick, pose, shape});
  return bodies.Add(record.head, blueprint, tick, TimeOf(record.head.restTick != 0 ? record.head.restTick : tick), pose,
                    shape, jitter.Playback());
}

void Client::Implementation::SendDueInputs() {
  for (int sent = 0; sent < kMaxCatchUp && now >= nextInput; ++sent) {
    inputs.Add(input, clock.ServerTime(now) * welcome.tickHz, now);
    SendInput();
    nextInput += tickSeconds;
  }
  if (now >= nextInput) nextInput = now + tickSeconds;
}

void Client::Implementation::SendInput() {
  const auto message = protocol::MakeInput(inputs.Frames(), received.Newest(), received.History(),
                                           hand ? &*hand : nullptr, static_cast<std::uint32_t>(statistics.stalls));
  const auto sent = transport->Send(connection, transport::Channel::kInput, message);
  if (sent == transport::SendResult::kQueued) ++statistics.inputsSent;
}

void Client::Implementation::Ask(const protocol::Message& message) {
  // A link on which nothing can be sent any more ends by itself.
  if (state == State::kPlaying) static_cast<void>(transport->Send(connection, transport::Channel::kControl, message));
}

void Client::Implementation::MoveOn(double to) {
  if (!hasSnapshot) return;
  jitter.Advance(clock.ServerTime(to), clock.TimeRatio(), to);
  if (to < nextForget) return;
  nextForget = to + kForgetEvery;
  bodies.Forget(TimeOf(newestTick) - kForgetAfter);
  const auto kept = static_cast<std::uint32_t>(kForgetAfter * welcome.tickHz);
  if (newestTick > kept) newestPoses.Forget(newestTick - kept);
}

}  // namespace wobble::client
