// One more WebSocket of a browser that plays.
//
// TCP delivers in order: a lost segment holds back everything behind it for a round trip and more. Over several
// connections it holds back its own only, and snapshots and inputs, of which each newer one replaces the older, go on
// over the others. Measured over an emulated line, 5 % of packets lost and 100 ms of round trip: EmulatedLines in
// tests/net/emulator.
//
// Includes Boost.Beast: for browser_websocket.cpp and http_connection.cpp alone.
#pragma once

#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "client/gateway/outbox.h"
#include "client/gateway/stream.h"

namespace wobble::gateway {

// Of every WebSocket. Idle: without a sign of life; Beast sends a ping after half of it.
inline constexpr std::chrono::seconds kHandshakeTimeout{5};
inline constexpr std::chrono::seconds kIdleTimeout{20};

// Besides the first.
inline constexpr std::size_t kMostLanes = 3;

class Lane : public std::enable_shared_from_this<Lane> {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  // A message that has come; false: the lane ends.
  using TakeFunction = std::function<bool(std::span<const std::uint8_t> message)>;

  Lane(Stream stream, Request request) : m_stream(std::move(stream)), m_request(std::move(request)) {}
  // Of a ping or pong; nothing may be ended inside it.
  using NoteControlFunction = std::function<void(std::size_t bytes)>;
  // Answers the request and reads from then on.
  void Start(TakeFunction take, const NoteControlFunction& noteControl);

  // Whether a message would be written at once.
  [[nodiscard]] bool IsFree() const { return m_isOpen && m_sending.empty(); }
  // Bytes that the far end has not acknowledged yet.
  [[nodiscard]] std::size_t CountOnTheWay();
  // Only while it is free.
  void Send(Outbox::Message message);
  void End();
  [[nodiscard]] bool IsOver() const { return m_isOver; }

 private:
  void Read();

  boost::beast::websocket::stream<Stream> m_stream;
  Request m_request;
  TakeFunction m_take;
  boost::beast::flat_buffer m_incoming;
  Outbox::Message m_sending;  // on its way; empty when none is
  bool m_isOpen = false;
  bool m_isOver = false;
};

// Bytes that a connection has sent or is to send, and that the far end has not acknowledged.
[[nodiscard]] std::size_t CountOnTheWay(Lane::Socket& socket);

}  // namespace wobble::gateway
