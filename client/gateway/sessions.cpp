// The only file that includes Boost.Beast: each that does takes half a minute to compile. What needs no Beast is in the
// files beside it.
//
// A connection is a Visitor while it asks for files and becomes a Browser when it asks for /play. Pending handlers keep
// both alive, and the shared list keeps a Browser alive as well. Callbacks rather than coroutines: this Boost has
// coroutines for one of the two compilers only.
//
// A browser is read only once its link to the server stands. Until then its messages wait in the system's buffer, so
// there is no queue here that it could fill. No message of a browser is trusted; every limit ends in a close with a
// reason.
#include "client/gateway/sessions.h"

#include <algorithm>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstdio>
#include <optional>
#include <span>

#include "client/command/clock.h"
#include "client/gateway/addresses.h"
#include "client/gateway/credential.h"
#include "client/gateway/origin.h"
#include "client/gateway/outbox.h"
#include "client/gateway/rate_limit.h"

namespace wobble::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;
using std::chrono::seconds;
using Request = http::request<http::empty_body>;

constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;
// For a whole request, however slowly it comes; for the next one on the same connection, the pause before it included.
constexpr seconds kRequestTimeout{4};
constexpr seconds kNextRequestTimeout{10};
// For an answer: the page over a slow link.
constexpr seconds kResponseTimeout{60};
// After the last answer the rest of the input is read and dropped for so long: closing at once could destroy the answer
// on its way.
constexpr seconds kLingerTimeout{1};
constexpr seconds kHandshakeTimeout{5};
// Without a sign of life; Beast sends a ping after half of it.
constexpr seconds kIdleTimeout{20};
// Seconds from the server's answer to the hello. The server itself waits a little less long.
constexpr double kHelloTimeout = protocol::kHelloTimeout + 2;
// An honest browser has said hello by then; where all places are taken, who has not may lose its own to another, s.
constexpr double kUsualHello = 1;
// Seconds in which a browser must take the messages that wait for it and answer the close.
constexpr double kCloseTimeout = 3;

// Scripts, styles and pictures come from this gateway alone. WebAssembly counts as a kind of eval, and not all browsers
// let 'self' cover a WebSocket.
constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; "
    "font-src 'self'; connect-src 'self' ws: wss:; manifest-src 'self'; worker-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

std::string_view AsView(beast::string_view text) { return {text.data(), text.size()}; }

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

std::uint64_t ReadUnixTime() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<seconds>(std::chrono::system_clock::now().time_since_epoch()).count());
}

// All headers of this name as one list.
std::string JoinHeaders(const Request& request, const char* name) {
  std::string all;
  const auto [begin, end] = request.equal_range(name);
  for (auto each = begin; each != end; ++each) {
    if (!all.empty()) all += ',';
    all += AsView(each->value());
  }
  return all;
}

}  // namespace

// A browser that plays: its WebSocket and its link to the server.
//
//   kAccepting --> kJoining --> kGreeting --> kPlaying      OnAccepted, Turn once the server has answered, Judge
//       |             |             |             |
//       +-------------+-------------+-------------+--> kLeaving --> kClosing      Close, then Write once nothing waits
//
// and from each of them to kOver by End. Close while kAccepting only sets the farewell: nothing can be written before
// the handshake is done, and OnAccepted then goes to kLeaving.
class Browser : public std::enable_shared_from_this<Browser> {
 public:
  // address: by which places are counted. credential: for the server.
  Browser(Shared& shared, const World& world, tcp::socket socket, Request request, const std::string& address,
          transport::vestibule::Credential credential)
      : m_shared(shared),
        m_world(world),
        m_stream(std::move(socket)),
        m_resolver(m_stream.get_executor()),
        m_request(std::move(request)),
        m_credential(std::move(credential)),
        m_guest{.address = address, .end = [this] { End("said no hello in time"); }},
        m_number(++shared.counts.browsers),
        m_begin(command::ReadClock()) {
    shared.greeting.Enter(m_guest, m_begin);
  }
  ~Browser() { m_shared.greeting.Leave(m_guest); }

  void Start();
  // Relays in both directions; to be called several hundred times a second.
  void Turn(double now);

  enum class Waiting { kDeliver, kDiscard };  // of the messages that wait for the browser
  // Begins to close with this reason. Later calls do nothing.
  void Close(websocket::close_code code, const std::string& reason, Waiting waiting);

  [[nodiscard]] bool IsOver() const { return m_state == State::kOver; }

 private:
  enum class State {
    kAccepting,  // the WebSocket handshake runs
    kJoining,    // the server's name is looked up, its link opened; the browser is not read yet
    kGreeting,   // its hello is awaited
    kPlaying,    // messages go both ways
    kLeaving,    // the last messages go to the browser, then the close
    kClosing,    // the close has been sent and is to be answered
    kOver,
  };

  void OnAccepted(error_code error);
  void OnResolved(error_code error, const udp::resolver::results_type& results);
  void TurnLink(double now);
  void TakeSeat(double now);
  void RefuseSeat();
  // Whether what the browser sends goes to the server.
  [[nodiscard]] bool IsHeard() const { return m_state == State::kGreeting || m_state == State::kPlaying; }
  void Read();
  void OnRead(error_code error);
  void Judge(std::span<const std::uint8_t> message);
  void CutOff(websocket::close_code code, const std::string& reason);
  void Write();
  [[nodiscard]] std::string DescribeEnd(error_code error) const;
  void End(const std::string& reason);
  void LeaveServer();

  Shared& m_shared;
  const World& m_world;
  websocket::stream<beast::tcp_stream> m_stream;
  udp::resolver m_resolver;
  Request m_request;
  transport::vestibule::Credential m_credential;
  Lobby::Guest m_guest;  // of `greeting`, until it has said hello or has ended
  Place m_seat;          // null until the server has let it in
  std::uint64_t m_number;
  double m_begin;
  double m_helloBy = 0;  // while kGreeting

  std::unique_ptr<ServerLink> m_link;
  RateLimit m_rate;
  Outbox m_outbox;
  Outbox::Message m_sending;  // on its way; empty when none is
  beast::flat_buffer m_incoming;
  State m_state = State::kAccepting;
  std::optional<websocket::close_reason> m_farewell;  // set by Close
  double m_closeBy = 0;                               // when a browser with a farewell is given up
  bool m_hasFlooded = false;                          // with pings; the next Turn cuts it off
};

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
  m_stream.control_callback([this](websocket::frame_type, beast::string_view text) {
    if (!m_rate.Allow(text.size(), command::ReadClock())) m_hasFlooded = true;
  });
  m_stream.async_accept(m_request, [self = shared_from_this()](error_code error) { self->OnAccepted(error); });
}

void Browser::OnAccepted(error_code error) {
  if (IsOver()) return;
  if (error) return End(error.message());
  m_state = m_farewell ? State::kLeaving : State::kJoining;
  if (m_farewell) return Write();
  m_request = {};  // it has the credential in plain text
  if (!m_shared.players.HasRoom(m_guest.address)) return RefuseSeat();
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
  if (m_state == State::kGreeting && now >= m_helloBy) CutOff(websocket::close_code::policy_error, "no hello");
  if (m_hasFlooded) CutOff(websocket::close_code::policy_error, "too many messages");
  if (m_outbox.IsOverfull()) CutOff(websocket::close_code::policy_error, "reads too slowly");
  Write();
  if (m_farewell && now >= m_closeBy) End("");
}

void Browser::TurnLink(double now) {
  m_link->Poll(now, m_outbox);
  if (m_link->HasEnded()) {
    Close(FindCloseCode(*m_link), m_link->EndReason(), Waiting::kDeliver);
  } else if (m_state == State::kJoining && m_link->IsConnected()) {
    TakeSeat(now);
  }
}

// Only now: those whom the server refuses keep no place from others.
void Browser::TakeSeat(double now) {
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
  }
  Write();
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
  const bool mayWrite = m_state == State::kJoining || IsHeard() || m_state == State::kLeaving;
  if (!mayWrite || !m_sending.empty()) return;
  if (!m_outbox.IsEmpty()) {
    m_sending = m_outbox.Take();
    m_shared.counts.bytesDown += m_sending.size();
    m_stream.async_write(asio::buffer(m_sending), [self = shared_from_this()](error_code error, std::size_t) {
      self->m_sending.clear();
      if (error) return self->End(self->DescribeEnd(error));
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

namespace {

// A connection that asks for files, until it asks to play. Requests are answered one after the other.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  // A proxy's connections are those of many browsers.
  Visitor(Shared& shared, tcp::socket socket, const std::string& peer)
      : m_shared(shared),
        m_stream(std::move(socket)),
        m_peer(peer),
        m_guest{.address = IsTrusted(peer, shared.options.proxies) ? "" : FindHousehold(peer),
                .end = [this] { m_stream.close(); }} {
    shared.visitors.Enter(m_guest, command::ReadClock());
  }
  ~Visitor() { m_shared.visitors.Leave(m_guest); }

  void Start() { Read(kRequestTimeout); }

 private:
  void Read(seconds timeout);
  void OnRead(error_code error);
  void Answer();
  void AnswerPlay(const World& world);
  void SendWorlds();
  void SendFile(const PageFile& file);
  void SendText(http::status status, std::string_view text);
  void Send(std::string_view body);
  void Linger();

  Shared& m_shared;
  beast::tcp_stream m_stream;
  std::string m_peer;
  Lobby::Guest m_guest;  // of `visitors`
  beast::flat_buffer m_buffer;
  std::optional<http::request_parser<http::empty_body>> m_parser;
  http::response<http::span_body<const char>> m_response;
  bool m_isLast = false;  // the connection ends after this answer
};

void Visitor::Read(seconds timeout) {
  m_shared.visitors.SetWaiting(m_guest, true, command::ReadClock());
  m_parser.emplace();
  m_parser->header_limit(kMaxHeaderBytes);
  m_response = {};
  m_stream.expires_after(timeout);
  http::async_read_header(m_stream, m_buffer, *m_parser,
                          [self = shared_from_this()](error_code error, std::size_t) { self->OnRead(error); });
}

void Visitor::OnRead(error_code error) {
  if (!m_stream.socket().is_open()) return;  // it had to go
  if (error == http::error::end_of_stream) return Linger();
  if (error && error.category() != make_error_code(http::error::end_of_stream).category()) return;  // gone, or too slow
  ++m_shared.counts.requests;
  m_isLast = error || !m_parser->is_done() || !m_parser->get().keep_alive();
  if (error == http::error::header_limit) {
    return SendText(http::status::request_header_fields_too_large, "too large a request\n");
  }
  if (error) return SendText(http::status::bad_request, "this is no request\n");
  Answer();
}

void Visitor::Answer() {
  const Request& request = m_parser->get();
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    m_response.set(http::field::allow, "GET, HEAD");
    m_isLast = true;
    return SendText(http::status::method_not_allowed, "only GET and HEAD are answered here\n");
  }
  if (!m_parser->is_done()) return SendText(http::status::bad_request, "a body is not expected\n");
  const std::string_view target = AsView(request.target());
  const std::string_view path = target.substr(0, target.find('?'));
  if (path == "/worlds") return SendWorlds();
  if (path == "/play") return AnswerPlay(m_shared.options.worlds[0]);
  for (const World& world : m_shared.options.worlds) {
    if (!world.name.empty() && path == "/play/" + world.name) return AnswerPlay(world);
  }
  if (path == "/healthz") return SendText(http::status::ok, "ok\n");
  const PageFile* file = FindFile(m_shared.page, target);
  if (file == nullptr) return SendText(http::status::not_found, "there is no such file\n");
  SendFile(*file);
}

void Visitor::AnswerPlay(const World& world) {
  const Request& request = m_parser->get();
  if (!websocket::is_upgrade(request)) {
    m_response.set(http::field::upgrade, "websocket");
    return SendText(http::status::upgrade_required, "a WebSocket is expected here\n");
  }
  if (!IsOriginAllowed(AsView(request[http::field::origin]), AsView(request[http::field::host]),
                       m_shared.options.origins)) {
    return SendText(http::status::forbidden, "pages of this origin may not play here\n");
  }
  const std::string offered = JoinHeaders(request, "Sec-WebSocket-Protocol");
  if (!http::token_list(offered).exists(MakeSubprotocol())) {
    return SendText(http::status::bad_request, "the subprotocol is not offered: load the page again\n");
  }
  const double now = command::ReadClock();
  auto credential = FindCredential(offered);
  if (!credential) return SendText(http::status::bad_request, "the password, invite or token is malformed\n");
  const std::string from =
      FindBrowserAddress(m_peer, JoinHeaders(request, "X-Forwarded-For"), m_shared.options.proxies);
  const std::string address = FindHousehold(from);
  if (!m_shared.plays.Allow(address, now)) {
    ++m_shared.counts.browsersRefused;
    return SendText(http::status::too_many_requests, "too many tries from this address: wait a few seconds\n");
  }
  if (m_shared.players.IsFull()) m_shared.greeting.EndOldest(now - kUsualHello);
  m_shared.visitors.Leave(m_guest);
  m_stream.expires_never();
  if (const auto& key = m_shared.options.gatewayKey) credential = Introduce(*credential, from, *key, ReadUnixTime());
  const auto browser = std::make_shared<Browser>(m_shared, world, m_stream.release_socket(), m_parser->release(),
                                                 address, std::move(*credential));
  m_shared.browsers.push_back(browser);
  browser->Start();
}

void Visitor::SendFile(const PageFile& file) {
  const bool isCompressed = !file.gzip.empty() && AcceptsGzip(AsView(m_parser->get()[http::field::accept_encoding]));
  m_response.set(http::field::content_type, beast::string_view(file.type.data(), file.type.size()));
  m_response.set(http::field::cache_control, file.isForever ? "public, max-age=31536000, immutable" : "no-cache");
  m_response.set(http::field::vary, "Accept-Encoding");
  if (isCompressed) m_response.set(http::field::content_encoding, "gzip");
  Send(isCompressed ? file.gzip : file.bytes);
}

void Visitor::SendWorlds() {
  m_response.set(http::field::content_type, "application/json");
  m_response.set(http::field::cache_control, "no-store");
  Send(m_shared.worlds);
}

// text: must live until it is sent, since it is not copied.
void Visitor::SendText(http::status status, std::string_view text) {
  if (status != http::status::ok) ++m_shared.counts.requestsRefused;
  m_response.result(status);
  m_response.set(http::field::content_type, "text/plain; charset=utf-8");
  m_response.set(http::field::cache_control, "no-store");
  Send(text);
}

void Visitor::Send(std::string_view body) {
  m_response.version(11);
  m_response.keep_alive(!m_isLast);
  m_response.set("X-Content-Type-Options", "nosniff");
  m_response.set("Content-Security-Policy", kContentSecurityPolicy);
  m_response.set("Referrer-Policy", "no-referrer");
  m_response.content_length(body.size());
  const bool isHeadOnly = m_parser->get().method() == http::verb::head;
  if (!isHeadOnly) m_response.body() = beast::span<const char>(body.data(), body.size());
  m_shared.visitors.SetWaiting(m_guest, false, command::ReadClock());
  m_stream.expires_after(kResponseTimeout);
  http::async_write(m_stream, m_response, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    if (self->m_isLast) return self->Linger();
    self->Read(kNextRequestTimeout);
  });
}

void Visitor::Linger() {
  m_shared.visitors.SetWaiting(m_guest, true, command::ReadClock());
  error_code ignored;
  m_stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
  m_stream.expires_after(kLingerTimeout);
  const auto discard = [self = shared_from_this()](const auto& again) -> void {
    self->m_buffer.clear();
    self->m_stream.async_read_some(self->m_buffer.prepare(4096), [again, self](error_code error, std::size_t) {
      if (!error) again(again);
    });
  };
  discard(discard);
}

}  // namespace

void Greet(Shared& shared, tcp::socket socket, const std::string& peer) {
  std::make_shared<Visitor>(shared, std::move(socket), peer)->Start();
}

void TurnBrowsers(Shared& shared, double now) {
  for (const std::shared_ptr<Browser>& browser : shared.browsers) browser->Turn(now);
  std::erase_if(shared.browsers, [](const std::shared_ptr<Browser>& browser) { return browser->IsOver(); });
}

void CloseBrowsers(Shared& shared) {
  for (const std::shared_ptr<Browser>& browser : shared.browsers) {
    browser->Close(websocket::close_code::going_away, "the gateway is closing", Browser::Waiting::kDiscard);
  }
}

}  // namespace wobble::gateway
