// A browser's connection: bytes over TCP, in plain or through TLS.
//
// One type for both, so that visitors, browsers and lanes are compiled once and do not know the difference: a template
// over the stream would double 28 s of compilation, and TLS in a unit of its own before a pipe would hide from the
// outboxes what the socket has not sent yet. The socket is the same, with its options; of TLS stands between it and the
// reader or writer one record at most.
//
// Includes Boost.Beast, which takes seconds to compile: for lane.h, browser_websocket.h and http_connection.cpp alone.
#pragma once

#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <boost/container/static_vector.hpp>
#include <functional>
#include <memory>

namespace wobble::gateway {

// As Beast's concept AsyncStream asks for. It can be moved while nothing is pending on it.
class Stream {
 public:
  using next_layer_type = boost::beast::tcp_stream;
  using executor_type = next_layer_type::executor_type;

  explicit Stream(boost::asio::ip::tcp::socket socket) : m_layers(std::make_unique<Layers>(std::move(socket))) {}

  [[nodiscard]] executor_type get_executor() noexcept { return m_layers->tcp.get_executor(); }
  // Where the time-outs and the socket are.
  [[nodiscard]] next_layer_type& next_layer() noexcept { return m_layers->tcp; }
  [[nodiscard]] const next_layer_type& next_layer() const noexcept { return m_layers->tcp; }
  [[nodiscard]] bool IsTls() const { return m_layers->tls != nullptr; }

  // Goes on in TLS. read: what has been read already; must live until handler(error, bytes of it that were used).
  template <typename Handler>
  void AcceptTls(boost::asio::ssl::context& context, boost::asio::const_buffer read, Handler&& handler) {
    m_layers->tls = std::make_unique<Tls>(m_layers->tcp, context);
    m_layers->tls->async_handshake(boost::asio::ssl::stream_base::server, read, std::forward<Handler>(handler));
  }

  // Says in TLS that nothing follows and waits for the same of the other end; at once in plain. handler(error).
  template <typename Handler>
  void EndTls(Handler&& handler) {
    if (IsTls()) return m_layers->tls->async_shutdown(std::forward<Handler>(handler));
    std::forward<Handler>(handler)(boost::system::error_code());
  }

  template <typename Sequence, typename Handler>
  void async_read_some(const Sequence& buffers, Handler&& handler) {
    Read(List<boost::asio::mutable_buffer>(buffers), Keep(std::forward<Handler>(handler)));
  }
  template <typename Sequence, typename Handler>
  void async_write_some(const Sequence& buffers, Handler&& handler) {
    Write(List<boost::asio::const_buffer>(buffers), Keep(std::forward<Handler>(handler)));
  }

  // Called by Beast when a WebSocket has ended.
  friend void teardown(boost::beast::role_type role, Stream& stream, boost::system::error_code& error) {
    using boost::beast::websocket::teardown;
    teardown(role, stream.next_layer().socket(), error);
  }
  template <typename Handler>
  friend void async_teardown(boost::beast::role_type role, Stream& stream, Handler&& handler) {
    using boost::beast::websocket::async_teardown;
    if (stream.IsTls()) return stream.m_layers->tls->async_shutdown(std::forward<Handler>(handler));
    async_teardown(role, stream.next_layer().socket(), std::forward<Handler>(handler));
  }

 private:
  // One type of buffers and of handlers, for which TCP and TLS are compiled once: Beast comes with a dozen of each,
  // which took most of the compile time.
  using Done = std::function<void(boost::system::error_code, std::size_t bytes)>;
  template <typename Buffer>
  using Buffers = boost::container::static_vector<Buffer, 16>;

  // The first that are not empty; the caller goes on behind what was used.
  template <typename Buffer, typename Sequence>
  static Buffers<Buffer> List(const Sequence& sequence) {
    Buffers<Buffer> buffers;
    const auto end = boost::asio::buffer_sequence_end(sequence);
    for (auto each = boost::asio::buffer_sequence_begin(sequence); each != end && buffers.size() < 16; ++each) {
      const Buffer buffer(*each);
      if (buffer.size() > 0) buffers.push_back(buffer);
    }
    return buffers;
  }
  // A std::function can be copied and Beast's handlers cannot.
  template <typename Handler>
  static Done Keep(Handler&& handler) {
    return [kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler))](
               boost::system::error_code error, std::size_t bytes) { (*kept)(error, bytes); };
  }
  void Read(const Buffers<boost::asio::mutable_buffer>& buffers, Done done);
  void Write(const Buffers<boost::asio::const_buffer>& buffers, Done done);

  using Tls = boost::beast::ssl_stream<boost::beast::tcp_stream&>;
  // At a fixed place, since one refers to the other.
  struct Layers {
    explicit Layers(boost::asio::ip::tcp::socket socket) : tcp(std::move(socket)) {}
    boost::beast::tcp_stream tcp;
    std::unique_ptr<Tls> tls;  // null: in plain
  };
  std::unique_ptr<Layers> m_layers;
};

inline void Stream::Read(const Buffers<boost::asio::mutable_buffer>& buffers, Done done) {
  if (IsTls()) return m_layers->tls->async_read_some(buffers, std::move(done));
  m_layers->tcp.async_read_some(buffers, std::move(done));
}

inline void Stream::Write(const Buffers<boost::asio::const_buffer>& buffers, Done done) {
  if (IsTls()) return m_layers->tls->async_write_some(buffers, std::move(done));
  m_layers->tcp.async_write_some(buffers, std::move(done));
}

}  // namespace wobble::gateway
