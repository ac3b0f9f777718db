#include "server/ops/acceptor.h"

#include <fmt/format.h>

#include <chrono>

namespace wobble::ops {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::chrono::milliseconds kPause{20};  // after accept() failed for want of descriptors

}  // namespace

Acceptor::Acceptor(asio::io_context& context, Take take)
    : m_context(context), m_take(std::move(take)), m_acceptor(context), m_pause(context) {}

bool Acceptor::Open(const Address& address, std::string& error) {
  if (const std::string why = Listen(address); !why.empty()) {
    error = fmt::format("{}:{} (TCP): cannot be listened on: {}", address.host, address.port, why);
    return false;
  }
  Accept();
  return true;
}

// Empty when it listens; else what failed.
std::string Acceptor::Listen(const Address& address) {
  tcp::resolver resolver(m_context);
  error_code error;
  const auto found = resolver.resolve(address.host, std::to_string(address.port), tcp::resolver::passive, error);
  if (error || found.empty()) return "the address is not known";
  const tcp::endpoint endpoint = *found.begin();
  m_acceptor.open(endpoint.protocol(), error);
  if (!error) m_acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) m_acceptor.bind(endpoint, error);
  if (!error) m_acceptor.listen(asio::socket_base::max_listen_connections, error);
  return error ? error.message() : "";
}

void Acceptor::Accept() {
  m_acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      const tcp::endpoint from = socket.remote_endpoint(error);
      if (!error) m_take(std::move(socket), from.address());
      return Accept();
    }
    m_pause.expires_after(kPause);
    m_pause.async_wait([this](error_code aborted) {
      if (!aborted) Accept();
    });
  });
}

}  // namespace wobble::ops
