#include "client/gateway/browser_websocket.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "protocol/transport/vestibule/keys.h"

namespace wobble::gateway {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
// Seconds from the server's answer to the hello. The server itself waits a little less long.
constexpr double kHelloTimeout = protocol::kHelloTimeout + 2;
// Seconds in which a browser must take the messages that wait for it and answer the close.
constexpr double kCloseTimeout = 3;

// Close codes of our own (4000 to 4999 are free for that), by which the page knows that another try is in vain, or
// needs a password, invite or token.
constexpr auto kRefusedForGood = static_cast<websocket::close_code>(4000);
constexpr auto kCredentialRefused = static_cast<websocket::close_code>(4001);

websocket::close_code FindCloseCode(const ServerLink& ended) {
  using transport::vestibule::Refusal;
  const Refusal refusal = ended.ReadRefusal();
  if (refusal == Refusal::kBadCredential) return kCredentialRefused;
  // The other connections of an address last; to ask every few seconds would not help.
  if (ended.IsFinal() || refusal == Refusal::kTooManyFromAddress) return kRefusedForGood;
  return ended.IsConnected() ? websocket::close_code::normal : websocket::close_code::try_again_later;
}

}  // namespace

void Browser::Start() {
  m_stream.set_option(websocket::stream_base::timeout{kHandshakeTimeout, kIdleTimeout, true});
  m_stream.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(http::field::sec_websocket_protocol, MakeSubprotocol());
  }));
  // Well above the limit that Judge applies: Beast closes so abruptly over its own that browsers miss the reason.
  m_stream.read_message_max(16 * kMaxBrowserMessageBytes);
  m_stream.binary(true);
  m_stream.auto_fragment(false);
  // Beast answers pings; they count like messages. Nothing may be closed inside this callback.
  m_stream.control_callback([this](websocket::frame_type, beast::string_view text) { NoteControl(text.size()); });
  m_stream.async_accept(m_request, [self = shared_from_this()](error_code error) { self->OnAccepted(error); });
}

void Browser::NoteControl(std::size_t bytes) {
  if (!m_rate.Allow(bytes, command::ReadClock())) m_hasFlooded = true;
}

void Browser::OnAccepted(error_code error) {
  if (IsOver()) return;
  if (error) return End(error.message());
  m_state = m_farewell ? State::kLeaving : m_film == nullptr ? State::kJoining : State::kPreparing;
  if (m_farewell) return Write();
  m_request = {};  // it has the credential in plain text
  if (!m_shared.players.HasRoom(m_guest.address)) return RefuseSeat();
  if (m_state == State::kJoining) Resolve();
}

void Browser::TurnFilm() {
  switch (m_film->ReadState()) {
    case Film::State::kStarting:
      return;
    case Film::State::kShown:
      m_state = State::kJoining;
      return Resolve();
    case Film::State::kOver:
      return Close(kRefusedForGood, m_film->Reason(), Waiting::kDiscard);
  }
}

void Browser::Resolve() {
  // Resolved anew for each browser: a server may have moved since the gateway began.
  m_resolver.async_resolve(m_world.server.host, std::to_string(m_world.server.port),
                           [self = shared_from_this()](error_code failure, const udp::resolver::results_type& results) {
                             self->OnResolved(failure, results);
                           });
}

void Browser::OnResolved(error_code error, const udp::resolver::results_type& results) {
  if (m_state != State::kJoining) return;
  std::string reason = "the server's name is not known";
  if (!error && !results.empty()) {
    // Of both kinds IPv4: a server that listens at one address of this machine most often has 127.0.0.1.
    const auto isIpv4 = [](const auto& each) { return each.endpoint().address().is_v4(); };
    const auto found = std::find_if(results.begin(), results.end(), isIpv4);
    const auto& chosen = found == results.end() ? *results.begin() : *found;
    m_link = ServerLink::Open(chosen.endpoint().address().to_string(), m_world.server.port,
                              {.credential = std::move(m_credential)}, reason);
  }
  if (m_link == nullptr) Close(websocket::close_code::try_again_later, reason, Waiting::kDiscard);
}

void Browser::Turn(double now) {
  if (m_link != nullptr) TurnLink(now);
  if (m_state == State::kPreparing) TurnFilm();
  if (m_state == State::kGreeting && now >= m_helloBy) CutOff(websocket::close_code::policy_error, "no hello");
  if (m_hasFlooded) CutOff(websocket::close_code::policy_error, "too many messages");
  if (m_outbox.IsOverfull()) CutOff(websocket::close_code::policy_error, "reads too slowly");
  m_outbox.DropLate(now);
  Spread();
  Write();
  if (m_farewell && now >= m_closeBy) End("");
}

void Browser::TurnLink(double now) {
  m_link->Poll(now, m_outbox);
  if (m_link->HasEnded()) {
    if (IsGatewayRefused(now))
      return Close(kRefusedForGood, "the server does not know this gateway", Waiting::kDeliver);
    Close(FindCloseCode(*m_link), m_link->EndReason(), Waiting::kDeliver);
  } else if (m_state == State::kJoining && m_link->IsConnected()) {
    TakeSeat(now);
  }
}

// Whether the server refuses the gateway itself; the host is told so, and where it may be so.
bool Browser::IsGatewayRefused(double now) {
  const bool isRefused = m_link->ReadRefusal() == transport::vestibule::Refusal::kBadCredential;
  if (!m_shared.options.gatewayKey || !isRefused || m_film != nullptr) return false;
  using Cause = KeyDoubts::Cause;
  const bool isCertain = m_showsNothing && !m_link->ServerWantsCredential();
  const std::string line =
      m_shared.keyDoubts.NoteRefused(m_world.name, isCertain ? Cause::kGateway : Cause::kPerhapsBrowser, now);
  if (!line.empty()) std::fprintf(stderr, "wobble gateway: %s\n", line.c_str());
  return isCertain;
}

// Only now: those whom the server refuses keep no place from others.
void Browser::TakeSeat(double now) {
  if (m_film == nullptr) m_shared.keyDoubts.NoteLetIn(m_world.name);
  m_seat = m_shared.players.Take(m_guest.address);
  if (m_seat == nullptr) return RefuseSeat();
  std::fprintf(stderr, "browser %llu: %s plays%s%s, %zu of %zu\n", static_cast<unsigned long long>(m_number),
               m_guest.address.c_str(), m_world.name.empty() ? "" : " ", m_world.name.c_str(),
               m_shared.players.CountTaken(), m_shared.options.maxConnections);
  m_state = State::kGreeting;
  m_helloBy = now + kHelloTimeout;
  Read();
}

void Browser::RefuseSeat() {
  ++m_shared.counts.browsersRefused;
  Close(websocket::close_code::try_again_later, "all places are taken", Waiting::kDiscard);
}

void Browser::Read() {
  m_stream.async_read(m_incoming, [self = shared_from_this()](error_code error, std::size_t) { self->OnRead(error); });
}

void Browser::OnRead(error_code error) {
  if (error == websocket::error::message_too_big) {
    ++m_shared.counts.browsersCutOff;
    return End("too large a message");  // Beast has closed with 1009
  }
  if (error) return End(DescribeEnd(error));
  if (IsHeard()) Judge({static_cast<const std::uint8_t*>(m_incoming.cdata().data()), m_incoming.size()});
  m_incoming.consume(m_incoming.size());
  if (IsHeard()) Read();
}

void Browser::Judge(std::span<const std::uint8_t> message) {
  m_shared.counts.bytesUp += message.size();
  if (!m_stream.got_binary()) return CutOff(websocket::close_code::unknown_data, "text is not understood");
  if (!m_rate.Allow(message.size(), command::ReadClock())) {
    return CutOff(websocket::close_code::policy_error, "too many messages");
  }
  switch (m_link->Take(message, m_outbox)) {
    case ServerLink::Verdict::kGood:
      break;  // the server judges whether it is a hello
    case ServerLink::Verdict::kTooLarge:
      return CutOff(websocket::close_code::too_big, "too large a message for its channel");
    case ServerLink::Verdict::kNotUnderstood:
      return CutOff(websocket::close_code::policy_error, "a message that is not understood");
  }
  if (m_state == State::kGreeting && message[0] == static_cast<std::uint8_t>(transport::Channel::kControl)) {
    m_state = State::kPlaying;
    m_shared.greeting.Leave(m_guest);
    transport::vestibule::FillRandomly(m_laneKey);
    m_outbox.Add(kLaneChannel, m_laneKey);
  }
  Write();
}

bool Browser::MayAdd(const LaneKey& key, const std::string& address) const {
  return m_state == State::kPlaying && m_lanes.size() < kMostLanes && address == m_guest.address &&
         transport::vestibule::AreEqual(key, m_laneKey);
}

void Browser::Add(Stream stream, Request request) {
  const auto lane = std::make_shared<Lane>(std::move(stream), std::move(request));
  m_lanes.push_back(lane);
  lane->Start(
      [self = weak_from_this()](std::span<const std::uint8_t> message) {
        const std::shared_ptr<Browser> browser = self.lock();
        return browser != nullptr && browser->JudgeOfLane(message);
      },
      [self = weak_from_this()](std::size_t bytes) {
        if (const std::shared_ptr<Browser> browser = self.lock()) browser->NoteControl(bytes);
      });
}

// Inputs alone; what has an order stays on the first.
bool Browser::JudgeOfLane(std::span<const std::uint8_t> message) {
  if (m_state != State::kPlaying) return false;
  m_shared.counts.bytesUp += message.size();
  const bool isInput = !message.empty() && message[0] == static_cast<std::uint8_t>(transport::Channel::kInput);
  if (!isInput || !m_rate.Allow(message.size(), command::ReadClock())) {
    CutOff(websocket::close_code::policy_error, isInput ? "too many messages" : "a message that is not understood");
    return false;
  }
  return m_link->Take(message, m_outbox) == ServerLink::Verdict::kGood;
}

// Each snapshot goes where least is on the way: a connection that waits for a lost segment has most.
void Browser::Spread() {
  std::erase_if(m_lanes, [](const std::shared_ptr<Lane>& lane) { return lane->IsOver(); });
  if (m_lanes.empty() || m_state != State::kPlaying) return;
  while (m_outbox.HasSnapshot()) {
    Lane* best = nullptr;
    std::size_t least = m_sending.empty() ? CountOnTheWay(beast::get_lowest_layer(m_stream).socket()) : kUnlimited;
    m_turn = (m_turn + 1) % (m_lanes.size() + 1);
    for (std::size_t i = 0; i < m_lanes.size(); ++i) {
      Lane& lane = *m_lanes[(m_turn + i) % m_lanes.size()];
      if (!lane.IsFree()) continue;
      const std::size_t onTheWay = lane.CountOnTheWay();
      if (onTheWay > least || (onTheWay == least && m_turn == 0)) continue;
      least = onTheWay;
      best = &lane;
    }
    if (best == nullptr) return;  // the first, or none has room
    Outbox::Message message = m_outbox.TakeSnapshot();
    m_shared.counts.bytesDown += message.size();
    best->Send(std::move(message));
  }
}

void Browser::CutOff(websocket::close_code code, const std::string& reason) {
  if (!m_farewell) ++m_shared.counts.browsersCutOff;
  Close(code, reason, Waiting::kDiscard);
}

void Browser::Close(websocket::close_code code, const std::string& reason, Waiting waiting) {
  if (m_farewell || IsOver()) return;
  if (m_state != State::kAccepting) m_state = State::kLeaving;
  m_farewell.emplace(code, reason);
  m_closeBy = command::ReadClock() + kCloseTimeout;
  if (waiting == Waiting::kDiscard) m_outbox.Clear();
  LeaveServer();
  Write();
}

// Beast writes one message at a time. The close goes after the last.
void Browser::Write() {
  const bool mayWrite =
      m_state == State::kJoining || m_state == State::kPreparing || IsHeard() || m_state == State::kLeaving;
  if (!mayWrite || !m_sending.empty()) return;
  if (!m_outbox.IsEmpty()) {
    m_sending = m_outbox.Take();
    m_shared.counts.bytesDown += m_sending.size();
    m_stream.async_write(asio::buffer(m_sending), [self = shared_from_this()](error_code error, std::size_t) {
      self->m_sending.clear();
      if (error) return self->End(self->DescribeEnd(error));
      self->Spread();
      self->Write();
    });
  } else if (m_state == State::kLeaving) {
    m_state = State::kClosing;
    m_stream.async_close(*m_farewell, [self = shared_from_this()](error_code) { self->End(""); });
  }
}

// Beast's messages say what a browser did wrong and are passed on; the system's messages about a lost connection tell
// people nothing.
std::string Browser::DescribeEnd(error_code error) const {
  // Some browsers close and are gone before the answer, which then fails.
  const bool hasLeft = error == websocket::error::closed || m_stream.reason().code != websocket::close_code::none;
  if (hasLeft) return "left";
  if (error == beast::error::timeout) return "silent";
  const bool isGone = error == asio::error::eof || error.category() == boost::system::system_category();
  return isGone ? "gone" : error.message();
}

// Drops the connection. reason: for the log; a farewell tells more and is taken instead.
void Browser::End(const std::string& reason) {
  if (IsOver()) return;
  m_state = State::kOver;
  m_shared.greeting.Leave(m_guest);
  LeaveServer();
  for (const std::shared_ptr<Lane>& lane : m_lanes) lane->End();
  m_shared.counts.snapshotsDropped += m_outbox.CountDropped();
  beast::get_lowest_layer(m_stream).close();
  if (m_seat == nullptr) return;
  m_seat = nullptr;
  std::fprintf(stderr, "browser %llu: ended after %.0f s: %s; %llu snapshots dropped\n",
               static_cast<unsigned long long>(m_number), command::ReadClock() - m_begin,
               m_farewell ? m_farewell->reason.c_str() : reason.c_str(),
               static_cast<unsigned long long>(m_outbox.CountDropped()));
}

void Browser::LeaveServer() {
  if (m_link == nullptr) return;
  m_link->Leave();
  m_shared.leaving.push_back(std::move(m_link));
}

}  // namespace wobble::gateway
