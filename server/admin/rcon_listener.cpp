// A connection is read only when all that it has sent is answered, so it holds a packet and a buffer at most, and takes
// turns with the others after each packet.
#include "server/admin/rcon_listener.h"

#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <thread>

#include "server/admin/rcon.h"
#include "server/ops/acceptor.h"

namespace wobble::admin {
namespace {

namespace asio = boost::asio;
namespace vestibule = transport::vestibule;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{5};  // to show the password, for a packet, and to take an answer
constexpr std::chrono::minutes kIdle{10};     // between packets of one who has shown the password
constexpr auto kAnswerPatience = std::chrono::milliseconds(2000);

transport::NetAddress FromAsio(const asio::ip::address& address) {
  transport::NetAddress result;
  result.ip =
      (address.is_v6() ? address.to_v6() : asio::ip::make_address_v6(asio::ip::v4_mapped, address.to_v4())).to_bytes();
  return result;
}

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using OnEnd = std::function<void(const Connection*)>;
  Connection(tcp::socket socket, asio::ip::address from, RconSession session, OnEnd onEnd)
      : m_socket(std::move(socket)),
        m_timer(m_socket.get_executor()),
        m_from(std::move(from)),
        m_session(std::move(session)),
        m_onEnd(std::move(onEnd)),
        m_mustBeInBy(Clock::now() + kPatience) {}

  void Start() { Read(); }
  void Close() {
    error_code ignored;
    m_socket.close(ignored);
    m_timer.cancel();
  }
  [[nodiscard]] const asio::ip::address& From() const { return m_from; }
  [[nodiscard]] bool MayYield() const { return !m_session.IsIn(); }

 private:
  // Closes the connection at that time, unless it is called again before.
  void ExpireAt(Clock::time_point time) {
    m_timer.expires_at(time);
    m_timer.async_wait([self = shared_from_this()](error_code aborted) {
      if (!aborted) self->Close();
    });
  }

  void Read() {
    // A packet that comes byte by byte gets no longer with each byte.
    if (!m_session.IsIn()) {
      ExpireAt(m_mustBeInBy);
    } else if (!m_session.IsInPacket()) {
      ExpireAt(Clock::now() + kIdle);
    } else if (!m_isMidPacket) {
      ExpireAt(Clock::now() + kPatience);
    }
    m_isMidPacket = m_session.IsInPacket();
    m_socket.async_read_some(asio::buffer(m_buffer), [self = shared_from_this()](error_code error, std::size_t count) {
      if (error) return self->End();
      self->m_session.Add({self->m_buffer.data(), count});
      self->TakeNext();
    });
  }

  void TakeNext() {
    const RconSession::Step step = m_session.TakeNext(m_answer);
    if (step == RconSession::Step::kWaits) return Read();
    m_isMidPacket = false;
    ExpireAt(Clock::now() + kPatience);
    asio::async_write(m_socket, asio::buffer(m_answer),
                      [self = shared_from_this(), step](error_code error, std::size_t) {
                        if (error || step == RconSession::Step::kEnds) return self->End();
                        self->TakeNext();
                      });
  }

  void End() {
    m_timer.cancel();
    error_code ignored;
    m_socket.shutdown(tcp::socket::shutdown_send, ignored);
    m_onEnd(this);
  }

  tcp::socket m_socket;
  asio::steady_timer m_timer;
  asio::ip::address m_from;
  RconSession m_session;
  OnEnd m_onEnd;
  Clock::time_point m_mustBeInBy;
  bool m_isMidPacket = false;  // the timer runs for the present packet
  std::array<char, 4096> m_buffer;
  std::string m_answer;
};

vestibule::Key MakeKey() {
  vestibule::Key key;
  vestibule::FillRandomly(key);
  return key;
}

}  // namespace

struct RconListener::Implementation {
  Implementation(const std::string& password, OrderQueue& orders)
      : queue(orders),
        guard(password, MakeKey()),
        acceptor(context,
                 [this](tcp::socket socket, const asio::ip::address& from) { Take(std::move(socket), from); }) {}

  void Take(tcp::socket socket, const asio::ip::address& from) {
    if (!crowd.MakeRoom(from)) return;  // closes it
    RconSession session([this, from](std::string_view password) { return Judge(from, password); },
                        [this](const std::string& order) { return queue.Ask(order, "RCON", kAnswerPatience).lines; });
    const auto connection = std::make_shared<Connection>(std::move(socket), from, std::move(session),
                                                         [this](const Connection* ended) { crowd.Remove(ended); });
    crowd.Add(connection);
    connection->Start();
  }

  RconGuess Judge(const asio::ip::address& from, std::string_view password) {
    const double now = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
    const RconGuess guess = guard.Judge(FromAsio(from), password, now);
    // Guesses that are not listened to are not logged: they may be any number.
    if (guess == RconGuess::kWrong) {
      spdlog::warn("RCON: a wrong password from {}; after three, its subnet is not listened to for a minute",
                   from.to_string());
    }
    return guess;
  }

  OrderQueue& queue;
  RconGuard guard;
  asio::io_context context{1};
  ops::Acceptor acceptor;
  ops::Crowd<Connection> crowd{kMostConnections, kMostPerAddress};
  std::thread thread;
};

RconListener::RconListener(std::unique_ptr<Implementation> implementation) : m(std::move(implementation)) {}

std::unique_ptr<RconListener> RconListener::Listen(const ops::Address& address, const std::string& password,
                                                   OrderQueue& queue, std::string& error) {
  auto made = std::make_unique<Implementation>(password, queue);
  if (!made->acceptor.Open(address, error)) return nullptr;
  made->thread = std::thread([context = &made->context] { context->run(); });
  return std::unique_ptr<RconListener>(new RconListener(std::move(made)));
}

RconListener::~RconListener() {
  m->context.stop();
  m->thread.join();
  m->crowd.Clear();
}

std::uint16_t RconListener::ReadPort() const { return m->acceptor.ReadPort(); }

}  // namespace wobble::admin
