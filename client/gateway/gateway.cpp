// The listening port, the timer and the end; http_connection.cpp has the connections.
//
// WebSockets and not WebRTC or WebTransport: a prototype of data channels on Debian's usrsctp showed bodies no earlier
// over a line with loss than four WebSockets do, because SCTP's congestion control queues what it cannot send, and it
// needs a UDP port that is open to the internet. WebTransport needs TLS in this process and has no library in Debian.
// Look again when Debian has one for HTTP/3 datagrams that browsers accept, or when an SCTP can be told to drop
// instead.
//
// One thread: 64 players at 16 Mbit/s cost a tenth of a core. ENet does not work with Asio, so a timer polls all links
// and checks for signals.
#include "client/gateway/gateway.h"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio.hpp>

#include "client/command/clock.h"
#include "client/command/show_page.h"
#include "client/command/sockets.h"
#include "client/command/world_list.h"
#include "client/gateway/addresses.h"
#include "client/gateway/http_connection.h"
#include "client/gateway/outbox.h"
#include "client/gateway/watched_files.h"

namespace wobble::gateway {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;
using std::chrono::milliseconds;

// Seconds for all goodbyes when the gateway ends.
constexpr double kStopTimeout = 0.7;
// The longest that a snapshot waits, and the interval of checking for signals when nobody plays.
constexpr milliseconds kTurn{4};
constexpr milliseconds kIdleTurn{20};
// Connections that ask for files: a browser has up to six of them. WebSockets that have not said hello yet: honest ones
// have within a second.
constexpr std::size_t kVisitorsPerPlayer = 8;
constexpr std::size_t kMostVisitors = 512, kMostVisitorsOfAddress = 64;
constexpr std::size_t kMostGreeting = 64, kMostGreetingOfAddress = 32;
// Bytes that the system may hold unsent for a browser; the rest waits in the outbox, where old snapshots can be
// dropped.
constexpr int kUnsentBytes = 4 * 1024;
// Where the sidecar of Agones answers Kubernetes' health checks.
constexpr std::uint16_t kSidecarPort = 8080;

std::string DescribeWorlds(const std::vector<World>& worlds) {
  if (worlds[0].name.empty()) return "on " + Describe(worlds[0].server);
  std::string names;
  for (const World& world : worlds) names += (names.empty() ? "" : ", ") + world.name;
  return names;
}

// As a JSON array. Names need no escaping.
std::string ListWorlds(const std::vector<World>& worlds) {
  std::string names;
  for (const World& world : worlds) {
    if (!world.name.empty()) names += (names.empty() ? "\"" : ", \"") + world.name + "\"";
  }
  return "[" + names + "]";
}

std::unique_ptr<Films> OpenFilms(const GatewayOptions& options) {
  if (options.recordings.empty()) return nullptr;
  const std::string program = (command::FindProgramFolder() / "wobbled").string();
  return std::make_unique<Films>(options.recordings, program, options.maxConnections);
}

class Gateway {
 public:
  Gateway(const GatewayOptions& options, const Page& page, const command::IsStopAsked& isStopAsked)
      : m_shared{options,
                 page,
                 ListWorlds(options.worlds),
                 OpenFilms(options),
                 Lobby(std::min(kMostVisitors, kVisitorsPerPlayer * options.maxConnections),
                       std::min(kMostVisitorsOfAddress, kVisitorsPerPlayer * options.maxPerAddress)),
                 Lobby(kMostGreeting, kMostGreetingOfAddress),
                 Places(options.maxConnections, options.maxPerAddress)},
        m_isStopAsked(isStopAsked),
        m_tlsFiles({options.tls.certificate, options.tls.key}),
        m_listFile({options.list}),
        m_acceptor(m_context),
        m_timer(m_context) {}
  ~Gateway() { m_shared.browsers.clear(); }  // they need the context

  // False with one line in `error`.
  [[nodiscard]] bool Open(std::string& error);
  void Run();

 private:
  // False with one line in `error`; what held before still holds.
  [[nodiscard]] bool ReadCertificate(std::string& error);
  [[nodiscard]] bool ReadList(std::string& error);
  void FollowFiles(double now);
  void Accept();
  void Admit(tcp::socket socket);
  void Turn();
  void Stop(double now);
  void ShowStatus(double now);

  Shared m_shared;  // first: handlers that the context holds at the end have their places in it
  const command::IsStopAsked& m_isStopAsked;
  WatchedFiles m_tlsFiles;
  WatchedFiles m_listFile;
  asio::io_context m_context{1};
  tcp::acceptor m_acceptor;
  asio::steady_timer m_timer;
  bool m_isAccepting = false;
  std::optional<double> m_stopBy;
  double m_nextStatus = 0;
  GatewayCounts m_shown;
};

void Say(const std::string& line) { std::fprintf(stderr, "wobble gateway: %s\n", line.c_str()); }

bool Gateway::ReadCertificate(std::string& error) {
  const TlsFiles& files = m_shared.options.tls;
  if (!files.IsWanted()) return true;
  std::string warning;
  TlsContext context = LoadTls(files, std::time(nullptr), error, warning);
  if (context == nullptr) return false;
  m_shared.tls = std::move(context);
  if (!warning.empty()) Say(warning);
  return true;
}

bool Gateway::ReadList(std::string& error) {
  if (m_shared.options.list.empty()) return true;
  const auto worlds = command::LoadWorldList(m_shared.options.list, error);
  if (!worlds) {
    error = "--list: " + error;
    return false;
  }
  m_shared.list = command::FormatWorldList(*worlds);
  m_shared.pages = command::FormatPages(*worlds);
  return true;
}

void Gateway::FollowFiles(double now) {
  const std::string stays = "; the one before still holds";
  std::string error;
  if (m_tlsFiles.HaveChanged(now)) Say(ReadCertificate(error) ? "the certificate was read again" : error + stays);
  if (m_listFile.HaveChanged(now)) Say(ReadList(error) ? "the list was read again" : error + stays);
}

bool Gateway::Open(std::string& error) {
  const GatewayOptions& options = m_shared.options;
  if (!ReadCertificate(error) || !ReadList(error)) return false;
  error_code failure;
  for (const World& world : options.worlds) {
    udp::resolver(m_context).resolve(world.server.host, std::to_string(world.server.port), failure);
    if (!failure) continue;
    error = "--server: no address is known for '" + world.server.host + "'";
    return false;
  }
  const tcp::endpoint endpoint(asio::ip::make_address(options.bindAddress), options.port);
  m_acceptor.open(endpoint.protocol(), failure);
  if (!failure) m_acceptor.set_option(tcp::acceptor::reuse_address(true), failure);
  if (!failure) m_acceptor.bind(endpoint, failure);
  if (!failure) m_acceptor.listen(asio::socket_base::max_listen_connections, failure);
  if (!failure) return true;
  const std::string port = "port " + std::to_string(options.port) + " (TCP) ";
  // The recipe of docker/agones has another port than the default for this reason.
  const char* const who = options.port == kSidecarPort ? " (Agones' sidecar has this port in every pod)" : "";
  error = failure == asio::error::address_in_use ? port + "is in use; --http has another" + who
                                                 : port + "cannot be opened: " + failure.message();
  return false;
}

void Gateway::Run() {
  const GatewayOptions& options = m_shared.options;
  const asio::ip::address address = m_acceptor.local_endpoint().address();
  const std::string host = address.is_unspecified() || address.is_loopback() ? "localhost"
                           : address.is_v6()                                 ? "[" + options.bindAddress + "]"
                                                                             : options.bindAddress;
  const char* scheme = options.tls.IsWanted() ? "https" : "http";
  const unsigned port = m_acceptor.local_endpoint().port();
  std::printf("open %s://%s:%u in a browser to play %s%s\n", scheme, host.c_str(), port,
              DescribeWorlds(options.worlds).c_str(), address.is_loopback() ? ", on this machine alone" : "");
  command::ShowPageToFriends(scheme, SpellAddress(options.bindAddress), port);
  std::fflush(stdout);
  m_nextStatus = command::ReadClock() + options.statusEvery;
  Turn();
  m_context.run();
  const auto show = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  const GatewayCounts& counts = m_shared.counts;
  std::printf(
      "%llu requests, %llu refused; %llu browsers, %llu without a place, %llu cut off, %llu snapshots dropped; "
      "%llu connections too many\n",
      show(counts.requests), show(counts.requestsRefused), show(counts.browsers), show(counts.browsersRefused),
      show(counts.browsersCutOff), show(counts.snapshotsDropped),
      show(counts.socketsRefused + m_shared.visitors.CountEnded() + m_shared.greeting.CountEnded()));
}

// After a failure, such as too many open files, the next turn tries again.
void Gateway::Accept() {
  m_isAccepting = true;
  m_acceptor.async_accept([this](error_code error, tcp::socket socket) {
    m_isAccepting = false;
    if (error) return;
    Admit(std::move(socket));
    Accept();
  });
}

void Gateway::Admit(tcp::socket socket) {
  error_code error;
  const tcp::endpoint from = socket.remote_endpoint(error);
  if (error) return;  // gone already
  const std::string text = from.address().to_string();
  const std::string peer = SpellAddress(text.substr(0, text.find('%')));  // without the zone of a link-local address
  if (!IsTrusted(peer, m_shared.options.proxies) && !m_shared.opens.Allow(FindHousehold(peer), command::ReadClock())) {
    ++m_shared.counts.socketsRefused;
    return;
  }
  socket.set_option(tcp::no_delay(true), error);
  static_cast<void>(
      setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsentBytes, sizeof kUnsentBytes));
  Greet(m_shared, std::move(socket), peer);
}

void Gateway::Turn() {
  const double now = command::ReadClock();
  if (m_isStopAsked() && !m_stopBy) Stop(now);
  if (!m_isAccepting && !m_stopBy) Accept();
  FollowFiles(now);
  TurnBrowsers(m_shared, now);
  if (m_shared.films != nullptr) m_shared.films->Turn(now);
  Outbox nobody;
  for (const std::unique_ptr<ServerLink>& link : m_shared.leaving) link->Poll(now, nobody);
  std::erase_if(m_shared.leaving, [](const std::unique_ptr<ServerLink>& link) { return link->HasEnded(); });
  ShowStatus(now);
  const bool isEmpty = m_shared.browsers.empty() && m_shared.leaving.empty();
  if (m_stopBy && (isEmpty || now >= *m_stopBy)) return m_context.stop();
  m_timer.expires_after(isEmpty ? kIdleTurn : kTurn);
  m_timer.async_wait([this](error_code) { Turn(); });
}

void Gateway::Stop(double now) {
  m_stopBy = now + kStopTimeout;
  error_code ignored;
  m_acceptor.close(ignored);
  CloseBrowsers(m_shared);
}

void Gateway::ShowStatus(double now) {
  const double every = m_shared.options.statusEvery;
  if (every <= 0 || now < m_nextStatus) return;
  const GatewayCounts& counts = m_shared.counts;
  const auto kbit = [&](std::uint64_t before, std::uint64_t after) {
    return std::lround(static_cast<double>(after - before) * 8 / 1000 / every);
  };
  std::printf("browsers %zu/%zu, up %ld kbit/s, down %ld kbit/s\n", m_shared.players.CountTaken(),
              m_shared.options.maxConnections, kbit(m_shown.bytesUp, counts.bytesUp),
              kbit(m_shown.bytesDown, counts.bytesDown));
  std::fflush(stdout);
  m_shown = counts;
  while (m_nextStatus <= now) m_nextStatus += every;
}

}  // namespace

int RunGateway(const GatewayOptions& options, const Page& page, const command::IsStopAsked& isStopAsked) {
  command::AllowManySockets();
  if (!transport::vestibule::InitialiseSodium()) {
    std::fprintf(stderr, "wobble gateway: the cryptographic library does not start\n");
    return command::kExitBadUse;
  }
  Gateway gateway(options, page, isStopAsked);
  std::string error;
  if (!gateway.Open(error)) {
    std::fprintf(stderr, "wobble gateway: %s\n", error.c_str());
    return command::kExitBadUse;
  }
  gateway.Run();
  return command::kExitGood;
}

}  // namespace wobble::gateway
