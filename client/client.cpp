// One connection from hello to goodbye. Update is Poll → take in → send what is due → move the shown moment on.
//
// Everything that comes in is untrusted: it is verified, counted when it is wrong and dropped whole, and the memory
// that it can make the client use is bounded (blueprint_store.h, bodies.h). A message that is out of place is treated
// like a broken one.
//
// An input goes out every tick, also without any key pressed and from spectators: it carries the acknowledgement of
// snapshots and shows the server that the client is there.
#include "client/client.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "client/blueprint_store.h"
#include "client/clearance.h"
#include "client/grounds.h"
#include "client/input_stream.h"
#include "client/news.h"
#include "client/own_body.h"
#include "client/snapshot_receiver.h"
#include "client/timing/link_judge.h"
#include "client/world_time.h"
#include "protocol/text.h"

namespace wobble::client {
namespace {

// A goodbye of ours may take so many seconds plus so many round trips until the link counts as closed. That allows a
// few tries: a server that never receives it keeps the body until the silence is too long. A round trip counts for
// kMaxLeaveRoundTrip, seconds, at most, whatever the link claims.
constexpr double kLeaveTimeout = 1;
constexpr double kLeaveRoundTrips = 4;
constexpr double kMaxLeaveRoundTrip = 1;
static_assert(kLeaveTimeout + kLeaveRoundTrips * kMaxLeaveRoundTrip == kLongestLeave);
// The most inputs sent in one Update; after a longer pause the schedule starts anew.
constexpr int kMaxCatchUp = 3;
// Seconds by which an input's stamp may be ahead of the newest snapshot: a few snapshots that are lost or late.
constexpr double kLongestStampLead = 0.2;
// Paces from here on count as 1: a late tick now and then is no slower world.
constexpr double kOnPace = 0.97;

std::string DescribeGoodbye(const wire::Goodbye& goodbye) {
  const std::string_view detail = goodbye.detail() == nullptr ? "" : goodbye.detail()->string_view();
  return protocol::DescribeGoodbye(goodbye.reason(), protocol::MakeLine(detail, protocol::kMaxShownBytes));
}

// Whether who was told this goodbye may come in the next time, though it has done nothing else.
bool IsPassing(wire::GoodbyeReason reason) {
  switch (reason) {
    case wire::GoodbyeReason::ServerClosing:  // mostly to be started again
    case wire::GoodbyeReason::ServerFull:
    case wire::GoodbyeReason::Busy:
    case wire::GoodbyeReason::TooManyFromAddress:  // the lost connection may still count
    case wire::GoodbyeReason::NoHello:
    case wire::GoodbyeReason::Silent:
      return true;
    default:
      return false;
  }
}

}  // namespace

struct Client::Implementation {
  Implementation(std::unique_ptr<transport::Transport> from, Options chosen, double start)
      : transport(std::move(from)),
        options(std::move(chosen)),
        startedAt(start),
        now(start),
        link(start),
        blueprints(options.decode, options.kept),
        snapshots(options, blueprints, time, statistics) {}

  // The connection.
  std::unique_ptr<transport::Transport> transport;
  Options options;
  transport::ConnectionId connection = 0;
  State state = State::kConnecting;
  std::string endReason;
  bool mayRejoin = false;  // once it has ended
  bool wasSentAway = false;
  bool leaving = false;
  double leaveDeadline = 0;
  double startedAt = 0;
  double now = 0;  // of the latest Update or Sample
  LinkJudge link;

  // The state that the server has sent.
  bool welcomed = false;
  bool isFirstScene = true;
  protocol::WelcomeFields welcome;
  client::Grounds grounds;
  BlueprintStore blueprints;
  std::size_t workLeft = 0;  // of this Update, for bases
  News news;
  WorldTime time;
  Statistics statistics;
  SnapshotReceiver snapshots;

  // The player's input.
  Input input;
  std::optional<wire::Hand> hand;
  std::uint16_t grips = 0;  // made so far
  InputStream inputs;
  double nextInput = 0;
  OwnBody ownBody;

  // The handlers; any may be empty.
  std::function<void(const Event&)> onEvent;
  std::function<void(const SnapshotArrival&)> onSnapshot;
  std::function<void(const std::string&)> onNotice;
  std::function<void(const std::string&)> onNextScene;
  std::function<void(const DecodedPatch&)> onDecoded;

  void TakeIn(const transport::Event& event);
  void End(std::string reason, bool mayComeBack = false);
  void EndIfLinkFails();
  void SayHello();
  void StartPlayingWhenComplete();

  void HandleControl(std::span<const std::uint8_t> bytes);
  void CompleteBlueprints();
  [[nodiscard]] bool HandleWelcome(const wire::Welcome& message);
  [[nodiscard]] bool HandleNextScene(const wire::NextScene& message);
  void HandleEvent(const wire::Event& message);
  void HandleSnapshot(std::span<const std::uint8_t> bytes);

  [[nodiscard]] double EstimateTick() const;
  void SendDueInputs();
  void SendInput();
  [[nodiscard]] bool Predicts() const;
  void NoteInput();
  void LeadOwnBody(std::span<BodySample> samples);
  void Ask(const protocol::Message& message);
  void MoveOn(double to);
};

Client::Client(std::unique_ptr<transport::Transport> transport, Options options, double now)
    : m(std::make_unique<Implementation>(std::move(transport), std::move(options), now)) {
  assert(m->transport != nullptr && m->options.name.size() <= protocol::kMaxNameBytes);
}

Client::~Client() = default;

void Client::Update(double now) {
  assert(now >= m->now);
  m->now = std::max(now, m->now);
  m->workLeft = m->options.completionWork;
  m->transport->Poll(m->now, [this](const transport::Event& event) { m->TakeIn(event); });
  if (m->leaving && m->now >= m->leaveDeadline) m->End("left");
  m->EndIfLinkFails();
  if (m->state != State::kEnded) {
    m->CompleteBlueprints();
    m->NoteInput();
    if (m->welcomed && !m->leaving) m->SendDueInputs();
    m->MoveOn(m->now);
  }
  m->transport->Flush();
}

void Client::SetInput(const Input& input) { m->input = input; }

void Client::SetPredicts(bool predicts) {
  if (m->options.predict != predicts) m->ownBody.Forget();
  m->options.predict = predicts;
}

void Client::SetHand(const std::optional<Hand>& hand) {
  if (!hand) {
    m->hand.reset();
    return;
  }
  const bool isSame = m->hand && m->hand->body() == hand->body && m->hand->vertex() == hand->vertex;
  if (!isSame && ++m->grips == 0) m->grips = 1;  // 0 means an empty hand
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
void Client::Order(const std::string& line) {
  m->Ask(protocol::MakeOrder(std::string_view(line).substr(0, protocol::kMaxOrderBytes)));
}
void Client::Say(const std::string& text) {
  m->Ask(protocol::MakeSay(protocol::MakeLine(text, protocol::kMaxSaidBytes)));
}
void Client::Emote(wire::EmoteKind kind) { m->Ask(protocol::MakeEmote(kind)); }
void Client::Rename(const std::string& name) {
  m->options.name = protocol::MakeLine(name, protocol::kMaxNameBytes);
  m->Ask(protocol::MakeRename(m->options.name));
}
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
  // The result makes no difference: the link is closed either way.
  static_cast<void>(m->transport->Send(m->connection, transport::Channel::kControl, goodbye));
  m->transport->Disconnect(m->connection);
  m->transport->Flush();
}

State Client::ReadState() const { return m->state; }
const std::string& Client::EndReason() const { return m->endReason; }
bool Client::EndedUnasked() const { return m->state == State::kEnded && !m->leaving; }
bool Client::WasSentAway() const { return m->wasSentAway; }
bool Client::MayRejoin() const { return m->mayRejoin; }
bool Client::IsCompleting() const { return m->state != State::kEnded && m->blueprints.IsCompleting(); }
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
double Client::ServerTime(double now) const { return m->time.HasSnapshot() ? m->time.ServerTime(now) : 0.0; }
double Client::InterpolationDelay() const { return m->time.Delay(); }
void Client::OnEvent(std::function<void(const Event&)> handler) { m->onEvent = std::move(handler); }
void Client::OnNextScene(std::function<void(const std::string&)> handler) { m->onNextScene = std::move(handler); }
void Client::OnNotice(std::function<void(const std::string&)> handler) { m->onNotice = std::move(handler); }
void Client::OnDecoded(std::function<void(const DecodedPatch&)> handler) { m->onDecoded = std::move(handler); }
void Client::OnSnapshot(std::function<void(const SnapshotArrival&)> handler) { m->onSnapshot = std::move(handler); }

void Client::Sample(double now, Detail detail, std::vector<BodySample>& samples) {
  m->now = std::max(now, m->now);
  m->MoveOn(m->now);
  m->NoteInput();
  m->snapshots.Sample(detail, samples);
  if (m->Predicts()) m->LeadOwnBody(samples);
}

std::optional<protocol::Pose> Client::NewestPose(std::uint32_t body) const { return m->snapshots.Poses().Find(body); }

std::optional<std::uint16_t> Client::FindVertex(std::uint32_t body, const protocol::Vector3& place) const {
  const auto pose = NewestPose(body);
  const auto form = m->snapshots.Poses().FindForm(body);
  const auto blueprint = form ? m->blueprints.Find(form->blueprint, form->generation) : nullptr;
  if (!pose || blueprint == nullptr) return std::nullopt;
  const protocol::Vector3 local = protocol::Rotate(protocol::Conjugate(pose->rotation), place - pose->centroid);
  std::uint16_t nearest = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < blueprint->rest.size(); ++i) {
    const float distance = protocol::Length(blueprint->rest[i] - local);
    if (distance < least) least = distance, nearest = static_cast<std::uint16_t>(i);
  }
  return nearest;
}

std::optional<Sighting> Client::FindSighting(std::uint32_t body) const {
  return m->snapshots.Poses().FindSighting(body, m->time.TickSeconds(), m->time.NewestTick());
}

void Client::ListSightings(std::vector<Sighting>& sightings) const {
  m->snapshots.Poses().List(m->time.TickSeconds(), m->time.NewestTick(), sightings);
}

void Client::Implementation::TakeIn(const transport::Event& event) {
  if (state == State::kEnded) return;
  switch (event.kind) {
    case transport::Event::Kind::kConnected:
      if (connection != 0) return;
      connection = event.connection;
      link.NoteArrival(now);
      state = State::kJoining;
      SayHello();
      return;
    case transport::Event::Kind::kDisconnected:
      if (leaving) return End("left");
      if (!event.reason.empty()) return End(std::string(event.reason), !event.isFinal);
      return End(state == State::kConnecting ? "no answer from the server" : "connection lost", !event.isFinal);
    case transport::Event::Kind::kOffence:
      return;
    case transport::Event::Kind::kMessage:
      break;
  }
  if (state == State::kConnecting) return;
  link.NoteArrival(now);
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
      return;  // clients send on this channel
  }
}

void Client::Implementation::End(std::string reason, bool mayComeBack) {
  if (state == State::kEnded) return;
  state = State::kEnded;
  mayRejoin = mayComeBack && !leaving;
  endReason = std::move(reason);
  if (connection != 0) transport->Disconnect(connection);
}

void Client::Implementation::EndIfLinkFails() {
  if (state == State::kEnded) return;
  double patience = protocol::kSilenceTimeout;
  if (state == State::kJoining) patience += protocol::FindJoinPatience(transport->ReadRoundTrip(connection));
  if (link.IsSilent(now, patience)) {
    const auto seconds = static_cast<int>(patience);
    return End(state == State::kConnecting ? "no answer from the server"
                                           : "server silent for " + std::to_string(seconds) + " s",
               true);
  }
  const auto loss = link.FindHeavyLoss(snapshots.Received().Newest(), statistics.snapshots, now);
  if (loss) {
    End("connection too poor: " + std::to_string(loss->lost) + " of the last " + std::to_string(loss->sent) +
        " packets were lost");
  }
}

void Client::Implementation::SayHello() {
  const auto role = options.spectator ? wire::Role::Spectator : wire::Role::Player;
  const auto hello = protocol::MakeHello(options.name, role, blueprints.KeptHashes(), options.protocolVersion,
                                         protocol::kSchemaHash, options.isBot);
  const auto sent = transport->Send(connection, transport::Channel::kControl, hello);
  if (sent != transport::SendResult::kQueued) End("connection lost", true);
}

void Client::Implementation::StartPlayingWhenComplete() {
  if (state != State::kJoining || !welcomed || !grounds.Complete()) return;
  if (welcome.blueprintCount > 0 && !blueprints.Has(welcome.ownBlueprint)) return;
  state = State::kPlaying;
  statistics.joinSeconds = now - startedAt;
  time.BeginPlay(now);
}

void Client::Implementation::HandleControl(std::span<const std::uint8_t> bytes) {
  const wire::ServerMessage* message = nullptr;
  if (protocol::ParseServerMessage(bytes, message) != protocol::ParseResult::kOk) {
    ++statistics.badMessages;
    return;
  }
  bool inPlace = true;
  if (const auto* goodbye = message->body_as_Goodbye()) {
    const wire::GoodbyeReason reason = goodbye->reason();
    wasSentAway = !leaving && (reason == wire::GoodbyeReason::Kicked || reason == wire::GoodbyeReason::Banned);
    End(leaving ? "left" : DescribeGoodbye(*goodbye), IsPassing(reason));
  } else if (const auto* fields = message->body_as_Welcome()) {
    inPlace = HandleWelcome(*fields);
  } else if (const auto* next = message->body_as_NextScene()) {
    inPlace = HandleNextScene(*next);
  } else if (const auto* chunk = message->body_as_BlueprintChunk()) {
    inPlace = blueprints.AddChunk(*chunk);
    CompleteBlueprints();  // at once, if there is time: the next message may need it
  } else if (const auto* rows = message->body_as_HeightRows()) {
    if (welcomed) blueprints.CountOther(2 * rows->heights()->size());
    inPlace = grounds.AddRows(*rows);
  } else if (const auto* event = message->body_as_Event()) {
    HandleEvent(*event);
  } else if (const auto* notice = message->body_as_Notice()) {
    if (onNotice) onNotice(protocol::MakeLine(notice->text()->string_view(), protocol::kMaxNoticeBytes));
  } else {
    inPlace = welcomed && news.Take(*message);
  }
  if (!inPlace) ++statistics.badMessages;
}

void Client::Implementation::CompleteBlueprints() {
  statistics.badMessages +=
      blueprints.Complete(workLeft, [this](std::uint64_t hash, std::span<const std::uint8_t> bytes) {
        if (bytes.size() > protocol::kBlueprintChunkBytes && options.keep) options.keep(hash, bytes);
      });
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
  welcome.scene = protocol::MakeLine(message.scene()->string_view(), protocol::kMaxShownBytes);
  welcome.blueprintCount = message.blueprint_count();
  welcome.obstacles.clear();
  welcome.heightFields.clear();
  welcome.obstacles.reserve(message.obstacles()->size());
  for (const wire::Obstacle* obstacle : *message.obstacles()) welcome.obstacles.push_back(*obstacle);
  for (const wire::HeightField* field : *message.height_fields()) welcome.heightFields.push_back(*field);
  welcome.hands = message.hands();
  welcome.reach = message.reach();
  welcome.game = protocol::MakeLine(message.game()->string_view(), protocol::kMaxNameBytes);
  welcome.workshop = message.workshop();
  welcome.ownBlueprint = message.own_blueprint();
  welcome.rank = message.rank();
  if (message.drive() != nullptr) welcome.drive = *message.drive();
  welcome.description = protocol::MakeLine(message.description() == nullptr ? "" : message.description()->string_view(),
                                           protocol::kMaxDescriptionBytes);
  welcome.talk = message.talk();
  grounds.Expect(welcome.heightFields);
  blueprints.Expect(welcome.blueprintCount);

  time.Start(welcome, now, statistics);
  nextInput = now;
  return true;
}

// The clock goes on, as ticks do. While the client is leaving it says no hello.
bool Client::Implementation::HandleNextScene(const wire::NextScene& message) {
  if (!welcomed) return false;
  welcomed = false;
  isFirstScene = false;
  state = State::kJoining;
  startedAt = now;
  welcome = {};
  grounds = {};
  news = {};
  hand.reset();
  blueprints.ForgetScene();
  snapshots.ForgetScene();
  ownBody.Forget();
  if (!leaving) SayHello();
  if (onNextScene) onNextScene(protocol::MakeLine(message.scene()->string_view(), protocol::kMaxShownBytes));
  return true;
}

void Client::Implementation::HandleEvent(const wire::Event& message) {
  if (message.kind() == wire::EventKind::BodyRemoved) {
    snapshots.Remove(message.body(), message.tick());
  } else if (message.kind() == wire::EventKind::Respawn) {
    snapshots.NoteRespawn(message.body(), message.tick());
  }
  if (!onEvent) return;
  onEvent({.kind = message.kind(),
           .clientId = message.client_id(),
           .body = message.body(),
           .name = protocol::MakeLine(message.name()->string_view(), protocol::kMaxSaidBytes),
           .emote = message.emote()});
}

void Client::Implementation::HandleSnapshot(std::span<const std::uint8_t> bytes) {
  const auto head = snapshots.Open(bytes);
  if (!head) return;
  // Of the scene before: it has come late.
  if (!isFirstScene && (!welcomed || head->tick <= welcome.tick)) return;
  // A packet that overtook the welcome says nothing: there is no tick rate yet. Its records count as unknown, since
  // there is no blueprint either.
  if (welcomed) {
    const double inputToSnapshot = inputs.MeasureEcho(head->inputTick, now);
    // It acts from the beginning of the tick.
    const double lag = time.TimeOf(head->tick) - time.TimeOf(head->inputTick) - time.TickSeconds();
    if (head->inputTick != 0) statistics.inputLag = ownBody.NoteLag(lag);
    const SnapshotArrival arrival = time.AddSnapshot(*head, inputToSnapshot, now, statistics);
    if (onSnapshot) onSnapshot(arrival);
  }
  snapshots.TakeRecords(head->tick, welcome.obstacles, onDecoded);
}

// The clock believes for seconds after a pause of the server that the world has gone on. Inputs stamped by it would be
// refused as too far ahead, so a stamp is never far from the newest tick that is known.
double Client::Implementation::EstimateTick() const {
  const double estimated = time.ServerTime(now) * welcome.tickHz;
  return time.HasSnapshot() ? std::min(estimated, time.NewestTick() + kLongestStampLead * welcome.tickHz) : estimated;
}

void Client::Implementation::SendDueInputs() {
  for (int sent = 0; sent < kMaxCatchUp && now >= nextInput; ++sent) {
    inputs.Add(input, EstimateTick(), now);
    SendInput();
    nextInput += time.TickSeconds();
  }
  if (now >= nextInput) nextInput = now + time.TickSeconds();
}

void Client::Implementation::SendInput() {
  const auto message = protocol::MakeInput({.frames = inputs.Frames(),
                                            .ackedSequence = snapshots.Received().Newest(),
                                            .ackedHistory = snapshots.Received().History(),
                                            .hand = hand ? &*hand : nullptr,
                                            .stalls = static_cast<std::uint32_t>(statistics.stalls),
                                            .downloaded = blueprints.CountTaken()});
  const auto sent = transport->Send(connection, transport::Channel::kInput, message);
  if (sent == transport::SendResult::kQueued) ++statistics.inputsSent;
}

bool Client::Implementation::Predicts() const {
  return options.predict && state == State::kPlaying && welcome.ownBody != 0 && welcome.drive.speed() > 0;
}

void Client::Implementation::NoteInput() {
  if (!Predicts()) return;
  const Track* track = snapshots.FindTrack(welcome.ownBody);
  const bool isBorne = track != nullptr && IsBorne(*track, news.tuning.gravity.z);
  ownBody.NoteInput(welcome.drive, input, time.ServerTime(now), isBorne);
}

void Client::Implementation::LeadOwnBody(std::span<BodySample> samples) {
  const auto own = std::lower_bound(samples.begin(), samples.end(), welcome.ownBody,
                                    [](const BodySample& sample, std::uint32_t body) { return sample.body < body; });
  const Track* track = snapshots.FindTrack(welcome.ownBody);
  if (own == samples.end() || own->body != welcome.ownBody || track == nullptr) return;
  const Surroundings surroundings{.obstacles = welcome.obstacles,
                                  .grounds = grounds.All(),
                                  .bodies = samples,
                                  .own = welcome.ownBody,
                                  .size = own->blueprint->size};
  const OwnBody::Base base = FindBase(*track, time.Playback(), news.tuning.gravity.z);
  const protocol::Vector3 wanted = ownBody.Follow(welcome.drive, base, time.ServerTime(now), news.tuning.gravity.z);
  const protocol::Vector3 lead = ownBody.GiveWay(ClearLead(surroundings, base.centroid, wanted));
  own->lead = lead;
  own->pose.centroid = own->pose.centroid + lead;
  for (protocol::Vector3& vertex : own->vertices) vertex = vertex + lead;
}

void Client::Implementation::Ask(const protocol::Message& message) {
  // The result is ignored: a link on which nothing can be sent ends by itself.
  if (state == State::kPlaying) static_cast<void>(transport->Send(connection, transport::Channel::kControl, message));
}

void Client::Implementation::MoveOn(double to) {
  if (!time.HasSnapshot()) return;
  time.Advance(to);
  snapshots.Forget(to);
}

}  // namespace wobble::client
