// Connections that ask for files, until they ask to play.
//
// A connection is a Visitor while it asks for files and becomes a Browser when it asks for /play. Pending handlers keep
// both alive, and the shared list keeps a Browser alive as well. Callbacks rather than coroutines: this Boost has
// coroutines for one of the two compilers only.
#include "client/gateway/http_connection.h"

#include <algorithm>
#include <boost/beast/core/detect_ssl.hpp>
#include <chrono>
#include <optional>

#include "client/command/lan_address.h"
#include "client/gateway/addresses.h"
#include "client/gateway/browser_websocket.h"
#include "client/gateway/credential.h"
#include "client/gateway/origin.h"
#include "client/gateway/stream.h"

namespace wobble::gateway {
namespace {

constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;
// For a whole request, however slowly it comes; for the next one on the same connection, the pause before it included.
constexpr seconds kRequestTimeout{4};
constexpr seconds kNextRequestTimeout{10};
// For an answer: the page over a slow link.
constexpr seconds kResponseTimeout{60};
// After the last answer the rest of the input is read and dropped for so long: closing at once could destroy the answer
// on its way.
constexpr seconds kLingerTimeout{1};
// An honest browser has said hello by then; where all places are taken, who has not may lose its own to another, s.
constexpr double kUsualHello = 1;

// Scripts, styles and pictures come from this gateway alone. WebAssembly counts as a kind of eval, and not all browsers
// let 'self' cover a WebSocket.
constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; "
    "font-src 'self'; connect-src 'self' ws: wss:; manifest-src 'self'; worker-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

constexpr std::string_view kPlay = "/play/";
constexpr std::string_view kHttpsOnly = "this port speaks https\n";

std::string_view AsView(beast::string_view text) { return {text.data(), text.size()}; }

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

// A connection that asks for files, until it asks to play. Requests are answered one after the other.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  // A proxy's connections are those of many browsers.
  Visitor(Shared& shared, tcp::socket socket, const std::string& peer)
      : m_shared(shared),
        m_stream(std::move(socket)),
        m_peer(peer),
        m_guest{.address = IsTrusted(peer, shared.options.proxies) ? "" : FindHousehold(peer),
                .end = [this] { m_stream.next_layer().close(); }} {
    shared.visitors.Enter(m_guest, command::ReadClock());
  }
  ~Visitor() { m_shared.visitors.Leave(m_guest); }

  void Start();

 private:
  void OnDetected(error_code error, bool isTls);
  void ReadWithin(seconds timeout);
  void Read();
  void OnRead(error_code error);
  void Answer();
  // recording: the name of one that is to be watched, in place of the world.
  void AnswerPlay(const World& world, const std::optional<std::string>& recording = {});
  void AnswerMore(const LaneKey& key);
  [[nodiscard]] bool IsOfThisMachine() const;
  void SendWorlds();
  void SendList();
  void SendToHttps();
  void SendFile(const PageFile& file);
  void SendText(http::status status, std::string_view text);
  void Send(std::string_view body);
  void Linger();
  void Discard();

  Shared& m_shared;
  Stream m_stream;
  std::string m_peer;
  Lobby::Guest m_guest;  // of `visitors`
  beast::flat_buffer m_buffer;
  std::optional<http::request_parser<http::empty_body>> m_parser;
  http::response<http::span_body<const char>> m_response;
  std::string m_list;     // of worlds, while it is sent
  bool m_isLast = false;  // the connection ends after this answer
};

// TLS's handshake has to be done within the time that there is for a request.
void Visitor::Start() {
  if (m_shared.tls == nullptr) return ReadWithin(kRequestTimeout);
  m_stream.next_layer().expires_after(kRequestTimeout);
  beast::async_detect_ssl(m_stream.next_layer(), m_buffer, [self = shared_from_this()](error_code error, bool isTls) {
    self->OnDetected(error, isTls);
  });
}

void Visitor::OnDetected(error_code error, bool isTls) {
  if (error) return;
  if (!isTls) return Read();
  // The context is held, since another may take its place meanwhile.
  m_stream.AcceptTls(*m_shared.tls, m_buffer.data(),
                     [self = shared_from_this(), context = m_shared.tls](error_code failure, std::size_t used) {
                       if (failure) return;
                       self->m_buffer.consume(used);
                       self->Read();
                     });
}

void Visitor::ReadWithin(seconds timeout) {
  m_stream.next_layer().expires_after(timeout);
  Read();
}

void Visitor::Read() {
  m_shared.visitors.SetWaiting(m_guest, true, command::ReadClock());
  m_parser.emplace();
  m_parser->header_limit(kMaxHeaderBytes);
  m_response = {};
  http::async_read_header(m_stream, m_buffer, *m_parser,
                          [self = shared_from_this()](error_code error, std::size_t) { self->OnRead(error); });
}

void Visitor::OnRead(error_code error) {
  if (!m_stream.next_layer().socket().is_open()) return;  // it had to go
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
  if (path == "/healthz") return SendText(http::status::ok, "ok\n");  // for checks of this machine, in plain as well
  if (m_shared.tls != nullptr && !m_stream.IsTls()) return SendToHttps();
  if (path == "/worlds") return SendWorlds();
  if (path == "/worlds.json" && !m_shared.list.empty()) return SendList();
  if (path == "/play") return AnswerPlay(m_shared.options.worlds[0]);
  for (const World& world : m_shared.options.worlds) {
    if (!world.name.empty() && path == "/play/" + world.name) return AnswerPlay(world);
  }
  if (m_shared.films != nullptr && path.starts_with(kPlay)) {
    const auto recording = FindRecordingName(path.substr(kPlay.size()));
    if (recording) return AnswerPlay(m_shared.options.worlds[0], recording);
  }
  const PageFile* file = FindFile(m_shared.page, target);
  if (file == nullptr) return SendText(http::status::not_found, "there is no such file\n");
  SendFile(*file);
}

void Visitor::AnswerPlay(const World& world, const std::optional<std::string>& recording) {
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
  if (const auto key = FindLaneKey(offered)) return AnswerMore(*key);
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
  m_stream.next_layer().expires_never();
  const bool showsNothing = credential->kind == transport::vestibule::Credential::Kind::kNone;
  std::shared_ptr<const Film> film;
  if (recording) {
    film = m_shared.films->Watch(*recording, now);
    credential.emplace();  // its server asks for none
  } else if (const auto& key = m_shared.options.gatewayKey) {
    credential = Introduce(*credential, from, *key, ReadUnixTime());
  }
  const auto browser = std::make_shared<Browser>(m_shared, world, std::move(film), std::move(m_stream),
                                                 m_parser->release(), address, std::move(*credential), showsNothing);
  m_shared.browsers.push_back(browser);
  browser->Start();
}

// One more WebSocket of a browser that plays.
void Visitor::AnswerMore(const LaneKey& key) {
  const std::string address = FindHousehold(
      FindBrowserAddress(m_peer, JoinHeaders(m_parser->get(), "X-Forwarded-For"), m_shared.options.proxies));
  const auto isIts = [&](const std::shared_ptr<Browser>& browser) { return browser->MayAdd(key, address); };
  const auto found = std::find_if(m_shared.browsers.begin(), m_shared.browsers.end(), isIts);
  if (found == m_shared.browsers.end()) return SendText(http::status::not_found, "nobody plays with this key\n");
  m_shared.visitors.Leave(m_guest);
  m_stream.next_layer().expires_never();
  (*found)->Add(std::move(m_stream), m_parser->release());
}

// Whether the page was opened on the machine that the gateway runs on. A proxy on it that is not named speaks from here
// for anybody, but it says for whom or passes on the name that they know it by.
bool Visitor::IsOfThisMachine() const {
  const Request& request = m_parser->get();
  const bool isPassedOn =
      request.find("X-Forwarded-For") != request.end() || request.find("Forwarded") != request.end();
  return IsLoopback(m_peer) && !isPassedOn && IsLoopbackHost(AsView(request[http::field::host]));
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
  m_list = "{\"worlds\": " + m_shared.worlds;
  if (m_shared.films != nullptr) m_list += ", \"recordings\": " + m_shared.films->List(command::ReadClock());
  if (!m_shared.pages.empty()) m_list += ", \"elsewhere\": " + m_shared.pages;
  if (IsOfThisMachine()) {
    std::string addresses;  // they need no escaping
    for (const std::string& each : command::FindLanAddresses(SpellAddress(m_shared.options.bindAddress))) {
      addresses += (addresses.empty() ? "\"" : ", \"") + each + "\"";
    }
    m_list += ", \"addresses\": [" + addresses + "]";
  }
  m_list += "}\n";
  Send(m_list);
}

// For everybody: pages of other origins may read it, too.
void Visitor::SendList() {
  m_response.set(http::field::content_type, "application/json");
  m_response.set(http::field::cache_control, "no-cache");
  m_response.set(http::field::access_control_allow_origin, "*");
  m_list = m_shared.list;
  Send(m_list);
}

// A request in plain where TLS is spoken.
void Visitor::SendToHttps() {
  const std::string_view host = AsView(m_parser->get()[http::field::host]);
  const std::string_view target = AsView(m_parser->get().target());
  m_isLast = true;
  if (host.empty() || !target.starts_with('/')) return SendText(http::status::bad_request, kHttpsOnly);
  m_response.set(http::field::location, "https://" + std::string(host) + std::string(target));
  SendText(http::status::temporary_redirect, kHttpsOnly);
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
  m_stream.next_layer().expires_after(kResponseTimeout);
  http::async_write(m_stream, m_response, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    if (self->m_isLast) return self->Linger();
    self->ReadWithin(kNextRequestTimeout);
  });
}

void Visitor::Linger() {
  m_shared.visitors.SetWaiting(m_guest, true, command::ReadClock());
  m_stream.next_layer().expires_after(kLingerTimeout);
  m_stream.EndTls([self = shared_from_this()](error_code) { self->Discard(); });
}

void Visitor::Discard() {
  error_code ignored;
  m_stream.next_layer().socket().shutdown(tcp::socket::shutdown_send, ignored);
  const auto discard = [self = shared_from_this()](const auto& again) -> void {
    self->m_buffer.clear();
    self->m_stream.next_layer().async_read_some(self->m_buffer.prepare(4096),
                                                [again, self](error_code error, std::size_t) {
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
