#include "client/gateway/lane.h"

#include <sys/ioctl.h>

#include "client/gateway/server_link.h"

namespace wobble::gateway {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

void Lane::Start(TakeFunction take, const NoteControlFunction& noteControl) {
  m_take = std::move(take);
  m_stream.set_option(websocket::stream_base::timeout{kHandshakeTimeout, kIdleTimeout, true});
  m_stream.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(beast::http::field::sec_websocket_protocol, MakeSubprotocol());
  }));
  m_stream.read_message_max(kMaxBrowserMessageBytes);
  m_stream.binary(true);
  m_stream.auto_fragment(false);
  m_stream.control_callback(
      [noteControl](websocket::frame_type, beast::string_view text) { noteControl(text.size()); });
  m_stream.async_accept(m_request, [self = shared_from_this()](error_code error) {
    self->m_request = {};
    if (error || self->m_isOver) return self->End();
    self->m_isOpen = true;
    self->Read();
  });
}

void Lane::Read() {
  m_stream.async_read(m_incoming, [self = shared_from_this()](error_code error, std::size_t) {
    const std::span<const std::uint8_t> message{static_cast<const std::uint8_t*>(self->m_incoming.cdata().data()),
                                                self->m_incoming.size()};
    if (error || self->m_isOver || !self->m_stream.got_binary() || !self->m_take(message)) return self->End();
    self->m_incoming.consume(self->m_incoming.size());
    self->Read();
  });
}

std::size_t Lane::CountOnTheWay() { return gateway::CountOnTheWay(beast::get_lowest_layer(m_stream).socket()); }

void Lane::Send(Outbox::Message message) {
  m_sending = std::move(message);
  m_stream.async_write(asio::buffer(m_sending), [self = shared_from_this()](error_code error, std::size_t) {
    self->m_sending.clear();
    if (error) self->End();
  });
}

void Lane::End() {
  if (m_isOver) return;
  m_isOver = true;
  m_isOpen = false;
  m_take = nullptr;
  beast::get_lowest_layer(m_stream).close();
}

std::size_t CountOnTheWay(Lane::Socket& socket) {
  int bytes = 0;
  return ioctl(socket.native_handle(), TIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
}

}  // namespace wobble::gateway
