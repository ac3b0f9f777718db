// A browser that plays: its WebSocket and its link to the server.
//
// Includes Boost.Beast, which takes seconds to compile: for http_connection.cpp and browser_websocket.cpp alone.
//
// A browser is read only once its link to the server stands. Until then its messages wait in the system's buffer, so
// there is no queue here that it could fill. No message of a browser is trusted; every limit ends in a close with a
// reason.
#pragma once

#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "client/command/clock.h"
#include "client/gateway/http_connection.h"
#include "client/gateway/lane.h"
#include "client/gateway/outbox.h"
#include "client/gateway/stream.h"
#include "protocol/transport/vestibule/handshake.h"

namespace wobble::gateway {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;
using std::chrono::seconds;
using Request = http::request<http::empty_body>;

//   kAccepting --> kJoining --> kGreeting --> kPlaying      OnAccepted, Turn once the server has answered, Judge
//       |    \        ^ |             |             |
//       |  kPreparing-+ |             |             |         OnAccepted and Turn, of a recording
//       |       |       |             |             |
//       +-------+-------+-------------+-------------+--> kLeaving --> kClosing    Close, then Write once nothing waits
//
// and from each of them to kOver by End. Close while kAccepting only sets the farewell: nothing can be written before
// the handshake is done, and OnAccepted then goes to kLeaving.
class Browser : public std::enable_shared_from_this<Browser> {
 public:
  // film: what is watched in place of the world; null: nothing. address: by which places are counted. credential: for
  // the server; showsNothing: of the browser itself.
  Browser(Shared& shared, const World& world, std::shared_ptr<const Film> film, Stream stream, Request request,
          const std::string& address, transport::vestibule::Credential credential, bool showsNothing)
      : m_shared(shared),
        m_film(std::move(film)),
        m_world(m_film == nullptr ? world : m_film->ReadWorld()),
        m_stream(std::move(stream)),
        m_resolver(m_stream.get_executor()),
        m_request(std::move(request)),
        m_credential(std::move(credential)),
        m_showsNothing(showsNothing),
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
  // Whether one more WebSocket of somebody with this key and address is this player's. A player has kMostLanes.
  [[nodiscard]] bool MayAdd(const LaneKey& key, const std::string& address) const;
  void Add(Stream stream, Request request);

 private:
  enum class State {
    kAccepting,  // the WebSocket handshake runs
    kPreparing,  // the recording's server is started
    kJoining,    // the server's name is looked up, its link opened; the browser is not read yet
    kGreeting,   // its hello is awaited
    kPlaying,    // messages go both ways
    kLeaving,    // the last messages go to the browser, then the close
    kClosing,    // the close has been sent and is to be answered
    kOver,
  };

  void NoteControl(std::size_t bytes);
  void OnAccepted(error_code error);
  void TurnFilm();
  void Resolve();
  void OnResolved(error_code error, const udp::resolver::results_type& results);
  void TurnLink(double now);
  [[nodiscard]] bool IsGatewayRefused(double now);
  void TakeSeat(double now);
  void RefuseSeat();
  // Whether what the browser sends goes to the server.
  [[nodiscard]] bool IsHeard() const { return m_state == State::kGreeting || m_state == State::kPlaying; }
  void Read();
  void OnRead(error_code error);
  void Judge(std::span<const std::uint8_t> message);
  [[nodiscard]] bool JudgeOfLane(std::span<const std::uint8_t> message);
  void Spread();
  void CutOff(websocket::close_code code, const std::string& reason);
  void Write();
  [[nodiscard]] std::string DescribeEnd(error_code error) const;
  void End(const std::string& reason);
  void LeaveServer();

  Shared& m_shared;
  std::shared_ptr<const Film> m_film;  // null: a world is played; it has m_world otherwise
  const World& m_world;
  websocket::stream<Stream> m_stream;
  udp::resolver m_resolver;
  Request m_request;
  transport::vestibule::Credential m_credential;
  bool m_showsNothing;   // apart from the gateway's introduction
  Lobby::Guest m_guest;  // of `greeting`, until it has said hello or has ended
  Place m_seat;          // null until the server has let it in
  std::uint64_t m_number;
  double m_begin;
  double m_helloBy = 0;  // while kGreeting

  std::unique_ptr<ServerLink> m_link;
  RateLimit m_rate;
  Outbox m_outbox;
  LaneKey m_laneKey{};
  std::vector<std::shared_ptr<Lane>> m_lanes;
  std::size_t m_turn = 0;     // of the lanes, where equally much is on the way
  Outbox::Message m_sending;  // on its way; empty when none is
  beast::flat_buffer m_incoming;
  State m_state = State::kAccepting;
  std::optional<websocket::close_reason> m_farewell;  // set by Close
  double m_closeBy = 0;                               // when a browser with a farewell is given up
  bool m_hasFlooded = false;                          // with pings; the next Turn cuts it off
};

}  // namespace wobble::gateway
