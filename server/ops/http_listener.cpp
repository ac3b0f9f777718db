#include "server/ops/http_listener.h"

#include <chrono>
#include <thread>

#include "server/ops/acceptor.h"

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace wobble::ops {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kPatience{2};  // for a whole request, and again for its answer

std::string ToString(beast::string_view text) { return {text.data(), text.size()}; }

// One request and its answer.
class Exchange : public std::enable_shared_from_this<Exchange> {
 public:
  using OnEnd = std::function<void(const Exchange*)>;
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
  [[nodiscard]] bool MayYield() const { return m_isReading; }

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

struct HttpListener::Implementation {
  explicit Implementation(Handler handler)
      : answer(std::move(handler)), acceptor(context, [this](tcp::socket socket, const asio::ip::address& from) {
          Take(std::move(socket), from);
        }) {}

  void Take(tcp::socket socket, const asio::ip::address& from) {
    if (!crowd.MakeRoom(from)) return;  // closes it
    const auto exchange = std::make_shared<Exchange>(std::move(socket), from, answer,
                                                     [this](const Exchange* ended) { crowd.Remove(ended); });
    crowd.Add(exchange);
    exchange->Start();
  }

  Handler answer;
  asio::io_context context{1};
  Acceptor acceptor;
  Crowd<Exchange> crowd{kMostConnections, kMostPerAddress};
  std::thread thread;
};

HttpListener::HttpListener(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}

std::unique_ptr<HttpListener> HttpListener::Listen(const Address& address, Handler answer, std::string& error) {
  auto made = std::make_unique<Implementation>(std::move(answer));
  if (!made->acceptor.Open(address, error)) return nullptr;
  made->thread = std::thread([context = &made->context] { context->run(); });
  return std::unique_ptr<HttpListener>(new HttpListener(std::move(made)));
}

HttpListener::~HttpListener() {
  m->context.stop();
  m->thread.join();
  m->crowd.Clear();
}

std::uint16_t HttpListener::ReadPort() const { return m->acceptor.ReadPort(); }

}  // namespace wobble::ops
