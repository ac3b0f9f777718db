#include "server/ops/http_listener.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <list>
#include <optional>
#include <thread>
#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace wobble::ops {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kPatience{2};     // for a whole request, and again for its answer
constexpr std::chrono::milliseconds kPause{20};  // after accept() failed for want of descriptors

std::string ToString(beast::string_view text) { return {text.data(), text.size()}; }

// One request and its answer.
class Exchange : public std::enable_shared_from_this<Exchange> {
 public:
  using OnEnd = std::function<void(Exchange*)>;
  Exchange(tcp::socket socket, asio::ip::address from, const HttpListener::Handler& answer, OnEnd onEnd)
      : m_stream(std::move(socket)), m_from(std::move(from)), m_answer(answer), m_onEnd(std::move(onEnd)) {}

  void Start() {
    m_parser.header_limit(HttpListener::kMostHeaderBytes);
    m_parser.body_limit(HttpListener::kMostBodyBytes);
    m_stream.expires_after(kPatience);
    http::async_read(m_stream, m_buffer, m_parser,
                     [self = shared_from_this()](error_code error, std::size_t) { self->OnRead(error); });
  }
  // Ends it at once, and without a word.
  void Close() {
    error_code ignored;
    m_stream.socket().close(ignored);
  }
  [[nodiscard]] const asio::ip::address& From() const { return m_from; }
  [[nodiscard]] bool IsReading() const { return m_isReading; }

 private:
  void OnRead(error_code error) {
    m_isReading = false;
    if (error == http::error::body_limit) return Write({.status = 413, .body = "too large\n"});
    if (error == http::error::header_limit) return Write({.status = 431, .body = "too large\n"});
    const bool isHttpFault = error && error.category() == http::make_error_code(http::error::bad_method).category();
    if (isHttpFault && error != http::error::end_of_stream && error != http::error::partial_message) {
      return Write({.status = 400, .body = "this is no HTTP request\n"});
    }
    if (error) return m_onEnd(this);
    const auto& request = m_parser.get();
    Write(m_answer({.method = ToString(request.method_string()),
                    .target = ToString(request.target()),
                    .authorization = ToString(request[http::field::authorization]),
                    .body = request.body()}));
  }

  void Write(const HttpResponse& response) {
    m_response.version(11);
    m_response.result(response.status);
    m_response.set(http::field::content_type, response.type);
    m_response.set(http::field::cache_control, "no-store");
    m_response.keep_alive(false);
    m_response.body() = response.body;
    if (m_parser.is_header_done() && m_parser.get().method() == http::verb::head) {
      m_response.content_length(response.body.size());
      m_response.body().clear();
    } else {
      m_response.prepare_payload();
    }
    m_stream.expires_after(kPatience);
    http::async_write(m_stream, m_response, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->m_stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
      self->m_onEnd(self.get());
    });
  }

  beast::tcp_stream m_stream;
  asio::ip::address m_from;
  const HttpListener::Handler& m_answer;
  OnEnd m_onEnd;
  beast::flat_buffer m_buffer{HttpListener::kMostHeaderBytes + HttpListener::kMostBodyBytes};
  http::request_parser<http::string_body> m_parser;
  http::response<http::string_body> m_response;
  bool m_isReading = true;
};

}  // namespace

bool ParseAddress(const std::string& text, Address& address, std::string& error) {
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  std::string host = colon == std::string::npos ? address.host : text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  std::uint16_t port = 0;
  const auto [end, result] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (result != std::errc{} || end != digits.data() + digits.size() || host.empty()) {
    error = "'" + text + "': must be HOST:PORT or PORT, with a PORT of 0 to 65535";
    return false;
  }
  address = {host, port};
  return true;
}

struct HttpListener::Implementation {
  explicit Implementation(Handler handler) : answer(std::move(handler)), acceptor(context), pause(context) {}

  // Empty when it listens; else a line.
  std::string Open(const Address& address) {
    tcp::resolver resolver(context);
    error_code error;
    const auto found = resolver.resolve(address.host, std::to_string(address.port), tcp::resolver::passive, error);
    if (error || found.empty()) return "the address is not known";
    const tcp::endpoint endpoint = *found.begin();
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    return error ? error.message() : "";
  }

  void Accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        Take(std::move(socket));
        return Accept();
      }
      pause.expires_after(kPause);
      pause.async_wait([this](error_code aborted) {
        if (!aborted) Accept();
      });
    });
  }

  void Take(tcp::socket socket) {
    error_code error;
    const tcp::endpoint from = socket.remote_endpoint(error);
    const auto ofAddress =
        std::count_if(open.begin(), open.end(), [&](const auto& each) { return each->From() == from.address(); });
    if (error || static_cast<std::size_t>(ofAddress) >= kMostPerAddress) return;  // closes it
    if (open.size() >= kMostConnections) {
      const auto oldest = std::find_if(open.begin(), open.end(), [](const auto& each) { return each->IsReading(); });
      if (oldest == open.end()) return;
      (*oldest)->Close();
      open.erase(oldest);
    }
    open.push_back(std::make_shared<Exchange>(std::move(socket), from.address(), answer, [this](Exchange* ended) {
      std::erase_if(open, [&](const auto& each) { return each.get() == ended; });
    }));
    open.back()->Start();
  }

  Handler answer;
  asio::io_context context{1};
  tcp::acceptor acceptor;
  asio::steady_timer pause;
  std::list<std::shared_ptr<Exchange>> open;  // the oldest first
  std::thread thread;
};

HttpListener::HttpListener(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}

std::unique_ptr<HttpListener> HttpListener::Listen(const Address& address, Handler answer, std::string& error) {
  auto made = std::make_unique<Implementation>(std::move(answer));
  if (const std::string why = made->Open(address); !why.empty()) {
    error = fmt::format("{}:{} (TCP): cannot be listened on: {}", address.host, address.port, why);
    return nullptr;
  }
  made->Accept();
  made->thread = std::thread([context = &made->context] { context->run(); });
  return std::unique_ptr<HttpListener>(new HttpListener(std::move(made)));
}

HttpListener::~HttpListener() {
  m->context.stop();
  m->thread.join();
  m->open.clear();
}

std::uint16_t HttpListener::ReadPort() const { return m->acceptor.local_endpoint().port(); }

}  // namespace wobble::ops
